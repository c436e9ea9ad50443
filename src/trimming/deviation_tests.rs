//! The bound of an edge's deviation holds: dense samples of edges and images are never farther apart.

use super::pcurve::{DirectedEdge, edge_images};
use super::segment::point_at;
use super::target::Target;
use super::tests::{cone, cylinder, plane, sphere, torus, tube};
use crate::brep::{Coedge, Edge, Id, Model};
use crate::geometry::{Curve, Frame, Surface, invert_curve};
use crate::numeric::Aabb;
use glam::{DVec2, DVec3};

const SAMPLES: u32 = 400;

/// Fits `curve` over `range` and compares; the greatest distance seen, the bound, and the tolerance.
fn compare(surface: &Surface, curve: &Curve, range: [f64; 2]) -> Option<[f64; 3]> {
    let mut model = Model::default();
    let surface_id = model.surfaces.push(surface.clone());
    let vertices = [Id::new(0); 2];
    let id = model.edges.push(Edge { curve: curve.clone(), range, vertices, pcurves: Vec::new(), entity: 1 });
    let edge = DirectedEdge::new(&model, Coedge { edge: id, reversed: false }).ok()?;
    let bounds = edge.samples().fold(Aabb::EMPTY, Aabb::including);
    let target = Target::new(surface_id, surface, 1e-7, bounds.diagonal(), 10.0);
    let images = edge_images(&target, &edge, None).ok()?;
    let bound = images.iter().map(|image| image.deviation).fold(0.0, f64::max);
    let mut worst = 0.0f64;
    let mut seed = Some(range[0]);
    for segment in images.iter().flat_map(|image| &image.segments) {
        for i in 0..=SAMPLES {
            let point = surface.point(point_at(segment, f64::from(i) / f64::from(SAMPLES)));
            let t = invert_curve(curve, point, seed);
            let t = t.clamp(range[0].min(range[1]), range[0].max(range[1]));
            seed = Some(t);
            worst = worst.max(curve.point(t).distance(point));
        }
    }
    Some([worst, bound, target.tolerance])
}

/// A circle near the surface point `uv`, turned out of the surface by `tilt`.
fn circle(surface: &Surface, uv: DVec2, radius: f64, tilt: f64) -> Curve {
    let d = surface.derivatives(uv);
    let normal = d.du.cross(d.dv).normalize();
    let z = (normal + d.du.normalize() * tilt).normalize();
    Curve::Circle { frame: Frame::from_axes(d.point, Some(z), None), radius }
}

#[test]
fn no_sample_exceeds_the_bound() {
    let surfaces = [plane(), cylinder(), cone(), sphere(), torus(), tube()];
    let mut state = 3u64;
    let mut random = move || {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 11) as f64 / (1u64 << 53) as f64
    };
    let (mut tried, mut tight) = (0, 0);
    for round in 0..240 {
        let surface = &surfaces[round % surfaces.len()];
        let uv = DVec2::new(0.2 + 5.0 * random(), 0.1 + 0.8 * random());
        // Small circles about a point of the surface bulge off it; lines and larger ones are farther off.
        let curve = if round % 5 == 4 {
            let d = surface.derivatives(uv);
            Curve::Line { origin: d.point, direction: d.du.normalize() + d.dv.normalize() * random() }
        } else {
            circle(surface, uv, 0.01 + 0.3 * random(), 0.2 * random())
        };
        let range = if round % 5 == 4 { [0.0, 0.3 * random()] } else { [random(), 1.5 + 4.0 * random()] };
        let range = if random() < 0.5 { range } else { [range[1], range[0]] };
        let Some([worst, bound, tolerance]) = compare(surface, &curve, range) else { continue };
        tried += 1;
        tight += usize::from(bound <= 1.5 * worst + tolerance);
        // Rounding of the distance itself: some roundings of coordinates below 10.
        assert!(worst <= bound + 1e-14, "{worst:e} > {bound:e}: {} {curve:?} {range:?}", surface.kind());
    }
    assert!(tried > 100, "{tried} images");
    // A bound that is always far too large would be no use.
    assert!(tight * 10 >= tried * 9, "{tight} of {tried} bounds are tight");
}

#[test]
fn exact_images_have_no_deviation() {
    let circle = Curve::Circle { frame: Frame { origin: DVec3::Z, ..Frame::IDENTITY }, radius: 2.0 };
    let [worst, bound, _] = compare(&cylinder(), &circle, [0.0, 6.0]).expect("an image");
    assert!(worst < 1e-14 && bound < 1e-14, "{worst:e} {bound:e}");
}
