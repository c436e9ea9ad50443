//! Edges: indices, degrees, numbers.

use super::validate::{Check, on_grid, require};
use super::{EdgeKind, MAX_DEGREE, NO_FACE, Scene};

/// Checks all that drawing relies on.
pub(super) fn edges(scene: &Scene<'_>) -> Check {
    let is_known = scene.metadata.has_edges || scene.edge_pieces.is_empty();
    require(is_known, "edge_pieces", 0, "the metadata says that there are none")?;
    for (index, piece) in scene.edge_pieces.iter().enumerate() {
        let check = |condition, reason| require(condition, "edge_pieces", index, reason);
        check((piece.part as usize) < scene.parts.len(), "no such part")?;
        let is_face = |&face: &u32| face == NO_FACE || (face as usize) < scene.faces.len();
        check(piece.faces.iter().all(is_face), "no such face")?;
        check((1..=MAX_DEGREE).contains(&piece.degree), "its degree is out of range")?;
        let end = piece.first_point as usize + piece.degree as usize + 1;
        check(end <= scene.edge_points.len(), "no such points")?;
        check(EdgeKind::from_number(piece.kind).is_some(), "no such kind")?;
        check(on_grid(piece.grid), "it lies outside of the grid")?;
    }
    for (index, point) in scene.edge_points.iter().enumerate() {
        let valid = point.iter().all(|x| x.is_finite()) && point[3] > 0.0;
        require(valid, "edge_points", index, "it is not finite or its weight is not positive")?;
    }
    Ok(())
}
