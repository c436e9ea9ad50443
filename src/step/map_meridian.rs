//! Profiles of surfaces of revolution that cross their axis: conics without ends, whose one half makes the same surface as the
//! other, with the normal turned round.

use super::map_curve::MappedCurve;
use super::map_swept::{PARALLEL, conic_frame};
use crate::geometry::{Curve, Frame};
use glam::DVec3;
use std::f64::consts::PI;

/// A sample is in the profile's plane where it is this near to it, as a share of its distance from the axis: files keep some
/// seven digits.
const IN_PLANE: f64 = 1e-6;

/// The direction from the axis to the half of a conic that is meant: that of its trim; else where most `samples` of the face's
/// boundary lie in its plane, since a seam runs on the profile; else that of its centre, or its x axis.
pub fn meridian_side(axis: &Frame, profile: &MappedCurve, frame: &Frame, samples: &[DVec3]) -> DVec3 {
    let across = frame.z.cross(axis.z).normalize_or(axis.x);
    let off = |p: DVec3| (p - axis.origin).dot(across);
    if let Some([a, b]) = profile.trim {
        return across * off(profile.curve.point(0.5 * (a + b))).signum();
    }
    let in_plane = samples.iter().filter(|p| {
        let radius = axis.local_point(**p).truncate().length();
        (**p - axis.origin).dot(frame.z).abs() <= IN_PLANE * radius && off(**p) != 0.0
    });
    let most: f64 = in_plane.map(|p| off(*p).signum()).sum();
    let candidates = [most, off(frame.origin), frame.x.dot(across), frame.y.dot(across)];
    let sign = candidates.into_iter().find(|c| c.abs() > PARALLEL).unwrap_or(1.0);
    across * sign.signum()
}

/// `point` turned about the axis to its `side`.
pub fn turned_to(axis: &Frame, point: DVec3, side: DVec3) -> DVec3 {
    let local = axis.local_point(point);
    axis.origin + axis.z * local.z + side * local.truncate().length()
}

/// The vertex of a parabola or of the branch of a hyperbola: a dome has its top there, which no boundary need touch.
pub fn conic_vertex(curve: &Curve) -> Option<DVec3> {
    matches!(curve, Curve::Parabola { .. } | Curve::Hyperbola { .. }).then(|| curve.point(0.0))
}

/// Whether `point` lies on the axis, compared with what the face's boundary reaches.
pub fn is_on_axis(axis: &Frame, point: DVec3, samples: &[DVec3]) -> bool {
    let radius = |p: DVec3| axis.local_point(p).truncate().length();
    radius(point) <= IN_PLANE * samples.iter().map(|&p| radius(p)).fold(0.0, f64::max)
}

/// The piece of `range` in which a conic in one plane with the axis stays on its `side`, from the point there that is farthest
/// away: turned about the axis, the other side would cover the surface a second time.
pub fn one_side(axis: &Frame, curve: &Curve, range: [f64; 2], side: DVec3) -> [f64; 2] {
    const STEPS: usize = 256;
    let Some(frame) = conic_frame(curve) else { return range };
    let is_meridian = frame.z.dot(axis.z).abs() < PARALLEL
        && (frame.origin - axis.origin).dot(frame.z).abs()
            < PARALLEL * (1.0 + frame.origin.distance(axis.origin));
    if !is_meridian {
        return range;
    }
    let off = |t: f64| (curve.point(t) - axis.origin).dot(side);
    let farthest_of = |range: [f64; 2]| {
        let at = |i: usize| range[0] + (range[1] - range[0]) * i as f64 / STEPS as f64;
        let offs: Vec<f64> = (0..=STEPS).map(|i| off(at(i))).collect();
        let farthest = (0..=STEPS).max_by(|&a, &b| offs[a].total_cmp(&offs[b])).unwrap_or(0);
        (offs, farthest, at(farthest))
    };
    // All of a closed conic is taken about that point, so that no side is cut in two.
    let is_whole = curve.period().is_some_and(|period| range[1] - range[0] >= period * (1.0 - PARALLEL));
    let middle = farthest_of(range).2;
    let range = if is_whole { [middle - PI, middle + PI] } else { range };
    let (offs, farthest, _) = farthest_of(range);
    let at = |i: usize| range[0] + (range[1] - range[0]) * i as f64 / STEPS as f64;
    // Within rounding of the axis counts as on it.
    let floor = PARALLEL * offs[farthest].abs();
    let crossing = |inside: usize, outside: usize| {
        let (mut inside, mut outside) = (at(inside), at(outside));
        loop {
            let middle = 0.5 * (inside + outside);
            if middle == inside || middle == outside {
                return inside;
            }
            if off(middle) >= 0.0 { inside = middle } else { outside = middle }
        }
    };
    let is_beyond = |i: &usize| offs[*i] < -floor;
    let before = (0..farthest).rev().find(is_beyond).map(|i| crossing(i + 1, i));
    let after = (farthest + 1..=STEPS).find(is_beyond).map(|i| crossing(i - 1, i));
    [before.unwrap_or(range[0]), after.unwrap_or(range[1])]
}
