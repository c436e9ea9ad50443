//! Pictures: the centres of all pixels over threads, then all samples of those that need them.

use super::adaptive::{Centers, paint, with_margin};
use super::camera::{pixel_key, pixel_ray, sample_offset};
use super::pixels::{Center, Refined, Sampled};
use super::shade::{Shading, beside, shade_center, shade_sample};
use crate::image::{Film, Window};
use crate::render::first_hits::FirstHits;
use crate::render::{Camera, RenderOptions};
use crate::scene::Scene;
use rayon::prelude::*;
use std::convert::Infallible;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Pixels that are refined at a time, which is what bounds the memory for it.
const MOST_REFINED: usize = 1 << 16;

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
    centers.take(0, pixels, 0.0, |some| {
        let some: Vec<u32> = some.map(|pixel| pixel as u32).collect();
        let found = find_centers(scene, camera, options, &some);
        tell(some.len());
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

/// What the centres of some pixels show, of the part that is rendered.
pub fn find_centers(
    scene: &Scene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    pixels: &[u32],
) -> Vec<Center> {
    let shading = Shading::new(scene, camera, options);
    let window = with_margin(options);
    let center = |&pixel: &u32| {
        let [x, y] = place(window, pixel);
        let ray = pixel_ray(camera, options.resolution, f64::from(x) + 0.5, f64::from(y) + 0.5);
        shade_center(&shading, camera, &ray, pixel_key(x, y))
    };
    pixels.iter().map(center).collect()
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
