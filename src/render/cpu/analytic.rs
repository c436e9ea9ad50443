//! Rays against planes, cylinders, cones, spheres and tori: closed forms over re-origined rays.
//!
//! All work in the carrier's frame, the ray's origin already near the frame's (see [`super::ray_space`]). The quadratics slide once more, to
//! the closest approach to the axis or centre, where the discriminant is a plain difference `r² − distance²` without
//! cancelling squares (Haines, Günther and Akenine-Möller, "Precision improvements for ray/sphere intersection", Ray Tracing Gems, ch. 7).

use super::footprint::LONGEST;
use super::torus::torus_roots;
use super::vector::{Vector3, number, vec3};
use crate::numeric::{Mask, Number, Real};
use crate::scene::FaceKind;

/// Where a line meets a carrier, ascending.
#[derive(Debug, Clone, Copy)]
pub struct Roots<T> {
    /// How many.
    pub count: usize,
    /// Distances from the ray's origin, in units of the direction.
    pub t: [T; 4],
}

impl<T: Real> Roots<T> {
    /// No roots.
    pub fn none() -> Self {
        Self { count: 0, t: [T::ZERO; 4] }
    }
    /// Adds a root, keeping order; what is not finite or beyond four is left out.
    #[inline]
    pub fn insert(&mut self, t: T) {
        if !t.is_finite() || self.count == 4 {
            return;
        }
        let mut at = self.count;
        while at > 0 && self.t[at - 1] > t {
            self.t[at] = self.t[at - 1];
            at -= 1;
        }
        self.t[at] = t;
        self.count += 1;
    }
}

/// Where along a line roots are wanted: where it is in the box of a face, as wide as the face's slack.
#[derive(Debug, Clone, Copy)]
pub struct Span<T> {
    /// Counted from the line's origin, in units of the direction.
    pub ends: [T; 2],
    /// Millimetres.
    pub slack: T,
}

impl<T: Real> Span<T> {
    /// All of the line.
    pub fn whole() -> Self {
        Self { ends: [-T::INFINITY, T::INFINITY], slack: T::ZERO }
    }

    /// The ends in lengths, times `scale`, as far beyond the box as a footprint reaches: in the tangent plane no hit of the face is farther.
    pub fn scaled(&self, length: T, scale: T) -> [T; 2] {
        let beyond = self.slack * number(LONGEST);
        [(self.ends[0] * length - beyond) * scale, (self.ends[1] * length + beyond) * scale]
    }
}

/// Where the line `origin + t · direction`, in the carrier's frame, meets the carrier; what is not within the span may be left out.
#[inline]
pub fn carrier_roots<T: Real>(
    kind: u32,
    origin: Vector3<T>,
    direction: Vector3<T>,
    radii: [T; 2],
    span: &Span<T>,
) -> Roots<T> {
    if kind == FaceKind::Torus as u32 {
        torus_roots(origin, direction, radii[0], radii[1], span)
    } else {
        quadric_roots(kind, origin, direction, radii).roots()
    }
}

/// Where lines meet a plane, a quadric: two distances at most.
#[derive(Debug, Clone, Copy)]
pub struct Pair<T: Number> {
    /// Distances from the rays' origins, in units of the directions.
    pub t: [T; 2],
    /// Whether they are any.
    pub exists: [T::Mask; 2],
}

impl<T: Number> Pair<T> {
    fn of(first: T, second: T, exists: T::Mask) -> Self {
        Self { t: [first, second], exists: [exists & first.is_finite(), exists & second.is_finite()] }
    }
}

impl<T: Real> Pair<T> {
    #[inline(always)]
    fn roots(self) -> Roots<T> {
        let mut roots = Roots::none();
        for (t, exists) in self.t.into_iter().zip(self.exists) {
            if exists {
                roots.insert(t);
            }
        }
        roots
    }
}

/// `z = 0`.
#[inline(always)]
pub fn plane_roots<T: Number>(o: Vector3<T>, d: Vector3<T>) -> Pair<T> {
    let t = -o.z / d.z;
    Pair { t: [t, t], exists: [t.is_finite(), Mask::everywhere(false)] }
}

/// `x² + y² = r²`.
#[inline(always)]
pub fn cylinder_roots<T: Number>(o: Vector3<T>, d: Vector3<T>, radius: T) -> Pair<T> {
    closest_then_chord(vec3(o.x, o.y, T::ZERO), vec3(d.x, d.y, T::ZERO), radius)
}

/// `x² + y² + z² = r²`.
#[inline(always)]
pub fn sphere_roots<T: Number>(o: Vector3<T>, d: Vector3<T>, radius: T) -> Pair<T> {
    closest_then_chord(o, d, radius)
}

/// `|o + t d| = radius`.
#[inline(always)]
fn closest_then_chord<T: Number>(o: Vector3<T>, d: Vector3<T>, radius: T) -> Pair<T> {
    let dd = d.dot(d);
    let slide = -o.dot(d) / dd;
    let closest = d.fused(slide, o);
    let distance = closest.length();
    let under_root = (radius - distance) * (radius + distance);
    // What roundings keep from 0 touches.
    let touches = (-number::<T>(2.0) * T::EPSILON * radius * (radius + o.length())).is_at_most(under_root);
    let half = (under_root.max(T::ZERO) / dd).sqrt();
    Pair::of(slide - half, slide + half, touches)
}

/// Sizes of the cone that its ray may slide by: as many times its roundings are polished away.
const FARTHEST_SLIDE: f64 = 64.0;

/// `x² + y² = (r + k z)²`, both nappes: the trim window tells them apart.
///
/// The discriminant of a cone has no such form as a sphere's; three Newton steps on the implicit, evaluated at the root, make up for what
/// its rounding costs.
#[inline(always)]
pub fn cone_roots<T: Number>(o: Vector3<T>, d: Vector3<T>, radius: T, slope: T) -> Pair<T> {
    // The closest approach to the axis, unless it is far off, as it is for rays along the axis. What the way there and back rounds is polished away.
    let slide = -(o.x * d.x + o.y * d.y) / (d.x * d.x + d.y * d.y);
    let farthest = number::<T>(FARTHEST_SLIDE) * (o.length() + radius.abs());
    let slide = T::choose((slide.abs() * d.length()).is_at_most(farthest), slide, T::ZERO);
    let p = d.fused(slide, o);
    let (rho, drho) = (radius + slope * p.z, slope * d.z);
    let a = (d.x * d.x + d.y * d.y) - drho * drho;
    let b = (p.x * d.x + p.y * d.y) - rho * drho;
    let c = (p.x * p.x + p.y * p.y) - rho * rho;
    let discriminant = b * b - a * c;
    // What roundings keep from 0 touches.
    let terms = ((d.x * d.x + d.y * d.y) + drho * drho) * ((p.x * p.x + p.y * p.y) + rho * rho);
    let touches = (-number::<T>(2.0) * T::EPSILON * terms).is_at_most(discriminant);
    if !touches.any() {
        return Pair::of(T::ZERO, T::ZERO, touches);
    }
    let q = -(b + b.signum() * discriminant.max(T::ZERO).sqrt());
    let polished = |start: T| polish_cone(o, d, radius, slope, start);
    Pair::of(polished(slide + q / a), polished(slide + c / q), touches)
}

/// `|(x, y)| − |r + k z|` at a point of a ray, and its change along the ray.
#[inline(always)]
fn cone_residual_and_change<T: Number>(o: Vector3<T>, d: Vector3<T>, radius: T, slope: T, t: T) -> [T; 2] {
    let p = o + d * t;
    let across = (p.x * p.x + p.y * p.y).sqrt();
    let rho = radius + slope * p.z;
    [across - rho.abs(), (p.x * d.x + p.y * d.y) / across - rho.signum() * slope * d.z]
}

/// Newton's method on `|(x, y)| − |r + k z|`, as long as that gets less: beside a tangent, which has no root to go to, a step is as long as you like.
#[inline(always)]
fn polish_cone<T: Number>(o: Vector3<T>, d: Vector3<T>, radius: T, slope: T, start: T) -> T {
    let mut t = start;
    let [mut residual, mut change] = cone_residual_and_change(o, d, radius, slope, t);
    let mut falls = T::Mask::everywhere(true);
    for _ in 0..3 {
        let next = t - residual / change;
        let [left, next_change] = cone_residual_and_change(o, d, radius, slope, next);
        falls = falls & left.abs().is_less(residual.abs());
        if !falls.any() {
            break;
        }
        let choose = |yes, no| T::choose(falls, yes, no);
        (t, residual, change) = (choose(next, t), choose(left, residual), choose(next_change, change));
    }
    t
}

/// Where lines meet a plane, a cylinder, a cone or a sphere, in no order.
#[inline(always)]
pub fn quadric_roots<T: Number>(kind: u32, o: Vector3<T>, d: Vector3<T>, radii: [T; 2]) -> Pair<T> {
    if kind == FaceKind::Plane as u32 {
        plane_roots(o, d)
    } else if kind == FaceKind::Cylinder as u32 {
        cylinder_roots(o, d, radii[0])
    } else if kind == FaceKind::Cone as u32 {
        cone_roots(o, d, radii[0], radii[1])
    } else {
        sphere_roots(o, d, radii[0])
    }
}

/// Surface parameters of a point of the carrier, in the carrier's frame; angles in (−π, π].
#[inline(always)]
pub fn carrier_parameters<T: Number>(kind: u32, p: Vector3<T>, radii: [T; 2]) -> [T; 2] {
    let minus_where = |is_negative: T::Mask| T::choose(is_negative, -T::ONE, T::ONE);
    if kind == FaceKind::Plane as u32 {
        [p.x, p.y]
    } else if kind == FaceKind::Cylinder as u32 {
        [p.y.atan2(p.x), p.z]
    } else if kind == FaceKind::Cone as u32 {
        // Beyond the apex the radius is negative and u points the other way.
        let side = minus_where((radii[0] + radii[1] * p.z).is_less(T::ZERO));
        [(p.y * side).atan2(p.x * side), p.z]
    } else {
        let across = (p.x * p.x + p.y * p.y).sqrt();
        if kind == FaceKind::Sphere as u32 {
            return [p.y.atan2(p.x), p.z.atan2(across)];
        }
        let [signed, beyond] = tube_place(p, across, radii);
        let side = minus_where(signed.is_less(T::ZERO));
        [(p.y * side).atan2(p.x * side), p.z.atan2(beyond)]
    }
}

/// The unit normal `S_u × S_v` in the carrier's frame.
#[inline]
pub fn carrier_normal<T: Real>(kind: u32, uv: [T; 2], radii: [T; 2]) -> Vector3<T> {
    if kind == FaceKind::Plane as u32 {
        return vec3(T::ZERO, T::ZERO, T::ONE);
    }
    let (sin_u, cos_u) = uv[0].sin_cos();
    if kind == FaceKind::Cylinder as u32 {
        return vec3(cos_u, sin_u, T::ZERO);
    }
    if kind == FaceKind::Cone as u32 {
        let side = if radii[0] + radii[1] * uv[1] < T::ZERO { -T::ONE } else { T::ONE };
        let scale = side / (T::ONE + radii[1] * radii[1]).sqrt();
        return vec3(cos_u * scale, sin_u * scale, -radii[1] * scale);
    }
    let (sin_v, cos_v) = uv[1].sin_cos();
    let outward = vec3(cos_v * cos_u, cos_v * sin_u, sin_v);
    if kind == FaceKind::Torus as u32 && radii[0] + radii[1] * cos_v < T::ZERO {
        return -outward;
    }
    outward
}

/// S_u and S_v at a point of the carrier, in the carrier's frame. Not finite where they are not defined: on the axis of spheres, cones and tori.
#[inline(always)]
pub fn carrier_tangents<T: Number>(kind: u32, p: Vector3<T>, radii: [T; 2]) -> [Vector3<T>; 2] {
    if kind == FaceKind::Plane as u32 {
        return [vec3(T::ONE, T::ZERO, T::ZERO), vec3(T::ZERO, T::ONE, T::ZERO)];
    }
    let around = vec3(-p.y, p.x, T::ZERO);
    if kind == FaceKind::Cylinder as u32 {
        return [around, vec3(T::ZERO, T::ZERO, T::ONE)];
    }
    let across = (p.x * p.x + p.y * p.y).sqrt();
    if kind == FaceKind::Cone as u32 {
        // The point at height z is (radius + slope z) from the axis; that is negative beyond the apex.
        let is_beyond = (radii[0] + radii[1] * p.z).is_less(T::ZERO);
        let change = radii[1] / T::choose(is_beyond, -across, across);
        return [around, vec3(p.x * change, p.y * change, T::ONE)];
    }
    if kind == FaceKind::Sphere as u32 {
        return [around, vec3(-p.z * p.x / across, -p.z * p.y / across, across)];
    }
    let [signed, beyond] = tube_place(p, across, radii);
    [around, vec3(-p.z * p.x / signed, -p.z * p.y / signed, beyond)]
}

/// A bound of the normal curvatures at a point of the carrier, in the carrier's frame.
#[inline(always)]
pub fn carrier_curvature<T: Number>(kind: u32, p: Vector3<T>, radii: [T; 2]) -> T {
    if kind == FaceKind::Plane as u32 {
        return T::ZERO;
    }
    let around = T::ONE / (p.x * p.x + p.y * p.y).sqrt();
    if kind == FaceKind::Sphere as u32 {
        T::ONE / radii[0]
    } else if kind == FaceKind::Torus as u32 {
        around.max(T::ONE / radii[1])
    } else {
        around
    }
}

/// Of the two tube circles in the half-plane of a torus' point (the far one counts for spindles) the one it lies on: the point's distance from
/// the axis, negative on the far one, and how far that is beyond the circle's centre.
#[inline(always)]
fn tube_place<T: Number>(p: Vector3<T>, across: T, radii: [T; 2]) -> [T; 2] {
    let squares = p.z * p.z - radii[1] * radii[1];
    let near = (across - radii[0]) * (across - radii[0]) + squares;
    let far = (across + radii[0]) * (across + radii[0]) + squares;
    let signed = T::choose(far.abs().is_less(near.abs()), -across, across);
    [signed, signed - radii[0]]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines within roundings of a tangent, inside and outside: what counts as touching is at the place where it touches.
    #[test]
    fn lines_that_touch_a_cone_do_so_near_it() {
        let (radius, slope) = (13.0f64, -0.999_999_999_9);
        let mut touching = 0;
        for index in 0..20_000u32 {
            let index = f64::from(index);
            let (angle, turn) = (index * 0.7, index * 0.618);
            let z = 12.0 * (index * 0.317).sin();
            let rho = radius + slope * z;
            let (sin, cos) = angle.sin_cos();
            let on = [rho * cos, rho * sin, z];
            let ruling = [slope * cos, slope * sin, 1.0];
            let around = [-sin, cos, 0.0];
            let direction = [0, 1, 2].map(|k| ruling[k] * turn.sin() + around[k] * turn.cos());
            let height =
                10f64.powf(-9.0 + 4.0 * (index / 20_000.0)) * if index % 2.0 == 0.0 { 1.0 } else { -1.0 };
            let normal = [cos, sin, -slope];
            let back = 5.0 * (index * 1.3).cos();
            let origin = [0, 1, 2].map(|k| (on[k] + normal[k] * height - direction[k] * back) as f32);
            let (origin, direction) =
                (Vector3 { x: origin[0], y: origin[1], z: origin[2] }, Vector3::<f32>::from_f64(direction));
            let roots = cone_roots(origin, direction, radius as f32, slope as f32).roots();
            for &t in &roots.t[..roots.count] {
                let p = origin + direction * t;
                let off = f64::from(p.x).hypot(p.y.into()) - (radius + slope * f64::from(p.z)).abs();
                assert!(off.abs() < 1e-6 * (20.0 + f64::from(t.abs())), "{index}: {off:e} at {t}");
                touching += 1;
            }
        }
        assert!(touching > 20_000, "{touching}");
    }
}
