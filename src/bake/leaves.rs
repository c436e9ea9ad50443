//! The leaves of one net: dyadic sub-domains, halved until their slabs fit, without those outside the trim.
//!
//! Always the leaf with the greatest distortion is halved next, so that a net that runs into its budget has spent it where it helps most. Ties
//! go to the older leaf, which makes the order a function of the net alone.

use super::region::{Rectangle, Region};
use super::slab::{self, Fit};
use super::trim_query;
use super::trim_tree::TrimTree;
use crate::geometry::BezierPatch;
use glam::DVec2;
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Halvings along one axis; leaf indices have 12 bits.
const MAX_LEVEL: u8 = 12;

/// Leaves of one net at most and, where a scene's nets are many, at least.
const MOST_LEAVES: [usize; 2] = [16, 4096];

/// Control points that the leaves of all nets may have together, each of its own patch: some seconds of work.
const MOST_POINTS: usize = 1 << 28;

/// Halvings towards a side that is short beside the one across from it, or one point: whatever its distortion, a leaf that reaches there has few rays whose
/// root is certified to be its only one, and the fewer rays meet it the better.
const TAPER_LEVEL: u8 = 3;

/// Leaves smaller than this share of the face are not split: they are at poles.
const MIN_SIZE: f64 = 1.0 / 4096.0;

/// Rectangles grow by this in normalised parameters before they are compared with trims: a few f32 roundings of numbers up to 1.
const MARGIN: f64 = 4e-7;

/// A part of a leaf thinner than this share of it does not count.
const THIN: f64 = 1e-6;

/// How a sub-domain lies to the trims.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Side {
    /// All of it is inside.
    Inside,
    /// Some may be inside.
    Mixed,
    /// None is inside.
    Outside,
}

/// A leaf.
#[derive(Debug)]
pub(super) struct Leaf {
    /// Control points in face space.
    pub patch: BezierPatch,
    /// How it fits its slab.
    pub fit: Fit,
    /// Along u and v: the sub-domain is `[index, index + 1] / 2^level`.
    pub level: [u8; 2],
    /// See `level`.
    pub index: [u32; 2],
    /// Not [`Side::Outside`].
    pub side: Side,
    views: Vec<View>,
    age: usize,
}

/// One period's image of a sub-domain in the window, and the pieces that may touch it.
#[derive(Debug, Clone)]
pub(super) struct View {
    shift: DVec2,
    pieces: Vec<u32>,
}

/// What a net's leaves are compared with.
pub(super) struct Trim<'a> {
    /// Pieces.
    pub region: &'a Region,
    /// Their tree.
    pub tree: &'a TrimTree,
    /// Periods in normalised parameters; 0 where not periodic.
    pub period: DVec2,
}

/// How far leaves are divided.
pub(super) struct Fineness {
    /// The distortion below which they are not.
    pub distortion: f64,
    /// The size from which it has to be half of that, millimetres. Of a picture's rays so many meet such a leaf that it pays.
    pub large: f64,
}

impl Fineness {
    /// The distortion below which a leaf of so many millimetres is not divided.
    fn distortion(&self, size: f64) -> f64 {
        if size > self.large { 0.5 * self.distortion } else { self.distortion }
    }
}

/// A net in normalised parameters.
pub(super) struct Domain {
    /// Least u and v.
    pub low: DVec2,
    /// Extents.
    pub size: DVec2,
}

impl PartialEq for Leaf {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Leaf {}
impl PartialOrd for Leaf {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Leaf {
    fn cmp(&self, other: &Self) -> Ordering {
        self.fit.distortion.total_cmp(&other.fit.distortion).then(other.age.cmp(&self.age))
    }
}

/// How many leaves each net may have in a scene whose nets have `points` control points together.
pub(super) fn most_leaves(points: usize) -> usize {
    (MOST_POINTS / points.max(1)).clamp(MOST_LEAVES[0], MOST_LEAVES[1])
}

/// The leaves of `patch` in order of their sub-domains, and whether any part of the net was left out; `views` are those of the net
/// or of a strip around it.
pub(super) fn leaves(
    patch: BezierPatch,
    domain: &Domain,
    trim: &Trim<'_>,
    views: &[View],
    fineness: &Fineness,
    max_leaves: usize,
    face_size: f64,
) -> (Vec<Leaf>, bool) {
    let mut splitting = BinaryHeap::new();
    let mut done = Vec::new();
    let mut left_out = false;
    let mut age = 0;
    let (side, views) = classify(domain.low, domain.size, trim, views.to_vec());
    match side {
        Side::Outside => return (done, true),
        _ => {
            let fit = slab::fit(&patch);
            splitting.push(Leaf { patch, fit, level: [0; 2], index: [0; 2], side, views, age });
        }
    }
    while let Some(leaf) = splitting.pop() {
        let taper = (0..2).find(|&axis| leaf.fit.tapers[axis] && leaf.level[axis] < TAPER_LEVEL);
        let fits = leaf.fit.distortion <= fineness.distortion(leaf.fit.size) && taper.is_none()
            || leaf.fit.size <= face_size * MIN_SIZE;
        let axis = match taper {
            Some(axis) => axis,
            None if leaf.level[leaf.fit.split_axis] < MAX_LEVEL => leaf.fit.split_axis,
            None => 1 - leaf.fit.split_axis,
        };
        let is_full = splitting.len() + done.len() + 2 > max_leaves;
        if fits || is_full || leaf.level[axis] >= MAX_LEVEL {
            done.push(leaf);
            continue;
        }
        for half in 0..2 {
            let mut ranges = [[0.0, 1.0]; 2];
            ranges[axis] = [0.5 * f64::from(half), 0.5 * f64::from(half) + 0.5];
            let mut level = leaf.level;
            let mut index = leaf.index;
            level[axis] += 1;
            index[axis] = 2 * index[axis] + half;
            let scale = DVec2::new(0.5f64.powi(level[0].into()), 0.5f64.powi(level[1].into()));
            let size = domain.size * scale;
            let low = domain.low + DVec2::new(f64::from(index[0]), f64::from(index[1])) * size;
            let (side, views) = classify(low, size, trim, leaf.views.clone());
            if side == Side::Outside {
                left_out = true;
                continue;
            }
            let patch = leaf.patch.piece(ranges[0], ranges[1]);
            let fit = slab::fit(&patch);
            age += 1;
            splitting.push(Leaf { patch, fit, level, index, side, views, age });
        }
    }
    done.sort_by_key(position);
    (done, left_out)
}

/// First u and v of a leaf in steps of the finest level.
fn position(leaf: &Leaf) -> [u32; 2] {
    [0, 1].map(|k| leaf.index[k] << (MAX_LEVEL - leaf.level[k]))
}

/// All images of a net, or of a strip of nets, in the window.
///
/// Faces can have many nets and many pieces: those of one strip are looked for once, so that not every net asks every piece.
pub(super) fn views(domain: &Domain, trim: &Trim<'_>) -> Vec<View> {
    let on_border = |piece: &super::region::Piece| {
        (0..2).any(|axis| piece.lies_at(axis, 0.0) || piece.lies_at(axis, 1.0))
    };
    let pieces: Vec<u32> = (0..trim.region.pieces.len() as u32)
        .filter(|&piece| !on_border(&trim.region.pieces[piece as usize]))
        .collect();
    let shifts = |axis: usize| -> Vec<f64> {
        let period = trim.period[axis];
        if !(period > 0.0) {
            return vec![0.0];
        }
        let first = (-(domain.low[axis] + domain.size[axis]) / period).ceil();
        let last = ((1.0 - domain.low[axis]) / period).floor();
        // A window is about one period wide, so that few images meet it.
        (0..4).map(|k| first + f64::from(k)).filter(|&k| k <= last).map(|k| k * period).collect()
    };
    let across = shifts(1);
    shifts(0)
        .iter()
        .flat_map(|&u| across.iter().map(move |&v| DVec2::new(u, v)))
        .map(|shift| {
            let grown = grown(domain.low + shift, domain.low + domain.size + shift);
            let touching = pieces.iter().copied();
            let touching = touching.filter(|&p| trim.region.touches(&trim.region.pieces[p as usize], &grown));
            View { shift, pieces: touching.collect() }
        })
        .collect()
}

fn grown(from: DVec2, to: DVec2) -> Rectangle {
    Rectangle { low: (from - MARGIN).as_vec2().to_array(), high: (to + MARGIN).as_vec2().to_array() }
}

/// How a sub-domain lies to the trims, and the views that still matter in it.
fn classify(low: DVec2, size: DVec2, trim: &Trim<'_>, views: Vec<View>) -> (Side, Vec<View>) {
    let mut kept = Vec::new();
    let mut covered = 0.0;
    let (mut any_inside, mut any_outside, mut any_touched) = (false, false, false);
    for mut view in views {
        let from = (low + view.shift).max(DVec2::ZERO);
        let to = (low + size + view.shift).min(DVec2::ONE);
        if !(to - from).cmpgt(size * THIN).all() {
            continue;
        }
        let grown = grown(from, to);
        view.pieces.retain(|&piece| trim.region.touches(&trim.region.pieces[piece as usize], &grown));
        if view.pieces.is_empty() {
            let middle = ((from + to) * 0.5).as_vec2().to_array();
            let is_inside = trim_query::inside(trim.tree, middle);
            any_inside |= is_inside;
            any_outside |= !is_inside;
            covered += (to - from).element_product();
        } else {
            any_touched = true;
        }
        kept.push(view);
    }
    let is_covered = covered >= size.element_product() * (1.0 - 4.0 * THIN);
    let side = if kept.is_empty() || !any_touched && !any_inside {
        Side::Outside
    } else if !any_touched && !any_outside && is_covered {
        Side::Inside
    } else {
        Side::Mixed
    };
    (side, kept)
}
