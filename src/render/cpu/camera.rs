//! Rays through pixels, and where in a pixel samples lie.

use super::sobol::sample_pair;
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

/// What tells pixels apart in sample sequences: x in the low half, y in the high one.
pub fn pixel_key(x: u32, y: u32) -> u32 {
    x & 0xffff | y << 16
}

/// Where sample `index` of `count` lies in its pixel, both in 0..1: spread so that the first 2, 4, 8 … are spread as well.
pub fn sample_offset(pixel: u32, index: u32, count: u32) -> [f32; 2] {
    if count <= 1 { [0.5, 0.5] } else { sample_pair(pixel, index, 0, 0) }
}
