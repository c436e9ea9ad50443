//! Points, placements and curves (ISO 10303-42, clause 4).

use super::map_bspline;
use super::map_composite;
use super::reader::{MAX_CHAIN, Mapped, Reader, problem, real, reference};
use super::value::{Entity, Record, Value};
use crate::geometry::{BsplineCurve, Curve, Frame, Homogeneous, Homogeneous3, invert_curve};
use glam::{DAffine3, DMat3, DVec3};

/// A curve, and what a file says around it.
#[derive(Debug, Clone)]
pub struct MappedCurve {
    /// The carrier, in millimetres; its parameter is the file's, angles in radians.
    pub curve: Curve,
    /// The range of a TRIMMED_CURVE.
    pub trim: Option<[f64; 2]>,
    /// The parameter-space curves of a SURFACE_CURVE.
    pub pcurves: Vec<u64>,
}

impl Reader<'_> {
    /// A CARTESIAN_POINT in millimetres; missing coordinates are 0.
    pub fn point(&self, id: u64) -> Mapped<DVec3> {
        if let Some(point) = self.plain_triple(id, "CARTESIAN_POINT") {
            return Ok(point * self.units.millimetres);
        }
        let entity = self.entity(id)?;
        let record =
            entity.record("CARTESIAN_POINT").ok_or_else(|| problem(&entity, "expected a CARTESIAN_POINT"))?;
        let coordinates = record.parameters.iter().find_map(Value::list);
        triple(coordinates.unwrap_or_default())
            .map(|point| point * self.units.millimetres)
            .ok_or_else(|| problem(&entity, "expected up to three coordinates"))
    }

    /// A DIRECTION, not normalised.
    pub fn direction(&self, id: u64) -> Mapped<DVec3> {
        if let Some(direction) = self.plain_triple(id, "DIRECTION") {
            return Ok(direction);
        }
        let entity = self.entity(id)?;
        let record = entity.record("DIRECTION").ok_or_else(|| problem(&entity, "expected a DIRECTION"))?;
        let ratios = record.parameters.iter().find_map(Value::list);
        triple(ratios.unwrap_or_default()).ok_or_else(|| problem(&entity, "expected up to three ratios"))
    }

    /// The direction of parameter `at`, where it is given and not zero.
    pub fn optional_direction(&self, record: &Record, at: usize) -> Option<DVec3> {
        let direction = record.reference(at).and_then(|id| self.direction(id).ok())?;
        (direction.length_squared() > 0.0).then_some(direction)
    }

    /// A VECTOR in millimetres.
    pub fn vector(&self, id: u64) -> Mapped<DVec3> {
        let entity = self.entity(id)?;
        let record = entity.first();
        if record.keyword != "VECTOR" {
            return Err(problem(&entity, "expected a VECTOR"));
        }
        let direction = self.direction(reference(id, record, 1)?)?;
        let magnitude = real(id, record, 2)?;
        let vector = direction.normalize_or_zero() * magnitude * self.units.millimetres;
        if vector.length_squared() > 0.0 && vector.is_finite() {
            Ok(vector)
        } else {
            Err(problem(&entity, "the vector has no length"))
        }
    }

    /// Any axis placement as a frame.
    pub fn placement(&self, id: u64) -> Mapped<Frame> {
        let entity = self.entity(id)?;
        let record = entity.first();
        match &*record.keyword {
            "AXIS2_PLACEMENT_3D" => {
                let origin = self.point(reference(id, record, 1)?)?;
                let (axis, reference) =
                    (self.optional_direction(record, 2), self.optional_direction(record, 3));
                Ok(Frame::from_axes(origin, axis, reference))
            }
            "AXIS1_PLACEMENT" | "AXIS2_PLACEMENT_2D" | "PLACEMENT" => {
                let origin = self.point(reference(id, record, 1)?)?;
                let direction = self.optional_direction(record, 2);
                Ok(if record.keyword == "AXIS1_PLACEMENT" {
                    Frame::from_axes(origin, direction, None)
                } else {
                    Frame::from_axes(origin, None, direction)
                })
            }
            _ => Err(problem(&entity, "expected an axis placement")),
        }
    }

    /// The matrix from an item's space to the outer one: of an axis placement or a CARTESIAN_TRANSFORMATION_OPERATOR.
    pub fn transform(&self, id: u64) -> Mapped<DAffine3> {
        let entity = self.entity(id)?;
        let Some(record) =
            entity.records.iter().find(|r| r.keyword.starts_with("CARTESIAN_TRANSFORMATION_OPERATOR"))
        else {
            return self.placement(id).map(|frame| frame.outer_from_local());
        };
        if entity.records.len() > 1 || record.keyword != "CARTESIAN_TRANSFORMATION_OPERATOR_3D" {
            return self.complex_operator(&entity);
        }
        // Editions differ in what is inherited before: the attributes of our own are the last five.
        let count = record.parameters.len();
        if count < 5 {
            return Err(problem(&entity, "expected axes, origin and scale"));
        }
        self.operator(
            &entity,
            [count - 5, count - 4, count - 1].map(|at| record.reference(at)),
            record,
            count - 3,
        )
    }

    fn complex_operator(&self, entity: &Entity) -> Mapped<DAffine3> {
        let base = entity.record("CARTESIAN_TRANSFORMATION_OPERATOR");
        let Some(base) = base.filter(|r| r.parameters.len() >= 4) else {
            return Err(problem(entity, "expected a CARTESIAN_TRANSFORMATION_OPERATOR_3D"));
        };
        let third = entity.record("CARTESIAN_TRANSFORMATION_OPERATOR_3D").and_then(|r| r.reference(0));
        let count = base.parameters.len();
        self.operator(entity, [base.reference(count - 4), base.reference(count - 3), third], base, count - 2)
    }

    /// ISO 10303-42, 4.4.22 and the function base_axis: the third axis first, then the first made orthogonal to it, then the
    /// second, which may make a mirror. `record[at]` is the origin, the scale follows.
    fn operator(
        &self,
        entity: &Entity,
        axes: [Option<u64>; 3],
        record: &Record,
        at: usize,
    ) -> Mapped<DAffine3> {
        let direction = |id: Option<u64>| id.and_then(|id| self.direction(id).ok());
        let origin = self.point(reference(entity.id, record, at)?)?;
        let scale = record.real(at + 1).unwrap_or(1.0);
        if scale == 0.0 {
            return Err(problem(entity, "the scale is 0"));
        }
        let [first, second, third] = axes.map(direction);
        let frame = Frame::from_axes(origin, third, first);
        let y = match second {
            Some(second) if second.dot(frame.y) < 0.0 => -frame.y,
            _ => frame.y,
        };
        Ok(DAffine3::from_mat3_translation(DMat3::from_cols(frame.x, y, frame.z) * scale, origin))
    }

    /// Any curve that we have a form for.
    pub fn curve(&self, id: u64) -> Mapped<MappedCurve> {
        self.curve_in_chain(id, 0)
    }

    /// Curve `id`, `depth` references down a chain of curves.
    pub fn curve_in_chain(&self, id: u64, depth: usize) -> Mapped<MappedCurve> {
        let entity = self.entity(id)?;
        if depth > MAX_CHAIN {
            return Err(problem(&entity, "curves refer to each other in a circle"));
        }
        let plain = |curve| Ok(MappedCurve { curve, trim: None, pcurves: Vec::new() });
        if let Some(surface_curve) = entity.record("SURFACE_CURVE").filter(|_| entity.records.len() > 1) {
            return self.surface_curve(&entity, surface_curve, 0, depth);
        }
        if map_bspline::is_curve(&entity) {
            return plain(Curve::Bspline(map_bspline::curve(self, &entity)?));
        }
        if map_composite::segments(&entity).is_some() {
            return plain(self.composite_curve(&entity, depth + 1)?);
        }
        let record = entity.first();
        let frame = || self.placement(reference(id, record, 1)?);
        let length = |at| positive_length(self, &entity, record, at);
        match &*record.keyword {
            "LINE" => {
                let origin = self.point(reference(id, record, 1)?)?;
                plain(Curve::Line { origin, direction: self.vector(reference(id, record, 2)?)? })
            }
            "CIRCLE" => plain(Curve::Circle { frame: frame()?, radius: length(2)? }),
            "ELLIPSE" => plain(Curve::Ellipse { frame: frame()?, radii: [length(2)?, length(3)?] }),
            "PARABOLA" => plain(Curve::Parabola { frame: frame()?, focal: length(2)? }),
            "HYPERBOLA" => plain(Curve::Hyperbola { frame: frame()?, radii: [length(2)?, length(3)?] }),
            "POLYLINE" => plain(Curve::Bspline(self.polyline(&entity)?)),
            "SURFACE_CURVE" | "SEAM_CURVE" | "INTERSECTION_CURVE" | "BOUNDED_SURFACE_CURVE" => {
                self.surface_curve(&entity, record, 1, depth)
            }
            "TRIMMED_CURVE" => {
                let basis = self.curve_in_chain(reference(id, record, 1)?, depth + 1)?;
                let trim = self.trim_range(&basis.curve, record);
                Ok(MappedCurve { trim: trim.or(basis.trim), ..basis })
            }
            "CURVE_REPLICA" => {
                let parent = self.curve_in_chain(reference(id, record, 1)?, depth + 1)?;
                let curve = parent.curve.transformed(&self.transform(reference(id, record, 2)?)?);
                Ok(MappedCurve { curve, pcurves: Vec::new(), ..parent })
            }
            _ => Err(problem(&entity, "this kind of curve is not supported")),
        }
    }

    fn surface_curve(
        &self,
        entity: &Entity,
        record: &Record,
        at: usize,
        depth: usize,
    ) -> Mapped<MappedCurve> {
        let curve = self.curve_in_chain(reference(entity.id, record, at)?, depth + 1)?;
        Ok(MappedCurve { pcurves: record.references(at + 1), ..curve })
    }

    fn polyline(&self, entity: &Entity) -> Mapped<BsplineCurve<Homogeneous3>> {
        let mut points = Vec::new();
        self.charge(entity, entity.first().list(1).len())?;
        for id in entity.first().references(1) {
            points.push(Homogeneous::new(self.point(id)?, 1.0));
        }
        let last = points.len().saturating_sub(1);
        let knots = (0..points.len() + 2).map(|i| i.saturating_sub(1).min(last) as f64).collect();
        BsplineCurve::new(1, knots, points).map_err(|error| problem(entity, error.to_string()))
    }

    /// The parameters of a TRIMMED_CURVE on its basis, in the curve's sense.
    fn trim_range(&self, basis: &Curve, record: &Record) -> Option<[f64; 2]> {
        let is_angle = matches!(basis, Curve::Circle { .. } | Curve::Ellipse { .. });
        let factor = if is_angle { self.units.radians } else { 1.0 };
        let end = |at: usize| {
            let trims = record.list(at);
            let parameter = trims.iter().find(|v| matches!(v, Value::Typed(..) | Value::Real(_)));
            parameter.and_then(Value::real).map(|t| t * factor).or_else(|| {
                let point = trims.iter().find_map(Value::reference)?;
                Some(invert_curve(basis, self.point(point).ok()?, None))
            })
        };
        let (from, to) = (end(2)?, end(3)?);
        let range = if record.logical(4) == Some(false) { [to, from] } else { [from, to] };
        match basis.period() {
            Some(period) if range[1] <= range[0] => {
                let turns = ((range[0] - range[1]) / period).floor() + 1.0;
                Some([range[0], range[1] + turns * period])
            }
            _ => Some(range).filter(|r| r[0] < r[1]),
        }
    }
}

/// Parameter `at` as a length greater than 0, in millimetres.
pub fn positive_length(reader: &Reader, entity: &Entity, record: &Record, at: usize) -> Mapped<f64> {
    let length = real(entity.id, record, at)? * reader.units.millimetres;
    if length > 0.0 && length.is_finite() {
        Ok(length)
    } else {
        Err(problem(entity, format!("parameter {} must be greater than 0", at + 1)))
    }
}

/// Up to three numbers, the missing ones 0.
fn triple(values: &[Value]) -> Option<DVec3> {
    let mut numbers = [0.0; 3];
    if values.is_empty() || values.len() > 3 {
        return None;
    }
    for (number, value) in numbers.iter_mut().zip(values) {
        *number = value.real()?;
    }
    Some(DVec3::from_array(numbers))
}
