//! How long pictures and rays take on a device.
//!
//! Pictures are what `render` makes without settings. Rays are counted where each costs the same: through all samples of all pixels with
//! nothing but lamps, and along chords of the scene's sphere.

use super::chord;
use super::stages::{Clock, Stage, StageTimes};
use crate::render::{Camera, Ray, RenderOptions, Sampling, Viewpoint};
use crate::scene::Scene;
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
    let aspect = f64::from(load.resolution[0]) / f64::from(load.resolution[1]);
    let camera = Camera::framing(&Viewpoint::default(), scene, aspect);
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
    let rays: Vec<Ray> = (0..load.rays).map(|index| chord(scene, index)).collect();
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
