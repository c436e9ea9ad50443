//! The trims of a face: a grid of cells over the parameter window and kd-trees below crowded ones, with the state of a corner and the segments inside.
//!
//! States are never found by evaluation. The state of a cell is that of its lower left corner approached from inside, at (u₀ + δ, v₀ + ε) with
//! ε ≪ δ. A query walks up just inside the left edge, meeting the pieces that leave through it, and then right, meeting the pieces that pass left of the
//! point (head of `scene::trim`). Moving from a cell to its right child at u = s, only pieces that touch the bottom edge at or left of s can matter; moving to
//! the upper child at v = s, only pieces that end on the left edge at or below s, and pieces that start exactly at the new corner. All
//! of these are comparisons of shared f32 vertices, those that the clip at s makes among them, so states are as exact as the chains are closed.
//!
//! Some pieces need no mention in a cell: those along its edges (on the left edge one is left of every point and of the walk, on the right edge right of
//! every point; the walk starts above the bottom edge and ends below the top edge). Horizontals inside a cell are kept, though nothing can cross them
//! sideways: those that start on the left edge for their toggle, all so that points near them are known to be near a border.
//!
//! The grid's shape follows from a count: a monotone piece crosses exactly as many grid lines as its ends differ in. Below it,
//! planes are chosen by the surface-area heuristic (Sloup and Havran 2021, eq. 2) over piece boxes, then by their median-split rule.

use super::region::{Piece, Region};
use super::trim_segments::{Evaluation, Segments};
use crate::scene::TrimSegment;
use crate::scene::trim_word::{self, HEADER_WORDS, MAX_GRID_LEVEL, PLANE_STEPS, TrimWord, position};
use smallvec::SmallVec;

/// Levels of a tree below the grid.
const MAX_DEPTH: usize = 24;

/// Cost of a kd step where testing one piece costs 1.
const TRAVERSAL_COST: f32 = 0.3;

/// A split has to save this many tests for a mean point of the window: what its words are worth.
const LEAST_GAIN: f32 = 1.0 / 64.0;

/// Evenly spaced plane candidates where pieces are too many to try all of their ends.
const EVEN_CANDIDATES: u32 = 64;

/// Up to this many pieces every end is a candidate.
const FEW_PIECES: usize = 32;

/// Mentions of segments that a face may have for each of its pieces, and on top: splits that only copy pieces stop there.
const MENTIONS_PER_PIECE: usize = 12;
const FREE_MENTIONS: usize = 1024;

/// Words of a tree for each mention that its budget allows, at most. On each level the cells that are not empty are no more than the mentions, with an
/// empty one beside each: two words or, where far, three. A list takes a word for each mention and one more.
const WORDS_PER_MENTION: usize = 3 * (MAX_DEPTH + 1) + 2;

/// The trims of one face; indices count from its own arrays.
#[derive(Debug, Clone, Default)]
pub(super) struct TrimTree {
    /// The root's header first; its word 1 is the scene's to set.
    pub words: Vec<u32>,
    /// Segments.
    pub segments: Vec<TrimSegment>,
    /// The highest degree of a curve.
    pub max_degree: u32,
}

impl TrimTree {
    /// Where a single cell is all: its state.
    pub(super) fn uniform(&self) -> Option<bool> {
        match trim_word::unpack(*self.words.get(HEADER_WORDS)?) {
            TrimWord::Uniform { inside } if self.words[0] == trim_word::grid([0, 0]) => Some(inside),
            _ => None,
        }
    }
}

#[derive(Debug, Clone, Copy)]
struct Cell {
    low: [f32; 2],
    high: [f32; 2],
}

impl Cell {
    fn size(&self, axis: usize) -> f32 {
        self.high[axis] - self.low[axis]
    }

    /// The parts below and above `position`.
    fn halves(self, axis: usize, position: f32) -> [Self; 2] {
        let (mut near, mut far) = (self, self);
        near.high[axis] = position;
        far.low[axis] = position;
        [near, far]
    }
}

/// A cell, what passes it and the state of its lower left corner.
struct Content {
    cell: Cell,
    pieces: Vec<Piece>,
    inside: bool,
}

struct Builder<'a> {
    region: &'a Region,
    segments: Segments,
    words: Vec<u32>,
    /// The word from which offsets count.
    beyond_cells: usize,
}

/// Builds the trims of `region`.
pub(super) fn build(region: &Region, evaluation: Evaluation) -> Result<TrimTree, String> {
    let whole = Cell { low: [0.0; 2], high: [1.0; 2] };
    if !region.is_bounded {
        let word = trim_word::pack(TrimWord::Uniform { inside: true });
        return Ok(TrimTree { words: vec![trim_word::grid([0, 0]), 0, word], ..TrimTree::default() });
    }
    let budget = region.pieces.len() * MENTIONS_PER_PIECE + FREE_MENTIONS;
    let mut inside = false;
    for piece in &region.pieces {
        inside ^= piece.low == [0.0; 2] && piece.high[1] > 0.0;
    }
    let segments = Segments::new(region, evaluation, |piece| !lies_on_edge(&whole, piece))?;
    let root = Content { cell: whole, pieces: segments.pieces.clone(), inside };
    let levels = grid_levels(&root.pieces);
    let beyond_cells = HEADER_WORDS + (1_usize << (levels[0] + levels[1]));
    let mut words = vec![0; beyond_cells];
    words[0] = trim_word::grid(levels);
    let mut builder = Builder { region, segments, words, beyond_cells };
    builder.fill_grid(root, levels, [0, 0], levels, budget);
    let Builder { segments, words, .. } = builder;
    let mut words = with_short_cells(words, beyond_cells);
    if words.len() > trim_word::MAX_OFFSET as usize {
        return Err(format!("{} trim curves are too many", region.pieces.len()));
    }
    let (segments, max_degree) = segments.into_records(region, &mut words)?;
    Ok(TrimTree { words, segments, max_degree })
}

/// The words with short cells, if all of them have a short form.
fn with_short_cells(words: Vec<u32>, beyond_cells: usize) -> Vec<u32> {
    let cells = &words[HEADER_WORDS..beyond_cells];
    if cells.len() < 2 {
        return words;
    }
    let Some(short) = cells.iter().map(|&word| trim_word::shorten(word)).collect::<Option<Vec<u32>>>() else {
        return words;
    };
    let pairs = short.chunks_exact(2).map(|pair| pair[1] << 16 | pair[0]);
    let header = [words[0] | trim_word::SHORT, words[1]];
    header.into_iter().chain(pairs).chain(words[beyond_cells..].iter().copied()).collect()
}

/// log2 of the cells along u and v: about [`SHORT_CELLS_PER_PIECE`] or [`LONG_CELLS_PER_PIECE`] for each piece, as many along each axis as leaves the
/// most of them without a piece.
fn grid_levels(pieces: &[Piece]) -> [u32; 2] {
    if pieces.is_empty() {
        return [0; 2];
    }
    let is_short = pieces.len() <= trim_word::MAX_SHORT_SEGMENT as usize;
    let per_piece = if is_short { SHORT_CELLS_PER_PIECE } else { LONG_CELLS_PER_PIECE };
    let total = ((pieces.len() * per_piece) as f32).log2().round().min((2 * MAX_GRID_LEVEL) as f32) as u32;
    let length = |axis| {
        pieces
            .iter()
            .map(|piece: &Piece| {
                let [a, b] = piece.range(axis);
                f64::from(b - a)
            })
            .sum::<f64>()
    };
    let lengths = [length(0), length(1)];
    let crossings = |along_u: u32| {
        lengths[0] * f64::from(1_u32 << along_u) + lengths[1] * f64::from(1_u32 << (total - along_u))
    };
    let allowed = total.saturating_sub(MAX_GRID_LEVEL)..=total.min(MAX_GRID_LEVEL);
    let along_u = allowed.min_by(|&a, &b| crossings(a).total_cmp(&crossings(b))).unwrap_or(0);
    [along_u, total - along_u]
}

/// Cells of the grid for each piece: more where the face has few, for then cells take half a word each, but for lists too far from them.
const SHORT_CELLS_PER_PIECE: usize = 16;
const LONG_CELLS_PER_PIECE: usize = 8;

impl Builder<'_> {
    /// Halves `content` until it is one cell of the grid: `left` counts the halvings to come, `index` is the cell's so far.
    fn fill_grid(
        &mut self,
        mut content: Content,
        left: [u32; 2],
        index: [usize; 2],
        levels: [u32; 2],
        budget: usize,
    ) {
        tidy(&content.cell, &mut content.pieces);
        if content.pieces.is_empty() {
            // Nothing changes from here on: all cells are alike.
            let word = self.leaf(&content);
            let [across, up] = [0, 1].map(|axis| index[axis] << left[axis]..(index[axis] + 1) << left[axis]);
            for row in up {
                let first = HEADER_WORDS + (row << levels[0]);
                self.words[first + across.start..first + across.end].fill(word);
            }
            return;
        }
        if left == [0, 0] {
            let at = HEADER_WORDS + (index[1] << levels[0] | index[0]);
            self.words[at] = match self.split_of(&content, MAX_DEPTH, budget) {
                None => self.leaf(&content),
                Some(_) => {
                    let offset = (self.words.len() - self.beyond_cells) as u32;
                    self.emit(content, MAX_DEPTH, budget);
                    trim_word::pack(TrimWord::Tree { offset: offset & trim_word::MAX_OFFSET })
                }
            };
            return;
        }
        let axis = usize::from(left[1] > left[0]);
        let middle = 0.5 * (content.cell.low[axis] + content.cell.high[axis]);
        let halves = self.divide(content, axis, middle);
        let budgets = shares(budget, &halves);
        for (side, (half, budget)) in halves.into_iter().zip(budgets).enumerate() {
            let (mut left, mut index) = (left, index);
            left[axis] -= 1;
            index[axis] = 2 * index[axis] + side;
            self.fill_grid(half, left, index, levels, budget);
        }
    }

    /// Where the tree below a cell would split it first; only while all pieces, copied, would stay within `budget`.
    fn split_of(&self, content: &Content, levels: usize, budget: usize) -> Option<(usize, u32)> {
        let may_split = levels > 0 && content.pieces.len() * 2 <= budget;
        if may_split { choose_split(&content.cell, &content.pieces) } else { None }
    }

    /// Emits a cell as a tree of at most `levels` levels.
    fn emit(&mut self, mut content: Content, levels: usize, budget: usize) {
        tidy(&content.cell, &mut content.pieces);
        let Some((axis, plane)) = self.split_of(&content, levels, budget) else {
            let at = self.words.len();
            self.words.push(0);
            self.words[at] = self.leaf(&content);
            return;
        };
        let halves = self.divide(content, axis, position(plane));
        let budgets = shares(budget, &halves);
        let [near, far] = halves;
        let is_far = budgets[0] * WORDS_PER_MENTION >= trim_word::FAR as usize;
        let word = self.words.len();
        self.words.extend(std::iter::repeat_n(0, 1 + usize::from(is_far)));
        self.emit(near, levels - 1, budgets[0]);
        let mut right = (self.words.len() - word) as u32;
        if is_far {
            self.words[word + 1] = right;
            right = trim_word::FAR;
        }
        self.words[word] = trim_word::pack(TrimWord::Inner { axis: axis as u32, plane, right });
        self.emit(far, levels - 1, budgets[1]);
    }

    /// The parts of `content` below and above `position`, with their states.
    fn divide(&self, content: Content, axis: usize, position: f32) -> [Content; 2] {
        let Content { cell, pieces, inside } = content;
        let mut near = Vec::with_capacity(pieces.len());
        let mut far = Vec::with_capacity(pieces.len());
        for piece in &pieces {
            let [below, above] = self.region.clip(piece, axis, position);
            near.extend(below);
            far.extend(above);
        }
        let [near_cell, far_cell] = cell.halves(axis, position);
        let far_inside = state_beyond(cell.low, far_cell.low, inside, near.iter().chain(&far));
        let near_inside = near.iter().fold(inside, |state, piece| state ^ lies_below_walk(&cell, piece));
        [
            Content { cell: near_cell, pieces: near, inside: near_inside },
            Content { cell: far_cell, pieces: far, inside: far_inside },
        ]
    }

    /// The word of a cell; a list goes to the end of the words.
    fn leaf(&mut self, content: &Content) -> u32 {
        let Content { cell, pieces, inside } = content;
        let mut corner = *inside;
        let mut entries: SmallVec<[(u32, u32); 8]> = SmallVec::new();
        for piece in pieces {
            if !entries.iter().any(|&(_, segment)| segment == piece.source) {
                let (toggles, passes_left) =
                    mention(&self.segments.pieces[piece.source as usize], piece, cell);
                corner ^= passes_left;
                entries.push((toggles, piece.source));
            }
        }
        match entries[..] {
            [] => trim_word::pack(TrimWord::Uniform { inside: corner }),
            [(toggles, segment)] => trim_word::pack(TrimWord::One { corner, toggles, segment }),
            _ => {
                let offset = (self.words.len() - self.beyond_cells) as u32 & trim_word::MAX_OFFSET;
                self.words.push(trim_word::list_head(corner, entries.len() as u32));
                self.words.extend(
                    entries.iter().map(|&(toggles, segment)| trim_word::list_entry(toggles, segment)),
                );
                trim_word::pack(TrimWord::List { offset })
            }
        }
    }
}

/// The budgets of two parts, by their numbers of pieces.
fn shares(budget: usize, parts: &[Content; 2]) -> [usize; 2] {
    let [near, far] = [0, 1].map(|side| parts[side].pieces.len());
    let near = (budget as f64 * near as f64 / (near + far).max(1) as f64) as usize;
    [near, budget - near]
}

/// The toggles of a segment in a cell that `piece` of it passes, and whether it passes left of the cell's corner at the corner's height.
///
/// With u₀ the cell's left edge: a segment that spans u₀ and rises to the right toggles at its lower end, one that falls at its upper
/// end, one right of u₀ never; one left of u₀ does not pass the cell. Toggles at or below the cell's bottom are folded into the corner's
/// state, as are those above it, which no point of the cell reaches.
fn mention(segment: &Piece, piece: &Piece, cell: &Cell) -> (u32, bool) {
    let spans = segment.low[0].min(segment.high[0]) <= cell.low[0];
    if !spans {
        return (0, false);
    }
    let rises = segment.high[0] > segment.low[0];
    let (bit, height) = if rises { (1, segment.low[1]) } else { (2, segment.high[1]) };
    if height > cell.low[1] {
        return (if height < cell.high[1] { bit } else { 0 }, false);
    }
    // Met by the walk up or, entering through the bottom edge, by none of the two ways to the corner.
    (0, rises && piece.low[0] == cell.low[0])
}

/// Removes the pieces that neither the cell nor a part of it needs: those along its edges.
fn tidy(cell: &Cell, pieces: &mut Vec<Piece>) {
    pieces.retain(|piece| !lies_on_edge(cell, piece));
}

fn lies_on_edge(cell: &Cell, piece: &Piece) -> bool {
    (0..2).any(|axis| piece.lies_at(axis, cell.low[axis]) || piece.lies_at(axis, cell.high[axis]))
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

/// Axis and plane of the best split, if one is worth it.
fn choose_split(cell: &Cell, pieces: &[Piece]) -> Option<(usize, u32)> {
    if pieces.is_empty() {
        return None;
    }
    let count = pieces.len() as f32;
    let area = cell.size(0) * cell.size(1);
    let mut best: Option<(f32, usize, u32)> = None;
    for axis in 0..2 {
        let mut least: Coordinates = pieces.iter().map(|piece| piece.range(axis)[0]).collect();
        let mut greatest: Coordinates = pieces.iter().map(|piece| piece.range(axis)[1]).collect();
        least.sort_unstable_by(f32::total_cmp);
        greatest.sort_unstable_by(f32::total_cmp);
        for plane in candidates(cell, axis, &least, &greatest) {
            let position = position(plane);
            let below = least.partition_point(|&x| x < position) as f32;
            let above = count - greatest.partition_point(|&x| x <= position) as f32;
            let share = (position - cell.low[axis]) / cell.size(axis);
            let cost = TRAVERSAL_COST + share * below + (1.0 - share) * above;
            if (count - cost) * area > LEAST_GAIN && best.is_none_or(|(least_cost, ..)| cost < least_cost) {
                best = Some((cost, axis, plane));
            }
        }
    }
    if let Some((_, axis, plane)) = best {
        return Some((axis, plane));
    }
    if (count - 1.0) * area > LEAST_GAIN {
        let axis = usize::from(cell.size(1) > cell.size(0));
        let [first, last] = planes(cell, axis);
        return (first <= last).then_some((axis, u32::midpoint(first, last)));
    }
    None
}

/// Coordinates of piece ends, mostly few.
type Coordinates = SmallVec<[f32; FEW_PIECES]>;

/// The first and the last plane inside a cell.
fn planes(cell: &Cell, axis: usize) -> [u32; 2] {
    // Borders of cells are planes or lines of the grid, so these products are whole.
    let steps = |x: f32| (x * PLANE_STEPS as f32) as u32;
    [steps(cell.low[axis]) + 1, steps(cell.high[axis]) - 1]
}

/// Planes to try: those that just leave a piece on one side for few pieces, evenly spaced for many.
fn candidates(cell: &Cell, axis: usize, least: &[f32], greatest: &[f32]) -> SmallVec<[u32; 64]> {
    let [first, last] = planes(cell, axis);
    if first > last {
        return SmallVec::new();
    }
    if least.len() > FEW_PIECES {
        let step = ((last - first + 1) / EVEN_CANDIDATES).max(1);
        return (first..=last).step_by(step as usize).collect();
    }
    let mut planes = SmallVec::from_slice(&[u32::midpoint(first, last)]);
    planes.extend(least.iter().map(|&end| (end * PLANE_STEPS as f32) as u32));
    planes.extend(greatest.iter().map(|&end| (end * PLANE_STEPS as f32).ceil() as u32));
    planes.retain(|plane| (first..=last).contains(plane));
    planes.sort_unstable();
    planes.dedup();
    planes
}
