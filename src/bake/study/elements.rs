//! Elements: pieces as records with control points of their own, from the low end to the high end.

use super::super::region::{Piece, Region};
use super::Structure;
use super::boxing::slab_word;
use crate::geometry::Homogeneous2;
use glam::DVec3;

/// Whether no ray to the left can cross the piece.
pub(super) fn is_horizontal(piece: &Piece) -> bool {
    piece.low[1] == piece.high[1]
}

/// The control points of a piece; two where it is straight.
pub(super) fn control_points(region: &Region, piece: &Piece) -> Vec<Homogeneous2> {
    match piece.curve {
        Some(curve) => region.curves[curve as usize].piece(piece.t[0], piece.t[1]).points,
        None => [piece.low, piece.high].map(|p| DVec3::new(f64::from(p[0]), f64::from(p[1]), 1.0)).to_vec(),
    }
}

impl Structure {
    /// Appends the record of a piece; returns its place.
    pub(super) fn push_element(&mut self, region: &Region, piece: &Piece, has_boxing: bool) -> u32 {
        let first = self.points.len() as u32;
        let (mut degree, mut slab) = (0, 0);
        if !is_horizontal(piece) {
            let points = control_points(region, piece);
            degree = points.len() as u32 - 1;
            if has_boxing {
                slab = slab_word(piece.low, piece.high, &[&points]);
            }
            self.points.extend(points.iter().map(|p| p.as_vec3().to_array()));
            self.max_degree = self.max_degree.max(degree);
        }
        self.push_record(piece.low, piece.high, [first, degree, slab])
    }

    /// Appends a record; returns its place.
    pub(super) fn push_record(&mut self, low: [f32; 2], high: [f32; 2], rest: [u32; 3]) -> u32 {
        let place = self.words.len() as u32;
        self.words.extend([low[0], low[1], high[0], high[1]].map(f32::to_bits));
        self.words.extend(rest);
        self.words.push(0);
        place
    }
}
