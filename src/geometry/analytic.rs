//! Values and derivatives of the elementary surfaces.

use super::frame::Frame;
use super::surface::SurfaceDerivatives;
use glam::{DVec2, DVec3};

pub(super) fn plane(frame: &Frame, uv: DVec2) -> SurfaceDerivatives {
    SurfaceDerivatives {
        point: frame.point(uv.extend(0.0)),
        du: frame.x,
        dv: frame.y,
        duu: DVec3::ZERO,
        duv: DVec3::ZERO,
        dvv: DVec3::ZERO,
    }
}

/// The surface `frame(ρ cos u, ρ sin u, h)`; `radius` and `height` hold ρ and h with their first two derivatives by v.
pub(super) fn revolved(frame: &Frame, u: f64, radius: [f64; 3], height: [f64; 3]) -> SurfaceDerivatives {
    let (sin, cos) = u.sin_cos();
    let out = frame.x * cos + frame.y * sin;
    let around = frame.y * cos - frame.x * sin;
    SurfaceDerivatives {
        point: frame.origin + out * radius[0] + frame.z * height[0],
        du: around * radius[0],
        dv: out * radius[1] + frame.z * height[1],
        duu: out * -radius[0],
        duv: around * radius[1],
        dvv: out * radius[2] + frame.z * height[2],
    }
}

/// The torus of radii `major` and `minor`; the sphere is the one with `major = 0`.
pub(super) fn torus(frame: &Frame, major: f64, minor: f64, uv: DVec2) -> SurfaceDerivatives {
    let (sin, cos) = uv.y.sin_cos();
    let (s, c) = (minor * sin, minor * cos);
    revolved(frame, uv.x, [major + c, -s, -c], [s, c, -s])
}
