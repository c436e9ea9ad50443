//! Curves that have no exact form, as B-splines: polynomial pieces of degree 6, halved where they do not fit.
//!
//! Each piece interpolates at Chebyshev–Lobatto points, ends included, as in [`super::fit`]: neighbours share their end point.

use super::bezier::{Homogeneous, Homogeneous3};
use super::bspline::BsplineCurve;
use super::fit::{DEGREE, Interpolation, WIDTH, knots_of};
use glam::DVec3;

/// A piece has 6 control points of 32 bytes: at most 200 KB a curve.
const MAX_PIECES: usize = 1024;

/// A fitted curve and how far it is from what it stands for.
#[derive(Debug, Clone)]
pub struct CurveFit {
    /// Over the same parameters.
    pub curve: BsplineCurve<Homogeneous3>,
    /// The greatest distance at the check points, the middles between interpolated ones.
    pub deviation: f64,
}

/// The function `point` over `breaks` (ascending, between which it is smooth), halved until all check points are closer than
/// `tolerance`, or the pieces are too many: then the deviation is larger. `None` where the function is, or the breaks are too
/// few or too many.
pub fn fit_curve(breaks: &[f64], point: impl Fn(f64) -> Option<DVec3>, tolerance: f64) -> Option<CurveFit> {
    let interpolation = Interpolation::new();
    // Backwards, so that the stack gives the pieces in order.
    let mut open: Vec<[f64; 2]> = breaks.windows(2).rev().map(|w| [w[0], w[1]]).collect();
    let mut points = vec![point(*breaks.first()?)?];
    let mut ends = vec![breaks[0]];
    let mut deviation = 0.0_f64;
    while let Some([low, high]) = open.pop() {
        let at = |s: f64| point(low * (1.0 - s) + high * s);
        let mut values = [DVec3::ZERO; WIDTH];
        for (value, node) in values.iter_mut().zip(interpolation.nodes) {
            *value = at(node)?;
        }
        let control = interpolation.row(values);
        let mut error = 0.0_f64;
        for pair in interpolation.nodes.windows(2) {
            let s = 0.5 * (pair[0] + pair[1]);
            error = error.max(casteljau(control, s).distance(at(s)?));
        }
        let middle = 0.5 * (low + high);
        let can_halve = ends.len() + open.len() < MAX_PIECES && low < middle && middle < high;
        if error > tolerance && can_halve {
            open.push([middle, high]);
            open.push([low, middle]);
            continue;
        }
        deviation = deviation.max(error);
        points.extend(&control[1..]);
        ends.push(high);
    }
    let points = points.into_iter().map(|p| <Homogeneous3 as Homogeneous>::new(p, 1.0)).collect();
    let curve = BsplineCurve::new(DEGREE, knots_of(&ends), points).ok()?;
    deviation.is_finite().then_some(CurveFit { curve, deviation })
}

fn casteljau(mut points: [DVec3; WIDTH], s: f64) -> DVec3 {
    for left in (1..WIDTH).rev() {
        for i in 0..left {
            points[i] = points[i].lerp(points[i + 1], s);
        }
    }
    points[0]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Curve;

    #[test]
    fn a_helix_is_met_within_the_tolerance() {
        let helix = |t: f64| DVec3::new(t.cos(), t.sin(), 0.3 * t);
        let fit = fit_curve(&[0.0, 1.0, 12.0], |t| Some(helix(t)), 1e-9).expect("a smooth curve");
        assert!(fit.deviation <= 1e-9);
        let curve = Curve::Bspline(fit.curve);
        for i in 0..=100 {
            let t = 0.12 * f64::from(i);
            assert!(curve.point(t).distance(helix(t)) < 3e-9, "{t}");
        }
        assert!(fit_curve(&[0.0, 1.0], |t| (t < 0.5).then_some(DVec3::X), 1e-9).is_none());
        assert!(fit_curve(&[], |_| Some(DVec3::X), 1e-9).is_none());
    }
}
