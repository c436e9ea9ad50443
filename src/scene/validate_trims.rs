//! The trims of a scene: every word belongs to one face's root and is reached once, and every number that a query follows leads somewhere.

use super::trim_word::{self, TrimWord, grid_levels, unpack};
use super::validate::{Check, require};
use super::validate_study::structures;
use super::{Scene, TRIM_INSIDE, TrimMethod, TrimSegment, TrimStructure};

/// Levels of a tree at most: what the queries walk.
const MAX_DEPTH: u32 = 32;

/// Checks the trims of faces and leaves, and the curves.
pub(super) fn trims(scene: &Scene<'_>) -> Check {
    curves(scene)?;
    match TrimMethod::from_number(scene.header.trim_method) {
        None => require(false, "header", 0, "no such trim method")?,
        Some(method) if method.structure() == TrimStructure::Packed => packed(scene)?,
        Some(method) => structures(scene, method)?,
    }
    for (index, leaf) in scene.net_leaves.iter().enumerate() {
        let face = &scene.faces[scene.nets[leaf.net as usize].face as usize];
        let valid = leaf.trim == TRIM_INSIDE || leaf.trim == face.trim_root;
        require(valid, "net_leaves", index, "its trims are not its face's")?;
    }
    Ok(())
}

/// Checks the cells and trees of the default method.
fn packed(scene: &Scene<'_>) -> Check {
    let mut visited = vec![false; scene.trim_nodes.len()];
    for (index, face) in scene.faces.iter().enumerate() {
        if face.trim_root != TRIM_INSIDE {
            let root = Root::new(scene, face.trim_root as usize, &mut visited);
            require(root.is_some_and(Root::check), "faces", index, "its trims are inconsistent")?;
        }
    }
    Ok(())
}

fn curves(scene: &Scene<'_>) -> Check {
    for (index, segment) in scene.trim_segments.iter().enumerate() {
        let check = |condition, reason| require(condition, "trim_segments", index, reason);
        let is_unit = segment.low.iter().chain(&segment.high).all(|x| (0.0..=1.0).contains(x));
        check(is_unit, "a number is outside of 0..=1")?;
        check(segment.low[1] <= segment.high[1], "its ends are in the wrong order")?;
        let degree = segment.degree();
        check(degree <= 1 || degree <= scene.header.max_trim_degree, "its degree is out of range")?;
    }
    for (index, point) in scene.trim_points.iter().enumerate() {
        let valid = point.iter().all(|x| x.is_finite()) && point[2] > 0.0;
        require(valid, "trim_points", index, "it is not finite or its weight is not positive")?;
    }
    Ok(())
}

/// The trims of a face under examination.
struct Root<'a> {
    scene: &'a Scene<'a>,
    root: usize,
    cells: usize,
    /// The word after the cells, from which offsets count.
    beyond: usize,
    visited: &'a mut [bool],
}

impl<'a> Root<'a> {
    /// None where the header or the cells are beyond the array.
    fn new(scene: &'a Scene<'a>, root: usize, visited: &'a mut [bool]) -> Option<Self> {
        let grid = *scene.trim_nodes.get(root)?;
        let [along_u, along_v] = grid_levels(grid);
        let is_grid = along_u.max(along_v) <= trim_word::MAX_GRID_LEVEL;
        let cells = is_grid.then(|| 1_usize << (along_u + along_v))?;
        let beyond = root + trim_word::beyond_cells(grid);
        (beyond <= scene.trim_nodes.len()).then_some(Self { scene, root, cells, beyond, visited })
    }

    /// Whether all that the cells name is there and named once.
    fn check(mut self) -> bool {
        (self.root..self.beyond).all(|at| self.claim(at)) && (0..self.cells).all(|index| self.cell(index))
    }

    /// Whether nobody was at a word before.
    fn claim(&mut self, at: usize) -> bool {
        self.visited.get_mut(at).is_some_and(|seen| !std::mem::replace(seen, true))
    }

    fn cell(&mut self, index: usize) -> bool {
        let words = self.scene.trim_nodes;
        match unpack(trim_word::cell_word(
            &words[self.root + trim_word::HEADER_WORDS..],
            words[self.root],
            index,
        )) {
            TrimWord::Inner { .. } => false,
            TrimWord::Tree { offset } => self.tree(self.beyond + offset as usize),
            leaf => self.leaf(leaf),
        }
    }

    /// Whether a whole tree hangs from a word.
    fn tree(&mut self, root: usize) -> bool {
        let words = self.scene.trim_nodes;
        let mut open = vec![(root, 1)];
        while let Some((at, depth)) = open.pop() {
            if depth > MAX_DEPTH || !self.claim(at) {
                return false;
            }
            match unpack(words[at]) {
                TrimWord::Inner { right, .. } => {
                    let is_far = right == trim_word::FAR;
                    if is_far && !self.claim(at + 1) {
                        return false;
                    }
                    let distance = if is_far { words[at + 1] } else { right };
                    let (left, right) = (at + if is_far { 2 } else { 1 }, at + distance as usize);
                    if right <= left {
                        return false;
                    }
                    open.extend([(right, depth + 1), (left, depth + 1)]);
                }
                TrimWord::Tree { .. } => return false,
                leaf => {
                    if !self.leaf(leaf) {
                        return false;
                    }
                }
            }
        }
        true
    }

    fn leaf(&mut self, word: TrimWord) -> bool {
        match word {
            TrimWord::One { segment, .. } => self.segment(segment),
            TrimWord::List { offset } => {
                let at = self.beyond + offset as usize;
                if !self.claim(at) {
                    return false;
                }
                let count = (self.scene.trim_nodes[at] & !(1 << 31)) as usize;
                let entry = |root: &mut Self, at: usize| {
                    root.claim(at) && root.segment(root.scene.trim_nodes[at] & trim_word::MAX_SEGMENT)
                };
                (at + 1..at + 1 + count).all(|at| entry(self, at))
            }
            _ => true,
        }
    }

    fn segment(&self, segment: u32) -> bool {
        let index = self.scene.trim_nodes[self.root + 1] as usize + segment as usize;
        let Some(segment) = self.scene.trim_segments.get(index) else { return false };
        let first = self.root + (segment.curve & TrimSegment::OFFSET_MASK) as usize;
        let Some(words) = self.scene.trim_nodes.get(first..first + segment.curve_words()) else {
            return false;
        };
        let is_rational = segment.curve & TrimSegment::RATIONAL != 0;
        // The third number of each inner control point is a weight.
        let is_weight = |place: usize| is_rational && place > 2 && place + 2 < words.len() && place % 3 == 1;
        words.iter().enumerate().all(|(place, &word)| {
            let x = f32::from_bits(word);
            x.is_finite() && (x > 0.0 || !is_weight(place))
        })
    }
}
