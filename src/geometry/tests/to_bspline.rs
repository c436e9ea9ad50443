use super::samples;
use crate::geometry::to_bspline::{curve_to_bspline, extrude, revolve};
use crate::geometry::{BsplineCurve, Curve, Frame, Homogeneous, Surface, invert_curve, invert_surface};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

fn tilted() -> Frame {
    Frame::from_axes(DVec3::new(1.0, 2.0, 3.0), Some(DVec3::new(1.0, 1.0, 0.5)), None)
}

#[test]
fn converted_curves_are_the_curve() {
    let frame = tilted();
    let curves = [
        Curve::Line { origin: DVec3::ONE, direction: DVec3::new(1.0, -2.0, 0.5) },
        Curve::Circle { frame, radius: 3.0 },
        Curve::Ellipse { frame, radii: [5.0, 0.7] },
        Curve::Parabola { frame, focal: 0.7 },
        Curve::Hyperbola { frame, radii: [2.0, 0.5] },
    ];
    for curve in curves {
        for range in [[0.0, TAU], [0.3, 0.5], [-1.0, 3.0], [2.0, -1.5], [TAU, 0.0]] {
            let spline = curve_to_bspline(&curve, range);
            let points: Vec<_> = spline.points.iter().map(|p| p.w).collect();
            assert!(points.iter().all(|w| *w > 0.5 && *w < 2.0));
            let [first, last] = spline.domain();
            let mut before = range[0];
            for i in 0..=50 {
                let point = Homogeneous::point(spline.eval(first + (last - first) * f64::from(i) / 50.0));
                let t = invert_curve(&curve, point, Some(before));
                assert!(curve.point(t).distance(point) < 1e-12 * (1.0 + point.length()), "{curve:?}");
                // Forward in the range, from end to end.
                let towards = (range[1] - range[0]).signum();
                assert!((t - before) * towards > -1e-9 && (range[1] - t) * towards > -1e-9, "{curve:?} {t}");
                before = t;
            }
            assert!((before - range[1]).abs() < 1e-9);
        }
    }
}

#[test]
fn converted_bsplines_keep_their_parameter() {
    samples::check(100, |u| {
        let spline = samples::curve(u)?;
        let [first, last] = spline.domain();
        let curve = Curve::Bspline(spline);
        let (a, b) = (samples::number(u, first, last)?, samples::number(u, first, last)?);
        let converted = curve_to_bspline(&curve, [a, b]);
        let sign = if a <= b { 1.0 } else { -1.0 };
        for share in [0.0, 0.3, 1.0] {
            let t = a + (b - a) * share;
            assert!(Homogeneous::point(converted.eval(sign * t)).distance(curve.point(t)) < 1e-11);
        }
        Ok(())
    });
}

#[test]
fn closed_bsplines_unroll_over_the_seam() {
    let circle = Curve::Circle { frame: tilted(), radius: 2.0 };
    let mut spline = curve_to_bspline(&circle, [0.0, TAU]);
    // Unequal weights at the two ends of the same closed curve.
    spline.points.iter_mut().enumerate().for_each(|(i, p)| *p *= 1.1_f64.powi(i as i32));
    let curve = Curve::Bspline(spline);
    assert!(curve.period().is_some_and(|period| (period - TAU).abs() < 1e-15));
    for range in [[5.0, 8.0], [-1.0, 0.5], [-1.0, 14.0], [7.0, 5.5], [TAU, 2.0 * TAU]] {
        let unrolled = curve_to_bspline(&curve, range);
        let sign = if range[0] <= range[1] { 1.0 } else { -1.0 };
        for i in 0..=30 {
            let t = range[0] + (range[1] - range[0]) * f64::from(i) / 30.0;
            assert!(
                Homogeneous::point(unrolled.eval(sign * t)).distance(curve.point(t)) < 1e-10,
                "{range:?} {t}"
            );
        }
    }
}

#[test]
fn ranges_without_sense_give_a_point() {
    let circle = Curve::Circle { frame: Frame::IDENTITY, radius: 1.0 };
    for range in [[0.5, 0.5], [f64::NAN, 1.0], [0.0, f64::INFINITY], [f64::MIN, f64::MAX]] {
        let spline: BsplineCurve<_> = curve_to_bspline(&circle, range);
        assert!(spline.points.iter().all(|p| p.is_finite()));
    }
}

#[test]
fn a_revolved_line_is_a_cylinder_and_a_revolved_arc_a_torus() {
    let frame = tilted();
    let line = Curve::Line { origin: frame.point(DVec3::new(0.0, 2.0, 0.0)), direction: frame.z };
    let arc_frame = Frame::from_axes(frame.point(DVec3::new(5.0, 0.0, 0.0)), Some(frame.y), Some(frame.x));
    let arc = Curve::Circle { frame: arc_frame, radius: 1.5 };
    let expected = [
        (line, [-1.0, 2.0], Surface::Cylinder { frame, radius: 2.0 }),
        (arc, [0.0, TAU], Surface::Torus { frame, major: 5.0, minor: 1.5 }),
    ];
    for (profile, range, surface) in expected {
        let profile_spline = curve_to_bspline(&profile, range);
        let revolved = revolve(&profile_spline, &frame);
        assert_eq!(revolved.closed, [true, matches!(profile, Curve::Circle { .. })]);
        let (domain, start) = (revolved.domain(), profile_spline.domain()[0]);
        assert!(
            revolved.point(DVec2::new(0.0, start)).distance(profile.point(range[0])) < 1e-14,
            "the profile is the iso-curve u = 0"
        );
        for i in 0..=20 {
            for j in 0..=20 {
                let share = DVec2::new(f64::from(i), f64::from(j)) / 20.0;
                let point = revolved.point(domain.min + (domain.max - domain.min) * share);
                assert!(invert_surface(&surface, point, None).distance < 1e-13);
            }
        }
        let angle_of = |u: f64| {
            let local = frame.local_point(revolved.point(DVec2::new(u, start)));
            local.y.atan2(local.x)
        };
        assert!(angle_of(0.1) > angle_of(0.0), "right-handed about z");
    }
}

#[test]
fn an_extruded_circle_is_a_cylinder() {
    let frame = tilted();
    let circle = curve_to_bspline(&Curve::Circle { frame, radius: 2.0 }, [0.0, TAU]);
    let spline = extrude(&circle, frame.z * 2.0, [-1.0, 3.0]);
    assert_eq!(spline.closed, [true, false]);
    let surface = Surface::Cylinder { frame, radius: 2.0 };
    for (u, v) in [(0.0, -1.0), (1.0, 0.0), (4.0, 3.0)] {
        let found = invert_surface(&surface, spline.point(DVec2::new(u, v)), None);
        assert!(found.distance < 1e-14 && (found.uv.y - 2.0 * v).abs() < 1e-13);
    }
}

#[test]
fn parameters_without_sense_come_to_an_end() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ZERO];
    let points = corners.iter().map(|&p| Homogeneous::new(p, 1.0)).collect();
    let triangle = BsplineCurve::new(1, vec![0.0, 0.0, 1.0, 2.0, 3.0, 3.0], points).expect("a polyline");
    let curve = Curve::Bspline(triangle);
    for range in [[-1e20, 0.0], [0.0, 1e20], [1e17, 1e17 + 64.0], [-1e300, 1e300]] {
        assert!(curve.breaks(range).len() < 100, "{range:?}");
        assert!(curve_to_bspline(&curve, range).points.iter().all(|p| p.is_finite()), "{range:?}");
    }
}
