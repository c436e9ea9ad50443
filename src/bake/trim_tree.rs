//! The trim kd-tree of a face: cells of the parameter plane with the state of a corner and the pieces of trim curves inside.
//!
//! States are never found by evaluation. The state of a cell is that of its lower left corner approached from inside, at (u₀ + δ, v₀ + ε) with
//! ε ≪ δ. A query walks up just inside the left edge, meeting the pieces that leave through it, and then right, meeting the pieces that pass left of the
//! point (`scene::TrimSegment`). Moving from a cell to its right child at u = s, only pieces that touch the bottom edge at or left of s can matter; moving to
//! the upper child at v = s, only pieces that end on the left edge at or below s, and pieces that start exactly at the new corner. All
//! of these are comparisons of shared f32 vertices, those that the clip at s makes among them, so states are as exact as the chains are closed.
//!
//! Some pieces need no storage: those along a cell's edges (on the left edge one is left of every point and of the walk, on the right edge right of
//! every point; the walk starts above the bottom edge and ends below the top edge). Horizontals inside a cell are kept, though nothing can cross them
//! sideways: those that start on the left edge for their flag, all so that points near them are known to be near a border.
//!
//! Planes are chosen by the surface-area heuristic (Sloup and Havran 2021, eq. 2) over piece boxes, then by their median-split rule.

use super::region::{Piece, Region};
use crate::geometry::Homogeneous2;
use crate::scene::TrimSegment;
use crate::scene::trim_node::{self, PLANE_STEPS, TrimNode, child_range, split_position};
use smallvec::SmallVec;

/// Levels of a tree.
pub(super) const MAX_DEPTH: usize = 24;

/// No cell is narrower: below it f32 coordinates have few bits left inside a cell.
const MIN_SIZE: f32 = 1.0 / 16384.0;

/// Cost of a kd step where testing one piece costs 1.
const TRAVERSAL_COST: f32 = 0.3;

/// Cells with two or more pieces are halved while larger than this (r_SA of Sloup and Havran 2021).
const HALVE_ABOVE_AREA: f32 = 0.0006;

/// Evenly spaced plane candidates where pieces are too many to try all of their ends.
const EVEN_CANDIDATES: u32 = 64;

/// Up to this many pieces every end is a candidate.
const FEW_PIECES: usize = 32;

/// Segments that a tree may have for each piece of its region, and on top: splits that only copy pieces stop there.
const SEGMENTS_PER_PIECE: usize = 12;
const FREE_SEGMENTS: usize = 1024;

/// The tree of one face; indices count from its own arrays.
#[derive(Debug, Clone, Default)]
pub(super) struct TrimTree {
    /// The root's word first (the word before the root is the scene's to add).
    pub nodes: Vec<u32>,
    /// Pieces, cell by cell.
    pub segments: Vec<TrimSegment>,
    /// Control points of curves, f64.
    pub points: Vec<Homogeneous2>,
    /// The highest degree of a curve.
    pub max_degree: u32,
}

impl TrimTree {
    /// Where a single cell is all: its state.
    pub(super) fn uniform(&self) -> Option<bool> {
        match trim_node::unpack(*self.nodes.first()?) {
            TrimNode::Leaf { inside, count: 0, .. } => Some(inside),
            _ => None,
        }
    }
}

#[derive(Debug, Clone, Copy)]
struct Cell {
    low: [f32; 2],
    size: [f32; 2],
    high: [f32; 2],
}

struct Builder<'a> {
    region: &'a Region,
    tree: TrimTree,
    first_point: Vec<u32>,
}

/// Builds the tree of `region`.
pub(super) fn build(region: &Region) -> Result<TrimTree, String> {
    if !region.is_bounded {
        let word = trim_node::pack(TrimNode::Leaf { inside: true, count: 0, first: 0 });
        return Ok(TrimTree { nodes: vec![word], ..TrimTree::default() });
    }
    let budget = region.pieces.len() * SEGMENTS_PER_PIECE + FREE_SEGMENTS;
    if budget >= 1 << 24 {
        return Err(format!("{} trim curves are too many", region.pieces.len()));
    }
    let mut builder =
        Builder { region, tree: TrimTree::default(), first_point: vec![u32::MAX; region.curves.len()] };
    builder.store_curves();
    let root = Cell { low: [0.0; 2], size: [1.0; 2], high: [1.0; 2] };
    let mut inside = false;
    for piece in &region.pieces {
        inside ^= piece.low == [0.0; 2] && piece.high[1] > 0.0;
    }
    builder.emit(root, region.pieces.clone(), inside, MAX_DEPTH, budget);
    Ok(builder.tree)
}

impl Builder<'_> {
    fn store_curves(&mut self) {
        for piece in &self.region.pieces {
            let Some(curve) = piece.curve else { continue };
            let points = &self.region.curves[curve as usize].points;
            self.first_point[curve as usize] = self.tree.points.len() as u32;
            self.tree.points.extend_from_slice(points);
            self.tree.max_degree = self.tree.max_degree.max(points.len() as u32 - 1);
        }
    }

    /// Emits a cell of at most `levels` levels; splits only while all pieces, copied, would stay within `budget` segments.
    fn emit(&mut self, cell: Cell, mut pieces: Vec<Piece>, inside: bool, levels: usize, budget: usize) {
        tidy(&cell, &mut pieces);
        let may_split = levels > 0 && pieces.len() * 2 <= budget;
        let split = if may_split { choose_split(&cell, &pieces) } else { None };
        let Some((axis, plane, position)) = split else {
            return self.emit_leaf(&cell, &pieces, inside);
        };
        let mut near = Vec::with_capacity(pieces.len());
        let mut far = Vec::with_capacity(pieces.len());
        for piece in &pieces {
            let [below, above] = self.region.clip(piece, axis, position);
            near.extend(below);
            far.extend(above);
        }
        drop(pieces);
        let near_budget =
            (budget as f64 * near.len() as f64 / (near.len() + far.len()).max(1) as f64) as usize;
        let child = |is_right: bool| {
            let mut child = cell;
            (child.low[axis], child.size[axis]) =
                child_range(cell.low[axis], cell.size[axis], position, is_right);
            child
        };
        let (mut near_cell, far_cell) = (child(false), child(true));
        near_cell.high[axis] = position;
        let far_inside = state_beyond(cell.low, far_cell.low, inside, near.iter().chain(&far));
        let near_inside = near.iter().fold(inside, |state, piece| state ^ lies_below_walk(&cell, piece));

        let word = self.tree.nodes.len();
        self.tree.nodes.push(0);
        self.emit(near_cell, near, near_inside, levels - 1, near_budget);
        let mut right = (self.tree.nodes.len() - word) as u32;
        if right >= trim_node::FAR {
            self.tree.nodes.insert(word + 1, right + 1);
            right = trim_node::FAR;
        }
        self.tree.nodes[word] = trim_node::pack(TrimNode::Inner { axis: axis as u32, plane, right });
        self.emit(far_cell, far, far_inside, levels - 1, budget - near_budget);
    }

    fn emit_leaf(&mut self, cell: &Cell, pieces: &[Piece], inside: bool) {
        let first = if pieces.is_empty() { 0 } else { self.tree.segments.len() as u32 };
        let count = pieces.len() as u32;
        let many = count >= trim_node::MANY;
        let word = TrimNode::Leaf { inside, count: if many { trim_node::MANY } else { count }, first };
        self.tree.nodes.push(trim_node::pack(word));
        if many {
            self.tree.nodes.push(count);
        }
        for piece in pieces {
            let (curve, degree) = match piece.curve {
                None => (0, 1),
                Some(curve) => (
                    self.first_point[curve as usize],
                    self.region.curves[curve as usize].points.len() as u32 - 1,
                ),
            };
            let flag = |end: [f32; 2], bit: u32| if end[0] == cell.low[0] { bit } else { 0 };
            self.tree.segments.push(TrimSegment {
                low: piece.low,
                high: piece.high,
                t_low: piece.t[0] as f32,
                t_high: piece.t[1] as f32,
                curve,
                flags: degree
                    | flag(piece.low, TrimSegment::LOW_ON_LEFT_EDGE)
                    | flag(piece.high, TrimSegment::HIGH_ON_LEFT_EDGE),
            });
        }
    }
}

/// Removes the pieces that neither the cell nor a part of it needs: those along its edges.
fn tidy(cell: &Cell, pieces: &mut Vec<Piece>) {
    let on_edge =
        |piece: &Piece, axis| piece.lies_at(axis, cell.low[axis]) || piece.lies_at(axis, cell.high[axis]);
    pieces.retain(|piece| !on_edge(piece, 0) && !on_edge(piece, 1));
}

/// Whether `piece` rose from the lower left corner of `cell` until clipping rounded it onto the bottom edge: the walk, which started below it, now
/// starts above it.
fn lies_below_walk(cell: &Cell, piece: &Piece) -> bool {
    piece.low == cell.low && piece.lies_at(1, cell.low[1])
}

/// The state of the lower left corner, `corner`, of the upper or right child of a cell that starts at `low`.
///
/// `pieces` are those of both children, already clipped: a vertex that clipping rounds onto the bottom edge makes its piece pass on the other side of the
/// corner.
fn state_beyond<'a>(
    low: [f32; 2],
    corner: [f32; 2],
    inside: bool,
    pieces: impl Iterator<Item = &'a Piece>,
) -> bool {
    pieces.fold(inside, |state, piece| {
        let rises = piece.low[1] == corner[1] && piece.high[1] > corner[1];
        let passes = rises && piece.low[0] <= corner[0];
        let leaves = |end: [f32; 2]| end[0] == low[0] && end[1] <= corner[1];
        state ^ passes ^ leaves(piece.low) ^ leaves(piece.high)
    })
}

/// Axis, plane and position of the best split, if one is worth it.
fn choose_split(cell: &Cell, pieces: &[Piece]) -> Option<(usize, u32, f32)> {
    if pieces.is_empty() {
        return None;
    }
    let count = pieces.len() as f32;
    let mut best: Option<(f32, usize, u32, f32)> = None;
    for axis in 0..2 {
        let mut least: Coordinates = pieces.iter().map(|piece| piece.range(axis)[0]).collect();
        let mut greatest: Coordinates = pieces.iter().map(|piece| piece.range(axis)[1]).collect();
        least.sort_unstable_by(f32::total_cmp);
        greatest.sort_unstable_by(f32::total_cmp);
        for plane in candidates(cell, axis, &least, &greatest) {
            let Some(position) = usable(cell, axis, plane) else { continue };
            let below = least.partition_point(|&x| x < position) as f32;
            let above = count - greatest.partition_point(|&x| x <= position) as f32;
            let share = (position - cell.low[axis]) / cell.size[axis];
            let cost = TRAVERSAL_COST + share * below + (1.0 - share) * above;
            if cost < count && best.is_none_or(|(least_cost, ..)| cost < least_cost) {
                best = Some((cost, axis, plane, position));
            }
        }
    }
    if let Some((_, axis, plane, position)) = best {
        return Some((axis, plane, position));
    }
    let curved = pieces.iter().any(|piece| piece.curve.is_some());
    if (pieces.len() > 1 || curved) && cell.size[0] * cell.size[1] > HALVE_ABOVE_AREA {
        let axis = usize::from(cell.size[1] > cell.size[0]);
        return usable(cell, axis, PLANE_STEPS / 2).map(|position| (axis, PLANE_STEPS / 2, position));
    }
    None
}

/// Coordinates of piece ends, mostly few.
type Coordinates = SmallVec<[f32; FEW_PIECES]>;

/// Planes to try: those that just leave a piece on one side for few pieces, evenly spaced for many.
fn candidates(cell: &Cell, axis: usize, least: &[f32], greatest: &[f32]) -> SmallVec<[u32; 64]> {
    if least.len() > FEW_PIECES {
        return (1..EVEN_CANDIDATES).map(|i| i * (PLANE_STEPS / EVEN_CANDIDATES)).collect();
    }
    let (low, size) = (cell.low[axis], cell.size[axis]);
    let below = |end: f32| ((end - low) / size * PLANE_STEPS as f32) as u32;
    let mut planes = SmallVec::from_slice(&[PLANE_STEPS / 2]);
    planes.extend(least.iter().map(|&end| {
        let plane = below(end);
        plane - u32::from(plane > 0 && split_position(low, size, plane) > end)
    }));
    planes.extend(greatest.iter().map(|&end| {
        let plane = below(end);
        plane + u32::from(split_position(low, size, plane) < end)
    }));
    planes.retain(|plane| (1..PLANE_STEPS).contains(plane));
    planes.sort_unstable();
    planes.dedup();
    planes
}

/// The position of a plane that leaves two cells of allowed size.
fn usable(cell: &Cell, axis: usize, plane: u32) -> Option<f32> {
    let position = split_position(cell.low[axis], cell.size[axis], plane);
    let wide = |size: f32| size >= MIN_SIZE;
    (wide(position - cell.low[axis]) && wide(cell.high[axis] - position)).then_some(position)
}
