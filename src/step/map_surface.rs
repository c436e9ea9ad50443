//! Surfaces (ISO 10303-42, clause 4.5). Those with radii are in [`super::map_round`], those swept from a curve in
//! [`super::map_swept`].

use super::map_bspline;
use super::map_swept;
use super::reader::{MAX_CHAIN, Mapped, Problem, Reader, SurfaceUse, problem, reference};
use crate::brep::Severity;
use crate::geometry::Surface;
use glam::DVec3;

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
    /// What had to be mended.
    pub repairs: Vec<Problem>,
}

impl MappedSurface {
    /// A surface as the file has it.
    pub fn plain(surface: Surface) -> Self {
        Self {
            surface,
            flipped: false,
            keeps_parameters: true,
            fits_one_face: false,
            deviation: 0.0,
            repairs: Vec::new(),
        }
    }

    /// The same with repairs.
    pub fn with(mut self, repairs: impl IntoIterator<Item = Problem>) -> Self {
        self.repairs.extend(repairs);
        self
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
        for repair in mapped.repairs {
            self.report(Severity::Repaired, repair);
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
            let (spline, repair) = map_bspline::surface(self, &entity)?;
            let repair = repair.map(|reason| problem(&entity, reason));
            return Ok(MappedSurface::plain(Surface::Bspline(spline)).with(repair));
        }
        let record = entity.first();
        let frame = || self.placement(reference(id, record, 1)?);
        match &*record.keyword {
            "PLANE" => Ok(MappedSurface::plain(Surface::Plane { frame: frame()? })),
            "CYLINDRICAL_SURFACE" => self.cylinder(&entity, record, frame()?),
            "SPHERICAL_SURFACE" => self.sphere(&entity, record, frame()?),
            "CONICAL_SURFACE" => self.cone(&entity, record, frame()?),
            "TOROIDAL_SURFACE" | "DEGENERATE_TOROIDAL_SURFACE" => self.torus(&entity, record, frame()?),
            "SURFACE_OF_LINEAR_EXTRUSION" => map_swept::extrusion(self, &entity, samples, depth),
            "SURFACE_OF_REVOLUTION" => map_swept::revolution(self, &entity, samples, depth),
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
                    ..parent
                })
            }
            "OFFSET_SURFACE" => self.offset(&entity, samples, depth),
            _ => Err(problem(&entity, "this kind of surface is not supported")),
        }
    }
}
