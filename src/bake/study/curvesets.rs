//! Curvesets: maximal chains of consecutive pieces of equal monotonicity (Schollmeyer and Fröhlich 2019), and where they are cut.
//!
//! Pieces parallel to an axis go with either monotonicity. A chain is one monotone curve, so that the parity of a whole chain follows from its two
//! ends as that of a piece does from its own.

use super::super::region::{Piece, Region};
use super::elements::is_horizontal;
use crate::scene::{TrimMethod, TrimStructure};

/// Pairs of boxes that cutting may compare: for a face of thousands of sets it stops early.
const MAX_COMPARISONS: usize = 1 << 26;

/// Cost of visiting the kd-tree for one more set (C_kd), where reading a box costs 1.
const VISIT_COST: f64 = 1.0 / 16.0;

/// Cost of an odd-even test (C_eval), where reading a box costs 1.
const EVALUATION_COST: f64 = 4.0;

/// A piece or a curveset.
#[derive(Debug, Clone)]
pub(super) struct Chain {
    /// Indices into the region's pieces, upwards.
    pub pieces: Vec<u32>,
    /// Ends of the pieces, upwards: one more.
    pub vertices: Vec<[f32; 2]>,
}

impl Chain {
    /// One piece.
    pub(super) fn single(index: usize, piece: &Piece) -> Self {
        Self { pieces: vec![index as u32], vertices: vec![piece.low, piece.high] }
    }

    /// The end with the lesser v; of equal ones that with the lesser u.
    pub(super) fn low(&self) -> [f32; 2] {
        self.vertices[0]
    }

    /// The other end.
    pub(super) fn high(&self) -> [f32; 2] {
        self.vertices[self.vertices.len() - 1]
    }

    /// Whether no ray to the left can cross it.
    pub(super) fn is_flat(&self) -> bool {
        self.low()[1] == self.high()[1]
    }

    /// The parts below and above vertex `at`.
    fn cut(&self, at: usize) -> [Self; 2] {
        let part = |first: usize, end: usize| Self {
            pieces: self.pieces[first..end].to_vec(),
            vertices: self.vertices[first..=end].to_vec(),
        };
        [part(0, at), part(at, self.pieces.len())]
    }

    fn bounds(&self, first: usize, end: usize) -> Bounds {
        Bounds::between(self.vertices[first], self.vertices[end])
    }
}

#[derive(Debug, Clone, Copy)]
struct Bounds {
    low: [f64; 2],
    high: [f64; 2],
}

impl Bounds {
    fn between(a: [f32; 2], b: [f32; 2]) -> Self {
        Self {
            low: [0, 1].map(|k| f64::from(a[k].min(b[k]))),
            high: [0, 1].map(|k| f64::from(a[k].max(b[k]))),
        }
    }

    fn area(&self) -> f64 {
        (self.high[0] - self.low[0]) * (self.high[1] - self.low[1])
    }

    fn overlap(&self, other: &Self) -> f64 {
        let length = |k: usize| (self.high[k].min(other.high[k]) - self.low[k].max(other.low[k])).max(0.0);
        length(0) * length(1)
    }
}

/// The sets of a method on curvesets.
pub(super) fn curvesets(region: &Region, method: TrimMethod) -> Vec<Chain> {
    let sets = maximal_chains(region);
    if method.structure() == TrimStructure::KdCurvesetsSf19 {
        return cut_by(sets, full_cost(region));
    }
    if method.has_overlap() { cut_by(sets, overlap_area) } else { sets }
}

/// A chain on its way round its loop.
struct Run {
    pieces: Vec<u32>,
    vertices: Vec<[f32; 2]>,
    /// Signs of the steps along u and v; 0 where there was none yet.
    signs: [i32; 2],
}

impl Run {
    fn start(&self) -> [f32; 2] {
        self.vertices[0]
    }

    fn end(&self) -> [f32; 2] {
        self.vertices[self.vertices.len() - 1]
    }

    /// Appends what starts where this ends, where it goes on in the same sense.
    fn append(&mut self, next: &Self) -> bool {
        let agrees = |k: usize| self.signs[k] * next.signs[k] >= 0;
        if self.end() != next.start() || !agrees(0) || !agrees(1) {
            return false;
        }
        self.pieces.extend(&next.pieces);
        self.vertices.extend(&next.vertices[1..]);
        self.signs = [0, 1].map(|k| (self.signs[k] + next.signs[k]).signum());
        true
    }

    fn into_chain(mut self) -> Chain {
        if self.signs[1] < 0 || self.signs[1] == 0 && self.signs[0] < 0 {
            self.pieces.reverse();
            self.vertices.reverse();
        }
        Chain { pieces: self.pieces, vertices: self.vertices }
    }
}

fn maximal_chains(region: &Region) -> Vec<Chain> {
    let mut runs: Vec<Run> = Vec::new();
    let mut first_of_loop = 0;
    for (index, piece) in region.pieces.iter().enumerate() {
        let (start, end) =
            if piece.t[0] < piece.t[1] { (piece.low, piece.high) } else { (piece.high, piece.low) };
        let sign = |k: usize| i32::from(end[k] > start[k]) - i32::from(end[k] < start[k]);
        let next = Run { pieces: vec![index as u32], vertices: vec![start, end], signs: [sign(0), sign(1)] };
        if runs.last_mut().is_some_and(|run| run.append(&next)) {
            continue;
        }
        if runs.last().is_some_and(|run| run.end() != next.start()) {
            close(&mut runs, first_of_loop);
            first_of_loop = runs.len();
        }
        runs.push(next);
    }
    close(&mut runs, first_of_loop);
    runs.into_iter().map(Run::into_chain).collect()
}

/// Joins the last run with the first of its loop where that goes on in the same sense.
fn close(runs: &mut Vec<Run>, first: usize) {
    if runs.len() > first + 1 {
        let mut last = runs.pop().expect("there are two");
        if last.append(&runs[first]) {
            runs[first] = last;
        } else {
            runs.push(last);
        }
    }
}

/// What a part of a set, from vertex to vertex, costs alone, and for the area that it shares with others.
trait Cost: Fn(&Chain, [usize; 2], f64) -> f64 {}
impl<F: Fn(&Chain, [usize; 2], f64) -> f64> Cost for F {}

/// Equation 3: the area shared with other sets.
fn overlap_area(_: &Chain, _: [usize; 2], shared: f64) -> f64 {
    shared
}

/// Equation 1; the boxes of a shared area's other sets count as one read and one test.
fn full_cost(region: &Region) -> impl Cost + '_ {
    let all = region.pieces.iter().flat_map(|piece| [piece.low, piece.high]);
    let bounds = all.fold(None::<Bounds>, |all, p| {
        let point = Bounds::between(p, p);
        Some(all.map_or(point, |all| Bounds {
            low: [0, 1].map(|k| all.low[k].min(point.low[k])),
            high: [0, 1].map(|k| all.high[k].max(point.high[k])),
        }))
    });
    let whole = bounds.map_or(1.0, |bounds| bounds.area()).max(f64::MIN_POSITIVE);
    move |chain: &Chain, [first, end]: [usize; 2], shared: f64| {
        let read = 1.0 + ((end - first) as f64).log2();
        let elements: f64 = (first..end).map(|i| chain.bounds(i, i + 1).area()).sum();
        let own = chain.bounds(first, end).area() * read + elements * EVALUATION_COST;
        VISIT_COST + (own + shared * (1.0 + EVALUATION_COST)) / whole
    }
}

/// Cuts sets, always that of the highest cost, while that lowers the cost.
fn cut_by(mut sets: Vec<Chain>, cost: impl Cost) -> Vec<Chain> {
    let mut boxes: Vec<Bounds> = sets.iter().map(|set| set.bounds(0, set.pieces.len())).collect();
    let mut comparisons = 0;
    let shared = |boxes: &[Bounds], own: &Bounds, but: usize| -> f64 {
        let others = boxes.iter().enumerate().filter(|(index, _)| *index != but);
        others.map(|(_, other)| own.overlap(other)).sum()
    };
    let mut costs: Vec<f64> = (0..sets.len())
        .map(|i| cost(&sets[i], [0, sets[i].pieces.len()], shared(&boxes, &boxes[i], i)))
        .collect();
    let mut is_done: Vec<bool> = sets.iter().map(|set| set.pieces.len() < 2).collect();
    loop {
        let open = (0..sets.len()).filter(|&i| !is_done[i]);
        let Some(worst) = open.max_by(|&a, &b| costs[a].total_cmp(&costs[b]).then(b.cmp(&a))) else { break };
        let set = &sets[worst];
        let count = set.pieces.len();
        comparisons += 2 * count * sets.len();
        if comparisons > MAX_COMPARISONS {
            break;
        }
        let parts_of = |at: usize| [[0, at], [at, count]];
        let part_cost =
            |part: [usize; 2]| cost(set, part, shared(&boxes, &set.bounds(part[0], part[1]), worst));
        let best = (1..count)
            .map(|at| (at, parts_of(at).map(part_cost)))
            .min_by(|(_, a), (_, b)| (a[0] + a[1]).total_cmp(&(b[0] + b[1])));
        let Some((at, [below, above])) = best.filter(|(_, parts)| parts[0] + parts[1] < costs[worst]) else {
            is_done[worst] = true;
            continue;
        };
        let [first, second] = set.cut(at);
        let new = [&first, &second].map(|part| part.bounds(0, part.pieces.len()));
        let old = boxes[worst];
        boxes[worst] = new[0];
        boxes.push(new[1]);
        is_done[worst] = first.pieces.len() < 2;
        is_done.push(second.pieces.len() < 2);
        costs[worst] = below;
        costs.push(above);
        sets[worst] = first;
        sets.push(second);
        let last = sets.len() - 1;
        for other in (0..last).filter(|&other| other != worst && old.overlap(&boxes[other]) > 0.0) {
            let own = boxes[other];
            costs[other] = cost(&sets[other], [0, sets[other].pieces.len()], shared(&boxes, &own, other));
            comparisons += sets.len();
        }
    }
    sets
}

/// The elements of a chain: its pieces but for the horizontal ones.
pub(super) fn elements<'a>(region: &'a Region, chain: &'a Chain) -> impl Iterator<Item = &'a Piece> {
    chain.pieces.iter().map(|&index| &region.pieces[index as usize]).filter(|piece| !is_horizontal(piece))
}
