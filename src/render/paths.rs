//! Path-traced pictures: what is common to both tracers.
//!
//! Samples are taken in passes over the pixels that still want some. A pixel depends on its place in the picture, the seed and its block of 8 by 8 pixels
//! alone, whose corners are those of the whole picture, so that tiles fit together to the bit; blocks are what stops early: one pixel's few samples say little of
//! its error, those of 64 say enough.

use super::cpu::path::{BRIGHTEST, PathSum, WorldGround};
use super::cpu::ray_space::scene_radius;
use super::cpu::vector::Vector3;
use super::environment::Shares;
use super::{Background, Camera, Environment, RenderOptions};
use crate::image::{Film, Window, decode_srgb};
use crate::scene::Header;
use glam::DVec3;
use std::ops::Range;

/// Pixels along the side of a block.
const BLOCK: usize = 8;
/// Samples before the first look at errors, and between looks.
const PASS: u32 = 16;
/// Pixels in one call of the CPU tracer.
pub(super) const MOST_PIXELS: usize = 1 << 16;
/// The luminance below which errors count as they do there: the eye sees no more in black.
const DARK: f64 = 0.01;
/// How far the ground is below the model, of the scene's radius: farther than rays start above it.
const GROUND_GAP: f64 = 4e-5;

/// A plane that catches shadows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ground {
    /// Unit normal, model space.
    pub up: DVec3,
    /// `up · p` of the model's lowest point, millimetres.
    pub height: f64,
}

/// How paths are traced.
#[derive(Debug, Clone, PartialEq)]
pub struct PathOptions {
    /// Samples of a pixel, at most.
    pub samples: u32,
    /// Surfaces along a path.
    pub max_depth: u32,
    /// Another one gives other noise.
    pub seed: u32,
    /// The standard error of a block's pixels, as the eye sees it, from 0 to 1 of the range of a picture, at which it is good enough; `None` takes all samples.
    pub noise: Option<f32>,
    /// Below the model.
    pub ground: Option<Ground>,
    /// Light.
    pub environment: Environment,
    /// Model-space unit vectors to the right of the map's middle, up, and away from the middle; `None`: those of the camera.
    pub axes: Option<[DVec3; 3]>,
    /// Whether the surroundings are seen behind the model.
    pub shows_surroundings: bool,
}

impl PathOptions {
    /// What the environment's map calls x, y and z, world space.
    pub(super) fn map_axes(&self, camera: &Camera) -> [DVec3; 3] {
        self.axes.unwrap_or([camera.right, camera.up, -camera.forward])
    }

    /// The greatest luminance of a path's light that comes by way of several surfaces; positive.
    pub(super) fn brightest(&self) -> f32 {
        (self.environment.mean() * BRIGHTEST) as f32 + f32::MIN_POSITIVE
    }

    /// The ground in world space, and what light on it is sampled by.
    pub(super) fn world_ground(&self, camera: &Camera, header: &Header) -> Option<(WorldGround, Shares)> {
        let ground = self.ground?;
        let gap = scene_radius(header) * GROUND_GAP;
        let height = ground.height - gap - ground.up.dot(DVec3::from_array(header.world_anchor));
        let in_map = self.map_axes(camera).map(|axis| axis.dot(ground.up));
        let in_map = DVec3::from_array(in_map);
        let irradiance = self.environment.irradiance(in_map) as f32;
        let up = Vector3::from_f64(ground.up.to_array());
        let ground = WorldGround { up, height: height as f32, irradiance };
        (irradiance > 0.0).then(|| (ground, self.environment.received_shares(in_map)))
    }
}

/// The luminance of what is behind the model.
pub(super) fn behind(options: &RenderOptions) -> f32 {
    match options.background {
        Background::Transparent => 1.0,
        Background::Color(srgb) => {
            super::cpu::bsdf::luminance(srgb.map(|code| decode_srgb(f64::from(code)) as f32))
        }
    }
}

/// The part of a picture to render: whole blocks where blocks stop early.
pub(super) fn path_window(options: &RenderOptions, paths: &PathOptions) -> Window {
    let whole = options.resolution.map(|n| n as usize);
    let asked = options.window.unwrap_or(Window::whole(whole[0], whole[1]));
    if paths.noise.is_none() {
        return asked;
    }
    let (left, top) = (asked.left / BLOCK * BLOCK, asked.top / BLOCK * BLOCK);
    let right = ((asked.left + asked.width).next_multiple_of(BLOCK)).min(whole[0]);
    let bottom = ((asked.top + asked.height).next_multiple_of(BLOCK)).min(whole[1]);
    Window { left, top, width: right - left, height: bottom - top }
}

/// All samples of a pixel so far.
#[derive(Debug, Clone, Copy, Default)]
struct Gathered {
    color: [f64; 4],
    brightness: f64,
    square: f64,
}

impl Gathered {
    fn add(&mut self, sum: &PathSum) {
        for (all, own) in self.color.iter_mut().zip(sum.color) {
            *all += f64::from(own);
        }
        self.brightness += f64::from(sum.brightness);
        self.square += f64::from(sum.square);
    }

    /// The square of the standard error of the mean as the eye sees it: of its root, about.
    fn square_error(&self, samples: f64) -> f64 {
        let mean = self.brightness / samples;
        let variance = (self.square / samples - mean * mean).max(0.0) / (samples - 1.0);
        variance / (4.0 * mean.max(DARK))
    }
}

/// The picture without a background. `take` adds up samples of some pixels of [`path_window`], at most `most`, given by index.
///
/// # Errors
///
/// Those of `take`.
pub(super) fn paint_paths<E>(
    options: &RenderOptions,
    paths: &PathOptions,
    progress: &(dyn Fn(usize, usize) + Sync),
    most: usize,
    mut take: impl FnMut(&[u32], Range<u32>) -> Result<Vec<PathSum>, E>,
) -> Result<Film, E> {
    let window = path_window(options, paths);
    let whole = options.resolution.map(|n| n as usize);
    let pixels = window.width * window.height;
    let mut gathered = vec![Gathered::default(); pixels];
    let mut taken = vec![0; pixels];
    let mut active: Vec<u32> = (0..pixels as u32).collect();
    let all = pixels * paths.samples as usize;
    let mut done = 0;
    let mut first = 0;
    while first < paths.samples && !active.is_empty() {
        let pass = first..paths.samples.min(first + PASS);
        for some in active.chunks(most) {
            progress(done, all);
            for (&pixel, sum) in some.iter().zip(take(some, pass.clone())?) {
                gathered[pixel as usize].add(&sum);
                taken[pixel as usize] = pass.end;
            }
            done += some.len() * pass.len();
        }
        if let Some(noise) = paths.noise {
            let noisy = noisy_blocks(window, &gathered, f64::from(pass.end), f64::from(noise));
            let count = active.len();
            active.retain(|&pixel| noisy[block_of(window, pixel as usize)]);
            done += (count - active.len()) * (paths.samples - pass.end) as usize;
        }
        first = pass.end;
    }
    progress(all, all);
    let mut film = Film::of_window(window, whole, crate::image::Layers::NONE);
    for ((color, gathered), &taken) in film.color.iter_mut().zip(&gathered).zip(&taken) {
        *color = gathered.color.map(|sum| (sum / f64::from(taken.max(1))) as f32);
        color[3] = color[3].clamp(0.0, 1.0);
    }
    let asked = options.window.unwrap_or(Window::whole(whole[0], whole[1]));
    let mut cut = Film::of_window(asked, whole, crate::image::Layers::NONE);
    cut.cut_from(&film, asked.left - window.left, asked.top - window.top);
    Ok(cut)
}

/// Blocks across a window that begins with one.
fn blocks_across(window: Window) -> usize {
    window.width.div_ceil(BLOCK)
}

fn block_of(window: Window, pixel: usize) -> usize {
    pixel / window.width / BLOCK * blocks_across(window) + pixel % window.width / BLOCK
}

/// Which blocks are not good enough yet; of those that have stopped it is of no account.
fn noisy_blocks(window: Window, gathered: &[Gathered], samples: f64, noise: f64) -> Vec<bool> {
    let mut errors = vec![(0.0, 0.0); blocks_across(window) * window.height.div_ceil(BLOCK)];
    for (pixel, gathered) in gathered.iter().enumerate() {
        let (sum, count) = &mut errors[block_of(window, pixel)];
        *sum += gathered.square_error(samples);
        *count += 1.0;
    }
    errors.iter().map(|(sum, count)| *sum > noise * noise * count).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::convert::Infallible;

    fn options(window: Option<Window>) -> RenderOptions {
        RenderOptions { resolution: [50, 30], window, ..RenderOptions::default() }
    }

    fn paths(noise: Option<f32>) -> PathOptions {
        PathOptions {
            samples: 256,
            max_depth: 1,
            seed: 0,
            noise,
            ground: None,
            environment: Environment::studio(),
            axes: None,
            shows_surroundings: false,
        }
    }

    /// Pixels of the right half are of noise, those of the left alike.
    fn painted(window: Option<Window>, noise: Option<f32>) -> (Film, usize) {
        let (options, paths) = (options(window), paths(noise));
        let part = path_window(&options, &paths);
        let mut samples = 0;
        let film = paint_paths(&options, &paths, &|_, _| {}, MOST_PIXELS, |pixels, range| {
            samples += pixels.len() * range.len();
            let sum = |&pixel: &u32| {
                let x = part.left + pixel as usize % part.width;
                let y = part.top + pixel as usize / part.width;
                let mut sum =
                    PathSum { color: [0.0; 4], brightness: 0.0, square: 0.0, is_cut: 0, is_done: 0 };
                for sample in range.clone() {
                    let key = (x + 50 * y) as u32;
                    let noise = super::super::cpu::sobol::hash(key, sample, 0) as f32 / u32::MAX as f32;
                    let value = if x < 24 { 0.5 } else { noise };
                    sum.color = sum.color.map(|all| all + value);
                    sum.brightness += value;
                    sum.square += value * value;
                }
                sum
            };
            Ok::<_, Infallible>(pixels.iter().map(sum).collect())
        });
        (film.unwrap_or_else(|never| match never {}), samples)
    }

    #[test]
    fn blocks_stop_where_they_are_good_enough_and_tiles_fit() {
        let (whole, all) = painted(None, None);
        assert_eq!(all, 50 * 30 * 256);
        let (early, fewer) = painted(None, Some(0.04));
        assert!(fewer < all / 4 && fewer > all / 16, "{fewer}");
        assert_ne!(whole.color, early.color);
        for noise in [None, Some(0.04)] {
            let (mut joined, _) = painted(None, noise);
            let expected = joined.clone();
            joined.color.fill([9.0; 4]);
            for window in [
                Window { left: 0, top: 0, width: 29, height: 30 },
                Window { left: 29, top: 0, width: 21, height: 13 },
                Window { left: 29, top: 13, width: 21, height: 17 },
            ] {
                joined.paste(&painted(Some(window), noise).0, window.left, window.top);
            }
            assert_eq!(joined, Film { ..expected });
        }
    }
}
