//! Strokes: what a straight piece of constant width covers of pixels, of lines as of letters.
//!
//! A pixel is taken for a box as wide as itself across the stroke, wherever that runs: the coverage is the share of that box within the stroke's width.
//! Across a straight stroke it adds up to the width exactly.

use glam::DVec2;

/// The distance of a place from a straight piece.
pub fn distance_to(place: DVec2, [a, b]: [DVec2; 2]) -> f64 {
    let (along, from) = (b - a, place - a);
    let share = (from.dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    from.distance(along * share)
}

/// What a stroke covers of a box as wide as a pixel across it, whose middle is at `distance` from that of the stroke; lengths in pixels.
pub fn box_coverage(distance: f64, width: f64) -> f64 {
    let half = 0.5 * width;
    ((distance + half).min(0.5) - (distance - half).max(-0.5)).max(0.0)
}
