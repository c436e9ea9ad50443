//! Whether a point of a face's parameter rectangle belongs to the face: one cell of the grid, or of a kd-tree below it, and the segments of that cell.
//!
//! The layout and the parity rule are those of [`crate::scene::trim_word`] and [`TrimSegment`]. A segment is monotone in u and in v, so the box
//! between its ends decides points beside it, and its band nearly all others; what is left needs the curve (`trim_curve`).

use super::tally::Tally;
use super::trim_curve::{ExactTest, is_right_of_chord, is_right_of_curve};
use super::trim_study::{TrimCounts, study_inside};
use super::vector::number;
use crate::numeric::Real;
use crate::scene::trim_study::BEFORE_ONE;
use crate::scene::trim_word::{
    FAR, HEADER_WORDS, MAX_SEGMENT, SHORT, TrimWord, beyond_cells, grid_cells, grid_levels, lengthen,
    position, short_cell, short_uniform, tree, uniform, unpack,
};
use crate::scene::{Band, Scene, TRIM_INSIDE, TrimMethod, TrimSegment};

/// Levels of a kd-tree: planes lie on a grid of 14 bits per axis.
const MAX_LEVELS: usize = 32;

/// What the trims say of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TrimPoint {
    /// Whether the point is inside.
    pub inside: bool,
    /// Whether a trim curve, or the border of a cell, may pass the box around the point.
    pub is_near: bool,
}

/// Whether `uv`, normalised and within the window, is inside the trims at `root`.
#[inline]
pub fn trim_inside<T: Real>(scene: &Scene<'_>, root: u32, uv: [T; 2]) -> bool {
    trim::<T, false, false>(scene, root, uv, [T::ZERO; 2], &mut TrimCounts::default()).inside
}

/// [`trim_inside`], counting.
pub fn trim_counted<T: Real>(scene: &Scene<'_>, root: u32, uv: [T; 2], counts: &mut TrimCounts) -> bool {
    counts.queries += 1;
    trim::<T, false, true>(scene, root, uv, [T::ZERO; 2], counts).inside
}

/// [`trim_inside`], and whether the box `uv ± extent` comes near a trim curve; the methods of the study do not know what is near.
pub fn trim_point<T: Real>(
    scene: &Scene<'_>,
    root: u32,
    uv: [T; 2],
    extent: [T; 2],
    tally: &mut impl Tally,
) -> TrimPoint {
    trim_tallied::<T, true>(scene, root, uv, extent, tally)
}

/// [`trim_inside`], taking note of its steps.
#[inline]
pub fn trim_inside_tallied<T: Real>(
    scene: &Scene<'_>,
    root: u32,
    uv: [T; 2],
    tally: &mut impl Tally,
) -> bool {
    trim_tallied::<T, false>(scene, root, uv, [T::ZERO; 2], tally).inside
}

#[inline(always)]
fn trim_tallied<T: Real, const NEAR: bool>(
    scene: &Scene<'_>,
    root: u32,
    uv: [T; 2],
    extent: [T; 2],
    tally: &mut impl Tally,
) -> TrimPoint {
    match tally.trims() {
        Some(counts) => {
            counts.queries += u64::from(root != TRIM_INSIDE);
            trim::<T, NEAR, true>(scene, root, uv, extent, counts)
        }
        None => trim::<T, NEAR, false>(scene, root, uv, extent, &mut TrimCounts::default()),
    }
}

/// The query by the scene's method; nearness only where `NEAR`, counts only where `COUNT`.
#[inline(always)]
fn trim<T: Real, const NEAR: bool, const COUNT: bool>(
    scene: &Scene<'_>,
    root: u32,
    uv: [T; 2],
    extent: [T; 2],
    counts: &mut TrimCounts,
) -> TrimPoint {
    if root == TRIM_INSIDE {
        return TrimPoint { inside: true, is_near: false };
    }
    if let Some(method) = study_method(scene) {
        let inside = match COUNT {
            true => study_inside::<T, true>(scene, method, root, uv, counts),
            // Counts that live here alone, so that other queries need not make any.
            false => study_trim(scene, method, root, uv),
        };
        return TrimPoint { inside, is_near: false };
    }
    packed::<T, NEAR, COUNT>(scene, root, uv, extent, counts)
}

/// The scene's method where it is one of the study, but for those of this program's own.
#[inline(always)]
pub fn study_method(scene: &Scene<'_>) -> Option<TrimMethod> {
    let number = scene.header.trim_method;
    if number < TrimMethod::PACKED.number() { TrimMethod::from_number(number) } else { None }
}

/// Apart, so that the queries of scenes for use need no registers for it.
#[cold]
#[inline(never)]
fn study_trim<T: Real>(scene: &Scene<'_>, method: TrimMethod, root: u32, uv: [T; 2]) -> bool {
    study_inside::<T, false>(scene, method, root, uv, &mut TrimCounts::default())
}

/// [`trim_inside`] of a face with trims in a scene of this program's own method.
#[inline(always)]
pub fn packed_inside<T: Real>(scene: &Scene<'_>, root: u32, uv: [T; 2]) -> bool {
    packed::<T, false, false>(scene, root, uv, [T::ZERO; 2], &mut TrimCounts::default()).inside
}

/// The query by this program's own method, of a face with trims.
#[inline(always)]
fn packed<T: Real, const NEAR: bool, const COUNT: bool>(
    scene: &Scene<'_>,
    root: u32,
    uv: [T; 2],
    extent: [T; 2],
    counts: &mut TrimCounts,
) -> TrimPoint {
    // Pieces along the window's far borders are in no cell: a point on them is decided just before.
    let uv = [uv[0].min(T::from_f32(BEFORE_ONE)), uv[1].min(T::from_f32(BEFORE_ONE))];
    let query = Query::<T, NEAR, COUNT> { scene, root: root as usize, uv, extent };
    let mut is_near = false;
    let inside = query.inside(&mut is_near, counts);
    TrimPoint { inside, is_near }
}

/// A cell: what most are, or the word that [`unpack`] tells the others by.
enum CellState {
    /// Without segments, inside or not.
    Uniform(bool),
    Other(u32),
}

/// A point asked of a face's trims.
struct Query<'a, T, const NEAR: bool, const COUNT: bool> {
    scene: &'a Scene<'a>,
    root: usize,
    uv: [T; 2],
    extent: [T; 2],
}

impl<T: Real, const NEAR: bool, const COUNT: bool> Query<'_, T, NEAR, COUNT> {
    #[inline(always)]
    fn inside(&self, is_near: &mut bool, counts: &mut TrimCounts) -> bool {
        let word = match self.trim_cell(is_near, counts) {
            CellState::Uniform(inside) => return inside,
            CellState::Other(word) => word,
        };
        match unpack(word) {
            TrimWord::Uniform { inside } => inside,
            TrimWord::One { corner, toggles, segment } => {
                corner ^ self.flips(toggles, segment, is_near, counts)
            }
            TrimWord::List { offset } => {
                let at = self.beyond_cells() + offset as usize;
                let head = self.scene.trim_nodes[at];
                let entries = &self.scene.trim_nodes[at + 1..at + 1 + (head & !(1 << 31)) as usize];
                let mut state = head >> 31 == 1;
                for entry in entries {
                    state ^= self.flips(entry >> 30, entry & MAX_SEGMENT, is_near, counts);
                }
                state
            }
            TrimWord::Inner { .. } | TrimWord::Tree { .. } => {
                *is_near = true;
                false
            }
        }
    }

    /// The word after the cells, from which offsets count.
    #[inline(always)]
    fn beyond_cells(&self) -> usize {
        self.root + beyond_cells(self.scene.trim_nodes[self.root])
    }

    /// What is known of the cell that the point lies in.
    #[inline(always)]
    fn trim_cell(&self, is_near: &mut bool, counts: &mut TrimCounts) -> CellState {
        let words = self.scene.trim_nodes;
        let grid = words[self.root];
        let levels = grid_levels(grid);
        let mut index = [0; 2];
        for axis in 0..2 {
            let scale = T::from_f32(grid_cells(levels[axis]));
            let scaled = self.uv[axis] * scale;
            index[axis] = scaled.to_u32();
            if NEAR {
                let within = scaled - T::from_f32(index[axis] as f32);
                let reach = self.extent[axis] * scale;
                *is_near |= within <= reach || T::ONE - within <= reach;
            }
        }
        if COUNT {
            counts.steps += 1;
        }
        let cells = &words[self.root + HEADER_WORDS..];
        let index = ((index[1] << levels[0]) | index[0]) as usize;
        let mut word;
        if grid & SHORT != 0 {
            let short = short_cell(cells, index);
            if let Some(inside) = short_uniform(short) {
                return CellState::Uniform(inside);
            }
            word = lengthen(short);
        } else {
            word = cells[index];
            if let Some(inside) = uniform(word) {
                return CellState::Uniform(inside);
            }
        }
        let Some(offset) = tree(word) else { return CellState::Other(word) };
        let mut at = self.beyond_cells() + offset as usize;
        word = words[at];
        for _ in 0..MAX_LEVELS {
            if COUNT {
                counts.steps += 1;
            }
            let TrimWord::Inner { axis, plane, right } = unpack(word) else { break };
            // No index: what is indexed lies in memory, for every query.
            let along = |pair: [T; 2]| if axis == 0 { pair[0] } else { pair[1] };
            let beyond = along(self.uv) - T::from_f32(position(plane));
            if NEAR {
                *is_near |= beyond.abs() <= along(self.extent);
            }
            let is_right = !(beyond < T::ZERO);
            at += if right == FAR {
                if is_right { words[at + 1] as usize } else { 2 }
            } else if is_right {
                right as usize
            } else {
                1
            };
            word = words[at];
        }
        CellState::Other(word)
    }

    /// Whether a segment of a cell flips the state of the cell's corner; sets `is_near` where it passes the box around the point.
    #[inline(always)]
    fn flips(&self, toggles: u32, segment: u32, is_near: &mut bool, counts: &mut TrimCounts) -> bool {
        let first = self.scene.trim_nodes[self.root + 1];
        let segment = &self.scene.trim_segments[(first + segment) as usize];
        let v = self.uv[1];
        let at_height = (v >= T::from_f32(segment.low[1])) & (v < T::from_f32(segment.high[1]));
        let crosses = if NEAR {
            self.crosses(segment, at_height, is_near, counts)
        } else {
            at_height && self.is_right(segment, self.uv, counts)
        };
        if toggles == 0 {
            return crosses;
        }
        let passed = |bit: u32, end: [f32; 2]| (toggles & bit != 0) & (v >= T::from_f32(end[1]));
        crosses ^ passed(1, segment.low) ^ passed(2, segment.high)
    }

    /// Whether the segment passes left of the point at the point's height; a monotone segment misses the box `uv ± extent` where the corner that it
    /// would meet first from its left, or from its right, is on the other side of it.
    fn crosses(
        &self,
        segment: &TrimSegment,
        at_height: bool,
        is_near: &mut bool,
        counts: &mut TrimCounts,
    ) -> bool {
        let (low, high): ([T; 2], [T; 2]) = (pair(segment.low), pair(segment.high));
        let (uv, extent) = (self.uv, self.extent);
        if uv[1] + extent[1] < low[1] || uv[1] - extent[1] > high[1] {
            return false;
        }
        if uv[0] - extent[0] >= low[0].max(high[0]) {
            return at_height;
        }
        if uv[0] + extent[0] < low[0].min(high[0]) {
            return false;
        }
        let up = if high[0] >= low[0] { extent[1] } else { -extent[1] };
        if low[1] < high[1] {
            if self.is_right(segment, [uv[0] - extent[0], uv[1] + up], counts) {
                return at_height;
            }
            if !self.is_right(segment, [uv[0] + extent[0], uv[1] - up], counts) {
                return false;
            }
        }
        *is_near = true;
        at_height && self.is_right(segment, uv, counts)
    }

    /// Whether the segment, which is not level, passes left of the point at the point's v, or at its own end that is nearest to that.
    ///
    /// Without branches but for what the band leaves undecided. A band by v gives the segment's u at the height; one by u its v, which is above or below.
    #[inline(always)]
    fn is_right(&self, segment: &TrimSegment, uv: [T; 2], counts: &mut TrimCounts) -> bool {
        let (low, high): ([T; 2], [T; 2]) = (pair(segment.low), pair(segment.high));
        let size = [high[0] - low[0], high[1] - low[1]];
        let at = [uv[0] - low[0], uv[1].max(low[1]).min(high[1]) - low[1]];
        let band = Band::unpack(segment.band);
        let (x, size_x, y, size_y) =
            if band.by_v { (at[1], size[1], at[0], size[0]) } else { (at[0], size[0], at[1], size[1]) };
        let beyond = y - size_y * band_middle(&band, (x / size_x).max(T::ZERO).min(T::ONE));
        let by_band = (beyond > T::ZERO) == (band.by_v || size[0] < T::ZERO);
        let is_decided = beyond.abs() > size_y.abs() * T::from_f32(band.half_width);
        if is_decided {
            return by_band;
        }
        let exact = is_right_of_segment(&self.scene.trim_nodes[self.root..], segment, uv, by_band);
        if COUNT && let Some(evaluations) = exact.evaluations {
            counts.exact_tests += 1;
            counts.evaluations += u64::from(evaluations);
        }
        exact.is_right
    }
}

/// Whether a segment passes left of a point, by the segment itself; `by_band` is what the middle of its band says. All by value: what is passed by
/// reference would be written to memory by every query that does not come here.
#[cold]
#[inline(never)]
fn is_right_of_segment<T: Real>(
    words: &[u32],
    segment: &TrimSegment,
    uv: [T; 2],
    by_band: bool,
) -> ExactTest {
    let (low, high): ([T; 2], [T; 2]) = (pair(segment.low), pair(segment.high));
    if uv[0] >= low[0].max(high[0]) {
        return ExactTest::by_ends(true);
    }
    if uv[0] < low[0].min(high[0]) {
        return ExactTest::by_ends(false);
    }
    // At its own ends the segment is known to the last bit, while a curve that is level there finds no u.
    if uv[1] <= low[1] {
        return ExactTest::by_ends(uv[0] >= low[0]);
    }
    if uv[1] >= high[1] {
        return ExactTest::by_ends(uv[0] >= high[0]);
    }
    match segment.degree() {
        0 => ExactTest::by_ends(by_band),
        1 => ExactTest::by_ends(is_right_of_chord(low, high, uv)),
        _ => is_right_of_curve(words, segment, uv),
    }
}

/// Without `map`, which the compiler does not always inline.
#[inline(always)]
fn pair<T: Real>(p: [f32; 2]) -> [T; 2] {
    [T::from_f32(p[0]), T::from_f32(p[1])]
}

/// Middle of a band; see [`Band`].
#[inline(always)]
fn band_middle<T: Real>(band: &Band, x: T) -> T {
    let slope = T::from_f32(band.bulge) + T::from_f32(band.skew) * (x + x - T::ONE);
    x + number::<T>(4.0) * x * (T::ONE - x) * slope
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneBuffers;
    use crate::scene::trim_word::{SHORT, grid, list_entry, list_head, pack, shorten};
    use std::f32::consts::FRAC_1_SQRT_2;

    const CENTER: f32 = 0.5;
    const RADIUS: f32 = 0.4;

    /// The four quarters of a circle, right upper first, counter-clockwise; their bands decide nothing. The curves follow the words.
    fn quarters(scene: &mut SceneBuffers) {
        let corners = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (1.0, 0.0_f32)];
        let place = |(x, y): (f32, f32)| [CENTER + RADIUS * x, CENTER + RADIUS * y];
        let band = Band::NONE.pack();
        for i in 0..4 {
            let (from, to) = (corners[i], corners[i + 1]);
            let [start, end] = [place(from), place(to)];
            let [u, v] = place((from.0 + to.0, from.1 + to.1)).map(|x| x * FRAC_1_SQRT_2);
            let offset = scene.trim_nodes.len() as u32;
            let numbers = [start[0], start[1], u, v, FRAC_1_SQRT_2, end[0], end[1]];
            scene.trim_nodes.extend(numbers.map(f32::to_bits));
            let falls = start[1] > end[1];
            let (low, high) = if falls { (end, start) } else { (start, end) };
            let curve = TrimSegment::curve_word(2, falls, true, offset).expect("small numbers");
            scene.trim_segments.push(TrimSegment { low, high, band, curve });
        }
    }

    fn assert_is_the_disc(words: &[u32]) {
        let mut scene = SceneBuffers { trim_nodes: words.to_vec(), ..SceneBuffers::default() };
        scene.header.trim_method = TrimMethod::PACKED.number();
        quarters(&mut scene);
        let scene = scene.scene();
        for i in 0..200 {
            for j in 0..200 {
                let uv = [(f64::from(i) + 0.31) / 200.0, (f64::from(j) + 0.77) / 200.0];
                let center = f64::from(CENTER);
                let gap = (uv[0] - center).hypot(uv[1] - center) - f64::from(RADIUS);
                assert_eq!(trim_inside(&scene, 0, uv), gap < 0.0, "{uv:?}");
                if gap.abs() > 1e-5 {
                    assert_eq!(trim_inside(&scene, 0, uv.map(|x| x as f32)), gap < 0.0, "{uv:?}");
                }
                let near = trim_point(&scene, 0, uv, [1e-3; 2], &mut ());
                assert_eq!(near.inside, gap < 0.0);
                assert!(near.is_near || gap.abs() > 1e-3, "{uv:?}");
            }
        }
    }

    #[test]
    fn one_cell_holds_a_circle() {
        let list = pack(TrimWord::List { offset: 0 });
        let entries = [0, 1, 2, 3].map(|segment| list_entry(0, segment));
        assert_is_the_disc(&[&[grid([0, 0]), 0, list, list_head(false, 4)][..], &entries].concat());
    }

    /// Right of u = ½ the upper quarter falls to the right and toggles at its upper end, the lower one rises and toggles at its lower end.
    fn right_half(offset: u32) -> [u32; 4] {
        let list = pack(TrimWord::List { offset });
        [list, list_head(false, 2), list_entry(2, 0), list_entry(1, 3)]
    }

    fn left_half(offset: u32) -> [u32; 4] {
        let list = pack(TrimWord::List { offset });
        [list, list_head(false, 2), list_entry(0, 1), list_entry(0, 2)]
    }

    /// Where two quarters meet in a level tangent, one step of f32 left of their common end: the curve's u is lost in the rounding of its v.
    #[test]
    fn what_lies_at_a_level_end_is_near() {
        let list = pack(TrimWord::List { offset: 0 });
        let entries = [0, 1, 2, 3].map(|segment| list_entry(0, segment));
        let trim_nodes = [&[grid([0, 0]), 0, list, list_head(false, 4)][..], &entries].concat();
        let mut scene = SceneBuffers { trim_nodes, ..SceneBuffers::default() };
        scene.header.trim_method = TrimMethod::PACKED.number();
        quarters(&mut scene);
        let lowest = scene.trim_segments[2].low;
        let scene = scene.scene();
        for by in -4..=4 {
            let u = f32::from_bits(lowest[0].to_bits().wrapping_add_signed(by));
            for v in [lowest[1].next_down(), lowest[1], lowest[1].next_up()] {
                assert!(trim_point(&scene, 0, [u, v], [1e-6; 2], &mut ()).is_near, "{by} {v}");
            }
        }
    }

    #[test]
    fn cells_of_a_grid_see_what_leaves_through_their_left_edge() {
        let [left, right] = [left_half(0), right_half(3)];
        let words = [&[grid([1, 0]), 0, left[0], right[0]][..], &left[1..], &right[1..]].concat();
        assert_is_the_disc(&words);
        let short = [left[0], right[0]].map(|word| shorten(word).expect("small numbers"));
        let header = [grid([1, 0]) | SHORT, 0, short[1] << 16 | short[0]];
        assert_is_the_disc(&[&header[..], &left[1..], &right[1..]].concat());
    }

    #[test]
    fn cells_of_a_tree_do_too_at_any_distance() {
        for is_far in [false, true] {
            let tree = pack(TrimWord::Tree { offset: 0 });
            let inner = |right: u32| pack(TrimWord::Inner { axis: 0, plane: 1 << 13, right });
            let header = [grid([0, 0]), 0, tree];
            let inner = if is_far { vec![inner(FAR), 6] } else { vec![inner(5)] };
            let at = inner.len() as u32;
            assert_is_the_disc(&[&header[..], &inner, &left_half(at + 1), &right_half(at + 5)].concat());
        }
    }
}
