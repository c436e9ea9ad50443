//! Images that are straight lines: one segment instead of many, and exactly so.

use super::segment::{Segment, end, point_at, start, straight};
use super::target::Target;
use crate::geometry::Homogeneous;
use glam::DVec2;

/// One straight segment where all of `segments` is straight within the tolerance, and how far points moved for it,
/// millimetres; parallel to an axis where it is that within the tolerance, so that the sides of rectangles become exact.
pub(super) fn straightened(target: &Target, segments: &[Segment]) -> Option<(Segment, f64)> {
    let (a, b) = (start(segments.first()?), end(segments.last()?));
    let metrics: Vec<DVec2> = segments
        .iter()
        .map(|s| [0.0, 0.5, 1.0].map(|t| target.metric(point_at(s, t))))
        .map(|[m0, m1, m2]| m0.max(m1).max(m2))
        .collect();
    let moved = |off: &dyn Fn(DVec2) -> DVec2| {
        let of_segment = |(s, m): (&Segment, &DVec2)| {
            s.points.iter().map(|p| (off(p.point()) * *m).length()).fold(0.0, f64::max)
        };
        segments.iter().zip(&metrics).map(of_segment).fold(0.0, f64::max)
    };
    // Back and forth on one line is not a straight image.
    let advances = |direction: DVec2| {
        segments.iter().all(|s| (end(s) - start(s)).dot(direction) >= -1e-9 * direction.length_squared())
    };
    for axis in 0..2 {
        let strongest = (0..segments.len()).max_by(|&i, &j| metrics[i][axis].total_cmp(&metrics[j][axis]))?;
        let value = point_at(&segments[strongest], 0.5)[axis];
        let off = |p: DVec2| {
            let mut d = DVec2::ZERO;
            d[axis] = p[axis] - value;
            d
        };
        let (mut a, mut b) = (a, b);
        (a[axis], b[axis]) = (value, value);
        let distance = moved(&off);
        if distance <= target.tolerance && advances(b - a) {
            return Some((straight(a, b), distance));
        }
    }
    let chord = b - a;
    let off = |p: DVec2| (p - a).reject_from_normalized(chord.normalize_or(DVec2::X));
    let distance = moved(&off);
    (chord.length() > 0.0 && distance <= target.tolerance && advances(chord))
        .then(|| (straight(a, b), distance))
}
