//! The same queries on a GPU, by the kernels' own trim functions.

use super::measure::{DeviceMeasure, QuerySet, rate};
use crate::bench::frames::WARM_UP_SECONDS;
use crate::render::gpu::{Gpu, TrimQuery};
use crate::scene::Scene;
use std::time::Instant;

/// How often all queries are asked in a run: one round of a fast device is as short as what surrounds it.
const ROUNDS: usize = 16;

/// How fast the GPU's kernel answers `set`, which the device holds, and how often otherwise than `expected`.
///
/// # Errors
///
/// The device's own.
pub fn measure_on_gpu(
    gpu: &Gpu,
    scene: &Scene<'_>,
    set: &QuerySet,
    expected: &[bool],
    runs: usize,
) -> Result<DeviceMeasure, String> {
    let uploaded = gpu.upload(scene).map_err(|error| error.to_string())?;
    let root = |face: u32| scene.faces[face as usize].trim_root;
    let queries: Vec<TrimQuery> = (set.queries.iter())
        .map(|query| TrimQuery { uv: query.uv, root: root(query.face), reserved: 0 })
        .collect();
    let answers = gpu.trim_inside(&uploaded, &queries).map_err(|error| error.to_string())?;
    let different = answers.iter().zip(expected).filter(|(answer, expected)| answer != expected).count();
    let held = gpu.hold_queries(&uploaded, &queries).map_err(|error| error.to_string())?;
    // What failed now would have failed before.
    let ask = || gpu.run_held(&uploaded, &held, ROUNDS).map_or(0, |()| queries.len());
    let clock = Instant::now();
    while clock.elapsed().as_secs_f64() < WARM_UP_SECONDS {
        ask();
    }
    Ok(DeviceMeasure { trims: rate(queries.len() * ROUNDS, runs, ask), different: different as u64 })
}
