//! The segments of a face's trims: its pieces, halved where their bands would leave too much to the curves.

use super::region::{Piece, Region, number};
use super::trim_band::band;
use crate::geometry::Homogeneous2;
use crate::scene::{Band, MAX_DEGREE, TrimSegment};

/// A segment is halved while its band covers more of the window than this: the share of evenly spread points that would need the curve.
const WIDEST: f32 = 1.0 / 1024.0;

/// Halvings of a piece at most.
const MAX_HALVINGS: u32 = 2;

/// Segments under construction.
pub(super) struct Segments {
    /// Each its own source.
    pub pieces: Vec<Piece>,
    /// Of the pieces; those of straight ones decide nothing.
    bands: Vec<Band>,
}

impl Segments {
    /// Those of a region.
    pub(super) fn new(region: &Region) -> Result<Self, String> {
        let mut segments = Self { pieces: Vec::new(), bands: Vec::new() };
        for piece in &region.pieces {
            segments.add(region, piece, MAX_HALVINGS);
        }
        number(&mut segments.pieces);
        if segments.pieces.len() > crate::scene::trim_word::MAX_SEGMENT as usize {
            return Err(format!("{} trim curves are too many", region.pieces.len()));
        }
        Ok(segments)
    }

    fn add(&mut self, region: &Region, piece: &Piece, halvings: u32) {
        let band = band_of(region, piece);
        let sides = [0, 1].map(|axis| {
            let [a, b] = piece.range(axis);
            b - a
        });
        // The band is a unit long in the chord's frame.
        let is_wide = piece.curve.is_some() && 2.0 * band.half_width * sides[0] * sides[1] > WIDEST;
        if is_wide
            && halvings > 0
            && let [Some(first), Some(second)] = region.halves(piece)
        {
            self.add(region, &first, halvings - 1);
            self.add(region, &second, halvings - 1);
        } else {
            self.pieces.push(*piece);
            self.bands.push(band);
        }
    }

    /// The records, the control points that they name, and the highest degree.
    pub(super) fn into_records(
        self,
        region: &Region,
    ) -> Result<(Vec<TrimSegment>, Vec<Homogeneous2>, u32), String> {
        let mut points = Vec::new();
        let mut first_point = vec![u32::MAX; region.curves.len()];
        let mut max_degree = 0;
        let mut records = Vec::with_capacity(self.pieces.len());
        for (piece, band) in self.pieces.iter().zip(self.bands) {
            let (degree, first) = match piece.curve {
                None => (1, 0),
                Some(curve) => {
                    let own = &region.curves[curve as usize].points;
                    let first = &mut first_point[curve as usize];
                    if *first == u32::MAX {
                        *first = points.len() as u32;
                        points.extend_from_slice(own);
                    }
                    (own.len() as u32 - 1, *first)
                }
            };
            max_degree = max_degree.max(degree);
            let curve = TrimSegment::curve_word(degree, piece.t[0] > piece.t[1], first).ok_or_else(|| {
                format!("{} trim curves up to degree {MAX_DEGREE} are too many", region.pieces.len())
            })?;
            records.push(TrimSegment { low: piece.low, high: piece.high, band: band.pack(), curve });
        }
        Ok((records, points, max_degree))
    }
}

fn band_of(region: &Region, piece: &Piece) -> Band {
    let Some(curve) = piece.curve else { return Band::NONE };
    if (0..2).any(|axis| piece.low[axis] == piece.high[axis]) {
        return Band::NONE;
    }
    band(&region.curves[curve as usize].piece(piece.t[0], piece.t[1]), piece.low, piece.high)
}
