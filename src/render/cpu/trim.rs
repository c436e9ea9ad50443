//! Whether a point of a face's parameter rectangle belongs to the face: a walk down the kd-tree, then the segments of one cell.
//!
//! The layout and the parity rule are those of [`crate::scene::trim_node`] and [`TrimSegment`]. A segment is monotone in u and in v, so the box
//! between its ends decides most points; the others bisect the curve (Schollmeyer and Fröhlich 2009), each evaluation shrinking the box.

use super::trim_study::{TrimCounts, study_inside};
use super::vector::number;
use crate::numeric::Real;
use crate::scene::trim_node::{FAR, MANY, TrimNode, child_range, split_position, unpack};
use crate::scene::trim_study::BEFORE_ONE;
use crate::scene::{Scene, TRIM_INSIDE, TrimMethod, TrimSegment};

/// Bisections of a curve piece: enough for f64's 52 bits.
const MAX_BISECTIONS: usize = 52;

/// Levels of a trim tree: each takes at least a word, and planes lie on a grid of 14 bits per axis and level.
const MAX_LEVELS: usize = 64;

/// What the trim tree says of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TrimPoint {
    /// Whether the point is inside.
    pub inside: bool,
    /// Whether a trim curve, or the border of a cell, may pass the box around the point.
    pub is_near: bool,
}

/// Whether `uv`, normalised and within the window, is inside the trims of the tree at `root`.
pub fn trim_inside<T: Real>(scene: &Scene<'_>, root: u32, uv: [T; 2]) -> bool {
    trim_point(scene, root, uv, [-T::ONE; 2]).inside
}

/// [`trim_inside`], and whether the box `uv ± extent` comes near a trim curve; where the extent is negative it never does.
pub fn trim_point<T: Real>(scene: &Scene<'_>, root: u32, uv: [T; 2], extent: [T; 2]) -> TrimPoint {
    if root == TRIM_INSIDE {
        return TrimPoint { inside: true, is_near: false };
    }
    if scene.header.trim_method != TrimMethod::PACKED.number() {
        let inside = TrimMethod::from_number(scene.header.trim_method).is_some_and(|method| {
            study_inside::<T, false>(scene, method, root, uv, &mut TrimCounts::default())
        });
        return TrimPoint { inside, is_near: false };
    }
    // Pieces along the window's far borders are in no cell: a point on them is decided just before.
    let uv = uv.map(|x| x.min(T::from_f32(BEFORE_ONE)));
    let mut node = root as usize;
    let mut low = [0.0_f32; 2];
    let mut size = [1.0_f32; 2];
    let mut is_near = false;
    for _ in 0..MAX_LEVELS {
        match unpack(scene.trim_nodes[node]) {
            TrimNode::Inner { axis, plane, right } => {
                let axis = axis as usize;
                let split = split_position(low[axis], size[axis], plane);
                let far = right == FAR;
                let beyond = uv[axis] - T::from_f32(split);
                is_near |= beyond.abs() <= extent[axis];
                let is_right = !(beyond < T::ZERO);
                (low[axis], size[axis]) = child_range(low[axis], size[axis], split, is_right);
                node += match (is_right, far) {
                    (false, false) => 1,
                    (false, true) => 2,
                    (true, false) => right as usize,
                    (true, true) => scene.trim_nodes[node + 1] as usize,
                };
            }
            TrimNode::Leaf { inside, count, first } => {
                let base = scene.trim_nodes[root as usize - 1] + first;
                let count = if count == MANY { scene.trim_nodes[node + 1] } else { count };
                let inside = leaf_parity(scene, inside, base, count, uv, extent, &mut is_near);
                return TrimPoint { inside, is_near };
            }
        }
    }
    TrimPoint { inside: false, is_near: true }
}

fn leaf_parity<T: Real>(
    scene: &Scene<'_>,
    corner: bool,
    first: u32,
    count: u32,
    uv: [T; 2],
    extent: [T; 2],
    is_near: &mut bool,
) -> bool {
    let mut inside = corner;
    for index in first..first + count {
        let segment = &scene.trim_segments[index as usize];
        inside ^= crosses(scene, segment, uv, extent, is_near) != crosses_left_edge(segment, uv[1]);
    }
    inside
}

/// Whether the way along the cell's left edge up to `v` passes an odd number of the segment's ends.
#[inline]
fn crosses_left_edge<T: Real>(segment: &TrimSegment, v: T) -> bool {
    let low = segment.flags & TrimSegment::LOW_ON_LEFT_EDGE != 0 && v >= T::from_f32(segment.low[1]);
    let high = segment.flags & TrimSegment::HIGH_ON_LEFT_EDGE != 0 && v >= T::from_f32(segment.high[1]);
    low != high
}

/// Whether the segment passes left of the point, at the point's v. Sets `is_near` where it passes the box `uv ± extent`.
///
/// A monotone segment misses the box where the corner that it would meet first from its left, or from its right, is on the other side of it.
#[inline]
fn crosses<T: Real>(
    scene: &Scene<'_>,
    segment: &TrimSegment,
    uv: [T; 2],
    extent: [T; 2],
    is_near: &mut bool,
) -> bool {
    let low = segment.low.map(T::from_f32);
    let high = segment.high.map(T::from_f32);
    let at_height = uv[1] >= low[1] && uv[1] < high[1];
    let reach = extent.map(|e| e.max(T::ZERO));
    if uv[1] + reach[1] < low[1] || uv[1] - reach[1] > high[1] {
        return false;
    }
    if uv[0] - reach[0] >= low[0].max(high[0]) {
        return at_height;
    }
    if uv[0] + reach[0] < low[0].min(high[0]) {
        return false;
    }
    if !(extent[0] >= T::ZERO) {
        return at_height && is_right(scene, segment, uv);
    }
    let up = if high[0] >= low[0] { reach[1] } else { -reach[1] };
    if low[1] < high[1] {
        if is_right(scene, segment, [uv[0] - reach[0], uv[1] + up]) {
            return at_height;
        }
        if !is_right(scene, segment, [uv[0] + reach[0], uv[1] - up]) {
            return false;
        }
    }
    *is_near = true;
    at_height && is_right(scene, segment, uv)
}

/// Whether the segment, which rises, passes left of the point at the point's v, or at its own end that is nearest to that.
fn is_right<T: Real>(scene: &Scene<'_>, segment: &TrimSegment, uv: [T; 2]) -> bool {
    let low = segment.low.map(T::from_f32);
    let high = segment.high.map(T::from_f32);
    let v = uv[1].max(low[1]).min(high[1]);
    let degree = segment.flags & TrimSegment::DEGREE_MASK;
    if degree <= 1 {
        return line_at(low, high, v) <= uv[0];
    }
    bisect(scene, segment, degree, low, high, [uv[0], v])
}

/// u of the chord at `v`.
#[inline(always)]
fn line_at<T: Real>(low: [T; 2], high: [T; 2], v: T) -> T {
    low[0] + (high[0] - low[0]) * ((v - low[1]) / (high[1] - low[1]))
}

fn bisect<T: Real>(
    scene: &Scene<'_>,
    segment: &TrimSegment,
    degree: u32,
    low: [T; 2],
    high: [T; 2],
    uv: [T; 2],
) -> bool {
    let (mut low, mut high) = (low, high);
    let (mut t_low, mut t_high) = (T::from_f32(segment.t_low), T::from_f32(segment.t_high));
    if uv[0] >= low[0].max(high[0]) || uv[0] < low[0].min(high[0]) {
        return uv[0] >= low[0].max(high[0]);
    }
    for _ in 0..MAX_BISECTIONS {
        let t = (t_low + t_high) * number(0.5);
        if t == t_low || t == t_high {
            break;
        }
        let at = curve_point(scene, segment.curve, degree, t);
        if at[1] <= uv[1] {
            low = at;
            t_low = t;
        } else {
            high = at;
            t_high = t;
        }
        if uv[0] >= low[0].max(high[0]) {
            return true;
        }
        if uv[0] < low[0].min(high[0]) {
            return false;
        }
    }
    line_at(low, high, uv[1]) <= uv[0]
}

/// The point of a rational Bézier curve by Horner's scheme in Bernstein form.
#[inline]
pub fn curve_point<T: Real>(scene: &Scene<'_>, first: u32, degree: u32, t: T) -> [T; 2] {
    let point = |i: u32| scene.trim_points[(first + i) as usize].map(T::from_f32);
    let s = T::ONE - t;
    let mut factor = T::ONE;
    let start = point(0);
    let mut sum = [start[0] * s, start[1] * s, start[2] * s];
    for i in 1..degree {
        // binomial(n, i) tⁱ from the one before.
        factor = factor * t * (T::from_f32((degree + 1 - i) as f32) / T::from_f32(i as f32));
        let p = point(i);
        sum = [(sum[0] + p[0] * factor) * s, (sum[1] + p[1] * factor) * s, (sum[2] + p[2] * factor) * s];
    }
    let power = factor * t / T::from_f32(degree as f32);
    let p = point(degree);
    let weight = sum[2] + p[2] * power;
    [(sum[0] + p[0] * power) / weight, (sum[1] + p[1] * power) / weight]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneBuffers;
    use crate::scene::trim_node::pack;
    use std::f32::consts::FRAC_1_SQRT_2;

    const CENTER: f32 = 0.5;
    const RADIUS: f32 = 0.4;

    /// The four quarters of a circle, right upper first, counter-clockwise.
    fn quarters(scene: &mut SceneBuffers) -> Vec<TrimSegment> {
        let corners = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (1.0, 0.0_f32)];
        let place = |(x, y): (f32, f32)| [CENTER + RADIUS * x, CENTER + RADIUS * y];
        (0..4)
            .map(|i| {
                let (from, to) = (corners[i], corners[i + 1]);
                let curve = scene.trim_points.len() as u32;
                let [start, end] = [place(from), place(to)];
                let middle = place((from.0 + to.0, from.1 + to.1)).map(|x| x * FRAC_1_SQRT_2);
                scene.trim_points.push([start[0], start[1], 1.0]);
                scene.trim_points.push([middle[0], middle[1], FRAC_1_SQRT_2]);
                scene.trim_points.push([end[0], end[1], 1.0]);
                let rising = start[1] < end[1];
                let (low, high) = if rising { (start, end) } else { (end, start) };
                let (t_low, t_high) = if rising { (0.0, 1.0) } else { (1.0, 0.0) };
                TrimSegment { low, high, t_low, t_high, curve, flags: 2 }
            })
            .collect()
    }

    fn assert_is_the_disc(scene: &SceneBuffers, root: u32) {
        let scene = scene.scene();
        for i in 0..200 {
            for j in 0..200 {
                let uv = [(f64::from(i) + 0.31) / 200.0, (f64::from(j) + 0.77) / 200.0];
                let center = f64::from(CENTER);
                let gap = (uv[0] - center).hypot(uv[1] - center) - f64::from(RADIUS);
                assert_eq!(trim_inside(&scene, root, uv), gap < 0.0, "{uv:?}");
                if gap.abs() > 1e-5 {
                    assert_eq!(trim_inside(&scene, root, uv.map(|x| x as f32)), gap < 0.0, "{uv:?}");
                }
            }
        }
    }

    #[test]
    fn one_cell_holds_a_circle() {
        let mut scene = SceneBuffers::default();
        scene.trim_segments = quarters(&mut scene);
        scene.trim_nodes = vec![0, pack(TrimNode::Leaf { inside: false, count: 4, first: 0 })];
        assert_is_the_disc(&scene, 1);
    }

    #[test]
    fn cells_see_what_leaves_through_their_left_edge() {
        let mut scene = SceneBuffers::default();
        let mut segments = quarters(&mut scene);
        // Right of u = ½: the upper quarter ends on the left edge at its top, the lower one starts there.
        segments[0].flags |= TrimSegment::HIGH_ON_LEFT_EDGE;
        segments[3].flags |= TrimSegment::LOW_ON_LEFT_EDGE;
        scene.trim_segments = vec![segments[1], segments[2], segments[0], segments[3]];
        // The far form of the distance, and the long form of the count.
        scene.trim_nodes = vec![
            0,
            pack(TrimNode::Inner { axis: 0, plane: 1 << 13, right: FAR }),
            4,
            pack(TrimNode::Leaf { inside: false, count: MANY, first: 0 }),
            2,
            pack(TrimNode::Leaf { inside: false, count: 2, first: 2 }),
        ];
        assert_is_the_disc(&scene, 1);
    }
}
