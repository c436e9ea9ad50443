//! Ruled surfaces (118), surfaces of revolution (120) and tabulated cylinders (122), exactly, as rational B-splines
//! (The NURBS Book, §8.3 to 8.5). Their parameters are those of the file, but for arcs: see `ParameterMap`.

use super::curve::{pieces, profile};
use super::directory::{Directory, Mapped, Parameters};
use super::surface::{Arc, ParameterMap, Sheet};
use crate::geometry::{
    BsplineCurve, BsplineSurface, Homogeneous, Homogeneous3, KnotError, Surface, elevated,
};
use glam::{DAffine3, DQuat, DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Breakpoints of two curves closer than this, as a share of the whole, are one.
const SAME_BREAK: f64 = 1e-9;

/// Files write a whole turn with some six digits: 6.28318.
const WHOLE_TURN: f64 = 2e-5;

fn sheet(
    parameters: &Parameters,
    surface: Result<BsplineSurface, KnotError>,
    arcs: [Vec<Arc>; 2],
) -> Mapped<Sheet> {
    let surface = surface.map_err(|error| parameters.problem(error.to_string()))?;
    let parameters = ParameterMap { scale: DVec2::ONE, arcs };
    Ok(Sheet { surface: Surface::Bspline(surface), flipped: false, parameters, deviation: 0.0 })
}

/// Entity 122: the directrix, and the point to which its start moves.
pub fn tabulated(file: &Directory, parameters: &Parameters, place: &DAffine3) -> Mapped<Sheet> {
    let directrix = parameters.reference(1)?;
    let (curve, spans) = profile(file, directrix, place)?;
    let target = place.transform_point3(parameters.point(2)?);
    let along = target - Homogeneous::point(curve.points[0]);
    if !(along.length() > 0.0 && along.is_finite()) {
        return Err(parameters.problem("the cylinder has no length"));
    }
    let moved = |p: &Homogeneous3| [*p, *p + (along * p.w).extend(0.0)];
    let points = curve.points.iter().flat_map(moved).collect();
    let knots = [curve.knots.as_slice().to_vec(), vec![0.0, 0.0, 1.0, 1.0]];
    let surface = BsplineSurface::new([curve.knots.degree(), 1], knots, points);
    sheet(parameters, surface, [Arc::of(&spans), Vec::new()])
}

/// Entity 120: the axis (a line), the generatrix, and the angles between which it turns.
pub fn revolved(file: &Directory, parameters: &Parameters, place: &DAffine3) -> Mapped<Sheet> {
    let axis = pieces(file, parameters.reference(1)?, place)?;
    let [start, end] = match axis.as_slice() {
        [piece] => piece.ends(),
        _ => return Err(parameters.problem("the axis is no line")),
    };
    let direction =
        (end - start).try_normalize().ok_or_else(|| parameters.problem("the axis has no length"))?;
    let generatrix = parameters.reference(2)?;
    let (first, last) = (parameters.real(3)?, parameters.real(4)?);
    let turn = if last > first { (last - first).min(TAU) } else { (last - first).rem_euclid(TAU) };
    let turn = if turn <= WHOLE_TURN || turn > TAU - WHOLE_TURN { TAU } else { turn };
    let (curve, spans) = profile(file, generatrix, place)?;
    let mirrored = place.matrix3.determinant() < 0.0;
    let angles = if mirrored { [-first, -first - turn] } else { [first, first + turn] };
    let (surface, arcs) = turned(&curve, start, direction, angles, [first, first + turn]);
    sheet(parameters, surface, [Arc::of(&spans), arcs])
}

/// `curve(u)` turned about an axis by angles from `angles[0]` to `angles[1]`, which the parameter v counts over `range`.
pub fn turned(
    curve: &BsplineCurve<Homogeneous3>,
    origin: DVec3,
    axis: DVec3,
    angles: [f64; 2],
    range: [f64; 2],
) -> (Result<BsplineSurface, KnotError>, Vec<Arc>) {
    let turn = angles[1] - angles[0];
    let count = (turn.abs() / FRAC_PI_2 - 1e-9).ceil().clamp(1.0, 4.0) as u32;
    let half = 0.5 * turn / f64::from(count);
    let is_whole = (turn.abs() - TAU).abs() < 1e-12;
    let rotations: Vec<DQuat> = (0..=2 * count)
        .map(|k| if is_whole && k == 2 * count { 0.0 } else { f64::from(k) * half })
        .map(|angle| DQuat::from_axis_angle(axis, angles[0] + angle))
        .collect();
    let mut points = Vec::with_capacity(curve.points.len() * rotations.len());
    for point in &curve.points {
        let position = Homogeneous::point(*point) - origin;
        let along = axis * position.dot(axis);
        let across = position - along;
        for (k, rotation) in rotations.iter().enumerate() {
            let turned = *rotation * across;
            let (offset, weight) = if k % 2 == 0 { (turned, 1.0) } else { (turned / half.cos(), half.cos()) };
            points.push(<Homogeneous3 as Homogeneous>::new(origin + along + offset, point.w * weight));
        }
    }
    let joint = |k: u32| range[0] + (range[1] - range[0]) * f64::from(k) / f64::from(count);
    let knots = [range[0]].into_iter().chain((0..=count).flat_map(|k| [joint(k); 2])).chain([joint(count)]);
    let arcs = (0..count).map(|k| Arc { range: [joint(k), joint(k + 1)], half_angle: half.abs() }).collect();
    let knots = [curve.knots.as_slice().to_vec(), knots.collect()];
    (BsplineSurface::new([curve.knots.degree(), 2], knots, points), arcs)
}

/// Entity 118: two curves, the second one run backwards where DIRFLG is 1. Points at equal shares of the parameters are
/// joined (form 1); equal shares of the arc lengths (form 0) are the same for lines and circles and near it for others.
pub fn ruled(file: &Directory, parameters: &Parameters, place: &DAffine3) -> Mapped<Sheet> {
    let rail = |at: usize, backwards: bool| -> Mapped<BsplineCurve<Homogeneous3>> {
        let entity = parameters.reference(at)?;
        // A rail may shrink to a point.
        if file.kind(entity) == 116 {
            let point = place.transform_point3(super::surface::location(file, entity)?);
            let point = <Homogeneous3 as Homogeneous>::new(point, 1.0);
            let curve = BsplineCurve::new(1, vec![0.0, 0.0, 1.0, 1.0], vec![point; 2]);
            return curve.map_err(|error| parameters.problem(error.to_string()));
        }
        let (curve, _) = profile(file, entity, place)?;
        let [first, last] = curve.domain();
        let curve = if backwards { curve.piece(last, first) } else { Some(curve) };
        curve.and_then(|curve| normalised(&curve)).ok_or_else(|| parameters.problem("a rail has no length"))
    };
    let rails = [rail(1, false)?, rail(2, parameters.integer(3)? == 1)?];
    let degree = rails[0].knots.degree().max(rails[1].knots.degree());
    let mut breaks: Vec<f64> = rails.iter().flat_map(|r| r.knots.inner_knots().map(|(t, _)| t)).collect();
    breaks.extend([0.0, 1.0]);
    breaks.sort_by(f64::total_cmp);
    breaks.dedup_by(|b, a| *b - *a <= SAME_BREAK);
    if let Some(last) = breaks.last_mut() {
        *last = 1.0;
    }
    let mut points: Vec<[Homogeneous3; 2]> = Vec::new();
    for range in breaks.windows(2) {
        let span = |rail: &BsplineCurve<Homogeneous3>| bezier(rail, [range[0], range[1]], degree);
        let (Some(a), Some(b)) = (span(&rails[0]), span(&rails[1])) else {
            return Err(parameters.problem("the rails cannot be cut at common parameters"));
        };
        let skip = usize::from(!points.is_empty());
        points.extend(a.into_iter().zip(b).skip(skip).map(|(a, b)| [a, b]));
    }
    let inner = breaks.iter().flat_map(|t| std::iter::repeat_n(*t, degree));
    let knots: Vec<f64> = [0.0].into_iter().chain(inner).chain([1.0]).collect();
    let surface = BsplineSurface::new(
        [degree, 1],
        [knots, vec![0.0, 0.0, 1.0, 1.0]],
        points.into_iter().flatten().collect(),
    );
    sheet(parameters, surface, [Vec::new(), Vec::new()])
}

/// The curve over [0, 1].
fn normalised(curve: &BsplineCurve<Homogeneous3>) -> Option<BsplineCurve<Homogeneous3>> {
    let [first, last] = curve.domain();
    let knots = curve.knots.as_slice().iter().map(|t| (t - first) / (last - first)).collect();
    BsplineCurve::new(curve.knots.degree(), knots, curve.points.clone()).ok()
}

/// The Bézier points over a range within which the curve has no knots but for rounding.
fn bezier(curve: &BsplineCurve<Homogeneous3>, [a, b]: [f64; 2], degree: usize) -> Option<Vec<Homogeneous3>> {
    let near = |t: f64| {
        let knot =
            curve.knots.inner_knots().map(|(knot, _)| knot).find(|knot| (knot - t).abs() <= SAME_BREAK);
        knot.unwrap_or(t)
    };
    let piece = curve.piece(near(a), near(b))?;
    (piece.points.len() == curve.knots.degree() + 1).then(|| elevated(piece.points, degree))
}
