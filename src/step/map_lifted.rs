//! Curves that follow from something else: those that a file gives in the parameter plane of a surface alone (ISO 10303-42:
//! pcurve), and those at a distance from others (offset_curve_3d).
//!
//! On planes, along lines of constant parameter, and at a distance from lines and circles they are exact; others are fitted.

use super::map_curve::MappedCurve;
use super::reader::{MAX_CHAIN, Mapped, Reader, problem, real, reference};
use super::value::Entity;
use crate::geometry::{Curve, Frame, Surface, fit_curve, invert_surface, iso_curve};
use glam::{DAffine3, DVec2, DVec3};

/// Fits are brought this close, as a share of the curve's size.
const TOLERANCE: f64 = 1e-9;

/// A fit that is farther off than this share of its size is not used.
const LIMIT: f64 = 1e-5;

/// A line in the parameter plane along which a parameter changes less than this share of the other one's change runs along it.
const ALONG: f64 = 1e-9;

/// What an attempt at a curve counts in list elements: about as long as it takes to read that many.
const LIFT_COST: usize = 64;

/// A surface as a function of the file's own parameters.
pub enum ParameterForm {
    /// A surface that keeps the parameters, up to these factors.
    Kept(Surface, DVec2),
    /// `C(u · factor) + v · along`.
    Extruded { profile: Curve, along: DVec3, factor: f64 },
    /// `C(v · factors.y)` turned by `u · factors.x` about z.
    Revolved { profile: Curve, axis: Frame, factors: DVec2 },
    /// Another one, moved.
    Moved(Box<ParameterForm>, DAffine3),
}

impl ParameterForm {
    /// The point at the file's parameters `uv`.
    pub fn point(&self, uv: DVec2) -> DVec3 {
        match self {
            Self::Kept(surface, factors) => surface.point(uv * *factors),
            Self::Extruded { profile, along, factor } => profile.point(uv.x * factor) + *along * uv.y,
            Self::Revolved { profile, axis, factors } => {
                let local = axis.local_point(profile.point(uv.y * factors.y));
                let turned = DVec2::from_angle(uv.x * factors.x).rotate(local.truncate());
                axis.point(turned.extend(local.z))
            }
            Self::Moved(basis, transform) => transform.transform_point3(basis.point(uv)),
        }
    }
}

impl Reader<'_> {
    /// Surface `id` by its parameters.
    pub fn parameter_form(&self, id: u64, depth: usize) -> Mapped<ParameterForm> {
        let entity = self.entity(id)?;
        if depth > MAX_CHAIN {
            return Err(problem(&entity, "surfaces refer to each other in a circle"));
        }
        let record = entity.first();
        let basis = || reference(id, record, 1);
        match &*record.keyword {
            "SURFACE_OF_LINEAR_EXTRUSION" => {
                let profile = self.curve_in_chain(basis()?, depth + 1)?.curve;
                let (along, factor) = (self.vector(reference(id, record, 2)?)?, self.curve_scale(&profile));
                Ok(ParameterForm::Extruded { profile, along, factor })
            }
            "SURFACE_OF_REVOLUTION" => {
                let profile = self.curve_in_chain(basis()?, depth + 1)?.curve;
                let axis = self.placement(reference(id, record, 2)?)?;
                let factors = DVec2::new(self.units.radians, self.curve_scale(&profile));
                Ok(ParameterForm::Revolved { profile, axis, factors })
            }
            "SURFACE_REPLICA" => {
                let parent = self.parameter_form(basis()?, depth + 1)?;
                let transform = self.transform(reference(id, record, 2)?)?;
                Ok(ParameterForm::Moved(Box::new(parent), transform))
            }
            "CURVE_BOUNDED_SURFACE" => self.parameter_form(basis()?, depth + 1),
            _ => {
                let mapped = self.map_surface(id, &[], depth + 1)?;
                if !mapped.keeps_parameters {
                    return Err(problem(&entity, "the surface is read with other parameters"));
                }
                let factors = self.parameter_scale(&mapped.surface);
                Ok(ParameterForm::Kept(mapped.surface, factors))
            }
        }
    }

    /// The PCURVE `id` in space; `ends` are points that it must reach, for curves that have no end of their own.
    pub fn lifted(&self, id: u64, ends: Option<[DVec3; 2]>, depth: usize) -> Mapped<MappedCurve> {
        let entity = self.entity(id)?;
        if depth > MAX_CHAIN {
            return Err(problem(&entity, "curves refer to each other in a circle"));
        }
        let record = entity.record("PCURVE").ok_or_else(|| problem(&entity, "expected a PCURVE"))?;
        // Each may have several alternatives, and each of those again.
        self.charge(&entity, LIFT_COST)?;
        let at = if entity.records.len() > 1 { 0 } else { 1 };
        let surface = self.parameter_form(reference(id, record, at)?, depth + 1)?;
        let representation = self.referred(id, record, at + 1)?;
        let item = representation.first().references(1).first().copied();
        let item = item.ok_or_else(|| problem(&representation, "there is no item"))?;
        // Its coordinates are brought to millimetres like all others.
        let flat = self.curve_in_chain(item, depth + 1)?;
        let to_parameters = 1.0 / self.units.millimetres;
        if let ParameterForm::Kept(Surface::Plane { frame }, _) = &surface {
            let curve = flat.curve.transformed(&frame.outer_from_local());
            return Ok(MappedCurve { curve, pcurves: Vec::new(), ..flat });
        }
        let mut range = flat.range();
        if let (Curve::Line { origin, direction }, ParameterForm::Kept(carrier, factors)) =
            (&flat.curve, &surface)
        {
            let factors = *factors * to_parameters;
            let (origin, direction) = (origin.truncate() * factors, direction.truncate() * factors);
            let constant = [0, 1].into_iter().find(|&i| direction[i].abs() <= ALONG * direction[1 - i].abs());
            if let (Some(axis), false) = (constant, matches!(carrier, Surface::Bspline(_))) {
                let curve = iso_curve(carrier, axis, origin[axis]);
                let trim = flat.trim.map(|t| t.map(|t| origin[1 - axis] + t * direction[1 - axis]));
                return Ok(MappedCurve { curve, trim, pcurves: Vec::new(), ..flat });
            }
            if flat.trim.is_none()
                && let Some(ends) = ends
            {
                range = ends.map(|p| along_line(carrier, p, origin, direction));
                range.sort_by(f64::total_cmp);
            }
        }
        if !(range.iter().all(|t| t.is_finite()) && range[0] != range[1]) {
            return Err(problem(&entity, "a curve in a parameter plane has no ends"));
        }
        let point = |t: f64| surface.point(flat.curve.point(t).truncate() * to_parameters);
        self.fitted(&entity, &flat, range, |t| Some(point(t)))
    }

    /// `OFFSET_CURVE_3D(name, basis, distance, self intersect, reference direction)`: at every point along the direction
    /// times the tangent.
    pub fn offset_curve(&self, entity: &Entity, depth: usize) -> Mapped<MappedCurve> {
        let record = entity.first();
        let basis = self.curve_in_chain(reference(entity.id, record, 1)?, depth + 1)?;
        let distance = real(entity.id, record, 2)? * self.units.millimetres;
        let direction = self.direction(reference(entity.id, record, 4)?)?;
        let side = |t: f64| {
            let across = direction.cross(basis.curve.derivatives(t).first);
            Some(across).filter(|v| v.length_squared() > 0.0).map(DVec3::normalize)
        };
        let exact = match &basis.curve {
            Curve::Line { origin, direction } => {
                side(0.0).map(|side| Curve::Line { origin: *origin + side * distance, direction: *direction })
            }
            Curve::Circle { frame, radius }
                if frame.z.cross(direction.normalize_or_zero()).length() < ALONG =>
            {
                let radius = radius - distance * frame.z.dot(direction).signum();
                (radius > 0.0).then_some(Curve::Circle { frame: *frame, radius })
            }
            _ => None,
        };
        if let Some(curve) = exact {
            return Ok(MappedCurve { curve, pcurves: Vec::new(), ..basis });
        }
        let range = basis.range();
        if !range.iter().all(|t| t.is_finite()) {
            return Err(problem(entity, "the offset of a curve without ends"));
        }
        self.fitted(entity, &basis, range, |t| Some(basis.curve.point(t) + side(t)? * distance))
    }

    /// A curve that has the parameter of `basis`, fitted over `range`.
    fn fitted(
        &self,
        entity: &Entity,
        basis: &MappedCurve,
        range: [f64; 2],
        point: impl Fn(f64) -> Option<DVec3>,
    ) -> Mapped<MappedCurve> {
        let mut breaks = vec![range[0]];
        breaks.extend(basis.curve.breaks(range));
        breaks.push(range[1]);
        breaks.sort_by(f64::total_cmp);
        let start = point(range[0]);
        let size = (1..=16)
            .filter_map(|i| {
                Some(point(range[0] + (range[1] - range[0]) * f64::from(i) / 16.0)?.distance(start?))
            })
            .fold(0.0, f64::max);
        let fit = fit_curve(&breaks, point, TOLERANCE * size)
            .filter(|fit| fit.deviation <= LIMIT * size)
            .ok_or_else(|| problem(entity, "the curve cannot be fitted"))?;
        let mut repairs = basis.repairs.clone();
        if fit.deviation > TOLERANCE * size {
            repairs.push(problem(entity, format!("approximated within {:.1e} mm", fit.deviation)));
        }
        Ok(MappedCurve { trim: Some(range), repairs, ..Curve::Bspline(fit.curve).into() })
    }
}

/// The parameter of `origin + t · direction` at `point` of the surface, whichever period of it the line runs in.
fn along_line(surface: &Surface, point: DVec3, origin: DVec2, direction: DVec2) -> f64 {
    let uv = invert_surface(surface, point, None).uv;
    let turns = surface.periods().map(|period| period.unwrap_or(0.0));
    let candidates = (-2..=2).flat_map(|i| (-2..=2).map(move |j| DVec2::new(f64::from(i), f64::from(j))));
    let (_, nearest) = candidates
        .map(|turn| {
            let moved = uv + turn * DVec2::from_array(turns) - origin;
            (moved.perp_dot(direction).abs(), moved.dot(direction) / direction.length_squared())
        })
        .fold((f64::INFINITY, 0.0), |best, next| if next.0 < best.0 { next } else { best });
    nearest
}
