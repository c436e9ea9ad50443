//! B-spline curves and surfaces in all forms (ISO 10303-42: b_spline_curve, b_spline_surface and their subtypes).
//!
//! A form is a simple instance, with the inherited attributes first, or a complex one, in which each partial record has its
//! own attributes only. Bézier, uniform and quasi-uniform forms have no knots in the file; theirs are the standard's.

use super::reader::{Mapped, Reader, problem};
use super::value::{Entity, Record, Value};
use crate::geometry::{BsplineCurve, BsplineSurface, Homogeneous, Homogeneous2, Homogeneous3, KnotVector};
use glam::DVec2;

/// How the knots are given.
#[derive(Clone, Copy)]
enum Spacing {
    Bezier,
    Uniform,
    QuasiUniform,
}

/// Whether an entity is a B-spline curve.
pub fn is_curve(entity: &Entity) -> bool {
    entity.records.iter().any(|r| {
        matches!(
            &*r.keyword,
            "B_SPLINE_CURVE"
                | "B_SPLINE_CURVE_WITH_KNOTS"
                | "RATIONAL_B_SPLINE_CURVE"
                | "BEZIER_CURVE"
                | "UNIFORM_CURVE"
                | "PIECEWISE_BEZIER_CURVE"
                | "QUASI_UNIFORM_CURVE"
        )
    })
}

/// Whether an entity is a B-spline surface.
pub fn is_surface(entity: &Entity) -> bool {
    entity.records.iter().any(|r| {
        matches!(
            &*r.keyword,
            "B_SPLINE_SURFACE"
                | "B_SPLINE_SURFACE_WITH_KNOTS"
                | "RATIONAL_B_SPLINE_SURFACE"
                | "BEZIER_SURFACE"
                | "UNIFORM_SURFACE"
                | "PIECEWISE_BEZIER_SURFACE"
                | "QUASI_UNIFORM_SURFACE"
        )
    })
}

/// A curve in space, millimetres; and what had to be mended.
pub fn curve(reader: &Reader, entity: &Entity) -> Mapped<(BsplineCurve<Homogeneous3>, Option<String>)> {
    let CurveParts { degree, ids, knots, weights, repair } = curve_parts(entity)?;
    reader.charge(entity, ids.len())?;
    let mut points = Vec::with_capacity(ids.len());
    for (id, weight) in ids.iter().zip(weights) {
        points.push(Homogeneous::new(reader.point(*id)?, weight));
    }
    let curve = BsplineCurve::new(degree, knots, points);
    curve.map(|curve| (curve, repair)).map_err(|error| problem(entity, error.to_string()))
}

/// A curve in a parameter plane: coordinates times `scale`.
pub fn curve2(reader: &Reader, entity: &Entity, scale: DVec2) -> Mapped<BsplineCurve<Homogeneous2>> {
    let CurveParts { degree, ids, knots, weights, .. } = curve_parts(entity)?;
    reader.charge(entity, ids.len())?;
    let mut points = Vec::with_capacity(ids.len());
    for (id, weight) in ids.iter().zip(weights) {
        let point = reader.point(*id)? / reader.units.millimetres;
        points.push(Homogeneous::new(point.truncate() * scale, weight));
    }
    BsplineCurve::new(degree, knots, points).map_err(|error| problem(entity, error.to_string()))
}

struct CurveParts {
    degree: usize,
    ids: Vec<u64>,
    knots: Vec<f64>,
    weights: Vec<f64>,
    repair: Option<String>,
}

fn curve_parts(entity: &Entity) -> Mapped<CurveParts> {
    let (base, at) = base_record(entity, "B_SPLINE_CURVE");
    let degree = degree(entity, base, at)?;
    let ids = base.references(at + 1);
    if ids.len() != base.list(at + 1).len() {
        return Err(problem(entity, "a control point is no reference"));
    }
    let mut repairs = Vec::new();
    let knots = match own_record(entity, "B_SPLINE_CURVE_WITH_KNOTS", 6) {
        Some((record, at)) => {
            let lists = [record.list(at), record.list(at + 1)];
            expanded_knots(entity, lists, degree, ids.len(), &mut repairs)?
        }
        None => implied_knots(spacing(entity, "CURVE"), degree, ids.len()),
    };
    let mut weights = match own_record(entity, "RATIONAL_B_SPLINE_CURVE", 6) {
        Some((record, at)) => numbers(entity, record.list(at))?,
        None => vec![1.0; ids.len()],
    };
    if weights.len() != ids.len() {
        return Err(problem(entity, "there are not as many weights as control points"));
    }
    turn_positive(&mut weights, &mut repairs);
    Ok(CurveParts { degree, ids, knots, weights, repair: joined(repairs) })
}

/// A surface, millimetres; and what had to be mended.
pub fn surface(reader: &Reader, entity: &Entity) -> Mapped<(BsplineSurface, Option<String>)> {
    let (base, at) = base_record(entity, "B_SPLINE_SURFACE");
    let degrees = [degree(entity, base, at)?, degree(entity, base, at + 1)?];
    let rows = base.list(at + 2);
    let count_v = rows.first().and_then(Value::list).map_or(0, <[Value]>::len);
    let weights = own_record(entity, "RATIONAL_B_SPLINE_SURFACE", 8).map(|(record, at)| record.list(at));
    let (mut controls, mut all_weights) = (Vec::new(), Vec::new());
    let mut repairs = Vec::new();
    for (i, row) in rows.iter().enumerate() {
        let row = row.list().unwrap_or_default();
        if row.len() != count_v {
            return Err(problem(entity, "the control points form no grid"));
        }
        reader.charge(entity, count_v)?;
        let row_weights = match weights {
            Some(weights) => numbers(entity, weights.get(i).and_then(Value::list).unwrap_or_default())?,
            None => vec![1.0; count_v],
        };
        if row_weights.len() != count_v {
            return Err(problem(entity, "there are not as many weights as control points"));
        }
        for value in row {
            let id = value.reference().ok_or_else(|| problem(entity, "a control point is no reference"))?;
            controls.push(reader.point(id)?);
        }
        all_weights.extend(row_weights);
    }
    turn_positive(&mut all_weights, &mut repairs);
    let points = controls.iter().zip(all_weights).map(|(point, weight)| Homogeneous::new(*point, weight));
    let points = points.collect();
    let counts = [rows.len(), count_v];
    let knots = match own_record(entity, "B_SPLINE_SURFACE_WITH_KNOTS", 8) {
        Some((record, at)) => {
            let mut along = |i: usize| {
                let lists = [record.list(at + i), record.list(at + 2 + i)];
                expanded_knots(entity, lists, degrees[i], counts[i], &mut repairs)
            };
            [along(0)?, along(1)?]
        }
        None => {
            let along = |i: usize| implied_knots(spacing(entity, "SURFACE"), degrees[i], counts[i]);
            [along(0), along(1)]
        }
    };
    let surface = BsplineSurface::new(degrees, knots, points);
    surface.map(|surface| (surface, joined(repairs))).map_err(|error| problem(entity, error.to_string()))
}

/// The record with the common attributes, and where they begin: after the name in a simple instance.
fn base_record<'e, 'a>(entity: &'e Entity<'a>, keyword: &str) -> (&'e Record<'a>, usize) {
    match entity.record(keyword) {
        Some(record) if entity.records.len() > 1 => (record, 0),
        _ => (entity.first(), 1),
    }
}

/// The record `keyword` and where its own attributes begin: after `inherited` others in a simple instance (a curve has name,
/// degree, points, form and two flags; a surface a degree and a flag more).
fn own_record<'e, 'a>(
    entity: &'e Entity<'a>,
    keyword: &str,
    inherited: usize,
) -> Option<(&'e Record<'a>, usize)> {
    let at = if entity.records.len() > 1 { 0 } else { inherited };
    entity.record(keyword).map(|record| (record, at))
}

fn degree(entity: &Entity, record: &Record, at: usize) -> Mapped<usize> {
    let degree = record.get(at).integer().and_then(|d| usize::try_from(d).ok());
    degree
        .filter(|d| (1..=KnotVector::MAX_DEGREE).contains(d))
        .ok_or_else(|| problem(entity, format!("the degree is not between 1 and {}", KnotVector::MAX_DEGREE)))
}

fn numbers(entity: &Entity, values: &[Value]) -> Mapped<Vec<f64>> {
    values.iter().map(|v| v.real().ok_or_else(|| problem(entity, "expected a list of numbers"))).collect()
}

/// Knots repeated by their multiplicities. Mended are knots out of order by rounding, multiplicities of the two ends that do
/// not give the number of knots which `count` control points ask for, and a single piece whose knots span no interval.
fn expanded_knots(
    entity: &Entity,
    [counts, knots]: [&[Value]; 2],
    degree: usize,
    count: usize,
    repairs: &mut Vec<&'static str>,
) -> Mapped<Vec<f64>> {
    if counts.len() != knots.len() {
        return Err(problem(entity, "there are not as many multiplicities as knots"));
    }
    let mut knots = numbers(entity, knots)?;
    let length = knots.last().zip(knots.first()).map_or(0.0, |(last, first)| last - first);
    for i in 1..knots.len() {
        let drop = knots[i - 1] - knots[i];
        if drop > 0.0 && drop <= ROUNDING * length {
            knots[i] = knots[i - 1];
            repairs.push("knots brought into order");
        }
    }
    // What bounds the memory is the number that degree and control points ask for.
    let expected = count + degree + 1;
    let multiplicity =
        |v: &Value| v.integer().and_then(|c| usize::try_from(c).ok()).filter(|c| *c <= expected);
    let mut counts: Vec<Option<usize>> = counts.iter().map(multiplicity).collect();
    let sum = |counts: &[Option<usize>]| counts.iter().copied().sum::<Option<usize>>();
    if sum(&counts) != Some(expected) {
        if let [first, .., last] = counts.as_mut_slice() {
            (*first, *last) = (Some(degree + 1), Some(degree + 1));
        }
        if sum(&counts) != Some(expected) {
            let reason =
                "the multiplicities of the knots do not fit the degree and the number of control points";
            return Err(problem(entity, reason));
        }
        repairs.push("multiplicities of the end knots corrected");
    }
    let repeated =
        knots.iter().zip(counts).flat_map(|(knot, count)| std::iter::repeat_n(*knot, count.unwrap_or(0)));
    let expanded: Vec<f64> = repeated.collect();
    if count == degree + 1 && expanded[degree] == expanded[count] {
        repairs.push("knots without an interval replaced");
        return Ok(implied_knots(Spacing::Bezier, degree, count));
    }
    Ok(expanded)
}

/// Knots that are below their predecessor by less than this share of their range are there by rounding.
const ROUNDING: f64 = 1e-9;

/// Weights count relative to each other: where all are negative, so is only their common factor.
fn turn_positive(weights: &mut [f64], repairs: &mut Vec<&'static str>) {
    if !weights.is_empty() && weights.iter().all(|weight| *weight < 0.0) {
        weights.iter_mut().for_each(|weight| *weight = -*weight);
        repairs.push("negative weights turned positive");
    }
}

fn joined(mut repairs: Vec<&'static str>) -> Option<String> {
    repairs.dedup();
    (!repairs.is_empty()).then(|| repairs.join("; "))
}

fn spacing(entity: &Entity, kind: &str) -> Spacing {
    let is = |form: &str| entity.is(&format!("{form}_{kind}"));
    if is("BEZIER") || is("PIECEWISE_BEZIER") {
        Spacing::Bezier
    } else if is("UNIFORM") {
        Spacing::Uniform
    } else {
        Spacing::QuasiUniform
    }
}

/// ISO 10303-42, function default_b_spline_knots: unit steps; a Bézier form has inner knots of full multiplicity.
fn implied_knots(spacing: Spacing, degree: usize, count: usize) -> Vec<f64> {
    let total = count + degree + 1;
    let segments = count.saturating_sub(degree).max(1);
    (0..total)
        .map(|i| match spacing {
            Spacing::Uniform => i as f64 - degree as f64,
            Spacing::QuasiUniform => i.saturating_sub(degree).min(segments) as f64,
            Spacing::Bezier => {
                let pieces = (count.saturating_sub(1) / degree).max(1);
                (i.saturating_sub(1) / degree).min(pieces) as f64
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn implied_knots_of_each_form() {
        assert_eq!(implied_knots(Spacing::Bezier, 2, 5), [0., 0., 0., 1., 1., 2., 2., 2.]);
        assert_eq!(implied_knots(Spacing::Bezier, 3, 4), [0., 0., 0., 0., 1., 1., 1., 1.]);
        assert_eq!(implied_knots(Spacing::Uniform, 2, 4), [-2., -1., 0., 1., 2., 3., 4.]);
        assert_eq!(implied_knots(Spacing::QuasiUniform, 2, 4), [0., 0., 0., 1., 2., 2., 2.]);
    }
}
