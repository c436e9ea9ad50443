//! One loop of a face, unwrapped: the images of its edges joined in the universal cover of the parameter plane.
//!
//! Parameters are carried along the loop, so that an edge used twice as a seam falls on both sides by itself. Where two
//! edges meet in a pole the loop runs along the pole's iso-line; by which multiple of the period follows from the side
//! on which the face lies (left of the loop in the plane of the surface normal): the rectangle around a whole sphere
//! runs counter-clockwise, so against u along the upper pole and with u along the lower one.

use super::TrimError;
use super::pcurve::{DirectedEdge, EdgeImage, edge_images};
use super::segment::{Segment, end, set_end, set_start, shift, start, straight, with_axis};
use super::target::Target;
use glam::DVec2;

/// End points whose images are apart by less than this share of the tolerance are one, up to rounding.
const ROUNDING: f64 = 1e-3;

/// A loop before its joints are closed.
pub(super) struct Outline {
    pub(super) images: Vec<EdgeImage>,
    /// Joint i lies between image i and the next.
    joints: Vec<Joint>,
    winding: [i32; 2],
}

/// A closed loop: consecutive segments share end points bit for bit; the last ends `winding` periods from the start.
pub(super) struct Chain {
    pub(super) segments: Vec<Segment>,
    pub(super) winding: [i32; 2],
    /// Of how many edges it is made.
    pub(super) edges: usize,
}

#[derive(Clone, Copy)]
enum Joint {
    Plain,
    /// Along the iso-line of the pole at which one image ends, to that at which the next starts (the same point in
    /// space), by `span` in the other parameter.
    Pole {
        poles: [usize; 2],
        span: f64,
    },
}

/// The unwrapped loop; `None` where all its edges are without length.
pub(super) fn outline(
    target: &Target,
    edges: &[DirectedEdge],
    left: bool,
) -> Result<Option<Outline>, TrimError> {
    let first = trace(target, edges, left, None)?;
    let Some(outline) = first else { return Ok(None) };
    // Without a seed the first edge may have come out on the wrong side of a seam: then start from the loop's end.
    let tail = outline.images.last().map(end_of);
    let seam_jump = tail.is_some_and(|tail| outline.jumps(target, tail));
    if seam_jump && let Some(second) = trace(target, edges, left, tail)? {
        let still = second.images.last().map(end_of).is_some_and(|tail| second.jumps(target, tail));
        if !still {
            return Ok(Some(second));
        }
    }
    Ok(Some(outline))
}

fn start_of(image: &EdgeImage) -> DVec2 {
    start(&image.segments[0])
}

fn end_of(image: &EdgeImage) -> DVec2 {
    end(&image.segments[image.segments.len() - 1])
}

fn shift_image(image: &mut EdgeImage, offset: DVec2) {
    if offset != DVec2::ZERO {
        image.segments.iter_mut().for_each(|segment| shift(segment, offset));
    }
}

fn trace(
    target: &Target,
    edges: &[DirectedEdge],
    left: bool,
    seed: Option<DVec2>,
) -> Result<Option<Outline>, TrimError> {
    let mut seed = seed;
    let mut images: Vec<EdgeImage> = Vec::new();
    let mut owners: Vec<u64> = Vec::new();
    let mut joints = Vec::new();
    for edge in edges {
        for mut image in edge_images(target, edge, seed)? {
            if let Some(before) = images.last() {
                let same = owners.last() == Some(&edge.edge.entity);
                let (joint, offset) = join(target, before, &image, same, left);
                shift_image(&mut image, offset);
                joints.push(joint);
            }
            seed = Some(end_of(&image));
            owners.push(edge.edge.entity);
            images.push(image);
        }
    }
    let (Some(first), Some(last)) = (images.first(), images.last()) else { return Ok(None) };
    let same = images.len() > 1 && owners.first() == owners.last();
    let (joint, offset) = join(target, last, first, same, left);
    joints.push(joint);
    let mut outline = Outline { images, joints, winding: [0; 2] };
    for axis in 0..2 {
        if let Some(period) = target.periods[axis] {
            outline.winding[axis] = (offset[axis] / period).round() as i32;
        }
    }
    outline.unwind_at_poles(target);
    Ok(Some(outline))
}

/// How `before` joins `after`, and the whole periods by which `after` must be shifted for it.
fn join(target: &Target, before: &EdgeImage, after: &EdgeImage, same: bool, left: bool) -> (Joint, DVec2) {
    let (p, q) = (end_of(before), start_of(after));
    let mut offset = target.nearest_shift(q, p);
    let poles = match (before.poles[1], after.poles[0]) {
        (Some(a), Some(b)) if target.is_same_pole(a, b) => [a, b],
        _ => return (Joint::Plain, offset),
    };
    let axis = target.poles[poles[0]].axis;
    let free = 1 - axis;
    let raw = q[free] - p[free];
    let Some(period) = target.periods[free] else { return (Joint::Pole { poles, span: raw }, offset) };
    let inner = &before.segments[before.segments.len() - 1];
    let upper = start(inner)[axis] < target.pole_value(poles[0], p[axis]);
    // Counter-clockwise: against u above and with u below; with v at the right and against v at the left.
    let forward = (upper == (axis == 0)) == left;
    let sign = if forward { 1.0 } else { -1.0 };
    let mut span = (raw * sign).rem_euclid(period);
    if span < 1e-6 * period || span > (1.0 - 1e-6) * period {
        // Straight on in the same iso-line: nothing between, or everything where the edge is a seam.
        span = if same { period } else { 0.0 };
    }
    let span = span * sign;
    offset[free] = ((span - raw) / period).round() * period;
    (Joint::Pole { poles, span: raw + offset[free] }, offset)
}

impl Outline {
    /// Whether all its numbers are finite.
    pub(super) fn is_finite(&self) -> bool {
        let segments = self.images.iter().flat_map(|image| &image.segments);
        segments.flat_map(|segment| &segment.points).all(|p| p.is_finite())
    }

    /// Whether it goes round a parameter that wraps.
    pub(super) fn goes_round(&self) -> bool {
        self.winding != [0; 2]
    }

    /// Whether the loop's end lies far from its start in parameters but not in space, with no pole or period to explain it.
    fn jumps(&self, target: &Target, tail: DVec2) -> bool {
        let Some(first) = self.images.first() else { return false };
        let head = start_of(first);
        let apart = tail + target.nearest_shift(tail, head) - head;
        let width = target.domain.max - target.domain.min;
        let far = (0..2).any(|axis| target.periods[axis].is_none() && apart[axis].abs() > 0.1 * width[axis]);
        let near = target.surface.point(tail).distance(target.surface.point(head)) <= 1e-3 * target.size;
        far && near && first.poles[0].is_none()
    }

    /// A loop that touches a pole goes round nothing: where it seems to, the face lies on the other side of the pole
    /// than its sense says, so one run along a pole is taken the other way.
    fn unwind_at_poles(&mut self, target: &Target) {
        for axis in 0..2 {
            let Some(period) = target.periods[axis] else { continue };
            let excess = f64::from(self.winding[axis]) * period;
            if self.winding[axis] == 0 {
                continue;
            }
            let fitting = self.joints.iter().position(|joint| match *joint {
                Joint::Pole { poles, span } => {
                    target.poles[poles[0]].axis != axis && (span - excess).abs() <= 1.000_001 * period
                }
                Joint::Plain => false,
            });
            let Some(index) = fitting else { continue };
            if let Joint::Pole { span, .. } = &mut self.joints[index] {
                *span -= excess;
            }
            let mut offset = DVec2::ZERO;
            offset[axis] = -excess;
            self.images[index + 1..].iter_mut().for_each(|image| shift_image(image, offset));
            self.winding[axis] = 0;
        }
    }

    /// Closes the joints: small gaps by moving end points, larger ones and poles by straight segments.
    ///
    /// Moving an end point by a distance moves no point of its segment farther, and the deviations grow by it.
    pub(super) fn welded(&mut self, target: &Target, repairs: &mut Vec<String>) -> Chain {
        let count = self.images.len();
        let mut total = DVec2::ZERO;
        for axis in 0..2 {
            total[axis] = f64::from(self.winding[axis]) * target.periods[axis].unwrap_or(0.0);
        }
        let mut connections: Vec<Option<Segment>> = vec![None; count];
        for i in 0..count {
            let next = (i + 1) % count;
            let offset = if next == 0 { total } else { DVec2::ZERO };
            let mut p = end_of(&self.images[i]);
            // Seen from the end of the loop, its start lies `offset` further.
            let mut q = start_of(&self.images[next]) + offset;
            match self.joints[i] {
                Joint::Pole { poles, .. } => {
                    let axis = target.poles[poles[0]].axis;
                    p = with_axis(p, axis, target.pole_value(poles[0], p[axis]));
                    q = with_axis(q, axis, target.pole_value(poles[1], q[axis]));
                }
                Joint::Plain => {
                    let gap = target.surface.point(p).distance(target.surface.point(q));
                    if gap <= 20.0 * target.tolerance {
                        let joint = meeting(&self.images[i], p, &self.images[next], q);
                        (p, q) = (joint, joint);
                    } else if gap > 1e-4 * target.size {
                        repairs.push(format!("gap of {gap:.1e} mm closed"));
                    }
                }
            }
            let moved = |from: DVec2, to: DVec2| {
                if from == to { 0.0 } else { ((to - from) * target.metric(from)).length() }
            };
            let image = &mut self.images[next];
            image.deviation += moved(start(&image.segments[0]), q - offset);
            set_start(&mut image.segments[0], q - offset);
            // The start is what the loop keeps; its copy at the end is derived from it.
            let q = start(&image.segments[0]) + offset;
            if let Joint::Plain = self.joints[i]
                && p != q
                && ((q - p) * target.metric(p)).length() <= ROUNDING * target.tolerance
            {
                p = q;
            }
            let image = &mut self.images[i];
            let last = image.segments.len() - 1;
            image.deviation += moved(end(&image.segments[last]), p);
            set_end(&mut image.segments[last], p);
            if p != q {
                connections[i] = Some(straight(p, q));
            }
        }
        let mut segments = Vec::new();
        for (image, connection) in self.images.iter_mut().zip(connections) {
            segments.append(&mut image.segments);
            segments.extend(connection);
        }
        Chain { segments, winding: self.winding, edges: count }
    }
}

/// Where two images meet: on the side that one of them keeps constant.
fn meeting(before: &EdgeImage, p: DVec2, after: &EdgeImage, q: DVec2) -> DVec2 {
    let keeps = |image: &EdgeImage, axis: usize| {
        image.segments.len() == 1 && start_of(image)[axis] == end_of(image)[axis]
    };
    let mut joint = p;
    for axis in 0..2 {
        if keeps(after, axis) && !keeps(before, axis) {
            joint[axis] = q[axis];
        }
    }
    joint
}
