//! Surfaces and their parameterisations (ISO 10303-42, clause 4.5; angles in radians).

use super::bezier::Homogeneous;
use super::bspline::BsplineSurface;
use super::curve::{scale_of, transformed_point, wrap};
use super::frame::Frame;
use super::{analytic, bounds};
use crate::numeric::Aabb;
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

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
        match self {
            Self::Bspline(surface) => surface.point(wrapped(surface, uv)),
            _ => self.derivatives(uv).point,
        }
    }
    /// The point and derivatives at `uv`, wrapped or clamped as in [`Self::point`].
    pub fn derivatives(&self, uv: DVec2) -> SurfaceDerivatives {
        match self {
            Self::Plane { frame } => analytic::plane(frame, uv),
            Self::Cylinder { frame, radius } => {
                analytic::revolved(frame, uv.x, [*radius, 0.0, 0.0], [uv.y, 1.0, 0.0])
            }
            Self::Cone { frame, radius, half_angle } => {
                let slope = half_angle.tan();
                analytic::revolved(frame, uv.x, [radius + uv.y * slope, slope, 0.0], [uv.y, 1.0, 0.0])
            }
            Self::Sphere { frame, radius } => analytic::torus(frame, 0.0, *radius, uv),
            Self::Torus { frame, major, minor } => analytic::torus(frame, *major, *minor, uv),
            Self::Bspline(surface) => surface.derivatives(wrapped(surface, uv)),
        }
    }
    /// The periods of u and v: 2π for angles, the domain's length for closed B-splines.
    pub fn periods(&self) -> [Option<f64>; 2] {
        match self {
            Self::Plane { .. } => [None, None],
            Self::Cylinder { .. } | Self::Cone { .. } | Self::Sphere { .. } => [Some(TAU), None],
            Self::Torus { .. } => [Some(TAU), Some(TAU)],
            Self::Bspline(surface) => {
                let length = surface.domain().max - surface.domain().min;
                [surface.closed[0].then_some(length.x), surface.closed[1].then_some(length.y)]
            }
        }
    }
    /// The natural parameter range: one period where periodic, infinite where unbounded.
    pub fn domain(&self) -> ParameterBox {
        let (u, v) = match self {
            Self::Plane { .. } => ([f64::NEG_INFINITY, f64::INFINITY], [f64::NEG_INFINITY, f64::INFINITY]),
            Self::Cylinder { .. } | Self::Cone { .. } => ([0.0, TAU], [f64::NEG_INFINITY, f64::INFINITY]),
            Self::Sphere { .. } => ([0.0, TAU], [-FRAC_PI_2, FRAC_PI_2]),
            Self::Torus { .. } => ([0.0, TAU], [0.0, TAU]),
            Self::Bspline(surface) => return surface.domain(),
        };
        ParameterBox { min: DVec2::new(u[0], v[0]), max: DVec2::new(u[1], v[1]) }
    }
    /// Poles, apexes and collapsed sides (those within 1e-9 of the control net's size).
    pub fn singularities(&self) -> Vec<Singularity> {
        let at_v = |value: f64| Singularity { axis: 1, value, point: self.point(DVec2::new(0.0, value)) };
        match self {
            Self::Plane { .. } | Self::Cylinder { .. } => Vec::new(),
            Self::Cone { frame, radius, half_angle } => {
                let value = -radius / half_angle.tan();
                vec![Singularity { axis: 1, value, point: frame.point(DVec3::new(0.0, 0.0, value)) }]
            }
            Self::Sphere { .. } => vec![at_v(-FRAC_PI_2), at_v(FRAC_PI_2)],
            Self::Torus { major, minor, .. } if minor > major => {
                let value = (-major / minor).acos();
                vec![at_v(value), at_v(TAU - value)]
            }
            Self::Torus { major, minor, .. } if minor == major => vec![at_v(PI)],
            Self::Torus { .. } => Vec::new(),
            Self::Bspline(surface) => collapsed_sides(surface),
        }
    }
    /// The surface moved by a similarity. Planes, cylinders and cones measure some of their parameters in lengths, which
    /// scale along. A mirror flips the frame's y axis, so that `S_u × S_v` stays the moved normal; B-splines keep their
    /// parameters instead. Returns the surface and whether its normal came out opposite to the moved normal.
    pub fn transformed(&self, transform: &DAffine3) -> (Self, bool) {
        let scale = scale_of(transform);
        let mirrors = transform.matrix3.determinant() < 0.0;
        let moved = |frame: &Frame| {
            let frame = frame.transformed(transform);
            // Under a mirror `Frame::transformed` turns z around; here z has to go along, and y to turn around.
            if mirrors { Frame { y: -frame.y, z: -frame.z, ..frame } } else { frame }
        };
        let surface = match self {
            Self::Plane { frame } => Self::Plane { frame: moved(frame) },
            Self::Cylinder { frame, radius } => {
                Self::Cylinder { frame: moved(frame), radius: radius * scale }
            }
            Self::Cone { frame, radius, half_angle } => {
                Self::Cone { frame: moved(frame), radius: radius * scale, half_angle: *half_angle }
            }
            Self::Sphere { frame, radius } => Self::Sphere { frame: moved(frame), radius: radius * scale },
            Self::Torus { frame, major, minor } => {
                Self::Torus { frame: moved(frame), major: major * scale, minor: minor * scale }
            }
            Self::Bspline(surface) => {
                let points = surface.points.iter().map(|p| transformed_point(transform, *p)).collect();
                return (Self::Bspline(BsplineSurface { points, ..surface.clone() }), mirrors);
            }
        };
        (surface, false)
    }
    /// A box around the piece over `range` (which may exceed one period), not larger than needed by more than a few percent.
    pub fn bounds(&self, range: ParameterBox) -> Aabb {
        bounds::surface_bounds(self, range)
    }
    /// "plane", "cylinder", "cone", "sphere", "torus" or "bspline".
    pub fn kind(&self) -> &'static str {
        match self {
            Self::Plane { .. } => "plane",
            Self::Cylinder { .. } => "cylinder",
            Self::Cone { .. } => "cone",
            Self::Sphere { .. } => "sphere",
            Self::Torus { .. } => "torus",
            Self::Bspline(_) => "bspline",
        }
    }
}

fn wrapped(surface: &BsplineSurface, uv: DVec2) -> DVec2 {
    let domain = surface.domain();
    let wrapped = |t: f64, closed: bool, range: [f64; 2]| if closed { wrap(t, range) } else { t };
    DVec2::new(
        wrapped(uv.x, surface.closed[0], [domain.min.x, domain.max.x]),
        wrapped(uv.y, surface.closed[1], [domain.min.y, domain.max.y]),
    )
}

fn collapsed_sides(surface: &BsplineSurface) -> Vec<Singularity> {
    let (domain, tolerance) = (surface.domain(), 1e-9 * surface.size());
    let sides = [(0, false), (0, true), (1, false), (1, true)].into_iter();
    let collapsed = |(axis, last): (usize, bool)| {
        let corner = surface.side(axis, last).next()?;
        let value = if last { domain.max[axis] } else { domain.min[axis] };
        surface.side(axis, last).all(|p| p.separation(corner) <= tolerance).then(|| Singularity {
            axis,
            value,
            point: Homogeneous::point(corner),
        })
    };
    sides.filter_map(collapsed).collect()
}
