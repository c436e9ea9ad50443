//! kd-trees over curves (KC) and over curvesets (KCS), Sloup and Havran 2021, section 3.1.
//!
//! Planes are first those of least length times area on both sides, as long as equation 2 says that a split pays; then (R) full leaves are halved along their
//! longer side while they are large; then (E) empty strips are cut off leaves with one curve. Curves go to the children that they pass through,
//! by clipping their pieces; leaves refer to whole curves.
//!
//! A leaf's parity comes from a single point in its middle. Those curves that the leaf does not refer to do not pass through it, so that what they and the
//! bits of the references say there holds all over the leaf; the others say it themselves at each query. Cells are never so
//! thin that rounding of a clip could reach their middle.

use super::super::region::{Piece, Region};
use super::Structure;
use super::boxing::slab_word;
use super::curvesets::{Chain, curvesets, elements};
use super::elements::control_points;
use super::heights::Heights;
use crate::scene::trim_study::{
    HIGH_IS_LEFT, KD_HEADER, LOW_IS_LEFT, MAX_STUDY_DEPTH, PARITY_BIT, RECORD_WORDS, STUDY_LEAF,
};
use crate::scene::{TrimMethod, TrimStructure};

/// C_trav where C_test is 1, which the paper does not state. On real files half gives trees of KC about as large as the paper's: 0.3 twice as many
/// nodes, 1 two thirds.
const TRAVERSAL_COST: f32 = 0.5;

/// r_SA: leaves smaller than this share of the tree are not halved.
const REFINED_AREA: f32 = 0.0006;

/// r_l: nor those whose longer side is less than this share of the tree's diagonal.
const REFINED_LENGTH: f32 = 0.025;

/// r_cutoff: an empty strip of more than this share of its leaf is cut off.
const CUT_OFF: f32 = 0.075;

/// No cell is narrower, as a share of the tree: a thousand times what a clip is off by.
const LEAST_SIZE: f32 = 1.0 / 16384.0;

/// Candidate planes along an axis where all ends of curves are too many.
const EVEN_CANDIDATES: usize = 64;

/// References beyond the first ones that splits may add, for each piece and on top.
const COPIES_PER_PIECE: usize = 64;
const FREE_COPIES: usize = 1 << 16;

pub(super) fn build(region: &Region, method: TrimMethod) -> Result<Structure, String> {
    let has_sets = method.structure() != TrimStructure::KdCurves;
    let chains: Vec<Chain> = if has_sets {
        curvesets(region, method)
    } else {
        region.pieces.iter().enumerate().map(|(index, piece)| Chain::single(index, piece)).collect()
    };
    let root = Cell::around(&region.pieces);
    let mut chain_of = vec![0; region.pieces.len()];
    for (index, chain) in chains.iter().enumerate() {
        chain.pieces.iter().for_each(|&piece| chain_of[piece as usize] = index as u32);
    }
    let mut builder = Builder {
        region,
        chains: &chains,
        chain_of,
        heights: Heights::new(region),
        method,
        root,
        nodes: Vec::new(),
        is_referred_to: vec![false; chains.len()],
        copies_left: region.pieces.len() * COPIES_PER_PIECE + FREE_COPIES,
    };
    if root.is_empty() {
        builder.nodes.push(Node::Leaf { parity: false, references: Vec::new() });
    } else {
        let entry = |(index, piece): (usize, &Piece)| Entry { chain: builder.chain_of[index], piece: *piece };
        let mut entries: Vec<Entry> = region.pieces.iter().enumerate().map(entry).collect();
        entries.sort_by_key(|entry| entry.chain);
        builder.grow(root, entries, Phase::Heuristic, MAX_STUDY_DEPTH);
    }
    builder.write(has_sets)
}

/// A rectangle of the parameter plane.
#[derive(Debug, Clone, Copy)]
struct Cell {
    low: [f32; 2],
    high: [f32; 2],
}

impl Cell {
    fn around(pieces: &[Piece]) -> Self {
        let mut all = Self { low: [1.0; 2], high: [0.0; 2] };
        for axis in 0..2 {
            for [least, greatest] in pieces.iter().map(|piece| piece.range(axis)) {
                all.low[axis] = all.low[axis].min(least);
                all.high[axis] = all.high[axis].max(greatest);
            }
        }
        all
    }

    fn size(&self, axis: usize) -> f32 {
        self.high[axis] - self.low[axis]
    }

    fn is_empty(&self) -> bool {
        !(self.size(0) > 0.0 && self.size(1) > 0.0)
    }

    fn area(&self) -> f32 {
        self.size(0) * self.size(1)
    }

    fn longer_axis(&self) -> usize {
        usize::from(self.size(1) > self.size(0))
    }

    fn middle(&self) -> [f32; 2] {
        [0, 1].map(|axis| self.low[axis] + 0.5 * self.size(axis))
    }
}

/// The part of a chain's piece in a cell.
#[derive(Debug, Clone, Copy)]
struct Entry {
    chain: u32,
    piece: Piece,
}

/// What splits a cell; later ones follow earlier ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
enum Phase {
    Heuristic,
    Refinement,
    EmptySpace,
}

enum Node {
    Inner {
        axis: usize,
        plane: f32,
        right: usize,
    },
    /// References have the index of the chain where the words have its place.
    Leaf {
        parity: bool,
        references: Vec<u32>,
    },
}

struct Builder<'a> {
    region: &'a Region,
    chains: &'a [Chain],
    chain_of: Vec<u32>,
    heights: Heights<'a>,
    method: TrimMethod,
    root: Cell,
    nodes: Vec<Node>,
    is_referred_to: Vec<bool>,
    copies_left: usize,
}

impl Builder<'_> {
    fn grow(&mut self, cell: Cell, mut entries: Vec<Entry>, phase: Phase, levels: usize) {
        entries.retain(|entry| !lies_on_edge(&cell, &entry.piece));
        let Some((phase, axis, plane)) = self.split(&cell, &entries, phase).filter(|_| levels > 1) else {
            return self.leaf(&cell, &entries);
        };
        let (mut below, mut above) = (Vec::new(), Vec::new());
        for entry in &entries {
            let [near, far] = self.region.clip(&entry.piece, axis, plane);
            below.extend(near.map(|piece| Entry { piece, ..*entry }));
            above.extend(far.map(|piece| Entry { piece, ..*entry }));
        }
        self.copies_left -= (below.len() + above.len()).saturating_sub(entries.len()).min(self.copies_left);
        drop(entries);
        let (mut left, mut right) = (cell, cell);
        left.high[axis] = plane;
        right.low[axis] = plane;
        let node = self.nodes.len();
        self.nodes.push(Node::Inner { axis, plane, right: 0 });
        self.grow(left, below, phase, levels - 1);
        let place = self.nodes.len();
        self.nodes[node] = Node::Inner { axis, plane, right: place };
        self.grow(right, above, phase, levels - 1);
    }

    fn split(&self, cell: &Cell, entries: &[Entry], phase: Phase) -> Option<(Phase, usize, f32)> {
        let ranges = self.ranges(entries);
        if ranges.is_empty() || self.copies_left == 0 {
            return None;
        }
        if phase == Phase::Heuristic
            && let Some((axis, plane)) = self.heuristic(cell, entries, &ranges)
        {
            return Some((phase, axis, plane));
        }
        if phase <= Phase::Refinement && self.method.has_refinement() {
            let axis = cell.longer_axis();
            let diagonal = self.root.size(0).hypot(self.root.size(1));
            let is_large = cell.area() >= REFINED_AREA * self.root.area()
                && cell.size(axis) >= REFINED_LENGTH * diagonal;
            let plane = cell.middle()[axis];
            if is_large && self.is_usable(cell, axis, plane) {
                return Some((Phase::Refinement, axis, plane));
            }
        }
        // One strip, the largest, for each leaf, as the paper's Figure 7 has it.
        if phase < Phase::EmptySpace && self.method.has_empty_space() && ranges.len() == 1 {
            let (axis, plane) = self.empty_strip(cell, &ranges[0])?;
            return Some((Phase::EmptySpace, axis, plane));
        }
        None
    }

    /// The boxes of the chains in a cell, without those that no ray to the left can cross.
    fn ranges(&self, entries: &[Entry]) -> Vec<Cell> {
        let groups = entries.chunk_by(|a, b| a.chain == b.chain);
        let solid = groups.filter(|group| !self.chains[group[0].chain as usize].is_flat());
        solid.map(|group| Cell::around(&group.iter().map(|entry| entry.piece).collect::<Vec<_>>())).collect()
    }

    fn is_usable(&self, cell: &Cell, axis: usize, plane: f32) -> bool {
        let least = LEAST_SIZE * self.root.size(axis);
        plane - cell.low[axis] >= least && cell.high[axis] - plane >= least
    }

    fn heuristic(&self, cell: &Cell, entries: &[Entry], ranges: &[Cell]) -> Option<(usize, f32)> {
        let mut best: Option<(f32, usize, f32)> = None;
        let area = cell.area();
        for axis in 0..2 {
            for plane in candidates(cell, axis, ranges) {
                if !self.is_usable(cell, axis, plane) {
                    continue;
                }
                let share = (plane - cell.low[axis]) / cell.size(axis);
                let below = ranges.iter().filter(|range| range.low[axis] < plane).count() as f32;
                let above = ranges.iter().filter(|range| range.high[axis] > plane).count() as f32;
                let cost = TRAVERSAL_COST + share * below + (1.0 - share) * above;
                if !(cost < ranges.len() as f32) {
                    continue;
                }
                let [left, right] = lengths(entries, axis, plane);
                let cost = area * (share * left + (1.0 - share) * right);
                if best.is_none_or(|(least, ..)| cost < least) {
                    best = Some((cost, axis, plane));
                }
            }
        }
        best.map(|(_, axis, plane)| (axis, plane))
    }

    /// The plane that cuts off the largest strip beside the only curve, if that is large enough.
    fn empty_strip(&self, cell: &Cell, range: &Cell) -> Option<(usize, f32)> {
        let mut best: Option<(f32, usize, f32)> = None;
        for axis in 0..2 {
            let least = LEAST_SIZE * self.root.size(axis);
            let sides = [
                (range.low[axis] - cell.low[axis], range.low[axis].min(cell.high[axis] - least)),
                (cell.high[axis] - range.high[axis], range.high[axis].max(cell.low[axis] + least)),
            ];
            for (width, plane) in sides {
                let share = width / cell.size(axis);
                let is_best = best.is_none_or(|(most, ..)| share > most);
                if share > CUT_OFF && is_best && self.is_usable(cell, axis, plane) {
                    best = Some((share, axis, plane));
                }
            }
        }
        best.map(|(_, axis, plane)| (axis, plane))
    }

    fn leaf(&mut self, cell: &Cell, entries: &[Entry]) {
        let mut references = Vec::new();
        let middle = cell.middle();
        let mut parity = false;
        let mut referred = Vec::new();
        for group in entries.chunk_by(|a, b| a.chain == b.chain) {
            let index = group[0].chain;
            let chain = &self.chains[index as usize];
            let [low_is_left, high_is_left] = [chain.low(), chain.high()].map(|end| end[0] <= cell.low[0]);
            // A horizontal chain says nothing but where it crosses the left edge.
            if chain.is_flat() && low_is_left == high_is_left {
                continue;
            }
            parity ^= low_is_left && middle[1] >= chain.low()[1];
            parity ^= high_is_left && middle[1] >= chain.high()[1];
            let bits = [(low_is_left, LOW_IS_LEFT), (high_is_left, HIGH_IS_LEFT)];
            let bits: u32 = bits.iter().filter(|(is_set, _)| *is_set).map(|(_, bit)| bit).sum();
            references.push(bits | index);
            referred.push(index);
            self.is_referred_to[index as usize] = true;
        }
        let counts = |piece: u32| referred.binary_search(&self.chain_of[piece as usize]).is_err();
        parity ^= self.heights.is_odd_left(middle, counts);
        self.nodes.push(Node::Leaf { parity, references });
    }

    fn write(self, has_sets: bool) -> Result<Structure, String> {
        let lists = self.nodes.iter().map(|node| match node {
            Node::Leaf { references, .. } if references.len() > 1 => references.len(),
            _ => 0,
        });
        let first_list = KD_HEADER + 2 * self.nodes.len();
        let first_record = first_list + lists.sum::<usize>();
        let mut structure = Structure::default();
        let mut place_of = vec![0; self.chains.len()];
        let kept = (0..self.chains.len()).filter(|&chain| self.is_referred_to[chain]);
        let records = kept.clone().count() * RECORD_WORDS;
        let has_boxing = self.method.has_boxing();
        let mut sets = Structure::default();
        for index in kept {
            let chain = &self.chains[index];
            if !has_sets {
                let piece = &self.region.pieces[chain.pieces[0] as usize];
                place_of[index] =
                    first_record as u32 + structure.push_element(self.region, piece, has_boxing);
                continue;
            }
            let first = (first_record + records + structure.words.len()) as u32;
            let count = elements(self.region, chain).count() as u32;
            elements(self.region, chain).for_each(|piece| {
                structure.push_element(self.region, piece, has_boxing);
            });
            let slab = if has_boxing && count > 0 { self.slab_of(chain) } else { 0 };
            place_of[index] =
                first_record as u32 + sets.push_record(chain.low(), chain.high(), [first, count, slab]);
        }
        let [low, high] = [self.root.low, self.root.high];
        let mut words = vec![0];
        words.extend([low[0], low[1], high[0], high[1]].map(f32::to_bits));
        let mut list = first_list;
        for (at, node) in self.nodes.iter().enumerate() {
            match node {
                Node::Inner { axis, plane, right } => {
                    words.extend([plane.to_bits(), ((*axis as u32) << 30) | (2 * (right - at) as u32)]);
                }
                Node::Leaf { parity, references } => {
                    let first = match references[..] {
                        [] => 0,
                        [only] => placed(only, &place_of),
                        _ => list as u32,
                    };
                    list += if references.len() > 1 { references.len() } else { 0 };
                    let parity = if *parity { PARITY_BIT } else { 0 };
                    words.extend([first, STUDY_LEAF << 30 | parity | references.len() as u32]);
                }
            }
        }
        for node in &self.nodes {
            if let Node::Leaf { references, .. } = node
                && references.len() > 1
            {
                words.extend(references.iter().map(|&reference| placed(reference, &place_of)));
            }
        }
        words.append(&mut sets.words);
        words.append(&mut structure.words);
        if words.len() >= PARITY_BIT as usize {
            return Err(format!("{} trim curves are too many for a kd-tree", self.region.pieces.len()));
        }
        Ok(Structure { words, ..structure })
    }

    fn slab_of(&self, chain: &Chain) -> u32 {
        let curves: Vec<_> = chain
            .pieces
            .iter()
            .map(|&index| control_points(self.region, &self.region.pieces[index as usize]))
            .collect();
        let curves: Vec<_> = curves.iter().map(|points| points.as_slice()).collect();
        slab_word(chain.low(), chain.high(), &curves)
    }
}

/// The word of a reference whose chain has a place.
fn placed(reference: u32, place_of: &[u32]) -> u32 {
    let bits = LOW_IS_LEFT | HIGH_IS_LEFT;
    reference & bits | place_of[(reference & !bits) as usize]
}

fn lies_on_edge(cell: &Cell, piece: &Piece) -> bool {
    (0..2).any(|axis| piece.lies_at(axis, cell.low[axis]) || piece.lies_at(axis, cell.high[axis]))
}

/// Ends of curves, or evenly spaced planes where those are too many.
fn candidates(cell: &Cell, axis: usize, ranges: &[Cell]) -> Vec<f32> {
    if 2 * ranges.len() > EVEN_CANDIDATES {
        let step = cell.size(axis) / EVEN_CANDIDATES as f32;
        return (1..EVEN_CANDIDATES).map(|i| cell.low[axis] + i as f32 * step).collect();
    }
    let mut planes: Vec<f32> = ranges.iter().flat_map(|range| [range.low[axis], range.high[axis]]).collect();
    planes.sort_unstable_by(f32::total_cmp);
    planes.dedup();
    planes
}

/// Lengths of the pieces, taken for straight, on both sides of a plane.
fn lengths(entries: &[Entry], axis: usize, plane: f32) -> [f32; 2] {
    let mut lengths = [0.0; 2];
    for Entry { piece, .. } in entries {
        let length = (piece.high[0] - piece.low[0]).hypot(piece.high[1] - piece.low[1]);
        let [least, greatest] = piece.range(axis);
        let below = if least >= plane { 0.0 } else { ((plane - least) / (greatest - least)).min(1.0) };
        lengths[0] += length * below;
        lengths[1] += length * (1.0 - below);
    }
    lengths
}
