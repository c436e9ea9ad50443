//! The trimmed region of a face in normalised parameters, ready for exact bookkeeping in f32.
//!
//! Curves stay f64; their end points become f32 once, here, and every later clip shares its f32 vertex between the two pieces it makes. So the
//! pieces of a region always form closed chains bit for bit, and parities found by counting shared vertices cannot disagree.

use crate::geometry::{Bezier, Homogeneous, Homogeneous2};
use crate::numeric::bernstein::{Coefficients, eval_with_derivative};
use crate::numeric::roots::bracketed_root;
use crate::scene::MAX_DEGREE;
use crate::trimming::FaceTrim;
use glam::DVec2;

/// A region with more loose ends than this is no set of loops; closing takes their square in time.
const MAX_OPEN_VERTICES: usize = 1024;

/// Control points nearer than this to their chord make a straight line: below half the spacing of f32 numbers near 1.
const STRAIGHT: f64 = 2.5e-8;

/// Curve parameters in [0, 1] are found this closely: a few roundings.
const PARAMETER_TOLERANCE: f64 = 4.0 * f64::EPSILON;

/// A piece of a curve, monotone in u and in v.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Piece {
    /// Index of the curve; the piece is the straight line between its ends where there is none.
    pub curve: Option<u32>,
    /// Curve parameters at `low` and `high`.
    pub t: [f64; 2],
    /// The end with the lesser v; of equal ones that with the lesser u.
    pub low: [f32; 2],
    /// The other end.
    pub high: [f32; 2],
    /// Index of the whole piece that clipping made this one from.
    pub source: u32,
}

impl Piece {
    fn new(curve: Option<u32>, t: [f64; 2], ends: [[f32; 2]; 2], source: u32) -> Self {
        let [a, b] = ends;
        if (a[1], a[0]) <= (b[1], b[0]) {
            Self { curve, t, low: a, high: b, source }
        } else {
            Self { curve, t: [t[1], t[0]], low: b, high: a, source }
        }
    }

    /// Least and greatest coordinate along an axis.
    pub(super) fn range(&self, axis: usize) -> [f32; 2] {
        let (a, b) = (self.low[axis], self.high[axis]);
        [a.min(b), a.max(b)]
    }

    /// Whether it is a point.
    pub(super) fn is_point(&self) -> bool {
        self.low == self.high
    }

    /// Whether all of it has the coordinate `value` along `axis`.
    pub(super) fn lies_at(&self, axis: usize, value: f32) -> bool {
        self.low[axis] == value && self.high[axis] == value
    }
}

/// A rectangle of normalised parameters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Rectangle {
    /// Least u and v.
    pub low: [f32; 2],
    /// Greatest u and v.
    pub high: [f32; 2],
}

/// Curves and pieces of one face; without pieces the whole window is inside.
#[derive(Debug, Clone, Default)]
pub(super) struct Region {
    /// Normalised: the window is [0, 1]².
    pub curves: Vec<Bezier<Homogeneous2>>,
    /// Closed chains.
    pub pieces: Vec<Piece>,
    /// Whether the file's trim has any curve.
    pub is_bounded: bool,
}

impl Region {
    /// The region of `trim`, whose window is finite and has an area.
    pub(super) fn new(trim: &FaceTrim) -> Result<Self, String> {
        let low = trim.window.min;
        let scale = DVec2::ONE / (trim.window.max - low);
        let curves: Vec<_> = trim.curves.iter().map(|curve| normalised(curve, low, scale)).collect();
        let mut ends = Vec::with_capacity(curves.len());
        for curve in &curves {
            let degree = curve.points.len().saturating_sub(1);
            if !(1..=MAX_DEGREE as usize).contains(&degree) {
                return Err(format!("a trim curve has degree {degree}"));
            }
            // As the scene will hold them: weights may be too small for f32, and points too far out.
            if !curve.points.iter().map(|p| p.as_vec3()).all(|p| p.is_finite() && p.z >= f32::MIN_POSITIVE) {
                return Err("a trim curve has points or weights beyond single precision".into());
            }
            ends.push([vertex(curve.points[0]), vertex(curve.points[degree])]);
        }
        let links = closing_links(&ends)?;
        let mut pieces = Vec::with_capacity(ends.len() + links.len());
        for (index, curve) in curves.iter().enumerate() {
            let curve_index = (!is_straight(curve)).then_some(index as u32);
            pieces.push(Piece::new(curve_index, [0.0, 1.0], ends[index], 0));
        }
        pieces.extend(links.into_iter().map(|link| Piece::new(None, [0.0, 1.0], link, 0)));
        pieces.retain(|piece| !piece.is_point());
        number(&mut pieces);
        Ok(Self { is_bounded: !curves.is_empty(), curves, pieces })
    }

    /// Where `piece` reaches the coordinate `value` along `axis`, which must lie between its ends: curve parameter and the other coordinate.
    pub(super) fn solve(&self, piece: &Piece, axis: usize, value: f32) -> (f64, f32) {
        let other = 1 - axis;
        let target = f64::from(value);
        let (from, to) = (f64::from(piece.low[axis]), f64::from(piece.high[axis]));
        let (t, found) = match piece.curve {
            None => {
                let share = ((target - from) / (to - from)).clamp(0.0, 1.0);
                let (a, b) = (f64::from(piece.low[other]), f64::from(piece.high[other]));
                (piece.t[0] + share * (piece.t[1] - piece.t[0]), a + share * (b - a))
            }
            Some(curve) => {
                let curve = &self.curves[curve as usize];
                let t = parameter_at(&curve.points, axis, target, piece.t, from < to);
                (t, curve.eval(t).point()[other])
            }
        };
        let [least, greatest] = piece.range(other);
        (t, single(found).clamp(least, greatest))
    }

    /// The parts of `piece` below and above `value` along `axis`, sharing their vertex at exactly `value`; points are left out.
    pub(super) fn clip(&self, piece: &Piece, axis: usize, value: f32) -> [Option<Piece>; 2] {
        let [least, greatest] = piece.range(axis);
        if greatest <= value && least < value {
            return [Some(*piece), None];
        }
        if least >= value {
            return [None, Some(*piece)];
        }
        let (t, across) = self.solve(piece, axis, value);
        let mut vertex = [value; 2];
        vertex[1 - axis] = across;
        let first = Piece::new(piece.curve, [piece.t[0], t], [piece.low, vertex], piece.source);
        let second = Piece::new(piece.curve, [t, piece.t[1]], [vertex, piece.high], piece.source);
        let (below, above) = if piece.low[axis] < value { (first, second) } else { (second, first) };
        [(!below.is_point()).then_some(below), (!above.is_point()).then_some(above)]
    }

    /// The halves of a curved piece; the piece alone where f32 has no vertex between its ends.
    pub(super) fn halves(&self, piece: &Piece) -> [Option<Piece>; 2] {
        let Some(curve) = piece.curve else { return [Some(*piece), None] };
        let t = 0.5 * (piece.t[0] + piece.t[1]);
        let at = self.curves[curve as usize].eval(t).point();
        let vertex = [0, 1].map(|axis| {
            let [least, greatest] = piece.range(axis);
            single(at[axis]).clamp(least, greatest)
        });
        let parts = [
            Piece::new(piece.curve, [piece.t[0], t], [piece.low, vertex], piece.source),
            Piece::new(piece.curve, [t, piece.t[1]], [vertex, piece.high], piece.source),
        ];
        let is_proper = |part: &Piece| (0..2).all(|axis| part.low[axis] != part.high[axis]);
        if parts.iter().all(is_proper) { parts.map(Some) } else { [Some(*piece), None] }
    }

    /// Whether `piece` may have a point in `rectangle`; a no is certain up to f32 rounding.
    pub(super) fn touches(&self, piece: &Piece, rectangle: &Rectangle) -> bool {
        let mut low = rectangle.low;
        let mut high = rectangle.high;
        for axis in 0..2 {
            let [least, greatest] = piece.range(axis);
            low[axis] = low[axis].max(least);
            high[axis] = high[axis].min(greatest);
            if low[axis] > high[axis] {
                return false;
            }
        }
        if piece.lies_at(0, piece.low[0]) || piece.lies_at(1, piece.low[1]) {
            return true;
        }
        // A monotone piece misses the rectangle where the corner that is first met from its left or from its right is beyond it.
        let rising = piece.high[0] > piece.low[0];
        let (left_test, right_test) = if rising {
            ([high[0], low[1]], [low[0], high[1]])
        } else {
            ([high[0], high[1]], [low[0], low[1]])
        };
        let all_left = || self.solve(piece, 1, left_test[1]).1 > left_test[0];
        let all_right = || self.solve(piece, 1, right_test[1]).1 < right_test[0];
        !(all_left() || all_right())
    }
}

/// Makes each piece its own source.
pub(super) fn number(pieces: &mut [Piece]) {
    for (index, piece) in pieces.iter_mut().enumerate() {
        piece.source = index as u32;
    }
}

/// Where a curve that is monotone along `axis` between the parameters `range` reaches the coordinate `target`; an end of the range where
/// all of it lies on one side. `rises`: whether the coordinate grows from `range[0]` to `range[1]`.
pub(super) fn parameter_at(
    points: &[Homogeneous2],
    axis: usize,
    target: f64,
    range: [f64; 2],
    rises: bool,
) -> f64 {
    // Weights are positive, so X − target · W has the sign of X / W − target.
    let off: Coefficients = points.iter().map(|p| p[axis] - target * p.z).collect();
    let is_before = |t: f64| (eval_with_derivative(&off, t).0 < 0.0) == rises;
    let [from, to] = range;
    if !is_before(from) {
        from
    } else if is_before(to) {
        to
    } else {
        let bracket = [from.min(to), from.max(to)];
        bracketed_root(|t| eval_with_derivative(&off, t), bracket, PARAMETER_TOLERANCE)
    }
}

/// `curve` in window units.
fn normalised(curve: &Bezier<Homogeneous2>, low: DVec2, scale: DVec2) -> Bezier<Homogeneous2> {
    let map = |p: &Homogeneous2| ((p.truncate() - low * p.z) * scale).extend(p.z);
    Bezier { points: curve.points.iter().map(map).collect() }
}

/// The f32 vertex of an end point, held to the window.
fn vertex(point: Homogeneous2) -> [f32; 2] {
    point.point().to_array().map(|x| single(x.clamp(0.0, 1.0)))
}

/// A coordinate of the window in f32, a multiple of 2⁻⁵²: processors that flush subnormal numbers to zero would move a lesser one.
fn single(x: f64) -> f32 {
    ((x + 1.0) - 1.0) as f32
}

/// Whether the control points lie on the chord.
fn is_straight(curve: &Bezier<Homogeneous2>) -> bool {
    let first = curve.points[0].point();
    let chord = curve.points[curve.points.len() - 1].point() - first;
    let Some(direction) = chord.try_normalize() else {
        return true;
    };
    curve.points.iter().all(|p| direction.perp_dot(p.point() - first).abs() <= STRAIGHT)
}

/// Straight links that close what stays open: loops are closed where every vertex is the end of an even number of curves, in whatever order and
/// direction the curves come. Trimming closes its loops bit for bit in f64, so there is nothing to do but for curves that lie almost outside the window.
fn closing_links(ends: &[[[f32; 2]; 2]]) -> Result<Vec<[[f32; 2]; 2]>, String> {
    let mut vertices: Vec<[f32; 2]> = ends.iter().flatten().copied().collect();
    vertices.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let mut open: Vec<[f32; 2]> =
        vertices.chunk_by(|a, b| a == b).filter(|same| same.len() % 2 == 1).map(|same| same[0]).collect();
    if open.len() > MAX_OPEN_VERTICES {
        return Err(format!("its trim curves have {} loose ends", open.len()));
    }
    let mut links = Vec::with_capacity(open.len() / 2);
    while let Some(from) = open.pop() {
        let distance = |p: &[f32; 2]| (p[0] - from[0]).hypot(p[1] - from[1]);
        let nearest = (0..open.len()).min_by(|&a, &b| distance(&open[a]).total_cmp(&distance(&open[b])));
        let nearest = nearest.expect("the ends of curves are even in number, so the odd vertices are too");
        links.push([from, open.swap_remove(nearest)]);
    }
    Ok(links)
}
