//! B-spline faces: one net for each Bézier span under the trim window, each stored once, with its leaves.

use super::faces::PartSpace;
use super::outline::Outline;
use super::trim_tree::TrimTree;
use crate::geometry::BsplineSurface;
use crate::numeric::Aabb;
use crate::scene::{Net, NetLeaf};
use glam::{DVec3, DVec4};

/// The nets of a face; indices count from its own arrays.
#[derive(Debug, Default)]
pub(super) struct Nets {
    /// Records; `face` is not set.
    pub nets: Vec<Net>,
    /// Leaves; `trim` is 0 or `TRIM_INSIDE`.
    pub leaves: Vec<NetLeaf>,
    /// Part-space boxes of the leaves.
    pub boxes: Vec<Aabb>,
    /// Homogeneous control points relative to the face's origin.
    pub points: Vec<DVec4>,
    /// Whether any leaf needs the trim tree.
    pub is_mixed: bool,
}

/// Origin of face space in part space (on the grid), and the nets.
pub(super) fn bake_nets(
    surface: &BsplineSurface,
    outline: &Outline,
    trim: &TrimTree,
    space: &PartSpace,
    distortion: f64,
) -> Result<(DVec3, Nets), String> {
    let _ = (surface, outline, trim, space, distortion);
    Err("B-spline surfaces are not baked".into())
}
