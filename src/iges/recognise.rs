//! Swept surfaces that are planes, cylinders, cones, spheres or tori.

use super::curve::Piece;
use super::surface::Sheet;
use glam::DVec3;

/// `piece` moved along a vector.
pub fn extruded(_piece: &Piece, _along: DVec3) -> Option<Sheet> {
    None
}

/// `piece` turned about an axis.
pub fn revolved(_piece: &Piece, _origin: DVec3, _axis: DVec3) -> Option<Sheet> {
    None
}
