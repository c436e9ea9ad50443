//! Whether a point is inside a trim tree: the query of the kernels, in f64 arithmetic over the tree's f32 numbers.

use super::region::parameter_at;
use super::trim_tree::{MAX_DEPTH, TrimTree};
use crate::geometry::{Homogeneous, Homogeneous2};
use crate::scene::TrimSegment;
use crate::scene::trim_node::{self, TrimNode, child_range, split_position};

/// The state of `point`, normalised and in [0, 1]².
pub(super) fn inside(tree: &TrimTree, point: [f32; 2]) -> bool {
    let mut at = 0;
    let mut low = [0.0f32; 2];
    let mut size = [1.0f32; 2];
    for _ in 0..=MAX_DEPTH {
        match trim_node::unpack(tree.nodes[at]) {
            TrimNode::Inner { axis, plane, right } => {
                let axis = axis as usize;
                let position = split_position(low[axis], size[axis], plane);
                let far = right == trim_node::FAR;
                let is_right = point[axis] >= position;
                (low[axis], size[axis]) = child_range(low[axis], size[axis], position, is_right);
                at += match (is_right, far) {
                    (false, false) => 1,
                    (false, true) => 2,
                    (true, false) => right as usize,
                    (true, true) => tree.nodes[at + 1] as usize,
                };
            }
            TrimNode::Leaf { inside, count, first } => {
                let count = if count == trim_node::MANY { tree.nodes[at + 1] } else { count } as usize;
                let segments = &tree.segments[first as usize..first as usize + count];
                return segments.iter().fold(inside, |state, segment| {
                    state ^ (crosses(segment, &tree.points, point) != on_left_edge(segment, point[1]))
                });
            }
        }
    }
    unreachable!("a tree is not deeper than its builder allows")
}

fn on_left_edge(segment: &TrimSegment, v: f32) -> bool {
    let passed = |bit: u32, end: [f32; 2]| segment.flags & bit != 0 && v >= end[1];
    passed(TrimSegment::LOW_ON_LEFT_EDGE, segment.low) != passed(TrimSegment::HIGH_ON_LEFT_EDGE, segment.high)
}

fn crosses(segment: &TrimSegment, points: &[Homogeneous2], point: [f32; 2]) -> bool {
    if !(segment.low[1] <= point[1] && point[1] < segment.high[1]) {
        return false;
    }
    let u = f64::from(point[0]);
    let v = f64::from(point[1]);
    let low = segment.low.map(f64::from);
    let high = segment.high.map(f64::from);
    if u >= low[0].max(high[0]) {
        return true;
    }
    if u < low[0].min(high[0]) {
        return false;
    }
    let degree = (segment.flags & TrimSegment::DEGREE_MASK) as usize;
    if degree == 1 {
        return low[0] + (v - low[1]) / (high[1] - low[1]) * (high[0] - low[0]) <= u;
    }
    let first = segment.curve as usize;
    let control = &points[first..=first + degree];
    let range = [f64::from(segment.t_low), f64::from(segment.t_high)];
    let t = parameter_at(control, 1, v, range, true);
    de_casteljau(control, t).x <= u
}

fn de_casteljau(control: &[Homogeneous2], t: f64) -> glam::DVec2 {
    let mut row: smallvec::SmallVec<[Homogeneous2; 8]> = control.into();
    for level in (1..row.len()).rev() {
        for i in 0..level {
            row[i] = row[i] * (1.0 - t) + row[i + 1] * t;
        }
    }
    row[0].point()
}
