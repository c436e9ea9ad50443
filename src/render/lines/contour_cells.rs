//! Contours within the square between four pixel centres: how its crossings are joined.

use super::Ends;
use super::stroke::Near;
use glam::DVec2;

/// How far, pixels, a contour that runs out may end before an edge that it runs into: the jump beside it is too little to be seen.
pub(super) const TO_EDGE: f64 = 2.5;

/// A place on a side of a cell where something ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Crossing {
    /// Pixels.
    pub(super) at: DVec2,
    /// Distance of what ends, from the eye.
    pub(super) depth: f64,
}

/// Joins the crossings of a cell's sides, at most one on each, in order around it.
///
/// Two are one line. Of three, the two that end at the most alike depths are one line, and the third ends at it: something goes on behind. Four are two
/// lines, of neighbouring sides at alike depths. A single one ends at a drawn edge where there is one near.
pub(super) fn lines_of_cell(sides: [Option<Crossing>; 4], near: &Near, lines: &mut Vec<Ends>) {
    let found: smallvec::SmallVec<[Crossing; 4]> = sides.into_iter().flatten().collect();
    let apart = |i: usize, j: usize| (found[i].depth - found[j].depth).abs();
    match found[..] {
        [a] => lines.extend(near.nearest(a.at, TO_EDGE).map(|end| [a.at, end])),
        [a, b] => lines.push([a.at, b.at]),
        [..] if found.len() == 3 => {
            let pairs = [(0, 1, 2), (1, 2, 0), (2, 0, 1)];
            let (i, j, k) = pairs
                .into_iter()
                .min_by(|p, q| apart(p.0, p.1).total_cmp(&apart(q.0, q.1)))
                .expect("three pairs");
            let ends = [found[i].at, found[j].at];
            lines.push(ends);
            let along = ends[1] - ends[0];
            let share = (found[k].at - ends[0]).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
            lines.push([found[k].at, ends[0] + along * share.clamp(0.0, 1.0)]);
        }
        [a, b, c, d] => {
            let is_first = apart(0, 1) + apart(2, 3) <= apart(1, 2) + apart(3, 0);
            let pairs = if is_first { [[a, b], [c, d]] } else { [[b, c], [d, a]] };
            lines.extend(pairs.map(|pair| pair.map(|crossing| crossing.at)));
        }
        _ => {}
    }
}
