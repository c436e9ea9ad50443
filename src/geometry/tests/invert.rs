use super::samples;
use crate::geometry::to_bspline::{curve_to_bspline, revolve};
use crate::geometry::{Curve, Frame, ParameterBox, Surface, invert_curve, invert_surface};
use glam::{DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

#[test]
fn analytic_surfaces_invert_with_and_without_a_seed() {
    for surface in samples::analytic_surfaces() {
        for (u, v) in [(0.3, 0.2), (2.0, -1.1), (6.2, 1.2), (3.2, 0.9)] {
            let uv = DVec2::new(u, v);
            let here = surface.derivatives(uv);
            let found = invert_surface(&surface, here.point, Some(uv + 0.3));
            assert!(found.uv.distance(uv) < 1e-13 && found.distance < 1e-13, "{}: {found:?}", surface.kind());
            let turned = if surface.periods()[0].is_some() { uv - DVec2::X * 3.0 * TAU } else { uv };
            let found = invert_surface(&surface, here.point, Some(turned));
            assert!(found.uv.distance(turned) < 1e-13, "{}: {found:?}", surface.kind());
            let off = here.point + here.du.cross(here.dv).normalize() * 0.1;
            let found = invert_surface(&surface, off, None);
            let domain = surface.domain();
            assert!(surface.point(found.uv).distance(here.point) < 1e-13, "{}", surface.kind());
            assert!((found.distance - 0.1).abs() < 1e-13);
            assert!(domain.min.cmple(found.uv).all() && found.uv.cmple(domain.max).all());
        }
    }
}

#[test]
fn poles_keep_the_angle_of_the_seed() {
    let frame = Frame::IDENTITY;
    let sphere = Surface::Sphere { frame, radius: 2.0 };
    let found = invert_surface(&sphere, DVec3::new(0.0, 0.0, 2.0), Some(DVec2::new(7.5, 1.0)));
    assert_eq!(found.uv, DVec2::new(7.5, FRAC_PI_2));
    let cone = Surface::Cone { frame, radius: 1.0, half_angle: PI / 4.0 };
    let found = invert_surface(&cone, DVec3::new(0.0, 0.0, -1.0), Some(DVec2::new(1.25, 0.0)));
    assert!(found.uv.distance(DVec2::new(1.25, -1.0)) < 1e-14);
}

#[test]
fn cones_and_spindle_tori_have_points_across_the_axis() {
    let frame = Frame::IDENTITY;
    let cone = Surface::Cone { frame, radius: 1.0, half_angle: PI / 4.0 };
    let spindle = Surface::Torus { frame, major: 1.0, minor: 2.0 };
    for (surface, uv) in [(cone, DVec2::new(1.0, -3.0)), (spindle, DVec2::new(1.0, 2.8))] {
        let found = invert_surface(&surface, surface.point(uv), None);
        assert!(found.uv.distance(uv) < 1e-13, "{found:?}");
    }
}

#[test]
fn bsplines_invert_with_and_without_a_seed() {
    samples::check(200, |u| {
        let spline = samples::surface(u)?;
        let domain = spline.domain();
        let surface = Surface::Bspline(spline);
        let uv = DVec2::new(
            samples::number(u, domain.min.x, domain.max.x)?,
            samples::number(u, domain.min.y, domain.max.y)?,
        );
        let point = surface.point(uv);
        let global = invert_surface(&surface, point, None);
        assert!(global.distance < 1e-12, "{global:?} {uv}");
        assert!(global.uv.distance(uv) < 1e-8, "{global:?} {uv}");
        let seed = (uv + (domain.max - domain.min) * 0.01).min(domain.max);
        let local = invert_surface(&surface, point, Some(seed));
        assert!(local.distance < 1e-12, "{local:?} {uv}");
        Ok(())
    });
}

#[test]
fn the_closest_point_of_a_bspline_is_not_farther_than_any_sample() {
    samples::check(100, |u| {
        let spline = samples::surface(u)?;
        let domain = spline.domain();
        let surface = Surface::Bspline(spline);
        let point = samples::point(u)? * DVec3::new(1.0, 1.0, 0.2);
        let found = invert_surface(&surface, point, None);
        assert!((surface.point(found.uv).distance(point) - found.distance).abs() < 1e-12);
        for i in 0..=40 {
            for j in 0..=40 {
                let share = DVec2::new(f64::from(i), f64::from(j)) / 40.0;
                let sample = surface.point(domain.min + (domain.max - domain.min) * share);
                assert!(found.distance <= sample.distance(point) + 1e-9);
            }
        }
        Ok(())
    });
}

#[test]
fn curves_invert() {
    let frame = Frame::from_axes(DVec3::new(1.0, 2.0, 3.0), Some(DVec3::new(1.0, 1.0, 0.5)), None);
    let curves = [
        Curve::Line { origin: DVec3::ONE, direction: DVec3::new(1.0, -2.0, 0.5) },
        Curve::Circle { frame, radius: 3.0 },
        Curve::Ellipse { frame, radii: [5.0, 0.2] },
        Curve::Ellipse { frame, radii: [1.0, 3.0] },
        Curve::Parabola { frame, focal: 0.7 },
        Curve::Hyperbola { frame, radii: [2.0, 0.5] },
    ];
    for curve in curves {
        for t in [-2.5, -0.4, 0.0, 0.3, 1.0, 3.1] {
            let point = curve.point(t);
            let seeded = invert_curve(&curve, point, Some(t + 0.1));
            assert!((seeded - t).abs() < 1e-12, "{curve:?} {t} {seeded}");
            let global = invert_curve(&curve, point, None);
            assert!(curve.point(global).distance(point) < 1e-12, "{curve:?} {t} {global}");
        }
        // Any point: no sample is closer.
        for point in [DVec3::new(4.0, -3.0, 2.0), DVec3::new(1.2, 2.1, 3.0), DVec3::new(-5.0, 9.0, 1.0)] {
            let found = curve.point(invert_curve(&curve, point, None)).distance(point);
            let closest = (-4000..4000)
                .map(|i| curve.point(f64::from(i) * 1e-3).distance(point))
                .fold(f64::MAX, f64::min);
            assert!(found <= closest + 1e-12, "{curve:?} {point}");
        }
    }
    samples::check(300, |u| {
        let curve = Curve::Bspline(samples::curve(u)?);
        let [first, last] = curve.domain();
        let t = samples::number(u, first, last)?;
        let point = curve.point(t);
        let global = invert_curve(&curve, point, None);
        assert!(
            curve.point(global).distance(point) < 1e-11,
            "{t} {global} {point} {} {curve:?}",
            curve.point(global)
        );
        assert!(curve.point(invert_curve(&curve, point, Some(t))).distance(point) < 1e-11);
        Ok(())
    });
}

#[test]
fn bounds_hold_the_surface_and_are_tight() {
    let check = |surface: &Surface, range: ParameterBox, slack: f64| {
        let bounds = surface.bounds(range);
        let mut inner = crate::numeric::Aabb::EMPTY;
        for i in 0..=60 {
            for j in 0..=60 {
                let share = DVec2::new(f64::from(i), f64::from(j)) / 60.0;
                let point = surface.point(range.min + (range.max - range.min) * share);
                assert_eq!(bounds.including(point), bounds, "{} {range:?}", surface.kind());
                inner = inner.including(point);
            }
        }
        assert!(
            inner.diagonal() >= (1.0 - slack) * bounds.diagonal(),
            "{}: {inner:?} in {bounds:?} over {range:?}",
            surface.kind()
        );
    };
    let ranges = [[-0.5, 0.3, 0.4, 1.2], [0.0, TAU, -0.3, 0.3], [5.0, 7.5, -1.5, 1.5], [1.0, 9.0, 0.0, 0.1]];
    for surface in samples::analytic_surfaces() {
        for [u0, u1, v0, v1] in ranges {
            check(&surface, ParameterBox { min: DVec2::new(u0, v0), max: DVec2::new(u1, v1) }, 0.003);
        }
    }
    samples::check(60, |u| {
        let spline = samples::surface(u)?;
        let domain = spline.domain();
        let size = domain.max - domain.min;
        let surface = Surface::Bspline(spline);
        check(&surface, domain, 0.03);
        let min =
            domain.min + size * DVec2::new(samples::number(u, 0.0, 0.8)?, samples::number(u, 0.0, 0.8)?);
        let range = ParameterBox { min, max: (min + size * 0.15).min(domain.max) };
        check(&surface, range, 0.04);
        Ok(())
    });
}

#[test]
fn moved_surfaces_and_curves_go_through_moved_points() {
    samples::check(100, |u| {
        let transform = samples::similarity(u)?;
        let mut surfaces = samples::analytic_surfaces();
        surfaces.push(Surface::Bspline(samples::surface(u)?));
        for surface in surfaces {
            let (moved, flipped) = surface.transformed(&transform);
            let uv = match surface.domain() {
                domain if domain.max.is_finite() => domain.min + (domain.max - domain.min) * 0.3,
                _ => DVec2::new(0.5, 0.8),
            };
            let (before, point) = (surface.derivatives(uv), transform.transform_point3(surface.point(uv)));
            let found = invert_surface(&moved, point, None);
            assert!(found.distance < 1e-11, "{}: {found:?}", surface.kind());
            let after = moved.derivatives(found.uv);
            // A moved normal is that of the moved solid, outside staying outside.
            let normal = before.du.cross(before.dv).normalize();
            let towards = transform.transform_vector3(normal).normalize();
            let sign = if flipped { -1.0 } else { 1.0 };
            assert!(
                (after.du.cross(after.dv).normalize() * sign - towards).length() < 1e-6,
                "{}",
                surface.kind()
            );
        }
        let frame = Frame::from_axes(DVec3::ONE, Some(DVec3::new(1.0, 2.0, -1.0)), None);
        for curve in [
            Curve::Ellipse { frame, radii: [2.0, 1.0] },
            Curve::Parabola { frame, focal: 0.5 },
            Curve::Bspline(samples::curve(u)?),
        ] {
            let moved = curve.transformed(&transform);
            let t = curve.domain()[0].max(-2.0) + 0.7;
            let expected = transform.transform_point3(curve.point(t));
            assert!(moved.point(t).distance(expected) < 1e-11);
        }
        Ok(())
    });
}

#[test]
fn collapsed_sides_of_bsplines_are_found_and_inverted() {
    let meridian = Curve::Circle {
        frame: Frame { origin: DVec3::ZERO, x: DVec3::X, y: DVec3::Z, z: -DVec3::Y },
        radius: 2.0,
    };
    let profile = curve_to_bspline(&meridian, [-FRAC_PI_2, FRAC_PI_2]);
    let sphere = Surface::Bspline(revolve(&profile, &Frame::IDENTITY));
    let poles = sphere.singularities();
    assert_eq!(poles.len(), 2);
    assert!(poles.iter().all(|pole| pole.axis == 1 && (pole.point.z.abs() - 2.0).abs() < 1e-14));
    let found = invert_surface(&sphere, poles[1].point, Some(DVec2::new(2.5, 1.0)));
    assert!(found.distance < 1e-7 && (found.uv.x - 2.5).abs() < 1e-3, "{found:?}");
    for (u, v) in [(0.0_f64, 0.3_f64), (6.2, -1.5), (3.0, 1.55), (4.0, 0.0), (1.0, -1.56)] {
        let point = DVec3::new(v.cos() * u.cos(), v.cos() * u.sin(), v.sin()) * 2.0;
        assert!(invert_surface(&sphere, point, None).distance < 1e-12, "{u} {v}");
        let seed = invert_surface(&sphere, point, None);
        // Across the seam the parameter runs on.
        let turned = invert_surface(&sphere, point, Some(seed.uv + DVec2::X * TAU));
        assert!(turned.distance < 1e-12 && (turned.uv.x - seed.uv.x - TAU).abs() < 1e-4);
    }
}
