//! Trim queries of the study's methods: a ray is shot to the left, curves that it meets are counted. The words are those of [`crate::scene::trim_study`].
//!
//! An element counts when the point's height is in [low v, high v) and the curve passes left of the point. Its box decides most points, then its slab
//! where the method has parallel boxing (Sloup and Havran 2021, eqs. 6 and 7); what is left bisects the curve (Schollmeyer and Fröhlich 2009, section 3.2), lines
//! like any other, as both papers do. These methods know nothing of what is near.

use super::trim_curve::rational_point;
use super::vector::number;
use crate::numeric::Real;
use crate::scene::trim_study::{
    BEFORE_ONE, HIGH_IS_LEFT, KD_HEADER, LOW_IS_LEFT, MANY_CURVES, ODD_BIT, PARITY_BIT, PLACES, RECORD_WORDS,
    SLAB_STEPS, STUDY_LEAF, unpack_slab,
};
use crate::scene::{Scene, TrimMethod, TrimStructure};
use std::ops::AddAssign;

/// Bisections of a curve: enough for f64's 52 bits.
const MAX_BISECTIONS: usize = 52;

/// What trim queries cost, whatever the machine.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct TrimCounts {
    /// Points asked for.
    pub queries: u64,
    /// Records of the structure that were looked at: a list's header, a binary search over slabs, one over intervals, a kd node, leaves included.
    pub steps: u64,
    /// Exact odd-even tests: the point lies in a curve's box (and slab), so that its control points must be read.
    pub exact_tests: u64,
    /// Curve points evaluated in those.
    pub evaluations: u64,
}

impl AddAssign for TrimCounts {
    fn add_assign(&mut self, other: Self) {
        self.queries += other.queries;
        self.steps += other.steps;
        self.exact_tests += other.exact_tests;
        self.evaluations += other.evaluations;
    }
}

/// Whether `uv`, normalised and within the window, is inside the trims at `root`, in a scene of a method of the study.
pub fn study_inside<T: Real, const COUNT: bool>(
    scene: &Scene<'_>,
    method: TrimMethod,
    root: u32,
    uv: [T; 2],
    counts: &mut TrimCounts,
) -> bool {
    let root = root as usize;
    let mut query = Query::<T, COUNT> {
        words: &scene.trim_nodes[root..],
        points: scene.trim_points,
        uv: [uv[0].min(T::from_f32(BEFORE_ONE)), uv[1].min(T::from_f32(BEFORE_ONE))],
        has_boxing: method.has_boxing(),
        counts,
    };
    match method.structure() {
        TrimStructure::List => query.list(),
        TrimStructure::Slabs => query.slabs(),
        TrimStructure::KdCurves => query.kd_tree(false),
        TrimStructure::KdCurvesets | TrimStructure::KdCurvesetsSf19 => query.kd_tree(true),
        TrimStructure::Packed => false,
    }
}

struct Query<'a, T, const COUNT: bool> {
    /// The face's words and what follows.
    words: &'a [u32],
    points: &'a [[f32; 3]],
    uv: [T; 2],
    has_boxing: bool,
    counts: &'a mut TrimCounts,
}

impl<T: Real, const COUNT: bool> Query<'_, T, COUNT> {
    fn number_at(&self, place: usize) -> T {
        T::from_f32(f32::from_bits(self.words[place]))
    }

    fn count_step(&mut self) {
        if COUNT {
            self.counts.steps += 1;
        }
    }

    fn list(&mut self) -> bool {
        self.count_step();
        let count = self.words[1] as usize;
        (0..count).fold(false, |inside, index| inside ^ self.element(2 + index * RECORD_WORDS))
    }

    fn slabs(&mut self) -> bool {
        self.count_step();
        let slabs = self.words[1] as usize;
        let Some(slab) = self.interval_at(2, slabs, self.uv[1]) else { return false };
        let slab = self.words[2 + slabs + 1 + slab] as usize;
        let intervals = self.words[slab] as usize;
        self.count_step();
        let Some(interval) = self.interval_at(slab + 1, intervals, self.uv[0]) else { return false };
        let word = self.words[slab + 1 + intervals + 1 + interval];
        let mut inside = word & ODD_BIT != 0;
        let mut place = (word & (PLACES - 1)) as usize;
        let mut count = word >> 24 & MANY_CURVES;
        if count == 1 {
            return inside ^ self.element(place);
        }
        if count == MANY_CURVES {
            count = self.words[place];
            place += 1;
        }
        for at in place..place + count as usize {
            inside ^= self.element(self.words[at] as usize);
        }
        inside
    }

    /// Which of `count` intervals between `count + 1` ascending numbers holds `x`.
    fn interval_at(&self, place: usize, count: usize, x: T) -> Option<usize> {
        if count == 0 || x < self.number_at(place) || !(x < self.number_at(place + count)) {
            return None;
        }
        let (mut first, mut end) = (0, count);
        while end - first > 1 {
            let middle = (first + end) / 2;
            if x < self.number_at(place + middle) { end = middle } else { first = middle }
        }
        Some(first)
    }

    fn kd_tree(&mut self, has_sets: bool) -> bool {
        let [u, v] = self.uv;
        self.count_step();
        let is_in_box = u >= self.number_at(1)
            && v >= self.number_at(2)
            && u < self.number_at(3)
            && v < self.number_at(4);
        if !is_in_box {
            return false;
        }
        let mut node = KD_HEADER;
        loop {
            let word = self.words[node + 1];
            let kind = word >> 30;
            if kind >= STUDY_LEAF {
                return self.leaf(node, has_sets);
            }
            self.count_step();
            let is_left = self.uv[kind as usize] < self.number_at(node);
            node += if is_left { 2 } else { (word & (HIGH_IS_LEFT - 1)) as usize };
        }
    }

    fn leaf(&mut self, node: usize, has_sets: bool) -> bool {
        let word = self.words[node + 1];
        let mut inside = word & PARITY_BIT != 0;
        let count = (word & (PARITY_BIT - 1)) as usize;
        let first = if count == 1 { node } else { self.words[node] as usize };
        for at in first..first + count {
            let reference = self.words[at];
            let place = (reference & (HIGH_IS_LEFT - 1)) as usize;
            let passes = if has_sets { self.curveset(place) } else { self.element(place) };
            inside ^= passes ^ self.passes_ends(reference, place);
        }
        inside
    }

    /// Whether the way up the leaf's left edge passes an odd number of those ends that lie left of it.
    fn passes_ends(&self, reference: u32, place: usize) -> bool {
        let low = reference & LOW_IS_LEFT != 0 && self.uv[1] >= self.number_at(place + 1);
        let high = reference & HIGH_IS_LEFT != 0 && self.uv[1] >= self.number_at(place + 3);
        low != high
    }

    fn curveset(&mut self, place: usize) -> bool {
        if let Some(side) = self.side_of_box(place) {
            return side;
        }
        let first = self.words[place + 4] as usize;
        let count = self.words[place + 5] as usize;
        let (mut low, mut end) = (0, count);
        while end - low > 1 {
            let middle = (low + end) / 2;
            if self.uv[1] < self.number_at(first + middle * RECORD_WORDS + 1) {
                end = middle
            } else {
                low = middle
            }
        }
        self.element(first + low * RECORD_WORDS)
    }

    fn element(&mut self, place: usize) -> bool {
        if let Some(side) = self.side_of_box(place) {
            return side;
        }
        if COUNT {
            self.counts.exact_tests += 1;
        }
        self.bisect_element(place)
    }

    /// Whether the element or curveset at `place` passes left of the point, as far as its box and its slab tell.
    fn side_of_box(&self, place: usize) -> Option<bool> {
        let [u, v] = self.uv;
        let low = [self.number_at(place), self.number_at(place + 1)];
        let high = [self.number_at(place + 2), self.number_at(place + 3)];
        if !(v >= low[1] && v < high[1]) || u < low[0].min(high[0]) {
            return Some(false);
        }
        if u >= low[0].max(high[0]) {
            return Some(true);
        }
        if !self.has_boxing {
            return None;
        }
        let diagonal = [high[0] - low[0], high[1] - low[1]];
        let longer = diagonal[0].abs().max(diagonal[1]);
        let step = longer * longer * T::from_f32(1.0 / SLAB_STEPS);
        let distance = (u - low[0]) * diagonal[1] - (v - low[1]) * diagonal[0];
        let [left, right] = unpack_slab(self.words[place + 6]);
        let (left, right) = (T::from_f32(left as f32), T::from_f32(right as f32));
        if distance > right * step {
            return Some(true);
        }
        (distance < -(left * step)).then_some(false)
    }

    fn bisect_element(&mut self, place: usize) -> bool {
        let [u, v] = self.uv;
        let mut low = [self.number_at(place), self.number_at(place + 1)];
        let mut high = [self.number_at(place + 2), self.number_at(place + 3)];
        let curve = self.words[0] + self.words[place + 4];
        let degree = self.words[place + 5];
        let (mut t_low, mut t_high) = (T::ZERO, T::ONE);
        for _ in 0..MAX_BISECTIONS {
            let t = (t_low + t_high) * number(0.5);
            if t == t_low || t == t_high {
                break;
            }
            if COUNT {
                self.counts.evaluations += 1;
            }
            let at = self.element_point(curve, degree, t);
            if at[1] <= v {
                low = at;
                t_low = t;
            } else {
                high = at;
                t_high = t;
            }
            if u >= low[0].max(high[0]) {
                return true;
            }
            if u < low[0].min(high[0]) {
                return false;
            }
        }
        low[0] + (high[0] - low[0]) * ((v - low[1]) / (high[1] - low[1])) <= u
    }

    fn element_point(&self, first: u32, degree: u32, t: T) -> [T; 2] {
        rational_point(degree, t, |index| self.element_control(first + index))
    }

    #[inline(always)]
    fn element_control(&self, index: u32) -> [T; 3] {
        let [u, v, w] = self.points[index as usize];
        [T::from_f32(u), T::from_f32(v), T::from_f32(w)]
    }
}
