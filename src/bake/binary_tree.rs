//! Binary trees over boxes, from the top down by binned surface-area heuristic (Wald 2007).
//!
//! obvhs builds from the bottom up by merging nearest neighbours, which takes the square of the time, and makes chains, where neighbours are equally
//! near: things in a row, boxes in each other, many copies of one box. CAD is full of those. From the top down both are bounded: after
//! [`BINNED_LEVELS`] levels each split halves the number of boxes.

use super::bvh::NarrowBox;
use glam::Vec3A;
use obvhs::aabb::Aabb as Bounds;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::node::Bvh2Node;

/// Levels that may be split where the heuristic says, however unevenly.
const BINNED_LEVELS: usize = 32;

/// Intervals of an axis between which a split is looked for.
const BINS: usize = 16;

/// A range of boxes that is to become the node `index`.
struct Open {
    index: usize,
    first: usize,
    end: usize,
    level: usize,
}

/// The tree over at least one box, one box a leaf; `balanced`: each split halves the number of boxes.
pub(super) fn build(boxes: &[NarrowBox], balanced: bool) -> Bvh2 {
    let bounds: Vec<Bounds> =
        boxes.iter().map(|b| Bounds::new(Vec3A::from_array(b[0]), Vec3A::from_array(b[1]))).collect();
    let centers: Vec<Vec3A> = bounds.iter().map(|b| (b.min + b.max) * 0.5).collect();
    let mut order: Vec<u32> = (0..boxes.len() as u32).collect();
    let mut nodes = vec![Bvh2Node::default()];
    let mut open = vec![Open { index: 0, first: 0, end: boxes.len(), level: 0 }];
    let mut deepest = 0;
    while let Some(Open { index, first, end, level }) = open.pop() {
        deepest = deepest.max(level);
        let range = &mut order[first..end];
        let own = union(range.iter().map(|&i| bounds[i as usize]));
        if range.len() == 1 {
            nodes[index] = Bvh2Node::new(own, 1, first as u32);
            continue;
        }
        let binned = !balanced && level < BINNED_LEVELS;
        let left = binned.then(|| split_by_cost(range, &bounds, &centers)).flatten();
        let middle = first + left.unwrap_or_else(|| split_in_halves(range, &centers));
        let children = nodes.len();
        nodes[index] = Bvh2Node::new(own, 0, children as u32);
        nodes.extend([Bvh2Node::default(); 2]);
        open.push(Open { index: children, first, end: middle, level: level + 1 });
        open.push(Open { index: children + 1, first: middle, end, level: level + 1 });
    }
    let max_depth = (deepest + 1).max(Bvh2::default().max_depth);
    Bvh2 { nodes, primitive_indices: order, max_depth, ..Bvh2::default() }
}

fn union(boxes: impl Iterator<Item = Bounds>) -> Bounds {
    boxes.fold(Bounds::empty(), |all, one| all.union(&one))
}

/// Boxes in an interval of an axis.
#[derive(Clone, Copy)]
struct Bin {
    bounds: Bounds,
    count: usize,
}

impl Bin {
    const EMPTY: Self = Self { bounds: Bounds::INVALID, count: 0 };

    fn joined(self, other: Self) -> Self {
        Self { bounds: self.bounds.union(&other.bounds), count: self.count + other.count }
    }

    fn cost(self) -> f32 {
        if self.count == 0 { 0.0 } else { self.bounds.half_area() * self.count as f32 }
    }
}

/// Sorts the range into the two sides of the cheapest split and returns how many are on the left; `None` where all centres are in one place.
fn split_by_cost(range: &mut [u32], bounds: &[Bounds], centers: &[Vec3A]) -> Option<usize> {
    let low = range.iter().fold(Vec3A::INFINITY, |low, &i| low.min(centers[i as usize]));
    let high = range.iter().fold(Vec3A::NEG_INFINITY, |high, &i| high.max(centers[i as usize]));
    let scale = Vec3A::splat(BINS as f32 * 0.999_999) / (high - low);
    let bin_of = |i: u32, axis: usize| ((centers[i as usize][axis] - low[axis]) * scale[axis]) as usize;
    let mut best: Option<(f32, usize, usize)> = None;
    for axis in (0..3).filter(|&axis| scale[axis].is_finite()) {
        let mut bins = [Bin::EMPTY; BINS];
        for &i in range.iter() {
            let bin = &mut bins[bin_of(i, axis).min(BINS - 1)];
            *bin = bin.joined(Bin { bounds: bounds[i as usize], count: 1 });
        }
        let mut right = [Bin::EMPTY; BINS];
        for at in (1..BINS).rev() {
            right[at - 1] = right[at].joined(bins[at]);
        }
        let mut left = Bin::EMPTY;
        for at in 0..BINS - 1 {
            left = left.joined(bins[at]);
            if left.count == 0 || right[at].count == 0 {
                continue;
            }
            let cost = left.cost() + right[at].cost();
            if best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, axis, at));
            }
        }
    }
    let (_, axis, last) = best?;
    let is_left = |i: u32| bin_of(i, axis).min(BINS - 1) <= last;
    // Stable, so that the tree does not depend on how it is sorted.
    let (left, right): (Vec<u32>, Vec<u32>) = range.iter().partition(|&&i| is_left(i));
    range[..left.len()].copy_from_slice(&left);
    range[left.len()..].copy_from_slice(&right);
    Some(left.len())
}

/// Sorts the range into two halves along the axis on which the centres reach farthest.
fn split_in_halves(range: &mut [u32], centers: &[Vec3A]) -> usize {
    let low = range.iter().fold(Vec3A::INFINITY, |low, &i| low.min(centers[i as usize]));
    let high = range.iter().fold(Vec3A::NEG_INFINITY, |high, &i| high.max(centers[i as usize]));
    let axis = (high - low).max_position();
    let half = range.len() / 2;
    let key = |i: &u32| centers[*i as usize][axis];
    range.select_nth_unstable_by(half, |a, b| key(a).total_cmp(&key(b)).then(a.cmp(b)));
    half
}
