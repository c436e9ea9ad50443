//! Surfaces (ISO 10303-42, clause 4.5). Those swept from a curve are in [`super::map_swept`].

use super::map_bspline;
use super::map_geometry::positive_length;
use super::map_swept;
use super::reader::{MAX_CHAIN, Mapped, Problem, Reader, SurfaceUse, problem, real, reference};
use super::value::{Entity, Record};
use crate::brep::Severity;
use crate::geometry::{Frame, Surface};
use glam::DVec3;
use std::f64::consts::FRAC_PI_2;

/// Angles below this make a cone a cylinder: over 10 m the radius then changes by less than 1e-5 mm.
const LEAST_CONE_ANGLE: f64 = 1e-9;

/// Surfaces that take another form, so that their parameters are not kept and their extent may depend on the face.
pub const RESHAPED: [&str; 6] = [
    "SURFACE_OF_LINEAR_EXTRUSION",
    "SURFACE_OF_REVOLUTION",
    "RECTANGULAR_TRIMMED_SURFACE",
    "CURVE_BOUNDED_SURFACE",
    "SURFACE_REPLICA",
    "OFFSET_SURFACE",
];

/// A surface on the way into the model.
pub struct MappedSurface {
    /// The surface.
    pub surface: Surface,
    /// Whether its normal is opposite to that of the file's surface.
    pub flipped: bool,
    /// Whether its parameters are those of the file's surface, units aside.
    pub keeps_parameters: bool,
    /// Whether it was cut to fit one face and serves no other.
    pub fits_one_face: bool,
    /// How far it may be from the file's surface, in millimetres, where it is not the same.
    pub deviation: f64,
}

impl MappedSurface {
    fn plain(surface: Surface) -> Self {
        Self { surface, flipped: false, keeps_parameters: true, fits_one_face: false, deviation: 0.0 }
    }
}

impl Reader<'_> {
    /// The surface `id` for a face whose boundary runs through `samples`.
    pub fn surface(&mut self, id: u64, samples: &[DVec3]) -> Mapped<SurfaceUse> {
        if let Some(&known) = self.surfaces.get(&id) {
            return Ok(known);
        }
        let mapped = self.map_surface(id, samples, 0)?;
        if mapped.deviation > 0.0 {
            let kind = self.keyword(id).into_owned();
            let reason = format!("approximated within {:.1e} mm", mapped.deviation);
            self.report(Severity::Warning, Problem { entity: id, kind, reason });
        }
        let surface_use = SurfaceUse {
            id: self.model.surfaces.push(mapped.surface),
            flipped: mapped.flipped,
            keeps_parameters: mapped.keeps_parameters,
        };
        if !mapped.fits_one_face {
            self.surfaces.insert(id, surface_use);
        }
        Ok(surface_use)
    }

    /// Surface `id` for a face whose boundary runs through `samples`, `depth` references down a chain of surfaces.
    pub fn map_surface(&self, id: u64, samples: &[DVec3], depth: usize) -> Mapped<MappedSurface> {
        let entity = self.entity(id)?;
        if depth > MAX_CHAIN {
            return Err(problem(&entity, "surfaces refer to each other in a circle"));
        }
        if map_bspline::is_surface(&entity) {
            return map_bspline::surface(self, &entity).map(|s| MappedSurface::plain(Surface::Bspline(s)));
        }
        let record = entity.first();
        let frame = || self.placement(reference(id, record, 1)?);
        let length = |at| positive_length(self, &entity, record, at);
        match &*record.keyword {
            "PLANE" => Ok(MappedSurface::plain(Surface::Plane { frame: frame()? })),
            "CYLINDRICAL_SURFACE" => {
                Ok(MappedSurface::plain(Surface::Cylinder { frame: frame()?, radius: length(2)? }))
            }
            "SPHERICAL_SURFACE" => {
                Ok(MappedSurface::plain(Surface::Sphere { frame: frame()?, radius: length(2)? }))
            }
            "CONICAL_SURFACE" => self.cone(&entity, record, frame()?).map(MappedSurface::plain),
            "TOROIDAL_SURFACE" | "DEGENERATE_TOROIDAL_SURFACE" => {
                self.torus(&entity, record, frame()?).map(MappedSurface::plain)
            }
            "SURFACE_OF_LINEAR_EXTRUSION" => map_swept::extrusion(self, &entity, samples),
            "SURFACE_OF_REVOLUTION" => map_swept::revolution(self, &entity, samples),
            "RECTANGULAR_TRIMMED_SURFACE" => {
                let basis = self.map_surface(reference(id, record, 1)?, samples, depth + 1)?;
                let against = |at| record.logical(at) == Some(false);
                let turned = against(6) || against(7);
                Ok(MappedSurface {
                    flipped: basis.flipped ^ (against(6) != against(7)),
                    keeps_parameters: basis.keeps_parameters && !turned,
                    ..basis
                })
            }
            "CURVE_BOUNDED_SURFACE" => self.map_surface(reference(id, record, 1)?, samples, depth + 1),
            "SURFACE_REPLICA" => {
                let transform = self.transform(reference(id, record, 2)?)?;
                let inverse = transform.inverse();
                let local: Vec<DVec3> = samples.iter().map(|&p| inverse.transform_point3(p)).collect();
                let parent = self.map_surface(reference(id, record, 1)?, &local, depth + 1)?;
                let (surface, turned) = parent.surface.transformed(&transform);
                // S_u × S_v of a mirrored parameterisation points against the mirrored normal.
                let mirrored = transform.matrix3.determinant() < 0.0;
                Ok(MappedSurface {
                    surface,
                    flipped: parent.flipped ^ turned ^ mirrored,
                    keeps_parameters: false,
                    fits_one_face: parent.fits_one_face,
                    deviation: parent.deviation,
                })
            }
            "OFFSET_SURFACE" => self.offset(&entity, samples, depth),
            _ => Err(problem(&entity, "this kind of surface is not supported")),
        }
    }

    fn cone(&self, entity: &Entity, record: &Record, frame: Frame) -> Mapped<Surface> {
        let radius = real(entity.id, record, 2)? * self.units.millimetres;
        let half_angle = real(entity.id, record, 3)? * self.units.radians;
        if radius < 0.0 || !radius.is_finite() {
            return Err(problem(entity, "the radius is negative"));
        }
        if half_angle.abs() < LEAST_CONE_ANGLE && radius > 0.0 {
            return Ok(Surface::Cylinder { frame, radius });
        }
        if half_angle.abs() < LEAST_CONE_ANGLE || half_angle.abs() > FRAC_PI_2 - LEAST_CONE_ANGLE {
            return Err(problem(entity, "the half angle is not between 0° and 90°"));
        }
        Ok(Surface::Cone { frame, radius, half_angle })
    }

    fn torus(&self, entity: &Entity, record: &Record, frame: Frame) -> Mapped<Surface> {
        let major = real(entity.id, record, 2)? * self.units.millimetres;
        let minor = positive_length(self, entity, record, 3)?;
        if major == 0.0 {
            return Ok(Surface::Sphere { frame, radius: minor });
        }
        if major < 0.0 || !major.is_finite() {
            return Err(problem(entity, "the major radius is negative"));
        }
        Ok(Surface::Torus { frame, major, minor })
    }
}
