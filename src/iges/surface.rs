//! Surface entities in millimetres: 108, 114, 118, 120, 122, 128, 140, 190, 192, 194, 196, 198.

use super::curve::{cubic, ordered};
use super::directory::{Directory, Mapped, Parameters};
use super::offset;
use super::placement::{self, is_similarity};
use super::reader::Form;
use super::spans::Span;
use super::swept;
use crate::geometry::{
    BsplineSurface, Frame, Homogeneous, Homogeneous3, RECOGNITION_TOLERANCE, Surface, recognise,
};
use glam::{DAffine3, DVec2, DVec3};
use std::f64::consts::FRAC_PI_2;

/// The entity types that bound a face without any trim, by their own parameter ranges.
pub const BOUNDED_KINDS: [u32; 8] = [114, 118, 120, 122, 128, 140, 196, 198];

/// Offsets of offsets may not be deeper than this; deeper ones are cyclic or hostile.
const MAX_DEPTH: usize = 16;

/// A surface, and how the file's parameters run on it.
#[derive(Debug, Clone)]
pub struct Sheet {
    /// The surface; its normal is that of the file's surface unless `flipped`.
    pub surface: Surface,
    /// Whether the normal is opposite to that of the file's surface.
    pub flipped: bool,
    /// From the file's parameters to the surface's.
    pub parameters: ParameterMap,
    /// How far the surface may be from the true one, millimetres; 0 where it is exact or as good as that.
    pub deviation: f64,
}

/// From the file's surface parameters to ours.
#[derive(Debug, Clone)]
pub struct ParameterMap {
    /// Units: degrees to radians, the file's lengths to millimetres; 1 where parameters are plain numbers.
    pub scale: DVec2,
    /// Arcs along u and v on which the file counts angles and a rational B-spline does not.
    pub arcs: [Vec<Arc>; 2],
}

/// An arc of a rational quadratic: the angle runs over `range`, and so does the spline's own parameter.
#[derive(Debug, Clone, Copy)]
pub struct Arc {
    /// First and last parameter.
    pub range: [f64; 2],
    /// Half the angle.
    pub half_angle: f64,
}

impl ParameterMap {
    /// Where the parameters are the same.
    pub fn same() -> Self {
        Self { scale: DVec2::ONE, arcs: [Vec::new(), Vec::new()] }
    }

    /// Whether nothing changes.
    pub fn is_same(&self) -> bool {
        self.scale == DVec2::ONE && self.arcs.iter().all(Vec::is_empty)
    }

    /// The surface's parameters for those of the file.
    pub fn apply(&self, uv: DVec2) -> DVec2 {
        let along = |axis: usize| {
            let value = uv[axis] * self.scale[axis];
            let inside = |arc: &&Arc| arc.range[0] <= value && value <= arc.range[1];
            self.arcs[axis].iter().find(inside).map_or(value, |arc| arc.own_parameter(value))
        };
        DVec2::new(along(0), along(1))
    }
}

impl Arc {
    /// The arcs among `spans`.
    pub fn of(spans: &[Span]) -> Vec<Self> {
        spans
            .iter()
            .filter_map(|s| s.half_angle.map(|half_angle| Self { range: s.range, half_angle }))
            .collect()
    }

    /// The parameter of the quadratic with weights (1, cos h, 1) at an angle ψ from the middle of its arc, on [0, 1]:
    /// (1 + tan(ψ/2) / tan(h/2)) / 2, as its weight function is proportional to 1 + tan²(h/2) (2t − 1)².
    fn own_parameter(&self, value: f64) -> f64 {
        let [first, last] = self.range;
        let share = (value - first) / (last - first);
        let angle = (2.0 * share - 1.0) * self.half_angle;
        first + (last - first) * 0.5 * (1.0 + (0.5 * angle).tan() / (0.5 * self.half_angle).tan())
    }
}

/// Surface `entity`, placed in `outer`.
pub fn sheet(file: &Directory, entity: u32, outer: &DAffine3, form: Form) -> Mapped<Sheet> {
    sheet_at(file, entity, outer, form, 0)
}

fn sheet_at(file: &Directory, entity: u32, outer: &DAffine3, form: Form, depth: usize) -> Mapped<Sheet> {
    if file.kind(entity) == 140 {
        let parameters = file.parameters(entity)?;
        if depth > MAX_DEPTH {
            return Err(parameters.problem("offsets refer to each other in a circle"));
        }
        let place = placement::of(file, entity, outer)?;
        let basis = sheet_at(file, parameters.reference(5)?, &place, form, depth + 1)?;
        let given = match form {
            Form::Recognised => {
                sheet_at(file, parameters.reference(5)?, &place, Form::Bounded, depth + 1).ok()
            }
            Form::Bounded => None,
        };
        return offset::sheet(&parameters, basis, given.as_ref(), &place);
    }
    let sheet = given(file, entity, outer)?;
    if let (Surface::Bspline(spline), Form::Recognised) = (&sheet.surface, form)
        && let Some((surface, flipped)) = recognise(spline, RECOGNITION_TOLERANCE * spline.size())
    {
        return Ok(Sheet { surface, flipped, parameters: ParameterMap::same(), deviation: 0.0 });
    }
    Ok(sheet)
}

/// The surface in the form in which the file gives it.
fn given(file: &Directory, entity: u32, outer: &DAffine3) -> Mapped<Sheet> {
    let entry = *file.entry(entity)?;
    let parameters = file.parameters(entity)?;
    let place = placement::of(file, entity, outer)?;
    match entry.kind {
        108 => plane(&parameters).and_then(|surface| placed(&parameters, surface, &place, DVec2::ONE)),
        114 => parametric(&parameters).and_then(|surface| placed(&parameters, surface, &place, DVec2::ONE)),
        118 => swept::ruled(file, &parameters, &place),
        120 => swept::revolved(file, &parameters, &place),
        122 => swept::tabulated(file, &parameters, &place),
        128 => bspline(&parameters).and_then(|surface| placed(&parameters, surface, &place, DVec2::ONE)),
        190 | 192 | 194 | 196 | 198 => {
            let (surface, scale) = elementary(file, &parameters, entry.form == 1, &place)?;
            placed(&parameters, surface, &place, scale)
        }
        _ => Err(parameters.problem("this is no surface that can be read")),
    }
}

fn placed(parameters: &Parameters, surface: Surface, place: &DAffine3, scale: DVec2) -> Mapped<Sheet> {
    if !matches!(surface, Surface::Bspline(_) | Surface::Plane { .. }) && !is_similarity(place) {
        return Err(parameters.problem("the matrix of an elementary surface skews it"));
    }
    if let (Surface::Plane { frame }, false) = (&surface, is_similarity(place)) {
        let [x, y] = [frame.x, frame.y].map(|v| place.transform_vector3(v));
        let frame = Frame::from_axes(place.transform_point3(frame.origin), Some(x.cross(y)), Some(x));
        let parameters = ParameterMap { scale, arcs: [Vec::new(), Vec::new()] };
        return Ok(Sheet { surface: Surface::Plane { frame }, flipped: false, parameters, deviation: 0.0 });
    }
    let (surface, flipped) = surface.transformed(place);
    // The parametric normal of the file's surface: a B-spline keeps its parameters under a mirror, and so does the file.
    let mirrors = place.matrix3.determinant() < 0.0;
    let flipped = if matches!(surface, Surface::Bspline(_)) { false } else { flipped ^ mirrors };
    let parameters = ParameterMap { scale, arcs: [Vec::new(), Vec::new()] };
    Ok(Sheet { surface, flipped, parameters, deviation: 0.0 })
}

/// Entity 108: `A x + B y + C z = D`.
fn plane(parameters: &Parameters) -> Mapped<Surface> {
    let (normal, distance) = (parameters.point(1)?, parameters.real(4)?);
    let length = normal.length();
    if !(length > 0.0 && length.is_finite()) {
        return Err(parameters.problem("the plane has no normal"));
    }
    let origin = normal / length * (distance / length);
    Ok(Surface::Plane { frame: Frame::from_axes(origin, Some(normal), None) })
}

/// Entity 114: patches of bicubics in powers, u running fastest within a patch, v fastest between patches. After the
/// patches of each strip stands one that means nothing, and so does a whole strip at the end.
fn parametric(parameters: &Parameters) -> Mapped<Surface> {
    let (m, n) = (parameters.count(3, 48)?, parameters.count(4, 48)?);
    let fail = |reason: &str| parameters.problem(reason);
    if m == 0 || n == 0 || m.saturating_mul(n) > parameters.values.len() / 48 {
        return Err(fail("the patches are fewer than promised"));
    }
    let breaks = |first: usize, count: usize| -> Mapped<Vec<f64>> {
        (0..=count).map(|i| parameters.given(first + i)).collect()
    };
    let (u, v) = (breaks(5, m)?, breaks(6 + m, n)?);
    let first = 7 + m + n;
    let (u_count, v_count) = (3 * m + 1, 3 * n + 1);
    let mut points = vec![Homogeneous3::ZERO; u_count * v_count];
    for i in 0..m {
        for j in 0..n {
            let at = first + 48 * (i * (n + 1) + j);
            let coefficient = |k: usize, l: usize| -> Mapped<DVec3> {
                let index = at + 4 * l + k;
                Ok(DVec3::new(
                    parameters.within(index)?,
                    parameters.within(index + 16)?,
                    parameters.within(index + 32)?,
                ))
            };
            let mut rows = [[DVec3::ZERO; 4]; 4];
            for (l, row) in rows.iter_mut().enumerate() {
                let powers = [coefficient(0, l)?, coefficient(1, l)?, coefficient(2, l)?, coefficient(3, l)?];
                *row = cubic(powers, u[i + 1] - u[i]);
            }
            for k in 0..4 {
                let column = cubic([rows[0][k], rows[1][k], rows[2][k], rows[3][k]], v[j + 1] - v[j]);
                for (l, point) in column.into_iter().enumerate() {
                    points[(3 * i + k) * v_count + 3 * j + l] =
                        <Homogeneous3 as Homogeneous>::new(point, 1.0);
                }
            }
        }
    }
    let knots = |breaks: &[f64]| -> Vec<f64> {
        let ends = [breaks[0], breaks[breaks.len() - 1]];
        let inner = breaks.iter().flat_map(|t| [*t; 3]);
        [ends[0]].into_iter().chain(inner).chain([ends[1]]).collect()
    };
    let surface = BsplineSurface::new([3, 3], [knots(&u), knots(&v)], points);
    surface.map(Surface::Bspline).map_err(|error| fail(&error.to_string()))
}

/// Entity 128: K1, K2, M1, M2, five properties, both knot vectors, weights, points (u fastest), the parameter ranges.
fn bspline(parameters: &Parameters) -> Mapped<Surface> {
    let last = [parameters.count(1, 4)?, parameters.count(2, 4)?];
    let degrees = [parameters.count(3, 1)?, parameters.count(4, 1)?];
    let counts = last.map(|k| k + 1);
    let total = counts[0] * counts[1];
    if total > parameters.values.len() / 4 {
        return Err(parameters.problem("the control points are fewer than promised"));
    }
    let knot_counts = [0, 1].map(|axis| counts[axis] + degrees[axis] + 1);
    let numbers = |first: usize, count: usize| -> Mapped<Vec<f64>> {
        (first..first + count).map(|i| parameters.given(i)).collect()
    };
    let u_knots = numbers(10, knot_counts[0])?;
    let v_knots = numbers(10 + knot_counts[0], knot_counts[1])?;
    let first_weight = 10 + knot_counts[0] + knot_counts[1];
    let weights = numbers(first_weight, total)?;
    let first = first_weight + total;
    let even = weights.iter().all(|w| *w == weights[0]) && weights[0] > 0.0;
    let mut points = Vec::with_capacity(total);
    for i in 0..counts[0] {
        for j in 0..counts[1] {
            let index = i + counts[0] * j;
            let weight = if even { 1.0 } else { weights[index] };
            points.push(<Homogeneous3 as Homogeneous>::new(
                parameters.point_within(first + 3 * index)?,
                weight,
            ));
        }
    }
    let fail = |error: crate::geometry::KnotError| parameters.problem(error.to_string());
    let knots = [ordered(u_knots), ordered(v_knots)];
    let mut surface = BsplineSurface::new(degrees, knots, points).map_err(fail)?;
    let after = first + 3 * total;
    let domain = surface.domain();
    let wanted = |axis: usize| -> Mapped<[f64; 2]> {
        let (low, high) = (domain.min[axis], domain.max[axis]);
        let range = [parameters.real(after + 2 * axis)?, parameters.real(after + 2 * axis + 1)?];
        let near = 1e-9 * (high - low);
        let inner = range[0] < range[1] && range[1] > low + near && range[0] < high - near;
        // A whole turn of a closed surface, begun elsewhere than at its seam, is all of it.
        let beyond = range[0] < low - near || range[1] > high + near;
        if surface.closed[axis] && beyond && range[1] - range[0] >= (high - low) * (1.0 - 1e-6) {
            return Ok([low, high]);
        }
        // No sliver of a span is left beside a knot.
        let knots = [&surface.u_knots, &surface.v_knots][axis].as_slice();
        let snapped = |t: f64| knots.iter().copied().find(|knot| (knot - t).abs() <= near).unwrap_or(t);
        Ok(if inner { range.map(snapped) } else { [low, high] })
    };
    let (u, v) = (wanted(0)?, wanted(1)?);
    if (u, v) != ([domain.min.x, domain.max.x], [domain.min.y, domain.max.y])
        && let Some(piece) = surface.piece(u, v)
    {
        surface = piece;
    }
    Ok(Surface::Bspline(surface))
}

/// Entities 190 to 198, and the units of their parameters.
fn elementary(
    file: &Directory,
    parameters: &Parameters,
    has_reference: bool,
    place: &DAffine3,
) -> Mapped<(Surface, DVec2)> {
    let millimetres = place.matrix3.determinant().abs().cbrt();
    let degrees = 1.0_f64.to_radians();
    let origin = location(file, parameters.reference(1)?)?;
    let direction = |at: usize| -> Mapped<Option<DVec3>> {
        match parameters.pointer(at)? {
            0 => Ok(None),
            entity => direction(file, entity).map(Some),
        }
    };
    let reference = |at: usize| if has_reference { direction(at) } else { Ok(None) };
    let positive = |at: usize| -> Mapped<f64> {
        let value = parameters.real(at)?;
        if value > 0.0 { Ok(value) } else { Err(parameters.problem("a radius is not positive")) }
    };
    Ok(match parameters.kind {
        190 => {
            let frame = Frame::from_axes(origin, direction(2)?, reference(3)?);
            (Surface::Plane { frame }, DVec2::splat(millimetres))
        }
        192 => {
            let frame = Frame::from_axes(origin, direction(2)?, reference(4)?);
            (Surface::Cylinder { frame, radius: positive(3)? }, DVec2::new(degrees, millimetres))
        }
        194 => {
            let (radius, half_angle) = (parameters.real(3)?, parameters.real(4)?.to_radians());
            if !(radius >= 0.0 && half_angle.abs() > 1e-9 && half_angle.abs() < FRAC_PI_2 - 1e-9) {
                return Err(parameters.problem("the cone has no possible radius or angle"));
            }
            let frame = Frame::from_axes(origin, direction(2)?, reference(5)?);
            (Surface::Cone { frame, radius, half_angle }, DVec2::new(degrees, millimetres))
        }
        196 => {
            let (axis, reference) = if has_reference { (direction(3)?, direction(4)?) } else { (None, None) };
            let frame = Frame::from_axes(origin, axis, reference);
            (Surface::Sphere { frame, radius: positive(2)? }, DVec2::splat(degrees))
        }
        _ => {
            let frame = Frame::from_axes(origin, direction(2)?, reference(5)?);
            (Surface::Torus { frame, major: positive(3)?, minor: positive(4)? }, DVec2::splat(degrees))
        }
    })
}

/// A point (entity 116), in the units of the file.
pub fn location(file: &Directory, entity: u32) -> Mapped<DVec3> {
    let parameters = file.parameters(entity)?;
    if parameters.kind != 116 {
        return Err(parameters.problem("this is no point"));
    }
    Ok(placement::of(file, entity, &DAffine3::IDENTITY)?.transform_point3(parameters.point(1)?))
}

/// A direction (entity 123).
fn direction(file: &Directory, entity: u32) -> Mapped<DVec3> {
    let parameters = file.parameters(entity)?;
    if parameters.kind != 123 {
        return Err(parameters.problem("this is no direction"));
    }
    Ok(placement::of(file, entity, &DAffine3::IDENTITY)?.transform_vector3(parameters.point(1)?))
}
