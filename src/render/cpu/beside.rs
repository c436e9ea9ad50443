//! What becomes of a ray that leaves a closed body less often than it enters, or more often: it slipped through a gap between the body's faces, or past
//! a tangent or a pole where what was found contradicts itself. A ray beside it, by less than half a pixel of a picture of 4096, does not.
//!
//! Gaps are the model's own, wider than the slack of its faces; moved by more than the gap is wide, a ray meets the face on one side of it. Such rays are
//! few, one in 10⁵ of those aimed at the edges of models with gaps, so that the cost does not matter.

use super::Kernel;
use super::footprint::sides;
use super::parity::{Crossing, consistent, leaves_as_often_as_it_enters};
use super::probe::{MAX_HITS, met_hits, places};
use super::ray_space::{PreparedRay, scene_radius};
use super::trace::RawHit;
use super::vector::{Vector3, number};
use crate::render::NetSearch;
use crate::scene::Scene;

/// How far aside, in radii of the scene: from what f32 can tell apart to what gaps of real models need, a fortieth of a millimetre in 100.
const DISTANCES: [f64; 4] = [1.0 / 1_048_576.0, 1.0 / 131_072.0, 1.0 / 16_384.0, 1.0 / 4_096.0];

/// The hits of a ray.
#[derive(Debug, Clone)]
pub struct Settled<T> {
    /// Along the ray.
    pub crossings: Vec<Crossing<T>>,
    /// Whether they are those of a ray beside it.
    pub is_beside: bool,
}

/// The hits that bodies can have, of all that a ray met: where it starts outside and a closed body has an odd number of them, those of the nearest ray
/// beside it with which no body has.
pub fn settle<T: Kernel>(
    scene: &Scene<'_>,
    search: impl Into<NetSearch>,
    prepared: &PreparedRay<T>,
    met: Vec<RawHit<T>>,
) -> Settled<T> {
    let search = search.into();
    let is_cut = met.len() >= MAX_HITS;
    let consistent_hits = |ray: &PreparedRay<T>, met: Vec<RawHit<T>>| {
        consistent(scene, ray.starts_outside, places(scene, ray, met))
    };
    let is_even = |crossings: &[Crossing<T>]| {
        leaves_as_often_as_it_enters(scene, crossings.iter().map(|c| (c.hit.instance, c.hit.face)))
    };
    let own = consistent_hits(prepared, met);
    if !prepared.starts_outside || is_cut || is_even(&own) {
        return Settled { crossings: own, is_beside: false };
    }
    let [first, second] = sides(prepared.ray.direction);
    let radius = scene_radius(scene.header);
    for distance in DISTANCES {
        for side in [first, -first, second, -second] {
            let moved = moved(prepared, side * number(distance * radius));
            let crossings = consistent_hits(&moved, met_hits(scene, search, &moved));
            if is_even(&crossings) {
                return Settled { crossings, is_beside: true };
            }
        }
    }
    Settled { crossings: own, is_beside: false }
}

fn moved<T: Kernel>(prepared: &PreparedRay<T>, by: Vector3<T>) -> PreparedRay<T> {
    let mut moved = *prepared;
    moved.ray.fraction = moved.ray.fraction + by;
    moved
}

#[cfg(test)]
mod tests {
    use super::super::ray_space::prepare;
    use super::super::test_scenes::{TestFace, scene_of};
    use super::*;
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
        scene.metadata.bodies.iter_mut().for_each(|body| body.is_closed = true);
        scene
    }

    fn settled_at(scene: &SceneBuffers, x: f64) -> (usize, bool) {
        let scene = scene.scene();
        let ray = Ray { origin: DVec3::new(x, 0.5, 9.0), direction: DVec3::NEG_Z };
        let prepared = prepare::<f64>(&ray, scene.header).expect("it meets the scene");
        let met = met_hits(&scene, Exactness::Exact, &prepared);
        let settled = settle(&scene, Exactness::Exact, &prepared, met);
        (settled.crossings.len(), settled.is_beside)
    }

    #[test]
    fn a_ray_in_a_gap_is_answered_by_one_beside_it() {
        let scene = nearly_closed(2e-5);
        assert_eq!(settled_at(&scene, 0.5), (2, false));
        assert_eq!(settled_at(&scene, -0.1), (0, false));
        let (hits, is_beside) = settled_at(&scene, 1e-5);
        assert!(is_beside && hits % 2 == 0, "{hits}");
    }

    #[test]
    fn what_is_missing_stays_missing() {
        assert_eq!(settled_at(&nearly_closed(0.5), 0.25), (1, false));
    }
}
