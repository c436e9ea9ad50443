//! The closest points of parabolas and hyperbolas, in their planes.
//!
//! Both are symmetric about x, and the closest point lies on the side of the given one, where the derivative of the
//! squared distance has exactly one root: for the parabola `t³ + (2 − x/f) t − y/f` changes signs once (Descartes), for
//! the hyperbola `g / (sinh t cosh t)` grows throughout where x > 0, and `g / cosh t` where x <= 0.

use crate::numeric::roots::bracketed_root;
use glam::DVec2;

/// Relative to the parameter; Newton's last step goes to the end of f64 anyway.
const TOLERANCE: f64 = 1e-15;

/// The parameter of the point of `(f t², 2 f t)` closest to `point`.
pub(super) fn parabola(focal: f64, point: DVec2, seed: Option<f64>) -> f64 {
    let (x, y) = (point.x / focal, point.y.abs() / focal);
    let root = if y == 0.0 {
        (x - 2.0).max(0.0).sqrt()
    } else {
        // At the greater of the parameters of equal y and of equal x both terms of the derivative are >= 0.
        let high = (0.5 * y).max(x.max(0.0).sqrt());
        let derivative = |t: f64| (t * (t * t + 2.0 - x) - y, 3.0 * t * t + 2.0 - x);
        bracketed_root(derivative, [0.0, high], TOLERANCE * high)
    };
    with_side(root, point.y, seed)
}

/// The parameter of the point of `(a cosh t, b sinh t)` closest to `point`.
pub(super) fn hyperbola(radii: [f64; 2], point: DVec2, seed: Option<f64>) -> f64 {
    let [a, b] = radii;
    let (x, y) = (point.x, point.y.abs());
    let root = if y == 0.0 {
        (a * x / (a * a + b * b)).max(1.0).acosh()
    } else {
        let high = (y / b).asinh().max((x / a).max(1.0).acosh());
        let derivative = |t: f64| {
            let (s, c) = (t.sinh(), t.cosh());
            let value = (a * c - x) * a * s + (b * s - y) * b * c;
            (value, (a * a + b * b) * (c * c + s * s) - a * x * c - b * y * s)
        };
        bracketed_root(derivative, [0.0, high], TOLERANCE * high)
    };
    with_side(root, point.y, seed)
}

fn with_side(root: f64, y: f64, seed: Option<f64>) -> f64 {
    let side = if y == 0.0 { seed.unwrap_or(1.0) } else { y };
    root.copysign(side)
}
