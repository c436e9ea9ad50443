//! Three-vectors over [`Number`], with the operators that WGSL's `vec3` has.

use crate::numeric::{Eight, Number, Real};
use std::ops::{Add, Mul, Neg, Sub};

/// Three numbers.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Vector3<T> {
    /// First.
    pub x: T,
    /// Second.
    pub y: T,
    /// Third.
    pub z: T,
}

/// The nearest `T`; for constants.
#[inline(always)]
pub fn number<T: Number>(value: f64) -> T {
    T::from_f64(value)
}

/// A vector.
#[inline(always)]
pub const fn vec3<T>(x: T, y: T, z: T) -> Vector3<T> {
    Vector3 { x, y, z }
}

impl<T: Number> Vector3<T> {
    /// Exact.
    #[inline(always)]
    pub fn from_f32(v: [f32; 3]) -> Self {
        vec3(T::from_f32(v[0]), T::from_f32(v[1]), T::from_f32(v[2]))
    }
    /// Rounded.
    #[inline(always)]
    pub fn from_f64(v: [f64; 3]) -> Self {
        vec3(T::from_f64(v[0]), T::from_f64(v[1]), T::from_f64(v[2]))
    }
    /// The inner product.
    #[inline(always)]
    pub fn dot(self, other: Self) -> T {
        self.x * other.x + self.y * other.y + self.z * other.z
    }
    /// The cross product.
    #[inline(always)]
    pub fn cross(self, other: Self) -> Self {
        vec3(
            self.y * other.z - self.z * other.y,
            self.z * other.x - self.x * other.z,
            self.x * other.y - self.y * other.x,
        )
    }
    /// The Euclidean length.
    #[inline(always)]
    pub fn length(self) -> T {
        self.dot(self).sqrt()
    }
    /// The greatest absolute component.
    #[inline(always)]
    pub fn greatest(self) -> T {
        self.x.abs().max(self.y.abs()).max(self.z.abs())
    }
    /// `t · self + base`, each component rounded once.
    #[inline(always)]
    pub fn fused(self, t: T, base: Self) -> Self {
        vec3(t.mul_add(self.x, base.x), t.mul_add(self.y, base.y), t.mul_add(self.z, base.z))
    }
    /// As an array.
    #[inline(always)]
    pub fn to_array(self) -> [T; 3] {
        [self.x, self.y, self.z]
    }
}

impl<T: Real> Vector3<T> {
    /// Exact.
    #[inline(always)]
    pub fn to_f64(self) -> glam::DVec3 {
        glam::DVec3::new(self.x.to_f64(), self.y.to_f64(), self.z.to_f64())
    }
}

impl Vector3<f32> {
    /// The same in other numbers, which hold those of f32.
    #[inline(always)]
    pub fn in_numbers<T: Number>(self) -> Vector3<T> {
        vec3(T::from_f32(self.x), T::from_f32(self.y), T::from_f32(self.z))
    }
}

impl Vector3<Eight> {
    /// One of the eight vectors.
    #[inline(always)]
    pub fn lane(self, lane: usize) -> Vector3<f32> {
        vec3(self.x.to_array()[lane], self.y.to_array()[lane], self.z.to_array()[lane])
    }
}

impl<T: Number> Add for Vector3<T> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        vec3(self.x + other.x, self.y + other.y, self.z + other.z)
    }
}

impl<T: Number> Sub for Vector3<T> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        vec3(self.x - other.x, self.y - other.y, self.z - other.z)
    }
}

impl<T: Number> Neg for Vector3<T> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        vec3(-self.x, -self.y, -self.z)
    }
}

impl<T: Number> Mul<T> for Vector3<T> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, factor: T) -> Self {
        vec3(self.x * factor, self.y * factor, self.z * factor)
    }
}
