//! What becomes of a ray with an odd number of hits on a closed body, which a line from outside cannot have: it slipped through a gap between the
//! body's faces, or past a tangent or a pole where what was found contradicts itself. A ray beside it, by at most half a pixel of a picture of 2048, does
//! not, and what that one alone meets of the body stands in for what is missing.
//!
//! Certain hits stay what they are, and so does all that the ray meets of other bodies. Gaps are the model's own, wider than the slack of its faces;
//! moved by more than the gap is wide, a ray meets the face on one side of it. Where faces overlap by more than their slack, the inner hit of two is
//! left out. Where a face is missing altogether nothing is found, at a cost of some rays for one.

use super::Kernel;
use super::footprint::sides;
use super::hit::body_of;
use super::parity::{Crossing, consistent, odd_bodies};
use super::probe::{MAX_HITS, met_hits, places};
use super::ray_space::{PreparedRay, scene_radius};
use super::trace::RawHit;
use super::vector::{Vector3, number};
use crate::render::NetSearch;
use crate::scene::Scene;

/// How far aside, in radii of the scene: from what f32 can tell apart to what gaps of real models need, a fortieth of a millimetre in 100.
const DISTANCES: [f64; 3] = [1.0 / 1_048_576.0, 1.0 / 32_768.0, 1.0 / 2_048.0];

/// A certain hit of the ray is the other one's within so many times the distance between them, over |cos| of its angle to the normal.
const SAME_HIT: f64 = 4.0;

/// The hits of a ray.
#[derive(Debug, Clone)]
pub struct Settled<T> {
    /// Along the ray.
    pub crossings: Vec<Crossing<T>>,
    /// How many places of faces it met.
    pub places: usize,
    /// How many of those its bodies can have.
    pub own: usize,
    /// Whether some of the hits are those of a ray beside it, or one was left out where faces overlap.
    pub is_beside: bool,
}

/// The hits that bodies can have, of all that a ray met; with those of rays beside it where it starts outside and a closed body has an odd number.
pub fn settle<T: Kernel>(
    scene: &Scene<'_>,
    search: impl Into<NetSearch>,
    prepared: &PreparedRay<T>,
    met: Vec<RawHit<T>>,
) -> Settled<T> {
    let search = search.into();
    let is_cut = met.len() >= MAX_HITS;
    let met = places(scene, prepared, met);
    let places = met.len();
    let mut crossings = consistent(scene, prepared.starts_outside, met);
    let own = crossings.len();
    let mut is_beside = false;
    if prepared.starts_outside && !is_cut {
        for body in odd_bodies(scene, crossings.iter().map(|c| body_of(scene, &c.hit))) {
            if let Some(others) = beside(scene, search, prepared, body, &crossings) {
                crossings
                    .retain(|crossing| body_of(scene, &crossing.hit) != body || crossing.hit.is_certain());
                crossings.extend(others);
                crossings.sort_by(|a, b| a.hit.distance.to_f64().total_cmp(&b.hit.distance.to_f64()));
                is_beside = true;
            } else if let Some(index) = overlap(scene, body, &crossings) {
                crossings.remove(index);
                is_beside = true;
            }
        }
    }
    Settled { crossings, places, own, is_beside }
}

/// What the nearest ray beside meets of a body beyond the ray's own certain hits of it, all of which it has too, so that both together are even.
fn beside<T: Kernel>(
    scene: &Scene<'_>,
    search: NetSearch,
    prepared: &PreparedRay<T>,
    body: (u32, u32),
    own: &[Crossing<T>],
) -> Option<Vec<Crossing<T>>> {
    let [first, second] = sides(prepared.ray.direction);
    let radius = scene_radius(scene.header);
    let is_of_body = |crossing: &Crossing<T>| body_of(scene, &crossing.hit) == body;
    let certain: Vec<&Crossing<T>> = own.iter().filter(|c| is_of_body(c) && c.hit.is_certain()).collect();
    for distance in DISTANCES {
        for side in [first, -first, second, -second] {
            let moved = moved(prepared, side * number(distance * radius));
            let met = met_hits(scene, search, &moved);
            if met.len() >= MAX_HITS {
                continue;
            }
            let mut others = consistent(scene, true, places(scene, &moved, met));
            others.retain(is_of_body);
            if others.len() % 2 == 1 {
                continue;
            }
            let is_same = |own: &Crossing<T>, other: &Crossing<T>| {
                let apart = own.hit.distance.minus(other.hit.distance).abs() * own.facing.abs();
                own.hit.face == other.hit.face && apart <= number(SAME_HIT * distance * radius)
            };
            let has_all = certain.iter().all(|own| {
                let found = others.iter().position(|other| is_same(own, other));
                found.map(|index| others.remove(index)).is_some()
            });
            if has_all {
                return Some(others);
            }
        }
    }
    None
}

/// Where two faces of a body overlap by more than their slack the ray enters or leaves it twice, certainly and within the greatest of [`DISTANCES`]: which of
/// the hits to leave out of the closest such pair, that inside of the other.
fn overlap<T: Kernel>(scene: &Scene<'_>, body: (u32, u32), crossings: &[Crossing<T>]) -> Option<usize> {
    let own: Vec<usize> =
        (0..crossings.len()).filter(|&k| body_of(scene, &crossings[k].hit) == body).collect();
    let across = |pair: &[usize]| {
        let [first, second] = [&crossings[pair[0]], &crossings[pair[1]]];
        let steepness = first.facing.abs().min(second.facing.abs());
        second.hit.distance.minus(first.hit.distance) * steepness
    };
    let limit = number::<T>(DISTANCES[DISTANCES.len() - 1] * scene_radius(scene.header));
    let enters = |index: usize| crossings[index].facing < T::ZERO;
    own.windows(2)
        .filter(|pair| enters(pair[0]) == enters(pair[1]) && across(pair) <= limit)
        .min_by(|a, b| across(a).to_f64().total_cmp(&across(b).to_f64()))
        .map(|pair| pair[usize::from(enters(pair[0]))])
}

fn moved<T: Kernel>(prepared: &PreparedRay<T>, by: Vector3<T>) -> PreparedRay<T> {
    let mut moved = *prepared;
    moved.ray.fraction = moved.ray.fraction + by;
    moved
}

#[cfg(test)]
mod tests {
    use super::super::probe::probe;
    use super::super::ray_space::prepare;
    use super::super::test_scenes::{TestFace, scene_of};
    use super::*;
    use crate::render::cpu::Precision;
    use crate::render::{Exactness, Ray};
    use crate::scene::{FaceKind, SceneBuffers};
    use glam::{DAffine3, DMat3, DVec3};

    /// Two squares, one above the other, called a closed body; the lower one starts at x = `gap`.
    fn nearly_closed(gap: f64) -> SceneBuffers {
        let square = |low: f64, height: f64, reversed: bool| {
            let face = TestFace::analytic(FaceKind::Plane, [0.0; 2], [low, 0.0], [1.0, 1.0]);
            TestFace { reversed, ..face }.placed(DVec3::Z * height, DMat3::IDENTITY)
        };
        let faces = [square(0.0, 1.0, false), square(gap, 0.0, true)];
        let mut scene = scene_of(&faces, &[DAffine3::IDENTITY]);
        scene.body_infos.iter_mut().for_each(|body| body.is_closed = 1);
        scene
    }

    fn ray_at(x: f64) -> Ray {
        Ray { origin: DVec3::new(x, 0.5, 9.0), direction: DVec3::NEG_Z }
    }

    fn settled_at(scene: &SceneBuffers, x: f64) -> (usize, usize, bool) {
        let scene = scene.scene();
        let prepared = prepare::<f64>(&ray_at(x), scene.header).expect("it meets the scene");
        let met = met_hits(&scene, Exactness::Exact, &prepared);
        let settled = settle(&scene, Exactness::Exact, &prepared, met);
        (settled.own, settled.crossings.len(), settled.is_beside)
    }

    #[test]
    fn a_ray_in_a_gap_is_answered_by_one_beside_it() {
        let scene = nearly_closed(2e-5);
        assert_eq!(settled_at(&scene, 0.5), (2, 2, false));
        assert_eq!(settled_at(&scene, -0.1), (0, 0, false));
        assert_eq!(settled_at(&scene, 1.5e-5), (1, 2, true));
    }

    /// A ray that misses all is even too, but does not have what the ray itself is certain of.
    #[test]
    fn what_is_certain_stays() {
        let scene = nearly_closed(1e-4);
        for x in [3e-5, 5e-5, 9e-5] {
            assert_eq!(settled_at(&scene, x), (1, 2, true), "{x}");
            let hits = |first_only: bool| probe(&scene.scene(), &[ray_at(x)], Precision::F64, first_only);
            let (first, all) = (hits(true), hits(false));
            assert_eq!(first[0], all[0][..1], "{x}");
            assert_eq!(first[0][0].t, 8.0, "{x}");
        }
    }

    #[test]
    fn the_inner_of_two_overlapping_faces_is_left_out() {
        let mut scene = nearly_closed(0.0);
        let third = TestFace::analytic(FaceKind::Plane, [0.0; 2], [0.0; 2], [1.0, 1.0]);
        let faces = [1.0, 1.0 - 1e-4, 0.0].map(|height| {
            let face = TestFace { reversed: height == 0.0, ..third.clone() };
            face.placed(DVec3::Z * height, DMat3::IDENTITY)
        });
        let bodies = scene.body_infos.clone();
        scene = scene_of(&faces, &[DAffine3::IDENTITY]);
        scene.body_infos = bodies;
        assert_eq!(settled_at(&scene, 0.5), (3, 2, true));
        let hits = probe(&scene.scene(), &[ray_at(0.5)], Precision::F64, false);
        assert_eq!(hits[0].iter().map(|hit| hit.t).collect::<Vec<_>>(), [8.0, 9.0]);
    }

    #[test]
    fn what_is_missing_stays_missing() {
        assert_eq!(settled_at(&nearly_closed(0.5), 0.25), (1, 1, false));
    }
}
