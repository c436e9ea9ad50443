//! Pictures: one sample of one tile a dispatch.
//!
//! A tile is a run of pixels, short enough that a dispatch never comes near a driver's time limit. Its samples are summed on the
//! device in the CPU tracer's order; then the tile is read back. Memory on the device does not depend on the picture's size.

use super::kernels::{MOST_ELEMENTS, NARROW, WIDE};
use super::{Entry, Gpu, GpuError, GpuScene};
use crate::image::Film;
use crate::render::cpu::section::WorldSection;
use crate::render::cpu::{self, shade};
use crate::render::section::MAX_PLANES;
use crate::render::{Camera, Exactness, RenderOptions};
use crate::scene::Header;
use bytemuck::{Pod, Zeroable};
use glam::DVec3;

/// `Camera` of `shaders/camera.wgsl`. 96 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
struct GpuCamera {
    grid: [i32; 3],
    eye_distance: f32,
    fraction: [f32; 3],
    orthographic: u32,
    forward: [f32; 3],
    reserved_0: u32,
    forward_low: [f32; 3],
    reserved_1: u32,
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
struct GpuSection {
    planes: [GpuSectionPlane; MAX_PLANES],
    count: u32,
    caps: u32,
    reserved: [u32; 2],
}

/// `RenderParameters` of `shaders/entry/render.wgsl`. 464 bytes.
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
}

/// What the centre of a pixel shows. 32 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Center {
    normal: [f32; 3],
    depth: f32,
    instance: u32,
    face: u32,
    incomplete: u32,
    reserved: u32,
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
        let [width, height] = options.resolution;
        let mut film = Film::new(width as usize, height as usize);
        let Some((eye_distance, placed)) = place_camera(camera, options.resolution, scene.scene.header)
        else {
            options.background.put_behind(&mut film);
            return Ok(film);
        };
        let samples = options.samples.max(1);
        let tiles = film.color.len().div_ceil(MOST_ELEMENTS);
        let units = tiles * (samples as usize + 1);
        let mut done = 0;
        for first in (0..film.color.len()).step_by(MOST_ELEMENTS) {
            let parameters = RenderParameters {
                camera: placed,
                lights: gpu_lights(&shade::Lights::from_camera(camera), options),
                section: gpu_section(&WorldSection::new(&options.section, scene.scene.header)),
                first_pixel: first as u32,
                pixel_count: MOST_ELEMENTS.min(film.color.len() - first) as u32,
                sample_index: 0,
                samples,
            };
            let mut tile = self.render_tile(scene, options.exactness, parameters, WIDE, &mut || {
                done += 1;
                progress(done, units);
            })?;
            if tile.is_cut_short() {
                tile = self.render_tile(scene, options.exactness, parameters, NARROW, &mut || {})?;
            }
            for (color, sum) in film.color[first..].iter_mut().zip(&tile.sums) {
                *color = sum.map(|component| component / samples as f32);
            }
            // What a software device gives up on, a few pixels at poles, the twin renders.
            let given_up = (first..).zip(&tile.centers).filter(|(_, center)| center.incomplete != 0);
            let given_up: Vec<usize> = given_up.map(|(pixel, _)| pixel).collect();
            for (pixel, center) in (first..).zip(&tile.centers) {
                if center.instance != 0 {
                    film.depth[pixel] = (eye_distance + f64::from(center.depth)) as f32;
                    film.normal[pixel] = center.normal;
                    film.part[pixel] = center.instance;
                    film.face[pixel] = center.face;
                }
            }
            cpu::render_pixels(&scene.scene, camera, options, &given_up, &mut film);
        }
        options.background.put_behind(&mut film);
        Ok(film)
    }

    /// All samples of a tile and its pixels' centres; `step` is called after each dispatch.
    fn render_tile(
        &self,
        scene: &GpuScene<'_>,
        exactness: Exactness,
        mut parameters: RenderParameters,
        lanes: u32,
        step: &mut dyn FnMut(),
    ) -> Result<Tile, GpuError> {
        let count = parameters.pixel_count;
        let colors = self.create_output("colors", size_of::<[f32; 4]>() as u64 * u64::from(count));
        let centers = self.create_output("centers", size_of::<Center>() as u64 * u64::from(count));
        let pipeline = self.pipeline(Entry::Render, scene, exactness, parameters.section.count > 0, lanes)?;
        // The last one tells what the pixels' centres show.
        for sample in 0..=parameters.samples {
            parameters.sample_index = sample;
            let uniform = self.create_uniform("render parameters", &parameters);
            let bind_group = self.bind(Entry::Render, &[&uniform, &colors, &centers]);
            self.dispatch(&pipeline, scene, &bind_group, count, lanes)?;
            step();
        }
        Ok(Tile { sums: self.read(&colors, count as usize)?, centers: self.read(&centers, count as usize)? })
    }
}

/// A run of pixels as the kernels leave it.
struct Tile {
    sums: Vec<[f32; 4]>,
    centers: Vec<Center>,
}

impl Tile {
    fn is_cut_short(&self) -> bool {
        self.centers.iter().any(|center| center.incomplete != 0)
    }
}

/// The camera at the plane through the scene's centre, or at the eye where that is in front of the plane; and how far that is from the
/// eye. `None` where the plane's point is so far from the scene that no pixel can show it.
fn place_camera(camera: &Camera, resolution: [u32; 2], header: &Header) -> Option<(f64, GpuCamera)> {
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
        reserved_0: 0,
        forward_low: (camera.forward - forward.as_dvec3()).as_vec3().to_array(),
        reserved_1: 0,
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

fn gpu_section(section: &WorldSection) -> GpuSection {
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
        reserved: [0; 2],
    }
}
