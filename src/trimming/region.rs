//! From closed loops in the universal cover to the trimmed region in one window.
//!
//! Three cases. *Islands*: no loop goes round the surface; the largest loop sets the window. On a surface that is closed
//! in itself the largest loop may be a hole: then the whole surface is added (see [`are_holes`]). *Bands*: loops
//! go round; two of them bound a band, a single one closes against the pole, apex or domain edge on the side on which
//! the face lies. *Windows*: no loops at all.

use super::holes::are_holes;
use super::monotone::split_monotone;
use super::outline::Chain;
use super::pole::Pole;
use super::segment::{
    Segment, end, extent, is_constant, point_at, samples, shift, signed_area, start, straight,
};
use super::target::Target;
use super::wrap::{Strip, wrap};
use super::{EdgeDeviation, FaceTrim, TrimError};
use crate::brep::{Edge, Id};
use crate::geometry::{ParameterBox, Surface};
use glam::{DVec2, DVec3};

/// What is gathered on the way.
#[derive(Default)]
pub(super) struct Report {
    /// Bounds of the distance of edges from their images; edges may come more than once.
    pub(super) edges: Vec<(Id<Edge>, f64)>,
    pub(super) size: f64,
    pub(super) repairs: Vec<String>,
    pub(super) losses: Vec<String>,
}

impl Report {
    /// The greatest bound of each edge, in order.
    fn edge_deviations(&self) -> Vec<EdgeDeviation> {
        let mut edges = self.edges.clone();
        edges.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)));
        edges.dedup_by_key(|(edge, _)| *edge);
        edges.into_iter().map(|(edge, distance)| EdgeDeviation { edge, distance }).collect()
    }
}

/// The face that covers its whole surface.
pub(super) fn whole_surface(surface: &Surface) -> Result<FaceTrim, TrimError> {
    let mut window = surface.domain();
    if let Surface::Torus { major, minor, .. } = surface
        && minor > major
    {
        // The outer one of the two sheets of a spindle torus lies between its poles.
        let pole = (-major / minor).acos();
        (window.min.y, window.max.y) = (-pole, pole);
    }
    if !(window.min.is_finite() && window.max.is_finite()) {
        return Err(TrimError::Unbounded(format!("a whole {} has no end", surface.kind())));
    }
    Ok(FaceTrim::whole(window))
}

/// What a face's loops are beside their chains.
pub(super) struct Sides {
    /// Whether the face lies left of its chains in the parameter plane.
    pub(super) left: bool,
    /// Whether an edge is used twice.
    pub(super) seams: bool,
    /// The vertices that bound the face each by itself.
    pub(super) vertices: Vec<DVec3>,
}

/// The region bounded by `chains`.
pub(super) fn region(
    target: &Target,
    mut chains: Vec<Chain>,
    sides: &Sides,
    mut report: Report,
) -> Result<FaceTrim, TrimError> {
    for chain in &mut chains {
        chain.segments = chain
            .segments
            .iter()
            .filter(|s| s.points.len() > 2 || start(s) != end(s))
            .flat_map(split_monotone)
            .collect();
    }
    chains.retain(|chain| !chain.segments.is_empty());
    if chains.is_empty() {
        return Err(TrimError::Empty);
    }
    let winds = |axis: usize| chains.iter().any(|chain| chain.winding[axis] != 0);
    let (origin, axes) = match (winds(0), winds(1)) {
        (true, true) => {
            return Err(TrimError::Numeric("the loops go round the surface both ways".into()));
        }
        (false, false) => (island(target, &mut chains, sides), [0, 1]),
        (along_u, _) => {
            let axis = usize::from(!along_u);
            (band(target, &mut chains, axis, sides.left, &mut report)?, [axis, 1 - axis])
        }
    };
    let mut sets: Vec<Vec<Segment>> = chains.into_iter().map(|chain| chain.segments).collect();
    for axis in axes {
        if let Some(period) = target.periods[axis] {
            let steepest = steepest(target, &sets, axis);
            // Parameters closer than this to the side of a strip are on it: ten tolerances in space.
            let snap = (10.0 * target.tolerance / steepest).clamp(1e-12 * period, 1e-7 * period);
            let (wrapped, moved) = wrap(sets, Strip { axis, origin: origin[axis], period, snap })?;
            report.edges.iter_mut().for_each(|(_, deviation)| *deviation += moved * steepest);
            sets = vec![wrapped];
        }
    }
    finished(sets.into_iter().flatten().collect(), report)
}

/// The greatest length of S_u or S_v where segments start, millimetres per unit of parameter.
fn steepest(target: &Target, sets: &[Vec<Segment>], axis: usize) -> f64 {
    sets.iter().flatten().map(|s| target.metric(start(s))[axis]).fold(0.0, f64::max)
}

/// No loop goes round: the window starts at the least parameters of the largest loop.
fn island(target: &Target, chains: &mut Vec<Chain>, sides: &Sides) -> DVec2 {
    let areas: Vec<f64> = chains.iter().map(|chain| signed_area(&chain.segments)).collect();
    let largest =
        (0..areas.len()).max_by(|&a, &b| areas[a].abs().total_cmp(&areas[b].abs())).expect("there are loops");
    let [origin, _] = extent(&chains[largest].segments);
    let backwards = (areas[largest] > 0.0) != sides.left;
    let are_holes = || are_holes(target, chains, &chains[largest], backwards, &sides.vertices);
    if !sides.seams && is_closed_surface(target) && are_holes() {
        let mut low = origin;
        let mut high = origin;
        for axis in 0..2 {
            let level = mean(&chains[largest], axis);
            let poles = [false, true].map(|up| pole_beyond(target, axis, level, up));
            match (poles, target.periods[axis]) {
                ([Some(below), Some(above)], _) => (low[axis], high[axis]) = (below, above),
                (_, Some(period)) => high[axis] += period,
                _ => (low[axis], high[axis]) = (target.domain.min[axis], target.domain.max[axis]),
            }
        }
        chains.push(Chain { segments: rectangle(low, high), winding: [0; 2], edges: 0 });
        return low;
    }
    origin
}

/// The pole nearest to `level` above it or below; poles of a periodic parameter come back in each period.
fn pole_beyond(target: &Target, axis: usize, level: f64, up: bool) -> Option<f64> {
    let value = |pole: &Pole| match target.periods[axis] {
        Some(period) if up => level + (pole.value - level).rem_euclid(period),
        Some(period) => level - (level - pole.value).rem_euclid(period),
        None => pole.value,
    };
    let beyond = |value: &f64| if up { *value > level } else { *value < level };
    let values = target.poles.iter().filter(|pole| pole.axis == axis).map(value).filter(beyond);
    values.min_by(|a, b| (a - level).abs().total_cmp(&(b - level).abs()))
}

/// Whether the surface bounds a volume by itself: each parameter wraps or ends in poles.
fn is_closed_surface(target: &Target) -> bool {
    (0..2).all(|axis| {
        let pole_at = |value: f64| target.poles.iter().any(|p| p.axis == axis && p.value == value);
        target.periods[axis].is_some()
            || (pole_at(target.domain.min[axis]) && pole_at(target.domain.max[axis]))
    })
}

fn rectangle(low: DVec2, high: DVec2) -> Vec<Segment> {
    let corners = [low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)];
    (0..4).map(|i| straight(corners[i], corners[(i + 1) % 4])).collect()
}

/// Loops go round along `axis`.
fn band(
    target: &Target,
    chains: &mut Vec<Chain>,
    axis: usize,
    left: bool,
    report: &mut Report,
) -> Result<DVec2, TrimError> {
    let across = 1 - axis;
    let period = target.periods[axis].expect("only periodic parameters wind");
    let rounds: Vec<usize> = (0..chains.len()).filter(|&i| chains[i].winding[axis] % 2 != 0).collect();
    // The side of the face, in the direction of the other parameter: left of +u is +v, left of +v is −u.
    let faces_up = |i: usize| (chains[i].winding[axis] > 0) == ((axis == 0) == left);
    let ups = rounds.iter().filter(|&&i| faces_up(i)).count();
    let Some(&reference) = rounds.iter().find(|&&i| faces_up(i)).or(rounds.first()) else {
        return Err(TrimError::Numeric("a loop goes round the surface twice".into()));
    };
    let mut origin = DVec2::ZERO;
    origin[axis] = cut_position(chains, &rounds, axis, period);
    let has_poles = target.poles.iter().any(|pole| pole.axis == across);
    if let Some(width) = target.periods[across]
        && (rounds.len().is_multiple_of(2) || !has_poles)
    {
        if rounds.len() % 2 == 1 {
            return Err(TrimError::Numeric("a single loop goes round the surface".into()));
        }
        let level = |chain: &Chain| mean(chain, across);
        let base = level(&chains[reference]);
        for &i in rounds.iter().filter(|&&i| i != reference) {
            let above = (level(&chains[i]) - base).rem_euclid(width);
            // The other side of the seam, not the same place.
            let above = if above <= 1e-6 * width { width } else { above };
            let mut offset = DVec2::ZERO;
            offset[across] = base + above - level(&chains[i]);
            let turns = (offset[across] / width).round() * width;
            offset[across] = turns;
            chains[i].segments.iter_mut().for_each(|s| shift(s, offset));
        }
        origin[across] = extent(&chains[reference].segments)[0][across];
    } else if rounds.len() % 2 == 1 {
        let up = 2 * ups > rounds.len();
        let level = mean(&chains[reference], across);
        let limit = closing_value(target, across, level, up, report)?;
        if target.periods[across].is_some() {
            origin[across] =
                rounds.iter().map(|&i| extent(&chains[i].segments)[0][across]).fold(limit, f64::min);
        }
        let mut ends = [origin; 2];
        ends[1][axis] += period;
        ends.iter_mut().for_each(|p| p[across] = limit);
        chains.push(Chain { segments: vec![straight(ends[0], ends[1])], winding: [0; 2], edges: 0 });
    }
    Ok(origin)
}

/// A place to cut where, if possible, a loop has a joint and no hole lies.
fn cut_position(chains: &[Chain], rounds: &[usize], axis: usize, period: f64) -> f64 {
    let holes: Vec<[f64; 2]> = chains
        .iter()
        .enumerate()
        .filter(|(i, _)| !rounds.contains(i))
        .map(|(_, chain)| extent(&chain.segments).map(|p| p[axis]))
        .collect();
    let free = |x: f64| {
        holes.iter().all(|[low, high]| {
            let above = x + ((low - x) / period).ceil() * period;
            above <= *low || above >= *high
        })
    };
    let joints = || rounds.iter().flat_map(|&i| chains[i].segments.iter().map(|s| start(s)[axis]));
    let first = joints().next().unwrap_or(0.0);
    let hole_ends = holes.iter().map(|hole| hole[1]);
    // Looking at some joints is enough: the cut is right anywhere.
    joints().take(64).chain(hole_ends.take(64)).find(|&x| free(x)).unwrap_or(first)
}

fn mean(chain: &Chain, axis: usize) -> f64 {
    let (sum, count) = chain
        .segments
        .iter()
        .flat_map(samples)
        .fold((0.0, 0.0), |(sum, count), p| (sum + p[axis], count + 1.0));
    sum / count
}

/// Where a band with one loop ends on the other side.
fn closing_value(
    target: &Target,
    across: usize,
    level: f64,
    up: bool,
    report: &mut Report,
) -> Result<f64, TrimError> {
    let on_side = |up: bool| {
        let edge = if up { target.domain.max[across] } else { target.domain.min[across] };
        let is_beyond = if up { edge > level } else { edge < level };
        pole_beyond(target, across, level, up)
            .or_else(|| (target.periods[across].is_none() && edge.is_finite() && is_beyond).then_some(edge))
    };
    if let Some(value) = on_side(up) {
        return Ok(value);
    }
    let value = on_side(!up).ok_or_else(|| {
        TrimError::Unbounded(format!("one loop around a {} bounds nothing", target.surface.kind()))
    })?;
    report.repairs.push("the loop runs the wrong way round".into());
    Ok(value)
}

/// The window and the final form.
fn finished(curves: Vec<Segment>, report: Report) -> Result<FaceTrim, TrimError> {
    let [min, max] = extent(&curves);
    if curves.is_empty() || !(min.cmplt(max).all()) {
        return Err(TrimError::Empty);
    }
    let window = ParameterBox { min, max };
    let on_border = |s: &Segment| {
        (0..2).any(|axis| is_constant(s, axis) && [min[axis], max[axis]].contains(&start(s)[axis]))
    };
    let curves = if curves.iter().all(on_border) { Vec::new() } else { curves };
    if !curves.is_empty() && spread(&curves, window) < 1e-12 {
        return Err(TrimError::Empty);
    }
    let edges = report.edge_deviations();
    let Report { size, repairs, losses, .. } = report;
    Ok(FaceTrim { window, curves, edges, size, repairs, losses })
}

/// How far the curves leave the window's diagonal or any other line: 0 for a region without area. Measured as the
/// greatest absolute sum of cross products along the curves, in units of the window's area.
fn spread(curves: &[Segment], window: ParameterBox) -> f64 {
    let size = window.max - window.min;
    let points: Vec<DVec2> = curves
        .iter()
        .flat_map(|s| [0.0, 0.3, 0.7, 1.0].map(|t| (point_at(s, t) - window.min) / size))
        .collect();
    let Some(far) = points
        .iter()
        .copied()
        .max_by(|a, b| (*a - points[0]).length_squared().total_cmp(&(*b - points[0]).length_squared()))
    else {
        return 0.0;
    };
    points.iter().map(|p| (*p - points[0]).perp_dot(far - points[0]).abs()).fold(0.0, f64::max)
}
