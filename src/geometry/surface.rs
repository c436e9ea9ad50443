//! Surfaces and their parameterisations (ISO 10303-42, clause 4.5; angles in radians).

use super::bspline::BsplineSurface;
use super::frame::Frame;
use crate::numeric::Aabb;
use glam::{DAffine3, DVec2, DVec3};

/// A surface in space, millimetres; its normal is `S_u × S_v`.
#[derive(Debug, Clone, PartialEq)]
pub enum Surface {
    /// `frame(u, v, 0)`.
    Plane {
        /// Origin and axes.
        frame: Frame,
    },
    /// `frame(r cos u, r sin u, v)`, u of period 2π.
    Cylinder {
        /// The axis is z.
        frame: Frame,
        /// Greater than 0.
        radius: f64,
    },
    /// `frame((r + v tan α) cos u, (r + v tan α) sin u, v)`, u of period 2π; the apex at `v = −r / tan α`.
    Cone {
        /// The axis is z.
        frame: Frame,
        /// At v = 0; not negative.
        radius: f64,
        /// α in (−π/2, π/2), not 0.
        half_angle: f64,
    },
    /// `frame(r cos v cos u, r cos v sin u, r sin v)`, u of period 2π, v in [−π/2, π/2].
    Sphere {
        /// Centre; the poles lie on z.
        frame: Frame,
        /// Greater than 0.
        radius: f64,
    },
    /// `frame((R + r cos v) cos u, (R + r cos v) sin u, r sin v)`, both of period 2π.
    Torus {
        /// Centre; the axis is z.
        frame: Frame,
        /// R > 0.
        major: f64,
        /// r > 0; `r >= R` makes a horn or spindle torus.
        minor: f64,
    },
    /// A rational B-spline; extrusions, revolutions and every other swept form are brought here exactly.
    Bspline(BsplineSurface),
}

/// A rectangle of surface parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ParameterBox {
    /// Least u and v.
    pub min: DVec2,
    /// Greatest u and v.
    pub max: DVec2,
}

/// A surface point with its derivatives up to second order.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SurfaceDerivatives {
    /// S.
    pub point: DVec3,
    /// S_u.
    pub du: DVec3,
    /// S_v.
    pub dv: DVec3,
    /// S_uu.
    pub duu: DVec3,
    /// S_uv.
    pub duv: DVec3,
    /// S_vv.
    pub dvv: DVec3,
}

/// An iso-line that is a single point in space: a pole, an apex, a collapsed side of a control net.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Singularity {
    /// The parameter that is constant on it: 0 for u, 1 for v.
    pub axis: usize,
    /// Its value.
    pub value: f64,
    /// The point in space.
    pub point: DVec3,
}

impl Surface {
    /// The point at `uv`; periodic and closed parameters wrap, other B-spline parameters are clamped to the domain.
    pub fn point(&self, uv: DVec2) -> DVec3 {
        self.derivatives(uv).point
    }
    /// The point and derivatives at `uv`, wrapped or clamped as in [`Self::point`].
    pub fn derivatives(&self, uv: DVec2) -> SurfaceDerivatives {
        todo!()
    }
    /// The periods of u and v: 2π for angles, the domain's length for closed B-splines.
    pub fn periods(&self) -> [Option<f64>; 2] {
        todo!()
    }
    /// The natural parameter range: one period where periodic, infinite where unbounded.
    pub fn domain(&self) -> ParameterBox {
        todo!()
    }
    /// Poles, apexes and collapsed sides.
    pub fn singularities(&self) -> Vec<Singularity> {
        todo!()
    }
    /// The surface moved by a similarity. A mirror keeps `S_u × S_v` consistent by flipping a frame axis; returns the surface and whether its
    /// normal came out opposite to the moved normal.
    pub fn transformed(&self, transform: &DAffine3) -> (Self, bool) {
        todo!()
    }
    /// A box around the piece over `range` (which may exceed one period), not larger than needed by more than a few percent.
    pub fn bounds(&self, range: ParameterBox) -> Aabb {
        todo!()
    }
    /// "plane", "cylinder", "cone", "sphere", "torus" or "bspline".
    pub fn kind(&self) -> &'static str {
        todo!()
    }
}
