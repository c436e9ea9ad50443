//! Two planes through a ray (Kajiya 1982), sheared along the direction's greatest component (Woop, Benthin and Wald 2013).

use super::ray_space::PrimitiveRay;
use crate::numeric::Real;

/// The two planes through a ray: about its origin, `p − along·slope` in the two minor axes is 0 on it.
#[derive(Debug, Clone, Copy)]
pub struct RayPlanes<T> {
    /// The greatest component of the direction.
    pub major: usize,
    /// The other two.
    pub minor: [usize; 2],
    /// The direction's minor components over the major one: at most 1.
    pub slope: [T; 2],
}

/// The planes of a ray.
#[inline]
pub fn ray_planes<T: Real>(ray: &PrimitiveRay<T>) -> RayPlanes<T> {
    let d = ray.direction.to_array();
    let major = if d[0].abs() >= d[1].abs() && d[0].abs() >= d[2].abs() {
        0
    } else if d[1].abs() >= d[2].abs() {
        1
    } else {
        2
    };
    let minor = [(major + 1) % 3, (major + 2) % 3];
    let slope = [d[minor[0]] / d[major], d[minor[1]] / d[major]];
    RayPlanes { major, minor, slope }
}

/// The two plane equations of a homogeneous vector about the ray's origin.
#[inline(always)]
pub fn plane_values<T: Real>(planes: &RayPlanes<T>, p: [T; 4]) -> [T; 2] {
    let [first, second] = planes.minor;
    [p[first] - planes.slope[0] * p[planes.major], p[second] - planes.slope[1] * p[planes.major]]
}
