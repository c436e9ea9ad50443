//! Rational B-spline curves and surfaces (Piegl & Tiller, The NURBS Book).

use super::bezier::{Homogeneous, Homogeneous3};
use super::knots::{KnotError, KnotVector};
use super::surface::SurfaceDerivatives;
use glam::{DVec2, DVec3};

/// A rational B-spline curve in homogeneous control points.
#[derive(Debug, Clone, PartialEq)]
pub struct BsplineCurve<P> {
    /// Degree and knots.
    pub knots: KnotVector,
    /// One per basis function.
    pub points: Vec<P>,
}

/// A rational B-spline surface in homogeneous control points.
#[derive(Debug, Clone, PartialEq)]
pub struct BsplineSurface {
    /// Along u.
    pub u_knots: KnotVector,
    /// Along v.
    pub v_knots: KnotVector,
    /// v running fastest: point (i, j) at `i · count_v + j`.
    pub points: Vec<Homogeneous3>,
    /// Whether the surface closes on itself along u and v: `S(u_min, v) = S(u_max, v)` for all v.
    pub closed: [bool; 2],
}

impl<P: Homogeneous> BsplineCurve<P> {
    /// A curve from a degree, a full knot vector (any, also unclamped or periodic: it is clamped by knot insertion) and control points.
    pub fn new(degree: usize, knots: Vec<f64>, points: Vec<P>) -> Result<Self, KnotError> {
        todo!()
    }
    /// First and last parameter.
    pub fn domain(&self) -> [f64; 2] {
        todo!()
    }
    /// Point, first and second derivative at `t`, clamped to the domain.
    pub fn eval(&self, t: f64) -> P {
        todo!()
    }
}

impl BsplineSurface {
    /// A surface from degrees, full knot vectors (any; clamped by knot insertion) and control points, v fastest. Detects `closed`
    /// within 1e-9 of the control net's size.
    pub fn new(
        degrees: [usize; 2],
        knots: [Vec<f64>; 2],
        points: Vec<Homogeneous3>,
    ) -> Result<Self, KnotError> {
        todo!()
    }
    /// Lowest and highest u and v.
    pub fn domain(&self) -> super::ParameterBox {
        todo!()
    }
    /// Value and derivatives up to second order, (u, v) clamped to the domain.
    pub fn derivatives(&self, uv: DVec2) -> SurfaceDerivatives {
        todo!()
    }
    /// The point at `uv`.
    pub fn point(&self, uv: DVec2) -> DVec3 {
        self.derivatives(uv).point
    }
}
