//! Where trims cost: exact odd-even tests per pixel, in the colours of Figure 10 of Sloup and Havran 2021: black for none, red for 20 or more.

use super::camera::center_ray;
use super::queries::{Untrimmed, first_hit_counts};
use super::render::render;
use crate::image::{Film, heat_color};
use crate::render::{Background, Camera, RenderOptions};
use crate::scene::Scene;
use rayon::prelude::*;

/// Exact tests from which a pixel is red.
const HOTTEST: f32 = 20.0;

/// A picture whose colours tell how many exact odd-even tests the ray through each pixel's centre needs to its first hit; the numbers are
/// [`Film::trim_tests`], and the other channels are those of [`render()`].
pub fn render_trim_tests(
    scene: &Scene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Film {
    let plain = RenderOptions {
        samples: 1,
        ambient_occlusion: false,
        background: Background::Transparent,
        ..*options
    };
    let mut film = render(scene, camera, &plain, progress);
    let untrimmed = Untrimmed::new(scene);
    let window = film.window();
    let count = |pixel: usize| {
        let ray = center_ray(camera, options.resolution, window, pixel);
        first_hit_counts(scene, &untrimmed, &ray).exact_tests as u32
    };
    film.trim_tests = (0..film.color.len()).into_par_iter().map(count).collect();
    for (color, &tests) in film.color.iter_mut().zip(&film.trim_tests) {
        *color = heat(tests);
    }
    film
}

/// Opaque linear light.
fn heat(tests: u32) -> [f32; 4] {
    heat_color(tests as f32 / HOTTEST)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn none_is_black_and_twenty_is_red() {
        assert_eq!(heat(0), [0.0, 0.0, 0.0, 1.0]);
        assert_eq!(heat(8), [0.0, 1.0, 1.0, 1.0]);
        assert_eq!(heat(20), [1.0, 0.0, 0.0, 1.0]);
        assert_eq!(heat(u32::MAX), heat(20));
    }
}
