//! Rays through pixels, and where in a pixel samples lie.

use crate::image::Window;
use crate::render::{Camera, Ray};

/// The model-space ray through `(x, y)` of the picture in pixels, from the left and from the top.
pub fn pixel_ray(camera: &Camera, resolution: [u32; 2], x: f64, y: f64) -> Ray {
    let [x, y, aspect] = in_picture(resolution, x, y);
    camera.ray(x, y, aspect)
}

/// Where `(x, y)` in pixels is in a picture: from −1 to 1 from the left and from the bottom, and how many times as wide as high the picture is.
pub fn in_picture(resolution: [u32; 2], x: f64, y: f64) -> [f64; 3] {
    let (width, height) = (f64::from(resolution[0]), f64::from(resolution[1]));
    [2.0 * x / width - 1.0, 1.0 - 2.0 * y / height, width / height]
}

/// The ray through the centre of pixel `pixel` of a part of a picture, row by row.
pub fn center_ray(camera: &Camera, resolution: [u32; 2], window: Window, pixel: usize) -> Ray {
    let [x, y, aspect] = center_in_picture(resolution, window, pixel);
    camera.ray(x, y, aspect)
}

/// Where that centre is, as [`in_picture`] has it.
pub fn center_in_picture(resolution: [u32; 2], window: Window, pixel: usize) -> [f64; 3] {
    let (x, y) = (window.left + pixel % window.width, window.top + pixel / window.width);
    in_picture(resolution, x as f64 + 0.5, y as f64 + 0.5)
}

/// What tells pixels apart in [`hash`] and in sample sequences: x in the low half, y in the high one.
pub fn pixel_key(x: u32, y: u32) -> u32 {
    x & 0xffff | y << 16
}

/// Where sample `index` of `count` lies in its pixel, both in 0..1: stratified over a grid of cells, jittered within the cell.
pub fn sample_offset(pixel: u32, index: u32, count: u32) -> [f32; 2] {
    if count <= 1 {
        return [0.5, 0.5];
    }
    let columns = stratum_columns(count);
    let rows = count.div_ceil(columns);
    let (column, row) = (index % columns, index / columns);
    // The last row may be shorter: its cells are wider.
    let in_row = if row + 1 == rows { count - row * columns } else { columns };
    let jitter_x = unit(hash(pixel, index, 0));
    let jitter_y = unit(hash(pixel, index, 1));
    [(column as f32 + jitter_x) / in_row as f32, (row as f32 + jitter_y) / rows as f32]
}

/// The least number of columns whose square holds `count`.
fn stratum_columns(count: u32) -> u32 {
    let mut columns = 1;
    while columns * columns < count && columns < 256 {
        columns += 1;
    }
    columns
}

/// A hash of three numbers (PCG, Jarzynski and Olano 2020): the same on every machine and in every order of work.
pub fn hash(pixel: u32, sample: u32, dimension: u32) -> u32 {
    let seed = pixel
        .wrapping_mul(747_796_405)
        .wrapping_add(sample.wrapping_mul(2_891_336_453))
        .wrapping_add(dimension.wrapping_mul(1_013_904_223))
        .wrapping_add(12_345);
    permute(permute(seed))
}

fn permute(value: u32) -> u32 {
    let state = value.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// The top 24 bits as a number in 0..1.
pub fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 / 16_777_216.0
}
