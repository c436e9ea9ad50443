//! The film: what a renderer fills, pixel by pixel, top row first.

use super::cryptomatte::{RANKS, Share};
use super::huge_pages::filled;
use super::picture::decode_srgb;
use bytemuck::NoUninit;
use rayon::prelude::*;
use std::ops::Range;

/// A rectangle of a picture's pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Window {
    /// Columns to the left of it.
    pub left: usize,
    /// Rows above it.
    pub top: usize,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

impl Window {
    /// All of a picture.
    pub fn whole(width: usize, height: usize) -> Self {
        Self { left: 0, top: 0, width, height }
    }

    /// With so many pixels more on each side, as far as a picture of that size has them.
    pub fn with_margin(&self, margin: usize, [width, height]: [usize; 2]) -> Self {
        let (left, top) = (self.left.saturating_sub(margin), self.top.saturating_sub(margin));
        let right = (self.left + self.width + margin).min(width);
        let bottom = (self.top + self.height + margin).min(height);
        Self { left, top, width: right - left, height: bottom - top }
    }

    /// Whether it lies in a picture of that size and holds a pixel.
    pub fn is_within(&self, [width, height]: [usize; 2]) -> bool {
        let fits = |first: usize, length: usize, most: usize| {
            length > 0 && first.checked_add(length).is_some_and(|end| end <= most)
        };
        fits(self.left, self.width, width) && fits(self.top, self.height, height)
    }
}

/// What a film has beside colours. What it has not costs nothing.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[allow(missing_docs, reason = "they are the fields of a film")]
pub struct Layers {
    pub depth: bool,
    pub normal: bool,
    pub position: bool,
    pub uv: bool,
    pub curvature: bool,
    /// [`Film::part`] and [`Film::face`].
    pub ids: bool,
    pub albedo: bool,
    pub matte: bool,
}

impl Layers {
    /// Colours alone.
    pub const NONE: Self = Self {
        depth: false,
        normal: false,
        position: false,
        uv: false,
        curvature: false,
        ids: false,
        albedo: false,
        matte: false,
    };
    /// All of them.
    pub const ALL: Self = Self {
        depth: true,
        normal: true,
        position: true,
        uv: true,
        curvature: true,
        ids: true,
        albedo: true,
        matte: true,
    };
    /// What tells which pixel shows what, and how far away.
    pub const PLAIN: Self = Self { depth: true, normal: true, ids: true, ..Self::NONE };

    /// These and those of [`Self::PLAIN`].
    pub fn with_plain(self) -> Self {
        Self { depth: true, normal: true, ids: true, ..self }
    }

    /// Whether any layer tells what is seen at the pixels' centres.
    pub fn has_centers(self) -> bool {
        self.depth || self.normal || self.position || self.uv || self.curvature || self.ids
    }

    /// Whether any layer gathers what the samples show first.
    pub fn has_first_hits(self) -> bool {
        self.albedo || self.matte
    }
}

/// A picture and what each pixel shows. Arrays of layers that the film has not are empty; the others have `width · height` elements, rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Where the film's upper left pixel is in the whole picture.
    pub corner: [usize; 2],
    /// Pixels across and down of the whole picture, of which the film may be a part.
    pub whole: [usize; 2],
    /// Linear-light red, green, blue, premultiplied, and coverage.
    pub color: Vec<[f32; 4]>,
    /// Distance along the view direction at the pixel's centre, millimetres; infinite where nothing is hit.
    pub depth: Vec<f32>,
    /// World-space unit normal towards the viewer; 0 where nothing is hit.
    pub normal: Vec<[f32; 3]>,
    /// Where the surface is at the pixel's centre, model space, millimetres; 0 where nothing is hit.
    pub position: Vec<[f32; 3]>,
    /// The surface's own parameters at the pixel's centre, radians and millimetres; 0 where nothing is hit.
    pub uv: Vec<[f32; 2]>,
    /// The surface's mean curvature at the pixel's centre, 1/mm, positive where it bulges towards the viewer, and its Gaussian curvature, 1/mm²; 0 where
    /// nothing is hit.
    pub curvature: Vec<[f32; 2]>,
    /// 1 + instance index; 0 where nothing is hit.
    pub part: Vec<u32>,
    /// 1 + face index; 0 where nothing is hit.
    pub face: Vec<u32>,
    /// Linear light of the colours without light: the mean of the samples, black where there is no model.
    pub albedo: Vec<[f32; 3]>,
    /// How much of the pixel the parts cover that its samples show first, the greatest share first.
    pub matte: Vec<[Share; RANKS]>,
    /// Exact odd-even tests that the trims cost; empty unless asked for.
    pub trim_tests: Vec<u32>,
    /// What lines cover of each pixel, 0 to 1; empty where none are drawn.
    pub lines: Vec<f32>,
}

impl Film {
    /// An empty picture with [`Layers::PLAIN`].
    pub fn new(width: usize, height: usize) -> Self {
        Self::of_window(Window::whole(width, height), [width, height], Layers::PLAIN)
    }

    /// An empty part of a picture of size `whole`.
    pub fn of_window(window: Window, whole: [usize; 2], layers: Layers) -> Self {
        let Window { left, top, width, height } = window;
        let pixels = width * height;
        Self {
            width,
            height,
            corner: [left, top],
            whole,
            color: filled([0.0; 4], pixels),
            depth: layer(layers.depth, f32::INFINITY, pixels),
            normal: layer(layers.normal, [0.0; 3], pixels),
            position: layer(layers.position, [0.0; 3], pixels),
            uv: layer(layers.uv, [0.0; 2], pixels),
            curvature: layer(layers.curvature, [0.0; 2], pixels),
            part: layer(layers.ids, 0, pixels),
            face: layer(layers.ids, 0, pixels),
            albedo: layer(layers.albedo, [0.0; 3], pixels),
            matte: layer(layers.matte, [Share::default(); RANKS], pixels),
            trim_tests: Vec::new(),
            lines: Vec::new(),
        }
    }

    /// Gives up the layers that are not among `layers`.
    pub fn keep(&mut self, layers: Layers) {
        keep_if(layers.depth, &mut self.depth);
        keep_if(layers.normal, &mut self.normal);
        keep_if(layers.position, &mut self.position);
        keep_if(layers.uv, &mut self.uv);
        keep_if(layers.curvature, &mut self.curvature);
        keep_if(layers.ids, &mut self.part);
        keep_if(layers.ids, &mut self.face);
        keep_if(layers.albedo, &mut self.albedo);
        keep_if(layers.matte, &mut self.matte);
    }

    /// Draws the lines over everything, in one colour (sRGB).
    pub fn draw_lines(&mut self, srgb: [f32; 3]) {
        let light = srgb.map(|code| decode_srgb(f64::from(code)) as f32);
        let lines = std::mem::take(&mut self.lines);
        self.lay_over(light, &lines);
        self.lines = lines;
    }

    /// Covers a share of each pixel with a linear-light colour.
    pub(super) fn lay_over(&mut self, [red, green, blue]: [f32; 3], covered: &[f32]) {
        for (color, &share) in self.color.iter_mut().zip(covered) {
            for (channel, over) in color.iter_mut().zip([red, green, blue, 1.0]) {
                *channel += (over - *channel) * share;
            }
        }
    }

    /// An empty picture with the layers that `other` has.
    pub fn with_layers_of(other: &Self, width: usize, height: usize) -> Self {
        let layers = Layers {
            depth: !other.depth.is_empty(),
            normal: !other.normal.is_empty(),
            position: !other.position.is_empty(),
            uv: !other.uv.is_empty(),
            curvature: !other.curvature.is_empty(),
            ids: !other.part.is_empty(),
            albedo: !other.albedo.is_empty(),
            matte: !other.matte.is_empty(),
        };
        let mut film = Self::of_window(Window::whole(width, height), [width, height], layers);
        film.trim_tests = layer(!other.trim_tests.is_empty(), 0, width * height);
        film.lines = layer(!other.lines.is_empty(), 0.0, width * height);
        film
    }

    /// The film's place in the whole picture.
    pub fn window(&self) -> Window {
        let [left, top] = self.corner;
        Window { left, top, width: self.width, height: self.height }
    }

    /// The part of this film that shows a window of the whole picture, with those of `layers` that it has, and what it has of lines and trim tests.
    ///
    /// # Panics
    ///
    /// Where the film does not show all of the window.
    pub fn part(&self, window: Window, layers: Layers) -> Self {
        let mut part = Self::of_window(window, self.whole, layers);
        let pixels = part.color.len();
        part.trim_tests = layer(!self.trim_tests.is_empty(), 0, pixels);
        part.lines = layer(!self.lines.is_empty(), 0.0, pixels);
        part.cut_from(self, window.left - self.corner[0], window.top - self.corner[1]);
        part
    }

    /// Copies `other` into this film, its upper left pixel to column `left` of row `top`.
    ///
    /// # Panics
    ///
    /// Where it does not fit.
    pub fn paste(&mut self, other: &Self, left: usize, top: usize) {
        let all = Window::whole(other.width, other.height);
        self.copy_from(other, all, left, top);
    }

    /// Takes the pixels of `other` that begin at its column `left` of its row `top`, as many as this film has.
    ///
    /// # Panics
    ///
    /// Where `other` has not as many there.
    pub fn cut_from(&mut self, other: &Self, left: usize, top: usize) {
        self.copy_from(other, Window { left, top, width: self.width, height: self.height }, 0, 0);
    }

    /// Copies part of `other`, counted in its own pixels, to column `left` of row `top`: the layers that both have.
    fn copy_from(&mut self, other: &Self, part: Window, left: usize, top: usize) {
        assert!(left + part.width <= self.width && top + part.height <= self.height, "the film is too large");
        assert!(
            part.left + part.width <= other.width && part.top + part.height <= other.height,
            "the film is too small"
        );
        for y in 0..part.height {
            let first = (part.top + y) * other.width + part.left;
            let from = first..first + part.width;
            let to = (top + y) * self.width + left;
            copy(&mut self.color, to, &other.color, from.clone());
            copy(&mut self.depth, to, &other.depth, from.clone());
            copy(&mut self.normal, to, &other.normal, from.clone());
            copy(&mut self.position, to, &other.position, from.clone());
            copy(&mut self.uv, to, &other.uv, from.clone());
            copy(&mut self.curvature, to, &other.curvature, from.clone());
            copy(&mut self.albedo, to, &other.albedo, from.clone());
            copy(&mut self.matte, to, &other.matte, from.clone());
            copy(&mut self.part, to, &other.part, from.clone());
            copy(&mut self.face, to, &other.face, from.clone());
            copy(&mut self.lines, to, &other.lines, from.clone());
            copy(&mut self.trim_tests, to, &other.trim_tests, from);
        }
    }

    /// Puts a wall of one colour behind everything: light that a pixel does not cover is replaced by it.
    pub fn put_behind(&mut self, srgb: [f32; 3]) {
        let light = srgb.map(|code| decode_srgb(f64::from(code)) as f32);
        self.color.par_iter_mut().for_each(|color| {
            let uncovered = 1.0 - color[3];
            for channel in 0..3 {
                color[channel] += uncovered * light[channel];
            }
            color[3] = 1.0;
        });
    }
}

/// The array of a layer, or none.
fn layer<T: NoUninit>(is_there: bool, value: T, pixels: usize) -> Vec<T> {
    if is_there { filled(value, pixels) } else { Vec::new() }
}

fn keep_if<T>(is_kept: bool, layer: &mut Vec<T>) {
    if !is_kept {
        *layer = Vec::new();
    }
}

/// Copies part of a row, where both films have the layer.
fn copy<T: Copy>(into: &mut [T], to: usize, from: &[T], range: Range<usize>) {
    if !into.is_empty() && !from.is_empty() {
        into[to..to + range.len()].copy_from_slice(&from[range]);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Picture;

    #[test]
    fn windows_lie_within_or_not() {
        let window = Window { left: 3, top: 1, width: 2, height: 4 };
        assert!(window.is_within([5, 5]) && !window.is_within([4, 5]) && !window.is_within([5, 4]));
        assert!(!Window { width: 0, ..window }.is_within([5, 5]));
        assert!(!Window { left: usize::MAX, ..window }.is_within([5, 5]));
    }

    #[test]
    fn a_margin_ends_with_the_picture() {
        let window = Window { left: 3, top: 10, width: 5, height: 4 };
        let grown = Window { left: 0, top: 6, width: 12, height: 9 };
        assert_eq!(window.with_margin(4, [20, 15]), grown);
        let mut film = Film::of_window(grown, [20, 15], Layers::ALL);
        film.lines = (0..108).map(|i| i as f32).collect();
        film.depth = film.lines.clone();
        let part = film.part(window, Layers::NONE);
        assert_eq!((part.corner, part.whole, part.depth.len()), ([3, 10], [20, 15], 0));
        assert_eq!((part.lines[0], part.lines[19]), (51.0, 91.0));
    }

    #[test]
    fn a_pasted_film_is_where_it_was_put() {
        let mut sheet = Film::new(5, 3);
        let mut cell = Film::new(2, 1);
        cell.color = vec![[1.0; 4], [2.0; 4]];
        cell.face = vec![7, 8];
        sheet.paste(&cell, 3, 2);
        assert_eq!(sheet.color[13..], [[1.0; 4], [2.0; 4]]);
        assert_eq!(sheet.face.iter().sum::<u32>(), 15);
        assert_eq!(sheet.color[..13], [[0.0; 4]; 13]);
    }

    #[test]
    fn a_wall_shows_where_the_model_does_not_cover_it() {
        let mut film = Film::new(3, 1);
        film.color[1] = [0.2, 0.1, 0.0, 1.0];
        film.color[2] = [0.1, 0.1, 0.1, 0.5];
        film.put_behind([1.0, 0.0, 0.0]);
        assert_eq!(film.color[1], [0.2, 0.1, 0.0, 1.0]);
        assert_eq!(film.color[2], [0.6, 0.1, 0.1, 1.0]);
        assert_eq!(<Picture>::from(&film).pixels[0], [255, 0, 0, 255]);
    }
}
