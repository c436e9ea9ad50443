//! What the kernels read of instances, faces and nets, in the kernels' own number type.
//!
//! The f32 kernels read the f32 arrays, the f64 kernels the f64 arrays. Both see the same grid; what is left of a position after its
//! grid steps is at most a step long and is all that the number type rounds.

use super::bernstein::NetNumber;
use super::lanes::Octet;
use super::polish::{is_rough, polish};
use super::ray_space::WorldRay;
use super::trace::RawHit;
use super::vector::{Vector3, vec3};
use crate::numeric::{Number, Real, Whole};
use crate::scene::Scene;
use wide::{f32x8, f64x8};

/// An [`crate::scene::Instance`].
#[derive(Debug, Clone, Copy)]
pub struct InstanceFrame<T> {
    /// Rows of the linear map part ← world.
    pub rows: [Vector3<T>; 3],
    /// Whether that map is exactly the identity.
    pub is_translation: bool,
    /// World position of the part's origin, grid steps …
    pub grid: [i32; 3],
    /// … plus this.
    pub fraction: Vector3<T>,
    /// Holds the part, around its origin.
    pub radius: T,
}

/// A [`crate::scene::Face`].
#[derive(Debug, Clone, Copy)]
pub struct FaceFrame<T> {
    /// Origin of face space in part space, grid steps.
    pub grid: [i32; 3],
    /// A [`crate::scene::FaceKind`].
    pub kind: u32,
    /// Origin of the carrier's frame in face space.
    pub offset: Vector3<T>,
    /// The frame's axes.
    pub axes: [Vector3<T>; 3],
    /// `radius_0`, `radius_1`.
    pub radii: [T; 2],
    /// Least u and v of the trim window.
    pub uv_low: [T; 2],
    /// 1 / size of the trim window.
    pub uv_scale: [T; 2],
    /// Periods in normalised units; 0 where not periodic.
    pub period: [T; 2],
    /// How far beside a ray the face's border may be off.
    pub slack: T,
}

impl InstanceFrame<f32> {
    /// The same in other numbers, which hold those of f32.
    #[inline(always)]
    pub fn in_numbers<T: Number>(&self) -> InstanceFrame<T> {
        InstanceFrame {
            rows: self.rows.map(Vector3::in_numbers),
            is_translation: self.is_translation,
            grid: self.grid,
            fraction: self.fraction.in_numbers(),
            radius: T::from_f32(self.radius),
        }
    }
}

impl FaceFrame<f32> {
    /// The same in other numbers, which hold those of f32.
    #[inline(always)]
    pub fn in_numbers<T: Number>(&self) -> FaceFrame<T> {
        FaceFrame {
            grid: self.grid,
            kind: self.kind,
            offset: self.offset.in_numbers(),
            axes: self.axes.map(Vector3::in_numbers),
            radii: self.radii.map(T::from_f32),
            uv_low: self.uv_low.map(T::from_f32),
            uv_scale: self.uv_scale.map(T::from_f32),
            period: self.period.map(T::from_f32),
            slack: T::from_f32(self.slack),
        }
    }
}

/// The number types of the kernels.
pub trait Kernel: Real + NetNumber {
    /// Newton steps to a double root: half the bits, and some on the way there.
    const TANGENT_STEPS: u32;
    /// Reads an instance.
    fn instance(scene: &Scene<'_>, index: u32) -> InstanceFrame<Self>;
    /// Reads a face.
    fn face(scene: &Scene<'_>, index: u32) -> FaceFrame<Self>;
    /// The homogeneous control points of all nets.
    fn net_points<'a>(scene: &Scene<'a>) -> &'a [[Self; 4]];
    /// The hit of `ray` without what the number type rounds on the way to it, where that is much; see [`super::polish`].
    fn polished(scene: &Scene<'_>, ray: &WorldRay<Self>, hit: RawHit<Self>) -> RawHit<Self>;
    /// Eight of these numbers.
    type Octet: Octet<Self>;
}

impl Kernel for f32 {
    type Octet = f32x8;
    const TANGENT_STEPS: u32 = 16;
    #[inline]
    fn instance(scene: &Scene<'_>, index: u32) -> InstanceFrame<f32> {
        let instance = &scene.instances[index as usize];
        InstanceFrame {
            rows: [instance.part_from_world_0, instance.part_from_world_1, instance.part_from_world_2]
                .map(Vector3::from_f32),
            is_translation: instance.is_translation != 0,
            grid: instance.grid,
            fraction: Vector3::from_f32(instance.fraction),
            radius: instance.radius,
        }
    }
    #[inline]
    fn face(scene: &Scene<'_>, index: u32) -> FaceFrame<f32> {
        let face = &scene.faces[index as usize];
        FaceFrame {
            grid: face.grid,
            kind: face.kind,
            offset: Vector3::from_f32(face.offset),
            axes: [face.x_axis, face.y_axis, face.z_axis].map(Vector3::from_f32),
            radii: [face.radius_0, face.radius_1],
            uv_low: face.uv_low,
            uv_scale: face.uv_scale,
            period: face.period,
            slack: face.slack,
        }
    }
    #[inline(always)]
    fn net_points<'a>(scene: &Scene<'a>) -> &'a [[f32; 4]] {
        scene.net_points
    }
    fn polished(scene: &Scene<'_>, ray: &WorldRay<f32>, hit: RawHit<f32>) -> RawHit<f32> {
        if is_rough(scene, &hit) { polish(scene, ray, &hit).unwrap_or(hit) } else { hit }
    }
}

impl Kernel for f64 {
    type Octet = f64x8;
    const TANGENT_STEPS: u32 = 32;
    fn instance(scene: &Scene<'_>, index: u32) -> InstanceFrame<f64> {
        let (narrow, exact) = (&scene.instances[index as usize], &scene.instances_f64[index as usize]);
        InstanceFrame {
            rows: exact.part_from_world.map(Vector3::from_f64),
            is_translation: narrow.is_translation != 0,
            grid: narrow.grid,
            fraction: Vector3::from_f64(exact.origin) - grid_position(narrow.grid, scene.header.grid_step),
            radius: f64::from(narrow.radius),
        }
    }
    fn face(scene: &Scene<'_>, index: u32) -> FaceFrame<f64> {
        let (narrow, exact) = (&scene.faces[index as usize], &scene.faces_f64[index as usize]);
        FaceFrame {
            grid: narrow.grid,
            kind: narrow.kind,
            offset: Vector3::from_f64(exact.origin) - grid_position(narrow.grid, scene.header.grid_step),
            axes: [exact.x_axis, exact.y_axis, exact.z_axis].map(Vector3::from_f64),
            radii: exact.radii,
            uv_low: exact.uv_low,
            uv_scale: exact.uv_scale,
            period: exact.period,
            slack: f64::from(narrow.slack),
        }
    }
    #[inline(always)]
    fn net_points<'a>(scene: &Scene<'a>) -> &'a [[f64; 4]] {
        scene.net_points_f64
    }
    #[inline(always)]
    fn polished(_: &Scene<'_>, _: &WorldRay<f64>, hit: RawHit<f64>) -> RawHit<f64> {
        hit
    }
}

/// `grid · step`; exact where the components are below the number type's whole-number range (2²⁴ for f32).
#[inline(always)]
pub fn grid_position<T: Number>(grid: [T::Whole; 3], step: T) -> Vector3<T> {
    vec3(T::from_whole(grid[0]), T::from_whole(grid[1]), T::from_whole(grid[2])) * step
}

/// `a − b`.
#[inline(always)]
pub fn grid_difference<W: Whole>(a: [W; 3], b: [i32; 3]) -> [W; 3] {
    [a[0].minus(b[0]), a[1].minus(b[1]), a[2].minus(b[2])]
}
