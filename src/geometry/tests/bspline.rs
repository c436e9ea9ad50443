use super::samples;
use crate::geometry::{
    BsplineCurve, BsplineSurface, Curve, Homogeneous, Homogeneous3, KnotError, Surface, decompose_curve,
    decompose_surface,
};
use glam::{DVec2, DVec3};

/// The de Boor recursion in its plainest form, on any knots.
fn slow_eval(degree: usize, knots: &[f64], points: &[Homogeneous3], t: f64) -> Homogeneous3 {
    fn basis(knots: &[f64], i: usize, p: usize, t: f64) -> f64 {
        if p == 0 {
            return f64::from(u8::from(knots[i] <= t && t < knots[i + 1]));
        }
        let term = |a: f64, b: f64, c: f64| if b > 0.0 { a / b * c } else { 0.0 };
        term(t - knots[i], knots[i + p] - knots[i], basis(knots, i, p - 1, t))
            + term(knots[i + p + 1] - t, knots[i + p + 1] - knots[i + 1], basis(knots, i + 1, p - 1, t))
    }
    points
        .iter()
        .enumerate()
        .fold(Homogeneous3::ZERO, |sum, (i, point)| sum + *point * basis(knots, i, degree, t))
}

#[test]
fn clamping_keeps_the_shape() {
    samples::check(300, |u| {
        let clamped = u.arbitrary()?;
        let (degree, knots, points) = samples::curve_parts(u, clamped)?;
        let curve = BsplineCurve::new(degree, knots.clone(), points.clone()).expect("good parts");
        let [first, last] = curve.domain();
        assert_eq!([first, last], [knots[degree], knots[points.len()]]);
        for i in 0..20 {
            let t = first + (last - first) * (f64::from(i) + 0.5) / 20.0;
            let expected = slow_eval(degree, &knots, &points, t);
            assert!(curve.eval(t).distance(expected) < 1e-11, "at {t}");
        }
        Ok(())
    });
}

#[test]
fn curve_derivatives_are_limits_of_differences() {
    samples::check(300, |u| {
        let curve = Curve::Bspline(samples::curve(u)?);
        let [first, last] = curve.domain();
        let t = samples::number(u, first, last)?;
        let h = 1e-5;
        let near_break = |knot: &f64| (knot - t).abs() < 3.0 * h;
        let Curve::Bspline(spline) = &curve else { unreachable!() };
        if spline.knots.as_slice().iter().any(near_break) {
            return Ok(());
        }
        let at = |t: f64| curve.derivatives(t);
        let (before, here, after) = (at(t - h), at(t), at(t + h));
        let first = (after.point - before.point) / (2.0 * h);
        let second = (after.first - before.first) / (2.0 * h);
        assert!((first - here.first).length() < 1e-4 * (1.0 + here.first.length() + here.second.length()));
        assert!((second - here.second).length() < 1e-4 * (10.0 + here.first.length() + here.second.length()));
        Ok(())
    });
}

#[test]
fn surface_derivatives_are_limits_of_differences() {
    let check = |surface: &Surface, uv: DVec2| {
        let h = 1e-5;
        let at = |du: f64, dv: f64| surface.derivatives(uv + DVec2::new(du, dv) * h);
        let here = at(0.0, 0.0);
        let close = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-4 * (30.0 + b.length()), "{a} {b}");
        let (left, right, down, up) = (at(-1.0, 0.0), at(1.0, 0.0), at(0.0, -1.0), at(0.0, 1.0));
        close((right.point - left.point) / (2.0 * h), here.du);
        close((up.point - down.point) / (2.0 * h), here.dv);
        close((right.du - left.du) / (2.0 * h), here.duu);
        close((up.dv - down.dv) / (2.0 * h), here.dvv);
        close((up.du - down.du) / (2.0 * h), here.duv);
    };
    for surface in samples::analytic_surfaces() {
        for (u, v) in [(0.3, 0.2), (2.0, -1.1), (4.0, 1.2), (-1.0, 0.9)] {
            check(&surface, DVec2::new(u, v));
        }
    }
    samples::check(300, |u| {
        let surface = samples::surface(u)?;
        let domain = surface.domain();
        let uv = DVec2::new(
            samples::number(u, domain.min.x, domain.max.x)?,
            samples::number(u, domain.min.y, domain.max.y)?,
        );
        let near = |knots: &[f64], t: f64| knots.iter().any(|knot| (knot - t).abs() < 3e-5);
        if !near(surface.u_knots.as_slice(), uv.x) && !near(surface.v_knots.as_slice(), uv.y) {
            assert!(surface.point(uv).distance(surface.derivatives(uv).point) < 1e-12);
            check(&Surface::Bspline(surface), uv);
        }
        Ok(())
    });
}

#[test]
fn bezier_pieces_are_the_curve() {
    samples::check(300, |u| {
        let curve = samples::curve(u)?;
        let spans = decompose_curve(&curve);
        assert_eq!(spans[0].range[0], curve.domain()[0]);
        assert_eq!(spans[spans.len() - 1].range[1], curve.domain()[1]);
        for pair in spans.windows(2) {
            assert_eq!(pair[0].range[1], pair[1].range[0]);
            assert_eq!(pair[0].bezier.points.last(), pair[1].bezier.points.first());
        }
        for span in &spans {
            let [a, b] = span.range;
            for s in [0.0, 0.2, 0.5, 0.9, 1.0] {
                assert!(span.bezier.eval(s).distance(curve.eval(a + (b - a) * s)) < 1e-10);
            }
            let derivatives = span.bezier.derivatives(0.4);
            let expected = curve.derivatives(a + (b - a) * 0.4);
            assert!((derivatives[1] - expected[1] * (b - a)).length() < 1e-9);
            assert!((derivatives[2] - expected[2] * (b - a) * (b - a)).length() < 1e-8);
        }
        Ok(())
    });
}

#[test]
fn bezier_patches_are_the_surface_and_share_boundaries() {
    samples::check(300, |u| {
        let surface = samples::surface(u)?;
        let patches = decompose_surface(&surface).collect::<Vec<_>>();
        let v_spans = surface.v_knots.spans().count();
        assert_eq!(patches.len(), v_spans * surface.u_knots.spans().count());
        for (n, span) in patches.iter().enumerate() {
            let [p, q] = span.patch.degrees;
            if (n + 1) % v_spans != 0 {
                let next = &patches[n + 1];
                assert_eq!(span.v[1], next.v[0]);
                assert!((0..=p).all(|i| span.patch.point(i, q) == next.patch.point(i, 0)));
            }
            if let Some(next) = patches.get(n + v_spans) {
                assert_eq!(span.u[1], next.u[0]);
                assert!((0..=q).all(|j| span.patch.point(p, j) == next.patch.point(0, j)));
            }
            for (s, t) in [(0.0, 0.0), (0.3, 0.8), (0.5, 0.1), (1.0, 1.0)] {
                let uv = DVec2::new(
                    span.u[0] + (span.u[1] - span.u[0]) * s,
                    span.v[0] + (span.v[1] - span.v[0]) * t,
                );
                let [value, du, dv] = span.patch.derivatives(s, t);
                let expected = surface.derivatives(uv);
                assert!(Homogeneous::point(value).distance(expected.point) < 1e-11);
                let quotient = |d: Homogeneous3| (d.truncate() - expected.point * d.w) / value.w;
                if s > 0.0 && s < 1.0 {
                    assert!((quotient(du) - expected.du * (span.u[1] - span.u[0])).length() < 1e-8);
                    assert!((quotient(dv) - expected.dv * (span.v[1] - span.v[0])).length() < 1e-8);
                }
            }
        }
        Ok(())
    });
}

#[test]
fn pieces_of_patches_are_the_patch_and_share_boundaries() {
    samples::check(300, |u| {
        let surface = samples::surface(u)?;
        let patch = decompose_surface(&surface).next().expect("a patch").patch;
        let cut = samples::number(u, 0.05, 0.95)?;
        let (left, right) = (patch.piece([0.1, cut], [0.2, 0.7]), patch.piece([cut, 1.0], [0.2, 0.7]));
        let [p, q] = patch.degrees;
        assert!((0..=q).all(|j| left.point(p, j) == right.point(0, j)));
        for (s, t) in [(0.0, 0.0), (0.25, 0.5), (1.0, 0.3)] {
            let expected = patch.derivatives(cut + (1.0 - cut) * s, 0.2 + 0.5 * t)[0];
            assert!(right.derivatives(s, t)[0].distance(expected) < 1e-11);
        }
        Ok(())
    });
}

#[test]
fn pieces_of_curves_are_the_curve() {
    samples::check(300, |u| {
        let curve = samples::curve(u)?;
        let [first, last] = curve.domain();
        let (a, b) = (samples::number(u, first, last)?, samples::number(u, first, last)?);
        let Some(piece) = curve.piece(a, b) else {
            assert!(a == b);
            return Ok(());
        };
        for s in [0.0, 0.3, 0.7, 1.0] {
            let t = a + (b - a) * s;
            assert!(piece.eval(if a < b { t } else { -t }).distance(curve.eval(t)) < 1e-10);
        }
        Ok(())
    });
}

#[test]
fn bad_knots_are_rejected() {
    let points = |n: usize| vec![<Homogeneous3 as Homogeneous>::new(DVec3::ONE, 1.0); n];
    let new = |degree, knots: &[f64], n| BsplineCurve::new(degree, knots.to_vec(), points(n)).err();
    assert_eq!(new(0, &[0.0, 1.0, 2.0], 2), Some(KnotError::Degree(0)));
    assert_eq!(new(26, &[0.0; 60], 33), Some(KnotError::Degree(26)));
    assert_eq!(new(2, &[0.0, 1.0], 4), Some(KnotError::Count { knots: 2, degree: 2, points: 4 }));
    assert_eq!(new(1, &[0.0, 0.0, f64::NAN, 1.0], 2), Some(KnotError::Order(2)));
    assert_eq!(new(1, &[0.0, 1.0, 0.5, 1.0], 2), Some(KnotError::Order(2)));
    assert_eq!(new(1, &[1.0, 1.0, 1.0, 1.0], 2), Some(KnotError::Empty));
    assert_eq!(new(1, &[0.0, 0.0, 1.0, 1.0], 2), None);
    let mut bad = points(2);
    bad[1].w = 0.0;
    assert_eq!(BsplineCurve::new(1, vec![0.0, 0.0, 1.0, 1.0], bad).err(), Some(KnotError::Point(1)));
    assert!(BsplineSurface::new([usize::MAX, 1], [vec![], vec![]], points(4)).is_err());
}

#[test]
fn knots_repeated_too_often_are_reduced_where_the_pieces_meet() {
    let at = |x: f64| <Homogeneous3 as Homogeneous>::new(DVec3::new(x, 0.0, 0.0), 1.0);
    let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 2.0, 2.0];
    let points = [0.0, 1.0, 2.0, 2.0, 3.0, 4.0].map(at);
    let curve = BsplineCurve::new(2, knots.clone(), points.to_vec()).expect("the pieces meet");
    assert_eq!(curve.points.len(), 5);
    for i in 0..=20 {
        let t = 0.1 * f64::from(i);
        assert!((curve.eval(t).x - 2.0 * t).abs() < 1e-14);
    }
    let points = [0.0, 1.0, 2.0, 2.5, 3.0, 4.0].map(at);
    assert_eq!(BsplineCurve::new(2, knots, points.to_vec()).err(), Some(KnotError::Discontinuous(3)));
}

/// A roof of three sides over x, `gap` open where it ends, and along y as wide as `width`.
fn roof(gap: f64, width: f64) -> BsplineSurface {
    let corners = [DVec3::ZERO, DVec3::new(4.0, 0.0, 0.0), DVec3::new(2.0, 0.0, 3.0), DVec3::X * gap];
    let rows = corners.iter().flat_map(|&p| [p, p + DVec3::Y * width]).map(|p| p.extend(1.0));
    let knots = [vec![0.0, 0.0, 1.0, 2.0, 3.0, 3.0], vec![0.0, 0.0, 1.0, 1.0]];
    BsplineSurface::new([1, 1], knots, rows.collect()).expect("valid knots")
}

#[test]
fn what_all_but_closes_is_closed_and_a_thin_strip_is_not() {
    assert_eq!(roof(1e-7, 1.0).closed, [true, false]);
    assert_eq!(roof(1e-6, 1.0).closed, [false, false]);
    assert_eq!(roof(0.0, 1e-7).closed, [true, false]);
}

#[test]
fn closed_sides_are_found() {
    let at =
        |angle: f64, z: f64| <Homogeneous3 as Homogeneous>::new(DVec3::new(angle.cos(), angle.sin(), z), 1.0);
    let mut points = Vec::new();
    for i in 0..5 {
        let angle = if i == 4 { 0.0 } else { f64::from(i) };
        points.extend([at(angle, 0.0), at(angle, 2.0)]);
    }
    let knots = [vec![0.0, 0.0, 1.0, 2.0, 3.0, 4.0, 4.0], vec![0.0, 0.0, 1.0, 1.0]];
    let surface = BsplineSurface::new([1, 1], knots, points).expect("good knots");
    assert_eq!(surface.closed, [true, false]);
    let surface = Surface::Bspline(surface);
    assert_eq!(surface.periods(), [Some(4.0), None]);
    let (a, b) = (surface.point(DVec2::new(0.5, 0.3)), surface.point(DVec2::new(8.5, 0.3)));
    assert!(a.distance(b) < 1e-14);
}
