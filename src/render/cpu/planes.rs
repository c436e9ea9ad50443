//! Two planes through a ray (Kajiya 1982), sheared along the direction's greatest component (Woop, Benthin and Wald 2013).

use super::bernstein::NetJet;
use super::ray_space::PrimitiveRay;
use super::vector::Vector3;
use crate::numeric::{Number, Real};

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
    planes_along(ray.direction, major_axis(ray.direction))
}

/// The greatest component of a direction; of equal ones the first.
#[inline(always)]
pub fn major_axis<T: Real>(direction: Vector3<T>) -> usize {
    let d = direction.to_array();
    if d[0].abs() >= d[1].abs() && d[0].abs() >= d[2].abs() {
        0
    } else if d[1].abs() >= d[2].abs() {
        1
    } else {
        2
    }
}

/// Whether `major` is the [`major_axis`] of directions.
#[inline(always)]
pub fn is_along<T: Number>(direction: Vector3<T>, major: usize) -> T::Mask {
    let [x, y, z] = direction.to_array().map(T::abs);
    let is_first = y.is_at_most(x) & z.is_at_most(x);
    match major {
        0 => is_first,
        1 => !is_first & z.is_at_most(y),
        _ => !is_first & !z.is_at_most(y),
    }
}

/// The planes of rays whose directions are greatest along the axis `major`.
#[inline(always)]
pub fn planes_along<T: Number>(direction: Vector3<T>, major: usize) -> RayPlanes<T> {
    let d = direction.to_array();
    let minor = [(major + 1) % 3, (major + 2) % 3];
    let slope = [d[minor[0]] / d[major], d[minor[1]] / d[major]];
    RayPlanes { major, minor, slope }
}

/// The two plane equations of a homogeneous vector about the ray's origin.
#[inline(always)]
pub fn plane_values<T: Number>(planes: &RayPlanes<T>, p: [T; 4]) -> [T; 2] {
    let [first, second] = planes.minor;
    [p[first] - planes.slope[0] * p[planes.major], p[second] - planes.slope[1] * p[planes.major]]
}

/// The values of the two planes at a point of a net, and by the quotient rule their derivatives by u and by v, times `size`.
#[inline(always)]
pub fn plane_jet<T: Number>(planes: &RayPlanes<T>, jet: &NetJet<T>, size: [T; 2]) -> [[T; 2]; 3] {
    let scale = T::ONE / jet.value[3];
    let f = plane_values(planes, jet.value).map(|x| x * scale);
    let slopes = |by: [T; 4], size: T| {
        let d = plane_values(planes, by);
        [0, 1].map(|k| (d[k] - f[k] * by[3]) * (scale * size))
    };
    [f, slopes(jet.by_u, size[0]), slopes(jet.by_v, size[1])]
}

/// How long the vector is whose product with a point is the combination `w` of the two planes.
#[inline(always)]
pub fn plane_norm<T: Real>(planes: &RayPlanes<T>, w: [T; 2]) -> T {
    let along = w[0] * planes.slope[0] + w[1] * planes.slope[1];
    (w[0] * w[0] + w[1] * w[1] + along * along).sqrt()
}
