//! Pictures: the centres of all pixels over threads, then all samples of those that need them.

use super::adaptive::{Centers, paint};
use super::camera::{pixel_key, pixel_ray, sample_offset};
use super::pixels::{Center, Refined, Sampled};
use super::shade::{Lights, Shading, beside, shade_center, shade_sample};
use crate::image::Film;
use crate::render::{Camera, RenderOptions};
use crate::scene::Scene;
use rayon::prelude::*;
use std::convert::Infallible;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Pixels per unit of work.
const PIXELS_PER_TASK: usize = 1024;

/// Renders a picture; `progress` is told (done, total) units of work.
///
/// Deterministic: each pixel depends on its position, its neighbours and the options alone.
pub fn render(
    scene: &Scene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Film {
    let [width, height] = options.resolution.map(|n| n as usize);
    let pixels: Vec<u32> = (0..(width * height) as u32).collect();
    let done = AtomicUsize::new(0);
    let tell = |more: usize| progress(done.fetch_add(more, Ordering::Relaxed) + more, pixels.len());
    let found: Vec<Vec<Center>> = pixels
        .par_chunks(PIXELS_PER_TASK)
        .map(|some| {
            let found = centers(scene, camera, options, some);
            tell(some.len());
            found
        })
        .collect();
    let mut centers = Centers::new(camera, options);
    let mut first = 0;
    for found in found {
        centers.put(first, &found, 0.0);
        first += found.len();
    }
    let refined = |asked: &[Refined]| Ok::<_, Infallible>(samples(scene, camera, options, asked));
    let mut film = paint(centers, refined).unwrap_or_else(|never| match never {});
    options.background.put_behind(&mut film);
    film
}

/// What the centres of some pixels show.
pub fn centers(scene: &Scene<'_>, camera: &Camera, options: &RenderOptions, pixels: &[u32]) -> Vec<Center> {
    let shading = Shading { scene, lights: Lights::from_camera(camera), options };
    let width = options.resolution[0];
    let center = |&pixel: &u32| {
        let (x, y) = (pixel % width, pixel / width);
        let ray = pixel_ray(camera, options.resolution, f64::from(x) + 0.5, f64::from(y) + 0.5);
        shade_center(&shading, camera, &ray, pixel_key(x, y))
    };
    pixels.iter().map(center).collect()
}

/// All samples of some pixels.
pub fn samples(
    scene: &Scene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    refined: &[Refined],
) -> Vec<Sampled> {
    let shading = Shading { scene, lights: Lights::from_camera(camera), options };
    refined.par_iter().map(|refined| sample_pixel(&shading, camera, refined)).collect()
}

/// The mean of a pixel's samples.
fn sample_pixel(shading: &Shading<'_, '_>, camera: &Camera, refined: &Refined) -> Sampled {
    let resolution = shading.options.resolution;
    let (x, y) = (refined.pixel % resolution[0], refined.pixel / resolution[0]);
    let pixel = pixel_key(x, y);
    let samples = shading.options.samples.max(1);
    let mut sampled = Sampled { color: [0.0; 4], flags: 0 };
    for sample in 0..samples {
        let place = sample_offset(pixel, sample, samples);
        let (px, py) = (f64::from(x) + f64::from(place[0]), f64::from(y) + f64::from(place[1]));
        let shaded =
            shade_sample(shading, &pixel_ray(camera, resolution, px, py), pixel, sample, &refined.around);
        for k in 0..4 {
            sampled.color[k] += shaded.color[k];
        }
        sampled.flags |= beside(&shaded, place, refined);
    }
    sampled.color = sampled.color.map(|sum| sum / samples as f32);
    sampled
}
