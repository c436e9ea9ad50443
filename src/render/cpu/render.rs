//! Pictures: the centres of all pixels over threads, then all samples of those that need them.

use super::adaptive::{Centers, paint, with_margin};
use super::beam::{Beam, may_meet};
use super::camera::{pixel_key, pixel_ray, sample_offset};
use super::packet::LANES;
use super::pixels::{Center, Refined, Sampled};
use super::shade::Shading;
use super::shade_rays::{beside, empty_center, shade_centers, shade_samples};
use crate::image::{Film, Window};
use crate::render::first_hits::FirstHits;
use crate::render::{Camera, Ray, RenderOptions};
use crate::scene::Scene;
use arrayvec::ArrayVec;
use rayon::prelude::*;
use std::convert::Infallible;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Pixels that are refined at a time, which is what bounds the memory for it.
const MOST_REFINED: usize = 1 << 14;

/// Pixels across that are looked at together, in all rows of a band: fewer rays would not be worth the beam, more would meet something more often.
const COLUMNS_PER_BLOCK: usize = 16;

/// Pixels whose rays are traced together.
const COLUMNS_PER_PACKET: usize = 4;
const ROWS_PER_PACKET: usize = LANES / COLUMNS_PER_PACKET;

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
    let first = rows.start;
    let mut found = vec![empty_center(); rows.len()];
    for left in (0..window.width).step_by(COLUMNS_PER_BLOCK) {
        let right = (left + COLUMNS_PER_BLOCK).min(window.width);
        let [low, high] = [[left, top], [right, bottom]].map(|[x, y]| [x + window.left, y + window.top]);
        if !may_meet(scene, &Beam::through(scene, camera, options.resolution, low, high)) {
            continue;
        }
        let columns: Vec<usize> = (left..right).step_by(COLUMNS_PER_PACKET).collect();
        let corners =
            (top..bottom).step_by(ROWS_PER_PACKET).flat_map(|y| columns.iter().map(move |&x| (x, y)));
        for (x, y) in corners {
            let rows = y..(y + ROWS_PER_PACKET).min(bottom);
            let pixels: ArrayVec<usize, LANES> = rows
                .flat_map(|y| (x..(x + COLUMNS_PER_PACKET).min(right)).map(move |x| x + y * window.width))
                .collect();
            let centers =
                find_packet(&shading, camera, pixels.iter().map(|&pixel| place(window, pixel as u32)));
            for (&pixel, center) in pixels.iter().zip(centers) {
                found[pixel - first] = center;
            }
        }
    }
    found
}

/// What the centres of up to eight pixels of the whole picture show.
fn find_packet(
    shading: &Shading<'_, '_>,
    camera: &Camera,
    pixels: impl Iterator<Item = [u32; 2]>,
) -> [Center; LANES] {
    let resolution = shading.options.resolution;
    let rays: ArrayVec<(Ray, u32), LANES> = pixels
        .map(|[x, y]| {
            let ray = pixel_ray(camera, resolution, f64::from(x) + 0.5, f64::from(y) + 0.5);
            (ray, pixel_key(x, y))
        })
        .collect();
    shade_centers(shading, camera, &rays)
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
    let find = |pixels: &[u32]| {
        let places = pixels.iter().map(|&pixel| place(window, pixel));
        find_packet(&shading, camera, places).into_iter().take(pixels.len()).collect::<ArrayVec<_, LANES>>()
    };
    pixels.chunks(LANES).flat_map(find).collect()
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
    for first in (0..samples).step_by(LANES) {
        let numbers = first..samples.min(first + LANES as u32);
        let places: ArrayVec<[f32; 2], LANES> =
            numbers.clone().map(|sample| sample_offset(pixel, sample, samples)).collect();
        let rays: ArrayVec<(Ray, u32), LANES> = places
            .iter()
            .zip(numbers)
            .map(|(place, sample)| {
                let (px, py) = (f64::from(x) + f64::from(place[0]), f64::from(y) + f64::from(place[1]));
                (pixel_ray(camera, options.resolution, px, py), sample)
            })
            .collect();
        for (shaded, place) in shade_samples(shading, &rays, pixel, &refined.around).into_iter().zip(places) {
            for k in 0..4 {
                color[k] += shaded.color[k];
            }
            flags |= beside(&shaded, place, refined);
            if let (true, Some((instance, face))) = (options.layers.has_first_hits(), shaded.first) {
                first_hits.add(shading.scene, instance, face);
            }
        }
    }
    Sampled {
        color: color.map(|sum| sum / samples as f32),
        flags,
        albedo: first_hits.albedo(samples),
        matte: first_hits.shares(samples),
    }
}
