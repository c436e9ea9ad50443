//! Surfaces at a constant distance from others (ISO 10303-42: offset_surface).
//!
//! Offsets of planes, cylinders, cones, spheres and tori are such surfaces again. Those of B-splines are no rational
//! surfaces at all and are fitted.

use super::fit::{breaks_of, fit_surface};
use super::frame::Frame;
use super::surface::Surface;
use glam::{DVec2, DVec3};

/// A surface at a distance.
#[derive(Debug, Clone)]
pub struct Offset {
    /// Over the same parameters, but for cones whose frame had to move along the axis.
    pub surface: Surface,
    /// How far the surface may be from the true one; 0 where it is exact.
    pub deviation: f64,
}

/// How far inside of the domain, as a share of it, a normal is taken where a side of the surface is a point.
const BESIDE_A_POLE: f64 = 1e-6;

/// The surface at `distance` along the normal of `surface`. Fits are brought within `tolerance` where that is possible; the
/// result says how far it got. `None` where nothing is left: a radius vanishes, or a B-spline has no normals.
pub fn offset_surface(surface: &Surface, distance: f64, tolerance: f64) -> Option<Offset> {
    let positive = |radius: f64| Some(radius).filter(|radius| *radius > 0.0);
    let surface = match surface {
        Surface::Plane { frame } => Surface::Plane { frame: moved(frame, distance) },
        Surface::Cylinder { frame, radius } => {
            Surface::Cylinder { frame: *frame, radius: positive(radius + distance)? }
        }
        Surface::Sphere { frame, radius } => {
            Surface::Sphere { frame: *frame, radius: positive(radius + distance)? }
        }
        Surface::Torus { frame, major, minor } => {
            Surface::Torus { frame: *frame, major: *major, minor: positive(minor + distance)? }
        }
        Surface::Cone { frame, radius, half_angle } => {
            // The normal is cos α outwards and −sin α along the axis.
            let frame = moved(frame, -distance * half_angle.sin());
            let radius = radius + distance * half_angle.cos();
            let to_apex = if radius < 0.0 { -radius / half_angle.tan() } else { 0.0 };
            let frame = moved(&frame, to_apex);
            Surface::Cone { frame, radius: radius.max(0.0), half_angle: *half_angle }
        }
        Surface::Bspline(spline) => {
            let domain = spline.domain();
            let size = domain.max - domain.min;
            let inside = [domain.min + size * BESIDE_A_POLE, domain.max - size * BESIDE_A_POLE];
            let normal = |uv: DVec2| {
                let d = spline.derivatives(uv);
                let normal = d.du.cross(d.dv);
                let regular = normal.length() > 1e-9 * d.du.length() * d.dv.length();
                (regular && normal.length() > 0.0).then(|| normal.normalize())
            };
            let point = |uv: DVec2| {
                let normal = normal(uv).or_else(|| normal(uv.clamp(inside[0], inside[1])))?;
                Some(spline.point(uv) + normal * distance).filter(|p: &DVec3| p.is_finite())
            };
            let (u, v) = (breaks_of(&spline.u_knots), breaks_of(&spline.v_knots));
            let fit = fit_surface(&u, &v, point, tolerance)?;
            return Some(Offset { surface: Surface::Bspline(fit.surface), deviation: fit.deviation });
        }
    };
    Some(Offset { surface, deviation: 0.0 })
}

fn moved(frame: &Frame, along: f64) -> Frame {
    Frame { origin: frame.origin + frame.z * along, ..*frame }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Curve, to_bspline};

    fn check(surface: &Surface, distance: f64, uvs: &[[f64; 2]], tolerance: f64) {
        let offset = offset_surface(surface, distance, tolerance).expect("something is left");
        for uv in uvs.iter().map(|uv| DVec2::from_array(*uv)) {
            let d = surface.derivatives(uv);
            let expected = d.point + d.du.cross(d.dv).normalize() * distance;
            let off = offset.surface.point(uv).distance(expected);
            assert!(off <= 1.5 * tolerance.max(1e-14), "{} {uv}: {off:e}", surface.kind());
        }
        assert!(offset.deviation <= tolerance, "{:e}", offset.deviation);
    }

    #[test]
    fn analytic_surfaces_stay_what_they_are() {
        let frame = Frame::from_axes(DVec3::new(1.0, 2.0, 3.0), Some(DVec3::new(1.0, 1.0, 1.0)), None);
        let uvs = [[0.3, 0.2], [2.0, 1.0], [5.0, -0.4]];
        for surface in [
            Surface::Plane { frame },
            Surface::Cylinder { frame, radius: 2.0 },
            Surface::Cone { frame, radius: 2.0, half_angle: 0.4 },
            Surface::Cone { frame, radius: 2.0, half_angle: -0.4 },
            Surface::Sphere { frame, radius: 2.0 },
            Surface::Torus { frame, major: 5.0, minor: 1.5 },
        ] {
            check(&surface, 0.7, &uvs, 1e-14);
            check(&surface, -0.7, &uvs, 1e-14);
        }
        assert!(offset_surface(&Surface::Sphere { frame, radius: 2.0 }, -2.0, 1e-9).is_none());
    }

    #[test]
    fn splines_are_fitted() {
        let profile = Curve::Ellipse {
            frame: Frame::from_axes(DVec3::X * 5.0, Some(DVec3::Y), Some(DVec3::X)),
            radii: [1.0, 2.0],
        };
        let profile = to_bspline::curve_to_bspline(&profile, [-1.0, 1.5]);
        let surface = Surface::Bspline(to_bspline::revolve(&profile, &Frame::IDENTITY));
        check(&surface, 0.3, &[[0.3, -0.2], [2.0, 1.0], [5.0, -0.4], [6.1, 1.4]], 1e-7);
    }
}
