//! How long pictures and rays take on a device, and the kernels of a GPU alone.
//!
//! Pictures are what `render` makes without settings. Rays are counted where each costs the same: through all samples of all pixels with
//! nothing but lamps, and along chords of the scene's sphere.

use super::chord;
use super::stages::{Clock, Stage, StageTimes};
use crate::render::cpu::{pixel_key, pixel_ray, sample_offset};
use crate::render::{Camera, Ray, RenderOptions, Sampling, Viewpoint};
use crate::scene::Scene;
use rayon::prelude::*;
use std::time::Instant;

/// What a device is asked to do.
#[derive(Debug, Clone, Copy)]
pub enum FrameWork<'a> {
    /// A picture.
    Picture(&'a Camera, &'a RenderOptions),
    /// The first hit of each ray, in f32.
    FirstHits(&'a [Ray]),
}

/// How much to measure.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameLoad {
    /// Pixels across and down.
    pub resolution: [u32; 2],
    /// Primary rays through each pixel.
    pub samples: u32,
    /// Random rays.
    pub rays: u64,
    /// Runs that do not count.
    pub warm_ups: usize,
    /// Runs that count.
    pub repeat: usize,
}

impl FrameLoad {
    /// Rays of one run of [`Stage::Primary`].
    pub fn primary_rays(&self) -> u64 {
        u64::from(self.resolution[0]) * u64::from(self.resolution[1]) * u64::from(self.samples)
    }
}

/// Adds the times of [`Stage::Compile`], [`Stage::FirstFrame`], [`Stage::Frame`], [`Stage::Primary`] and [`Stage::Random`].
///
/// # Errors
/// Those of `work`.
pub fn measure_frames<E>(
    scene: &Scene<'_>,
    load: &FrameLoad,
    times: &mut StageTimes,
    work: &mut dyn FnMut(FrameWork<'_>) -> Result<(), E>,
) -> Result<(), E> {
    let camera = camera(scene, load);
    let picture = RenderOptions { resolution: load.resolution, ..RenderOptions::default() };
    let lamps = RenderOptions {
        samples: load.samples,
        sampling: Sampling::Uniform,
        ambient_occlusion: false,
        ..picture
    };
    let mut clock = Clock(Instant::now());
    work(FrameWork::Picture(&camera, &RenderOptions { resolution: [1, 1], ..picture }))?;
    times.add(Stage::Compile, clock.lap());
    work(FrameWork::Picture(&camera, &picture))?;
    times.add(Stage::FirstFrame, clock.lap());
    let rays = random_rays(scene, load);
    for run in 0..load.warm_ups + load.repeat {
        clock.lap();
        work(FrameWork::Picture(&camera, &picture))?;
        let frame = clock.lap();
        work(FrameWork::Picture(&camera, &lamps))?;
        let primary = clock.lap();
        work(FrameWork::FirstHits(&rays))?;
        let random = clock.lap();
        if run >= load.warm_ups {
            times.add(Stage::Frame, frame);
            times.add(Stage::Primary, primary);
            times.add(Stage::Random, random);
        }
    }
    Ok(())
}

/// GPUs take tenths of a second of work before they run at their full clock.
pub(super) const WARM_UP_SECONDS: f64 = 0.5;

/// The first hits of rays that a device holds, again and again, as a stage of their own.
///
/// # Errors
/// Those of `run`.
pub fn measure_kernel<E>(
    stage: Stage,
    load: &FrameLoad,
    times: &mut StageTimes,
    mut run: impl FnMut() -> Result<(), E>,
) -> Result<(), E> {
    let mut clock = Clock(Instant::now());
    for _ in 0..load.warm_ups {
        run()?;
    }
    while clock.0.elapsed().as_secs_f64() < WARM_UP_SECONDS {
        run()?;
    }
    for _ in 0..load.repeat {
        clock.lap();
        run()?;
        times.add(stage, clock.lap());
    }
    Ok(())
}

/// The rays of [`Stage::RandomKernel`] and [`Stage::Random`].
pub fn random_rays(scene: &Scene<'_>, load: &FrameLoad) -> Vec<Ray> {
    (0..load.rays).into_par_iter().map(|index| chord(scene, index)).collect()
}

/// Pixels along a side of the squares in which [`primary_rays`] go through a picture.
const SQUARE: u32 = 8;

/// A ray through each sample of each pixel, those of a square of pixels after each other: what a GPU traces side by side is side by side.
pub fn primary_rays(scene: &Scene<'_>, load: &FrameLoad) -> Vec<Ray> {
    let camera = camera(scene, load);
    let [width, height] = load.resolution;
    let squares: Vec<[u32; 2]> = (0..height)
        .step_by(SQUARE as usize)
        .flat_map(|y| (0..width).step_by(SQUARE as usize).map(move |x| [x, y]))
        .collect();
    let of_square = |&[left, top]: &[u32; 2]| {
        let camera = &camera;
        let columns = left..(left + SQUARE).min(width);
        let pixels =
            (top..(top + SQUARE).min(height)).flat_map(move |y| columns.clone().map(move |x| [x, y]));
        pixels.flat_map(move |[x, y]| {
            (0..load.samples).map(move |sample| {
                let [right, down] = sample_offset(pixel_key(x, y), sample, load.samples).map(f64::from);
                pixel_ray(camera, load.resolution, f64::from(x) + right, f64::from(y) + down)
            })
        })
    };
    squares.par_iter().flat_map_iter(of_square).collect()
}

fn camera(scene: &Scene<'_>, load: &FrameLoad) -> Camera {
    let aspect = f64::from(load.resolution[0]) / f64::from(load.resolution[1]);
    Camera::framing(&Viewpoint::default(), scene, aspect)
}
