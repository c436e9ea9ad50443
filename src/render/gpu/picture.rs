//! Pictures: one sample of one tile a dispatch.
//!
//! A tile is a run of pixels, short enough that a dispatch never comes near a driver's time limit. Its samples are summed on the
//! device in the CPU tracer's order; then the tile is read back. Memory on the device does not depend on the picture's size.

use super::kernels::{MOST_ELEMENTS, NARROW, WIDE};
use super::{Entry, Gpu, GpuError, GpuScene};
use crate::image::{Film, Window};
use crate::render::cpu::camera::pixel_key;
use crate::render::cpu::hit::surface_parameters;
use crate::render::cpu::{self, shade};
use crate::render::first_hits::FirstHits;
use crate::render::{Camera, RenderOptions};
use crate::scene::{Header, Scene};
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

/// `RenderParameters` of `shaders/entry/render.wgsl`. 160 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct RenderParameters {
    camera: GpuCamera,
    lights: GpuLights,
    first_pixel: u32,
    pixel_count: u32,
    sample_index: u32,
    samples: u32,
}

/// What the centre or a sample of a pixel shows first. 48 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
struct Center {
    normal: [f32; 3],
    depth: f32,
    instance: u32,
    face: u32,
    incomplete: u32,
    net: u32,
    uv: [f32; 2],
    reserved: [u32; 2],
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
        let mut film = options.film();
        let placed = place_camera(camera, options.resolution, film.window(), scene.scene.header);
        let Some((eye_distance, placed)) = placed else {
            options.background.put_behind(&mut film);
            return Ok(film);
        };
        let samples = options.samples.max(1);
        let tiles = film.color.len().div_ceil(MOST_ELEMENTS);
        let units = tiles * dispatches(options).count();
        let mut done = 0;
        for first in (0..film.color.len()).step_by(MOST_ELEMENTS) {
            let parameters = RenderParameters {
                camera: placed,
                lights: gpu_lights(&shade::Lights::from_camera(camera), options),
                first_pixel: first as u32,
                pixel_count: MOST_ELEMENTS.min(film.color.len() - first) as u32,
                sample_index: 0,
                samples,
            };
            let mut tile = self.render_tile(scene, options, parameters, WIDE, &mut || {
                done += 1;
                progress(done, units);
            })?;
            if tile.is_cut_short() {
                tile = self.render_tile(scene, options, parameters, NARROW, &mut || {})?;
            }
            for (color, sum) in film.color[first..].iter_mut().zip(&tile.sums) {
                *color = sum.map(|component| component / samples as f32);
            }
            // What a software device gives up on, a few pixels at poles, the twin renders.
            let given_up = (first..).zip(&tile.centers).filter(|(_, center)| center.incomplete != 0);
            let given_up: Vec<usize> = given_up.map(|(pixel, _)| pixel).collect();
            if options.layers.has_centers() {
                for (pixel, center) in (first..).zip(&tile.centers).filter(|(_, center)| center.face != 0) {
                    put_center(&scene.scene, camera, options, eye_distance, center, pixel, &mut film);
                }
            }
            for (pixel, hits) in (first..).zip(&tile.first_hits) {
                if options.layers.albedo {
                    film.albedo[pixel] = hits.albedo(samples);
                }
                if options.layers.matte {
                    film.matte[pixel] = hits.shares(samples);
                }
            }
            cpu::render_pixels(&scene.scene, camera, options, &given_up, &mut film);
        }
        options.background.put_behind(&mut film);
        Ok(film)
    }

    /// All samples of a tile, its pixels' centres and first hits; `step` is called after each dispatch.
    fn render_tile(
        &self,
        scene: &GpuScene<'_>,
        options: &RenderOptions,
        mut parameters: RenderParameters,
        lanes: u32,
        step: &mut dyn FnMut(),
    ) -> Result<Tile, GpuError> {
        let count = parameters.pixel_count;
        let pixels = count as usize;
        let colors = self.create_output("colors", size_of::<[f32; 4]>() as u64 * u64::from(count));
        let new_centers = || self.create_output("centers", size_of::<Center>() as u64 * u64::from(count));
        let centers = new_centers();
        let pipeline = self.pipeline(Entry::Render, scene, options.exactness, lanes)?;
        let gathers = options.layers.has_first_hits();
        let mut first_hits = vec![FirstHits::default(); if gathers { pixels } else { 0 }];
        let mut cut_short = vec![0; first_hits.len()];
        for index in dispatches(options) {
            parameters.sample_index = index;
            let shows_first = index > parameters.samples;
            let own_centers = if shows_first { new_centers() } else { centers.clone() };
            let uniform = self.create_uniform("render parameters", &parameters);
            let bind_group = self.bind(Entry::Render, &[&uniform, &colors, &own_centers]);
            self.dispatch(&pipeline, scene, &bind_group, count, lanes)?;
            if shows_first {
                let found: Vec<Center> = self.read(&own_centers, pixels)?;
                for ((center, hits), cut) in found.iter().zip(&mut first_hits).zip(&mut cut_short) {
                    *cut |= center.incomplete;
                    if center.face != 0 {
                        hits.add(&scene.scene, center.instance - 1, center.face - 1);
                    }
                }
            }
            step();
        }
        let mut centers: Vec<Center> = self.read(&centers, pixels)?;
        for (center, cut) in centers.iter_mut().zip(cut_short) {
            center.incomplete |= cut;
        }
        Ok(Tile { sums: self.read(&colors, pixels)?, centers, first_hits })
    }
}

/// The `sample_index` of each dispatch of a tile: the samples, then what the pixels' centres show, and what each sample shows first, where that
/// is asked for.
fn dispatches(options: &RenderOptions) -> impl Iterator<Item = u32> + use<> {
    let samples = options.samples.max(1);
    let center = options.layers.has_centers().then_some(samples);
    let first_hits = if options.layers.has_first_hits() { samples + 1..2 * samples + 1 } else { 0..0 };
    (0..samples).chain(center).chain(first_hits)
}

/// Puts what the centre of a pixel shows into a film.
fn put_center(
    scene: &Scene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    eye_distance: f64,
    center: &Center,
    pixel: usize,
    film: &mut Film,
) {
    let layers = options.layers;
    let depth = eye_distance + f64::from(center.depth);
    if layers.depth {
        film.depth[pixel] = depth as f32;
    }
    if layers.normal {
        film.normal[pixel] = center.normal;
    }
    if layers.position {
        let (x, y) = (film.corner[0] + pixel % film.width, film.corner[1] + pixel / film.width);
        let ray = cpu::pixel_ray(camera, options.resolution, x as f64 + 0.5, y as f64 + 0.5);
        let position = ray.origin + ray.direction * (depth / ray.direction.dot(camera.forward));
        film.position[pixel] = position.as_vec3().to_array();
    }
    if layers.uv {
        let parameters = surface_parameters(scene, center.face - 1, center.net, center.uv);
        film.uv[pixel] = parameters.map(|parameter| parameter as f32);
    }
    if layers.ids {
        film.part[pixel] = center.instance;
        film.face[pixel] = center.face;
    }
}

/// A run of pixels as the kernels leave it.
struct Tile {
    sums: Vec<[f32; 4]>,
    centers: Vec<Center>,
    /// None where nothing asks for them.
    first_hits: Vec<FirstHits>,
}

impl Tile {
    fn is_cut_short(&self) -> bool {
        self.centers.iter().any(|center| center.incomplete != 0)
    }
}

/// The camera at the plane through the scene's centre, or at the eye where that is in front of the plane; and how far that is from the
/// eye. `None` where the plane's point is so far from the scene that no pixel can show it.
fn place_camera(
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
