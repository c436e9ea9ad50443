//! `trimray bench rays`: the first hits of given rays, timed.

use super::args::General;
use super::args_bench::BenchRays;
use super::load::{Purpose, load};
use super::ray_lines::RayLines;
use crate::bench::measure_first_hits;
use crate::render::Ray;
use serde::Serialize;
use std::io::Write;
use std::path::Path;

/// A line of JSON. Names of fields stay.
#[derive(Serialize)]
struct Line<'a> {
    file: std::borrow::Cow<'a, str>,
    threads: usize,
    rays: usize,
    hits: usize,
    /// The least time.
    seconds: f64,
    median_seconds: f64,
}

pub(super) fn run(command: &BenchRays, general: &General) -> anyhow::Result<()> {
    let rays = all_rays(&command.rays)?;
    let threads = rayon::current_num_threads();
    let mut out = std::io::stdout().lock();
    for path in &command.inputs {
        let loaded = load(path, Purpose::default(), general)?;
        let times = measure_first_hits(&loaded.scene(), &rays, usize::from(command.repeat));
        let (hits, seconds, median_seconds) = (times.hits, times.least, times.median);
        let file = path.to_string_lossy();
        if command.json {
            let line = Line { file, threads, rays: rays.len(), hits, seconds, median_seconds };
            serde_json::to_writer(&mut out, &line).map_err(std::io::Error::from)?;
            writeln!(out)?;
        } else {
            let rate = rays.len() as f64 * 1e-6 / seconds.max(1e-9);
            let [least, median] = [seconds, median_seconds].map(|seconds| seconds * 1e3);
            writeln!(out, "{file}: {} rays, {hits} of them hit, threads: {threads}", rays.len())?;
            writeln!(out, "  {rate:.2} Mrays/s: {least:.2} ms, in the median {median:.2} ms")?;
        }
        out.flush()?;
    }
    Ok(())
}

fn all_rays(path: &Path) -> anyhow::Result<Vec<Ray>> {
    let mut lines = RayLines::open(path)?;
    let mut rays = Vec::new();
    loop {
        let batch = lines.batch();
        batch.end?;
        if batch.rays.is_empty() {
            anyhow::ensure!(!rays.is_empty(), "{}: there is no ray in it", path.display());
            return Ok(rays);
        }
        rays.extend(batch.rays);
    }
}
