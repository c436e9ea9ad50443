//! Which steps of edges are seen: the first hit towards the middle of each decides.
//!
//! An edge lies on its faces, so that the nearest hit is where the edge is, before or behind it, or one that hides it. A face that hides it is
//! before it, and the edge is off the face's tangent plane there; a face that the edge lies on, however grazing, has the edge in that plane.

use super::FirstHits;
use super::screen::Screen;
use super::steps::Step;
use crate::scene::Scene;

/// Rays asked at once: little enough memory, enough work for a device.
const BATCH: usize = 1 << 19;

/// A hit is that of the edge's own place within so many slacks: its own, the edge's, and what both round.
const SLACKS: f64 = 4.0;

/// What positions round, as a share of the scene's size.
const ROUNDING: f64 = 1e-6;

/// For each step whether it is visible.
pub(super) fn visible<E>(
    scene: &Scene<'_>,
    screen: &Screen<'_>,
    steps: &[Step],
    first_hits: &mut FirstHits<'_, E>,
) -> Result<Vec<bool>, E> {
    let rounding = rounding(scene);
    let mut visible = Vec::with_capacity(steps.len());
    for batch in steps.chunks(BATCH) {
        let (rays, distances): (Vec<_>, Vec<_>) =
            batch.iter().map(|step| screen.ray_to(step.middle, step.at)).unzip();
        let hits = first_hits(&rays)?;
        for (((step, ray), distance), hits) in batch.iter().zip(&rays).zip(distances).zip(hits) {
            visible.push(hits.first().is_none_or(|hit| {
                let slack = step
                    .slack
                    .max(scene.faces.get(hit.face as usize).map_or(0.0, |face| f64::from(face.slack)));
                let tolerance = SLACKS * slack + rounding;
                let before = distance - hit.t;
                before <= tolerance || before * hit.normal.dot(ray.direction).abs() <= tolerance
            }));
        }
    }
    Ok(smoothed(steps, &visible))
}

/// A step that is not as its neighbours are on both sides, or on the one at an end of its edge, is taken for what they are: a ray aimed at an edge, or
/// at a corner above all, may slip past what hides it.
fn smoothed(steps: &[Step], visible: &[bool]) -> Vec<bool> {
    let follows = |i: usize| steps[i].ends[1] == steps[i + 1].ends[0];
    let smooth = |i: usize| {
        let before = (i > 0 && follows(i - 1)).then(|| visible[i - 1]);
        let after = (i + 1 < steps.len() && follows(i)).then(|| visible[i + 1]);
        match (before, after) {
            (Some(before), Some(after)) if before != after => visible[i],
            (before, after) => before.or(after).unwrap_or(visible[i]),
        }
    };
    (0..steps.len()).map(smooth).collect()
}

/// What positions in the scene round, millimetres.
pub(super) fn rounding(scene: &Scene<'_>) -> f64 {
    ROUNDING * scene.header.half_size.iter().map(|&x| f64::from(x)).fold(0.0, f64::max)
}
