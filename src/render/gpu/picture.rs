//! Pictures: the centres of a run of pixels a dispatch, then one sample of some pixels a dispatch.
//!
//! A run is short enough that a dispatch never comes near a driver's time limit. Samples are summed on the
//! device in the CPU tracer's order, then read back. Memory on the device does not depend on the picture's size. What is made of centres and samples
//! is common to both tracers (`cpu::adaptive`).

use super::kernels::MOST_HARDWARE_ELEMENTS;
use super::{Entry, Gpu, GpuError, GpuScene, Grouping};
use crate::image::{Film, Window};
use crate::render::cpu::adaptive::{Centers, paint, with_margin};
use crate::render::cpu::camera::pixel_key;
use crate::render::cpu::pixels::{Center, INCOMPLETE, Refined, Sampled};
use crate::render::cpu::section::WorldSection;
use crate::render::cpu::{self, shade};
use crate::render::first_hits::FirstHits;
use crate::render::section::MAX_PLANES;
use crate::render::{Camera, RenderOptions};
use crate::scene::Header;
use bytemuck::{Pod, Zeroable};
use glam::DVec3;
use std::ops::Range;

/// `Camera` of `shaders/camera.wgsl`. 96 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(super) struct GpuCamera {
    grid: [i32; 3],
    eye_distance: f32,
    fraction: [f32; 3],
    orthographic: u32,
    forward: [f32; 3],
    corner: u32,
    forward_low: [f32; 3],
    window_width: u32,
    right: [f32; 3],
    width: u32,
    up: [f32; 3],
    height: u32,
}

/// `Lights` of `shaders/shade.wgsl`. 48 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct GpuLights {
    key: [f32; 3],
    reserved_0: u32,
    fill: [f32; 3],
    reserved_1: u32,
    up: [f32; 3],
    ambient_occlusion: u32,
}

/// `SectionPlane` of `shaders/section.wgsl`. 48 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct GpuSectionPlane {
    normal: [f32; 3],
    offset: f32,
    hatch_x: [f32; 3],
    reserved_0: u32,
    hatch_y: [f32; 3],
    reserved_1: u32,
}

/// `Section` of `shaders/section.wgsl`. 304 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub(super) struct GpuSection {
    planes: [GpuSectionPlane; MAX_PLANES],
    count: u32,
    caps: u32,
    sense: f32,
    reserved: u32,
}

/// `RenderParameters` of `shaders/entry/render.wgsl`. 480 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct RenderParameters {
    camera: GpuCamera,
    lights: GpuLights,
    section: GpuSection,
    first_pixel: u32,
    pixel_count: u32,
    sample_index: u32,
    samples: u32,
    centers_only: u32,
    reserved: [u32; 3],
}

impl Gpu {
    /// Renders a picture; `progress` is told (done, total) units of work.
    ///
    /// # Errors
    ///
    /// The device's own.
    pub fn render(
        &self,
        scene: &GpuScene<'_>,
        camera: &Camera,
        options: &RenderOptions,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Film, GpuError> {
        let window = with_margin(options);
        let placed = place_camera(camera, options.resolution, window, scene.scene.header);
        let Some((eye_distance, placed)) = placed else {
            let mut film = options.film();
            options.background.put_behind(&mut film);
            return Ok(film);
        };
        let shot = Shot { gpu: self, scene, camera, options, placed };
        let count = window.width * window.height;
        let mut centers = Centers::new(&scene.scene, camera, options);
        let most = self.most_elements();
        for first in (0..count).step_by(most) {
            let pixels = first as u32..(first + most).min(count) as u32;
            progress(first, count);
            let found = shot.centers(pixels)?;
            centers
                .take(first, found.len(), eye_distance, |some| &found[some.start - first..some.end - first]);
        }
        progress(count, count);
        let mut film = paint(centers, most, |refined| shot.samples(refined))?;
        options.background.put_behind(&mut film);
        Ok(film)
    }
}

/// Samples that are dispatched before the first of them is waited for.
const SAMPLES_IN_FLIGHT: u32 = 8;

// The least that Vulkan lets a kernel bind.
const _: () = assert!(MOST_HARDWARE_ELEMENTS * size_of::<Refined>() <= 128 << 20);

/// One picture of one scene.
struct Shot<'a> {
    gpu: &'a Gpu,
    scene: &'a GpuScene<'a>,
    camera: &'a Camera,
    options: &'a RenderOptions,
    placed: GpuCamera,
}

impl Shot<'_> {
    /// What the centres of a run of pixels show; depths are from the plane through the scene's centre.
    fn centers(&self, pixels: Range<u32>) -> Result<Vec<Center>, GpuError> {
        let parameters = RenderParameters {
            first_pixel: pixels.start,
            pixel_count: pixels.len() as u32,
            centers_only: 1,
            ..self.parameters()
        };
        let mut centers = self.run(parameters, &[Refined::zeroed()])?.centers;
        // What a software device gives up on, a few pixels at poles, the twin renders.
        let given_up: Vec<u32> =
            pixels.clone().zip(&centers).filter(|(_, c)| c.flags & INCOMPLETE != 0).map(|(p, _)| p).collect();
        let eye_distance = self.eye_distance();
        let found = cpu::find_centers(&self.scene.scene, self.camera, self.options, &given_up);
        for (pixel, mut center) in given_up.into_iter().zip(found) {
            center.depth = (f64::from(center.depth) - eye_distance) as f32;
            centers[(pixel - pixels.start) as usize] = center;
        }
        Ok(centers)
    }

    /// All samples of some pixels.
    fn samples(&self, refined: &[Refined]) -> Result<Vec<Sampled>, GpuError> {
        let samples = self.options.samples.max(1);
        let parameters = RenderParameters { pixel_count: refined.len() as u32, samples, ..self.parameters() };
        let Run { sums, centers, first_hits } = self.run(parameters, refined)?;
        let mean = |sum: [f32; 4]| sum.map(|component| component / samples as f32);
        let mut sampled: Vec<Sampled> = sums
            .into_iter()
            .zip(&centers)
            .zip(first_hits)
            .map(|((sum, center), first_hits)| Sampled {
                color: mean(sum),
                flags: center.flags,
                albedo: first_hits.albedo(samples),
                matte: first_hits.shares(samples),
            })
            .collect();
        let given_up: Vec<usize> =
            (0..sampled.len()).filter(|&index| sampled[index].flags & INCOMPLETE != 0).collect();
        let asked: Vec<Refined> = given_up.iter().map(|&index| refined[index]).collect();
        let found = cpu::take_samples(&self.scene.scene, self.camera, self.options, &asked);
        for (index, one) in given_up.into_iter().zip(found) {
            sampled[index] = one;
        }
        Ok(sampled)
    }

    fn parameters(&self) -> RenderParameters {
        let lights = gpu_lights(&shade::Lights::from_camera(self.camera), self.options);
        let RenderOptions { section, resolution, .. } = self.options;
        let section = WorldSection::new(section, self.scene.scene.header, self.camera, resolution[1]);
        let section = gpu_section(&section);
        RenderParameters { camera: self.placed, lights, section, samples: 1, ..RenderParameters::zeroed() }
    }

    fn eye_distance(&self) -> f64 {
        f64::from(self.placed.eye_distance)
    }

    /// Runs the kernel, again with narrow workgroups where wide ones run out of loop turns.
    fn run(&self, parameters: RenderParameters, refined: &[Refined]) -> Result<Run, GpuError> {
        let run = self.run_once(parameters, refined, Grouping::Wide)?;
        if run.centers.iter().any(|center| center.flags & INCOMPLETE != 0) {
            return self.run_once(parameters, refined, Grouping::Narrow);
        }
        Ok(run)
    }

    fn run_once(
        &self,
        mut parameters: RenderParameters,
        refined: &[Refined],
        grouping: Grouping,
    ) -> Result<Run, GpuError> {
        let gpu = self.gpu;
        let count = parameters.pixel_count;
        let asked = gpu.create_input("refined pixels", bytemuck::cast_slice(refined));
        let colors = gpu.create_output("colors", size_of::<[f32; 4]>() as u64 * u64::from(count));
        let centers = gpu.create_output("centers", size_of::<Center>() as u64 * u64::from(count));
        let pipeline = gpu.pipeline(
            Entry::Render,
            self.scene,
            self.options.exactness,
            parameters.section.count > 0,
            grouping,
        )?;
        let mut first_hits = vec![FirstHits::default(); count as usize];
        for sample in 0..parameters.samples {
            parameters.sample_index = sample;
            let uniform = gpu.create_uniform("render parameters", &parameters);
            let bind_group = gpu.bind(Entry::Render, &[&uniform, &asked, &colors, &centers]);
            gpu.dispatch(&pipeline, self.scene, &bind_group, count, grouping)?;
            if sample % SAMPLES_IN_FLIGHT == SAMPLES_IN_FLIGHT - 1 {
                gpu.wait()?;
            }
            if self.options.layers.has_first_hits() && parameters.centers_only == 0 {
                let found: Vec<Center> = gpu.read(&centers, count as usize)?;
                for (hits, center) in first_hits.iter_mut().zip(found).filter(|(_, c)| c.instance != 0) {
                    hits.add(&self.scene.scene, center.instance - 1, center.face - 1);
                }
            }
        }
        let (sums, centers) = (gpu.read(&colors, count as usize)?, gpu.read(&centers, count as usize)?);
        Ok(Run { sums, centers, first_hits })
    }
}

/// What the kernel leaves.
struct Run {
    sums: Vec<[f32; 4]>,
    /// Of the last sample, where it is not centres that were asked for.
    centers: Vec<Center>,
    /// What the samples show first; nothing where nothing asks for it.
    first_hits: Vec<FirstHits>,
}

/// The camera at the plane through the scene's centre, or at the eye where that is in front of the plane; and how far that is from the
/// eye. `None` where the plane's point is so far from the scene that no pixel can show it.
pub(super) fn place_camera(
    camera: &Camera,
    resolution: [u32; 2],
    window: Window,
    header: &Header,
) -> Option<(f64, GpuCamera)> {
    let step = header.grid_step;
    let eye = camera.position - DVec3::from_array(header.world_anchor);
    let distance = (-eye.dot(camera.forward)).max(0.0);
    let center = eye + camera.forward * distance;
    let grid = (center / step).round();
    // Half of what an i32 holds: the kernel adds what pixels are apart. The scene is 2¹⁶ steps wide.
    let fits = grid.abs().max_element() < f64::from(1 << 30);
    if !fits || resolution.contains(&0) {
        return None;
    }
    let forward = camera.forward.as_vec3();
    let aspect = f64::from(resolution[0]) / f64::from(resolution[1]);
    let placed = GpuCamera {
        grid: grid.as_ivec3().to_array(),
        eye_distance: distance as f32,
        fraction: (center - grid * step).as_vec3().to_array(),
        orthographic: camera.orthographic.into(),
        forward: forward.to_array(),
        corner: pixel_key(window.left as u32, window.top as u32),
        forward_low: (camera.forward - forward.as_dvec3()).as_vec3().to_array(),
        window_width: window.width as u32,
        right: (camera.right * (aspect * camera.half_height)).as_vec3().to_array(),
        width: resolution[0],
        up: (camera.up * camera.half_height).as_vec3().to_array(),
        height: resolution[1],
    };
    Some((distance, placed))
}

fn gpu_lights(lights: &shade::Lights, options: &RenderOptions) -> GpuLights {
    GpuLights {
        key: lights.key.to_array(),
        reserved_0: 0,
        fill: lights.fill.to_array(),
        reserved_1: 0,
        up: lights.up.to_array(),
        ambient_occlusion: options.ambient_occlusion.into(),
    }
}

impl GpuSection {
    /// Whether anything is cut.
    pub(super) fn has_planes(&self) -> bool {
        self.count > 0
    }
}

pub(super) fn gpu_section(section: &WorldSection) -> GpuSection {
    let plane = |index: usize| {
        let plane = &section.planes[index];
        GpuSectionPlane {
            normal: plane.normal.to_array(),
            offset: plane.offset,
            hatch_x: plane.hatch_x.to_array(),
            reserved_0: 0,
            hatch_y: plane.hatch_y.to_array(),
            reserved_1: 0,
        }
    };
    GpuSection {
        planes: std::array::from_fn(plane),
        count: section.count,
        caps: section.caps.into(),
        sense: section.sense,
        reserved: 0,
    }
}
