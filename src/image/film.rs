//! The film: what a renderer fills, pixel by pixel, top row first.

use super::picture::decode_srgb;

/// A picture and what each pixel shows. Arrays have `width · height` elements, rows from the top.
#[derive(Debug, Clone, PartialEq)]
pub struct Film {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Linear-light red, green, blue, premultiplied, and coverage.
    pub color: Vec<[f32; 4]>,
    /// Distance along the view direction at the pixel's centre, millimetres; infinite where nothing is hit.
    pub depth: Vec<f32>,
    /// World-space unit normal towards the viewer; 0 where nothing is hit.
    pub normal: Vec<[f32; 3]>,
    /// 1 + instance index; 0 where nothing is hit.
    pub part: Vec<u32>,
    /// 1 + face index; 0 where nothing is hit.
    pub face: Vec<u32>,
    /// Exact odd-even tests that the trims cost; empty unless asked for.
    pub trim_tests: Vec<u32>,
    /// What lines cover of each pixel, 0 to 1; empty where none are drawn.
    pub lines: Vec<f32>,
}

impl Film {
    /// An empty picture.
    pub fn new(width: usize, height: usize) -> Self {
        let pixels = width * height;
        Self {
            width,
            height,
            color: vec![[0.0; 4]; pixels],
            depth: vec![f32::INFINITY; pixels],
            normal: vec![[0.0; 3]; pixels],
            part: vec![0; pixels],
            face: vec![0; pixels],
            trim_tests: Vec::new(),
            lines: Vec::new(),
        }
    }

    /// Draws the lines over everything, in one colour (sRGB).
    pub fn draw_lines(&mut self, srgb: [f32; 3]) {
        let light = srgb.map(|code| decode_srgb(f64::from(code)) as f32);
        for (color, &line) in self.color.iter_mut().zip(&self.lines) {
            let [red, green, blue] = light;
            for (channel, over) in color.iter_mut().zip([red, green, blue, 1.0]) {
                *channel += (over - *channel) * line;
            }
        }
    }

    /// Puts a wall of one colour behind everything: light that a pixel does not cover is replaced by it.
    pub fn put_behind(&mut self, srgb: [f32; 3]) {
        let light = srgb.map(|code| decode_srgb(f64::from(code)) as f32);
        for color in &mut self.color {
            let uncovered = 1.0 - color[3];
            for channel in 0..3 {
                color[channel] += uncovered * light[channel];
            }
            color[3] = 1.0;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::Picture;

    #[test]
    fn a_wall_shows_where_the_model_does_not_cover_it() {
        let mut film = Film::new(3, 1);
        film.color[1] = [0.2, 0.1, 0.0, 1.0];
        film.color[2] = [0.1, 0.1, 0.1, 0.5];
        film.put_behind([1.0, 0.0, 0.0]);
        assert_eq!(film.color[1], [0.2, 0.1, 0.0, 1.0]);
        assert_eq!(film.color[2], [0.6, 0.1, 0.1, 1.0]);
        assert_eq!(Picture::from(&film).pixels[0], [255, 0, 0, 255]);
    }
}
