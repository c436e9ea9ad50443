//! Curve entities, as pieces of curves in millimetres: 100, 102, 104, 106, 110, 112, 126, 130.

use super::conic;
use super::directory::{Directory, Mapped, Parameters, Problem};
use super::offset;
use super::placement::{self, is_similarity};
use super::spans::{self, Span};
use crate::geometry::to_bspline::curve_to_bspline;
use crate::geometry::{BsplineCurve, Curve, Frame, Homogeneous, Homogeneous2, Homogeneous3};
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::TAU;

/// Composite curves may hold composite curves; deeper ones are cyclic or hostile.
const MAX_DEPTH: usize = 16;

/// One composite curve may not have more pieces than this.
const MOST_PIECES: usize = 1_000_000;

/// A curve from start to end.
#[derive(Debug, Clone)]
pub struct Piece {
    /// The carrier.
    pub curve: Curve,
    /// Its parameters at start and end.
    pub range: [f64; 2],
    /// The file's own parameters at start and end.
    pub own: [f64; 2],
    /// The directory number.
    pub entity: u32,
}

impl Piece {
    /// Start and end in space.
    pub fn ends(&self) -> [DVec3; 2] {
        self.range.map(|t| self.curve.point(t))
    }

    /// The point at the share `s` of the way.
    pub fn at(&self, s: f64) -> DVec3 {
        self.curve.point(self.range[0] + s * (self.range[1] - self.range[0]))
    }

    /// The greatest distance of some points from the start.
    pub fn reach(&self) -> f64 {
        let start = self.at(0.0);
        (1..=8).map(|i| self.at(f64::from(i) / 8.0).distance(start)).fold(0.0, f64::max)
    }

    /// The same piece run backwards.
    pub fn reversed(mut self) -> Self {
        self.range.reverse();
        self.own.reverse();
        self
    }
}

/// The pieces of curve `entity` in order, placed in `outer`.
pub fn pieces(file: &Directory, entity: u32, outer: &DAffine3) -> Mapped<Vec<Piece>> {
    let mut pieces = Vec::new();
    collect(file, entity, outer, 0, &mut pieces)?;
    finite(file, pieces)
}

/// The pieces of curve `entity`, to which another curve refers, in that one's own space.
pub fn pieces_within(file: &Directory, entity: u32, depth: usize) -> Mapped<Vec<Piece>> {
    let mut pieces = Vec::new();
    collect(file, entity, &DAffine3::IDENTITY, depth, &mut pieces)?;
    finite(file, pieces)
}

fn finite(file: &Directory, pieces: Vec<Piece>) -> Mapped<Vec<Piece>> {
    let finite = |piece: &Piece| {
        piece.ends().iter().all(|p| p.is_finite()) && piece.range.iter().all(|t| t.is_finite())
    };
    match pieces.iter().find(|piece| !finite(piece)) {
        Some(piece) => Err(Problem {
            entity: piece.entity,
            kind: file.kind(piece.entity),
            reason: "the curve is not finite".into(),
        }),
        None => Ok(pieces),
    }
}

/// The pieces of curve `entity` as one B-spline over the file's own parameters, with the spans it is made of.
pub fn profile(
    file: &Directory,
    entity: u32,
    outer: &DAffine3,
) -> Mapped<(BsplineCurve<Homogeneous3>, Vec<Span>)> {
    let pieces = pieces(file, entity, outer)?;
    let mut spans = Vec::new();
    let mut at = pieces.first().map_or(0.0, |piece| piece.own[0]);
    for piece in &pieces {
        // A composite curve's parameter is the sum of those of its members.
        let length = piece.own[1] - piece.own[0];
        spans.extend(spans::of_curve(&piece.curve, piece.range, [at, at + length]));
        at += length;
    }
    let fail = |reason: String| Problem { entity, kind: file.kind(entity), reason };
    let spline = spans::joined(&spans).map_err(|error| fail(error.to_string()))?;
    Ok((spline, spans))
}

fn collect(
    file: &Directory,
    entity: u32,
    outer: &DAffine3,
    depth: usize,
    pieces: &mut Vec<Piece>,
) -> Mapped<()> {
    let entry = *file.entry(entity)?;
    let parameters = file.parameters(entity)?;
    if depth > MAX_DEPTH || pieces.len() >= MOST_PIECES {
        return Err(parameters.problem("curves refer to each other in a circle"));
    }
    let place = placement::of(file, entity, outer)?;
    let (curve, range, own) = match entry.kind {
        102 => {
            for i in 0..parameters.count(1, 1)? {
                let member = parameters.reference(2 + i)?;
                // Points and connections between the members carry no curve.
                if !matches!(file.kind(member), 116 | 132) {
                    collect(file, member, &place, depth + 1, pieces)?;
                }
            }
            return Ok(());
        }
        100 => arc(&parameters)?,
        104 => conic::piece(&parameters, entry.form)?,
        106 => copious(&parameters, entry.form)?,
        110 => {
            let (start, end) = (parameters.point(1)?, parameters.point(4)?);
            (Curve::Line { origin: start, direction: end - start }, [0.0, 1.0], [0.0, 1.0])
        }
        112 => parametric(&parameters)?,
        126 => bspline(&parameters)?,
        130 => {
            for piece in offset::pieces(file, &parameters, depth + 1)? {
                let (curve, range) =
                    placed(piece.curve, piece.range, &place).map_err(|reason| parameters.problem(reason))?;
                pieces.push(Piece { curve, range, ..piece });
            }
            return Ok(());
        }
        _ => return Err(parameters.problem("this is no curve that can be read")),
    };
    let (curve, range) = placed(curve, range, &place).map_err(|reason| parameters.problem(reason))?;
    pieces.push(Piece { curve, range, own, entity });
    Ok(())
}

/// The curve moved by `place`; conics under what is no similarity become B-splines first.
fn placed(curve: Curve, range: [f64; 2], place: &DAffine3) -> Result<(Curve, [f64; 2]), String> {
    let is_affine = matches!(curve, Curve::Line { .. } | Curve::Bspline(_));
    if is_affine || is_similarity(place) {
        return Ok((curve.transformed(place), range));
    }
    let spline =
        spans::joined(&spans::of_curve(&curve, range, [0.0, 1.0])).map_err(|error| error.to_string())?;
    Ok((Curve::Bspline(spline).transformed(place), [0.0, 1.0]))
}

type Carrier = (Curve, [f64; 2], [f64; 2]);

/// Entity 100: counter-clockwise from the start to the end; a whole circle where they coincide.
fn arc(parameters: &Parameters) -> Mapped<Carrier> {
    let height = parameters.real(1)?;
    let at = |i: usize| -> Mapped<DVec2> { Ok(DVec2::new(parameters.real(i)?, parameters.real(i + 1)?)) };
    let center = at(2)?;
    let (start, end) = (at(4)? - center, at(6)? - center);
    let radius = start.length();
    if !(radius > 0.0 && radius.is_finite()) {
        return Err(parameters.problem("the arc has no radius"));
    }
    let frame = Frame::from_axes(center.extend(height), None, Some(start.extend(0.0)));
    let sweep = sweep(start, end, radius);
    let from = start.y.atan2(start.x).rem_euclid(TAU);
    Ok((Curve::Circle { frame, radius }, [0.0, sweep], [from, from + sweep]))
}

/// The counter-clockwise angle from `start` to `end`, in (0, 2π]; ends that coincide make a whole turn.
pub fn sweep(start: DVec2, end: DVec2, size: f64) -> f64 {
    if start.distance(end) <= 1e-9 * size {
        return TAU;
    }
    let angle = start.angle_to(end);
    if angle > 0.0 { angle } else { angle + TAU }
}

/// Entity 106: points in order, joined by lines.
fn copious(parameters: &Parameters, form: i32) -> Mapped<Carrier> {
    let kind = parameters.integer(1)?;
    let (width, first) = match kind {
        1 => (2, 4),
        2 => (3, 3),
        3 => (6, 3),
        _ => return Err(parameters.problem("the points have no known layout")),
    };
    if !matches!(form, 1..=3 | 11..=13 | 63) {
        return Err(parameters.problem(format!("form {form} is no curve")));
    }
    let count = parameters.count(2, width)?;
    let height = if kind == 1 { parameters.real(3)? } else { 0.0 };
    let mut points: Vec<DVec3> = Vec::with_capacity(count + 1);
    for i in 0..count {
        let at = first + i * width;
        let z = if kind == 1 { height } else { parameters.within(at + 2)? };
        let point = DVec3::new(parameters.within(at)?, parameters.within(at + 1)?, z);
        if points.last() != Some(&point) {
            points.push(point);
        }
    }
    if form == 63 && points.first() != points.last() {
        points.extend(points.first().copied());
    }
    if points.len() < 2 {
        return Err(parameters.problem("the polyline has fewer than two different points"));
    }
    let last = (points.len() - 1) as f64;
    let knots = [0.0].into_iter().chain((0..points.len()).map(|i| i as f64)).chain([last]).collect();
    let points = points.into_iter().map(|p| <Homogeneous3 as Homogeneous>::new(p, 1.0)).collect();
    let spline =
        BsplineCurve::new(1, knots, points).map_err(|error| parameters.problem(error.to_string()))?;
    Ok((Curve::Bspline(spline), [0.0, last], [0.0, last]))
}

/// Entity 112: cubics `A + B s + C s² + D s³` between breakpoints.
fn parametric(parameters: &Parameters) -> Mapped<Carrier> {
    let count = parameters.count(4, 13)?;
    let breaks: Vec<f64> = (0..=count).map(|i| parameters.given(5 + i)).collect::<Mapped<_>>()?;
    let mut spans = Vec::with_capacity(count);
    for i in 0..count {
        let at = 6 + count + 12 * i;
        let coefficient = |k: usize| -> Mapped<DVec3> {
            Ok(DVec3::new(
                parameters.within(at + k)?,
                parameters.within(at + 4 + k)?,
                parameters.within(at + 8 + k)?,
            ))
        };
        let width = breaks[i + 1] - breaks[i];
        let points = cubic([coefficient(0)?, coefficient(1)?, coefficient(2)?, coefficient(3)?], width);
        let points = points.map(|p| <Homogeneous3 as Homogeneous>::new(p, 1.0)).to_vec();
        spans.push(Span { range: [breaks[i], breaks[i + 1]], points, half_angle: None });
    }
    let spline = spans::joined(&spans).map_err(|error| parameters.problem(error.to_string()))?;
    let range = spline.domain();
    Ok((Curve::Bspline(spline), range, range))
}

/// Bézier points of `a + b s + c s² + d s³` for s in `[0, width]`.
pub fn cubic([a, b, c, d]: [DVec3; 4], width: f64) -> [DVec3; 4] {
    let (b, c, d) = (b * width, c * width * width, d * width * width * width);
    [a, a + b / 3.0, a + b * (2.0 / 3.0) + c / 3.0, a + b + c + d]
}

/// Entity 126: K, M, four properties, knots, weights, points, the range of the parameter.
fn bspline(parameters: &Parameters) -> Mapped<Carrier> {
    let last = parameters.count(1, 5)?;
    let degree = parameters.count(2, 1)?;
    let knot_count = last + degree + 2;
    let knots: Vec<f64> = (0..knot_count).map(|i| parameters.given(7 + i)).collect::<Mapped<_>>()?;
    let weights: Vec<f64> =
        (0..=last).map(|i| parameters.given(7 + knot_count + i)).collect::<Mapped<_>>()?;
    let first = 8 + knot_count + last;
    let points: Vec<DVec3> =
        (0..=last).map(|i| parameters.point_within(first + 3 * i)).collect::<Mapped<_>>()?;
    let even = weights.iter().all(|w| *w == weights[0]) && weights[0] > 0.0;
    let after = first + 3 * (last + 1);
    let domain = [knots[degree], knots[last + 1]];
    let wanted = [parameters.real(after)?, parameters.real(after + 1)?];
    let clamped = wanted.map(|t| t.clamp(domain[0].min(domain[1]), domain[1].max(domain[0])));
    let range = if clamped[0] < clamped[1] { clamped } else { domain };
    if let (true, 1, [a, b]) = (even, degree, points.as_slice())
        && domain[0] < domain[1]
    {
        let share = |t: f64| (t - domain[0]) / (domain[1] - domain[0]);
        return Ok((Curve::Line { origin: *a, direction: *b - *a }, range.map(share), range));
    }
    let point = |(p, w): (&DVec3, &f64)| <Homogeneous3 as Homogeneous>::new(*p, if even { 1.0 } else { *w });
    let points = points.iter().zip(&weights).map(point).collect();
    let spline = BsplineCurve::new(degree, ordered(knots), points)
        .map_err(|error| parameters.problem(error.to_string()))?;
    // A closed curve may begin anywhere and run over its seam, once around at most; a rounding beyond it is none.
    let [low, high] = domain;
    let near = 1e-6 * (high - low);
    let is_turn = wanted[0] < wanted[1] && wanted[1] - wanted[0] <= (high - low) + near;
    if is_turn && (wanted[0] < low - near || wanted[1] > high + near) && spline.is_closed() {
        let wanted = [wanted[0], wanted[1].min(wanted[0] + (high - low))];
        let curve = Curve::Bspline(spline);
        let unrolled = curve_to_bspline(&curve, wanted);
        let [first, last] = unrolled.domain();
        let is_whole = (first - wanted[0]).abs() <= near && (last - wanted[1]).abs() <= near;
        return Ok(if is_whole { (Curve::Bspline(unrolled), wanted, wanted) } else { (curve, range, range) });
    }
    Ok((Curve::Bspline(spline), range, range))
}

/// Knots whose order is broken by rounding only, mended.
pub fn ordered(mut knots: Vec<f64>) -> Vec<f64> {
    let length = knots.last().copied().unwrap_or(0.0) - knots.first().copied().unwrap_or(0.0);
    for i in 1..knots.len() {
        if knots[i] < knots[i - 1] && knots[i - 1] - knots[i] <= 1e-9 * length {
            knots[i] = knots[i - 1];
        }
    }
    knots
}

/// A curve of a parameter plane: x and y of a piece that was read without units.
pub fn flattened(spline: &BsplineCurve<Homogeneous3>) -> BsplineCurve<Homogeneous2> {
    let points = spline.points.iter().map(|p| DVec3::new(p.x, p.y, p.w)).collect();
    BsplineCurve { knots: spline.knots.clone(), points }
}
