//! `trimray bench` as clap sees it.

use super::args::{DeviceChoice, ExactnessChoice, PrecisionChoice, parse_resolution};
use super::args_bench_trim::BenchTrim;
use clap::{Args, Subcommand};
use std::path::PathBuf;

/// The greatest number of a first ray: the numbers of all that follow are whole 64-bit numbers.
const MAX_FIRST: u64 = 1 << 62;

/// Measures how fast trimray is on this machine, and how exact.
#[derive(Debug, Args)]
pub(super) struct Bench {
    #[command(subcommand)]
    pub(super) command: BenchCommand,
}

#[derive(Debug, Subcommand)]
pub(super) enum BenchCommand {
    Stages(BenchStages),
    Accuracy(BenchAccuracy),
    Work(BenchWork),
    Leaks(BenchLeaks),
    Rays(BenchRays),
    Stress(BenchStress),
    Trim(BenchTrim),
}

/// Times of each stage from a file to a picture: the least of all repetitions, and their median.
///
/// `decode` is the decoding of all entities that shape refers to, each once, on one thread, measured on its own; the mapping decodes
/// what it reaches by itself, so `map` includes that work and the sums leave `decode` out. Trim trees, nets and leaves are parts of the bake: their work over
/// the threads that share it. `open, first ray` opens the written `.trimray` file anew and traces one ray;
/// `find kept, first ray` does so with a scene that was kept, which is not checked again. `compile` is a picture of one pixel, frames are pictures without settings,
/// primary rays see lamps but no sky; random rays are chords of the scene's sphere, and on a GPU their rate includes the transfers.
/// `kernel` is a GPU's kernel alone: the first hits of rays that the device holds, and its rate is that of those rays that can meet the scene.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trimray bench stages part.step
  trimray bench stages *.step --json --repeat 5 > stages.jsonl
  trimray bench stages *.step --compare stages.jsonl
  trimray bench stages part.step --frames --resolution 3840,2160 --rays-per-pixel 8 --repeat 15 --warm-ups 5
  trimray bench stages part.step --grow 1,2,4,8 --plot growth.svg")]
pub(super) struct BenchStages {
    /// STEP or IGES files.
    #[arg(required = true, value_name = "INPUT")]
    pub(super) inputs: Vec<PathBuf>,
    /// How often to run each stage.
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub(super) repeat: u16,
    /// Go on to pictures and rays.
    #[arg(long)]
    pub(super) frames: bool,
    /// Of pictures and rays time a GPU's kernels alone, on rays that it holds.
    #[arg(long, requires = "frames")]
    pub(super) kernels: bool,
    /// Runs of pictures and rays that do not count.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u16).range(0..=1000), requires = "frames")]
    pub(super) warm_ups: u16,
    /// Pixels of pictures across and down.
    #[arg(long, value_name = "W,H", default_value = "1920,1080", value_parser = parse_resolution, requires = "frames")]
    pub(super) resolution: [u32; 2],
    /// Primary rays through each pixel.
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = clap::value_parser!(u32).range(1..=4096), requires = "frames")]
    pub(super) rays_per_pixel: u32,
    /// How many random rays.
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(1..=100_000_000), requires = "frames")]
    pub(super) rays: u64,
    /// What computes pictures and rays.
    #[arg(long, value_enum, default_value_t = DeviceChoice::Auto, requires = "frames")]
    pub(super) device: DeviceChoice,
    /// Measure so many copies along each axis, one number after the other, and tell how the time of each stage grows with the number of faces.
    #[arg(long, value_name = "N,...", value_delimiter = ',', default_value = "1", value_parser = clap::value_parser!(u32).range(1..=1000))]
    pub(super) grow: Vec<u32>,
    /// Write a plot of times by faces here, as SVG; of one file, with --grow.
    #[arg(long, value_name = "FILE", requires = "grow")]
    pub(super) plot: Option<PathBuf>,
    /// Compare with an earlier run: its lines of JSON.
    #[arg(long, value_name = "FILE", conflicts_with = "json")]
    pub(super) compare: Option<PathBuf>,
    /// One JSON object a line, times in seconds.
    #[arg(long)]
    pub(super) json: bool,
}

/// Hits of the CPU tracer against an f64 reference that subdivides every net: missed and made-up hits, errors, time per ray.
///
/// Rays are chords of the scene's bounding sphere. The reference is certain of a ray unless 2⁻²¹ of a face's size, or twice the gap of its edges, would
/// change its hits, and unless it has an odd number of them itself on closed bodies (`bench leaks` counts those); only certain rays are compared.
/// `tracer` compares with the baked numbers, so that what differs is the tracer's own error; `total` compares with the model's f64 numbers, so that
/// the baking counts too. `trims` counts the missed and made-up hits whose place is right, so that a trim was decided otherwise, or a hit left out
/// that its body cannot have. Errors of distance are relative to the size of the net or face piece that was hit, `steep` is the 99.9th percentile
/// where |cos| of the angle to the normal is above 0.2; `angle` is that of normals in radians, and `uv` that of the surface parameters as a length
/// along the surface, over that size.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trimray bench accuracy part.step
  trimray bench accuracy part.step --exactness fast
  trimray bench accuracy *.step --rays 1000000 --csv accuracy.csv")]
pub(super) struct BenchAccuracy {
    /// STEP or IGES files.
    #[arg(required = true, value_name = "INPUT")]
    pub(super) inputs: Vec<PathBuf>,
    /// How many rays.
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = clap::value_parser!(u64).range(1..=10_000_000_000))]
    pub(super) rays: u64,
    /// Start the rays so many radii of the scene farther away.
    #[arg(long, value_name = "RADII", default_value_t = 0.0, value_parser = parse_distance)]
    pub(super) distance: f64,
    /// The number of the first ray in the sequence: other rays than those of an earlier run.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=MAX_FIRST))]
    pub(super) first: u64,
    /// How carefully nets are searched.
    #[arg(long, value_enum, default_value_t = ExactnessChoice::Exact)]
    pub(super) exactness: ExactnessChoice,
    /// Write the rows here too, as comma-separated values.
    #[arg(long, value_name = "FILE")]
    pub(super) csv: Option<PathBuf>,
    /// One JSON object a line.
    #[arg(long)]
    pub(super) json: bool,
}

/// Run time against error: first hits at five distortions of the leaves, three exactnesses and two precisions, with Newton's method stopped
/// earlier or later, and with other trim methods.
///
/// The setting is the distortion, the step in √ε of a leaf's side below which Newton's method has converged (1 elsewhere), or the trim method.
/// Each setting's bake time, bytes, nanoseconds a ray on one thread, and the errors of its first hits against the f64 reference, in diagonals of
/// the scene. `--csv` writes rows that tools/rival/mesh_embree.py writes too, for a mesh of the same model; `--rival` reads those, so that the
/// plot shows both.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trimray bench work part.step
  trimray bench work part.step --csv work.csv --rival mesh.csv --plot work.svg")]
pub(super) struct BenchWork {
    /// A STEP or IGES file.
    #[arg(value_name = "INPUT")]
    pub(super) input: PathBuf,
    /// How many rays.
    #[arg(long, value_name = "N", default_value_t = 100_000, value_parser = clap::value_parser!(u64).range(1..=1_000_000_000))]
    pub(super) rays: u64,
    /// The number of the first ray in the sequence: other rays than those of an earlier run.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=MAX_FIRST))]
    pub(super) first: u64,
    /// Write the rows here, as comma-separated values.
    #[arg(long, value_name = "FILE")]
    pub(super) csv: Option<PathBuf>,
    /// Rows of another tracer to show beside ours.
    #[arg(long, value_name = "FILE")]
    pub(super) rival: Option<PathBuf>,
    /// Write a log-log plot here, as SVG.
    #[arg(long, value_name = "FILE")]
    pub(super) plot: Option<PathBuf>,
}

/// Rays that see an odd number of walls of closed solids.
///
/// Half of the rays are chords of the scene's bounding sphere, half pass by edges at 1e-9 to 1e-3 of the scene's size. `closed` says whether the
/// model is made of whole solids alone; where it is not, odd rays are no fault. Rates are upper bounds at 95 %. Near edges and tangents more hits are
/// found than a body can have: `before` counts the rays that are odd before the fewest hits are left out that make them even, `left out` those
/// hits, `repeated` the rays that keep two hits at one place and from one side, and `beside` the rays that are odd on a closed body and made even by
/// hits of a ray moved aside, by a millionth to a 2,048th of the scene's radius, or by leaving out one of two hits where faces overlap by no more
/// than that.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trimray bench leaks part.step
  trimray bench leaks *.step --rays 10000000 --precision f32 --json > leaks.jsonl")]
pub(super) struct BenchLeaks {
    /// STEP or IGES files.
    #[arg(required = true, value_name = "INPUT")]
    pub(super) inputs: Vec<PathBuf>,
    /// How many rays.
    #[arg(long, value_name = "N", default_value_t = 1_000_000, value_parser = clap::value_parser!(u64).range(2..=10_000_000_000))]
    pub(super) rays: u64,
    /// The number of the first ray in the sequence: other rays than those of an earlier run.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=MAX_FIRST))]
    pub(super) first: u64,
    /// Numbers to compute with; both, one after the other, where it is left out.
    #[arg(long, value_enum)]
    pub(super) precision: Option<PrecisionChoice>,
    /// Print so many odd rays of each kind, as lines that `probe --rays` reads.
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub(super) show: usize,
    /// One JSON object a line.
    #[arg(long)]
    pub(super) json: bool,
}

/// How fast the first hits of given rays are found on the CPU, as pictures find them: in f32, without shading.
///
/// The time includes that from the ray's f64 numbers to the distance along it, on all threads (`--threads`), and is the least of all runs, beside their median.
/// `tools/speed/peers.py` asks another tracer the same rays.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trimray bench rays part.step --rays rays.txt
  trimray bench rays part.step --rays rays.txt --threads 1 --json")]
pub(super) struct BenchRays {
    /// STEP or IGES files, or `.trimray` files.
    #[arg(required = true, value_name = "INPUT")]
    pub(super) inputs: Vec<PathBuf>,
    /// A file with a ray on each line, `ox oy oz dx dy dz`.
    #[arg(long, value_name = "FILE")]
    pub(super) rays: PathBuf,
    /// How often to trace them.
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u16).range(1..=1000))]
    pub(super) repeat: u16,
    /// One JSON object a line.
    #[arg(long)]
    pub(super) json: bool,
}

/// Scenes that are hard to trace, made by the program itself: hits against the f64 reference, odd rays, and shapes in other forms.
///
/// Each scene is traced with rays made for it (near tangents, past slivers, through edges, from afar) and with chords of its sphere. Only rays
/// of which the reference is certain are compared; odd rays are counted on closed solids. The scenes called same-… are traced again moved,
/// turned, scaled, of higher degree, with more knots, in other parameters and turned around, and started again at each of their hits (`restart`),
/// where all hits have to stay within 1e-6 of the scene's size in f32 and 1e-12 in f64. Rates are upper bounds at 95 %.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trimray bench stress
  trimray bench stress --only torus-rim --rays 1000000 --precision f32
  trimray bench stress --json > stress.jsonl")]
pub(super) struct BenchStress {
    /// How many rays of each kind for each scene.
    #[arg(long, value_name = "N", default_value_t = 10_000, value_parser = clap::value_parser!(u64).range(1..=10_000_000_000))]
    pub(super) rays: u64,
    /// The number of the first ray in the sequence: other rays than those of an earlier run.
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = clap::value_parser!(u64).range(..=MAX_FIRST))]
    pub(super) first: u64,
    /// Only the scenes whose names begin so.
    #[arg(long, value_name = "NAME", default_value = "", hide_default_value = true)]
    pub(super) only: String,
    /// Numbers to compute with; both, one after the other, where it is left out.
    #[arg(long, value_enum)]
    pub(super) precision: Option<PrecisionChoice>,
    /// One JSON object a line, with the first ray that went wrong.
    #[arg(long)]
    pub(super) json: bool,
}

fn parse_distance(text: &str) -> Result<f64, String> {
    let distance: f64 = text.parse().map_err(|_| format!("`{text}` is no number"))?;
    if (0.0..=1e9).contains(&distance) { Ok(distance) } else { Err("it has to be from 0 to 1e9".to_owned()) }
}
