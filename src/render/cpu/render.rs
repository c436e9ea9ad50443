//! Pictures: the centres of all pixels over threads, then all samples of those that need them.

use super::adaptive::{Centers, paint, with_margin};
use super::beam::{Beam, may_meet};
use super::camera::{pixel_key, pixel_ray, sample_offset};
use super::pixels::{Center, Refined, Sampled};
use super::shade::{Shading, beside, empty_center, shade_center, shade_sample};
use crate::image::{Film, Window};
use crate::render::first_hits::FirstHits;
use crate::render::{Camera, RenderOptions};
use crate::scene::Scene;
use rayon::prelude::*;
use std::convert::Infallible;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Pixels that are refined at a time, which is what bounds the memory for it.
const MOST_REFINED: usize = 1 << 16;

/// Pixels across that are looked at together, in all rows of a band: fewer rays would not be worth the beam, more would meet something more often.
const COLUMNS_PER_BLOCK: usize = 16;

/// Renders a picture, or the part of it that the options ask for; `progress` is told (done, total) units of work.
///
/// Deterministic: each pixel depends on its position in the whole picture, its neighbours and the options alone.
pub fn render(
    scene: &Scene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Film {
    let window = with_margin(options);
    let pixels = window.width * window.height;
    let done = AtomicUsize::new(0);
    let tell = |more: usize| progress(done.fetch_add(more, Ordering::Relaxed) + more, pixels);
    let mut centers = Centers::new(scene, camera, options);
    centers.take(0, pixels, 0.0, |rows| {
        let pixels = rows.len();
        let found = find_rows(scene, camera, options, rows);
        tell(pixels);
        found
    });
    let refined = |asked: &[Refined]| Ok::<_, Infallible>(take_samples(scene, camera, options, asked));
    let mut film = paint(centers, MOST_REFINED, refined).unwrap_or_else(|never| match never {});
    options.background.put_behind(&mut film);
    film
}

/// Where in the whole picture a pixel of the part that is rendered is.
fn place(window: Window, pixel: u32) -> [u32; 2] {
    let (x, y) = (pixel % window.width as u32, pixel / window.width as u32);
    [x + window.left as u32, y + window.top as u32]
}

/// What the centres of whole rows of pixels show: block by block, for where nothing is no ray need find that out.
fn find_rows(scene: &Scene<'_>, camera: &Camera, options: &RenderOptions, rows: Range<usize>) -> Vec<Center> {
    let shading = Shading::new(scene, camera, options);
    let window = with_margin(options);
    let [top, bottom] = [rows.start, rows.end].map(|pixel| pixel / window.width);
    let mut found = vec![empty_center(); rows.len()];
    for left in (0..window.width).step_by(COLUMNS_PER_BLOCK) {
        let right = (left + COLUMNS_PER_BLOCK).min(window.width);
        let [low, high] = [[left, top], [right, bottom]].map(|[x, y]| [x + window.left, y + window.top]);
        if !may_meet(scene, &Beam::through(scene, camera, options.resolution, low, high)) {
            continue;
        }
        for pixel in (top..bottom).flat_map(|y| (left..right).map(move |x| x + y * window.width)) {
            found[pixel - rows.start] = find_center(&shading, camera, place(window, pixel as u32));
        }
    }
    found
}

/// What the centre of the pixel at `(x, y)` of the whole picture shows.
fn find_center(shading: &Shading<'_, '_>, camera: &Camera, [x, y]: [u32; 2]) -> Center {
    let ray = pixel_ray(camera, shading.options.resolution, f64::from(x) + 0.5, f64::from(y) + 0.5);
    shade_center(shading, camera, &ray, pixel_key(x, y))
}

/// What the centres of some pixels show, of the part that is rendered: those that a GPU gives up.
#[cfg(feature = "gpu")]
pub fn find_centers(
    scene: &Scene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    pixels: &[u32],
) -> Vec<Center> {
    let shading = Shading::new(scene, camera, options);
    let window = with_margin(options);
    pixels.iter().map(|&pixel| find_center(&shading, camera, place(window, pixel))).collect()
}

/// All samples of some pixels.
pub fn take_samples(
    scene: &Scene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    refined: &[Refined],
) -> Vec<Sampled> {
    let shading = Shading::new(scene, camera, options);
    let window = with_margin(options);
    let sampled = |refined: &Refined| sample_pixel(&shading, camera, place(window, refined.pixel), refined);
    refined.par_iter().map(sampled).collect()
}

/// The mean of the samples of the pixel at `(x, y)` of the whole picture, and what they show first.
fn sample_pixel(shading: &Shading<'_, '_>, camera: &Camera, [x, y]: [u32; 2], refined: &Refined) -> Sampled {
    let options = shading.options;
    let pixel = pixel_key(x, y);
    let samples = options.samples.max(1);
    let (mut color, mut flags) = ([0.0_f32; 4], 0);
    let mut first_hits = FirstHits::default();
    for sample in 0..samples {
        let place = sample_offset(pixel, sample, samples);
        let (px, py) = (f64::from(x) + f64::from(place[0]), f64::from(y) + f64::from(place[1]));
        let ray = pixel_ray(camera, options.resolution, px, py);
        let shaded = shade_sample(shading, &ray, pixel, sample, &refined.around);
        for k in 0..4 {
            color[k] += shaded.color[k];
        }
        flags |= beside(&shaded, place, refined);
        if let (true, Some((instance, face))) = (options.layers.has_first_hits(), shaded.first) {
            first_hits.add(shading.scene, instance, face);
        }
    }
    Sampled {
        color: color.map(|sum| sum / samples as f32),
        flags,
        albedo: first_hits.albedo(samples),
        matte: first_hits.shares(samples),
    }
}
