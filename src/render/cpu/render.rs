//! Pictures: tiles over threads, samples over pixels.

use super::camera::{pixel_key, pixel_ray, sample_offset};
use super::ray_space::prepare;
use super::section::{NO_PLANE, first_seen};
use super::shade::{Shading, seen_normal, shade_ray};
use crate::image::Film;
use crate::render::{Camera, RenderOptions};
use crate::scene::Scene;
use rayon::prelude::*;
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Rows per unit of work.
const ROWS_PER_TILE: usize = 4;

/// Pixels of one row, or some of them.
struct Row {
    color: Vec<[f32; 4]>,
    depth: Vec<f32>,
    normal: Vec<[f32; 3]>,
    part: Vec<u32>,
    face: Vec<u32>,
}

/// Renders a picture; `progress` is told (done, total) units of work.
///
/// Deterministic: each pixel depends on its position and the options alone.
pub fn render(
    scene: &Scene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Film {
    let [width, height] = options.resolution.map(|n| n as usize);
    let tiles = height.div_ceil(ROWS_PER_TILE);
    let done = AtomicUsize::new(0);
    let shading = Shading::new(scene, camera, options);
    let rows: Vec<Vec<Row>> = (0..tiles)
        .into_par_iter()
        .map(|tile| {
            let last = height.min((tile + 1) * ROWS_PER_TILE);
            let rows =
                (tile * ROWS_PER_TILE..last).map(|y| render_row(&shading, camera, y, 0..width)).collect();
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, tiles);
            rows
        })
        .collect();
    let mut film = Film::new(width, height);
    for (y, row) in rows.into_iter().flatten().enumerate() {
        row.put(&mut film, y * width);
    }
    options.background.put_behind(&mut film);
    film
}

/// Renders some pixels of a picture, by index, into `film`; without a background.
pub fn render_pixels(
    scene: &Scene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    pixels: &[usize],
    film: &mut Film,
) {
    let shading = Shading::new(scene, camera, options);
    let width = options.resolution[0] as usize;
    let one = |&pixel: &usize| {
        let (x, y) = (pixel % width, pixel / width);
        render_row(&shading, camera, y, x..x + 1)
    };
    let rendered: Vec<Row> = pixels.par_iter().map(one).collect();
    for (pixel, row) in pixels.iter().zip(rendered) {
        row.put(film, *pixel);
    }
}

impl Row {
    /// Writes the pixels from index `first` on.
    fn put(&self, film: &mut Film, first: usize) {
        let range = first..first + self.color.len();
        film.color[range.clone()].copy_from_slice(&self.color);
        film.depth[range.clone()].copy_from_slice(&self.depth);
        film.normal[range.clone()].copy_from_slice(&self.normal);
        film.part[range.clone()].copy_from_slice(&self.part);
        film.face[range].copy_from_slice(&self.face);
    }
}

/// The pixels of row `y` in the given columns.
fn render_row(shading: &Shading<'_, '_>, camera: &Camera, y: usize, columns: Range<usize>) -> Row {
    let resolution = shading.options.resolution;
    let width = columns.len();
    let mut row = Row {
        color: vec![[0.0; 4]; width],
        depth: vec![f32::INFINITY; width],
        normal: vec![[0.0; 3]; width],
        part: vec![0; width],
        face: vec![0; width],
    };
    for (place, x) in columns.enumerate() {
        let pixel = pixel_key(x as u32, y as u32);
        row.color[place] = pixel_color(shading, camera, x, y, pixel);
        let ray = pixel_ray(camera, resolution, x as f64 + 0.5, y as f64 + 0.5);
        let Some(prepared) = prepare::<f32>(&ray, shading.scene.header) else { continue };
        let exactness = shading.options.exactness;
        let mut cut = shading.cut(&prepared);
        let seen = first_seen(shading.scene, exactness, &prepared.ray, prepared.near, &mut cut);
        let Some(seen) = seen else { continue };
        let t = prepared.start + seen.hit.distance.to_f64();
        let normal = seen_normal(shading, &seen);
        let facing = if normal.dot(prepared.ray.direction) > 0.0 { -normal } else { normal };
        row.depth[place] = (t * ray.direction.dot(camera.forward)) as f32;
        row.normal[place] = facing.to_array();
        row.part[place] = seen.hit.instance + 1;
        row.face[place] = if seen.cap == NO_PLANE { seen.hit.face + 1 } else { 0 };
    }
    row
}

/// The mean of a pixel's samples.
fn pixel_color(shading: &Shading<'_, '_>, camera: &Camera, x: usize, y: usize, pixel: u32) -> [f32; 4] {
    let samples = shading.options.samples.max(1);
    let mut sum = [0.0_f32; 4];
    for sample in 0..samples {
        let [across, down] = sample_offset(pixel, sample, samples);
        let (px, py) = (x as f64 + f64::from(across), y as f64 + f64::from(down));
        let ray = pixel_ray(camera, shading.options.resolution, px, py);
        let color = shade_ray(shading, &ray, pixel, sample);
        for k in 0..4 {
            sum[k] += color[k];
        }
    }
    sum.map(|c| c / samples as f32)
}
