//! Rays that start on a surface: from each hit of a ray on, the hits beyond are the same.

use super::sameness::{Sameness, Subject, certain, limit, sameness_rays};
use super::{baked, scene_radius, truth};
use crate::render::cpu::{Precision, probe};
use crate::render::reference::{Reference, widened};
use crate::render::{Hit, Ray};

/// A ray's hits, and those of the ray that starts at one of them.
struct Restart {
    ray: Ray,
    start: f64,
    /// Those of the ray beyond its start.
    beyond: Vec<Hit>,
}

/// Traces the rays of [`measure_sameness`](super::measure_sameness), starts them again at each of their hits, and compares what follows. The hit at
/// the start itself, which rounding may put before or behind it, does not count.
pub fn measure_restarts(subject: &Subject, precision: Precision, first: u64, count: u64) -> Sameness {
    let model = (subject.build)();
    let buffers = baked(&model);
    let scene = buffers.scene();
    let narrow = widened(&scene);
    let reference = Reference::new(truth(&scene, &narrow, precision));
    let rays = sameness_rays(&scene, &model, first, count);
    let found = probe(&scene, &rays, precision, false);
    let mut result = Sameness { rays: count, ..Sameness::default() };
    let mut restarts = Vec::new();
    let is_certain = certain(&reference, &rays);
    for ((&ray, hits), _) in rays.iter().zip(&found).zip(is_certain).filter(|(_, is_certain)| *is_certain) {
        result.certain += 1;
        for (index, hit) in hits.iter().enumerate() {
            restarts.push(Restart { ray, start: hit.t, beyond: hits[index + 1..].to_vec() });
        }
    }
    let moved = |Restart { ray, start, .. }: &Restart| Ray { origin: ray.at(*start), ..*ray };
    let moved: Vec<Ray> = restarts.iter().map(moved).collect();
    let size = 2.0 * scene_radius(&scene);
    for (Restart { ray, start, beyond }, found) in
        restarts.iter().zip(probe(&scene, &moved, precision, false))
    {
        let across = |t: f64, hit: &Hit| t.abs() * hit.normal.dot(ray.direction).abs() / size;
        let is_ahead = |hit: &&Hit| across(hit.t, hit) > limit(precision);
        let found: Vec<&Hit> = found.iter().filter(is_ahead).collect();
        let beyond: Vec<&Hit> =
            beyond.iter().filter(|hit| across(hit.t - start, hit) > limit(precision)).collect();
        let is_turned = |(a, b): (&&Hit, &&Hit)| a.normal.dot(b.normal) < 0.0;
        let is_different = found.len() != beyond.len() || beyond.iter().zip(&found).any(is_turned);
        let pairs = beyond.iter().zip(&found).filter(|_| !is_different);
        let distances: Vec<f64> = pairs.map(|(a, b)| across(a.t - start - b.t, a)).collect();
        result.hits += beyond.len() as u64;
        result.add(ray, is_different, &distances, limit(precision));
    }
    result
}
