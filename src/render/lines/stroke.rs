//! Strokes: what a line of constant width covers of pixels.
//!
//! A pixel is taken for a box as wide as itself across the line, wherever the line runs: the coverage is the share of that box within the line's width.
//! Across a straight line it adds up to the width exactly.

use super::Ends;
use super::steps::distance_to;
use glam::DVec2;
use std::collections::HashMap;

/// What lines cover of each pixel.
pub(super) struct Mask {
    width: usize,
    height: usize,
    coverage: Vec<f32>,
}

impl Mask {
    pub(super) fn new(width: usize, height: usize) -> Self {
        Self { width, height, coverage: vec![0.0; width * height] }
    }

    /// Draws a straight piece with round ends.
    pub(super) fn add(&mut self, ends: Ends, width: f64) {
        for (x, y) in pixels_near(ends, 0.5 * width + 0.5, [self.width, self.height]) {
            let distance = distance_to(DVec2::new(x as f64 + 0.5, y as f64 + 0.5), ends);
            self.cover(y * self.width + x, box_coverage(distance, width) as f32);
        }
    }

    /// Covers a pixel at least so much.
    pub(super) fn cover(&mut self, pixel: usize, covered: f32) {
        self.coverage[pixel] = self.coverage[pixel].max(covered);
    }

    /// Takes for each pixel what covers more of it: this, or the given share of `other`.
    pub(super) fn unite(&mut self, other: &Self, share: f32) {
        for (pixel, other) in self.coverage.iter_mut().zip(&other.coverage) {
            *pixel = pixel.max(share * other);
        }
    }

    pub(super) fn into_coverage(self) -> Vec<f32> {
        self.coverage
    }
}

/// What a line covers of a box as wide as a pixel across it, whose middle is at `distance` from that of the line.
pub(super) fn box_coverage(distance: f64, width: f64) -> f64 {
    let half = 0.5 * width;
    ((distance + half).min(0.5) - (distance - half).max(-0.5)).max(0.0)
}

/// The pixels whose centres may be within `reach` of a straight piece.
fn pixels_near(ends: Ends, reach: f64, [width, height]: [usize; 2]) -> impl Iterator<Item = (usize, usize)> {
    let [low, high] = [ends[0].min(ends[1]) - reach - 0.5, ends[0].max(ends[1]) + reach + 0.5];
    // Casts of floats hold to the range of the integers.
    let across = low.x.floor().max(0.0) as usize..(high.x.ceil() as usize).min(width);
    let down = low.y.floor().max(0.0) as usize..(high.y.ceil() as usize).min(height);
    down.flat_map(move |y| across.clone().map(move |x| (x, y)))
}

/// Finds drawn pieces near a place.
pub(super) struct Near {
    width: usize,
    height: usize,
    /// For each pixel the pieces whose middles are in it.
    cells: HashMap<usize, Vec<Ends>>,
}

impl Near {
    pub(super) fn new(width: usize, height: usize) -> Self {
        Self { width, height, cells: HashMap::new() }
    }

    /// Notes a piece, which is at most a pixel long.
    pub(super) fn add(&mut self, ends: Ends) {
        let middle = 0.5 * (ends[0] + ends[1]);
        let (x, y) = (middle.x.floor(), middle.y.floor());
        if x >= 0.0 && y >= 0.0 && x < self.width as f64 && y < self.height as f64 {
            self.cells.entry(y as usize * self.width + x as usize).or_default().push(ends);
        }
    }

    /// The place on noted pieces nearest to `place`, within `reach`.
    pub(super) fn nearest(&self, place: DVec2, reach: f64) -> Option<DVec2> {
        let around = pixels_near([place; 2], reach + 0.5, [self.width, self.height]);
        let pieces = around.filter_map(|(x, y)| self.cells.get(&(y * self.width + x))).flatten();
        let places = pieces.map(|&[a, b]| {
            let along = b - a;
            let share = (place - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE);
            a + along * share.clamp(0.0, 1.0)
        });
        let nearest = places.min_by(|a, b| a.distance(place).total_cmp(&b.distance(place)));
        nearest.filter(|nearest| nearest.distance(place) <= reach)
    }

    /// Whether a noted piece is within `reach`.
    pub(super) fn is_near(&self, place: DVec2, reach: f64) -> bool {
        self.nearest(place, reach).is_some()
    }
}
