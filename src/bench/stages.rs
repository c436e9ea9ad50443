//! How long each stage takes from a file to a picture.
//!
//! Every stage is a call of its own into the rooms that do the work, so that what is measured is what runs. Each has the
//! least time of some repetitions and their median, and so have the sums: what disturbs a run only ever makes it slower.

use super::chord;
use crate::bake::{BakeOptions, bake_timed, replicate_side_by_side, trim};
use crate::brep::ReplicateError;
use crate::cache::{CacheError, CacheFile, Key, Provenance, Store, write};
use crate::import::{ImportError, Source};
use crate::render::cpu::{Precision, probe};
use crate::scene::SceneBuffers;
use std::collections::BTreeMap;
use std::path::Path;
use std::time::Instant;

/// A stage, in the order in which they happen.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// The file into memory.
    Read,
    /// Its statements or records found.
    Scan,
    /// Every entity that shape refers to decoded once, on one thread, on its own: not a part of the sums, as the
    /// mapping decodes again whatever it reaches.
    Decode,
    /// Scanned file to model, decoding included.
    Map,
    /// File to model: read, scan, map.
    Import,
    /// Edges to parameter planes, loops to regions.
    Trims,
    /// Trim trees, on all threads' shares: a part of [`Stage::Bake`], as are the next three.
    TrimTrees,
    /// Bézier nets, likewise.
    Nets,
    /// Leaves, likewise.
    Leaves,
    /// BVHs.
    Bvhs,
    /// Trimmed model to scene.
    Bake,
    /// File to baked scene: import, trims, bake.
    Total,
    /// The scene to a `.trimray` file.
    Write,
    /// The file mapped and validated.
    Open,
    /// The first ray traced through the mapped file, after opening it anew.
    FirstRay,
    /// The same of a scene that was kept, and is not validated again.
    KeptFirstRay,
    /// The scene to the device.
    Upload,
    /// A picture of one pixel: on a GPU its kernels are compiled for the scene.
    Compile,
    /// The first whole picture.
    FirstFrame,
    /// The next ones.
    Frame,
    /// A ray through each sample of each pixel, all light but that of the sky.
    Primary,
    /// The first hits of chords of the scene's sphere.
    Random,
    /// A GPU's kernel alone: the first hits of primary rays that it holds.
    PrimaryKernel,
    /// The same of random rays.
    RandomKernel,
}

impl Stage {
    /// All, in order.
    pub const ALL: [Self; 24] = [
        Self::Read,
        Self::Scan,
        Self::Decode,
        Self::Map,
        Self::Import,
        Self::Trims,
        Self::TrimTrees,
        Self::Nets,
        Self::Leaves,
        Self::Bvhs,
        Self::Bake,
        Self::Total,
        Self::Write,
        Self::Open,
        Self::FirstRay,
        Self::KeptFirstRay,
        Self::Upload,
        Self::Compile,
        Self::FirstFrame,
        Self::Frame,
        Self::Primary,
        Self::Random,
        Self::PrimaryKernel,
        Self::RandomKernel,
    ];

    /// For JSON.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Read => "read",
            Self::Scan => "scan",
            Self::Decode => "decode",
            Self::Map => "map",
            Self::Import => "import",
            Self::Trims => "trims",
            Self::TrimTrees => "trim_trees",
            Self::Nets => "nets",
            Self::Leaves => "leaves",
            Self::Bvhs => "bvhs",
            Self::Bake => "bake",
            Self::Total => "total",
            Self::Write => "write",
            Self::Open => "open",
            Self::FirstRay => "first_ray",
            Self::KeptFirstRay => "kept_first_ray",
            Self::Upload => "upload",
            Self::Compile => "compile",
            Self::FirstFrame => "first_frame",
            Self::Frame => "frame",
            Self::Primary => "primary",
            Self::Random => "random",
            Self::PrimaryKernel => "primary_kernel",
            Self::RandomKernel => "random_kernel",
        }
    }

    /// For people.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Decode => "decode, on its own",
            Self::Map => "map, which decodes too",
            Self::Import => "file to model",
            Self::TrimTrees => "  trim trees",
            Self::Nets => "  nets",
            Self::Leaves => "  leaves",
            Self::Bvhs => "  BVHs",
            Self::Total => "file to baked scene",
            Self::FirstRay => "open, first ray",
            Self::KeptFirstRay => "find kept, first ray",
            Self::FirstFrame => "first frame",
            Self::Frame => "steady frame",
            Self::Primary => "primary rays",
            Self::Random => "random rays",
            Self::PrimaryKernel => "primary rays, kernel",
            Self::RandomKernel => "random rays, kernel",
            _ => self.name(),
        }
    }
}

/// The times of stages, seconds, one for each repetition.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StageTimes(BTreeMap<Stage, Vec<f64>>);

impl StageTimes {
    /// One more.
    pub fn add(&mut self, stage: Stage, seconds: f64) {
        self.0.entry(stage).or_default().push(seconds);
    }

    /// The least, if any.
    pub fn least(&self, stage: Stage) -> Option<f64> {
        self.0.get(&stage)?.iter().copied().reduce(f64::min)
    }

    /// The one in the middle, if any.
    pub fn median(&self, stage: Stage) -> Option<f64> {
        let mut times = self.0.get(&stage)?.clone();
        times.sort_by(f64::total_cmp);
        times.get(times.len() / 2).copied()
    }
}

/// The stages of one file up to its scene.
#[derive(Debug)]
pub struct Stages {
    /// The file's size.
    pub bytes: usize,
    /// Entities that shape refers to.
    pub entities: usize,
    /// Faces in the model.
    pub faces: usize,
    /// The `.trimray` file's size.
    pub cache_bytes: u64,
    /// What was baked.
    pub scene: SceneBuffers,
    /// Times.
    pub times: StageTimes,
}

/// Why there are no measurements.
#[derive(Debug, thiserror::Error)]
pub enum StagesError {
    /// The file cannot be imported.
    #[error(transparent)]
    Import(#[from] ImportError),
    /// There cannot be so many copies.
    #[error(transparent)]
    Replicate(#[from] ReplicateError),
    /// The baked scene cannot be written or read.
    #[error(transparent)]
    Cache(#[from] CacheError),
}

/// Imports, bakes, writes and opens the file `repeat` times (at least once), as `copies` along each axis. The baked scene is left in `scratch`.
///
/// # Errors
/// Those of the import, of replication and of the cache.
pub fn measure_stages(
    path: &Path,
    scratch: &Path,
    copies: u32,
    repeat: usize,
) -> Result<Stages, StagesError> {
    let mut times = StageTimes::default();
    let mut stages = measure_once(path, scratch, copies, &mut times)?;
    for _ in 1..repeat {
        stages = measure_once(path, scratch, copies, &mut times)?;
    }
    Ok(Stages { times, ..stages })
}

fn measure_once(
    path: &Path,
    scratch: &Path,
    copies: u32,
    times: &mut StageTimes,
) -> Result<Stages, StagesError> {
    let mut clock = Clock(Instant::now());
    let source = Source::open(path)?;
    let read = clock.lap();
    let scanned = source.scan()?;
    let scan = clock.lap();
    let entities = scanned.decode();
    let decode = clock.lap();
    let model = scanned.map();
    let map = clock.lap();
    let options = BakeOptions::default();
    let model = if copies > 1 { replicate_side_by_side(model, [copies; 3], &options)? } else { model };
    clock.lap();
    let trimmed = trim(&model, &options, &|_, _| {});
    let trims = clock.lap();
    let (scene, steps) = bake_timed(&model, trimmed, &options);
    let bake = clock.lap();
    let threads = rayon::current_num_threads() as f64;
    let import = read + scan + map;
    for (stage, seconds) in [
        (Stage::Read, read),
        (Stage::Scan, scan),
        (Stage::Decode, decode),
        (Stage::Map, map),
        (Stage::Import, import),
        (Stage::Trims, trims),
        (Stage::TrimTrees, steps.trim_trees / threads),
        (Stage::Nets, steps.nets / threads),
        (Stage::Leaves, steps.leaves / threads),
        (Stage::Bvhs, steps.bvhs),
        (Stage::Bake, bake),
        (Stage::Total, import + trims + bake),
    ] {
        times.add(stage, seconds);
    }
    let cache_bytes = measure_cache(&scene, scratch, times)?;
    Ok(Stages {
        bytes: source.size(),
        entities,
        faces: model.faces.len(),
        cache_bytes,
        scene,
        times: StageTimes::default(),
    })
}

/// Writes the scene, opens it, and opens it once more and traces a ray, as a file and as a scene that was kept; the file's size.
fn measure_cache(scene: &SceneBuffers, scratch: &Path, times: &mut StageTimes) -> Result<u64, CacheError> {
    let mut clock = Clock(Instant::now());
    write(scratch, &scene.scene(), &Provenance::default())?;
    times.add(Stage::Write, clock.lap());
    drop(CacheFile::open(scratch)?);
    times.add(Stage::Open, clock.lap());
    let file = CacheFile::open(scratch)?;
    trace_one(&file);
    times.add(Stage::FirstRay, clock.lap());
    let (store, key) = (Store::private(scratch.with_extension("kept")), Key::new([0; 32], ""));
    store.keep(&key, &scene.scene(), &Provenance::default())?;
    clock.lap();
    if let Some(kept) = store.find(&key) {
        trace_one(&kept);
        times.add(Stage::KeptFirstRay, clock.lap());
    }
    Ok(file.bytes())
}

fn trace_one(file: &CacheFile) {
    let ray = chord(&file.scene(), 0);
    std::hint::black_box(probe(&file.scene(), &[ray], Precision::F32, true));
}

/// The exponent e of `time ≈ c · size^e` by least squares of the logarithms; nothing from less than two sizes.
pub fn growth_exponent(points: &[[f64; 2]]) -> Option<f64> {
    let logarithms: Vec<[f64; 2]> =
        points.iter().filter(|p| p[0] > 0.0 && p[1] > 0.0).map(|p| p.map(f64::ln)).collect();
    let count = logarithms.len() as f64;
    let mean = [0, 1].map(|k| logarithms.iter().map(|p| p[k]).sum::<f64>() / count);
    let moment = |k: usize| logarithms.iter().map(|p| (p[0] - mean[0]) * (p[k] - mean[k])).sum::<f64>();
    let spread = moment(0);
    (spread > 0.0).then(|| moment(1) / spread)
}

/// Reads off laps.
pub(super) struct Clock(pub(super) Instant);

impl Clock {
    /// Seconds since the last call.
    pub(super) fn lap(&mut self) -> f64 {
        let now = Instant::now();
        let seconds = now.duration_since(self.0).as_secs_f64();
        self.0 = now;
        seconds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponents_are_those_of_powers() {
        let power = |e: f64| [1.0, 8.0, 64.0].map(|n: f64| [n, 0.3 * n.powf(e)]);
        for e in [0.0, 1.0, 1.5] {
            let found = growth_exponent(&power(e)).expect("three sizes");
            assert!((found - e).abs() < 1e-12, "{found} {e}");
        }
        assert_eq!(growth_exponent(&[[5.0, 1.0], [5.0, 2.0]]), None);
    }

    #[test]
    fn the_least_and_the_middle_are_told() {
        let mut times = StageTimes::default();
        [3.0, 1.0, 2.0].into_iter().for_each(|seconds| times.add(Stage::Bake, seconds));
        assert_eq!((times.least(Stage::Bake), times.median(Stage::Bake)), (Some(1.0), Some(2.0)));
        assert_eq!(times.least(Stage::Nets), None);
    }
}
