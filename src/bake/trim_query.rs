//! Whether a point is inside a face's trims: the query of the kernels, in f64 arithmetic over the f32 numbers, without bands.

use super::region::parameter_at;
use super::trim_tree::TrimTree;
use crate::geometry::{Homogeneous, Homogeneous2};
use crate::scene::TrimSegment;
use crate::scene::trim_word::{
    self, FAR, HEADER_WORDS, MAX_SEGMENT, TrimWord, grid_levels, position, unpack,
};

/// The state of `point`, normalised and in [0, 1]².
pub(super) fn inside(tree: &TrimTree, point: [f32; 2]) -> bool {
    match cell(&tree.words, point) {
        TrimWord::Uniform { inside } => inside,
        TrimWord::One { corner, toggles, segment } => corner ^ flips(tree, toggles, segment, point),
        TrimWord::List { offset } => {
            let at = trim_word::beyond_cells(tree.words[0]) + offset as usize;
            let head = tree.words[at];
            let entries = &tree.words[at + 1..][..(head & !(1 << 31)) as usize];
            entries.iter().fold(head >> 31 == 1, |state, entry| {
                state ^ flips(tree, entry >> 30, entry & MAX_SEGMENT, point)
            })
        }
        TrimWord::Inner { .. } | TrimWord::Tree { .. } => unreachable!("walks end at leaves"),
    }
}

fn cell(words: &[u32], point: [f32; 2]) -> TrimWord {
    let levels = grid_levels(words[0]);
    let index = [0, 1].map(|axis| {
        let cells = 1_u32 << levels[axis];
        ((point[axis] * cells as f32) as u32).min(cells - 1) as usize
    });
    let word =
        unpack(trim_word::cell_word(&words[HEADER_WORDS..], words[0], index[1] << levels[0] | index[0]));
    let TrimWord::Tree { offset } = word else { return word };
    let mut at = trim_word::beyond_cells(words[0]) + offset as usize;
    loop {
        let TrimWord::Inner { axis, plane, right } = unpack(words[at]) else { return unpack(words[at]) };
        at += match (point[axis as usize] >= position(plane), right == FAR) {
            (false, false) => 1,
            (false, true) => 2,
            (true, false) => right as usize,
            (true, true) => words[at + 1] as usize,
        };
    }
}

fn flips(tree: &TrimTree, toggles: u32, segment: u32, point: [f32; 2]) -> bool {
    let segment = &tree.segments[segment as usize];
    let passed = |bit: u32, end: [f32; 2]| toggles & bit != 0 && point[1] >= end[1];
    crosses(segment, &tree.words, point) ^ passed(1, segment.low) ^ passed(2, segment.high)
}

fn crosses(segment: &TrimSegment, words: &[u32], point: [f32; 2]) -> bool {
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
    if segment.degree() == 1 {
        return low[0] + (v - low[1]) / (high[1] - low[1]) * (high[0] - low[0]) <= u;
    }
    let control = control_points(segment, words);
    let range = if segment.curve & TrimSegment::FALLS != 0 { [1.0, 0.0] } else { [0.0, 1.0] };
    let t = parameter_at(&control, 1, v, range, true);
    de_casteljau(control, t).x <= u
}

/// Control points, mostly few.
type Control = smallvec::SmallVec<[Homogeneous2; 8]>;

fn control_points(segment: &TrimSegment, words: &[u32]) -> Control {
    let degree = segment.degree() as usize;
    let is_rational = segment.curve & TrimSegment::RATIONAL != 0;
    let words = &words[(segment.curve & TrimSegment::OFFSET_MASK) as usize..];
    let number = |place: usize| f64::from(f32::from_bits(words[place]));
    let point = |index: usize| {
        let place = if !is_rational { 2 * index } else { (3 * index).saturating_sub(1) };
        let weight = if is_rational && index > 0 && index < degree { number(place + 2) } else { 1.0 };
        Homogeneous2::new(number(place), number(place + 1), weight)
    };
    (0..=degree).map(point).collect()
}

fn de_casteljau(mut row: Control, t: f64) -> glam::DVec2 {
    for level in (1..row.len()).rev() {
        for i in 0..level {
            row[i] = row[i] * (1.0 - t) + row[i + 1] * t;
        }
    }
    row[0].point()
}
