//! Batches of rays to hits.

use super::beside::settle;
use super::footprint::{LONGEST, same_place};
use super::hit::{finish_hit, hit_normal, world_slack};
use super::packet::{LANES, Packet, Segment, first_hits};
use super::parity::{Crossing, consistent};
use super::ray_space::{Distance, PreparedRay, place, prepare, scene_radius};
use super::trace::{Certainty, RawHit, first_hit, trace};
use super::vector::number;
use super::{Kernel, NO_NET, Precision};
use crate::render::{Exactness, Hit, NetSearch, Ray};
use crate::scene::Scene;
use rayon::prelude::*;

/// Hits kept per ray: more than any model has, little enough to bound memory.
pub const MAX_HITS: usize = 1 << 16;

/// All hits of each ray, sorted by t; or only the first of each, which is the first of all (in f32 of those that are as far but for roundings either one). In f32
/// where the scene has no f64 arrays.
pub fn probe(scene: &Scene<'_>, rays: &[Ray], precision: Precision, first_only: bool) -> Vec<Vec<Hit>> {
    probe_with(scene, rays, precision, first_only, Exactness::default())
}

/// All hits of each ray as [`probe`] has them, but without the help of rays beside it: what the tracer itself finds.
pub fn probe_alone(
    scene: &Scene<'_>,
    rays: &[Ray],
    precision: Precision,
    search: impl Into<NetSearch>,
) -> Vec<Vec<Hit>> {
    let search = search.into();
    of_each(
        scene,
        rays,
        precision,
        |ray| alone::<f64>(scene, search, ray),
        |ray| alone::<f32>(scene, search, ray),
    )
}

/// What `wide` says of each ray, or `narrow` where f64 is not asked for or the scene has none.
pub fn of_each<R: Send>(
    scene: &Scene<'_>,
    rays: &[Ray],
    precision: Precision,
    wide: impl Fn(&Ray) -> R + Sync,
    narrow: impl Fn(&Ray) -> R + Sync,
) -> Vec<R> {
    let exact = precision == Precision::F64 && scene.has_f64();
    rays.par_iter().map(|ray| if exact { wide(ray) } else { narrow(ray) }).collect()
}

fn alone<T: Kernel>(scene: &Scene<'_>, search: NetSearch, ray: &Ray) -> Vec<Hit> {
    let Some(prepared) = prepare::<T>(ray, scene.header) else { return Vec::new() };
    let hits = consistent_hits(scene, &prepared, met_hits(scene, search, &prepared));
    hits.iter().map(|hit| finish_hit(scene, hit, prepared.start)).collect()
}

/// Those that bodies can have, of all that were met.
pub fn consistent_hits<T: Kernel>(
    scene: &Scene<'_>,
    prepared: &PreparedRay<T>,
    met: Vec<RawHit<T>>,
) -> Vec<RawHit<T>> {
    let crossings = consistent(scene, prepared.starts_outside, places(scene, prepared, met));
    crossings.into_iter().map(|crossing| crossing.hit).collect()
}

/// [`probe`] with the search of choice.
pub fn probe_with(
    scene: &Scene<'_>,
    rays: &[Ray],
    precision: Precision,
    first_only: bool,
    search: impl Into<NetSearch>,
) -> Vec<Vec<Hit>> {
    let search = search.into();
    let wide = |ray: &Ray| probe_ray::<f64>(scene, search, ray, first_only);
    of_each(scene, rays, precision, wide, |ray| probe_ray::<f32>(scene, search, ray, first_only))
}

/// How far each ray goes to its first hit, as pictures take it: in f32, and whatever the bodies can have. Infinite where it meets nothing.
pub fn first_distances(scene: &Scene<'_>, rays: &[Ray]) -> Vec<f64> {
    let radius = scene_radius(scene.header);
    let mut distances = vec![f64::INFINITY; rays.len()];
    distances.par_chunks_mut(LANES).zip(rays.par_chunks(LANES)).for_each(|(distances, rays)| {
        let mut packet = Packet::default();
        let mut starts = [0.0; LANES];
        for (lane, ray) in rays.iter().enumerate() {
            if let Some(prepared) = place::<f32>(ray, scene.header, radius) {
                packet.put(lane, &Segment::of(&prepared));
                starts[lane] = prepared.start;
            }
        }
        let hits = first_hits(scene, Exactness::default(), &packet);
        for (distance, (start, first)) in distances.iter_mut().zip(starts.iter().zip(&hits)) {
            if let Some(first) = first {
                *distance = start + first.hit.distance.to_f64();
            }
        }
    });
    distances
}

/// The hits of one ray.
fn probe_ray<T: Kernel>(scene: &Scene<'_>, search: NetSearch, ray: &Ray, first_only: bool) -> Vec<Hit> {
    let Some(prepared) = prepare::<T>(ray, scene.header) else {
        return Vec::new();
    };
    let hits = if first_only {
        let first = first_hit(scene, search, &prepared.ray, prepared.near);
        match first.map(|hit| T::polished(scene, &prepared.ray, hit)) {
            Some(first) if !first.is_certain() => {
                let met = met_hits(scene, search, &prepared);
                // Of more hits than are kept the first may be missing.
                let is_cut = met.len() == MAX_HITS;
                let all = if is_cut { vec![first] } else { settled(scene, search, &prepared, met) };
                all.into_iter().take(1).collect()
            }
            first => first.into_iter().collect(),
        }
    } else {
        settled(scene, search, &prepared, met_hits(scene, search, &prepared))
    };
    hits.iter().map(|hit| finish_hit(scene, hit, prepared.start)).collect()
}

/// The hits of the answer, of all that were met.
pub fn settled<T: Kernel>(
    scene: &Scene<'_>,
    search: impl Into<NetSearch>,
    prepared: &PreparedRay<T>,
    met: Vec<RawHit<T>>,
) -> Vec<RawHit<T>> {
    settle(scene, search, prepared, met).crossings.into_iter().map(|crossing| crossing.hit).collect()
}

/// All hits as they are met.
pub fn met_hits<T: Kernel>(
    scene: &Scene<'_>,
    search: impl Into<NetSearch>,
    prepared: &PreparedRay<T>,
) -> Vec<RawHit<T>> {
    let mut hits: Vec<RawHit<T>> = Vec::new();
    trace(scene, search, &prepared.ray, prepared.near, Distance::INFINITE, &mut |candidate| {
        hits.push(T::polished(scene, &prepared.ray, candidate.hit));
        (hits.len() < MAX_HITS).then_some(Distance::INFINITE)
    });
    if hits.len() == MAX_HITS {
        hits.iter_mut().for_each(|hit| hit.certainty = Certainty::Border);
    }
    hits
}

/// Sorts hits and leaves one for each place where the ray passes a face from one side.
///
/// Neighbouring leaves and nets find one hit each where they meet, as many as share a corner or a pole, and along a tangent every search ends at another
/// point of the stretch in which the face is within its slack of the ray. A hit is at the place of another if it is at that of
/// its last one, so that a stretch is one place as long as the searches leave no wider gaps. Of hits at one place the first of the surest stays.
pub fn places<T: Kernel>(
    scene: &Scene<'_>,
    prepared: &PreparedRay<T>,
    mut hits: Vec<RawHit<T>>,
) -> Vec<Crossing<T>> {
    // Sums in f64, for differences of pairs are no total order, which sorting needs.
    let order = |a: &RawHit<T>, b: &RawHit<T>| {
        let by_distance = a.distance.to_f64().total_cmp(&b.distance.to_f64());
        by_distance.then(a.face.cmp(&b.face)).then(a.net.cmp(&b.net)).then(a.instance.cmp(&b.instance))
    };
    hits.sort_by(order);
    let mut kept: Vec<Crossing<T>> = Vec::with_capacity(hits.len());
    // By index in `kept`: the last hit of the place.
    let mut last: Vec<Crossing<T>> = Vec::with_capacity(hits.len());
    // Places of nets that a next hit may still be at.
    let mut open: Vec<usize> = Vec::new();
    for hit in hits {
        let own = Crossing { hit, facing: hit_normal(scene, &hit).dot(prepared.ray.direction) };
        let apart = |other: &Crossing<T>| hit.distance.minus(other.hit.distance);
        open.retain(|&k| apart(&last[k]) <= world_slack(scene, &last[k].hit) * number(2.0 * LONGEST));
        let (is_of_net, slack) = (hit.net != NO_NET, world_slack(scene, &hit));
        let is_same = |other: &Crossing<T>| {
            is_of_net
                && other.hit.face == hit.face
                && other.hit.instance == hit.instance
                && same_place(apart(other), own.facing, other.facing, slack)
        };
        match open.iter().rev().copied().find(|&k| is_same(&last[k])) {
            Some(place) => {
                last[place] = own;
                if hit.certainty < kept[place].hit.certainty {
                    kept[place] = own;
                }
            }
            None => {
                if is_of_net {
                    open.push(kept.len());
                }
                kept.push(own);
                last.push(own);
            }
        }
    }
    kept.sort_by(|a, b| order(&a.hit, &b.hit));
    kept
}
