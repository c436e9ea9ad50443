//! What lines cover of each pixel, and which lines are near a place.

use super::Ends;
use crate::image::{Window, box_coverage, distance_to};
use glam::DVec2;
use std::collections::HashMap;

/// What lines cover of each pixel of a part of the picture.
pub(super) struct Mask {
    window: Window,
    coverage: Vec<f32>,
}

impl Mask {
    pub(super) fn new(window: Window) -> Self {
        Self { window, coverage: vec![0.0; window.width * window.height] }
    }

    /// Draws a straight piece with round ends.
    pub(super) fn add(&mut self, ends: Ends, width: f64) {
        for (x, y) in pixels_near(ends, 0.5 * width + 0.5, self.window) {
            let distance = distance_to(DVec2::new(x as f64 + 0.5, y as f64 + 0.5), ends);
            let pixel = (y - self.window.top) * self.window.width + (x - self.window.left);
            self.cover(pixel, box_coverage(distance, width) as f32);
        }
    }

    /// Covers a pixel, by its index in the part, at least so much.
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

/// The pixels of a part of the picture whose centres may be within `reach` of a straight piece.
fn pixels_near(ends: Ends, reach: f64, window: Window) -> impl Iterator<Item = (usize, usize)> {
    let [low, high] = [ends[0].min(ends[1]) - reach - 0.5, ends[0].max(ends[1]) + reach + 0.5];
    // Casts of floats hold to the range of the integers.
    let within = |low: f64, high: f64, first: usize, count: usize| {
        (low.floor().max(0.0) as usize).max(first)..(high.ceil() as usize).min(first + count)
    };
    let across = within(low.x, high.x, window.left, window.width);
    let down = within(low.y, high.y, window.top, window.height);
    down.flat_map(move |y| across.clone().map(move |x| (x, y)))
}

/// Finds drawn pieces near a place of a part of the picture.
pub(super) struct Near {
    window: Window,
    /// For each pixel, by column and row, the pieces whose middles are in it.
    cells: HashMap<(usize, usize), Vec<Ends>>,
}

impl Near {
    pub(super) fn new(window: Window) -> Self {
        Self { window, cells: HashMap::new() }
    }

    /// Notes a piece, which is at most a pixel long.
    pub(super) fn add(&mut self, ends: Ends) {
        let middle = 0.5 * (ends[0] + ends[1]);
        for pixel in pixels_near([middle; 2], 0.0, self.window) {
            if [middle.x, middle.y].map(f64::floor) == [pixel.0 as f64, pixel.1 as f64] {
                self.cells.entry(pixel).or_default().push(ends);
            }
        }
    }

    /// The place on noted pieces nearest to `place`, within `reach`.
    pub(super) fn nearest(&self, place: DVec2, reach: f64) -> Option<DVec2> {
        let around = pixels_near([place; 2], reach + 0.5, self.window);
        let pieces = around.filter_map(|pixel| self.cells.get(&pixel)).flatten();
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
