//! Whole faces: every way in which loops go round seams and poles, and input that is broken.

use super::{FaceTrim, TrimError, TrimOptions, trim_face};
use crate::brep::{Coedge, Edge, Face, Id, Model, TrimLoop, Vertex};
use crate::geometry::{BsplineSurface, Curve, Frame, Homogeneous, Homogeneous3, Surface};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI, TAU};

/// A model with one surface and one face.
pub(super) struct Builder {
    pub(super) model: Model,
    pub(super) face: Face,
}

impl Builder {
    pub(super) fn new(surface: Surface) -> Self {
        let mut model = Model::default();
        let surface = model.surfaces.push(surface);
        let face = Face {
            surface,
            same_sense: true,
            loops: Vec::new(),
            color: None,
            name: String::new(),
            entity: 1,
        };
        Self { model, face }
    }

    fn flipped(mut self) -> Self {
        self.face.same_sense = false;
        self
    }

    pub(super) fn vertex(&mut self, point: DVec3) -> Id<Vertex> {
        let known =
            self.model.vertices.ids().find(|&id| self.model.vertices[id].point.distance(point) < 1e-9);
        known.unwrap_or_else(|| self.model.vertices.push(Vertex { point, entity: 0 }))
    }

    pub(super) fn edge(&mut self, curve: Curve, range: [f64; 2]) -> Id<Edge> {
        let vertices = range.map(|t| self.vertex(curve.point(t)));
        let entity = 100 + self.model.edges.len() as u64;
        self.model.edges.push(Edge { curve, range, vertices, pcurves: Vec::new(), entity })
    }

    pub(super) fn line(&mut self, a: DVec3, b: DVec3) -> Id<Edge> {
        self.edge(Curve::Line { origin: a, direction: b - a }, [0.0, 1.0])
    }

    /// A loop of edges; negative numbers (−1 − i) are edges run backwards.
    pub(super) fn with_loop(&mut self, edges: &[(Id<Edge>, bool)]) {
        let coedges = edges.iter().map(|&(edge, reversed)| Coedge { edge, reversed }).collect();
        self.face.loops.push(TrimLoop::Edges(coedges));
    }

    pub(super) fn polygon(&mut self, points: &[DVec3]) {
        let edges: Vec<(Id<Edge>, bool)> = (0..points.len())
            .map(|i| (self.line(points[i], points[(i + 1) % points.len()]), false))
            .collect();
        self.with_loop(&edges);
    }

    pub(super) fn trim(self) -> Result<FaceTrim, TrimError> {
        let mut model = self.model;
        let face = model.faces.push(self.face);
        trim_face(&model, face, &TrimOptions::default())
    }
}

/// Whether `uv`, wrapped into the window, is inside by an odd number of crossings.
fn inside(trim: &FaceTrim, periods: [Option<f64>; 2], mut uv: DVec2) -> bool {
    for axis in 0..2 {
        if let Some(period) = periods[axis] {
            uv[axis] -= ((uv[axis] - trim.window.min[axis]) / period).floor() * period;
        }
    }
    if uv.cmplt(trim.window.min).any() || uv.cmpgt(trim.window.max).any() {
        return false;
    }
    if trim.curves.is_empty() {
        return true;
    }
    let mut crossings = 0;
    for curve in &trim.curves {
        let (a, b) = (Homogeneous::point(curve.eval(0.0)), Homogeneous::point(curve.eval(1.0)));
        if (a.y <= uv.y) == (b.y <= uv.y) || a.x.max(b.x) < uv.x {
            continue;
        }
        let rising = b.y > a.y;
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..50 {
            let middle = 0.5 * (low + high);
            if (Homogeneous::point(curve.eval(middle)).y <= uv.y) == rising {
                low = middle
            } else {
                high = middle
            }
        }
        crossings += usize::from(Homogeneous::point(curve.eval(low)).x > uv.x);
    }
    crossings % 2 == 1
}

/// The area in space, by midpoints over the window.
pub(super) fn area(surface: &Surface, trim: &FaceTrim) -> f64 {
    let count = 200;
    let step = (trim.window.max - trim.window.min) / f64::from(count);
    let mut sum = 0.0;
    for i in 0..count {
        for j in 0..count {
            let uv = trim.window.min + step * DVec2::new(f64::from(i) + 0.503, f64::from(j) + 0.497);
            if inside(trim, surface.periods(), uv) {
                let d = surface.derivatives(uv);
                sum += d.du.cross(d.dv).length();
            }
        }
    }
    sum * step.x * step.y
}

#[track_caller]
pub(super) fn assert_area(builder: Builder, expected: f64) -> FaceTrim {
    let surface = builder.model.surfaces[builder.face.surface].clone();
    let trim = builder.trim().expect("the face can be trimmed");
    check_invariants(&surface, &trim);
    let found = area(&surface, &trim);
    assert!((found - expected).abs() < 6e-3 * expected, "area {found}, expected {expected}; {trim:?}");
    trim
}

#[track_caller]
fn check_invariants(surface: &Surface, trim: &FaceTrim) {
    for axis in 0..2 {
        if let Some(period) = surface.periods()[axis] {
            assert!(trim.window.max[axis] - trim.window.min[axis] <= period * (1.0 + 1e-14));
        }
    }
    // Every end point is met an even number of times, bit for bit.
    let mut ends: Vec<[u64; 2]> = trim
        .curves
        .iter()
        .flat_map(|c| [c.points[0], c.points[c.points.len() - 1]])
        .map(|p| Homogeneous::point(p) + DVec2::ZERO)
        .map(|p| [p.x.to_bits(), p.y.to_bits()])
        .collect();
    ends.sort_unstable();
    for pair in ends.chunks(2) {
        assert!(pair.len() == 2 && pair[0] == pair[1], "an end point is not shared: {trim:?}");
    }
}

pub(super) fn frame_at(z: f64) -> Frame {
    Frame { origin: DVec3::Z * z, ..Frame::IDENTITY }
}

pub(super) fn circle_at(z: f64, radius: f64) -> Curve {
    Curve::Circle { frame: frame_at(z), radius }
}

/// The great circle through the poles at longitude `u`: latitude as parameter.
pub(super) fn meridian(u: f64, radius: f64) -> Curve {
    let x = DVec3::new(u.cos(), u.sin(), 0.0);
    Curve::Circle { frame: Frame { origin: DVec3::ZERO, x, y: DVec3::Z, z: x.cross(DVec3::Z) }, radius }
}

pub(super) fn plane() -> Surface {
    Surface::Plane { frame: Frame::IDENTITY }
}
pub(super) fn cylinder() -> Surface {
    Surface::Cylinder { frame: Frame::IDENTITY, radius: 2.0 }
}
pub(super) fn sphere() -> Surface {
    Surface::Sphere { frame: Frame::IDENTITY, radius: 2.0 }
}
pub(super) fn torus() -> Surface {
    Surface::Torus { frame: Frame::IDENTITY, major: 5.0, minor: 2.0 }
}

pub(super) fn square(size: f64) -> [DVec3; 4] {
    [(0.0, 0.0), (size, 0.0), (size, size), (0.0, size)].map(|(x, y)| DVec3::new(x, y, 0.0))
}

#[test]
fn rectangle_on_a_plane_needs_no_curves() {
    let mut b = Builder::new(plane());
    b.polygon(&square(3.0));
    assert!(assert_area(b, 9.0).curves.is_empty());
}

#[test]
fn rectangle_with_a_round_hole() {
    let mut b = Builder::new(plane());
    b.polygon(&square(4.0));
    let frame = Frame { origin: DVec3::new(2.0, 2.0, 0.0), ..Frame::IDENTITY };
    let hole = b.edge(Curve::Circle { frame, radius: 1.0 }, [TAU, 0.0]);
    b.with_loop(&[(hole, false)]);
    assert_area(b, 16.0 - PI);
}

fn band(surface: Surface, low: Curve, high: Curve) -> Builder {
    let mut b = Builder::new(surface);
    let (low, high) = (b.edge(low, [0.0, TAU]), b.edge(high, [0.0, TAU]));
    b.with_loop(&[(low, false)]);
    b.with_loop(&[(high, true)]);
    b
}

#[test]
fn full_cylinder_without_seam() {
    let trim = assert_area(band(cylinder(), circle_at(0.0, 2.0), circle_at(3.0, 2.0)), TAU * 6.0);
    assert!(trim.curves.is_empty(), "a rectangle");
}

#[test]
fn full_cylinder_with_seam_edge() {
    for start in 0..4 {
        let mut b = Builder::new(cylinder());
        let low = b.edge(circle_at(0.0, 2.0), [0.0, TAU]);
        let high = b.edge(circle_at(3.0, 2.0), [0.0, TAU]);
        let seam = b.line(DVec3::new(2.0, 0.0, 0.0), DVec3::new(2.0, 0.0, 3.0));
        let mut edges = [(low, false), (seam, false), (high, true), (seam, true)];
        edges.rotate_left(start);
        b.with_loop(&edges);
        assert!(assert_area(b, TAU * 6.0).curves.is_empty(), "a rectangle");
    }
}

#[test]
fn half_cylinder() {
    let mut b = Builder::new(cylinder());
    let low = b.edge(circle_at(0.0, 2.0), [2.0, 2.0 + PI]);
    let high = b.edge(circle_at(3.0, 2.0), [2.0, 2.0 + PI]);
    let at = |t: f64, z: f64| DVec3::new(2.0 * t.cos(), 2.0 * t.sin(), z);
    let right = b.line(at(2.0 + PI, 0.0), at(2.0 + PI, 3.0));
    let left = b.line(at(2.0, 0.0), at(2.0, 3.0));
    b.with_loop(&[(low, false), (right, false), (high, true), (left, true)]);
    assert!(assert_area(b, PI * 6.0).curves.is_empty(), "a rectangle");
}

fn oblique() -> Curve {
    // z = 3 + x: semi-axes 2 √2 in the plane and 2 across.
    let x = DVec3::new(1.0, 0.0, 1.0).normalize();
    let frame = Frame { origin: DVec3::Z * 3.0, x, y: DVec3::Y, z: x.cross(DVec3::Y) };
    Curve::Ellipse { frame, radii: [8.0f64.sqrt(), 2.0] }
}

#[test]
fn cylinder_cut_obliquely() {
    let trim = assert_area(band(cylinder(), circle_at(0.0, 2.0), oblique()), TAU * 6.0);
    assert!(trim.edges.iter().all(|edge| edge.distance < 1e-6));
}

#[test]
fn hole_through_a_cylinder_across_the_seam() {
    for turn in [0.0, 1.0, PI] {
        let mut b = band(cylinder(), circle_at(0.0, 2.0), circle_at(4.0, 2.0));
        // A rectangle of the parameter plane, 1 rad wide and 2 high, centred at u = turn.
        let (from, to) = (turn - 0.5, turn + 0.5);
        let at = |t: f64, z: f64| DVec3::new(2.0 * t.cos(), 2.0 * t.sin(), z);
        let low = b.edge(circle_at(1.0, 2.0), [from, to]);
        let high = b.edge(circle_at(3.0, 2.0), [from, to]);
        let (left, right) = (b.line(at(from, 1.0), at(from, 3.0)), b.line(at(to, 1.0), at(to, 3.0)));
        b.with_loop(&[(left, false), (high, false), (right, true), (low, true)]);
        assert_area(b, TAU * 8.0 - 4.0);
    }
}

#[test]
fn helical_strip_of_three_turns() {
    // Not a real thread flank, but a region that covers each place once and is three periods long.
    let mut b = Builder::new(cylinder());
    let helix = |offset: f64| {
        let count = 160;
        let at = |i: i32| {
            let t = 3.0 * TAU * f64::from(i) / f64::from(count);
            DVec3::new(2.0 * t.cos(), 2.0 * t.sin(), t / TAU + offset)
        };
        (0..=count).map(at).collect::<Vec<DVec3>>()
    };
    let (low, high) = (helix(0.0), helix(0.5));
    let mut outline = low.clone();
    outline.extend(high.iter().rev());
    // Chords lie up to r (1 − cos(h/2)) = 0.7 % of r below the surface; the tolerance for bad files takes that.
    b.polygon(&outline);
    assert_area(b, 3.0 * TAU * 2.0 * 0.5);
}

#[test]
fn whole_sphere_by_a_vertex() {
    let mut b = Builder::new(sphere());
    let pole = b.vertex(DVec3::Z * 2.0);
    b.face.loops.push(TrimLoop::Vertex(pole));
    assert_area(b, 16.0 * PI);
}

#[test]
fn whole_sphere_with_a_seam() {
    for flipped in [false, true] {
        let mut b = Builder::new(sphere());
        let seam = b.edge(meridian(0.0, 2.0), [-FRAC_PI_2, FRAC_PI_2]);
        b.with_loop(&[(seam, false), (seam, true)]);
        assert_area(if flipped { b.flipped() } else { b }, 16.0 * PI);
    }
}

#[test]
fn caps_of_a_sphere() {
    let cap = |reversed: bool, flipped: bool| {
        let mut b = Builder::new(sphere());
        let rim = b.edge(circle_at(1.0, 3.0f64.sqrt()), [0.0, TAU]);
        b.with_loop(&[(rim, reversed)]);
        if flipped { b.flipped() } else { b }
    };
    let (upper, lower) = (4.0 * PI, 12.0 * PI);
    assert_area(cap(false, false), upper);
    assert_area(cap(true, false), lower);
    assert_area(cap(false, true), lower);
    assert_area(cap(true, true), upper);
}

#[test]
fn hemisphere_with_a_seam_to_the_pole() {
    let mut b = Builder::new(sphere());
    let rim = b.edge(circle_at(0.0, 2.0), [0.0, TAU]);
    let seam = b.edge(meridian(0.0, 2.0), [0.0, FRAC_PI_2]);
    b.with_loop(&[(rim, false), (seam, false), (seam, true)]);
    assert!(assert_area(b, 8.0 * PI).curves.is_empty(), "a rectangle");
}

#[test]
fn octant_of_a_sphere_whatever_its_direction() {
    for (reversed, expected) in [(false, 2.0 * PI), (true, 2.0 * PI)] {
        let mut b = Builder::new(sphere());
        let rim = b.edge(circle_at(0.0, 2.0), [1.0, 1.0 + FRAC_PI_2]);
        let right = b.edge(meridian(1.0 + FRAC_PI_2, 2.0), [0.0, FRAC_PI_2]);
        let left = b.edge(meridian(1.0, 2.0), [FRAC_PI_2, 0.0]);
        let mut edges = vec![(rim, reversed), (right, reversed), (left, reversed)];
        if reversed {
            edges.reverse();
        }
        b.with_loop(&edges);
        assert_area(b, expected);
    }
}

#[test]
fn lunes_of_a_sphere() {
    for width in [1.0, 4.0] {
        for flipped in [false, true] {
            let mut b = Builder::new(sphere());
            let right = b.edge(meridian(width, 2.0), [-FRAC_PI_2, FRAC_PI_2]);
            let left = b.edge(meridian(0.0, 2.0), [-FRAC_PI_2, FRAC_PI_2]);
            b.with_loop(&[(right, false), (left, true)]);
            let b = if flipped { b.flipped() } else { b };
            assert_area(b, 8.0 * if flipped { TAU - width } else { width });
        }
    }
}

#[test]
fn sphere_cut_through_its_pole_by_one_circle() {
    // The plane through the axis: one closed edge through both poles.
    let mut b = Builder::new(sphere());
    let rim = b.edge(meridian(0.5, 2.0), [0.3, 0.3 + TAU]);
    b.with_loop(&[(rim, false)]);
    assert_area(b, 8.0 * PI);
}

pub(super) fn cone() -> Surface {
    // r = 1 + z, the apex at z = −1.
    Surface::Cone { frame: Frame::IDENTITY, radius: 1.0, half_angle: FRAC_PI_4 }
}

#[test]
fn cone_to_its_apex() {
    for with_vertex in [false, true] {
        let mut b = Builder::new(cone());
        let rim = b.edge(circle_at(1.0, 2.0), [0.0, TAU]);
        b.with_loop(&[(rim, true)]);
        if with_vertex {
            let apex = b.vertex(-DVec3::Z);
            b.face.loops.push(TrimLoop::Vertex(apex));
        }
        assert_area(b, PI * 2.0 * 8.0f64.sqrt());
    }
    let mut b = Builder::new(cone());
    let rim = b.edge(circle_at(1.0, 2.0), [0.0, TAU]);
    let seam = b.line(-DVec3::Z, DVec3::new(2.0, 0.0, 1.0));
    b.with_loop(&[(rim, true), (seam, true), (seam, false)]);
    assert_area(b, PI * 2.0 * 8.0f64.sqrt());
}

#[test]
fn truncated_cone() {
    let surface_area = PI * (2.0 * 8.0f64.sqrt() - 2.0f64.sqrt());
    assert_area(band(cone(), circle_at(0.0, 1.0), circle_at(1.0, 2.0)), surface_area);
}

#[test]
fn whole_torus_with_two_seams() {
    let mut b = Builder::new(torus());
    let long = b.edge(circle_at(0.0, 7.0), [0.0, TAU]);
    let frame = Frame { origin: DVec3::X * 5.0, x: DVec3::X, y: DVec3::Z, z: -DVec3::Y };
    let short = b.edge(Curve::Circle { frame, radius: 2.0 }, [0.0, TAU]);
    b.with_loop(&[(long, false), (short, false), (long, true), (short, true)]);
    assert!(assert_area(b, 40.0 * PI * PI).curves.is_empty());
}

#[test]
fn torus_bands() {
    // Between the outermost and the uppermost circle: v from 0 to π/2; the other way round it is the rest.
    let quarter = TAU * (5.0 * 2.0 * FRAC_PI_2 + 4.0);
    assert_area(band(torus(), circle_at(0.0, 7.0), circle_at(2.0, 5.0)), quarter);
    assert_area(band(torus(), circle_at(2.0, 5.0), circle_at(0.0, 7.0)), 40.0 * PI * PI - quarter);
    // Along v: a quarter of a pipe bend.
    let mut b = Builder::new(torus());
    let mut section = |u: f64| {
        let x = DVec3::new(u.cos(), u.sin(), 0.0);
        let frame = Frame { origin: x * 5.0, x, y: DVec3::Z, z: x.cross(DVec3::Z) };
        b.edge(Curve::Circle { frame, radius: 2.0 }, [0.0, TAU])
    };
    let (first, second) = (section(-0.3), section(1.2));
    b.with_loop(&[(first, true)]);
    b.with_loop(&[(second, false)]);
    assert_area(b, 1.5 * 5.0 * TAU * 2.0);
}

#[test]
fn torus_fillet_across_both_seams() {
    let mut b = Builder::new(torus());
    let at = |u: f64, v: f64| torus().point(DVec2::new(u, v));
    let mut parallel = |v: f64| b.edge(circle_at(2.0 * v.sin(), 5.0 + 2.0 * v.cos()), [-0.7, 0.8]);
    let (low, high) = (parallel(-0.5), parallel(0.9));
    let mut section = |u: f64| {
        let x = DVec3::new(u.cos(), u.sin(), 0.0);
        let frame = Frame { origin: x * 5.0, x, y: DVec3::Z, z: x.cross(DVec3::Z) };
        b.edge(Curve::Circle { frame, radius: 2.0 }, [-0.5, 0.9])
    };
    let (left, right) = (section(-0.7), section(0.8));
    assert!(at(-0.7, -0.5).is_finite());
    b.with_loop(&[(low, false), (right, false), (high, true), (left, true)]);
    let expected = 1.5 * 2.0 * (5.0 * 1.4 + 2.0 * (0.9f64.sin() + 0.5f64.sin()));
    assert!(assert_area(b, expected).curves.is_empty());
}

/// A tube of square section with rounded corners, closed along u.
pub(super) fn tube() -> Surface {
    let mut points = Vec::new();
    for i in 0..=8 {
        let angle = TAU * f64::from(i % 8) / 8.0;
        for z in [0.0, 4.0] {
            points.push(Homogeneous3::new(2.0 * angle.cos(), 2.0 * angle.sin(), z, 1.0));
        }
    }
    let u: Vec<f64> = [0.0; 3].into_iter().chain((1..7).map(f64::from)).chain([7.0; 3]).collect();
    let v = vec![0.0, 0.0, 1.0, 1.0];
    Surface::Bspline(BsplineSurface::new([2, 1], [u, v], points).expect("a proper surface"))
}

/// The section of the tube at height z.
pub(super) fn tube_section(z: f64) -> Curve {
    let Surface::Bspline(surface) = tube() else { unreachable!() };
    let points = surface.points.chunks(2).map(|p| Homogeneous3::new(p[0].x, p[0].y, z, 1.0)).collect();
    Curve::Bspline(
        crate::geometry::BsplineCurve::new(2, surface.u_knots.as_slice().to_vec(), points).expect("proper"),
    )
}

#[test]
fn closed_bspline_tube() {
    let whole = {
        let trim = FaceTrim::whole(tube().domain());
        area(&tube(), &trim)
    };
    assert_eq!(tube().periods(), [Some(7.0), None]);
    for start in 0..4 {
        let mut b = Builder::new(tube());
        let (low, high) = (b.edge(tube_section(0.0), [0.0, 7.0]), b.edge(tube_section(2.0), [0.0, 7.0]));
        let seam = b.line(DVec3::new(2.0, 0.0, 0.0), DVec3::new(2.0, 0.0, 2.0));
        let mut edges = [(low, false), (seam, false), (high, true), (seam, true)];
        edges.rotate_left(start);
        b.with_loop(&edges);
        assert!(assert_area(b, 0.5 * whole).curves.is_empty());
    }
    let mut b = Builder::new(tube());
    let (low, high) = (b.edge(tube_section(1.0), [0.0, 7.0]), b.edge(tube_section(2.0), [0.0, 7.0]));
    b.with_loop(&[(low, false)]);
    b.with_loop(&[(high, true)]);
    assert_area(b, 0.25 * whole);
}

#[test]
fn order_and_direction_are_repaired() {
    let points = square(3.0);
    let mut b = Builder::new(plane());
    let edges: Vec<Id<Edge>> = (0..4).map(|i| b.line(points[i], points[(i + 1) % 4])).collect();
    b.with_loop(&[(edges[0], false), (edges[2], true), (edges[3], false), (edges[1], false)]);
    let trim = assert_area(b, 9.0);
    assert_eq!(trim.repairs.len(), 1);
}

#[test]
fn gaps_and_edges_without_length() {
    let mut b = Builder::new(plane());
    let p = square(3.0);
    let edges = [
        b.line(p[0], p[1]),
        b.line(p[1], p[1]),
        b.line(p[1], p[2]),
        b.line(p[2], p[3] + DVec3::X * 0.01),
        b.line(p[3], p[0]),
    ];
    b.with_loop(&edges.map(|e| (e, false)));
    let trim = assert_area(b, 9.0);
    assert!(trim.repairs.iter().any(|r| r.contains("gap")), "{:?}", trim.repairs);
}

#[test]
fn damage_is_an_error_or_a_region_and_never_a_panic() {
    let mut state = 11u64;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (state >> 33) as usize % below
    };
    let surfaces = [plane(), cylinder(), cone(), sphere(), torus(), tube()];
    for round in 0..240 {
        let mut b = Builder::new(surfaces[round % surfaces.len()].clone());
        b.face.same_sense = random(2) == 0;
        let curves = [
            circle_at(0.0, 2.0),
            circle_at(1.0, 2.0),
            circle_at(0.0, 7.0),
            meridian(0.0, 2.0),
            meridian(1.0, 2.0),
            oblique(),
            tube_section(1.0),
            Curve::Line { origin: DVec3::new(2.0, 0.0, 0.0), direction: DVec3::Z },
            Curve::Line { origin: DVec3::NEG_Z, direction: DVec3::new(1.0, 0.0, 1.0) },
        ];
        let numbers = [0.0, 1.0, -FRAC_PI_2, FRAC_PI_2, TAU, 7.0, 1e-13, -1e9, 1e300, f64::NAN];
        for _ in 0..1 + random(2) {
            let mut edges = Vec::new();
            for _ in 0..1 + random(4) {
                let curve = curves[random(curves.len())].clone();
                let usual = if random(4) == 0 { numbers.len() } else { 6 };
                let range = [numbers[random(usual)], numbers[random(usual)]];
                edges.push((b.edge(curve, range), random(2) == 0));
            }
            b.with_loop(&edges);
        }
        let surface = surfaces[round % surfaces.len()].clone();
        if let Ok(trim) = b.trim() {
            assert!(trim.window.min.is_finite() && trim.window.max.is_finite());
            check_invariants(&surface, &trim);
        }
    }
}

#[test]
fn what_cannot_be_trimmed_is_an_error() {
    let mut b = Builder::new(cylinder());
    let low = b.edge(circle_at(0.0, 2.0), [0.0, TAU]);
    b.with_loop(&[(low, false)]);
    assert!(matches!(b.trim(), Err(TrimError::Unbounded(_))));

    assert!(matches!(Builder::new(plane()).trim(), Err(TrimError::Unbounded(_))));

    let mut b = Builder::new(plane());
    b.polygon(&[DVec3::ZERO, DVec3::X]);
    assert!(matches!(b.trim(), Err(TrimError::Empty)));

    let mut b = Builder::new(cylinder());
    b.polygon(&square(3.0));
    assert!(matches!(b.trim(), Err(TrimError::OffSurface { .. })));

    for bad in [f64::NAN, f64::INFINITY] {
        let mut b = Builder::new(sphere());
        let rim = b.edge(circle_at(0.0, 2.0), [0.0, 1.0]);
        b.model.edges[rim].range[1] = bad;
        b.with_loop(&[(rim, false)]);
        assert!(matches!(b.trim(), Err(TrimError::Numeric(_))));
    }
}
