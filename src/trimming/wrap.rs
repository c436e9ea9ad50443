//! Cutting loops of the universal cover to one period.
//!
//! All segments are cut at the lines `c + k · period` and moved into `[c, c + period]`. What is left is no longer
//! closed: segments end on the two sides of the strip. Inside is an odd number of crossings, and far out along the
//! other parameter nothing is inside; so on each side the ends, sorted, are joined in pairs, and this closure is the only
//! finite one. Segments that lie on the sides are dropped before, as the closure restores them where they count.

use super::TrimError;
use super::segment::{
    Segment, control, end, is_constant, point_at, set_end, set_start, shift, start, straight, with_axis,
    with_unit_ends,
};
use crate::geometry::Homogeneous;
use glam::DVec2;

/// A loop may run round this many times (threads of long screws).
const MAX_TURNS: f64 = 4096.0;

/// The strip `[origin, origin + period]` of parameter `axis`.
#[derive(Clone, Copy)]
pub(super) struct Strip {
    pub(super) axis: usize,
    pub(super) origin: f64,
    pub(super) period: f64,
    /// Points closer to a side are on it.
    pub(super) snap: f64,
}

impl Strip {
    fn line(&self, k: f64) -> f64 {
        self.origin + k * self.period
    }

    fn turns(&self, x: f64) -> f64 {
        (x - self.origin) / self.period
    }

    /// `x`, on the nearest line where it is close to it.
    fn snapped(&self, x: f64) -> f64 {
        let line = self.line(self.turns(x).round());
        if (x - line).abs() <= self.snap { line } else { x }
    }
}

/// Cuts closed chains of monotone segments, each `winding` periods long, into the strip and closes them there. Also returns how
/// far end points moved to lie on a side, in parameters.
pub(super) fn wrap(chains: Vec<Vec<Segment>>, strip: Strip) -> Result<(Vec<Segment>, f64), TrimError> {
    let mut inside = Vec::new();
    let mut moved = 0.0f64;
    for chain in chains {
        let mut pieces = Vec::new();
        for segment in chain {
            for x in [start(&segment), end(&segment)].map(|p| p[strip.axis]) {
                moved = moved.max((strip.snapped(x) - x).abs());
            }
            cut(segment, &strip, &mut pieces)?;
        }
        // A chain that winds around ends a period from its start: after wrapping that is one point.
        let count = pieces.len();
        if count > 1 {
            let (head, tail) = (start(&pieces[0]), end(&pieces[count - 1]));
            let apart = (head - tail).abs().max_element();
            if head != tail && apart <= strip.snap {
                moved = moved.max(apart);
                set_end(&mut pieces[count - 1], head);
            }
        }
        inside.extend(pieces);
    }
    let (low, high) = (strip.line(0.0), strip.line(1.0));
    inside
        .retain(|piece| !(is_constant(piece, strip.axis) && [low, high].contains(&start(piece)[strip.axis])));
    for side in [low, high] {
        close_side(&mut inside, strip.axis, side)?;
    }
    Ok((inside, moved))
}

/// Joins the ends on the line `axis = side` in pairs.
fn close_side(segments: &mut Vec<Segment>, axis: usize, side: f64) -> Result<(), TrimError> {
    let across = 1 - axis;
    let mut ends: Vec<f64> = segments
        .iter()
        .flat_map(|s| [start(s), end(s)])
        .filter(|p| p[axis] == side)
        .map(|p| p[across])
        .collect();
    if ends.len() % 2 == 1 {
        return Err(TrimError::Numeric("the loops do not close around the surface".into()));
    }
    ends.sort_by(f64::total_cmp);
    for pair in ends.chunks_exact(2) {
        if pair[0] < pair[1] {
            let corner = |value| with_axis(DVec2::splat(value), axis, side);
            segments.push(straight(corner(pair[0]), corner(pair[1])));
        }
    }
    Ok(())
}

/// Cuts a monotone segment at the lines and moves the pieces into the strip.
fn cut(mut segment: Segment, strip: &Strip, out: &mut Vec<Segment>) -> Result<(), TrimError> {
    let axis = strip.axis;
    let (a, b) = (start(&segment), end(&segment));
    let (from, to) = (strip.snapped(a[axis]), strip.snapped(b[axis]));
    if strip.turns(to).abs().max(strip.turns(from).abs()) > MAX_TURNS {
        return Err(TrimError::Numeric("a loop winds around the surface too often".into()));
    }
    set_start(&mut segment, with_axis(a, axis, from));
    set_end(&mut segment, with_axis(b, axis, to));
    let (low, high) = (from.min(to), from.max(to));
    let mut k = strip.turns(low).floor();
    let mut lines = Vec::new();
    while strip.line(k) < high {
        if strip.line(k) > low {
            lines.push(strip.line(k));
        }
        k += 1.0;
    }
    if from > to {
        lines.reverse();
    }
    for line in lines {
        let t = crossing(&segment, axis, line);
        let [mut left, mut right] = segment.split(t);
        let joint = with_axis(point_at(&segment, t), axis, line);
        let failed = || TrimError::Numeric("a loop cannot be cut at the period".into());
        left = with_unit_ends(left).ok_or_else(failed)?;
        right = with_unit_ends(right).ok_or_else(failed)?;
        set_end(&mut left, joint);
        set_start(&mut right, joint);
        push_moved(left, strip, out);
        segment = right;
    }
    push_moved(segment, strip, out);
    Ok(())
}

/// Moves a piece that lies between two lines into the strip.
fn push_moved(mut piece: Segment, strip: &Strip, out: &mut Vec<Segment>) {
    let axis = strip.axis;
    let (from, to) = (start(&piece), end(&piece));
    let k = strip.turns(0.5 * (from[axis] + to[axis])).floor();
    let (low, high) = (strip.line(0.0), strip.line(1.0));
    // The ends on lines must come out on the sides exactly, the others only move.
    let moved = |x: f64| {
        if x == strip.line(k) {
            low
        } else if x == strip.line(k + 1.0) {
            high
        } else {
            (x - k * strip.period).clamp(low, high)
        }
    };
    let (from, to) = (with_axis(from, axis, moved(from[axis])), with_axis(to, axis, moved(to[axis])));
    if k != 0.0 {
        shift(&mut piece, with_axis(DVec2::ZERO, axis, -k * strip.period));
    }
    set_start(&mut piece, from);
    set_end(&mut piece, to);
    let (least, greatest) = (from[axis].min(to[axis]), from[axis].max(to[axis]));
    for point in &mut piece.points {
        let position = point.point();
        let inside = position[axis].clamp(low.min(least), high.max(greatest));
        if inside != position[axis] {
            *point = control(with_axis(position, axis, inside), point.weight());
        }
    }
    out.push(piece);
}

/// Where a monotone segment meets the line; by bisection, as nothing is gained by speed here.
fn crossing(segment: &Segment, axis: usize, line: f64) -> f64 {
    let rising = end(segment)[axis] > start(segment)[axis];
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if (point_at(segment, middle)[axis] < line) == rising { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}
