//! The trims of a face: a grid of cells over its parameter window, kd-trees where a cell is crowded, and monotone segments that cells share.
//!
//! A cell holds a state and refers to the segments that pass it. Segments are stored once, whole, with a *band* that decides nearly all points
//! without a look at the curve; so cells cost a word each, and a point is answered by one of them in most cases: that replaces the first
//! levels of the kd-tree of Sloup and Havran (2021), every level of which is a dependent read and an unforeseeable branch.
//!
//! ```text
//! root    word 0: log2 of the number of cells along u [3:0], along v [7:4]; [8]: cells are short
//!         word 1: first segment of the face in trim_segments
//!         then the cells, u fastest; then the nodes of trees and the lists; then the curves. Offsets in words count from the end of the cells,
//!         those of curves from the root.
//! inner   [31] = 0  [30] axis  [29:16] plane in steps of 2⁻¹⁴ of the window  [15:0] words to the right child
//!         (the left child is the next word; distance 0xffff: the next word holds the distance, the left child follows it)
//! uniform [31:29] = 100  [28] inside
//! one     [31:29] = 101  [28] corner  [27:26] toggles  [25:0] segment of the face
//! list    [31:29] = 110  [28:0] offset of: [31] corner [30:0] count, then a word for each segment: [31:30] toggles [25:0] segment of the face
//! tree    [31:29] = 111  [28:0] offset of the root of a kd-tree (in the grid only)
//! short   two cells in a word, the first in the lower half: [15:14] the lower two bits of the kind, then [13] inside or corner [12:11] toggles [10:0] segment,
//!         or [13:0] offset
//! curve   f32 bits: (u, v) of each control point; of a rational curve (u w, v w, w) of the inner ones, and weights of 1 at the ends
//! ```
//! A point goes to the cell that it lies in, upper borders excluded but for the window's own, and in a tree left where its coordinate is below the plane.
//! Its state is `corner`, flipped once for each segment of the cell that passes left of it at its height (`low.v <= v < high.v` and `u(v) <= u`), and once for each
//! toggle whose height is at most v: bit 0 stands for `low.v`, bit 1 for `high.v`.
//!
//! Why: the state is known at the cell's lower left corner. Walk up just inside the left edge, u₀, then right to the point; each
//! crossing flips. A segment that spans u₀ is met by the walk up or passes left of the way right, and which of them follows from
//! heights alone: one that rises to the right is met on one of the two legs for every v from `low.v` on unless it passes left of the point, one that
//! falls for every v from `high.v` on. Toggles at heights below the cell are the same for all of its points and so part of `corner`.

use super::layout::MAX_DEGREE;
use bytemuck::{Pod, Zeroable};

/// The trim root that means "inside everywhere".
pub const TRIM_INSIDE: u32 = u32::MAX;

/// A piece of a trim curve, monotone in u and in v. 24 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct TrimSegment {
    /// The end with the lesser v, normalised (u, v); of equal ones that with the lesser u.
    pub low: [f32; 2],
    /// The other end.
    pub high: [f32; 2],
    /// A [`Band`], where the degree is above 1.
    pub band: u32,
    /// `degree << 27 | falls << 26 | rational << 25 | offset of the curve`. Degree 1: the straight line from low to high, without a curve; degree 0:
    /// the middle of the band, without a curve. `falls`: the curve's parameter runs from high to low.
    pub curve: u32,
}

impl TrimSegment {
    /// Bit of `curve`: v falls with the curve's parameter.
    pub const FALLS: u32 = 1 << 26;
    /// Bit of `curve`: inner control points have weights.
    pub const RATIONAL: u32 = 1 << 25;
    /// Mask of the offset in `curve`.
    pub const OFFSET_MASK: u32 = Self::RATIONAL - 1;

    /// The word `curve`; nothing where a number does not fit.
    pub fn curve_word(degree: u32, falls: bool, is_rational: bool, offset: u32) -> Option<u32> {
        let fits = degree <= MAX_DEGREE && offset <= Self::OFFSET_MASK;
        let flags = if falls { Self::FALLS } else { 0 } | if is_rational { Self::RATIONAL } else { 0 };
        fits.then_some(degree << 27 | flags | offset)
    }

    /// The degree.
    #[inline(always)]
    pub const fn degree(&self) -> u32 {
        self.curve >> 27
    }

    /// Words of the curve.
    pub const fn curve_words(&self) -> usize {
        let degree = self.degree() as usize;
        match (degree, self.curve & Self::RATIONAL != 0) {
            (0 | 1, _) => 0,
            (_, false) => 2 * (degree + 1),
            (_, true) => 3 * degree + 1,
        }
    }
}

/// A cubic band around a segment: 13 + 10 + 1 + 8 bits.
///
/// In the frame where `low` is (0, 0) and `high` (1, 1), a monotone segment is the graph of a function of either coordinate. With x the one that the band goes
/// by and y the other one, all of it has `|y − x − 4 x (1 − x) (bulge + skew (2 x − 1))| <= half_width`: above the band is above the segment. A curve is
/// smooth as a function of the coordinate that it does not turn in, so the halves of a turn have narrow bands, whose width falls with the fourth power of
/// their length (a parabola's, Sederberg, White and Zundel 1989, with the third).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// In −1..=1.
    pub bulge: f32,
    /// In −1..=1.
    pub skew: f32,
    /// Whether it goes by v; else by u.
    pub by_v: bool,
    /// Infinite where the band decides nothing.
    pub half_width: f32,
}

impl Band {
    /// Steps of `bulge` in a unit: 13 bits with a sign.
    pub const BULGE_STEPS: f32 = 4095.0;
    /// Steps of `skew` in a unit: 10 bits with a sign.
    pub const SKEW_STEPS: f32 = 511.0;
    /// The bit of `by_v`.
    pub const BY_V: u32 = 1 << 8;
    /// The upper 12 bits, exponent and three bits of the fraction, of the least half width, 2⁻²³.
    pub const WIDTH_BIAS: u32 = (127 - 23) << 3;
    /// One that decides nothing.
    pub const NONE: Self = Self { bulge: 0.0, skew: 0.0, by_v: false, half_width: f32::INFINITY };

    /// The band nearest to the given coefficients, with a half width not below the given one.
    pub fn pack(self) -> u32 {
        let steps = |x: f32, steps: f32| ((x * steps).round().clamp(-steps, steps) as i32) as u32;
        let bulge = steps(self.bulge, Self::BULGE_STEPS) & 0x1fff;
        let skew = steps(self.skew, Self::SKEW_STEPS) & 0x3ff;
        let above = (self.half_width.to_bits() + ((1 << 20) - 1)) >> 20;
        let is_number = self.half_width >= 0.0;
        let width = if is_number { above.saturating_sub(Self::WIDTH_BIAS).min(255) } else { 255 };
        bulge << 19 | skew << 9 | if self.by_v { Self::BY_V } else { 0 } | width
    }

    /// The band of a word.
    #[inline(always)]
    pub fn unpack(word: u32) -> Self {
        let width = word & 0xff;
        Self {
            bulge: ((word as i32) >> 19) as f32 * (1.0 / Self::BULGE_STEPS),
            skew: (((word << 13) as i32) >> 22) as f32 * (1.0 / Self::SKEW_STEPS),
            by_v: word & Self::BY_V != 0,
            half_width: if width == 255 {
                f32::INFINITY
            } else {
                f32::from_bits((width + Self::WIDTH_BIAS) << 20)
            },
        }
    }
}

/// Words of `trim_nodes`; see the head of the module.
pub mod trim_word {
    /// Words before the cells.
    pub const HEADER_WORDS: usize = 2;
    /// log2 of the number of cells along an axis at most.
    pub const MAX_GRID_LEVEL: u32 = 8;
    /// Steps of split planes across the window.
    pub const PLANE_STEPS: u32 = 1 << 14;
    /// A distance that does not fit.
    pub const FAR: u32 = 0xffff;
    /// The greatest number of a face's segment.
    pub const MAX_SEGMENT: u32 = (1 << 26) - 1;
    /// The greatest offset of a list or a tree.
    pub const MAX_OFFSET: u32 = (1 << 29) - 1;
    /// The bit of a root's first word that says that its cells are short.
    pub const SHORT: u32 = 1 << 8;
    /// The greatest number of a face's segment in a short cell.
    pub const MAX_SHORT_SEGMENT: u32 = (1 << 11) - 1;
    /// The greatest offset of a list or a tree in a short cell.
    pub const MAX_SHORT_OFFSET: u32 = (1 << 14) - 1;

    /// An unpacked word.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum TrimWord {
        /// A split.
        Inner {
            /// 0: u, 1: v.
            axis: u32,
            /// In steps of 1 / [`PLANE_STEPS`] of the window.
            plane: u32,
            /// Words from this one to the right child, or [`FAR`].
            right: u32,
        },
        /// A cell without segments.
        Uniform {
            /// Its state.
            inside: bool,
        },
        /// A cell with one segment.
        One {
            /// State that counts from.
            corner: bool,
            /// See the head of the module.
            toggles: u32,
            /// Of the face.
            segment: u32,
        },
        /// A cell with a list of segments.
        List {
            /// From the end of the cells.
            offset: u32,
        },
        /// A cell with a tree of its own.
        Tree {
            /// From the end of the cells.
            offset: u32,
        },
    }

    /// The word of a cell or node; fields beyond their bits are the caller's mistake.
    pub const fn pack(word: TrimWord) -> u32 {
        match word {
            TrimWord::Inner { axis, plane, right } => {
                assert!(axis < 2 && plane < PLANE_STEPS && right <= FAR);
                axis << 30 | plane << 16 | right
            }
            TrimWord::Uniform { inside } => 0b100 << 29 | (inside as u32) << 28,
            TrimWord::One { corner, toggles, segment } => {
                assert!(toggles < 4 && segment <= MAX_SEGMENT);
                0b101 << 29 | (corner as u32) << 28 | toggles << 26 | segment
            }
            TrimWord::List { offset } => {
                assert!(offset <= MAX_OFFSET);
                0b110 << 29 | offset
            }
            TrimWord::Tree { offset } => {
                assert!(offset <= MAX_OFFSET);
                0b111 << 29 | offset
            }
        }
    }

    /// The cell or node of a word.
    #[inline(always)]
    pub const fn unpack(word: u32) -> TrimWord {
        match word >> 29 {
            0b100 => TrimWord::Uniform { inside: word >> 28 & 1 == 1 },
            0b101 => TrimWord::One {
                corner: word >> 28 & 1 == 1,
                toggles: word >> 26 & 3,
                segment: word & MAX_SEGMENT,
            },
            0b110 => TrimWord::List { offset: word & MAX_OFFSET },
            0b111 => TrimWord::Tree { offset: word & MAX_OFFSET },
            _ => TrimWord::Inner { axis: word >> 30 & 1, plane: word >> 16 & 0x3fff, right: word & FAR },
        }
    }

    /// The state of a cell without segments: what [`unpack`] would say, of which most queries need no more.
    #[inline(always)]
    pub const fn uniform(word: u32) -> Option<bool> {
        if word >= 0b100 << 29 && word < 0b101 << 29 { Some(word & 1 << 28 != 0) } else { None }
    }

    /// The offset of a tree.
    #[inline(always)]
    pub const fn tree(word: u32) -> Option<u32> {
        if word >= 0b111 << 29 { Some(word & MAX_OFFSET) } else { None }
    }

    /// The short form of a cell, if it has one.
    pub const fn shorten(word: u32) -> Option<u32> {
        let kind = (word >> 29 & 3) << 14;
        match unpack(word) {
            TrimWord::Inner { .. } => None,
            TrimWord::Uniform { inside } => Some(kind | (inside as u32) << 13),
            TrimWord::One { corner, toggles, segment } if segment <= MAX_SHORT_SEGMENT => {
                Some(kind | (corner as u32) << 13 | toggles << 11 | segment)
            }
            TrimWord::List { offset } | TrimWord::Tree { offset } if offset <= MAX_SHORT_OFFSET => {
                Some(kind | offset)
            }
            _ => None,
        }
    }

    /// The word of a short cell.
    #[inline(always)]
    pub const fn lengthen(short: u32) -> u32 {
        let kind = 0b100 << 29 | short >> 14 << 29;
        let is_segment = short < 0b10 << 14;
        kind | if is_segment {
            (short & 0x3800) << 15 | short & MAX_SHORT_SEGMENT
        } else {
            short & MAX_SHORT_OFFSET
        }
    }

    /// Words from a root to the end of its cells, from which offsets count, by its first word.
    #[inline(always)]
    pub const fn beyond_cells(grid: u32) -> usize {
        let [along_u, along_v] = grid_levels(grid);
        let cells = 1_usize << (along_u + along_v);
        HEADER_WORDS + if grid & SHORT != 0 { cells.div_ceil(2) } else { cells }
    }

    /// The word of a cell, by the first word of the root and its index in `cells`.
    pub fn cell_word(cells: &[u32], grid: u32, index: usize) -> u32 {
        if grid & SHORT != 0 { lengthen(short_cell(cells, index)) } else { cells[index] }
    }

    /// A short cell by its index.
    #[inline(always)]
    pub fn short_cell(cells: &[u32], index: usize) -> u32 {
        let halves: &[u16] = bytemuck::cast_slice(cells);
        halves[if cfg!(target_endian = "big") { index ^ 1 } else { index }].into()
    }

    /// The state of a short cell without segments.
    #[inline(always)]
    pub const fn short_uniform(short: u32) -> Option<bool> {
        if short < 1 << 14 { Some(short & 1 << 13 != 0) } else { None }
    }

    /// Where a plane stands.
    #[inline(always)]
    pub fn position(plane: u32) -> f32 {
        plane as f32 * (1.0 / PLANE_STEPS as f32)
    }

    /// The first word of a list.
    pub const fn list_head(corner: bool, count: u32) -> u32 {
        assert!(count < 1 << 31);
        (corner as u32) << 31 | count
    }

    /// A list's word of a segment.
    pub const fn list_entry(toggles: u32, segment: u32) -> u32 {
        assert!(toggles < 4 && segment <= MAX_SEGMENT);
        toggles << 30 | segment
    }

    /// The first word of a root.
    pub const fn grid(levels: [u32; 2]) -> u32 {
        assert!(levels[0] <= MAX_GRID_LEVEL && levels[1] <= MAX_GRID_LEVEL);
        levels[0] | levels[1] << 4
    }

    /// `2^level`, from the bits of its exponent.
    #[inline(always)]
    pub const fn grid_cells(level: u32) -> f32 {
        f32::from_bits((127 + level) << 23)
    }

    /// log2 of the number of cells along u and v.
    #[inline(always)]
    pub const fn grid_levels(word: u32) -> [u32; 2] {
        [word & 15, word >> 4 & 15]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_keep_their_numbers_within_a_step_and_never_narrow() {
        for i in -40..=40 {
            let x = i as f32 / 40.0;
            for exponent in -24..2 {
                let width = 1.37 * (exponent as f32).exp2();
                let band = Band { bulge: x, skew: -x, by_v: i % 2 == 0, half_width: width };
                let back = Band::unpack(band.pack());
                assert!((back.bulge - x).abs() <= 0.5 / Band::BULGE_STEPS + 1e-7);
                assert!((back.skew + x).abs() <= 0.5 / Band::SKEW_STEPS + 1e-7, "{band:?} {back:?}");
                assert!(back.half_width >= width && back.half_width <= (1.126 * width).max(1.2e-7));
                assert_eq!(back.by_v, band.by_v);
            }
        }
        for wide in [f32::NAN, f32::INFINITY, 1e30] {
            let band = Band { half_width: wide, ..Band::NONE };
            assert_eq!(Band::unpack(band.pack()).half_width, f32::INFINITY);
        }
    }

    #[test]
    fn words_come_back() {
        use trim_word::{TrimWord, pack, unpack};
        for word in [
            TrimWord::Inner { axis: 1, plane: 16383, right: 77 },
            TrimWord::Uniform { inside: true },
            TrimWord::One { corner: true, toggles: 2, segment: trim_word::MAX_SEGMENT },
            TrimWord::List { offset: 12 },
            TrimWord::Tree { offset: trim_word::MAX_OFFSET },
        ] {
            assert_eq!(unpack(pack(word)), word);
        }
        for word in [
            TrimWord::Uniform { inside: true },
            TrimWord::Uniform { inside: false },
            TrimWord::One { corner: true, toggles: 3, segment: trim_word::MAX_SHORT_SEGMENT },
            TrimWord::One { corner: false, toggles: 1, segment: 7 },
            TrimWord::List { offset: trim_word::MAX_SHORT_OFFSET },
            TrimWord::Tree { offset: 12 },
        ] {
            let short = trim_word::shorten(pack(word)).expect("small numbers");
            assert!(short < 1 << 16);
            assert_eq!(unpack(trim_word::lengthen(short)), word);
        }
        let long = [
            TrimWord::One { corner: true, toggles: 0, segment: trim_word::MAX_SHORT_SEGMENT + 1 },
            TrimWord::List { offset: trim_word::MAX_SHORT_OFFSET + 1 },
            TrimWord::Inner { axis: 0, plane: 1, right: 2 },
        ];
        assert!(long.iter().all(|&word| trim_word::shorten(pack(word)).is_none()));
    }
}
