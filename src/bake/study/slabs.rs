//! Horizontal slabs (HS; Schollmeyer and Fröhlich 2009, section 3.3): all heights of curve ends cut the curves, and in each slab the ends of their u-ranges
//! make intervals with the parity of what is left of them and a list of the curves above them.
//!
//! The pieces of a curve in several slabs have control points of their own, as in both papers: memory is the product of heights and of curves there.

use super::super::region::{Piece, Region};
use super::Structure;
use super::elements::is_horizontal;
use crate::scene::TrimMethod;
use crate::scene::trim_study::{MANY_CURVES, ODD_BIT, PLACES};

/// Pieces of all slabs: beyond it places do not fit.
const MAX_PIECES: usize = PLACES as usize / 16;

pub(super) fn build(region: &Region, method: TrimMethod) -> Result<Structure, String> {
    let pieces = region.pieces.iter().filter(|piece| !is_horizontal(piece));
    let mut heights: Vec<f32> = pieces.clone().flat_map(|p| [p.low[1], p.high[1]]).collect();
    heights.sort_unstable_by(f32::total_cmp);
    heights.dedup();
    let count = heights.len().saturating_sub(1);
    let mut result = Structure { words: vec![0, count as u32], ..Structure::default() };
    if count == 0 {
        return Ok(result);
    }
    let mut slabs: Vec<Vec<Piece>> = vec![Vec::new(); count];
    let mut total = 0;
    for piece in pieces {
        let mut rest = Some(*piece);
        let first = heights.partition_point(|&v| v <= piece.low[1]);
        for slab in first - 1..count {
            let Some(piece) = rest else { break };
            let [below, above] = region.clip(&piece, 1, heights[slab + 1]);
            slabs[slab].extend(below);
            total += 1;
            rest = above;
        }
        if total > MAX_PIECES {
            return Err(format!("{} trim curves are too many for slabs", region.pieces.len()));
        }
    }
    result.words.extend(heights.iter().map(|v| v.to_bits()));
    let table = result.words.len();
    result.words.resize(table + count, 0);
    let plans: Vec<Plan> = slabs.iter().map(|pieces| Plan::new(pieces)).collect();
    // Elements come last; their places follow from the sizes of what comes before.
    let ahead: usize = plans.iter().map(Plan::words).sum();
    let mut elements = Structure { max_degree: 0, ..Structure::default() };
    let first_element = result.words.len() + ahead;
    for (slab, (plan, pieces)) in plans.iter().zip(&slabs).enumerate() {
        let places: Vec<u32> = pieces
            .iter()
            .map(|piece| first_element as u32 + elements.push_element(region, piece, method.has_boxing()))
            .collect();
        result.words[table + slab] = result.words.len() as u32;
        plan.write(&mut result.words, &places);
    }
    result.words.append(&mut elements.words);
    result.points = elements.points;
    result.max_degree = elements.max_degree;
    if result.words.len() >= PLACES as usize {
        return Err(format!("{} trim curves are too many for slabs", region.pieces.len()));
    }
    Ok(result)
}

/// The intervals of one slab.
struct Plan {
    ends: Vec<f32>,
    /// Whether curves left of it are odd in number, and the curves above it.
    intervals: Vec<(bool, Vec<u32>)>,
}

impl Plan {
    fn new(pieces: &[Piece]) -> Self {
        let mut ends: Vec<f32> = pieces.iter().flat_map(|piece| piece.range(0)).collect();
        ends.sort_unstable_by(f32::total_cmp);
        ends.dedup();
        if ends.is_empty() {
            // A slab between loops: as one of vertical lines at one place, it has an end and no interval.
            ends.push(0.0);
        }
        let intervals = ends
            .windows(2)
            .map(|interval| {
                let is_left = |piece: &&Piece| piece.range(0)[1] <= interval[0];
                let odd = pieces.iter().filter(is_left).count() % 2 == 1;
                let is_above = |piece: &Piece| {
                    let [least, greatest] = piece.range(0);
                    least <= interval[0] && greatest >= interval[1]
                };
                let above = (0..pieces.len()).filter(|&i| is_above(&pieces[i])).map(|i| i as u32);
                (odd, above.collect())
            })
            .collect();
        Self { ends, intervals }
    }

    /// Words of a list of `count` places.
    fn list_words(count: usize) -> usize {
        match count {
            0 | 1 => 0,
            _ => count + usize::from(count >= MANY_CURVES as usize),
        }
    }

    fn words(&self) -> usize {
        let lists: usize = self.intervals.iter().map(|(_, list)| Self::list_words(list.len())).sum();
        1 + self.ends.len() + self.intervals.len() + lists
    }

    /// Appends the slab; `places` are those of its elements.
    fn write(&self, words: &mut Vec<u32>, places: &[u32]) {
        words.push(self.intervals.len() as u32);
        words.extend(self.ends.iter().map(|u| u.to_bits()));
        let mut place = words.len() + self.intervals.len();
        for (odd, list) in &self.intervals {
            let count = (list.len() as u32).min(MANY_CURVES);
            let at = match list[..] {
                [] => 0,
                [only] => places[only as usize],
                _ => place as u32,
            };
            words.push(if *odd { ODD_BIT } else { 0 } | count << 24 | at & (PLACES - 1));
            place += Self::list_words(list.len());
        }
        for (_, list) in self.intervals.iter().filter(|(_, list)| list.len() > 1) {
            if list.len() >= MANY_CURVES as usize {
                words.push(list.len() as u32);
            }
            words.extend(list.iter().map(|&i| places[i as usize]));
        }
    }
}
