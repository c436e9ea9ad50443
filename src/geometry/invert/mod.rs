//! The parameters of the point of a curve or surface that is closest to a given point.
//!
//! Elementary forms have closed answers. B-splines are searched: without a seed on a grid over all knot spans, whose best
//! places are polished; with a seed from there only, which is both faster and what a march along an edge needs (independent
//! global searches jump between branches). Polishing is Newton's method on the squared distance with the full Hessian, or
//! Gauss-Newton where that is not positive definite, with step halving, so that the distance never grows.

mod analytic;
mod conic;
mod curve;
mod surface;

use super::curve::Curve;
use super::surface::Surface;
use glam::{DVec2, DVec3};

/// The closest point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inversion {
    /// Its parameters.
    pub uv: DVec2,
    /// Its distance from the given point.
    pub distance: f64,
}

/// The parameter of the point of `curve` closest to `point`; near `seed` where one is given, else the global closest.
///
/// Parameters of closed curves come out nearest to the seed, or inside the domain without one. A point without a
/// single closest one (the centre of a circle) keeps the seed.
pub fn invert_curve(curve: &Curve, point: DVec3, seed: Option<f64>) -> f64 {
    let local = |frame: &super::Frame| frame.local_point(point).truncate();
    match curve {
        Curve::Line { origin, direction } => {
            let t = (point - *origin).dot(*direction) / direction.length_squared();
            if t.is_finite() { t } else { seed.unwrap_or(0.0) }
        }
        Curve::Circle { frame, radius } => {
            unwrapped(analytic::angle(local(frame), *radius, seed), analytic::TURN, seed)
        }
        Curve::Ellipse { .. } => curve::closed(curve, point, seed),
        Curve::Parabola { frame, focal } => conic::parabola(*focal, local(frame), seed),
        Curve::Hyperbola { frame, radii } => conic::hyperbola(*radii, local(frame), seed),
        Curve::Bspline(spline) if spline.is_closed() => curve::closed(curve, point, seed),
        Curve::Bspline(_) => curve::open(curve, point, seed),
    }
}

/// The point of `surface` closest to `point`. With a seed (the previous point of a march) the local solution reached
/// from it, with periodic parameters unwrapped to be nearest to the seed; without one the global closest, with periodic
/// parameters inside the domain. At poles and apexes the seed's u is kept.
pub fn invert_surface(surface: &Surface, point: DVec3, seed: Option<DVec2>) -> Inversion {
    let uv = match surface {
        Surface::Bspline(spline) => return surface::invert(spline, point, seed),
        Surface::Plane { frame } => frame.local_point(point).truncate(),
        Surface::Cylinder { frame, radius } => analytic::cylinder(*radius, frame.local_point(point), seed),
        Surface::Cone { frame, radius, half_angle } => {
            analytic::cone(*radius, *half_angle, frame.local_point(point), seed)
        }
        Surface::Sphere { frame, radius } => analytic::sphere(*radius, frame.local_point(point), seed),
        Surface::Torus { frame, major, minor } => {
            analytic::torus([*major, *minor], frame.local_point(point), seed)
        }
    };
    let [u_period, v_period] = surface.periods();
    let unwrap = |value: f64, period: Option<f64>, seed: Option<f64>| match period {
        Some(length) => unwrapped(value, [0.0, length], seed),
        None => value,
    };
    let uv = DVec2::new(
        unwrap(uv.x, u_period, seed.map(|seed| seed.x)),
        unwrap(uv.y, v_period, seed.map(|seed| seed.y)),
    );
    Inversion { uv, distance: surface.point(uv).distance(point) }
}

/// `value` moved by whole periods: nearest to the seed, or into `domain`, which is one period, without one.
fn unwrapped(value: f64, domain: [f64; 2], seed: Option<f64>) -> f64 {
    let period = domain[1] - domain[0];
    match seed {
        Some(seed) => value + period * ((seed - value) / period).round(),
        None => super::curve::wrap(value, domain),
    }
}

/// Whether a step is as short as rounding allows: Newton's steps shrink fast until they only jitter.
fn finished(moved: f64, moved_before: f64, size: f64) -> bool {
    moved <= f64::EPSILON * size || (moved <= 1e-7 * size && moved > 0.9 * moved_before)
}
