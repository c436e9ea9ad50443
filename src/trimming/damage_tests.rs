//! What files do to faces: poles that are holes, pinched tori, broken loops, pcurves that lie, loops that cross themselves,
//! models of a micrometre and of a kilometre.

use super::tests::{
    Builder, area, assert_area, circle_at, cylinder, frame_at, plane, sphere, square, torus, tube,
    tube_section,
};
use super::{TrimError, TrimOptions, trim_face};
use crate::brep::{Edge, Id, Pcurve};
use crate::geometry::to_bspline::{curve_to_bspline, revolve};
use crate::geometry::{BsplineSurface, Curve, Curve2, Frame, Homogeneous, Homogeneous3, Surface};
use glam::{DAffine3, DQuat, DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// The circle of the tube of a torus at longitude `u`, with the tube's angle as parameter.
fn tube_circle(major: f64, minor: f64, u: f64) -> Curve {
    let x = DVec3::new(u.cos(), u.sin(), 0.0);
    Curve::Circle { frame: Frame { origin: x * major, x, y: DVec3::Z, z: x.cross(DVec3::Z) }, radius: minor }
}

#[test]
fn sector_of_a_horn_torus_through_its_pinch() {
    // Exactly a horn, and off it by rounding to either side.
    for major in [1.0, 1.0 - 4e-15, 1.0 + 4e-15] {
        for flipped in [false, true] {
            let mut b = Builder::new(Surface::Torus { frame: Frame::IDENTITY, major, minor: 1.0 });
            let low = b.edge(tube_circle(major, 1.0, 0.3), [-PI, 0.5]);
            let high = b.edge(tube_circle(major, 1.0, 0.3), [0.5, PI]);
            let back_high = b.edge(tube_circle(major, 1.0, 1.1), [-PI, -0.5]);
            let back_low = b.edge(tube_circle(major, 1.0, 1.1), [-0.5, PI]);
            let mut edges = vec![(back_high, false), (back_low, false), (high, true), (low, true)];
            if flipped {
                edges.reverse();
                edges.iter_mut().for_each(|edge| edge.1 ^= true);
                b.face.same_sense = false;
            }
            b.with_loop(&edges);
            assert_area(b, 0.8 * TAU);
        }
    }
}

#[test]
fn both_sheets_of_a_spindle_torus() {
    let (major, minor) = (1.0f64, 2.0f64);
    let spindle = || Surface::Torus { frame: Frame::IDENTITY, major, minor };
    let pole = (-major / minor).acos();
    // ∫ 2π r |R + r cos v| dv.
    let apple = |a: f64, b: f64| TAU * minor * (major * (b - a) + minor * (b.sin() - a.sin()));
    // Without edges it is the outer sheet.
    assert_area(Builder::new(spindle()), apple(-pole, pole));
    let parallel = |v: f64| circle_at(minor * v.sin(), (major + minor * v.cos()).abs());
    // One circle on the outer sheet, the face above it up to the pole and below it down to the other pole.
    for (reversed, expected) in [(false, apple(0.4, pole)), (true, apple(-pole, 0.4))] {
        let mut b = Builder::new(spindle());
        let rim = b.edge(parallel(0.4), [0.0, TAU]);
        b.with_loop(&[(rim, reversed)]);
        assert_area(b, expected);
    }
    // On the inner one, between the poles at v and 2π − v: the lemon above its equator.
    let v = PI - 0.2;
    let mut b = Builder::new(spindle());
    let rim = b.edge(parallel(v), [0.0, TAU]);
    b.with_loop(&[(rim, true)]);
    let trim = assert_area(b, -apple(pole, v));
    assert!((trim.window.min.y - pole).abs() < 1e-9 && (trim.window.max.y - v).abs() < 1e-6, "{trim:?}");
}

#[test]
fn cone_whose_generator_misses_the_axis() {
    // The hole where the apex should be is 1e-3 of the cone's size; the edges end in the middle of it.
    let generator =
        Curve::Line { origin: DVec3::new(0.01, 0.0, 0.0), direction: DVec3::new(3.0, 0.01, -4.0) };
    let net = revolve(&curve_to_bspline(&generator, [0.0, 1.0]), &Frame::IDENTITY);
    let rim = 3.01f64.hypot(0.01);
    let half = 0.5 * PI * rim * 5.0;
    for left in [false, true] {
        let mut b = Builder::new(Surface::Bspline(net.clone()));
        let angle = 0.01f64.atan2(3.01);
        let at = |u: f64| DVec3::new(rim * u.cos(), rim * u.sin(), -4.0);
        let arc = b.edge(circle_at(-4.0, rim), [angle, angle + PI]);
        let up = b.line(at(angle + PI), DVec3::ZERO);
        let down = b.line(DVec3::ZERO, at(angle));
        b.with_loop(&[(arc, false), (up, false), (down, false)]);
        b.face.same_sense = left;
        assert_area(b, half);
    }
}

#[test]
fn a_broken_hole_is_lost_and_a_broken_boundary_costs_the_face() {
    let with_loops = |outer_height: f64, hole_height: f64| {
        let mut b = Builder::new(plane());
        b.polygon(&square(4.0).map(|p| p + DVec3::Z * outer_height));
        b.polygon(&square(1.0).map(|p| p + DVec3::new(1.0, 1.0, hole_height)));
        b
    };
    let sound = assert_area(with_loops(0.0, 0.0), 15.0);
    assert!(sound.losses.is_empty());
    let lossy = assert_area(with_loops(0.0, 2.0), 16.0);
    assert!(lossy.losses[0].starts_with("a hole is lost"), "{:?}", lossy.losses);
    assert!(matches!(with_loops(2.0, 0.0).trim(), Err(TrimError::OffSurface { .. })));
    // A loop of unknown size may be the outer one.
    let mut b = Builder::new(plane());
    b.polygon(&square(4.0));
    let line = b.line(DVec3::ZERO, DVec3::X);
    b.model.edges[line].range[1] = f64::NAN;
    b.with_loop(&[(line, false)]);
    assert!(matches!(b.trim(), Err(TrimError::Numeric(_))));
    // Both rims of a cylinder are needed.
    let mut b = Builder::new(cylinder());
    let (low, high) = (b.edge(circle_at(0.0, 2.0), [0.0, TAU]), b.edge(circle_at(3.0, 0.5), [0.0, TAU]));
    b.with_loop(&[(low, false)]);
    b.with_loop(&[(high, true)]);
    assert!(b.trim().is_err());
}

/// A sheet that runs along x from 0 to 1 for u up to 1/2, and all the way back on itself.
fn folded_sheet() -> Surface {
    let rows = [0.0, 1.0, 0.0].into_iter();
    let points: Vec<Homogeneous3> =
        rows.flat_map(|x| [0.0, 1.0].map(|y| Homogeneous::new(DVec3::new(x, y, 0.0), 1.0))).collect();
    let knots = [vec![0.0, 0.0, 0.5, 1.0, 1.0], vec![0.0, 0.0, 1.0, 1.0]];
    Surface::Bspline(BsplineSurface::new([1, 1], knots, points).expect("proper"))
}

#[test]
fn pcurves_tell_the_sheet_where_they_lie_on_the_edge() {
    let corners = [(0.2, 0.1), (0.6, 0.1), (0.6, 0.9), (0.2, 0.9)].map(|(x, y)| DVec3::new(x, y, 0.0));
    let window = |image: Option<&dyn Fn(DVec3) -> DVec2>| {
        let mut b = Builder::new(folded_sheet());
        b.polygon(&corners);
        if let Some(image) = image {
            for id in b.model.edges.ids() {
                let [from, to] = [0.0, 1.0].map(|t| image(b.model.edges[id].curve.point(t)));
                let curve = Curve2::Line { origin: from, direction: to - from };
                b.model.edges[id].pcurves.push(Pcurve { surface: Id::new(0), curve });
            }
        }
        assert_area(b, 0.4 * 0.8).window
    };
    let second = window(Some(&|p| DVec2::new(1.0 - 0.5 * p.x, p.y)));
    assert!(second.min.distance(DVec2::new(0.7, 0.1)) < 1e-9, "{second:?}");
    let first = window(Some(&|p| DVec2::new(0.5 * p.x, p.y)));
    assert!(first.min.distance(DVec2::new(0.1, 0.1)) < 1e-9, "{first:?}");
    // A pcurve that lies elsewhere is as good as none.
    assert_eq!(window(Some(&|p| DVec2::new(0.3 * p.x, p.y))), window(None));
}

#[test]
fn loops_that_cross_or_touch_themselves_are_even_and_odd() {
    let at = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    let mut bow = Builder::new(plane());
    bow.polygon(&[at(0.0, 0.0), at(2.0, 2.0), at(2.0, 0.0), at(0.0, 2.0)]);
    assert_area(bow, 2.0);
    // Two squares that meet in one corner, as one loop.
    let mut chain = Builder::new(plane());
    chain.polygon(&[
        at(0.0, 0.0),
        at(1.0, 0.0),
        at(1.0, 1.0),
        at(2.0, 1.0),
        at(2.0, 2.0),
        at(1.0, 2.0),
        at(1.0, 1.0),
        at(0.0, 1.0),
    ]);
    assert_area(chain, 2.0);
}

#[test]
fn faces_thinner_than_the_tolerance_are_slivers() {
    let mut b = Builder::new(plane());
    b.polygon(&square(1.0).map(|p| p * DVec3::new(1.0, 1e-14, 1.0)));
    assert!(matches!(b.trim(), Err(TrimError::Empty)));
}

#[test]
fn edges_a_little_beyond_the_sides_of_a_net_end_on_them() {
    let whole = {
        let mut b = Builder::new(tube());
        let rims = [0.0, 4.0].map(|z| b.edge(tube_section(z), [0.0, 7.0]));
        b.with_loop(&[(rims[0], false)]);
        b.with_loop(&[(rims[1], true)]);
        let trim = b.trim().expect("a whole tube");
        area(&tube(), &trim)
    };
    let mut b = Builder::new(tube());
    let rims = [-0.01, 4.01].map(|z| b.edge(tube_section(z), [0.0, 7.0]));
    b.with_loop(&[(rims[0], false)]);
    b.with_loop(&[(rims[1], true)]);
    let trim = assert_area(b, whole);
    assert!(trim.edges.iter().all(|edge| (edge.distance - 0.01).abs() < 1e-4), "{:?}", trim.edges);
}

/// A face of every kind, with a hole, a seam or a pole.
fn faces() -> Vec<(Builder, f64)> {
    let mut disc = Builder::new(plane());
    let (rim, hole) =
        (disc.edge(circle_at(0.0, 2.0), [0.0, TAU]), disc.edge(circle_at(0.0, 1.0), [0.0, TAU]));
    disc.with_loop(&[(rim, false)]);
    disc.with_loop(&[(hole, true)]);
    let mut band = Builder::new(cylinder());
    let (low, high) =
        (band.edge(circle_at(0.0, 2.0), [0.0, TAU]), band.edge(circle_at(3.0, 2.0), [0.0, TAU]));
    let seam = band.line(DVec3::new(2.0, 0.0, 0.0), DVec3::new(2.0, 0.0, 3.0));
    band.with_loop(&[(low, false), (seam, false), (high, true), (seam, true)]);
    let mut cap = Builder::new(sphere());
    let rim = cap.edge(circle_at(1.0, 3.0f64.sqrt()), [0.0, TAU]);
    cap.with_loop(&[(rim, false)]);
    let mut bend = Builder::new(torus());
    let sections = [-0.3, 1.2].map(|u| bend.edge(tube_circle(5.0, 2.0, u), [0.0, TAU]));
    bend.with_loop(&[(sections[0], true)]);
    bend.with_loop(&[(sections[1], false)]);
    vec![(disc, 3.0 * PI), (band, 12.0 * PI), (cap, 4.0 * PI), (bend, 1.5 * 5.0 * TAU * 2.0)]
}

#[test]
fn no_size_and_no_place_is_special() {
    // From a part of 1e-3 mm to one of 1e6 mm; and far out, at 1e6 of its sizes.
    for (scale, offset) in [(3e-4, 0.0), (3e5, 0.0), (1.0, 4e6), (3e-4, 1e3)] {
        let turn = DQuat::from_euler(glam::EulerRot::XYZ, 0.3, -0.7, 1.1);
        let place = DAffine3::from_scale_rotation_translation(
            DVec3::splat(scale),
            turn,
            DVec3::new(offset, -0.5 * offset, 0.25 * offset),
        );
        for (mut b, expected) in faces() {
            let surface = b.face.surface;
            b.model.surfaces[surface] = b.model.surfaces[surface].transformed(&place).0;
            for id in b.model.edges.ids() {
                let moved: &mut Edge = &mut b.model.edges[id];
                // Lines measure their parameter in their direction, so ranges stay.
                moved.curve = moved.curve.transformed(&place);
            }
            let trim = assert_area(b, expected * scale * scale);
            let worst = trim.edges.iter().map(|edge| edge.distance / trim.size).fold(0.0, f64::max);
            assert!(worst < 1e-6 + 1e-13 * offset / scale, "{worst} at scale {scale}, offset {offset}");
        }
    }
}

#[test]
fn one_cylinder_as_two_faces() {
    let mut total = 0.0;
    for start in [0.0, PI] {
        let mut b = Builder::new(cylinder());
        let arc = |b: &mut Builder, z: f64| b.edge(circle_at(z, 2.0), [start, start + PI]);
        let (low, high) = (arc(&mut b, 0.0), arc(&mut b, 3.0));
        let at = |u: f64, z: f64| DVec3::new(2.0 * u.cos(), 2.0 * u.sin(), z);
        let (left, right) =
            (b.line(at(start, 0.0), at(start, 3.0)), b.line(at(start + PI, 0.0), at(start + PI, 3.0)));
        b.with_loop(&[(low, false), (right, false), (high, true), (left, true)]);
        let trim = assert_area(b, 6.0 * PI);
        total += trim.window.max.x - trim.window.min.x;
    }
    assert!((total - TAU).abs() < 1e-12);
}

#[test]
fn frames_may_stand_anywhere_on_the_axis() {
    // A quarter of a cylinder from a frame far below: heights are far from 0.
    let mut b = Builder::new(Surface::Cylinder { frame: frame_at(-1e5), radius: 2.0 });
    let (low, high) =
        (b.edge(circle_at(0.0, 2.0), [0.0, FRAC_PI_2]), b.edge(circle_at(1.0, 2.0), [0.0, FRAC_PI_2]));
    let (left, right) = (
        b.line(DVec3::X * 2.0, DVec3::new(2.0, 0.0, 1.0)),
        b.line(DVec3::Y * 2.0, DVec3::new(0.0, 2.0, 1.0)),
    );
    b.with_loop(&[(low, false), (right, false), (high, true), (left, true)]);
    let mut model = b.model;
    let face = model.faces.push(b.face);
    let trim = trim_face(&model, face, &TrimOptions::default()).expect("a quarter");
    assert!(trim.curves.is_empty(), "a rectangle");
}
