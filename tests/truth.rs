//! Hits against analytic truth: spheres, tori, blocks, cylinders and cones, some also as rational B-splines, in f64 within 10⁻¹² of their size.
//!
//! A hit lies on its ray, so that it is right where the surface's own equation holds at it; counts are those of the equation's real roots.

use glam::DVec3;
use trimray::bake::{BakeOptions, bake};
use trimray::bench::chord;
use trimray::brep::{Body, BodyKind, Face, Id, Model, Part, primitive};
use trimray::geometry::{BsplineSurface, Frame, Homogeneous, Surface};
use trimray::render::cpu::{Precision, probe, probe_alone};
use trimray::render::{Exactness, Ray};
use trimray::scene::{FaceKind, SceneBuffers};

const RAYS: u64 = 20_000;

/// Rays that come closer to a tangent than this (|cos| of the angle to the normal) are left out: their roots are not well conditioned.
const STEEP: f64 = 1e-3;

/// In f64, over the size.
const TOLERANCE: f64 = 1e-12;

fn scene_of(surface: Surface) -> SceneBuffers {
    let mut model = Model::default();
    let surface = model.surfaces.push(surface);
    let (color, name) = (None, String::new());
    let face = model.faces.push(Face { surface, same_sense: true, loops: vec![], color, name, entity: 1 });
    let buffers = solid_of(model, vec![face]);
    assert_eq!(buffers.faces.len(), 1, "{:?}", buffers.metadata.findings);
    buffers
}

fn solid_of(mut model: Model, faces: Vec<Id<Face>>) -> SceneBuffers {
    model.declared_faces = faces.len();
    let body = Body { kind: BodyKind::Solid, faces, name: String::new(), entity: 2 };
    let part = Part { name: "part".into(), bodies: vec![body], children: vec![], entity: 3 };
    let part = model.parts.push(part);
    model.roots.push(part);
    bake(&model, &BakeOptions { keep_f64: true, ..BakeOptions::default() }, &|_, _| {})
}

/// Half the diagonal of a quarter circle's control polygon: the weight of its middle point.
const QUARTER: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// The surface that points (distance from the axis, height, weight) sweep around z.
fn revolved(degree: usize, knots: Vec<f64>, profile: &[[f64; 3]]) -> BsplineSurface {
    let corners = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]];
    let around = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4].map(f64::from).to_vec();
    let points = corners.iter().enumerate().flat_map(|(index, &[x, y])| {
        let weight = if index % 2 == 0 { 1.0 } else { QUARTER };
        let point = move |[r, z, w]: [f64; 3]| {
            Homogeneous::new(DVec3::new(r * f64::from(x), r * f64::from(y), z), w * weight)
        };
        profile.iter().copied().map(point)
    });
    BsplineSurface::new([2, degree], [around, knots], points.collect()).expect("valid knots")
}

/// A surface as a quadric or torus and as a B-spline, and how far a point is off it.
struct Case {
    name: &'static str,
    analytic: Surface,
    spline: BsplineSurface,
    size: f64,
    off: fn(DVec3) -> f64,
}

const RADIUS: f64 = 2.0;
const MINOR: f64 = 0.5;

fn cases() -> [Case; 2] {
    let frame = Frame::IDENTITY;
    let (r, m) = (RADIUS, MINOR);
    let half_circle = [[0.0, -r, 1.0], [r, -r, QUARTER], [r, 0.0, 1.0], [r, r, QUARTER], [0.0, r, 1.0]];
    let circle = [
        [r + m, 0.0, 1.0],
        [r + m, m, QUARTER],
        [r, m, 1.0],
        [r - m, m, QUARTER],
        [r - m, 0.0, 1.0],
        [r - m, -m, QUARTER],
        [r, -m, 1.0],
        [r + m, -m, QUARTER],
        [r + m, 0.0, 1.0],
    ];
    let halves = [0, 0, 0, 1, 1, 2, 2, 2].map(f64::from).to_vec();
    let whole = [0, 0, 0, 1, 1, 2, 2, 3, 3, 4, 4, 4].map(f64::from).to_vec();
    [
        Case {
            name: "sphere",
            analytic: Surface::Sphere { frame, radius: r },
            spline: revolved(2, halves, &half_circle),
            size: r,
            off: |p| p.length() - RADIUS,
        },
        Case {
            name: "torus",
            analytic: Surface::Torus { frame, major: r, minor: m },
            spline: revolved(2, whole, &circle),
            size: r + m,
            off: |p| (p.truncate().length() - RADIUS).hypot(p.z) - MINOR,
        },
    ]
}

/// The distances at which a ray meets the surface, all steep enough to be sure of, and the worst that a hit is off.
fn hits(scene: &SceneBuffers, rays: &[Ray], off: fn(DVec3) -> f64) -> (Vec<Option<Vec<f64>>>, f64) {
    let mut worst = 0.0f64;
    let found = probe(&scene.scene(), rays, Precision::F64, false);
    let distances = rays.iter().zip(&found).map(|(ray, hits)| {
        hits.iter().for_each(|hit| worst = worst.max(off(ray.at(hit.t)).abs()));
        let is_steep = hits.iter().all(|hit| hit.normal.dot(ray.direction).abs() > STEEP);
        is_steep.then(|| hits.iter().map(|hit| hit.t).collect())
    });
    let distances = distances.collect();
    (distances, worst)
}

#[test]
fn quadrics_tori_and_their_splines_agree_with_their_equations() {
    for Case { name, analytic, spline, size, off } in cases() {
        let (exact, nets) = (scene_of(analytic), scene_of(Surface::Bspline(spline)));
        assert!(exact.faces[0].kind != FaceKind::Nets as u32 && nets.faces[0].kind == FaceKind::Nets as u32);
        let rays: Vec<Ray> = (0..RAYS).map(|index| chord(&exact.scene(), index)).collect();
        let ((first, first_off), (second, second_off)) = (hits(&exact, &rays, off), hits(&nets, &rays, off));
        let (mut compared, mut apart) = (0, 0.0f64);
        for (a, b) in first.iter().zip(&second) {
            let (Some(a), Some(b)) = (a, b) else { continue };
            assert_eq!(a.len(), b.len(), "{name}: {a:?} {b:?}");
            assert_eq!(a.len() % 2, 0, "{name}: {a:?}");
            a.iter().zip(b).for_each(|(a, b)| apart = apart.max((a - b).abs() * STEEP));
            compared += a.len();
        }
        eprintln!("{name}: {compared} hits, off by {first_off:.1e} and as nets {second_off:.1e} mm");
        assert!(compared > 5_000, "{name}: {compared}");
        assert!(first_off <= TOLERANCE * size && second_off <= TOLERANCE * size, "{name}");
        assert!(apart <= TOLERANCE * size, "{name}: {apart}");
    }
}

#[test]
fn a_cylinder_agrees_with_its_equation() {
    let line = [[RADIUS, -3.0, 1.0], [RADIUS, 3.0, 1.0]];
    let spline = revolved(1, vec![0.0, 0.0, 1.0, 1.0], &line);
    let nets = scene_of(Surface::Bspline(spline));
    let rays: Vec<Ray> = (0..RAYS).map(|index| chord(&nets.scene(), index)).collect();
    let (found, worst) = hits(&nets, &rays, |p| p.truncate().length() - RADIUS);
    let mut compared = 0;
    for (ray, found) in rays.iter().zip(&found) {
        let Some(found) = found else { continue };
        // |o + t d| = r in the plane, |z| <= 3.
        let (o, d) = (ray.origin.truncate(), ray.direction.truncate());
        let (a, b, c) = (d.length_squared(), o.dot(d), o.length_squared() - RADIUS * RADIUS);
        let root = (b * b - a * c).max(0.0).sqrt();
        let heights = [(-b - root) / a, (-b + root) / a].map(|t| ray.origin.z + t * ray.direction.z);
        if b * b - a * c < 1e-6 || heights.iter().any(|z| (z.abs() - 3.0).abs() < 1e-6) {
            continue;
        }
        assert_eq!(found.len(), heights.iter().filter(|z| z.abs() < 3.0).count(), "{ray:?}");
        compared += found.len();
    }
    eprintln!("cylinder: {compared} hits, as nets off by {worst:.1e} mm");
    assert!(compared > 5_000 && worst <= TOLERANCE * 3.0, "{compared} {worst:e}");
}

/// A convex solid between two heights: where a ray is inside of its walls, and how far a point is off its surface.
struct Convex {
    name: &'static str,
    build: fn(&mut Model) -> Option<Vec<Id<Face>>>,
    height: f64,
    within: fn(&Ray) -> Option<[f64; 2]>,
    off: fn(DVec3) -> f64,
}

/// Where `a t² + 2 b t + c <= 0`, for a wall that is convex.
fn quadratic([a, b, c]: [f64; 3]) -> Option<[f64; 2]> {
    let root = (b * b - a * c).sqrt();
    (root > 0.0).then(|| [(-b - root) / a, (-b + root) / a])
}

/// The ray in a round wall whose radius is `r + k z`.
fn round(ray: &Ray, r: f64, k: f64) -> Option<[f64; 2]> {
    let (o, d) = (ray.origin, ray.direction);
    let (rho, change) = (r + k * o.z, k * d.z);
    let inner = |p: DVec3, q: DVec3| p.truncate().dot(q.truncate());
    let terms = [inner(d, d) - change * change, inner(o, d) - rho * change, inner(o, o) - rho * rho];
    let [first, last] = quadratic(terms)?;
    if terms[0] > 0.0 {
        return (r + k * (o.z + d.z * first) > 0.0).then_some([first, last]);
    }
    // It leaves one nappe and goes on in the other: inside from the root in ours on, or up to it.
    let [near, far] = [first.min(last), first.max(last)];
    Some(if change > 0.0 { [far, f64::INFINITY] } else { [f64::NEG_INFINITY, near] })
}

fn block_walls(ray: &Ray) -> Option<[f64; 2]> {
    let across = |o: f64, d: f64, size: f64| {
        let (a, b) = (-o / d, (size - o) / d);
        [a.min(b), a.max(b)]
    };
    let [x, y] = [0, 1].map(|k| across(ray.origin[k], ray.direction[k], [6.0, 4.0][k]));
    Some([x[0].max(y[0]), x[1].min(y[1])])
}

const CONVEX: [Convex; 3] = [
    Convex {
        name: "block",
        build: |model| primitive::block(model, &Frame::IDENTITY, DVec3::new(6.0, 4.0, 2.0), 1),
        height: 2.0,
        within: block_walls,
        off: |p| {
            let beside = (p - DVec3::new(3.0, 2.0, 1.0)).abs() - DVec3::new(3.0, 2.0, 1.0);
            beside.max_element().abs()
        },
    },
    Convex {
        name: "cylinder",
        build: |model| primitive::frustum(model, &Frame::IDENTITY, [2.0, 2.0], 5.0, 1),
        height: 5.0,
        within: |ray| round(ray, 2.0, 0.0),
        off: |p| (p.truncate().length() - 2.0).max((p.z - 2.5).abs() - 2.5).abs(),
    },
    Convex {
        name: "cone",
        build: |model| primitive::frustum(model, &Frame::IDENTITY, [2.0, 0.0], 4.0, 1),
        height: 4.0,
        within: |ray| round(ray, 2.0, -0.5),
        off: |p| {
            let beside = (p.truncate().length() - (2.0 - 0.5 * p.z)) * 0.8f64.sqrt();
            beside.max((p.z - 2.0).abs() - 2.0).abs()
        },
    },
];

#[test]
fn planes_cylinders_and_cones_agree_with_their_equations() {
    for Convex { name, build, height, within, off } in CONVEX {
        let mut model = Model::default();
        let faces = build(&mut model).expect("a solid");
        let scene = solid_of(model, faces);
        assert!(scene.faces.iter().all(|face| face.kind != FaceKind::Nets as u32), "{name}");
        let rays: Vec<Ray> = (0..RAYS).map(|index| chord(&scene.scene(), index)).collect();
        let (found, worst) = hits(&scene, &rays, off);
        let mut compared = 0;
        for (ray, found) in rays.iter().zip(&found) {
            let Some(found) = found else { continue };
            let (o, d) = (ray.origin.z, ray.direction.z);
            let ends = [-o / d, (height - o) / d];
            let inside =
                within(ray).map(|[from, to]| [from.max(ends[0].min(ends[1])), to.min(ends[0].max(ends[1]))]);
            let length = inside.map_or(-1.0, |[from, to]| to - from);
            // Past an edge, by less than the slack.
            if length.abs() < 1e-3 {
                continue;
            }
            assert_eq!(found.len(), if length > 0.0 { 2 } else { 0 }, "{name}: {ray:?} {inside:?}");
            for (t, expected) in found.iter().zip(inside.into_iter().flatten()) {
                assert!((t - expected).abs() * STEEP < TOLERANCE * 8.0, "{name}: {ray:?} {t} {expected}");
            }
            compared += found.len();
        }
        eprintln!("{name}: {compared} hits, off by {worst:.1e} mm");
        assert!(compared > 4_000 && worst <= TOLERANCE * 8.0, "{name}: {compared} {worst:e}");
    }
}

/// Rays through the poles of a sphere that is a net, and past them by 10⁻⁹ to 10⁻² mm: twice the sphere, whatever mode finds them, with its own normals.
#[test]
fn poles_of_a_net_are_met_once() {
    let [Case { spline, .. }, _] = cases();
    let buffers = scene_of(Surface::Bspline(spline));
    let scene = buffers.scene();
    let rays: Vec<Ray> = (0..400)
        .map(|index| {
            let direction = chord(&scene, index).direction;
            let beside = chord(&scene, index + 1000).direction;
            let offset = if index % 2 == 0 { 0.0 } else { 10f64.powf(-9.0 + 7.0 * (index as f64 / 400.0)) };
            let pole = DVec3::Z * if index % 4 < 2 { RADIUS } else { -RADIUS };
            Ray { origin: pole + beside * offset - direction * 10.0, direction }
        })
        .chain([Ray { origin: DVec3::Z * 10.0, direction: DVec3::NEG_Z }])
        .filter(|ray| ray.direction.z.abs() > 0.05)
        .collect();
    for (precision, off) in [(Precision::F32, 4e-6), (Precision::F64, 4e-6)] {
        for (ray, hits) in rays.iter().zip(probe_alone(&scene, &rays, precision, Exactness::Exact)) {
            assert_eq!(hits.len(), 2, "{precision:?} {ray:?}: {hits:?}");
            for hit in hits {
                let at = ray.at(hit.t);
                assert!((at.length() - RADIUS).abs() < off, "{precision:?} {ray:?}: {hit:?}");
                assert!((hit.normal - at / RADIUS).length() < 1e-3, "{precision:?} {ray:?}: {hit:?}");
            }
        }
        // From pole to pole.
        for exactness in [Exactness::Fast, Exactness::Balanced] {
            let axis = probe_alone(&scene, &rays[rays.len() - 1..], precision, exactness);
            assert_eq!(axis[0].len(), 2, "{precision:?} {exactness:?}: {axis:?}");
        }
    }
}

/// A ray just outside of a silhouette, within the slack, may meet it or not, but not more often than a line can.
#[test]
fn silhouettes_are_met_twice_at_most() {
    let [Case { spline, .. }, _] = cases();
    let buffers = scene_of(Surface::Bspline(spline));
    let rays: Vec<Ray> = (0..400)
        .map(|index| {
            let normal = chord(&buffers.scene(), index).direction;
            let (first, second) = normal.any_orthonormal_pair();
            let (sin, cos) = (index as f64).sin_cos();
            let direction = first * cos + second * sin;
            let height = RADIUS + 10f64.powf(-9.0 + 2.0 * (index as f64 / 400.0));
            Ray { origin: normal * height - direction * 10.0, direction }
        })
        .collect();
    for precision in [Precision::F32, Precision::F64] {
        for (ray, hits) in rays.iter().zip(probe(&buffers.scene(), &rays, precision, false)) {
            assert!(matches!(hits.len(), 0 | 2), "{precision:?} {ray:?}: {hits:?}");
        }
    }
}
