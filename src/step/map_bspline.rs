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
                | "QUASI_UNIFORM_SURFACE"
        )
    })
}

/// A curve in space, millimetres.
pub fn curve(reader: &Reader, entity: &Entity) -> Mapped<BsplineCurve<Homogeneous3>> {
    let (degree, ids, knots, weights) = curve_parts(entity)?;
    reader.charge(entity, ids.len())?;
    let mut points = Vec::with_capacity(ids.len());
    for (id, weight) in ids.iter().zip(weights) {
        points.push(Homogeneous::new(reader.point(*id)?, weight));
    }
    BsplineCurve::new(degree, knots, points).map_err(|error| problem(entity, error.to_string()))
}

/// A curve in a parameter plane: coordinates times `scale`.
pub fn curve2(reader: &Reader, entity: &Entity, scale: DVec2) -> Mapped<BsplineCurve<Homogeneous2>> {
    let (degree, ids, knots, weights) = curve_parts(entity)?;
    reader.charge(entity, ids.len())?;
    let mut points = Vec::with_capacity(ids.len());
    for (id, weight) in ids.iter().zip(weights) {
        let point = reader.point(*id)? / reader.units.millimetres;
        points.push(Homogeneous::new(point.truncate() * scale, weight));
    }
    BsplineCurve::new(degree, knots, points).map_err(|error| problem(entity, error.to_string()))
}

type CurveParts = (usize, Vec<u64>, Vec<f64>, Vec<f64>);

fn curve_parts(entity: &Entity) -> Mapped<CurveParts> {
    let (base, at) = base_record(entity, "B_SPLINE_CURVE");
    let degree = degree(entity, base, at)?;
    let ids = base.references(at + 1);
    if ids.len() != base.list(at + 1).len() {
        return Err(problem(entity, "a control point is no reference"));
    }
    let knots = match own_record(entity, "B_SPLINE_CURVE_WITH_KNOTS", 6) {
        Some((record, at)) => {
            expanded_knots(entity, record.list(at), record.list(at + 1), degree + ids.len() + 1)?
        }
        None => implied_knots(spacing(entity, degree, ids.len(), "CURVE"), degree, ids.len()),
    };
    let weights = match own_record(entity, "RATIONAL_B_SPLINE_CURVE", 6) {
        Some((record, at)) => numbers(entity, record.list(at))?,
        None => vec![1.0; ids.len()],
    };
    if weights.len() != ids.len() {
        return Err(problem(entity, "there are not as many weights as control points"));
    }
    Ok((degree, ids, knots, weights))
}

/// A surface, millimetres.
pub fn surface(reader: &Reader, entity: &Entity) -> Mapped<BsplineSurface> {
    let (base, at) = base_record(entity, "B_SPLINE_SURFACE");
    let degrees = [degree(entity, base, at)?, degree(entity, base, at + 1)?];
    let rows = base.list(at + 2);
    let count_v = rows.first().and_then(Value::list).map_or(0, <[Value]>::len);
    let weights = own_record(entity, "RATIONAL_B_SPLINE_SURFACE", 8).map(|(record, at)| record.list(at));
    let mut points = Vec::new();
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
        for (value, weight) in row.iter().zip(row_weights) {
            let id = value.reference().ok_or_else(|| problem(entity, "a control point is no reference"))?;
            points.push(Homogeneous::new(reader.point(id)?, weight));
        }
    }
    let counts = [rows.len(), count_v];
    let knots = match own_record(entity, "B_SPLINE_SURFACE_WITH_KNOTS", 8) {
        Some((record, at)) => {
            let along = |i: usize| {
                let expected = counts[i] + degrees[i] + 1;
                expanded_knots(entity, record.list(at + i), record.list(at + 2 + i), expected)
            };
            [along(0)?, along(1)?]
        }
        None => {
            let along = |i: usize| {
                implied_knots(spacing(entity, degrees[i], counts[i], "SURFACE"), degrees[i], counts[i])
            };
            [along(0), along(1)]
        }
    };
    BsplineSurface::new(degrees, knots, points).map_err(|error| problem(entity, error.to_string()))
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

/// Knots repeated by their multiplicities; `expected` bounds the memory.
fn expanded_knots(entity: &Entity, counts: &[Value], knots: &[Value], expected: usize) -> Mapped<Vec<f64>> {
    if counts.len() != knots.len() {
        return Err(problem(entity, "there are not as many multiplicities as knots"));
    }
    let mut expanded = Vec::with_capacity(expected);
    for (count, knot) in counts.iter().zip(numbers(entity, knots)?) {
        let count = count.integer().and_then(|c| usize::try_from(c).ok()).unwrap_or(usize::MAX);
        if count > expected - expanded.len() {
            return Err(problem(entity, "there are more knots than control points and degree ask for"));
        }
        expanded.extend(std::iter::repeat_n(knot, count));
    }
    Ok(expanded)
}

fn spacing(entity: &Entity, degree: usize, count: usize, kind: &str) -> Spacing {
    if entity.is(&format!("BEZIER_{kind}")) || count == degree + 1 {
        Spacing::Bezier
    } else if entity.is(&format!("UNIFORM_{kind}")) {
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
