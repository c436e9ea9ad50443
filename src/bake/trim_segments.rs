//! The segments of a face's trims: its pieces, halved where their bands would leave too much to the curves.

use super::narrow;
use super::region::{Piece, Region, number};
use super::trim_band::{self, band};
use crate::geometry::{Bezier, Homogeneous2};
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
    /// Those of the pieces of a region that are needed.
    pub(super) fn new(region: &Region, is_needed: impl Fn(&Piece) -> bool) -> Result<Self, String> {
        let mut segments = Self { pieces: Vec::new(), bands: Vec::new() };
        for piece in region.pieces.iter().filter(|piece| is_needed(piece)) {
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

    /// The records and the highest degree; the curves that they name are added to `words`.
    pub(super) fn into_records(
        self,
        region: &Region,
        words: &mut Vec<u32>,
    ) -> Result<(Vec<TrimSegment>, u32), String> {
        let mut stored: Vec<Option<StoredCurve>> = vec![None; region.curves.len()];
        let mut max_degree = 0;
        let mut records = Vec::with_capacity(self.pieces.len());
        for (piece, band) in self.pieces.iter().zip(self.bands) {
            let curve = match piece.curve {
                None => StoredCurve { degree: 1, is_rational: false, offset: 0 },
                Some(index) => match stored[index as usize] {
                    Some(curve) => curve,
                    None => *stored[index as usize].insert(store(&region.curves[index as usize], words)?),
                },
            };
            max_degree = max_degree.max(curve.degree);
            let falls = piece.t[0] > piece.t[1];
            let curve = TrimSegment::curve_word(curve.degree, falls, curve.is_rational, curve.offset)
                .ok_or_else(|| {
                    format!("{} trim curves up to degree {MAX_DEGREE} are too many", region.pieces.len())
                })?;
            records.push(TrimSegment { low: piece.low, high: piece.high, band: band.pack(), curve });
        }
        Ok((records, max_degree))
    }
}

/// A curve among the words.
#[derive(Clone, Copy)]
struct StoredCurve {
    degree: u32,
    is_rational: bool,
    offset: u32,
}

/// Adds a curve to `words`.
fn store(curve: &Bezier<Homogeneous2>, words: &mut Vec<u32>) -> Result<StoredCurve, String> {
    let last = curve.points.len() - 1;
    if curve.points[0].z != 1.0 || curve.points[last].z != 1.0 {
        return Err("a trim curve's weights at its ends are not 1".into());
    }
    let stored = StoredCurve {
        degree: last as u32,
        is_rational: curve.points.iter().any(|p| p.z != 1.0),
        offset: words.len() as u32,
    };
    for (index, point) in curve.points.iter().enumerate() {
        let numbers = if stored.is_rational && index > 0 && index < last { 3 } else { 2 };
        words.extend(point.to_array()[..numbers].iter().map(|&x| narrow::number(x).to_bits()));
    }
    Ok(stored)
}

/// The band of a piece. A straight one goes by v, so that its u at a height comes of it, within the roundings of kernels.
fn band_of(region: &Region, piece: &Piece) -> Band {
    match piece.curve {
        None => Band { by_v: true, half_width: trim_band::ROUNDING as f32, ..Band::NONE },
        Some(_) if (0..2).any(|axis| piece.low[axis] == piece.high[axis]) => Band::NONE,
        Some(curve) => {
            band(&region.curves[curve as usize].piece(piece.t[0], piece.t[1]), piece.low, piece.high)
        }
    }
}
