//! Rays on their way from model space to the space of one primitive, without loss.
//!
//! An f32 ray in world coordinates is off by 2⁻²⁴ of the *world*, whatever it hits. Here the error stays near 2⁻²⁴ of the *primitive*,
//! by three rules:
//!
//! 1. **Grid.** A position is a pair (grid i32×3, fraction), `grid · grid_step + fraction`. Rays, instances and faces share the grid, so
//!    differences of positions lose nothing: the whole numbers cancel exactly and only fractions of a step are rounded.
//! 2. **Re-origin.** Before a ray meets a thing, its origin slides to the closest approach to the thing's centre:
//!    `o'' = fma(t0, d, base) + rest`. `base` (the grid difference) and `t0` are exact, the product is not rounded, and the sum is
//!    as small as the thing: one rounding at the thing's own scale.
//! 3. **Whole anchors.** `t0` is rounded to a multiple of the grid step. Any multiple is as good as another, for all later distances are
//!    counted from it; and sums of multiples are exact as long as they stay below 2²⁴ steps (the scene is 2¹⁶ steps wide). A hit's
//!    distance is the pair (anchor, offset), compared as `(a.anchor − b.anchor) + (a.offset − b.offset)`: the first
//!    difference is exact.
//!
//! A direction is rounded too, and would swing the ray by 2⁻²⁴ of its length; so it carries its own rounding error in
//! `direction_low`, which enters where the origin moves. None of this relies on error-free transformations, which a shader compiler
//! may reassociate away; without a fused `fma` rule 2 degrades to 2⁻²⁴ of the scene.
//!
//! Through an instance that is a translation, the grid goes on to the faces. Through a rotated one the ray is re-origined at the part,
//! rotated (one rounding at the part's scale), and continues with grid 0.

use super::frames::{FaceFrame, InstanceFrame, grid_difference, grid_position};
use super::vector::{Vector3, number};
use crate::numeric::{Eight, Number, Real, Whole};
use crate::render::Ray;
use crate::scene::Header;
use glam::DVec3;

/// A distance along a ray in two parts: `anchor`, a multiple of the grid step, and `offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Distance<T> {
    /// A multiple of the grid step.
    pub anchor: T,
    /// The rest.
    pub offset: T,
}

impl<T: Number> Distance<T> {
    /// Farther than everything.
    pub const INFINITE: Self = Self { anchor: T::ZERO, offset: T::INFINITY };

    /// `self − other`.
    #[inline(always)]
    pub fn minus(self, other: Self) -> T {
        (self.anchor - other.anchor) + (self.offset - other.offset)
    }
    /// The greater; `self` where they are equal.
    #[inline(always)]
    pub fn later(self, other: Self) -> Self {
        let is_less = T::ZERO.is_less(other.minus(self));
        let choose = |yes, no| T::choose(is_less, yes, no);
        Self { anchor: choose(other.anchor, self.anchor), offset: choose(other.offset, self.offset) }
    }
    /// `self − anchor`.
    #[inline(always)]
    pub fn beyond(self, anchor: T) -> T {
        (self.anchor - anchor) + self.offset
    }
}

impl<T: Real> Distance<T> {
    /// The sum.
    #[inline(always)]
    pub fn to_f64(self) -> f64 {
        self.anchor.to_f64() + self.offset.to_f64()
    }
}

/// A ray in world space, its origin at the closest approach to the scene's centre.
#[derive(Debug, Clone, Copy)]
pub struct WorldRay<T: Number> {
    /// Origin, grid steps …
    pub grid: [T::Whole; 3],
    /// … plus this.
    pub fraction: Vector3<T>,
    /// Of length 1 up to rounding.
    pub direction: Vector3<T>,
    /// What `direction` misses.
    pub direction_low: Vector3<T>,
}

/// A ray in part space: `grid · grid_step + fraction + (t − anchor) · direction`.
#[derive(Debug, Clone, Copy)]
pub struct PartRay<T: Number> {
    /// Origin, grid steps …
    pub grid: [T::Whole; 3],
    /// … plus this.
    pub fraction: Vector3<T>,
    /// Not of length 1 where the instance scales.
    pub direction: Vector3<T>,
    /// What `direction` misses.
    pub direction_low: Vector3<T>,
    /// 1 over the square of the direction's length.
    pub per_square: T,
    /// Where on the world ray the origin lies.
    pub anchor: T,
    /// The point closest to the part's centre, for the BVH …
    pub near_origin: Vector3<T>,
    /// … and where on the world ray it lies.
    pub near_anchor: T,
}

/// A ray in the space of a primitive, its origin as close to it as it gets.
#[derive(Debug, Clone, Copy)]
pub struct PrimitiveRay<T> {
    /// For analytic faces relative to the carrier's frame origin; for nets in face space.
    pub origin: Vector3<T>,
    /// As in the [`PartRay`].
    pub direction: Vector3<T>,
    /// Where on the world ray the origin lies.
    pub anchor: T,
}

/// A model-space ray made ready.
#[derive(Debug, Clone, Copy)]
pub struct PreparedRay<T: Number> {
    /// The ray.
    pub ray: WorldRay<T>,
    /// Add to a world distance to get the distance from the model-space origin.
    pub start: f64,
    /// World distance of the model-space origin: hits before it do not count.
    pub near: Distance<T>,
    /// Whether that origin lies outside of the scene's sphere.
    pub starts_outside: bool,
}

impl PartRay<Eight> {
    /// One of the eight rays.
    pub fn lane(&self, lane: usize) -> PartRay<f32> {
        let number = |eight: Eight| eight.to_array()[lane];
        PartRay {
            grid: self.grid.map(|along| along.to_array()[lane]),
            fraction: self.fraction.lane(lane),
            direction: self.direction.lane(lane),
            direction_low: self.direction_low.lane(lane),
            per_square: number(self.per_square),
            anchor: number(self.anchor),
            near_origin: self.near_origin.lane(lane),
            near_anchor: number(self.near_anchor),
        }
    }
}

/// The step of the grid, a power of two, and its reciprocal: products with both are exact.
#[derive(Debug, Clone, Copy)]
pub struct GridStep<T> {
    /// Millimetres.
    pub size: T,
    /// 1 / size.
    pub per_size: T,
}

impl<T: Number> GridStep<T> {
    /// That of a scene.
    #[inline(always)]
    pub fn of(header: &Header) -> Self {
        let size = T::from_f64(header.grid_step);
        Self { size, per_size: T::ONE / size }
    }
}

/// The nearest multiple of `step`.
#[inline(always)]
pub fn whole_steps<T: Number>(value: T, step: GridStep<T>) -> T {
    (value * step.per_size + number(0.5)).floor() * step.size
}

/// Brings a ray into the world's grid; `None` where it cannot meet the scene.
pub fn prepare<T: Real>(ray: &Ray, header: &Header) -> Option<PreparedRay<T>> {
    place(ray, header, scene_radius(header))
}

/// Brings a ray into the world's grid; `None` where it cannot come as near as `radius` to the world's origin.
pub fn place<T: Real>(ray: &Ray, header: &Header, radius: f64) -> Option<PreparedRay<T>> {
    let step = GridStep::<f64>::of(header);
    let direction = unit(ray.direction)?;
    let from_anchor = ray.origin - DVec3::from_array(header.world_anchor);
    let along = -from_anchor.dot(direction);
    let closest = from_anchor + direction * along;
    // Not "greater": a ray of NaNs fails this test as well.
    if !(closest.length_squared() <= radius * radius) || along < -2.0 * radius {
        return None;
    }
    let grid = (closest * step.per_size).round();
    let narrow = Vector3::<T>::from_f64(direction.to_array());
    let near = -along.min(2.0 * radius);
    let near_anchor = whole_steps(near, step);
    Some(PreparedRay {
        ray: WorldRay {
            grid: [grid.x as i32, grid.y as i32, grid.z as i32],
            fraction: Vector3::from_f64((closest - grid * step.size).to_array()),
            direction: narrow,
            direction_low: Vector3::from_f64((direction - narrow.to_f64()).to_array()),
        },
        start: along,
        near: Distance { anchor: T::from_f64(near_anchor), offset: T::from_f64(near - near_anchor) },
        starts_outside: along > 0.0 && from_anchor.length_squared() > radius * radius,
    })
}

/// A direction of length 1, as most are already; `None` where it has none.
fn unit(direction: DVec3) -> Option<DVec3> {
    let square = direction.length_squared();
    if (square - 1.0).abs() <= 4.0 * f64::EPSILON { Some(direction) } else { direction.try_normalize() }
}

/// A radius around the world's origin that holds the scene.
pub fn scene_radius(header: &Header) -> f64 {
    let half = DVec3::from_array(header.half_size.map(f64::from));
    half.length() * 1.001 + 2.0 * header.grid_step
}

/// The ray in the part's space, and whether it may meet the part: it passes others by.
#[inline(always)]
pub fn enter_instance<T: Number>(
    ray: &WorldRay<T>,
    instance: &InstanceFrame<T>,
    step: GridStep<T>,
) -> (T::Mask, PartRay<T>) {
    let grid = grid_difference(ray.grid, instance.grid);
    let base = grid_position::<T>(grid, step.size);
    let rest = ray.fraction - instance.fraction;
    let anchor = whole_steps(-(base + rest).dot(ray.direction), step);
    let near = ray.direction.fused(anchor, base) + (rest + ray.direction_low * anchor);
    // The anchor is up to half a step off the closest approach.
    let slack = instance.radius * number(0.001) + step.size;
    if instance.is_translation {
        let reach = instance.radius + slack;
        let part_ray = PartRay {
            grid,
            fraction: rest,
            direction: ray.direction,
            direction_low: ray.direction_low,
            per_square: T::ONE,
            anchor: T::ZERO,
            near_origin: near,
            near_anchor: anchor,
        };
        return (near.dot(near).is_at_most(reach * reach), part_ray);
    }
    let origin = apply_rows(&instance.rows, near);
    let direction = apply_rows(&instance.rows, ray.direction);
    let reach = instance.radius + slack * (T::ONE + direction.length());
    let part_ray = PartRay {
        grid: [Whole::ZERO; 3],
        fraction: origin,
        direction,
        direction_low: Vector3::default(),
        per_square: T::ONE / direction.dot(direction),
        anchor,
        near_origin: origin,
        near_anchor: anchor,
    };
    (origin.dot(origin).is_at_most(reach * reach), part_ray)
}

/// The ray in the space of a carrier's frame, whose axes it still has to be turned to.
#[inline]
pub fn approach_frame<T: Number>(
    ray: &PartRay<T>,
    face: &FaceFrame<T>,
    step: GridStep<T>,
) -> PrimitiveRay<T> {
    approach(ray, face.grid, face.offset, Vector3::default(), step)
}

/// The ray in face space, its origin at the closest approach to `center`.
#[inline]
pub fn approach_point<T: Number>(
    ray: &PartRay<T>,
    face_grid: [i32; 3],
    center: Vector3<T>,
    step: GridStep<T>,
) -> PrimitiveRay<T> {
    approach(ray, face_grid, Vector3::default(), center, step)
}

/// The ray relative to `grid · step + shift`, its origin at the closest approach to `center` there.
#[inline(always)]
fn approach<T: Number>(
    ray: &PartRay<T>,
    grid: [i32; 3],
    shift: Vector3<T>,
    center: Vector3<T>,
    step: GridStep<T>,
) -> PrimitiveRay<T> {
    let base = grid_position(grid_difference(ray.grid, grid), step.size);
    let rest = ray.fraction - shift;
    let d = ray.direction;
    let slide = whole_steps((center - (base + rest)).dot(d) * ray.per_square, step);
    let origin = d.fused(slide, base) + (rest + ray.direction_low * slide);
    PrimitiveRay { origin, direction: d, anchor: ray.anchor + slide }
}

/// `rows · v`.
#[inline(always)]
pub fn apply_rows<T: Number>(rows: &[Vector3<T>; 3], v: Vector3<T>) -> Vector3<T> {
    Vector3 { x: rows[0].dot(v), y: rows[1].dot(v), z: rows[2].dot(v) }
}
