//! How fast the first hits of given rays are found on the CPU, by nothing but the tracer: what other tracers can be asked too.

use super::stages::Clock;
use crate::render::Ray;
use crate::render::cpu::first_distances;
use crate::scene::Scene;
use std::time::Instant;

/// Seconds for all rays, and how many of them hit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FirstHitTimes {
    /// The least of all runs.
    pub least: f64,
    /// Their median.
    pub median: f64,
    /// Rays that hit something.
    pub hits: usize,
}

/// Traces the rays on all threads once more than `repeat` times, at least twice; the first does not count.
pub fn measure_first_hits(scene: &Scene<'_>, rays: &[Ray], repeat: usize) -> FirstHitTimes {
    let found = first_distances(scene, rays);
    let hits = found.iter().filter(|distance| distance.is_finite()).count();
    let mut clock = Clock(Instant::now());
    let mut run = || {
        clock.lap();
        std::hint::black_box(first_distances(scene, rays));
        clock.lap()
    };
    let mut times: Vec<f64> = (0..repeat.max(1)).map(|_| run()).collect();
    times.sort_by(f64::total_cmp);
    FirstHitTimes { least: times[0], median: times[times.len() / 2], hits }
}
