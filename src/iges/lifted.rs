//! Curves given in the parameter plane of a surface alone, lifted into space: `S(B(t))`.
//!
//! The composition is approximated piece by piece with quintics through six Chebyshev–Lobatto points, halved until the
//! points between them agree as well.

use super::boundary::Bound;
use super::curve::{self, Piece, flattened};
use super::directory::{Mapped, Problem};
use super::reader::{Form, Reader, SurfaceUse};
use super::spans::{Span, joined};
use super::surface::ParameterMap;
use crate::brep::Pcurve;
use crate::geometry::{Curve, Curve2, Homogeneous, Homogeneous3, Surface};
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::PI;

/// Greatest error, as a share of the curve's size.
const TOLERANCE: f64 = 1e-9;

/// Halvings of one piece between corners; a kink of the surface costs as many spans.
const MAX_HALVINGS: u32 = 12;

/// The most spans of one curve.
const MOST_SPANS: usize = 4096;

/// The curves of parameter-space curve `entity` on surface `surface`.
pub fn bounds(
    reader: &mut Reader,
    entity: u32,
    surface: u32,
    used: &SurfaceUse,
    outer: &DAffine3,
) -> Mapped<Vec<Bound>> {
    let form = reader.surface(surface, outer, Form::Bounded)?;
    let pieces = curve::pieces(&reader.file, entity, &DAffine3::IDENTITY)?;
    let carrier = &reader.model.surfaces[form.id];
    // The parameters of the file count on the surface of the face only where that one still has them.
    let keeps = form.parameters.is_same() && reader.model.surfaces[used.id] == *carrier;
    let fail = |reason: String| Problem { entity, kind: reader.file.kind(entity), reason };
    let mut bounds = Vec::with_capacity(pieces.len());
    for piece in pieces {
        let lifted = lift(&piece, carrier, &form.parameters).map_err(fail)?;
        let pcurve = pcurve(&piece).filter(|_| keeps).map(|curve| Pcurve { surface: used.id, curve });
        bounds.push(Bound { piece: lifted, pcurve });
    }
    Ok(bounds)
}

/// The sides of a surface's parameter rectangle, counter-clockwise.
pub fn sides(surface: &Surface, entity: u32) -> Result<Vec<Bound>, String> {
    let domain = surface.domain();
    let corners = [
        domain.min,
        DVec2::new(domain.max.x, domain.min.y),
        domain.max,
        DVec2::new(domain.min.x, domain.max.y),
        domain.min,
    ];
    let side = |ends: &[DVec2]| {
        let (origin, direction) = (ends[0].extend(0.0), (ends[1] - ends[0]).extend(0.0));
        let curve = Curve::Line { origin, direction };
        let piece = Piece { curve, range: [0.0, 1.0], own: [0.0, 1.0], entity };
        lift(&piece, surface, &ParameterMap::same()).map(Bound::from)
    };
    corners.windows(2).map(side).collect()
}

/// The parameter curve, where the lifted curve has its parameter.
fn pcurve(piece: &Piece) -> Option<Curve2> {
    match &piece.curve {
        Curve::Line { origin, direction } => {
            Some(Curve2::Line { origin: origin.truncate(), direction: direction.truncate() })
        }
        Curve::Bspline(spline) => Some(Curve2::Bspline(flattened(spline))),
        _ => None,
    }
}

fn lift(piece: &Piece, surface: &Surface, parameters: &ParameterMap) -> Result<Piece, String> {
    let [a, b] = piece.range;
    let point = |t: f64| surface.point(parameters.apply(piece.curve.point(t).truncate()));
    let size =
        (0..=16).map(|i| point(a + (b - a) * f64::from(i) / 16.0).distance(point(a))).fold(0.0, f64::max);
    let mut corners = vec![a];
    corners.extend(piece.curve.breaks([a, b]));
    corners.push(b);
    // Backwards, so that the stack gives the spans in order.
    let mut open: Vec<([f64; 2], u32)> = corners.windows(2).rev().map(|w| ([w[0], w[1]], 0)).collect();
    let basis = Basis::new();
    let mut spans: Vec<Span> = Vec::new();
    while let Some((range, halvings)) = open.pop() {
        let points = basis.interpolate(|s| point(range[0] + s * (range[1] - range[0])));
        let error = basis.error(&points, |s| point(range[0] + s * (range[1] - range[0])));
        let fits = error <= TOLERANCE * size;
        if fits || halvings >= MAX_HALVINGS || spans.len() + open.len() >= MOST_SPANS {
            let points = points.map(|p| <Homogeneous3 as Homogeneous>::new(p, 1.0)).to_vec();
            let range = if a <= b { range } else { range.map(|t| a + b - t) };
            spans.push(Span { range, points, half_angle: None });
        } else {
            let middle = 0.5 * (range[0] + range[1]);
            open.push(([middle, range[1]], halvings + 1));
            open.push(([range[0], middle], halvings + 1));
        }
    }
    if a > b {
        // The parameter of a curve rises; the range a + b − t keeps the ends.
        for span in &mut spans {
            span.range.sort_by(f64::total_cmp);
        }
    }
    let spline = joined(&spans).map_err(|error| error.to_string())?;
    let range = spline.domain();
    Ok(Piece { curve: Curve::Bspline(spline), range, own: range, entity: piece.entity })
}

/// Bernstein polynomials of degree 5 at the Chebyshev–Lobatto points of [0, 1].
struct Basis {
    nodes: [f64; 6],
    /// From values at the nodes to control points.
    inverse: [[f64; 6]; 6],
}

fn bernstein(t: f64) -> [f64; 6] {
    const BINOMIALS: [f64; 6] = [1.0, 5.0, 10.0, 10.0, 5.0, 1.0];
    std::array::from_fn(|i| BINOMIALS[i] * t.powi(i as i32) * (1.0 - t).powi(5 - i as i32))
}

impl Basis {
    fn new() -> Self {
        let nodes: [f64; 6] = std::array::from_fn(|i| 0.5 - 0.5 * (PI * i as f64 / 5.0).cos());
        let mut matrix = nodes.map(bernstein);
        let mut inverse: [[f64; 6]; 6] =
            std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
        // Gauss–Jordan without pivots: the matrix is totally positive.
        for i in 0..6 {
            let pivot = matrix[i][i];
            for k in 0..6 {
                matrix[i][k] /= pivot;
                inverse[i][k] /= pivot;
            }
            for row in (0..6).filter(|row| *row != i) {
                let factor = matrix[row][i];
                for k in 0..6 {
                    matrix[row][k] -= factor * matrix[i][k];
                    inverse[row][k] -= factor * inverse[i][k];
                }
            }
        }
        Self { nodes, inverse }
    }

    fn interpolate(&self, point: impl Fn(f64) -> DVec3) -> [DVec3; 6] {
        let values = self.nodes.map(point);
        let mut points: [DVec3; 6] = std::array::from_fn(|i| {
            values.iter().zip(self.inverse[i]).map(|(value, share)| *value * share).sum()
        });
        // Neighbouring spans meet exactly.
        (points[0], points[5]) = (values[0], values[5]);
        points
    }

    /// The greatest distance at points between the nodes.
    fn error(&self, points: &[DVec3; 6], point: impl Fn(f64) -> DVec3) -> f64 {
        let between = |i: usize| 0.5 * (self.nodes[i] + self.nodes[i + 1]);
        let value = |t: f64| points.iter().zip(bernstein(t)).map(|(p, b)| *p * b).sum::<DVec3>();
        (0..5).map(between).map(|t| value(t).distance(point(t))).fold(0.0, f64::max)
    }
}
