//! How long each stage from a file to a baked scene takes.
//!
//! Every stage is a call of its own into the rooms that do the work, so that what is measured is what runs. Each is the
//! least time of some repetitions, and so are the sums: what disturbs a run only ever makes it slower.

use crate::bake::{BakeOptions, bake_trimmed, trim};
use crate::import::{ImportError, Source};
use std::path::Path;
use std::time::Instant;

/// Wall-clock times, seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seconds {
    /// The file into memory.
    pub read: f64,
    /// Its statements or records found.
    pub scan: f64,
    /// Every entity that shape refers to decoded once, on one thread, on its own: not a part of the sums, as the
    /// mapping decodes again whatever it reaches.
    pub decode: f64,
    /// Scanned file to model, decoding included.
    pub map: f64,
    /// Edges to parameter planes, loops to regions.
    pub trims: f64,
    /// Nets, leaves, trim trees, BVHs.
    pub bake: f64,
    /// File to model: read, scan, map.
    pub import: f64,
    /// File to baked scene: import, trims, bake.
    pub total: f64,
}

/// The stages of one file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stages {
    /// The file's size.
    pub bytes: usize,
    /// Entities that shape refers to.
    pub entities: usize,
    /// Faces in the model.
    pub faces: usize,
    /// Faces in the scene; a face of a part counts once.
    pub baked_faces: usize,
    /// Times.
    pub seconds: Seconds,
}

impl Seconds {
    fn least(self, other: Self) -> Self {
        Self {
            read: self.read.min(other.read),
            scan: self.scan.min(other.scan),
            decode: self.decode.min(other.decode),
            map: self.map.min(other.map),
            trims: self.trims.min(other.trims),
            bake: self.bake.min(other.bake),
            import: self.import.min(other.import),
            total: self.total.min(other.total),
        }
    }
}

/// Imports and bakes the file `repeat` times (at least once).
///
/// # Errors
/// Those of the import.
pub fn measure_stages(path: &Path, repeat: usize) -> Result<Stages, ImportError> {
    let mut stages = measure_once(path)?;
    for _ in 1..repeat {
        let again = measure_once(path)?;
        stages.seconds = stages.seconds.least(again.seconds);
    }
    Ok(stages)
}

fn measure_once(path: &Path) -> Result<Stages, ImportError> {
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
    let trimmed = trim(&model, &options, &|_, _| {});
    let trims = clock.lap();
    let scene = bake_trimmed(&model, trimmed, &options);
    let bake = clock.lap();
    let import = read + scan + map;
    let seconds = Seconds { read, scan, decode, map, trims, bake, import, total: import + trims + bake };
    Ok(Stages {
        bytes: source.size(),
        entities,
        faces: model.faces.len(),
        baked_faces: scene.faces.len(),
        seconds,
    })
}

struct Clock(Instant);

impl Clock {
    /// Seconds since the last call.
    fn lap(&mut self) -> f64 {
        let now = Instant::now();
        let seconds = now.duration_since(self.0).as_secs_f64();
        self.0 = now;
        seconds
    }
}
