//! Light paths from the eye to the surroundings, one ray at a time.
//!
//! A path is a state machine: [`turn`] traces one ray of it, the path's own or one that asks whether the light of a direction arrives (next event
//! estimation). Both tracers keep the state in one record, so that a kernel can stop after any ray. At each surface the surroundings are sampled once by their
//! brightness and the path goes on as the surface scatters; whatever light both ways could have found is weighed by how densely each finds
//! it (multiple importance sampling, the balance heuristic of Veach 1997). Faces that let light through let a ray pass by chance.
//!
//! Light that comes by way of several surfaces is held to [`BRIGHTEST`] times the mean of the surroundings: it would be seldom found and then so bright that
//! pixels stood out. That is the only light that is lost, and little of it but for caustics of small bright lights.
//!
//! The ground catches shadows: it is a plane that is as bright as what the surroundings show behind it, less the share of their light that the model keeps
//! from it. It ends at [`GROUND_REACH`] radii, where no shadow is left.

use super::bsdf::{luminance, sample_direction, scatter, surface};
use super::camera::{pixel_key, pixel_ray};
use super::environment::{Surroundings, light_density, light_from, sample_light};
use super::frames::grid_position;
use super::ray_space::{Distance, GridStep, WorldRay, place, scene_radius};
use super::section::{NO_PLANE, first_seen, hatch, section_plane, to_pair};
use super::shade::{Shading, hit_material, leave_surface, surface_offset, visible_normal};
use super::sobol::sample_pair;
use super::trace::{Certainty, RawHit};
use super::vector::Vector3;
use crate::render::{Camera, PathOptions};
use crate::scene::Header;
use bytemuck::{Pod, Zeroable};

/// How far the ground reaches from the middle of the scene, of the scene's radius.
pub const GROUND_REACH: f64 = 16.0;

/// How bright the light of one path may be that comes by way of several surfaces, of the mean luminance of the surroundings.
pub const BRIGHTEST: f64 = 10.0;

/// See-through faces that a ray passes; the last of so many counts as opaque.
pub const MAX_PASSED: u32 = 16;

/// Surfaces after which a path may end by chance.
pub const SURE_BOUNCES: u32 = 3;

/// What [`PathState::kind`] is: a new sample, the path's own ray, a ray that asks for light; all samples are taken.
pub const START: u32 = 0;
/// See [`START`].
pub const PATH: u32 = 1;
/// See [`START`].
pub const SHADOW: u32 = 2;
/// A ray that asks whether something keeps light from the ground: it counts where it does not arrive.
pub const CATCHER: u32 = 3;
/// See [`START`].
pub const DONE: u32 = 4;

/// The samples of one pixel on their way. 144 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct PathState {
    /// The ray, as in [`WorldRay`].
    pub grid: [i32; 3],
    /// Which ray it is.
    pub kind: u32,
    /// See `grid`.
    pub fraction: [f32; 3],
    /// From where on hits count.
    pub near_anchor: f32,
    /// See `grid`.
    pub direction: [f32; 3],
    /// See `near_anchor`.
    pub near_offset: f32,
    /// See `grid`.
    pub direction_low: [f32; 3],
    /// Faces that the ray has passed.
    pub passed: u32,
    /// What is left of light that goes back along the path.
    pub throughput: [f32; 3],
    /// How densely the surface before scatters into the ray, per steradian; 0 where the surroundings are not sampled as well.
    pub density: f32,
    /// Light of the sample so far.
    pub light: [f32; 3],
    /// Coverage of the sample so far.
    pub alpha: f32,
    /// What a ray that asks for light adds to the light.
    pub asked: [f32; 3],
    /// The same of the coverage.
    pub asked_alpha: f32,
    /// Where the path goes on after that; 0 where it ends.
    pub next: [f32; 3],
    /// Surfaces so far.
    pub bounces: u32,
    /// Index of the pixel in the part of the picture that is rendered.
    pub pixel: u32,
    /// The sample.
    pub sample_index: u32,
    /// The first sample that is no longer wanted.
    pub end: u32,
    /// 0.
    pub reserved: u32,
}

/// The samples of a pixel, summed. 32 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct PathSum {
    /// Linear light, premultiplied, and coverage.
    pub color: [f32; 4],
    /// Luminance before the background.
    pub brightness: f32,
    /// Its square.
    pub square: f32,
    /// 1 where a kernel ran out of loop turns at the pixel's next ray.
    pub is_cut: u32,
    /// 1 where all samples are taken; the CPU does not ask.
    pub is_done: u32,
}

const _: () = assert!(size_of::<PathState>() == 144 && size_of::<PathSum>() == 32);

/// The ground in world space.
#[derive(Debug, Clone, Copy)]
pub struct WorldGround {
    /// Unit normal.
    pub up: Vector3<f32>,
    /// `up · p` on it.
    pub height: f32,
    /// The luminance that it receives where nothing is in the way.
    pub irradiance: f32,
}

/// All that paths are traced through.
#[derive(Debug, Clone, Copy)]
pub struct Paths<'a, 's> {
    /// The scene and how it is cut.
    pub shading: &'a Shading<'a, 's>,
    /// Light.
    pub surroundings: Surroundings<'a>,
    /// Below the model; none where light comes from below too.
    pub ground: Option<WorldGround>,
    /// From where the picture is taken.
    pub camera: &'a Camera,
    /// How paths are traced.
    pub options: &'a PathOptions,
    /// The greatest luminance of a path's light that comes by way of several surfaces.
    pub brightest: f32,
    /// Luminance of the background, in the estimate of errors.
    pub behind: f32,
    /// Upper left pixel and width of the part that is rendered.
    pub window: [u32; 3],
}

/// How far from the middle of a scene rays count.
pub fn path_reach(header: &Header, has_ground: bool) -> f64 {
    scene_radius(header) * if has_ground { GROUND_REACH } else { 1.0 }
}

/// Traces one ray of a pixel's samples and goes on to the next; at the end of a sample it is added to `sum`.
pub fn turn(paths: &Paths<'_, '_>, state: &mut PathState, sum: &mut PathSum) {
    if state.kind == START && !start(paths, state) {
        finish(paths, state, sum);
        return;
    }
    let scene = paths.shading.scene;
    let ray = WorldRay {
        grid: state.grid,
        fraction: Vector3::from_f32(state.fraction),
        direction: Vector3::from_f32(state.direction),
        direction_low: Vector3::from_f32(state.direction_low),
    };
    let near = Distance { anchor: state.near_anchor, offset: state.near_offset };
    let mut cut = paths.shading.cut(&ray, near);
    let exactness = paths.shading.options.exactness;
    let seen = first_seen(scene, exactness, &ray, near, Distance::INFINITE, &mut cut);
    let ground = ground_distance(paths, &ray, near);
    let is_ground = ground < seen.map_or(f32::MAX, |seen| seen.hit.distance.beyond(0.0));
    let pixel = path_key(paths, state.pixel);
    let mut ends = true;
    if let Some(seen) = seen.filter(|_| !is_ground) {
        let material = hit_material(scene, seen.hit.instance, seen.hit.face);
        if passes(paths, state, pixel, material.opacity) {
            state.passed += 1;
            state.near_anchor = seen.hit.distance.anchor;
            state.near_offset = seen.hit.distance.offset + surface_offset(scene);
            return;
        }
        if state.kind == PATH {
            if state.bounces == 0 {
                state.alpha = 1.0;
            }
            let n = visible_normal(paths.shading, &ray, &seen);
            let mut share = 1.0;
            if let (Some(section), true) = (&paths.shading.section, seen.cap != NO_PLANE) {
                let origin = grid_position(ray.grid, scene.header.grid_step as f32) + ray.fraction;
                let point = origin + ray.direction * seen.hit.distance.beyond(0.0);
                share = hatch(section_plane(section, seen.cap), point, seen.hit.instance);
            }
            if state.bounces < paths.options.max_depth {
                let surface = surface(&material, share, n, -ray.direction);
                leave(paths, state, &ray, &seen.hit, n);
                ends = !bounce(paths, state, &surface, n, pixel);
            }
        } else {
            ends = !answer(state, state.kind == CATCHER);
        }
    } else if state.kind != PATH {
        ends = !answer(state, state.kind == SHADOW && !is_ground);
    } else if is_ground {
        ends = !catch_shadow(paths, state, &ray, ground, pixel);
    } else {
        meet_surroundings(paths, state, ray.direction);
    }
    if ends {
        finish(paths, state, sum);
    }
}

/// The pixel as samples know it.
fn path_key(paths: &Paths<'_, '_>, pixel: u32) -> u32 {
    let [left, top, width] = paths.window;
    pixel_key(left + pixel % width, top + pixel / width)
}

/// Sends a sample on its way; false where it cannot meet the scene.
fn start(paths: &Paths<'_, '_>, state: &mut PathState) -> bool {
    let pixel = path_key(paths, state.pixel);
    let [right, down] = sample_pair(pixel, state.sample_index, 0, paths.options.seed);
    let (x, y) = (f64::from(pixel & 0xffff) + f64::from(right), f64::from(pixel >> 16) + f64::from(down));
    let ray = pixel_ray(paths.camera, paths.shading.options.resolution, x, y);
    let header = paths.shading.scene.header;
    *state = PathState {
        kind: PATH,
        throughput: [1.0; 3],
        pixel: state.pixel,
        sample_index: state.sample_index,
        end: state.end,
        ..PathState::zeroed()
    };
    let Some(placed) = place::<f32>(&ray, header, path_reach(header, paths.ground.is_some())) else {
        meet_surroundings(paths, state, Vector3::from_f64(ray.direction.to_array()));
        return false;
    };
    state.grid = placed.ray.grid;
    state.fraction = placed.ray.fraction.to_array();
    state.direction = placed.ray.direction.to_array();
    state.direction_low = placed.ray.direction_low.to_array();
    (state.near_anchor, state.near_offset) = (placed.near.anchor, placed.near.offset);
    true
}

/// Adds a sample to the sum, and makes ready for the next.
fn finish(paths: &Paths<'_, '_>, state: &mut PathState, sum: &mut PathSum) {
    let [red, green, blue] = state.light;
    let brightness = luminance(state.light) + (1.0 - state.alpha) * paths.behind;
    // One sample in millions may divide by next to nothing.
    if brightness.is_finite() {
        for (sum, own) in sum.color.iter_mut().zip([red, green, blue, state.alpha]) {
            *sum += own;
        }
        sum.brightness += brightness;
        sum.square += brightness * brightness;
    }
    state.sample_index += 1;
    state.kind = if state.sample_index == state.end { DONE } else { START };
}

/// Whether the ray passes a face by chance.
fn passes(paths: &Paths<'_, '_>, state: &PathState, pixel: u32, opacity: f32) -> bool {
    if opacity >= 1.0 || state.passed >= MAX_PASSED {
        return false;
    }
    let pair = 1024 + 64 * (4 * state.bounces + state.kind) + state.passed;
    sample_pair(pixel, state.sample_index, pair, paths.options.seed)[0] >= opacity
}

/// How far along the ray the ground is; out of reach where it is not met.
fn ground_distance(paths: &Paths<'_, '_>, ray: &WorldRay<f32>, near: Distance<f32>) -> f32 {
    let Some(ground) = &paths.ground else { return f32::MAX };
    let header = paths.shading.scene.header;
    let rate = ground.up.dot(ray.direction);
    if rate > -1e-6 {
        return f32::MAX;
    }
    let origin = grid_position(ray.grid, header.grid_step as f32) + ray.fraction;
    let distance = (ground.height - ground.up.dot(origin)) / rate;
    let reach = path_reach(header, true) as f32;
    let is_near = (origin + ray.direction * distance).length() < reach;
    if is_near && distance > near.beyond(0.0) { distance } else { f32::MAX }
}

/// Moves the ray's origin to where it has met something, a little above.
fn leave(
    paths: &Paths<'_, '_>,
    state: &mut PathState,
    ray: &WorldRay<f32>,
    hit: &RawHit<f32>,
    n: Vector3<f32>,
) {
    let scene = paths.shading.scene;
    let left = leave_surface(scene, ray, hit, n, n, surface_offset(scene));
    state.grid = left.grid;
    state.fraction = left.fraction.to_array();
    state.direction_low = [0.0; 3];
}

/// Sends a ray from the origin.
fn send(state: &mut PathState, kind: u32, direction: [f32; 3]) {
    state.kind = kind;
    state.direction = direction;
    state.near_anchor = 0.0;
    state.near_offset = 0.0;
    state.passed = 0;
}

/// Takes the answer of a ray that asked for light; false where the path ends.
fn answer(state: &mut PathState, counts: bool) -> bool {
    if counts {
        for (light, asked) in state.light.iter_mut().zip(state.asked) {
            *light += asked;
        }
        state.alpha += state.asked_alpha;
    }
    if state.next == [0.0; 3] {
        return false;
    }
    send(state, PATH, state.next);
    true
}

/// What the path's ray finds where it meets nothing.
fn meet_surroundings(paths: &Paths<'_, '_>, state: &mut PathState, direction: Vector3<f32>) {
    let mut weight = 1.0;
    if state.bounces == 0 {
        if !paths.options.shows_surroundings {
            return;
        }
        state.alpha = 1.0;
    } else {
        weight = state.density / (state.density + light_density(&paths.surroundings, direction));
    }
    let light = light_from(&paths.surroundings, direction);
    let found = std::array::from_fn(|k| state.throughput[k] * light[k] * weight);
    let found = if state.bounces > 1 { held(paths, found) } else { found };
    for (light, found) in state.light.iter_mut().zip(found) {
        *light += found;
    }
}

/// Light, no brighter than that by way of several surfaces may be.
fn held(paths: &Paths<'_, '_>, light: [f32; 3]) -> [f32; 3] {
    let share = paths.brightest / luminance(light).max(paths.brightest);
    light.map(|channel| channel * share)
}

/// The points of the unit square that a path has at its next surface, by number: for light, for where to go on, for choices.
fn path_points(paths: &Paths<'_, '_>, state: &PathState, pixel: u32) -> impl Fn(u32) -> [f32; 2] + use<> {
    let (sample, first, seed) = (state.sample_index, 1 + 3 * state.bounces, paths.options.seed);
    move |number| sample_pair(pixel, sample, first + number, seed)
}

/// Asks for light at a surface and chooses where to go on; false where the path ends. The origin has been left.
fn bounce(
    paths: &Paths<'_, '_>,
    state: &mut PathState,
    surface: &super::bsdf::Surface,
    n: Vector3<f32>,
    pixel: u32,
) -> bool {
    let point = path_points(paths, state, pixel);
    let from = sample_light(&paths.surroundings, false, point(0));
    let [choice, fate] = point(2);
    let next = sample_direction(surface, point(1), choice);
    let mut asked = [0.0; 3];
    if n.dot(from.direction) > 0.0 && !meets_ground(paths, state, from.direction) {
        let scattered = scatter(surface, from.direction);
        let light = light_from(&paths.surroundings, from.direction);
        let weight = 1.0 / (from.density + scattered.density);
        asked = std::array::from_fn(|k| state.throughput[k] * scattered.value[k] * light[k] * weight);
        if state.bounces > 0 {
            asked = held(paths, asked);
        }
    }
    let scattered = scatter(surface, next);
    state.bounces += 1;
    state.density = scattered.density;
    state.next = next.to_array();
    if scattered.density > 0.0 {
        let passed_on = 1.0 / scattered.density;
        for (throughput, value) in state.throughput.iter_mut().zip(scattered.value) {
            *throughput *= value * passed_on;
        }
    } else {
        state.next = [0.0; 3];
    }
    if state.bounces > SURE_BOUNCES {
        let [red, green, blue] = state.throughput;
        let chance = red.max(green).max(blue).min(0.95);
        if fate >= chance {
            state.next = [0.0; 3];
        } else {
            state.throughput = state.throughput.map(|throughput| throughput / chance);
        }
    }
    state.asked = asked;
    state.asked_alpha = 0.0;
    if asked[0].max(asked[1]).max(asked[2]) > 0.0 {
        send(state, SHADOW, from.direction.to_array());
        return true;
    }
    answer(state, false)
}

/// Whether a ray from the origin meets the ground, which then stands for the light from there.
fn meets_ground(paths: &Paths<'_, '_>, state: &PathState, direction: Vector3<f32>) -> bool {
    let ray = WorldRay {
        grid: state.grid,
        fraction: Vector3::from_f32(state.fraction),
        direction,
        direction_low: Vector3::default(),
    };
    ground_distance(paths, &ray, Distance { anchor: 0.0, offset: 0.0 }) < f32::MAX
}

/// Asks whether something keeps light from the ground; false where the path ends.
fn catch_shadow(
    paths: &Paths<'_, '_>,
    state: &mut PathState,
    ray: &WorldRay<f32>,
    distance: f32,
    pixel: u32,
) -> bool {
    let Some(ground) = &paths.ground else { return false };
    let mut shown = [0.0; 3];
    let is_shown = state.bounces > 0 || paths.options.shows_surroundings;
    if is_shown {
        let light = light_from(&paths.surroundings, ray.direction);
        shown = std::array::from_fn(|k| state.throughput[k] * light[k]);
        for (light, shown) in state.light.iter_mut().zip(shown) {
            *light += shown;
        }
        if state.bounces == 0 {
            state.alpha = 1.0;
        }
    }
    let from = sample_light(&paths.surroundings, true, path_points(paths, state, pixel)(0));
    let cosine = ground.up.dot(from.direction);
    if cosine <= 0.0 {
        return false;
    }
    let received = luminance(light_from(&paths.surroundings, from.direction)) * cosine;
    let share = received / (from.density * ground.irradiance);
    let step = GridStep::of(paths.shading.scene.header);
    let hit = RawHit {
        distance: to_pair(distance, step),
        instance: 0,
        face: 0,
        net: 0,
        uv: [0.0; 2],
        certainty: Certainty::Certain,
        is_shallow: false,
    };
    leave(paths, state, ray, &hit, ground.up);
    state.asked = shown.map(|light| -light * share);
    state.asked_alpha = if is_shown { 0.0 } else { share };
    state.next = [0.0; 3];
    send(state, CATCHER, from.direction.to_array());
    true
}
