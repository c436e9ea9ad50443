//! Boxes around pieces of surfaces.

use super::surface::{ParameterBox, Surface};
use crate::numeric::Aabb;

/// A box around the piece of `surface` over `range`.
pub(super) fn surface_bounds(surface: &Surface, range: ParameterBox) -> Aabb {
    todo!()
}
