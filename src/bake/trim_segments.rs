//! The segments of a face's trims: its pieces, halved where their bands would leave too much to the curves.

use super::narrow;
use super::region::{Piece, Region, number};
use super::trim_band::{self, band};
use crate::geometry::{Bezier, Homogeneous2};
use crate::scene::{Band, MAX_DEGREE, TrimMethod, TrimSegment};

/// A segment is halved while its band covers more of the window than this: the share of evenly spread points that would need the curve.
const WIDEST: f32 = 1.0 / 1024.0;

/// Halvings of a piece at most.
const MAX_HALVINGS: u32 = 2;

/// Without curves, segments are halved until their bands are no wider than this share of the window, 2⁻²²: four steps of f32 numbers below 1.
const NARROWEST: f32 = 1.0 / 4_194_304.0;

/// Halvings of a piece at most without curves: a quarter of a circle as large as the window needs 5.
const MAX_HALVINGS_OF_BANDS: u32 = 12;

/// What decides where a band is too wide.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Evaluation {
    /// The curve.
    Curves,
    /// More and narrower bands: their middles take the place of the curve, off by their half width at most.
    Bands,
}

impl Evaluation {
    /// That of a method.
    pub(super) fn of(method: TrimMethod) -> Self {
        if method == TrimMethod::PACKED_BANDS { Self::Bands } else { Self::Curves }
    }
}

/// Segments under construction.
pub(super) struct Segments {
    /// Each its own source.
    pub pieces: Vec<Piece>,
    /// Of the pieces.
    bands: Vec<Band>,
    evaluation: Evaluation,
}

impl Segments {
    /// Those of the pieces of a region that are needed.
    pub(super) fn new(
        region: &Region,
        evaluation: Evaluation,
        is_needed: impl Fn(&Piece) -> bool,
    ) -> Result<Self, String> {
        let mut segments = Self { pieces: Vec::new(), bands: Vec::new(), evaluation };
        let halvings = match evaluation {
            Evaluation::Curves => MAX_HALVINGS,
            Evaluation::Bands => MAX_HALVINGS_OF_BANDS,
        };
        for piece in region.pieces.iter().filter(|piece| is_needed(piece)) {
            segments.add(region, piece, halvings);
        }
        number(&mut segments.pieces);
        if segments.pieces.len() > crate::scene::trim_word::MAX_SEGMENT as usize {
            return Err(format!("{} trim curves are too many", region.pieces.len()));
        }
        Ok(segments)
    }

    fn add(&mut self, region: &Region, piece: &Piece, halvings: u32) {
        let band = band_of(region, piece);
        let side = |axis| {
            let [least, greatest] = piece.range(axis);
            greatest - least
        };
        let is_wide = match self.evaluation {
            // The band is a unit long in the chord's frame.
            Evaluation::Curves => 2.0 * band.half_width * side(0) * side(1) > WIDEST,
            Evaluation::Bands => !is_narrow(piece, &band),
        };
        if is_wide
            && piece.curve.is_some()
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
                Some(_) if self.evaluation == Evaluation::Bands && is_narrow(piece, &band) => {
                    StoredCurve { degree: 0, is_rational: false, offset: 0 }
                }
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

/// Whether the middle of the band may stand for the piece.
fn is_narrow(piece: &Piece, band: &Band) -> bool {
    let [least, greatest] = piece.range(usize::from(!band.by_v));
    band.half_width * (greatest - least) <= NARROWEST
}

/// The band of a piece. A straight one goes by v, so that its u at a height comes of it, within the roundings of kernels.
fn band_of(region: &Region, piece: &Piece) -> Band {
    match piece.curve {
        None => Band { by_v: true, half_width: narrow::above(trim_band::ROUNDING), ..Band::NONE },
        Some(_) if (0..2).any(|axis| piece.low[axis] == piece.high[axis]) => Band::NONE,
        Some(curve) => {
            band(&region.curves[curve as usize].piece(piece.t[0], piece.t[1]), piece.low, piece.high)
        }
    }
}
