//! Curves in space and in parameter planes.

use super::bezier::{Homogeneous2, Homogeneous3};
use super::bspline::BsplineCurve;
use super::frame::Frame;
use glam::{DAffine3, DVec2, DVec3};

/// A curve in space, millimetres.
#[derive(Debug, Clone, PartialEq)]
pub enum Curve {
    /// `origin + t · direction`; the direction need not be a unit vector.
    Line {
        /// At t = 0.
        origin: DVec3,
        /// Per unit of t.
        direction: DVec3,
    },
    /// `frame(r cos t, r sin t, 0)`, period 2π.
    Circle {
        /// Centre and plane.
        frame: Frame,
        /// Greater than 0.
        radius: f64,
    },
    /// `frame(a cos t, b sin t, 0)`, period 2π.
    Ellipse {
        /// Centre and plane.
        frame: Frame,
        /// Semi-axes along x and y.
        radii: [f64; 2],
    },
    /// `frame(f t², 2 f t, 0)`.
    Parabola {
        /// Vertex and plane.
        frame: Frame,
        /// Focal distance f.
        focal: f64,
    },
    /// `frame(a cosh t, b sinh t, 0)`.
    Hyperbola {
        /// Centre and plane.
        frame: Frame,
        /// Semi-axis a and imaginary semi-axis b.
        radii: [f64; 2],
    },
    /// A rational B-spline.
    Bspline(BsplineCurve<Homogeneous3>),
}

/// A curve in the parameter plane of a surface.
#[derive(Debug, Clone, PartialEq)]
pub enum Curve2 {
    /// `origin + t · direction`.
    Line {
        /// At t = 0.
        origin: DVec2,
        /// Per unit of t.
        direction: DVec2,
    },
    /// A rational B-spline.
    Bspline(BsplineCurve<Homogeneous2>),
}

/// A point of a curve and its first two derivatives by the parameter.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurveDerivatives {
    /// C.
    pub point: DVec3,
    /// C'.
    pub first: DVec3,
    /// C''.
    pub second: DVec3,
}

impl Curve {
    /// The point at `t`; B-splines clamp `t` to their domain, or wrap it where they are closed.
    pub fn point(&self, t: f64) -> DVec3 {
        self.derivatives(t).point
    }
    /// The point and two derivatives at `t`.
    pub fn derivatives(&self, t: f64) -> CurveDerivatives {
        todo!()
    }
    /// The period of closed curves.
    pub fn period(&self) -> Option<f64> {
        todo!()
    }
    /// The parameters for which the curve is defined; infinite where unbounded.
    pub fn domain(&self) -> [f64; 2] {
        todo!()
    }
    /// The curve moved by a similarity (rotation, uniform scale, translation, mirror).
    pub fn transformed(&self, transform: &DAffine3) -> Self {
        todo!()
    }
    /// Parameters strictly inside `range` (either direction) where the curve may fail to be C¹, in the range's order.
    pub fn breaks(&self, range: [f64; 2]) -> Vec<f64> {
        todo!()
    }
}

impl Curve2 {
    /// The point at `t`.
    pub fn point(&self, t: f64) -> DVec2 {
        todo!()
    }
}
