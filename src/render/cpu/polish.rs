//! What f32 rounds on the way to a hit, taken out again in f64.
//!
//! An error e of a surface's position moves a hit by `e / |cos|` along the ray, so that of the hits that f32 finds those near a tangent are off by many roundings.
//! They are few: here the ray's way to the primitive is gone again in f64, from the same f32 numbers of the scene, and the root beside the one that was found
//! is taken. What is left is what f32 makes of the result, half a rounding of a distance that is counted from within the primitive.
//!
//! It is for answers, on whatever device they were found; a picture shows none of it.

use super::analytic::{Span, carrier_roots};
use super::bernstein::widened_net_jet;
use super::footprint::LONGEST;
use super::newton::point_and_tangents;
use super::ray_space::{
    Distance, GridStep, PartRay, WorldRay, apply_rows, approach_frame, approach_point, enter_instance,
};
use super::trace::{RawHit, window_parameters};
use super::vector::Vector3;
use super::{Kernel, NO_NET};
use crate::scene::Scene;

/// Steps of Newton's method on a net: the first leaves the square of f32's error, which near a tangent may be seen.
const STEPS: usize = 2;

/// How far, of the net's parameters, a root may be from the hit.
const FARTHEST: f64 = 1.0 / 256.0;

/// How far along the ray, in slacks of the face: as long as the longest footprint. What is farther is another root.
const FARTHEST_ALONG: f64 = LONGEST;

/// Whether f32 may round more on the way to a hit than some 10⁻⁷ of the primitive: it is shallow, or in a part that is turned, which rounds at the part's scale.
/// Beside a hit that grazes its surface, which is not certain, there may be another root, that of another hit: it stays as it is.
pub fn is_rough(scene: &Scene<'_>, hit: &RawHit<f32>) -> bool {
    hit.is_certain() && (hit.is_shallow || scene.instances[hit.instance as usize].is_translation == 0)
}

/// The hit where f64 finds it; `None` where it finds none.
pub fn polish(scene: &Scene<'_>, ray: &WorldRay<f32>, hit: &RawHit<f32>) -> Option<RawHit<f32>> {
    let step = GridStep::of(scene.header);
    let ray = WorldRay::<f64> {
        grid: ray.grid,
        fraction: ray.fraction.in_numbers(),
        direction: ray.direction.in_numbers() + ray.direction_low.in_numbers(),
        direction_low: Vector3::default(),
    };
    let (may_meet, part_ray) = enter_instance(&ray, &f32::instance(scene, hit.instance).in_numbers(), step);
    if !may_meet {
        return None;
    }
    let (along, uv) = if hit.net == NO_NET {
        polish_on_face(scene, &part_ray, hit, step)
    } else {
        polish_on_net(scene, &part_ray, hit, step)
    }?;
    let slack = f64::from(scene.faces[hit.face as usize].slack);
    let moved = along.minus(wide_distance(hit.distance)).abs() * part_ray.direction.length();
    if !(moved <= FARTHEST_ALONG * slack) {
        return None;
    }
    let anchor = hit.distance.anchor;
    let offset = along.beyond(anchor.into()) as f32;
    Some(RawHit { distance: Distance { anchor, offset }, uv: uv.map(|x| x as f32), ..*hit })
}

/// Where the ray meets the face's carrier, nearest to the hit.
fn polish_on_face(
    scene: &Scene<'_>,
    part_ray: &PartRay<f64>,
    hit: &RawHit<f32>,
    step: GridStep<f64>,
) -> Option<(Distance<f64>, [f64; 2])> {
    let face = f32::face(scene, hit.face).in_numbers();
    let ray = approach_frame(part_ray, &face, step);
    let [origin, direction] = [ray.origin, ray.direction].map(|v| apply_rows(&face.axes, v));
    let found = wide_distance(hit.distance).beyond(ray.anchor);
    let roots = carrier_roots(face.kind, origin, direction, face.radii, &Span::whole());
    let apart = |t: &f64| (t - found).abs();
    let t = roots.t[..roots.count].iter().copied().min_by(|a, b| apart(a).total_cmp(&apart(b)))?;
    let distance = Distance { anchor: ray.anchor, offset: t };
    Some((distance, window_parameters(&face, origin + direction * t)))
}

/// Where the ray meets the net beside the hit.
///
/// With `S − ray = R` at (u, v, t) a step (du, dv, dt) solves `S_u du + S_v dv − d dt = −R`: the product with the normal n leaves `dt = R·n / d·n`, those with
/// `S_v × n` and `n × S_u` the others.
fn polish_on_net(
    scene: &Scene<'_>,
    part_ray: &PartRay<f64>,
    hit: &RawHit<f32>,
    step: GridStep<f64>,
) -> Option<(Distance<f64>, [f64; 2])> {
    let net = &scene.nets[hit.net as usize];
    let grid = scene.faces[net.face as usize].grid;
    let ray = approach_point(part_ray, grid, Vector3::default(), step);
    let start = hit.uv.map(f64::from);
    let (mut uv, mut t) = (start, wide_distance(hit.distance).beyond(ray.anchor));
    for _ in 0..STEPS {
        let jet = widened_net_jet(scene, net, ray.origin + ray.direction * t, uv);
        let (miss, tangents) = point_and_tangents(&jet);
        let [s_u, s_v] = tangents.map(|tangent| tangent * (1.0 / jet.value[3]));
        let n = s_u.cross(s_v);
        let dt = miss.dot(n) / ray.direction.dot(n);
        let along = ray.direction * dt - miss;
        let per_square = 1.0 / n.dot(n);
        uv = [uv[0] + along.cross(s_v).dot(n) * per_square, uv[1] + s_u.cross(along).dot(n) * per_square];
        t += dt;
    }
    let is_near = (0..2).all(|k| (uv[k] - start[k]).abs() <= FARTHEST);
    is_near.then_some((Distance { anchor: ray.anchor, offset: t }, uv))
}

fn wide_distance(distance: Distance<f32>) -> Distance<f64> {
    Distance { anchor: distance.anchor.into(), offset: distance.offset.into() }
}

#[cfg(test)]
mod tests {
    use super::super::ray_space::prepare;
    use super::super::test_scenes::{Random, TestFace, TestNet, scene_of};
    use super::super::trace::trace;
    use super::*;
    use crate::render::reference::widened;
    use crate::render::{Exactness, Ray};
    use crate::scene::FaceKind;
    use glam::{DAffine3, DQuat, DVec3};

    fn faces() -> [TestFace; 4] {
        use std::f64::consts::{FRAC_PI_2, TAU};
        let rows: [[f64; 3]; 3] = [[0.0, 0.4, 0.1], [0.3, 1.2, 0.2], [-0.2, 0.5, 0.9]];
        let points = rows
            .iter()
            .zip([-1.0, 0.0, 1.0])
            .flat_map(|(row, x)| {
                row.iter().zip([-1.0, 0.0, 1.0]).map(move |(&z, y)| [x, y, z, 1.0 + 0.3 * x])
            })
            .map(|[x, y, z, w]| [x * w, y * w, z * w, w])
            .collect();
        [
            TestFace::analytic(FaceKind::Sphere, [1.0, 0.0], [0.0, -FRAC_PI_2], [TAU, FRAC_PI_2]),
            TestFace::analytic(FaceKind::Torus, [1.0, 0.4], [0.0, 0.0], [TAU, TAU]),
            TestFace::analytic(FaceKind::Cone, [1.0, 0.5], [0.0, -1.0], [TAU, 1.0]),
            TestFace::nets(TestNet { degrees: [2, 2], points, level: 1 }),
        ]
    }

    fn met<T: Kernel>(scene: &Scene<'_>, ray: &Ray) -> Vec<(WorldRay<T>, RawHit<T>)> {
        let prepared = prepare::<T>(ray, scene.header).expect("a ray at the scene");
        let mut met = Vec::new();
        trace(scene, Exactness::Exact, &prepared.ray, prepared.near, Distance::INFINITE, &mut |candidate| {
            met.push((prepared.ray, candidate.hit));
            Some(Distance::INFINITE)
        });
        met
    }

    /// The parts are a thousand sizes apart and one is turned; the same numbers traced in f64 are the truth.
    #[test]
    fn polished_hits_are_as_good_as_the_numbers_that_hold_them() {
        let turned = DAffine3::from_scale_rotation_translation(
            DVec3::ONE,
            DQuat::from_rotation_z(0.6) * DQuat::from_rotation_x(0.8),
            DVec3::new(1000.0, 300.0, 20.0),
        );
        let (mut rough, mut least_gain) = (0, f64::INFINITY);
        for face in faces() {
            let narrow = scene_of(&[face], &[DAffine3::IDENTITY, turned]);
            let narrow = narrow.scene();
            let wide = widened(&narrow);
            let (mut before, mut after) = (0.0_f64, 0.0_f64);
            let mut random = Random(7);
            for index in 0..4000 {
                let (target, direction) = (random.point(0.9), random.direction());
                let target = if index % 2 == 0 { target } else { turned.transform_point3(target) };
                let ray = Ray { origin: target - direction * 50.0, direction };
                let expected = met::<f64>(&wide.scene(), &ray);
                for (world_ray, hit) in met::<f32>(&narrow, &ray) {
                    if !is_rough(&narrow, &hit) {
                        continue;
                    }
                    let error = |hit: &RawHit<f32>| {
                        let found = wide_distance(hit.distance);
                        let apart = |(_, own): &(_, RawHit<f64>)| found.minus(own.distance).abs();
                        expected.iter().map(apart).fold(f64::INFINITY, f64::min)
                    };
                    let polished = polish(&narrow, &world_ray, &hit).expect("a root");
                    (before, after) = (before.max(error(&hit)), after.max(error(&polished)));
                    rough += 1;
                }
            }
            // Half a rounding of a distance from within a size of 2.
            assert!(after < 1.3e-7, "{after:e}, before {before:e}");
            least_gain = least_gain.min(before / after);
        }
        eprintln!("{rough} hits, the worst {least_gain} times better at least");
        assert!(rough > 4000 && least_gain > 8.0, "{rough} {least_gain}");
    }
}
