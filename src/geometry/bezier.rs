//! Bézier curves and tensor-product patches over homogeneous points.

use glam::{DVec2, DVec3, DVec4};
use std::ops::{Add, Mul, Sub};

/// A point with premultiplied weight, `(w·x, w·y[, w·z], w)`: curves and patches are polynomial in it.
pub trait Homogeneous:
    Copy
    + Default
    + PartialEq
    + std::fmt::Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<f64, Output = Self>
{
    /// The Cartesian type.
    type Point: Copy;
    /// Premultiplies.
    fn new(point: Self::Point, weight: f64) -> Self;
    /// Divides by the weight.
    fn point(self) -> Self::Point;
    /// The weight.
    fn weight(self) -> f64;
}

/// `(w·x, w·y, w·z, w)`.
pub type Homogeneous3 = DVec4;
/// `(w·u, w·v, w)`.
pub type Homogeneous2 = DVec3;

impl Homogeneous for DVec4 {
    type Point = DVec3;
    fn new(point: DVec3, weight: f64) -> Self {
        (point * weight).extend(weight)
    }
    fn point(self) -> DVec3 {
        self.truncate() / self.w
    }
    fn weight(self) -> f64 {
        self.w
    }
}

impl Homogeneous for DVec3 {
    type Point = DVec2;
    fn new(point: DVec2, weight: f64) -> Self {
        (point * weight).extend(weight)
    }
    fn point(self) -> DVec2 {
        self.truncate() / self.z
    }
    fn weight(self) -> f64 {
        self.z
    }
}

/// A rational Bézier curve on [0, 1]; degree = points − 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Bezier<P> {
    /// Control points, at least two.
    pub points: Vec<P>,
}

/// A rational Bézier patch on [0, 1]².
#[derive(Debug, Clone, PartialEq)]
pub struct BezierPatch {
    /// Degrees along u and v.
    pub degrees: [usize; 2],
    /// `(degrees[0] + 1) · (degrees[1] + 1)` control points, v running fastest: point (i, j) at `i · (degrees[1] + 1) + j`.
    pub points: Vec<Homogeneous3>,
}

/// The value and the first two derivatives of a Cartesian curve.
impl<P: Homogeneous> Bezier<P> {
    /// The homogeneous point at `t`.
    pub fn eval(&self, t: f64) -> P {
        todo!()
    }
    /// The two halves at `t`.
    pub fn split(&self, t: f64) -> [Self; 2] {
        todo!()
    }
    /// The piece over `[a, b]`, reversed where `a > b`; end points at exactly 0 and 1 are kept bit for bit.
    pub fn piece(&self, a: f64, b: f64) -> Self {
        todo!()
    }
}

impl BezierPatch {
    /// The control point (i, j).
    pub fn point(&self, i: usize, j: usize) -> Homogeneous3 {
        self.points[i * (self.degrees[1] + 1) + j]
    }
    /// Homogeneous value and first partial derivatives at (u, v).
    pub fn derivatives(&self, u: f64, v: f64) -> [Homogeneous3; 3] {
        todo!()
    }
    /// The sub-patch over `[u0, u1] × [v0, v1]`, reparameterised to [0, 1]².
    pub fn piece(&self, u: [f64; 2], v: [f64; 2]) -> Self {
        todo!()
    }
}
