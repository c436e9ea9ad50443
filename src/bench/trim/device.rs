//! The same queries on a GPU, by the kernels' own trim functions.

use super::measure::{DeviceMeasure, QuerySet, rate};
use crate::bench::frames::WARM_UP_SECONDS;
use crate::render::gpu::{Gpu, TrimQuery};
use crate::scene::Scene;
use std::cell::RefCell;
use std::time::Instant;

/// How often all queries are asked in a run, and how many a hardware device holds at least, the same ones again and again: less is as short as what
/// surrounds it.
const ROUNDS: usize = 16;
const LEAST_HELD: usize = 1 << 22;

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
    let least = if gpu.is_software() { 0 } else { LEAST_HELD };
    let count = if queries.is_empty() { 0 } else { least.max(queries.len()) };
    let repeated: Vec<TrimQuery> = queries.iter().copied().cycle().take(count).collect();
    let held = gpu.hold_queries(&uploaded, &repeated).map_err(|error| error.to_string())?;
    let failure = RefCell::new(None);
    let ask = || match gpu.run_held(&uploaded, &held, ROUNDS) {
        Ok(()) => count,
        Err(error) => {
            failure.borrow_mut().get_or_insert(error);
            0
        }
    };
    let clock = Instant::now();
    while clock.elapsed().as_secs_f64() < WARM_UP_SECONDS && failure.borrow().is_none() {
        ask();
    }
    let trims = rate(count * ROUNDS, runs, ask);
    if let Some(error) = failure.take() {
        return Err(error.to_string());
    }
    Ok(DeviceMeasure { trims, different: different as u64 })
}
