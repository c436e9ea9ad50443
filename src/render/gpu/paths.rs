//! Path-traced pictures: some rays of a run of pixels a dispatch, until all their samples are taken.
//!
//! The state of each pixel stays on the device between dispatches, so that none runs long, however deep paths go. On a software device, which counts loop
//! turns, a dispatch is one ray of each pixel.

use super::picture::{GpuCamera, GpuSection, gpu_section, place_camera};
use super::{Entry, Gpu, GpuError, GpuScene, Grouping};
use crate::image::Film;
use crate::render::cpu::path::{PathState, PathSum, path_reach};
use crate::render::cpu::section::WorldSection;
use crate::render::cpu::{render_paths, take_path_samples};
use crate::render::paths::{behind, paint_paths, path_window};
use crate::render::{Camera, PathOptions, RenderOptions};
use bytemuck::{Pod, Zeroable};
use std::ops::Range;

/// Rays of each pixel in a dispatch, and pixels: a million rays, which a slow device traces within its driver's patience.
const RAYS: u32 = 16;
const MOST_PATHS: usize = 1 << 16;

/// `PathParameters` of `shaders/entry/paths.wgsl`. 496 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct PathParameters {
    camera: GpuCamera,
    section: GpuSection,
    map_x: [f32; 3],
    map_width: u32,
    map_y: [f32; 3],
    map_height: u32,
    map_z: [f32; 3],
    seed: u32,
    ground_up: [f32; 3],
    ground_height: f32,
    ground_irradiance: f32,
    reach: f32,
    max_depth: u32,
    shows_surroundings: u32,
    behind: f32,
    pixel_count: u32,
    rays: u32,
    brightest: f32,
}

const _: () = assert!(size_of::<PathParameters>() == 496);

impl Gpu {
    /// Renders the light of a picture; what [`cpu::render_paths`](crate::render::cpu::render_paths) does.
    ///
    /// # Errors
    ///
    /// [`GpuError::TooLarge`] where the map of light is larger than the device can bind, and the device's own.
    pub fn render_paths(
        &self,
        scene: &GpuScene<'_>,
        camera: &Camera,
        options: &RenderOptions,
        paths: &PathOptions,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Film, GpuError> {
        let header = scene.scene.header;
        let window = path_window(options, paths);
        let map = &paths.environment;
        let texels: &[u8] = bytemuck::cast_slice(&map.texels);
        let most =
            self.device.limits().max_storage_buffer_binding_size.min(self.device.limits().max_buffer_size);
        if texels.len() as u64 > most {
            return Err(GpuError::TooLarge { array: "map of light", bytes: texels.len() as u64, most });
        }
        let Some((_, placed)) = place_camera(camera, options.resolution, window, header) else {
            // So far away that there is nothing to do but the surroundings.
            return Ok(render_paths(&scene.scene, camera, options, paths, progress));
        };
        let found_ground = paths.world_ground(camera, header);
        let ground = found_ground.as_ref().map(|(ground, _)| ground);
        let [map_x, map_y, map_z] = paths.map_axes(camera).map(|axis| axis.as_vec3().to_array());
        let section = WorldSection::new(&options.section, header, camera, options.resolution[1]);
        let parameters = PathParameters {
            camera: placed,
            section: gpu_section(&section),
            map_x,
            map_width: map.width as u32,
            map_y,
            map_height: map.height as u32,
            map_z,
            seed: paths.seed,
            ground_up: ground.map_or([0.0; 3], |ground| ground.up.to_array()),
            ground_height: ground.map_or(0.0, |ground| ground.height),
            ground_irradiance: ground.map_or(0.0, |ground| ground.irradiance),
            reach: path_reach(header, ground.is_some()) as f32,
            max_depth: paths.max_depth,
            shows_surroundings: paths.shows_surroundings.into(),
            behind: behind(options),
            brightest: paths.brightest(),
            ..PathParameters::zeroed()
        };
        let texels = self.create_input("map of light", texels);
        let on_ground = found_ground.as_ref().map_or(&[][..], |(_, shares)| shares);
        let shares: Vec<f32> = map.shares.iter().chain(on_ground).copied().collect();
        let shares = self.create_input("shares of the map", bytemuck::cast_slice(&shares));
        let light = [&texels, &shares];
        let mut film = paint_paths(
            options,
            paths,
            progress,
            self.most_elements().min(MOST_PATHS),
            |pixels, samples| {
                let mut sums =
                    self.path_samples(scene, options, parameters, light, pixels, samples.clone())?;
                let given_up: Vec<usize> = (0..sums.len()).filter(|&index| sums[index].is_cut != 0).collect();
                let asked: Vec<u32> = given_up.iter().map(|&index| pixels[index]).collect();
                let found = take_path_samples(
                    &scene.scene,
                    camera,
                    options,
                    (paths, found_ground.as_ref()),
                    &asked,
                    samples,
                );
                for (index, sum) in given_up.into_iter().zip(found) {
                    sums[index] = sum;
                }
                Ok::<_, GpuError>(sums)
            },
        )?;
        options.background.put_behind(&mut film);
        Ok(film)
    }

    /// The sums of some pixels' samples; those that a software device gives up on are marked.
    fn path_samples(
        &self,
        scene: &GpuScene<'_>,
        options: &RenderOptions,
        mut parameters: PathParameters,
        [texels, shares]: [&wgpu::Buffer; 2],
        pixels: &[u32],
        samples: Range<u32>,
    ) -> Result<Vec<PathSum>, GpuError> {
        let count = pixels.len() as u32;
        let state = |&pixel: &u32| PathState {
            pixel,
            sample_index: samples.start,
            end: samples.end,
            ..PathState::zeroed()
        };
        let fresh: Vec<PathState> = pixels.iter().map(state).collect();
        let states = self.create_input("paths", bytemuck::cast_slice(&fresh));
        let sums = self.create_output("sums", size_of::<PathSum>() as u64 * u64::from(count));
        parameters.pixel_count = count;
        parameters.rays = if self.is_software() { 1 } else { RAYS };
        let uniform = self.create_uniform("path parameters", &parameters);
        let bind_group = self.bind(Entry::Paths, &[&uniform, texels, shares, &states, &sums]);
        let has_section = parameters.section.has_planes();
        let mut grouping = Grouping::Wide;
        loop {
            let pipeline = self.pipeline(Entry::Paths, scene, options.exactness, has_section, grouping)?;
            self.dispatch(&pipeline, scene, &bind_group, count, grouping)?;
            let found: Vec<PathSum> = self.read(&sums, pixels.len())?;
            let waits = |sum: &&PathSum| sum.is_done == 0 && sum.is_cut == 0;
            let is_cut = found.iter().any(|sum| sum.is_cut != 0);
            // A ray that runs out of turns beside others has all for itself in the next dispatch; what is cut then is given up.
            if is_cut && grouping == Grouping::Wide {
                grouping = Grouping::Narrow;
            } else if found.iter().find(waits).is_none() {
                return Ok(found);
            } else {
                grouping = Grouping::Wide;
            }
        }
    }
}
