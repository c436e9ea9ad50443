//! What trim regions are made of.

use super::judge::TrimJudge;
use super::retrim::TrimRegions;
use std::collections::BTreeMap;

impl TrimRegions {
    /// How many faces they belong to.
    pub fn len(&self) -> usize {
        self.regions.len()
    }

    /// Whether there is no face.
    pub fn is_empty(&self) -> bool {
        self.regions.is_empty()
    }

    /// Whether a face has trim curves.
    pub fn is_trimmed(&self, face: usize) -> bool {
        self.regions[face].is_bounded
    }

    /// Who tells whether points of a face are inside.
    pub fn judge(&self, face: usize) -> TrimJudge {
        TrimJudge::new(&self.regions[face])
    }

    /// How many bi-monotone rational Bézier curves there are of each degree; straight ones are of degree 1, whatever their control points.
    pub fn degrees(&self) -> BTreeMap<usize, usize> {
        let mut degrees = BTreeMap::new();
        for region in &self.regions {
            for piece in &region.pieces {
                let degree = piece.curve.map_or(1, |curve| region.curves[curve as usize].degree());
                *degrees.entry(degree).or_default() += 1;
            }
        }
        degrees
    }
}
