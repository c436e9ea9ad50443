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
use rayon::prelude::*;
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
            shot.centers(pixels, |found| {
                centers.take(first, found.len(), eye_distance, |some| {
                    &found[some.start - first..some.end - first]
                });
            })?;
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
    /// Tells what the centres of a run of pixels show; depths are from the plane through the scene's centre.
    fn centers(&self, pixels: Range<u32>, take: impl FnOnce(&[Center])) -> Result<(), GpuError> {
        let parameters = RenderParameters {
            first_pixel: pixels.start,
            pixel_count: pixels.len() as u32,
            centers_only: 1,
            ..self.parameters()
        };
        let is_cut = |center: &Center| center.flags & INCOMPLETE != 0;
        let buffer = self.run_centers(parameters, Grouping::Wide)?;
        let count = pixels.len();
        if !self.gpu.is_software() {
            return self.gpu.read_with(&buffer, count, take);
        }
        let mut centers: Vec<Center> = self.gpu.read(&buffer, count)?;
        if centers.iter().any(is_cut) {
            centers = self.gpu.read(&self.run_centers(parameters, Grouping::Narrow)?, count)?;
        }
        // What a software device gives up on, a few pixels at poles, the twin renders.
        let given_up: Vec<u32> = pixels
            .clone()
            .zip(&centers)
            .filter(|(_, center)| is_cut(center))
            .map(|(pixel, _)| pixel)
            .collect();
        let eye_distance = self.eye_distance();
        let found = cpu::find_centers(&self.scene.scene, self.camera, self.options, &given_up);
        for (pixel, mut center) in given_up.into_iter().zip(found) {
            center.depth = (f64::from(center.depth) - eye_distance) as f32;
            centers[(pixel - pixels.start) as usize] = center;
        }
        take(&centers);
        Ok(())
    }

    fn run_centers(
        &self,
        parameters: RenderParameters,
        grouping: Grouping,
    ) -> Result<wgpu::Buffer, GpuError> {
        let outputs = Outputs::new(self.gpu, 1, parameters.pixel_count);
        let asked = self.gpu.create_input("refined pixels", bytemuck::bytes_of(&Refined::zeroed()));
        let pipeline = self.pipeline(&parameters, grouping)?;
        self.dispatch(&pipeline, &parameters, &asked, &outputs, grouping)?;
        Ok(outputs.centers)
    }

    /// All samples of some pixels.
    fn samples(&self, refined: &[Refined]) -> Result<Vec<Sampled>, GpuError> {
        let mut sampled = self.run_samples(refined, Grouping::Wide)?;
        if !self.gpu.is_software() {
            return Ok(sampled);
        }
        if sampled.iter().any(|one| one.flags & INCOMPLETE != 0) {
            sampled = self.run_samples(refined, Grouping::Narrow)?;
        }
        let given_up: Vec<usize> =
            (0..sampled.len()).filter(|&index| sampled[index].flags & INCOMPLETE != 0).collect();
        let asked: Vec<Refined> = given_up.iter().map(|&index| refined[index]).collect();
        let found = cpu::take_samples(&self.scene.scene, self.camera, self.options, &asked);
        for (index, one) in given_up.into_iter().zip(found) {
            sampled[index] = one;
        }
        Ok(sampled)
    }

    fn run_samples(&self, refined: &[Refined], grouping: Grouping) -> Result<Vec<Sampled>, GpuError> {
        let samples = self.options.samples.max(1);
        let count = refined.len();
        let mut parameters = RenderParameters { pixel_count: count as u32, samples, ..self.parameters() };
        let outputs = Outputs::new(self.gpu, parameters.pixel_count, 1);
        let asked = self.gpu.create_input("refined pixels", bytemuck::cast_slice(refined));
        let pipeline = self.pipeline(&parameters, grouping)?;
        let has_first_hits = self.options.layers.has_first_hits();
        let mut first_hits = vec![FirstHits::default(); if has_first_hits { count } else { 0 }];
        for sample in 0..samples {
            parameters.sample_index = sample;
            self.dispatch(&pipeline, &parameters, &asked, &outputs, grouping)?;
            if sample % SAMPLES_IN_FLIGHT == SAMPLES_IN_FLIGHT - 1 {
                self.gpu.wait()?;
            }
            if has_first_hits {
                self.gpu.read_with(&outputs.shown, count, |shown: &[Shown]| {
                    for (hits, shown) in first_hits.iter_mut().zip(shown).filter(|(_, s)| s.instance != 0) {
                        hits.add(&self.scene.scene, shown.instance - 1, shown.face - 1);
                    }
                })?;
            }
        }
        let sums: Vec<[f32; 4]> = self.gpu.read(&outputs.colors, count)?;
        self.gpu.read_with(&outputs.shown, count, |shown: &[Shown]| {
            let of_pixel = |(index, (sum, shown)): (usize, (&[f32; 4], &Shown))| {
                let hits = first_hits.get(index);
                Sampled {
                    color: sum.map(|component| component / samples as f32),
                    flags: shown.flags,
                    albedo: hits.map_or_else(Default::default, |hits| hits.albedo(samples)),
                    matte: hits.map_or_else(Default::default, |hits| hits.shares(samples)),
                }
            };
            sums.par_iter().zip(shown).enumerate().map(of_pixel).collect()
        })
    }

    fn pipeline(
        &self,
        parameters: &RenderParameters,
        grouping: Grouping,
    ) -> Result<wgpu::ComputePipeline, GpuError> {
        let has_section = parameters.section.has_planes();
        self.gpu.pipeline(Entry::Render, self.scene, self.options.exactness, has_section, grouping)
    }

    fn dispatch(
        &self,
        pipeline: &wgpu::ComputePipeline,
        parameters: &RenderParameters,
        asked: &wgpu::Buffer,
        outputs: &Outputs,
        grouping: Grouping,
    ) -> Result<(), GpuError> {
        let uniform = self.gpu.create_uniform("render parameters", parameters);
        let Outputs { colors, shown, centers } = outputs;
        let bind_group = self.gpu.bind(Entry::Render, &[&uniform, asked, colors, shown, centers]);
        self.gpu.dispatch(pipeline, self.scene, &bind_group, parameters.pixel_count, grouping)
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
}

/// What the kernel leaves, on the device.
struct Outputs {
    /// Of samples: sums.
    colors: wgpu::Buffer,
    /// Of samples: [`Shown`].
    shown: wgpu::Buffer,
    /// [`Center`].
    centers: wgpu::Buffer,
}

impl Outputs {
    /// Room for the samples of some pixels and for the centres of others; one at least of each is to be asked for, as a kernel binds both.
    fn new(gpu: &Gpu, sampled: u32, centers: u32) -> Self {
        let room = |label, size, count| gpu.create_output(label, size as u64 * u64::from(count));
        Self {
            colors: room("colors", size_of::<[f32; 4]>(), sampled),
            shown: room("shown", size_of::<Shown>(), sampled),
            centers: room("centers", size_of::<Center>(), centers),
        }
    }
}

/// What samples show first: `Shown` of `shaders/entry/render.wgsl`. 16 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Shown {
    /// 1 + index, of the last sample; 0 where nothing is hit.
    instance: u32,
    face: u32,
    /// Of all samples.
    flags: u32,
    reserved: u32,
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
