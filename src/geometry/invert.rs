//! The parameters of the point of a curve or surface that is closest to a given point.

use super::curve::Curve;
use super::surface::Surface;
use glam::{DVec2, DVec3};

/// The closest point of a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inversion {
    /// Its parameters.
    pub uv: DVec2,
    /// Its distance from the given point.
    pub distance: f64,
}

/// The parameter of the point of `curve` closest to `point`; near `seed` where one is given, else the global closest.
pub fn invert_curve(curve: &Curve, point: DVec3, seed: Option<f64>) -> f64 {
    todo!()
}

/// The point of `surface` closest to `point`. With a seed (the previous point of a march) the local solution reached from it, with periodic
/// parameters unwrapped to be nearest to the seed; without one the global closest.
pub fn invert_surface(surface: &Surface, point: DVec3, seed: Option<DVec2>) -> Inversion {
    todo!()
}
