//! The command line as clap sees it. Flags follow f3d where it has one.

use super::args_bench::Bench;
use super::args_cache::CacheArguments;
use super::args_camera::CameraArguments;
use super::args_files::{Diff, Merge};
use super::args_material::MaterialArguments;
use super::args_output::OutputArguments;
use super::args_path::PathArguments;
use super::args_reference::ReferenceArguments;
use super::args_section::SectionArguments;
use super::args_select::SelectionArguments;
use super::args_style::StyleArguments;
use crate::render::{Exactness, Sampling};
use crate::scene::TrimMethod;
use clap::{Args, Parser, Subcommand, ValueEnum};
use glam::DVec3;
use std::path::PathBuf;

/// Ray traces the exact trimmed surfaces of CAD files. Nothing is tessellated.
///
/// INPUT is a STEP file (.step, .stp, .p21), an IGES file (.igs, .iges) or a scene baked by `trimray bake` (.trimray).
/// All lengths are millimetres, whatever unit the file is in.
#[derive(Debug, Parser)]
#[command(
    version,
    propagate_version = true,
    after_help = "\
Examples:
  trimray render part.step -o part.png
  trimray bake plant.step && trimray render plant.trimray -o plant.exr
  trimray info part.step
  echo '0 0 100 0 0 -1' | trimray probe part.step --rays -

Exit codes: 0 done, 1 cannot read or write, 2 wrong usage, 3 --strict and something was dropped,
4 nothing to render, 5 pictures differ. Where several inputs were rendered: that of the worst."
)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,
    #[command(flatten)]
    pub(super) general: General,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    Render(Box<Render>),
    Bake(Bake),
    Info(Info),
    Probe(Probe),
    Diff(Diff),
    Merge(Merge),
    Bench(Bench),
}

/// Flags of every command.
#[derive(Debug, Args)]
pub(super) struct General {
    /// Say nothing but errors.
    #[arg(short, long, global = true, conflicts_with = "verbose", help_heading = "General")]
    pub(super) quiet: bool,
    /// Say more: times, every warning, notes. Twice: debug messages too.
    #[arg(short, long, global = true, action = clap::ArgAction::Count, help_heading = "General")]
    pub(super) verbose: u8,
    /// Threads to use [default: one per core].
    #[arg(short = 'j', long, global = true, value_name = "N", help_heading = "General",
          value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
}

/// What reads a model.
#[derive(Debug, Args)]
pub(super) struct Import {
    /// End with exit code 3, and write nothing, if any face had to be dropped.
    #[arg(long)]
    pub(super) strict: bool,
}

/// Renders still pictures of models.
///
/// Without options the whole model is in the picture, seen from above at an angle, +Z up, in the file's own colours.
/// The extension of the output picks the format: .png is sRGB, .exr is linear light with depth, normals, ids and more as --layers says.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trimray render part.step -o part.png
  trimray render part.step -o top.png --camera-direction -Z --up +Y --camera-orthographic
  trimray render part.step -o drawing.png --style technical --hidden-lines dashed
  trimray render pump.step -o cut.png --section x=50% --edges feature --section-exclude 'Shaft*'
  trimray render part.step -o - --no-background --resolution 400x400 | display
  trimray render part.step -o sheet.png --view review
  trimray render part.step -o '{view}.png' --view front,top,right --camera-orthographic
  trimray render part.step -o turn.png --frames 36
  trimray render part.step -o still.png --path-trace --ground --spp 256 --noise 0.01
  trimray render part.step -o new.png --reference old.png --reference-tolerance 0.02 --reference-max-outliers 0.001
  trimray render a.step b.step -o 'pictures/{model}.png'")]
pub(super) struct Render {
    /// STEP or IGES files, or baked .trimray files.
    #[arg(required = true, value_name = "INPUT")]
    pub(super) inputs: Vec<PathBuf>,
    /// The picture to write: .png, .exr, or '-' for a PNG on stdout.
    ///
    /// {model} stands for the input's name without its extension, {view} for the name of a --view, {frame} for the number of one of --frames,
    /// from 0; {frame:04} has four digits.
    #[arg(short, long, value_name = "FILE", required = true)]
    pub(super) output: String,
    #[command(flatten)]
    pub(super) import: Import,
    #[command(flatten)]
    pub(super) cache: CacheArguments,
    #[command(flatten)]
    pub(super) selection: SelectionArguments,
    /// Pixels across and down.
    #[arg(long, value_name = "W,H", default_value = "1000,600", value_parser = parse_resolution)]
    pub(super) resolution: [u32; 2],
    /// Samples of a pixel in which something changes.
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub(super) samples: u32,
    /// Which pixels get all their samples.
    #[arg(long, value_enum, default_value_t = SamplingChoice::Adaptive)]
    pub(super) sampling: SamplingChoice,
    /// How finely free-form faces of a CAD file are divided; a baked scene is what it is.
    #[arg(long, value_enum, default_value_t = BakeQuality::Balanced)]
    pub(super) bake_quality: BakeQuality,
    /// What computes.
    #[arg(long, value_enum, default_value_t = DeviceChoice::Auto)]
    pub(super) device: DeviceChoice,
    /// Colour behind the model, sRGB: r,g,b in 0..=1, or #rrggbb [default: white; blue in the style blueprint].
    #[arg(long, value_name = "COLOR", value_parser = parse_color, allow_hyphen_values = true)]
    pub(super) background_color: Option<[f32; 3]>,
    /// No background: the picture is transparent where there is no model.
    #[arg(long, conflicts_with = "background_color")]
    pub(super) no_background: bool,
    /// No darkening where the surroundings block the light: faster.
    #[arg(long)]
    pub(super) no_ambient_occlusion: bool,
    /// How carefully hits on free-form faces are searched for where a ray grazes them.
    #[arg(long, value_enum, default_value_t = ExactnessChoice::Exact)]
    pub(super) exactness: ExactnessChoice,
    /// Show what something costs instead of what is seen; on the CPU.
    #[arg(long, value_enum, value_name = "WHAT")]
    pub(super) aov: Option<AovChoice>,
    #[command(flatten)]
    pub(super) camera: CameraArguments,
    #[command(flatten)]
    pub(super) writing: OutputArguments,
    #[command(flatten)]
    pub(super) reference: ReferenceArguments,
    #[command(flatten)]
    pub(super) style: StyleArguments,
    #[command(flatten)]
    pub(super) material: MaterialArguments,
    #[command(flatten)]
    pub(super) path: PathArguments,
    #[command(flatten)]
    pub(super) section: SectionArguments,
    /// Take the assembly apart: what the model contains moves away from its middle by this share of its distance from there, what that contains in turn by half
    /// of the share from its own middle, and so on. Sections cut what is then.
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = parse_explode, help_heading = "Selection")]
    pub(super) explode: f64,
}

/// Imports and preprocesses a model once: a .trimray file opens at once, and every command takes it as INPUT.
///
/// The same input and options give the same bytes, whatever the machine's threads.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trimray bake plant.step
  trimray bake plant.step -o /tmp/plant.trimray --keep-f64
  trimray bake engine.step -o engines.trimray --replicate 5,5,3")]
pub(super) struct Bake {
    /// A STEP or IGES file.
    #[arg(value_name = "INPUT")]
    pub(super) input: PathBuf,
    /// The file to write [default: beside the input, with the extension .trimray].
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
    #[command(flatten)]
    pub(super) import: Import,
    #[command(flatten)]
    pub(super) selection: SelectionArguments,
    /// Keep the geometry in f64 too, for `probe --precision f64`.
    #[arg(long)]
    pub(super) keep_f64: bool,
    /// Keep the model's edges too, for `render --edges`.
    #[arg(long)]
    pub(super) edges: bool,
    /// What trim queries search in: a row of Table 2 of Sloup and Havran 2021, by number or name (lc, hs+b, kc+rbe, kcs-sf19, ...), or packed.
    #[arg(long, value_name = "METHOD", default_value = "packed")]
    pub(super) trim_method: TrimMethod,
    /// How finely free-form faces are divided.
    #[arg(long, value_enum, default_value_t = BakeQuality::Balanced)]
    pub(super) bake_quality: BakeQuality,
    /// Bake so many copies of the model along x, y and z, side by side, each with faces of its own.
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_counts)]
    pub(super) replicate: Option<[u32; 3]>,
}

/// Tells what is in a file: units, product tree, faces by kind, sizes, and what was dropped and why.
///
/// B-spline surfaces that are planes, cylinders, cones, spheres or tori within 1e-7 of their size are taken for these,
/// and counted. The largest gap is a bound: no two faces are farther apart along an edge that they share.
#[derive(Debug, Args)]
pub(super) struct Info {
    /// A STEP or IGES file, or a baked .trimray file.
    #[arg(value_name = "INPUT")]
    pub(super) input: PathBuf,
    #[command(flatten)]
    pub(super) import: Import,
    #[command(flatten)]
    pub(super) cache: CacheArguments,
    /// Machine-readable, as one JSON object.
    #[arg(long)]
    pub(super) json: bool,
}

/// Answers rays with exact hits.
///
/// Each line `ox oy oz dx dy dz` of the ray file (millimetres; the direction may have any length but 0) is answered by one line of JSON on
/// stdout, in order: {"hits":[{"t":12.5,"p":[x,y,z],"n":[x,y,z],"u":0.1,"v":0.2,"face":17,"entity":"#123","part":"Bolt"}]}.
/// t is in millimetres along the normalised direction, n is the outward normal, u and v are the surface's parameters (radians and
/// millimetres), entity is the face's number in the CAD file. A miss is {"hits":[]}. Empty lines and lines that begin with # are skipped.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  echo '0 0 100 0 0 -1' | trimray probe part.step --rays -
  trimray probe part.trimray --rays rays.txt --hits first --precision f32 > hits.jsonl")]
pub(super) struct Probe {
    /// A STEP or IGES file, or a baked .trimray file.
    #[arg(value_name = "INPUT")]
    pub(super) input: PathBuf,
    #[command(flatten)]
    pub(super) import: Import,
    #[command(flatten)]
    pub(super) cache: CacheArguments,
    #[command(flatten)]
    pub(super) selection: SelectionArguments,
    /// The rays, one a line; '-' for stdin.
    #[arg(long, value_name = "FILE")]
    pub(super) rays: PathBuf,
    /// All hits of each ray, nearest first, or only the nearest.
    #[arg(long, value_enum, default_value_t = HitsChoice::All)]
    pub(super) hits: HitsChoice,
    /// Numbers to compute with [default: f64; f32 on the GPU and for a .trimray file without f64 geometry].
    #[arg(long, value_enum)]
    pub(super) precision: Option<PrecisionChoice>,
    /// How carefully hits on free-form faces are searched for where a ray grazes them.
    #[arg(long, value_enum, default_value_t = ExactnessChoice::Exact)]
    pub(super) exactness: ExactnessChoice,
    /// What computes; auto is the CPU for f64.
    #[arg(long, value_enum, default_value_t = DeviceChoice::Auto)]
    pub(super) device: DeviceChoice,
    /// Count what the rays take, in f32: nodes, faces, leaves, steps of Newton's method, trim tests; on stderr.
    #[arg(long)]
    pub(super) stats: bool,
}

/// How bent a piece of a free-form face may be that is searched for hits as a whole, half as much where it is large in its scene. Hits are exact whatever the
/// pieces.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, ValueEnum)]
pub(super) enum BakeQuality {
    /// A quarter of its size: baked sooner, rays take longer.
    Fast,
    /// An eighth.
    #[default]
    Balanced,
    /// A sixteenth: baked in up to twice the time, rays are a little faster.
    Best,
}

impl BakeQuality {
    /// The distortion of leaves below which they are not divided.
    pub(super) fn distortion(self) -> f64 {
        match self {
            Self::Fast => 1.0 / 4.0,
            Self::Balanced => 1.0 / 8.0,
            Self::Best => 1.0 / 16.0,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum DeviceChoice {
    /// A hardware GPU if there is one, else the CPU.
    Auto,
    /// All cores.
    Cpu,
    /// The GPU, or a software driver that poses as one; an error if there is neither.
    Gpu,
}

/// What a picture shows other than light.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum AovChoice {
    /// Exact odd-even trim tests for each pixel, from black (0) over blue, cyan, green and yellow to red (20 or more); an EXR file has the numbers too.
    TrimTests,
}

/// [`Exactness`], with what each costs and loses: measured in f32 on twelve free-form models, with 100,000 random chords each.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum ExactnessChoice {
    /// One search where a ray grazes a patch: of a million rays, 30 to 6000 hits are lost at silhouettes.
    Fast,
    /// Two searches: of a million rays up to 200 hits are lost; up to 1.3 times the time of fast.
    Balanced,
    /// A certified search: only hits that nearly coincide, and hits at poles, may be lost; 1 to 1.5 times the time of fast, more for rays past the pole of a patch.
    Exact,
}

impl From<ExactnessChoice> for Exactness {
    fn from(choice: ExactnessChoice) -> Self {
        match choice {
            ExactnessChoice::Fast => Self::Fast,
            ExactnessChoice::Balanced => Self::Balanced,
            ExactnessChoice::Exact => Self::Exact,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum SamplingChoice {
    /// Those in which something changes; the others have the light of their centre.
    Adaptive,
    /// All.
    Uniform,
}

impl From<SamplingChoice> for Sampling {
    fn from(choice: SamplingChoice) -> Self {
        match choice {
            SamplingChoice::Adaptive => Self::Adaptive,
            SamplingChoice::Uniform => Self::Uniform,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum HitsChoice {
    First,
    All,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum PrecisionChoice {
    F32,
    F64,
}

/// More pixels than this would not fit the memory of common machines.
pub(super) const MAX_PIXELS: u64 = 1 << 27;

/// How far an assembly may be taken apart: what is left of 24 bits between the grid's step and the model's size bears this easily.
const MOST_EXPLODED: f64 = 10.0;

fn parse_explode(text: &str) -> Result<f64, String> {
    let share = text.parse::<f64>().ok().filter(|share| (0.0..=MOST_EXPLODED).contains(share));
    share.ok_or_else(|| format!("a number from 0 (as it is) to {MOST_EXPLODED} is wanted, such as 1"))
}

pub(super) fn parse_resolution(text: &str) -> Result<[u32; 2], String> {
    let (width, height) =
        text.split_once([',', 'x', 'X']).ok_or("expected W,H or WxH, such as 1000,600".to_owned())?;
    let side = |text: &str| match text.trim().parse::<u32>() {
        Ok(pixels @ 1..=65_536) => Ok(pixels),
        _ => Err(format!("`{text}` is no number of pixels from 1 to 65536")),
    };
    let (width, height) = (side(width)?, side(height)?);
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(format!("more than {MAX_PIXELS} pixels"));
    }
    Ok([width, height])
}

/// Copies along x, y and z.
pub(super) fn parse_counts(text: &str) -> Result<[u32; 3], String> {
    let counts: Vec<Option<u32>> =
        text.split(',').map(|n| n.trim().parse().ok().filter(|&count| count > 0)).collect();
    match counts[..] {
        [Some(x), Some(y), Some(z)] => Ok([x, y, z]),
        _ => Err("expected three counts X,Y,Z, each at least 1".to_owned()),
    }
}

pub(super) fn parse_point(text: &str) -> Result<DVec3, String> {
    let mut numbers = text.split(',').map(|n| n.trim().parse::<f64>());
    match (numbers.next(), numbers.next(), numbers.next(), numbers.next()) {
        (Some(Ok(x)), Some(Ok(y)), Some(Ok(z)), None) if [x, y, z].iter().all(|c| c.abs() < 1e15) => {
            Ok(DVec3::new(x, y, z))
        }
        _ => Err("expected three numbers x,y,z".into()),
    }
}

/// A unit vector.
pub(super) fn parse_direction(text: &str) -> Result<DVec3, String> {
    let (sign, axis) = match text.as_bytes() {
        [b'+', axis] | [axis] => (1.0, axis),
        [b'-', axis] => (-1.0, axis),
        _ => (1.0, &b' '),
    };
    let vector = match axis {
        b'x' | b'X' => DVec3::X,
        b'y' | b'Y' => DVec3::Y,
        b'z' | b'Z' => DVec3::Z,
        _ => parse_point(text).map_err(|_| "expected +X, -X, +Y, -Y, +Z, -Z or x,y,z".to_owned())?,
    };
    (vector * sign).try_normalize().ok_or("the direction is 0".into())
}

pub(super) fn parse_color(text: &str) -> Result<[f32; 3], String> {
    if let Some(hex) = text.strip_prefix('#') {
        let is_code = hex.len() == 6 && hex.bytes().all(|b| b.is_ascii_hexdigit());
        let code =
            u32::from_str_radix(hex, 16).ok().filter(|_| is_code).ok_or("expected #rrggbb".to_owned())?;
        return Ok([16, 8, 0].map(|shift| (code >> shift & 0xff) as f32 / 255.0));
    }
    let color = parse_point(text).map_err(|_| "expected r,g,b in 0..=1 or #rrggbb".to_owned())?.as_vec3();
    if color.to_array().iter().all(|c| (0.0..=1.0).contains(c)) {
        Ok(color.to_array())
    } else {
        Err("red, green and blue are in 0..=1".into())
    }
}

pub(super) fn parse_view_angle(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(degrees) if (0.01..=170.0).contains(&degrees) => Ok(degrees),
        _ => Err("expected degrees from 0.01 to 170".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_definition_is_sound() {
        Arguments::command().debug_assert();
    }

    #[test]
    fn resolutions() {
        assert_eq!(parse_resolution("1000,600"), Ok([1000, 600]));
        assert_eq!(parse_resolution("64x48"), Ok([64, 48]));
        for wrong in ["", "3", "0,5", "-1,5", "1,2,3", "65536,65536", "1e3,5"] {
            assert!(parse_resolution(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn counts() {
        assert_eq!(parse_counts("2, 3,1"), Ok([2, 3, 1]));
        for wrong in ["", "2", "2,3", "0,1,1", "-1,1,1", "1,2,3,4", "1.5,1,1", "4294967296,1,1"] {
            assert!(parse_counts(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn directions() {
        assert_eq!(parse_direction("-Z"), Ok(-DVec3::Z));
        assert_eq!(parse_direction("+x"), Ok(DVec3::X));
        assert_eq!(parse_direction("y"), Ok(DVec3::Y));
        assert_eq!(parse_direction("0,-3,0"), Ok(-DVec3::Y));
        for wrong in ["", "+", "0,0,0", "1,2", "nan,0,0", "W", "inf,0,0"] {
            assert!(parse_direction(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn colors() {
        assert_eq!(parse_color("#ff0000"), Ok([1.0, 0.0, 0.0]));
        assert_eq!(parse_color("0,0.5,1"), Ok([0.0, 0.5, 1.0]));
        for wrong in ["#f00", "#+10000", "2,0,0", "-0.1,0,0", "red"] {
            assert!(parse_color(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn negative_directions_are_values_not_flags() {
        let line =
            ["trimray", "render", "a.step", "-o", "a.png", "--camera-direction", "-1,1,-0.5", "--up", "-Z"];
        let arguments = Arguments::try_parse_from(line).expect("parsed");
        let Command::Render(render) = arguments.command else { panic!("a render command") };
        assert_eq!(render.camera.up, -DVec3::Z);
    }
}
