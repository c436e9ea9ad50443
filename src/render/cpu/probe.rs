//! Batches of rays to hits.

use super::hit::{finish_hit, hit_normal};
use super::parity::{Crossing, consistent};
use super::ray_space::{Distance, PreparedRay, prepare};
use super::trace::{RawHit, first_hit, trace};
use super::vector::number;
use super::{Kernel, Precision};
use crate::render::{Exactness, Hit, Ray};
use crate::scene::Scene;
use rayon::prelude::*;

/// Hits kept per ray: more than any model has, little enough to bound memory.
const MAX_HITS: usize = 1 << 16;

/// All hits of each ray, sorted by t; or only the first of each. In f32 where the scene has no f64 arrays.
pub fn probe(scene: &Scene<'_>, rays: &[Ray], precision: Precision, first_only: bool) -> Vec<Vec<Hit>> {
    probe_with(scene, rays, precision, first_only, Exactness::default())
}

/// [`probe`] with the exactness of choice.
pub fn probe_with(
    scene: &Scene<'_>,
    rays: &[Ray],
    precision: Precision,
    first_only: bool,
    exactness: Exactness,
) -> Vec<Vec<Hit>> {
    let exact = precision == Precision::F64 && scene.has_f64();
    rays.par_iter()
        .map(|ray| {
            if exact {
                probe_ray::<f64>(scene, exactness, ray, first_only)
            } else {
                probe_ray::<f32>(scene, exactness, ray, first_only)
            }
        })
        .collect()
}

/// The hits of one ray.
fn probe_ray<T: Kernel>(scene: &Scene<'_>, exactness: Exactness, ray: &Ray, first_only: bool) -> Vec<Hit> {
    let Some(prepared) = prepare::<T>(ray, scene.header) else {
        return Vec::new();
    };
    if first_only {
        let first = first_hit(scene, exactness, &prepared.ray, prepared.near);
        first.iter().map(|hit| finish_hit(scene, hit, prepared.start)).collect()
    } else {
        let hits = all_hits(scene, exactness, &prepared);
        hits.iter().map(|hit| finish_hit(scene, hit, prepared.start)).collect()
    }
}

/// All hits, sorted, each once.
pub fn all_hits<T: Kernel>(
    scene: &Scene<'_>,
    exactness: Exactness,
    prepared: &PreparedRay<T>,
) -> Vec<RawHit<T>> {
    let mut hits: Vec<RawHit<T>> = Vec::new();
    trace(scene, exactness, &prepared.ray, prepared.near, Distance::INFINITE, &mut |hit| {
        hits.push(hit);
        (hits.len() < MAX_HITS).then_some(Distance::INFINITE)
    });
    sort_and_merge(scene, prepared, hits)
}

/// Sorts hits and leaves each once, and those alone that the bodies can have.
pub fn sort_and_merge<T: Kernel>(
    scene: &Scene<'_>,
    prepared: &PreparedRay<T>,
    mut hits: Vec<RawHit<T>>,
) -> Vec<RawHit<T>> {
    // Sums in f64, for differences of pairs are no total order, which sorting needs.
    let order = |a: &RawHit<T>, b: &RawHit<T>| {
        let by_distance = a.distance.to_f64().total_cmp(&b.distance.to_f64());
        by_distance.then(a.face.cmp(&b.face)).then(a.net.cmp(&b.net)).then(a.instance.cmp(&b.instance))
    };
    hits.sort_by(order);
    let crossings = merge_doubles(scene, prepared, hits);
    let hits = consistent(scene, prepared.starts_outside, crossings);
    hits.into_iter().map(|crossing| crossing.hit).collect()
}

/// Leaves one of the certain hits that neighbouring leaves and nets of one face report twice: same face, same facing, and closer together than the
/// face's slack along the ray.
fn merge_doubles<T: Kernel>(
    scene: &Scene<'_>,
    prepared: &PreparedRay<T>,
    hits: Vec<RawHit<T>>,
) -> Vec<Crossing<T>> {
    let mut kept: Vec<Crossing<T>> = Vec::with_capacity(hits.len());
    for hit in hits {
        let facing = hit_normal(scene, &hit).dot(prepared.ray.direction);
        let slack = number::<T>(scene.faces[hit.face as usize].slack.into());
        let tolerance = slack * number(2.0) / facing.abs();
        let mut double = false;
        for other in kept.iter().rev() {
            if hit.distance.minus(other.hit.distance) > tolerance {
                break;
            }
            double |= hit.net != super::NO_NET
                && hit.is_certain
                && other.hit.is_certain
                && other.hit.face == hit.face
                && other.hit.instance == hit.instance
                && (other.facing >= T::ZERO) == (facing >= T::ZERO);
        }
        if !double {
            kept.push(Crossing { hit, facing });
        }
    }
    kept
}
