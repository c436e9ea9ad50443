//! Points, directions, placements and transformations (ISO 10303-42, clauses 4.3 and 4.4).

use super::reader::{Mapped, Reader, problem, real, reference};
use super::value::{Entity, Record, Value};
use crate::geometry::Frame;
use glam::{DAffine3, DMat3, DVec3};

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
            "AXIS2_PLACEMENT_3D" | "FEA_AXIS2_PLACEMENT_3D" => {
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
