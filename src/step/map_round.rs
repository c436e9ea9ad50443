//! Cylinders, cones, spheres and tori (ISO 10303-42, clause 4.5.4 to 4.5.8), also with radii and angles that the standard does not
//! allow: the standard's own formulas say which surface those are.

use super::map_surface::MappedSurface;
use super::reader::{Mapped, Reader, problem, real};
use super::value::{Entity, Record};
use crate::geometry::{Curve, Frame, Surface, to_bspline};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Angles below this make a cone a cylinder: over 10 m the radius then changes by less than 1e-5 mm.
const LEAST_CONE_ANGLE: f64 = 1e-9;

/// Tori whose radii differ by less than this share are horn tori, which have a single sheet.
const HORN: f64 = 1e-9;

impl Reader<'_> {
    /// `CYLINDRICAL_SURFACE(name, position, radius)`. With `u + π` for u a negative radius is a positive one.
    pub fn cylinder(&self, entity: &Entity, record: &Record, frame: Frame) -> Mapped<MappedSurface> {
        let radius = self.radius(entity, record, 2)?;
        Ok(mended(Surface::Cylinder { frame, radius: radius.abs() }, entity, radius < 0.0))
    }

    /// `SPHERICAL_SURFACE(name, position, radius)`. With a negative radius `S_u × S_v` points inwards.
    pub fn sphere(&self, entity: &Entity, record: &Record, frame: Frame) -> Mapped<MappedSurface> {
        let radius = self.radius(entity, record, 2)?;
        let mapped = mended(Surface::Sphere { frame, radius: radius.abs() }, entity, radius < 0.0);
        Ok(MappedSurface { flipped: radius < 0.0, ..mapped })
    }

    /// `CONICAL_SURFACE(name, position, radius, semi angle)`. Only the tangent of the angle counts, which has period π; a
    /// negative radius lies beyond the apex.
    pub fn cone(&self, entity: &Entity, record: &Record, frame: Frame) -> Mapped<MappedSurface> {
        let radius = real(entity.id, record, 2)? * self.units.millimetres;
        let given = real(entity.id, record, 3)? * self.units.radians;
        let half_angle = if given.abs() < FRAC_PI_2 { given } else { given.tan().atan() };
        let is_odd = half_angle != given;
        if half_angle.abs() < LEAST_CONE_ANGLE && radius != 0.0 {
            return Ok(mended(
                Surface::Cylinder { frame, radius: radius.abs() },
                entity,
                is_odd || radius < 0.0,
            ));
        }
        if half_angle.abs() < LEAST_CONE_ANGLE || half_angle.abs() > FRAC_PI_2 - LEAST_CONE_ANGLE {
            return Err(problem(entity, "the half angle is not between 0° and 90°"));
        }
        if radius >= 0.0 {
            return Ok(mended(Surface::Cone { frame, radius, half_angle }, entity, is_odd));
        }
        let origin = frame.origin - frame.z * (radius / half_angle.tan());
        let surface = Surface::Cone { frame: Frame { origin, ..frame }, radius: 0.0, half_angle };
        Ok(mended(surface, entity, true))
    }

    /// `TOROIDAL_SURFACE(name, position, major radius, minor radius)`, and `DEGENERATE_TOROIDAL_SURFACE(.., select outer)`: of a
    /// spindle torus the outer or the inner sheet alone, as a B-spline of revolution, since the torus has both.
    ///
    /// A negative major radius is a positive one with `u + π` and `π − v`, which turns the normal; a negative minor one is a
    /// positive one with `v + π`.
    pub fn torus(&self, entity: &Entity, record: &Record, frame: Frame) -> Mapped<MappedSurface> {
        let major = real(entity.id, record, 2)? * self.units.millimetres;
        let minor = self.radius(entity, record, 3)?;
        let is_odd = major < 0.0 || minor < 0.0;
        let flipped = major < 0.0;
        let (major, minor) = (major.abs(), minor.abs());
        let surface = match record.logical(4) {
            _ if major == 0.0 => Surface::Sphere { frame, radius: minor },
            Some(is_outer) if minor > major * (1.0 + HORN) => {
                let to_axis = (-major / minor).acos();
                let range = if is_outer { [-to_axis, to_axis] } else { [to_axis, TAU - to_axis] };
                let origin = frame.origin + frame.x * major;
                let meridian = Frame { origin, x: frame.x, y: frame.z, z: -frame.y };
                let circle = Curve::Circle { frame: meridian, radius: minor };
                let profile = to_bspline::curve_to_bspline(&circle, range);
                let surface = Surface::Bspline(to_bspline::revolve(&profile, &frame));
                let mapped = mended(surface, entity, is_odd);
                return Ok(MappedSurface { flipped, keeps_parameters: false, ..mapped });
            }
            _ => Surface::Torus { frame, major, minor },
        };
        Ok(MappedSurface { flipped, ..mended(surface, entity, is_odd) })
    }

    /// Parameter `at` as a length that is not 0, in millimetres.
    fn radius(&self, entity: &Entity, record: &Record, at: usize) -> Mapped<f64> {
        let radius = real(entity.id, record, at)? * self.units.millimetres;
        let good = radius != 0.0 && radius.is_finite();
        good.then_some(radius).ok_or_else(|| problem(entity, "a radius of 0"))
    }
}

/// A surface whose numbers are odd, or are not; odd ones do not keep their parameters.
fn mended(surface: Surface, entity: &Entity, is_odd: bool) -> MappedSurface {
    let repair = is_odd
        .then(|| problem(entity, "a radius or angle out of its range; read by the formula of the surface"));
    MappedSurface { keeps_parameters: !is_odd, ..MappedSurface::plain(surface) }.with(repair)
}
