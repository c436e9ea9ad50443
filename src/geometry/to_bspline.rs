//! Exact conversions to rational B-spline form.

use super::bezier::Homogeneous3;
use super::bspline::{BsplineCurve, BsplineSurface};
use super::curve::Curve;
use super::frame::Frame;
use glam::DVec3;

/// `curve` over `range` as a rational B-spline; the image is exact. The parameter is kept for lines and B-splines only.
pub fn curve_to_bspline(curve: &Curve, range: [f64; 2]) -> BsplineCurve<Homogeneous3> {
    todo!()
}

/// The ruled surface `profile(u) + v · direction`, v in `v_range`.
pub fn extrude(profile: &BsplineCurve<Homogeneous3>, direction: DVec3, v_range: [f64; 2]) -> BsplineSurface {
    todo!()
}

/// The full revolution of `profile` about the z axis of `axis`: u the angle's rational parameter, closed; v the profile's parameter.
pub fn revolve(profile: &BsplineCurve<Homogeneous3>, axis: &Frame) -> BsplineSurface {
    todo!()
}
