//! Words of `trim_nodes` where a scene's trims are searched by a method of the study ([`TrimMethod`](super::TrimMethod) 1 to 29).
//!
//! A face's words follow those of the face before; `Face::trim_root` is the first. Places count from there, in words. Numbers are f32 bits.
//!
//! ```text
//! list    first control point of the face, count, elements
//! slabs   first control point, n, v_0 … v_n, places of the n slabs; slab: k, u_0 … u_k, k intervals; lists of intervals; elements
//!         interval  [31] curves left of it are odd in number  [30:24] count  [23:0] place of the element (count 1), of the list of elements'
//!                   places (count 2 to 126), or of the count and the list (127)
//! kd      first control point, low u, low v, high u, high v, nodes, lists of leaves, curvesets (kd on curvesets), elements
//!         inner     plane; [31:30] axis  [29:0] words to the right child (the left child is next)
//!         leaf      [31:30] 2  [29] parity  [28:0] count, after a word: the reference (count 1), or the place of the list of references
//!         reference [31] low end at or left of the leaf's left edge  [30] high end too  [29:0] place of the element or curveset
//! element low u, low v, high u, high v, first control point (from the face's first), degree, slab, 0
//! set     low u, low v, high u, high v, place of its first element, count, slab, 0
//! ```
//! An element is a rational Bézier curve, monotone in u and in v, from its low end (the lesser v; of equal ones the lesser u) to its high end. A
//! horizontal one has degree 0 and no control points: nothing crosses it sideways, it is there for its reference's bits. The elements of a set follow each
//! other upwards.
//!
//! A point is inside where an odd number of elements pass left of it. In a leaf of a kd-tree: where its parity, flipped once for each reference with
//! `passes left != (v >= low v, if bit 31) != (v >= high v, if bit 30)`, is 1. Why: walk from the leaf's lower left corner up just inside its left
//! edge, then right to the point. An element at p = (u₀, v) on the edge changes "passes left of p" where the edge crosses it and at each of its ends left of
//! the edge; only the former are crossings of the walk, and the bits take the latter out.

/// Words of an element and of a curveset.
pub const RECORD_WORDS: usize = 8;
/// Words before the nodes of a kd-tree.
pub const KD_HEADER: usize = 5;
/// Bit of an interval's word: the curves left of it are odd in number.
pub const ODD_BIT: u32 = 1 << 31;
/// An interval's count that does not fit.
pub const MANY_CURVES: u32 = 127;
/// An interval's place stays below this.
pub const PLACES: u32 = 1 << 24;
/// The kind of a kd leaf, in the upper two bits.
pub const STUDY_LEAF: u32 = 2;
/// Bit of a leaf's second word: its parity.
pub const PARITY_BIT: u32 = 1 << 29;
/// Bit of a reference: the low end lies at or left of the leaf's left edge.
pub const LOW_IS_LEFT: u32 = 1 << 31;
/// Bit of a reference: the high end does.
pub const HIGH_IS_LEFT: u32 = 1 << 30;
/// Levels of a kd-tree at most.
pub const MAX_STUDY_DEPTH: usize = 48;
/// The greatest f32 below 1: points on the upper borders of the parameter square belong to what lies before them.
pub const BEFORE_ONE: f32 = 1.0 - f32::EPSILON / 2.0;

/// Steps of a slab's distances across the square of the longer side; two of the 2¹⁵ are left for rounding outward.
pub const SLAB_STEPS: f32 = 32_765.0;

/// Mask of a distance in steps.
pub const SLAB_MASK: u32 = 0x7fff;

/// The slab of a box whose diagonal, from the low to the high end, is `(dx, dy)`: with `d = x · dy − y · dx` for a point (x, y) from the low end and
/// steps of `max(|dx|, dy)² / SLAB_STEPS`, the curve has `−left <= d <= right`, rounded up. The orientation of the diagonal, a bit in the paper, is that
/// of the ends.
pub const fn pack_slab(left: u32, right: u32) -> u32 {
    left << 15 | right
}

/// Steps to the left and to the right.
pub const fn unpack_slab(word: u32) -> [u32; 2] {
    [word >> 15 & SLAB_MASK, word & SLAB_MASK]
}
