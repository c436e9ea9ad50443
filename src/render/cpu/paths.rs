//! Path-traced pictures on the CPU: pixels over threads.

use super::environment::Surroundings;
use super::path::{DONE, PathState, PathSum, Paths, WorldGround, turn};
use super::shade::Shading;
use super::vector::Vector3;
use crate::image::Film;
use crate::render::environment::Shares;
use crate::render::paths::{MOST_PIXELS, behind, paint_paths, path_window};
use crate::render::{Camera, PathOptions, RenderOptions};
use crate::scene::Scene;
use bytemuck::Zeroable;
use rayon::prelude::*;
use std::convert::Infallible;
use std::ops::Range;

/// Renders the light of a picture, or of the part of it that the options ask for; `progress` is told (done, total) units of work. The film has no layers; of
/// `options` the samples and the ambient occlusion are of no account.
///
/// Deterministic: a pixel depends on its position in the whole picture, on the options and on the seed alone.
pub fn render_paths(
    scene: &Scene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    paths: &PathOptions,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Film {
    let ground = paths.world_ground(camera, scene.header);
    let painted = paint_paths(options, paths, progress, MOST_PIXELS, |pixels, samples| {
        Ok::<_, Infallible>(take_path_samples(
            scene,
            camera,
            options,
            (paths, ground.as_ref()),
            pixels,
            samples,
        ))
    });
    let mut film = painted.unwrap_or_else(|never| match never {});
    options.background.put_behind(&mut film);
    film
}

/// Adds up samples of some pixels.
pub fn take_path_samples(
    scene: &Scene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    (paths, ground): (&PathOptions, Option<&(WorldGround, Shares)>),
    pixels: &[u32],
    samples: Range<u32>,
) -> Vec<PathSum> {
    let window = path_window(options, paths);
    let shading = Shading::new(scene, camera, options);
    let axes = paths.map_axes(camera).map(|axis| Vector3::from_f64(axis.to_array()));
    let paths = Paths {
        shading: &shading,
        surroundings: Surroundings {
            map: &paths.environment,
            on_ground: ground.map_or(&[], |(_, shares)| shares),
            axes,
        },
        ground: ground.map(|(ground, _)| *ground),
        camera,
        options: paths,
        brightest: paths.brightest(),
        behind: behind(options),
        window: [window.left, window.top, window.width].map(|n| n as u32),
    };
    let take = |&pixel: &u32| {
        let mut state =
            PathState { pixel, sample_index: samples.start, end: samples.end, ..PathState::zeroed() };
        let mut sum = PathSum::zeroed();
        while state.kind != DONE {
            turn(&paths, &mut state, &mut sum);
        }
        sum
    };
    pixels.par_iter().map(take).collect()
}
