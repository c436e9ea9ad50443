//! Curves in parameter planes (ISO 10303-42: pcurve). They are hints only, so what cannot be used is left out without a word.

use super::map_bspline;
use super::map_surface::RESHAPED;
use super::reader::{Mapped, Reader, SurfaceUse, problem, reference};
use crate::brep::Pcurve;
use crate::geometry::{BsplineCurve, Curve, Curve2, Surface};
use glam::DVec2;

impl Reader<'_> {
    /// The pcurves among `ids` whose surface is mapped and keeps its parameters, made to run with `curve`'s parameter.
    pub fn pcurves(&mut self, ids: &[u64], curve: &Curve) -> Vec<Pcurve> {
        ids.iter().filter_map(|&id| self.pcurve(id, curve).ok().flatten()).collect()
    }

    fn pcurve(&mut self, id: u64, curve: &Curve) -> Mapped<Option<Pcurve>> {
        let entity = self.entity(id)?;
        let Some(record) = entity.record("PCURVE") else { return Ok(None) };
        let at = if entity.records.len() > 1 { 0 } else { 1 };
        let basis = reference(id, record, at)?;
        // What a swept surface becomes depends on the face, and its parameters are not kept.
        if RESHAPED.contains(&&*self.keyword(basis)) {
            return Ok(None);
        }
        let SurfaceUse { id: surface, keeps_parameters, .. } = self.surface(basis, &[])?;
        if !keeps_parameters {
            return Ok(None);
        }
        let representation = self.referred(id, record, at + 1)?;
        let item = representation.first().references(1).first().copied();
        let item = item.ok_or_else(|| problem(&representation, "there is no item"))?;
        let scale = self.parameter_scale(&self.model.surfaces[surface]);
        // On circles and ellipses the file's parameter is an angle in the file's unit.
        let angle = match curve {
            Curve::Circle { .. } | Curve::Ellipse { .. } => self.units.radians,
            _ => 1.0,
        };
        Ok(self.curve2(item, scale, angle)?.map(|curve| Pcurve { surface, curve }))
    }

    /// What the file's u and v are multiplied by to be ours.
    pub fn parameter_scale(&self, surface: &Surface) -> DVec2 {
        let (length, angle) = (self.units.millimetres, self.units.radians);
        match surface {
            Surface::Plane { .. } => DVec2::new(length, length),
            Surface::Cylinder { .. } | Surface::Cone { .. } => DVec2::new(angle, length),
            Surface::Sphere { .. } | Surface::Torus { .. } => DVec2::new(angle, angle),
            Surface::Bspline(_) => DVec2::ONE,
        }
    }

    /// A line or B-spline in a parameter plane, its parameter times `angle`.
    fn curve2(&self, id: u64, scale: DVec2, angle: f64) -> Mapped<Option<Curve2>> {
        let entity = self.entity(id)?;
        if map_bspline::is_curve(&entity) {
            let spline = map_bspline::curve2(self, &entity, scale)?;
            if angle == 1.0 {
                return Ok(Some(Curve2::Bspline(spline)));
            }
            let knots = spline.knots.as_slice().iter().map(|knot| knot * angle).collect();
            let turned = BsplineCurve::new(spline.knots.degree(), knots, spline.points);
            return Ok(turned.ok().map(Curve2::Bspline));
        }
        let record = entity.first();
        if record.keyword != "LINE" {
            return Ok(None);
        }
        // Points and vectors were brought to millimetres as if in space.
        let to_parameters = scale / self.units.millimetres;
        let origin = self.point(reference(id, record, 1)?)?.truncate() * to_parameters;
        let direction = self.vector(reference(id, record, 2)?)?.truncate() * to_parameters / angle;
        Ok(Some(Curve2::Line { origin, direction }))
    }
}
