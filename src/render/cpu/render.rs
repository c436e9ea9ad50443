//! Pictures: tiles over threads, samples over pixels.

use super::camera::{pixel_key, pixel_ray, sample_offset};
use super::hit::{hit_normal, surface_parameters};
use super::ray_space::prepare;
use super::shade::{Lights, Shading, shade_ray};
use super::trace::first_hit;
use crate::image::{Film, Window};
use crate::render::first_hits::FirstHits;
use crate::render::{Camera, RenderOptions};
use crate::scene::Scene;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Rows per unit of work.
const ROWS_PER_TILE: usize = 4;

/// Renders a picture, or the part of it that the options ask for; `progress` is told (done, total) units of work.
///
/// Deterministic: each pixel depends on its position in the whole picture and the options alone.
pub fn render(
    scene: &Scene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Film {
    let mut film = options.film();
    let window = film.window();
    let tiles = window.height.div_ceil(ROWS_PER_TILE);
    let done = AtomicUsize::new(0);
    let shading = Shading { scene, lights: Lights::from_camera(camera), options };
    let parts: Vec<Film> = (0..tiles)
        .into_par_iter()
        .map(|tile| {
            let first = tile * ROWS_PER_TILE;
            let height = ROWS_PER_TILE.min(window.height - first);
            let part = render_window(&shading, camera, Window { top: window.top + first, height, ..window });
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, tiles);
            part
        })
        .collect();
    for (tile, part) in parts.iter().enumerate() {
        film.paste(part, 0, tile * ROWS_PER_TILE);
    }
    options.background.put_behind(&mut film);
    film
}

/// Renders some pixels of a film, by index, into it; without a background.
pub fn render_pixels(
    scene: &Scene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    pixels: &[usize],
    film: &mut Film,
) {
    let shading = Shading { scene, lights: Lights::from_camera(camera), options };
    let window = film.window();
    let place = |pixel: usize| (pixel % window.width, pixel / window.width);
    let one = |&pixel: &usize| {
        let (x, y) = place(pixel);
        let own = Window { left: window.left + x, top: window.top + y, width: 1, height: 1 };
        render_window(&shading, camera, own)
    };
    let rendered: Vec<Film> = pixels.par_iter().map(one).collect();
    for (&pixel, part) in pixels.iter().zip(&rendered) {
        let (x, y) = place(pixel);
        film.paste(part, x, y);
    }
}

/// Part of the picture, without a background.
fn render_window(shading: &Shading<'_, '_>, camera: &Camera, window: Window) -> Film {
    let options = RenderOptions { window: Some(window), ..*shading.options };
    let mut film = options.film();
    for index in 0..film.color.len() {
        let (x, y) = (window.left + index % window.width, window.top + index / window.width);
        let pixel = pixel_key(x as u32, y as u32);
        render_samples(shading, camera, x, y, pixel, &mut film, index);
        if options.layers.has_centers() {
            render_center(shading, camera, x, y, &mut film, index);
        }
    }
    film
}

/// What the centre of pixel `(x, y)` shows, into the film's pixel `index`.
fn render_center(
    shading: &Shading<'_, '_>,
    camera: &Camera,
    x: usize,
    y: usize,
    film: &mut Film,
    index: usize,
) {
    let scene = shading.scene;
    let ray = pixel_ray(camera, shading.options.resolution, x as f64 + 0.5, y as f64 + 0.5);
    let Some(prepared) = prepare::<f32>(&ray, scene.header) else { return };
    let Some(hit) = first_hit(scene, shading.options.exactness, &prepared.ray, prepared.near) else { return };
    let t = prepared.start + hit.distance.to_f64();
    let normal = hit_normal(scene, &hit);
    let facing = if normal.dot(prepared.ray.direction) > 0.0 { -normal } else { normal };
    let layers = shading.options.layers;
    if layers.depth {
        film.depth[index] = (t * ray.direction.dot(camera.forward)) as f32;
    }
    if layers.normal {
        film.normal[index] = facing.to_array();
    }
    if layers.position {
        film.position[index] = (ray.origin + ray.direction * t).as_vec3().to_array();
    }
    if layers.uv {
        film.uv[index] =
            surface_parameters(scene, hit.face, hit.net, hit.uv).map(|parameter| parameter as f32);
    }
    if layers.ids {
        film.part[index] = hit.instance + 1;
        film.face[index] = hit.face + 1;
    }
}

/// The mean of a pixel's samples, and what they show first, into the film's pixel `index`.
fn render_samples(
    shading: &Shading<'_, '_>,
    camera: &Camera,
    x: usize,
    y: usize,
    pixel: u32,
    film: &mut Film,
    index: usize,
) {
    let samples = shading.options.samples.max(1);
    let layers = shading.options.layers;
    let mut sum = [0.0_f32; 4];
    let mut first_hits = FirstHits::default();
    for sample in 0..samples {
        let [across, down] = sample_offset(pixel, sample, samples);
        let (px, py) = (x as f64 + f64::from(across), y as f64 + f64::from(down));
        let ray = pixel_ray(camera, shading.options.resolution, px, py);
        let shaded = shade_ray(shading, &ray, pixel, sample);
        for k in 0..4 {
            sum[k] += shaded.color[k];
        }
        if let (true, Some((instance, face))) = (layers.has_first_hits(), shaded.first) {
            first_hits.add(shading.scene, instance, face);
        }
    }
    film.color[index] = sum.map(|c| c / samples as f32);
    if layers.albedo {
        film.albedo[index] = first_hits.albedo(samples);
    }
    if layers.matte {
        film.matte[index] = first_hits.shares(samples);
    }
}
