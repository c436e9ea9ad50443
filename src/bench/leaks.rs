//! Rays that see an odd number of walls of closed solids: something leaks, or is counted twice.
//!
//! Uniform rays are chords of the scene's bounding sphere; aimed rays pass by edges. Both start outside.

use super::rays::{aimed, chord};
use crate::brep::{Edge, Id, Model, TrimLoop, occurrences};
use crate::render::Ray;
use crate::render::cpu::{Choice, Precision, choices};
use crate::scene::Scene;
use glam::{DAffine3, DVec3};

/// Rays that are traced at once.
const BATCH: u64 = 1 << 14;

/// Points of each edge that rays are aimed at.
const POINTS_OF_EDGE: usize = 64;

/// How many rays were odd.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Leaks {
    /// Rays traced.
    pub rays: u64,
    /// Those with an odd number of hits.
    pub odd: u64,
    /// Those that were odd before hits were left out to make them even.
    pub odd_before: u64,
    /// Rays whose own hits are odd on a closed body, and are made up by those of a ray beside them.
    pub beside: u64,
    /// Hits left out.
    pub left_out: u64,
    /// Rays with two hits at one place of a body and from one side: even, but not right.
    pub repeated: u64,
    /// The first odd rays, as many as asked for.
    pub shown: Vec<Ray>,
}

impl Leaks {
    /// See [`rate_bound`].
    pub fn bound(&self) -> f64 {
        rate_bound(self.rays, self.odd)
    }
}

/// Where `k` of `n` rays were seen to be something, with a confidence of 95 % no more than this share of all such rays is (Wilson's upper
/// bound; three by the number where none was). Of none, all may be so.
pub fn rate_bound(n: u64, k: u64) -> f64 {
    let (n, p) = (n.max(1) as f64, k as f64 / n.max(1) as f64);
    if k == 0 {
        return (3.0 / n).min(1.0);
    }
    let z = 1.96;
    let spread = z * (p * (1.0 - p) / n + z * z / (4.0 * n * n)).sqrt();
    (p + z * z / (2.0 * n) + spread) / (1.0 + z * z / n)
}

/// Whether the scene is made of closed solids alone, with all faces of its model: then all rays from outside have an even number of hits.
pub fn is_closed(model: &Model, scene: &Scene<'_>) -> bool {
    let bodies = scene.body_infos;
    model.declared_faces == model.faces.len()
        && !bodies.is_empty()
        && bodies.iter().all(|body| body.is_closed())
}

/// Points on the edges of every occurrence of a part, world space.
pub fn edge_points(model: &Model) -> Vec<DVec3> {
    let mut edges_of_part = std::collections::HashMap::new();
    let mut points = Vec::new();
    for occurrence in occurrences(model).0 {
        let edges: &Vec<_> = edges_of_part.entry(occurrence.part).or_insert_with(|| {
            let bodies = model.parts[occurrence.part].bodies.iter();
            let loops = bodies.flat_map(|body| &body.faces).flat_map(|&face| &model.faces[face].loops);
            let mut edges: Vec<Id<Edge>> = Vec::new();
            for trim_loop in loops {
                if let TrimLoop::Edges(coedges) = trim_loop {
                    edges.extend(coedges.iter().map(|coedge| coedge.edge));
                }
            }
            edges.sort_unstable_by_key(|edge| edge.index());
            edges.dedup();
            edges
        });
        let place = |world: &DAffine3, point: DVec3| world.transform_point3(point);
        for &edge in edges {
            let edge = &model.edges[edge];
            for i in 0..=POINTS_OF_EDGE {
                let share = i as f64 / POINTS_OF_EDGE as f64;
                let t = edge.range[0] + (edge.range[1] - edge.range[0]) * share;
                points.push(place(&occurrence.world_from_part, edge.curve.point(t)));
            }
        }
    }
    points
}

/// Odd rays among `count` chords, from number `first` on; keeps `show` of them.
pub fn count_uniform_leaks(
    scene: &Scene<'_>,
    precision: Precision,
    first: u64,
    count: u64,
    show: usize,
) -> Leaks {
    count_odd(scene, precision, first, count, show, &|index| chord(scene, index))
}

/// Odd rays among `count` rays that are aimed at `points`, of which there is at least one.
pub fn count_aimed_leaks(
    scene: &Scene<'_>,
    precision: Precision,
    points: &[DVec3],
    first: u64,
    count: u64,
    show: usize,
) -> Leaks {
    count_odd(scene, precision, first, count, show, &|index| aimed(scene, points, index))
}

fn count_odd(
    scene: &Scene<'_>,
    precision: Precision,
    first: u64,
    count: u64,
    show: usize,
    ray: &dyn Fn(u64) -> Ray,
) -> Leaks {
    let mut leaks = Leaks { rays: count, ..Leaks::default() };
    for start in (first..first + count).step_by(BATCH as usize) {
        let rays: Vec<Ray> = (start..(start + BATCH).min(first + count)).map(ray).collect();
        for (ray, choice) in rays.iter().zip(choices(scene, &rays, precision)) {
            let Choice { places, own, hits, is_repeated, is_beside } = choice;
            leaks.odd += (hits % 2) as u64;
            leaks.odd_before += (places % 2) as u64;
            leaks.left_out += (places - own) as u64;
            leaks.beside += u64::from(is_beside);
            leaks.repeated += u64::from(is_repeated);
            if hits % 2 == 1 && leaks.shown.len() < show {
                leaks.shown.push(*ray);
            }
        }
    }
    leaks
}

#[cfg(test)]
mod tests {
    use super::rate_bound;

    #[test]
    fn a_bound_is_a_share() {
        assert_eq!([rate_bound(0, 0), rate_bound(1, 0), rate_bound(3000, 0)], [1.0, 1.0, 1e-3]);
        let some = rate_bound(100, 7);
        assert!(some > 0.07 && some < 0.15, "{some}");
    }
}
