//! Closed forms, in the frame of the surface; angles in (−π, π].
//!
//! All these surfaces are revolved: a point lies at the radius ρ in the half-plane of its own angle, and at −ρ in the
//! half-plane opposite. The profile curve is hit in the former, except by cones beyond the apex and by tori with `r > R`,
//! whose profiles cross the axis: these take the better of the two.

use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// The domain of an angle.
pub(super) const TURN: [f64; 2] = [0.0, TAU];

/// Closer to the axis than this share of the size, the angle is rounding noise and the seed's is kept. The wrong angle
/// moves the answer by twice this share at most.
const ON_AXIS: f64 = 1e-13;

/// The angle of `point`, or the seed's where it lies on the axis of something as large as `size`.
pub(super) fn angle(point: DVec2, size: f64, seed: Option<f64>) -> f64 {
    if point.length() <= ON_AXIS * size { seed.unwrap_or(0.0) } else { point.y.atan2(point.x) }
}

pub(super) fn cylinder(radius: f64, point: DVec3, seed: Option<DVec2>) -> DVec2 {
    DVec2::new(angle(point.truncate(), radius, seed.map(|seed| seed.x)), point.z)
}

pub(super) fn sphere(radius: f64, point: DVec3, seed: Option<DVec2>) -> DVec2 {
    let rho = point.truncate().length();
    let u = angle(point.truncate(), radius + point.z.abs(), seed.map(|seed| seed.x));
    let centre = rho.hypot(point.z) <= ON_AXIS * radius;
    DVec2::new(u, if centre { seed.map_or(0.0, |seed| seed.y) } else { point.z.atan2(rho) })
}

pub(super) fn cone(radius: f64, half_angle: f64, point: DVec3, seed: Option<DVec2>) -> DVec2 {
    let slope = half_angle.tan();
    let apex = -radius / slope;
    let size = radius + (point.z - apex).abs();
    let u = angle(point.truncate(), size, seed.map(|seed| seed.x));
    // The generator in the half-plane is ρ = r + v tan α, h = v: project on it.
    let project = |rho: f64| {
        let v = ((rho - radius) * slope + point.z) / (1.0 + slope * slope);
        let off = (rho - radius - point.z * slope).abs();
        (v, off)
    };
    let rho = point.truncate().length();
    let (near, far) = (project(rho), project(-rho));
    let opposite = better(near.1, far.1, size, || {
        seed.is_some_and(|seed| (far.0 - seed.y).abs() < (near.0 - seed.y).abs())
    });
    if opposite && rho > ON_AXIS * size { DVec2::new(u + PI, far.0) } else { DVec2::new(u, near.0) }
}

/// `radii`: major and minor.
pub(super) fn torus(radii: [f64; 2], point: DVec3, seed: Option<DVec2>) -> DVec2 {
    let [major, minor] = radii;
    let size = major + minor;
    let u = angle(point.truncate(), size, seed.map(|seed| seed.x));
    let project = |rho: f64| {
        let (x, y) = (rho - major, point.z);
        let off = (x.hypot(y) - minor).abs();
        let v = if x.hypot(y) <= ON_AXIS * size { seed.map_or(0.0, |seed| seed.y) } else { y.atan2(x) };
        (v, off)
    };
    let rho = point.truncate().length();
    let (near, far) = (project(rho), project(-rho));
    let apart = |v: f64, seed: f64| ((v - seed + PI).rem_euclid(TAU) - PI).abs();
    let opposite = minor > major
        && better(near.1, far.1, size, || {
            seed.is_some_and(|seed| apart(far.0, seed.y) < apart(near.0, seed.y))
        });
    if opposite { DVec2::new(u + PI, far.0) } else { DVec2::new(u, near.0) }
}

/// Whether `second` is the lesser distance; `tie` decides where they are equal up to rounding.
fn better(first: f64, second: f64, size: f64, tie: impl Fn() -> bool) -> bool {
    if (first - second).abs() <= 1e-12 * size { tie() } else { second < first }
}
