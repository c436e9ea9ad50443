//! Lines of constant u or v of a surface, as curves whose parameter is the other surface parameter.

use super::bspline::BsplineCurve;
use super::curve::Curve;
use super::frame::Frame;
use super::surface::Surface;
use glam::{DVec2, DVec3};

/// The line of `surface` on which parameter `axis` (0 for u, 1 for v) is `value`. On B-splines only the sides of the domain
/// are given: `value` is then the lowest or highest parameter, whichever is nearer.
pub fn iso_curve(surface: &Surface, axis: usize, value: f64) -> Curve {
    let at_u = |frame: &Frame, radius: f64, slope: f64| {
        let radial = DVec2::from_angle(value).extend(0.0);
        Curve::Line {
            origin: frame.point(radial * radius),
            direction: frame.vector(radial * slope + DVec3::Z),
        }
    };
    match surface {
        Surface::Plane { frame } if axis == 0 => {
            Curve::Line { origin: frame.point(DVec3::X * value), direction: frame.y }
        }
        Surface::Plane { frame } => Curve::Line { origin: frame.point(DVec3::Y * value), direction: frame.x },
        Surface::Cylinder { frame, radius } if axis == 0 => at_u(frame, *radius, 0.0),
        Surface::Cylinder { frame, radius } => parallel(frame, *radius, value),
        Surface::Cone { frame, radius, half_angle } if axis == 0 => at_u(frame, *radius, half_angle.tan()),
        Surface::Cone { frame, radius, half_angle } => {
            parallel(frame, radius + value * half_angle.tan(), value)
        }
        Surface::Sphere { frame, radius } => tube(frame, [0.0, *radius], axis, value),
        Surface::Torus { frame, major, minor } => tube(frame, [*major, *minor], axis, value),
        Surface::Bspline(spline) => {
            let domain = spline.domain();
            let last = value - domain.min[axis] > domain.max[axis] - value;
            let knots = if axis == 0 { &spline.v_knots } else { &spline.u_knots };
            let points = spline.side(axis, last).collect();
            Curve::Bspline(BsplineCurve { knots: knots.clone(), points })
        }
    }
}

/// The circle at `height`; a negative radius starts at the other side of the axis.
fn parallel(frame: &Frame, radius: f64, height: f64) -> Curve {
    let origin = frame.origin + frame.z * height;
    let side = if radius < 0.0 { -1.0 } else { 1.0 };
    let frame = Frame { origin, x: frame.x * side, y: frame.y * side, z: frame.z };
    Curve::Circle { frame, radius: radius.abs() }
}

fn tube(frame: &Frame, [major, minor]: [f64; 2], axis: usize, value: f64) -> Curve {
    if axis == 1 {
        return parallel(frame, major + minor * value.cos(), minor * value.sin());
    }
    let radial = frame.vector(DVec2::from_angle(value).extend(0.0));
    let origin = frame.origin + radial * major;
    let frame = Frame { origin, x: radial, y: frame.z, z: radial.cross(frame.z) };
    Curve::Circle { frame, radius: minor }
}
