//! The tracer against closed forms and brute force, on scenes made by hand.

use super::ray_space::prepare;
use super::test_scenes::{Random, TestFace, TestNet, scene_of};
use super::trace::first_hit;
use super::{Precision, probe};
use crate::render::{Exactness, Hit, Ray};
use crate::scene::FaceKind;
use glam::{DAffine3, DMat3, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const BOTH: [Precision; 2] = [Precision::F32, Precision::F64];

fn tolerance(precision: Precision) -> f64 {
    match precision {
        Precision::F32 => 5e-7,
        Precision::F64 => 1e-13,
    }
}

fn box_faces() -> Vec<TestFace> {
    let plane = TestFace::analytic(FaceKind::Plane, [0.0; 2], [-1.0; 2], [1.0; 2]);
    [DVec3::X, DVec3::Y, DVec3::Z]
        .into_iter()
        .flat_map(|axis| [axis, -axis])
        .map(|z| {
            let x = DVec3::new(z.y, z.z, z.x);
            plane.clone().placed(z, DMat3::from_cols(x, z.cross(x), z))
        })
        .collect()
}

/// A face of each analytic kind, whole.
fn whole_faces() -> Vec<TestFace> {
    let turn = DMat3::from_rotation_x(0.7) * DMat3::from_rotation_z(0.4);
    vec![
        TestFace::analytic(FaceKind::Plane, [0.0; 2], [-1.0, -2.0], [1.5, 1.0]),
        TestFace::analytic(FaceKind::Cylinder, [0.8, 0.0], [0.0, -1.0], [TAU, 1.0]),
        TestFace::analytic(FaceKind::Cylinder, [0.8, 0.0], [-1.0, -1.0], [2.0, 1.0]),
        TestFace::analytic(FaceKind::Cone, [1.0, -0.5], [-PI, -0.5], [PI, 1.9]),
        TestFace::analytic(FaceKind::Cone, [0.4, 0.05], [0.5, -1.0], [5.0, 1.0]),
        TestFace::analytic(FaceKind::Sphere, [1.2, 0.0], [0.0, -FRAC_PI_2], [TAU, FRAC_PI_2]),
        TestFace::analytic(FaceKind::Sphere, [1.2, 0.0], [1.0, -0.4], [2.5, 1.4]),
        TestFace::analytic(FaceKind::Torus, [1.0, 0.3], [0.0, 0.0], [TAU, TAU]),
        TestFace::analytic(FaceKind::Torus, [1.0, 0.05], [0.0, -1.0], [TAU, 1.0]),
        TestFace::analytic(FaceKind::Torus, [0.5, 0.5], [0.0, 0.0], [TAU, TAU]),
        TestFace::analytic(FaceKind::Torus, [0.4, 0.7], [0.0, -2.1], [TAU, 2.1]),
    ]
    .into_iter()
    .map(|face| face.placed(DVec3::new(3.0, -2.0, 1.0), turn))
    .collect()
}

fn wavy_net(degrees: [usize; 2], rational: bool, level: u32) -> TestNet {
    let mut random = Random(7);
    let mut points = Vec::new();
    for i in 0..=degrees[0] {
        for j in 0..=degrees[1] {
            let weight = if rational { 0.6 + 0.8 * random.unit() } else { 1.0 };
            let x = i as f64 / degrees[0] as f64 * 2.0 - 1.0 + 0.1 * (random.unit() - 0.5);
            let y = j as f64 / degrees[1] as f64 * 2.0 - 1.0 + 0.1 * (random.unit() - 0.5);
            let z = 1.2 * (random.unit() - 0.5);
            points.push([x * weight, y * weight, z * weight, weight]);
        }
    }
    TestNet { degrees, points, level }
}

fn random_rays(count: usize, seed: u64, center: DVec3, radius: f64) -> Vec<Ray> {
    let mut random = Random(seed);
    (0..count)
        .map(|_| {
            let direction = random.direction();
            Ray { origin: center + random.point(radius * 0.7) - direction * (radius * 2.0), direction }
        })
        .collect()
}

fn point(ray: &Ray, hit: &Hit) -> DVec3 {
    ray.at(hit.t)
}

#[test]
fn hits_lie_on_their_faces_where_uv_says() {
    for face in whole_faces() {
        let scene = scene_of(std::slice::from_ref(&face), &[DAffine3::IDENTITY]);
        let rays = random_rays(3000, 1, face.origin, 2.0);
        for precision in BOTH {
            let hits = probe(&scene.scene(), &rays, precision, false);
            assert!(hits.iter().flatten().count() > 100, "{face:?}");
            for (ray, hits) in rays.iter().zip(&hits) {
                for hit in hits {
                    let cosine = hit.normal.dot(ray.direction).abs();
                    let error = (point(ray, hit) - face.point(hit.uv)).length();
                    let allowed = 8.0 * tolerance(precision) / cosine.max(1e-3);
                    assert!(error <= allowed, "{:?} {precision:?} {ray:?} {hit:?}: {error}", face.kind);
                }
            }
        }
    }
}

/// Parameters where the distance to the carrier changes sign along the ray, by dense sampling.
fn brute_force(face: &TestFace, ray: &Ray, length: f64) -> Vec<f64> {
    let implicit = |t: f64| {
        let p = face.axes.transpose() * (ray.at(t) - face.origin);
        let across = p.truncate().length();
        let [r, k] = face.radii;
        match face.kind {
            FaceKind::Plane => p.z,
            FaceKind::Cylinder => across - r,
            FaceKind::Cone => across - (r + k * p.z).abs(),
            FaceKind::Sphere => p.length() - r,
            _ => ((across - r).powi(2) + p.z * p.z - k * k) * ((across + r).powi(2) + p.z * p.z - k * k),
        }
    };
    let steps = 4000;
    let mut roots = Vec::new();
    for i in 0..steps {
        let at = |i: usize| length * i as f64 / steps as f64;
        let (mut low, mut high) = (at(i), at(i + 1));
        if (implicit(low) < 0.0) == (implicit(high) < 0.0) {
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if (implicit(middle) < 0.0) == (implicit(low) < 0.0) { low = middle } else { high = middle }
        }
        roots.push(0.5 * (low + high));
    }
    roots
}

#[test]
fn all_roots_of_whole_carriers_are_found() {
    for face in whole_faces() {
        let whole = matches!(face.kind, FaceKind::Torus | FaceKind::Sphere)
            && (face.high[0] - face.low[0] - TAU).abs() < 1e-9
            && (face.kind == FaceKind::Sphere || (face.high[1] - face.low[1] - TAU).abs() < 1e-9);
        if !whole {
            continue;
        }
        let scene = scene_of(std::slice::from_ref(&face), &[DAffine3::IDENTITY]);
        let rays = random_rays(1500, 2, face.origin, 2.0);
        for precision in BOTH {
            let mut differing = 0;
            for (ray, hits) in rays.iter().zip(probe(&scene.scene(), &rays, precision, false)) {
                let expected = brute_force(&face, ray, 8.0);
                if expected.len() != hits.len() {
                    // Sampling misses pairs closer than its step, f32 those closer than its roundings.
                    let closest = hits.windows(2).map(|w| w[1].t - w[0].t).fold(f64::INFINITY, f64::min);
                    assert!(closest < 5e-3, "{face:?} {ray:?}: {expected:?} {hits:?}");
                    differing += 1;
                    continue;
                }
                for (t, hit) in expected.iter().zip(&hits) {
                    let allowed =
                        8.0 * tolerance(precision).max(1e-12) / hit.normal.dot(ray.direction).abs().max(1e-3);
                    assert!((t - hit.t).abs() < allowed, "{face:?} {ray:?}: {expected:?} {hits:?}");
                }
            }
            assert!(differing <= 6, "{face:?}: {differing}");
        }
    }
}

#[test]
fn near_tangent_rays_meet_the_torus_twice_or_not_at_all() {
    let face = TestFace::analytic(FaceKind::Torus, [1.0, 0.25], [0.0; 2], [TAU; 2]);
    let scene = scene_of(&[face], &[DAffine3::IDENTITY]);
    for exponent in 1..10 {
        let inside = 10.0_f64.powi(-exponent);
        for (offset, expected) in [(-inside, 2), (inside, 0)] {
            // Over the top of the tube, across it; the crest is straight only to first order, so no further hit is near.
            let ray = Ray { origin: DVec3::new(1.0, -3.0, 0.25 + offset), direction: DVec3::Y };
            let hits = &probe(&scene.scene(), &[ray], Precision::F64, false)[0];
            assert_eq!(hits.len(), expected, "{offset}: {hits:?}");
        }
    }
}

/// Whatever boxes led to them, equal hits are equal to the last bit: with the boxes of one, of the other, and of both.
#[test]
fn of_coincident_tori_the_first_is_hit() {
    let face = TestFace::analytic(FaceKind::Torus, [1.0, 0.25], [0.0; 2], [TAU; 2]);
    let part = TestFace::analytic(FaceKind::Torus, [1.0, 0.25], [0.5, 1.0], [3.0, 2.5]);
    let scene = scene_of(&[part, face.clone(), face], &[DAffine3::IDENTITY, DAffine3::IDENTITY]);
    let scene = scene.scene();
    let mut faces = [0; 3];
    for ray in random_rays(20_000, 9, DVec3::ZERO, 1.5) {
        let prepared = prepare::<f32>(&ray, scene.header).expect("it is near");
        let Some(hit) = first_hit(&scene, Exactness::Exact, &prepared.ray, prepared.near) else { continue };
        faces[hit.face as usize] += 1;
        assert_eq!(hit.instance, 0, "{ray:?}");
    }
    assert!(faces[0] > 100 && faces[1] > 1000 && faces[2] == 0, "{faces:?}");
}

#[test]
fn a_box_is_watertight_and_knows_its_normals() {
    let faces = box_faces();
    let scene = scene_of(&faces, &[DAffine3::IDENTITY]);
    let mut rays = random_rays(20_000, 3, DVec3::ZERO, 1.0);
    // Aimed exactly at edges and corners, from inside: each ray has to meet something.
    let mut random = Random(4);
    for _ in 0..5000 {
        let edge = DVec3::new(1.0, -1.0, random.unit() * 2.0 - 1.0);
        let origin = random.point(0.5);
        rays.push(Ray { origin, direction: (edge - origin).normalize() });
    }
    for precision in BOTH {
        let all = probe(&scene.scene(), &rays, precision, false);
        let first = probe(&scene.scene(), &rays, precision, true);
        for (i, ray) in rays.iter().enumerate() {
            assert_eq!(first[i].first(), all[i].first(), "{ray:?}");
            let inside = ray.origin.abs().max_element() < 1.0;
            if inside {
                assert!(!all[i].is_empty(), "{precision:?}: {ray:?} leaks");
            } else {
                assert!(all[i].len().is_multiple_of(2), "{precision:?}: {ray:?}: {:?}", all[i]);
            }
            for hit in &all[i] {
                assert!((hit.normal - faces[hit.face as usize].axes.z_axis).length() < 1e-12);
            }
        }
    }
}

#[test]
fn axis_parallel_rays_with_signed_zeros_hit() {
    let scene = scene_of(&box_faces(), &[DAffine3::IDENTITY]);
    for zero in [0.0, -0.0] {
        for (direction, across) in [
            (DVec3::new(1.0, zero, zero), DVec3::new(0.0, 0.25, -0.5)),
            (DVec3::new(zero, -1.0, zero), DVec3::new(0.25, 0.0, 0.0)),
            (DVec3::new(zero, zero, 1.0), DVec3::new(-0.75, 0.999, 0.0)),
            (DVec3::new(-1.0, zero, zero), DVec3::new(0.0, 1.0, 0.25)),
        ] {
            let ray = Ray { origin: across - direction * 5.0, direction };
            for precision in BOTH {
                let hits = &probe(&scene.scene(), &[ray], precision, false)[0];
                assert_eq!(hits.len(), 2, "{ray:?}: {hits:?}");
                assert!((hits[0].t - 4.0).abs() < 1e-6 && (hits[1].t - 6.0).abs() < 1e-6);
            }
        }
    }
}

#[test]
fn degenerate_rays_are_misses() {
    let scene = scene_of(&whole_faces(), &[DAffine3::IDENTITY]);
    let nan = f64::NAN;
    for (origin, direction) in [
        (DVec3::ZERO, DVec3::ZERO),
        (DVec3::ZERO, DVec3::new(nan, 0.0, 1.0)),
        (DVec3::new(nan, 0.0, 0.0), DVec3::X),
        (DVec3::new(f64::INFINITY, 0.0, 0.0), DVec3::X),
        (DVec3::splat(1e300), DVec3::X),
    ] {
        for precision in BOTH {
            assert!(probe(&scene.scene(), &[Ray { origin, direction }], precision, false)[0].is_empty());
        }
    }
}

/// The greatest distance of f32 hits from f64 hits, for rays that start `distance` away from a part at `offset`.
fn worst_error(faces: &[TestFace], placements: &[DAffine3], offset: DVec3, distance: f64) -> f64 {
    let moved: Vec<DAffine3> = placements.iter().map(|p| DAffine3::from_translation(offset) * *p).collect();
    let scene = scene_of(faces, &moved);
    let mut random = Random(11);
    let rays: Vec<Ray> = (0..2000)
        .map(|_| {
            let direction = random.direction();
            let target = moved[0].transform_point3(random.point(0.5));
            Ray { origin: target - direction * distance, direction }
        })
        .collect();
    let narrow = probe(&scene.scene(), &rays, Precision::F32, true);
    let exact = probe(&scene.scene(), &rays, Precision::F64, true);
    let mut worst = 0.0_f64;
    let mut compared = 0;
    for ((ray, a), b) in rays.iter().zip(&narrow).zip(&exact) {
        let (Some(a), Some(b)) = (a.first(), b.first()) else { continue };
        let cosine = b.normal.dot(ray.direction).abs();
        if a.face == b.face && cosine > 0.2 {
            worst = worst.max((a.t - b.t).abs());
            compared += 1;
        }
    }
    assert!(compared > 500, "{compared}");
    worst
}

#[test]
fn f32_error_depends_on_neither_distance_nor_offset() {
    let sphere = TestFace::analytic(FaceKind::Sphere, [0.5, 0.0], [0.0, -FRAC_PI_2], [TAU, FRAC_PI_2]);
    let torus = TestFace::analytic(FaceKind::Torus, [0.35, 0.15], [0.0; 2], [TAU; 2]);
    let mut net = wavy_net([3, 3], true, 3);
    for p in &mut net.points {
        *p = [p[0] * 0.5, p[1] * 0.5, p[2] * 0.5, p[3]];
    }
    for face in [sphere, torus, TestFace::nets(net)] {
        // Alone, and as one of two that stand ten thousand sizes apart.
        let alone = vec![DAffine3::IDENTITY];
        let apart = vec![DAffine3::IDENTITY, DAffine3::from_translation(DVec3::new(1e4, 3e3, -2e3))];
        for placements in [alone, apart] {
            for offset in [DVec3::ZERO, DVec3::new(1e6, -7e5, 3e5)] {
                for distance in [2.0, 100.0, 1e4] {
                    let worst = worst_error(std::slice::from_ref(&face), &placements, offset, distance);
                    // The f64 ray itself is known to 1e-16 of its offset.
                    assert!(worst <= 5e-7 * 2.0_f64.sqrt(), "{:?} {offset} {distance}: {worst}", face.kind);
                }
            }
        }
    }
}

#[test]
fn net_hits_are_those_of_subdivision() {
    for (degrees, rational) in [([3, 3], false), ([2, 2], true), ([7, 5], true), ([1, 1], false)] {
        let net = wavy_net(degrees, rational, 3);
        let face = TestFace::nets(net.clone());
        let scene = scene_of(std::slice::from_ref(&face), &[DAffine3::IDENTITY]);
        let rays = random_rays(1000, 5, DVec3::ZERO, 1.2);
        for precision in BOTH {
            let mut missing = 0;
            let mut total = 0;
            for (ray, hits) in rays.iter().zip(probe(&scene.scene(), &rays, precision, false)) {
                for hit in &hits {
                    let error = (point(ray, hit) - net.point(hit.uv)).length();
                    let allowed = 4.0 * tolerance(precision) / hit.normal.dot(ray.direction).abs().max(1e-3);
                    assert!(error <= allowed, "{degrees:?} {precision:?}: {error} {hit:?}");
                }
                let expected = subdivision_roots(&net, ray);
                total += expected.len();
                missing +=
                    expected.iter().filter(|&&t| !hits.iter().any(|hit| (hit.t - t).abs() < 1e-4)).count();
                assert!(hits.len() <= expected.len() + 2, "{hits:?} {expected:?}");
                assert!(hits.windows(2).all(|w| w[0].t <= w[1].t));
            }
            assert!(total > 500);
            assert_eq!(missing, 0, "{degrees:?} {precision:?}: of {total}");
        }
    }
}

/// Roots of well-crossing rays: small bilinear quads against the ray, polished by Newton's method.
fn subdivision_roots(net: &TestNet, ray: &Ray) -> Vec<f64> {
    let n = 48;
    let mut roots: Vec<f64> = Vec::new();
    let grid: Vec<DVec3> = (0..=n)
        .flat_map(|i| (0..=n).map(move |j| (i, j)))
        .map(|(i, j)| net.point([i as f64 / n as f64, j as f64 / n as f64]))
        .collect();
    let side = ray.direction.any_orthonormal_pair();
    let flat = |p: DVec3| ((p - ray.origin).dot(side.0), (p - ray.origin).dot(side.1));
    for i in 0..n {
        for j in 0..n {
            let corners =
                [(i, j), (i + 1, j), (i, j + 1), (i + 1, j + 1)].map(|(i, j)| flat(grid[i * (n + 1) + j]));
            let range = |k: fn(&(f64, f64)) -> f64| {
                let values = corners.iter().map(k);
                let (low, high) = values.fold((f64::MAX, f64::MIN), |r, x| (r.0.min(x), r.1.max(x)));
                let room = 0.25 * (high - low) + 1e-3;
                low - room <= 0.0 && high + room >= 0.0
            };
            if !(range(|c| c.0) && range(|c| c.1)) {
                continue;
            }
            let mut uv = [(i as f64 + 0.5) / n as f64, (j as f64 + 0.5) / n as f64];
            for _ in 0..20 {
                let f = flat(net.point(uv));
                let [s_u, s_v] = net.tangents(uv).map(|t| (t.dot(side.0), t.dot(side.1)));
                let determinant = s_u.0 * s_v.1 - s_u.1 * s_v.0;
                uv[0] -= (f.0 * s_v.1 - f.1 * s_v.0) / determinant;
                uv[1] -= (s_u.0 * f.1 - s_u.1 * f.0) / determinant;
            }
            let inside = uv.iter().all(|x| (0.0..=1.0).contains(x));
            let f = flat(net.point(uv));
            let t = (net.point(uv) - ray.origin).dot(ray.direction);
            let [s_u, s_v] = net.tangents(uv);
            let cosine = s_u.cross(s_v).normalize().dot(ray.direction).abs();
            if inside
                && f.0.hypot(f.1) < 1e-10
                && cosine > 1e-2
                && !roots.iter().any(|r| (r - t).abs() < 1e-7)
            {
                roots.push(t);
            }
        }
    }
    roots
}

#[test]
fn closed_shapes_are_crossed_an_even_number_of_times() {
    let sphere = TestFace::analytic(FaceKind::Sphere, [1.0, 0.0], [0.0, -FRAC_PI_2], [TAU, FRAC_PI_2]);
    let torus = TestFace::analytic(FaceKind::Torus, [0.8, 0.35], [0.0; 2], [TAU; 2]);
    for face in [sphere, torus] {
        let scene = scene_of(&[face], &[DAffine3::IDENTITY]);
        let rays = random_rays(20_000, 9, DVec3::ZERO, 1.2);
        for precision in BOTH {
            for (ray, hits) in rays.iter().zip(probe(&scene.scene(), &rays, precision, false)) {
                assert!(hits.len().is_multiple_of(2), "{precision:?} {ray:?}: {hits:?}");
                let outwards = hits.iter().map(|hit| hit.normal.dot(ray.direction) > 0.0);
                assert!(outwards.enumerate().all(|(i, out)| out == (i % 2 == 1)), "{hits:?}");
            }
        }
    }
}

#[test]
fn rotated_scaled_and_mirrored_instances_agree_with_moved_rays() {
    let faces = whole_faces();
    let base = scene_of(&faces, &[DAffine3::IDENTITY]);
    let turn = DAffine3::from_rotation_y(0.3) * DAffine3::from_rotation_z(1.1);
    let mirror = DAffine3::from_scale(DVec3::new(-1.0, 1.0, 1.0));
    for placement in [
        DAffine3::from_translation(DVec3::new(5.0, 60.0, -7.0)) * turn,
        DAffine3::from_scale(DVec3::splat(25.4)) * turn,
        DAffine3::from_translation(DVec3::new(1.0, 2.0, 3.0)) * mirror * turn,
    ] {
        let scale = placement.matrix3.determinant().abs().cbrt();
        let moved = scene_of(&faces, &[placement]);
        let rays = random_rays(2000, 13, faces[0].origin, 2.0);
        let outer: Vec<Ray> = rays
            .iter()
            .map(|ray| Ray {
                origin: placement.transform_point3(ray.origin),
                direction: placement.transform_vector3(ray.direction).normalize(),
            })
            .collect();
        let a = probe(&base.scene(), &rays, Precision::F64, true);
        let b = probe(&moved.scene(), &outer, Precision::F64, true);
        let c = probe(&moved.scene(), &outer, Precision::F32, true);
        for ((a, b), c) in a.iter().zip(&b).zip(&c) {
            assert_eq!(a.len(), b.len());
            let (Some(a), Some(b)) = (a.first(), b.first()) else { continue };
            assert_eq!(a.face, b.face);
            assert!((a.t * scale - b.t).abs() < 1e-9, "{a:?} {b:?}");
            let normal = placement.transform_vector3(a.normal).normalize();
            assert!((normal - b.normal).length() < 1e-6, "{normal} {b:?}");
            if let Some(c) = c.first().filter(|c| c.face == b.face) {
                assert!((c.t - b.t).abs() < 2e-3 * scale, "{b:?} {c:?}");
            }
        }
    }
}
