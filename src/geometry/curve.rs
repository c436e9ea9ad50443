//! Curves in space and in parameter planes.

use super::bezier::{Homogeneous, Homogeneous2, Homogeneous3};
use super::bspline::BsplineCurve;
use super::frame::Frame;
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::TAU;

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
        match self {
            Self::Bspline(curve) => Homogeneous::point(curve.eval(wrapped(curve, t))),
            _ => self.derivatives(t).point,
        }
    }
    /// The point and two derivatives at `t`.
    pub fn derivatives(&self, t: f64) -> CurveDerivatives {
        let local = |frame: &Frame, p: DVec2, d1: DVec2, d2: DVec2| CurveDerivatives {
            point: frame.point(p.extend(0.0)),
            first: frame.vector(d1.extend(0.0)),
            second: frame.vector(d2.extend(0.0)),
        };
        match self {
            Self::Line { origin, direction } => {
                CurveDerivatives { point: *origin + *direction * t, first: *direction, second: DVec3::ZERO }
            }
            Self::Circle { frame, radius } => {
                let p = DVec2::from_angle(t) * *radius;
                local(frame, p, p.perp(), -p)
            }
            Self::Ellipse { frame, radii } => {
                let (unit, radii) = (DVec2::from_angle(t), DVec2::from_array(*radii));
                local(frame, unit * radii, unit.perp() * radii, -unit * radii)
            }
            Self::Parabola { frame, focal } => local(
                frame,
                DVec2::new(t * t, 2.0 * t) * *focal,
                DVec2::new(2.0 * t, 2.0) * *focal,
                DVec2::new(2.0, 0.0) * *focal,
            ),
            Self::Hyperbola { frame, radii } => {
                let (c, s) = (radii[0] * t.cosh(), radii[1] * t.sinh());
                let (dc, ds) = (radii[0] * t.sinh(), radii[1] * t.cosh());
                local(frame, DVec2::new(c, s), DVec2::new(dc, ds), DVec2::new(c, s))
            }
            Self::Bspline(curve) => {
                let [a, a1, a2] = curve.derivatives(wrapped(curve, t));
                let point = a.truncate() / a.w;
                let first = (a1.truncate() - point * a1.w) / a.w;
                let second = (a2.truncate() - first * (2.0 * a1.w) - point * a2.w) / a.w;
                CurveDerivatives { point, first, second }
            }
        }
    }
    /// The period of closed curves: 2π for circles and ellipses, the domain's length for closed B-splines.
    pub fn period(&self) -> Option<f64> {
        match self {
            Self::Circle { .. } | Self::Ellipse { .. } => Some(TAU),
            Self::Bspline(curve) if curve.is_closed() => Some(curve.domain()[1] - curve.domain()[0]),
            _ => None,
        }
    }
    /// The parameters for which the curve is defined, one period where it is closed; infinite where unbounded.
    pub fn domain(&self) -> [f64; 2] {
        match self {
            Self::Circle { .. } | Self::Ellipse { .. } => [0.0, TAU],
            Self::Bspline(curve) => curve.domain(),
            _ => [f64::NEG_INFINITY, f64::INFINITY],
        }
    }
    /// The curve moved by a similarity (rotation, uniform scale, translation, mirror); the parameter is kept.
    pub fn transformed(&self, transform: &DAffine3) -> Self {
        let scale = scale_of(transform);
        match self {
            Self::Line { origin, direction } => Self::Line {
                origin: transform.transform_point3(*origin),
                direction: transform.transform_vector3(*direction),
            },
            Self::Circle { frame, radius } => {
                Self::Circle { frame: frame.transformed(transform), radius: radius * scale }
            }
            Self::Ellipse { frame, radii } => {
                Self::Ellipse { frame: frame.transformed(transform), radii: radii.map(|r| r * scale) }
            }
            Self::Parabola { frame, focal } => {
                Self::Parabola { frame: frame.transformed(transform), focal: focal * scale }
            }
            Self::Hyperbola { frame, radii } => {
                Self::Hyperbola { frame: frame.transformed(transform), radii: radii.map(|r| r * scale) }
            }
            Self::Bspline(curve) => Self::Bspline(BsplineCurve {
                knots: curve.knots.clone(),
                points: curve.points.iter().map(|p| transformed_point(transform, *p)).collect(),
            }),
        }
    }
    /// Parameters strictly inside `range` (either direction) where the curve may fail to be C¹, in the range's order:
    /// knots of a B-spline as often as its degree, and the seam of a closed one, in every period within the range.
    pub fn breaks(&self, range: [f64; 2]) -> Vec<f64> {
        /// A range of more periods than this is no edge of a model.
        const MAX_PERIODS: f64 = 16.0;
        let Self::Bspline(curve) = self else { return Vec::new() };
        let (low, high) = (range[0].min(range[1]), range[0].max(range[1]));
        let [first, last] = curve.domain();
        let degree = curve.knots.degree();
        let mut sharp: Vec<f64> =
            curve.knots.inner_knots().filter(|(_, count)| *count >= degree).map(|(knot, _)| knot).collect();
        let mut periods = [0.0, 0.0];
        let length = last - first;
        if (low < first || high > last) && curve.is_closed() {
            sharp.insert(0, first);
            periods = [low, high].map(|t| ((t - first) / length).floor());
            periods[1] = periods[1].min(periods[0] + MAX_PERIODS);
        }
        let mut breaks = Vec::new();
        // Counted in whole numbers: beyond 2⁵³ a period and the next are the same.
        for i in 0..=(periods[1] - periods[0]) as u32 {
            let shift = (periods[0] + f64::from(i)) * length;
            breaks.extend(sharp.iter().map(|knot| knot + shift).filter(|t| low < *t && *t < high));
        }
        breaks.dedup();
        if range[0] > range[1] {
            breaks.reverse();
        }
        breaks
    }
}

impl Curve2 {
    /// The point at `t`, which B-splines clamp to their domain.
    pub fn point(&self, t: f64) -> DVec2 {
        match self {
            Self::Line { origin, direction } => *origin + *direction * t,
            Self::Bspline(curve) => Homogeneous::point(curve.eval(t)),
        }
    }
}

/// `t` taken into the domain where the curve is closed; left as it is elsewhere.
fn wrapped(curve: &BsplineCurve<Homogeneous3>, t: f64) -> f64 {
    let [first, last] = curve.domain();
    if (t < first || t > last) && curve.is_closed() { wrap(t, [first, last]) } else { t }
}

/// The parameter inside `domain` that is whole periods from `t`; parameters inside stay as they are.
pub(super) fn wrap(t: f64, [first, last]: [f64; 2]) -> f64 {
    if t < first || t > last { first + (t - first).rem_euclid(last - first) } else { t }
}

/// A homogeneous point moved by an affine map: the translation counts as often as the weight says.
pub(super) fn transformed_point(transform: &DAffine3, point: Homogeneous3) -> Homogeneous3 {
    (transform.transform_vector3(point.truncate()) + transform.translation * point.w).extend(point.w)
}

/// The length ratio of a similarity.
pub(super) fn scale_of(transform: &DAffine3) -> f64 {
    transform.matrix3.determinant().abs().cbrt()
}
