//! Hits against analytic truth: spheres, cylinders and tori, as such and as rational B-splines, in f64 within 10⁻¹² of their size.
//!
//! A hit lies on its ray, so that it is right where the surface's own equation holds at it; counts are those of the equation's real roots.

use glam::DVec3;
use trimray::bake::{BakeOptions, bake};
use trimray::bench::chord;
use trimray::brep::{Body, BodyKind, Face, Model, Part};
use trimray::geometry::{BsplineSurface, Frame, Homogeneous, Surface};
use trimray::render::Ray;
use trimray::render::cpu::{Precision, probe};
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
    let body = Body { kind: BodyKind::Solid, faces: vec![face], name: String::new(), entity: 2 };
    let part = Part { name: "part".into(), bodies: vec![body], children: vec![], entity: 3 };
    let part = model.parts.push(part);
    model.roots.push(part);
    model.declared_faces = 1;
    let buffers = bake(&model, &BakeOptions { keep_f64: true, ..BakeOptions::default() }, &|_, _| {});
    assert_eq!(buffers.faces.len(), 1, "{:?}", buffers.metadata.findings);
    buffers
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
        hits.iter().for_each(|hit| worst = worst.max(off(ray.origin + ray.direction * hit.t).abs()));
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
