//! The look of a hit: a hemisphere of soft light, a key and a fill light that move with the camera, ambient occlusion.

use super::camera::{hash, pixel_key, unit};
use super::hit::hit_normal;
use super::light::{
    AMBIENT_DOWN, AMBIENT_UP, AMBIENT_WEIGHT, FILL_COLOR, FILL_FROM, GLOSS, KEY_COLOR, KEY_FROM,
    OCCLUSION_RADIUS, RIM_COLOR, SPECULAR_REFLECTANCE, SURFACE_OFFSET,
};
use super::ray_space::{Distance, PreparedRay, WorldRay, prepare, scene_radius, whole_steps};
use super::section::{
    Cut, NO_PLANE, Seen, WorldSection, first_hit_of, first_seen, hatch, is_kept, kept, section_plane,
};
use super::trace::{RawHit, first_hit_before};
use super::vector::{Vector3, vec3};
use crate::render::{Camera, Ray, RenderOptions};
use crate::scene::{Material, NO_MATERIAL, Scene};

/// See-through faces that are blended along a ray; the last of so many counts as opaque.
const MAX_LAYERS: usize = 8;

/// Directions of light in model space, fixed to the camera.
#[derive(Debug, Clone, Copy)]
pub struct Lights {
    /// Towards the key light.
    pub key: Vector3<f32>,
    /// Towards the fill light.
    pub fill: Vector3<f32>,
    /// Where the sky is brightest.
    pub up: Vector3<f32>,
}

/// All that shading needs.
#[derive(Debug, Clone, Copy)]
pub struct Shading<'a, 's> {
    /// What is looked at.
    pub scene: &'a Scene<'s>,
    /// The lights.
    pub lights: Lights,
    /// How to render.
    pub options: &'a RenderOptions,
    /// What the scene is cut down to; `None` where nothing is cut.
    section: Option<WorldSection>,
}

impl<'a, 's> Shading<'a, 's> {
    /// Of a scene as a camera sees it.
    pub fn new(scene: &'a Scene<'s>, camera: &Camera, options: &'a RenderOptions) -> Self {
        let section =
            (!options.section.is_empty()).then(|| WorldSection::new(&options.section, scene.header));
        Self { scene, lights: Lights::from_camera(camera), options, section }
    }

    /// The way of a ray through the section.
    pub fn cut(&self, prepared: &PreparedRay<f32>) -> Option<Cut> {
        let step = self.scene.header.grid_step as f32;
        self.section.as_ref().map(|section| Cut::new(section, &prepared.ray, prepared.near, step))
    }
}

impl Lights {
    /// The lights of a camera.
    pub fn from_camera(camera: &Camera) -> Self {
        let place = |from: [f64; 3]| {
            let d = (camera.right * from[0] + camera.up * from[1] - camera.forward * from[2]).normalize();
            Vector3::from_f64(d.to_array())
        };
        Self { key: place(KEY_FROM), fill: place(FILL_FROM), up: place([0.0, 1.0, 0.25]) }
    }
}

/// The colour along a model-space ray: linear light, premultiplied, with coverage.
pub fn shade_ray(shading: &Shading<'_, '_>, ray: &Ray, pixel: u32, sample: u32) -> [f32; 4] {
    let scene = shading.scene;
    let Some(prepared) = prepare::<f32>(ray, scene.header) else {
        return [0.0; 4];
    };
    shade_layers(shading, &prepared, pixel, sample)
}

/// Front to back through see-through faces.
fn shade_layers(shading: &Shading<'_, '_>, prepared: &PreparedRay<f32>, pixel: u32, sample: u32) -> [f32; 4] {
    let scene = shading.scene;
    let mut near = prepared.near;
    let mut color = [0.0_f32; 4];
    let mut cut = shading.cut(prepared);
    for layer in 1..=MAX_LAYERS {
        let seen = first_seen(scene, shading.options.exactness, &prepared.ray, near, &mut cut);
        let Some(seen) = seen else { break };
        let hit = seen.hit;
        let material = hit_material(scene, &hit);
        let lit = shade_hit(shading, &prepared.ray, &seen, &material, pixel, sample);
        // What lies behind the last layer is not looked for: the layer stands for it.
        let opacity = if layer == MAX_LAYERS { 1.0 } else { material.opacity };
        let left = (1.0 - color[3]) * opacity;
        for k in 0..3 {
            color[k] += lit[k] * left;
        }
        color[3] += left;
        if color[3] > 0.995 {
            let full = 1.0 / color[3];
            return [color[0] * full, color[1] * full, color[2] * full, 1.0];
        }
        let skip = surface_offset(scene);
        near = Distance { anchor: hit.distance.anchor, offset: hit.distance.offset + skip };
    }
    color
}

/// The look of a hit: the occurrence's, else the face's.
pub fn hit_material(scene: &Scene<'_>, hit: &RawHit<f32>) -> Material {
    let of_instance = scene.instances[hit.instance as usize].material;
    let index =
        if of_instance == NO_MATERIAL { scene.faces[hit.face as usize].material } else { of_instance };
    scene.materials[index as usize]
}

/// How far from a surface secondary rays start.
pub(super) fn surface_offset(scene: &Scene<'_>) -> f32 {
    (scene_radius(scene.header) * SURFACE_OFFSET) as f32
}

/// The outward normal of what is seen.
pub fn seen_normal(shading: &Shading<'_, '_>, seen: &Seen) -> Vector3<f32> {
    match &shading.section {
        Some(section) if seen.cap != NO_PLANE => section_plane(section, seen.cap).normal,
        _ => hit_normal(shading.scene, &seen.hit),
    }
}

/// The light that an opaque hit sends back along the ray.
fn shade_hit(
    shading: &Shading<'_, '_>,
    ray: &WorldRay<f32>,
    seen: &Seen,
    material: &Material,
    pixel: u32,
    sample: u32,
) -> [f32; 3] {
    let hit = &seen.hit;
    let outward = seen_normal(shading, seen);
    let n = if outward.dot(ray.direction) > 0.0 { -outward } else { outward };
    let open =
        if shading.options.ambient_occlusion { openness(shading, ray, hit, n, pixel, sample) } else { 1.0 };
    let lit = shade_surface(&shading.lights, n, -ray.direction, material, open);
    match &shading.section {
        Some(section) if seen.cap != NO_PLANE => {
            let step = shading.scene.header.grid_step as f32;
            let origin = super::frames::grid_position(ray.grid, step) + ray.fraction;
            let point = origin + ray.direction * hit.distance.beyond(0.0);
            let share = hatch(section_plane(section, seen.cap), point, hit.instance);
            lit.map(|light| light * share)
        }
        _ => lit,
    }
}

/// The light of the environment on a surface with normal `n`, seen from `view`; `open` is the share of the sky that it sees.
pub fn shade_surface(
    lights: &Lights,
    n: Vector3<f32>,
    view: Vector3<f32>,
    material: &Material,
    open: f32,
) -> [f32; 3] {
    // The key and the fill are large soft boxes: what is enclosed sees less of them too, though not as much less.
    let soft = 0.35 + 0.65 * open;
    let key = n.dot(lights.key).max(0.0) * soft;
    let fill = n.dot(lights.fill).max(0.0) * soft;
    let sky = 0.5 + 0.5 * n.dot(lights.up);
    let facing = n.dot(view).clamp(0.0, 1.0);
    let grazing = (1.0 - facing) * (1.0 - facing);
    let rim = grazing * grazing * (1.0 - facing) * open;
    let gleam = specular(n, view, lights.key) * soft + 0.25 * specular(n, view, lights.fill) * soft;
    let mut out = [0.0; 3];
    for k in 0..3 {
        let ambient = (AMBIENT_DOWN[k] + (AMBIENT_UP[k] - AMBIENT_DOWN[k]) * sky) * AMBIENT_WEIGHT * open;
        let diffuse = ambient + key * KEY_COLOR[k] + fill * FILL_COLOR[k];
        out[k] = material.rgb[k] * diffuse + gleam * KEY_COLOR[k] + rim * RIM_COLOR[k];
    }
    out
}

/// Blinn's highlight, normalised so that its energy does not depend on the gloss.
fn specular(n: Vector3<f32>, view: Vector3<f32>, light: Vector3<f32>) -> f32 {
    let half = view + light;
    let length = half.length();
    if length < 1e-6 || n.dot(light) <= 0.0 {
        return 0.0;
    }
    let along = (n.dot(half) / length).max(0.0);
    SPECULAR_REFLECTANCE * (GLOSS + 8.0) / 8.0 * along.powf(GLOSS) * n.dot(light)
}

/// The share of the sky seen from a hit, by one ray drawn from a cosine distribution; near blockers count more than far ones.
fn openness(
    shading: &Shading<'_, '_>,
    ray: &WorldRay<f32>,
    hit: &RawHit<f32>,
    n: Vector3<f32>,
    pixel: u32,
    sample: u32,
) -> f32 {
    let scene = shading.scene;
    let [a, b] = sky_sample(pixel, sample);
    let direction = cosine_direction(n, a, b);
    let probe = leave_surface(scene, ray, hit, n, direction, surface_offset(scene));
    let radius = (scene_radius(scene.header) * OCCLUSION_RADIUS) as f32;
    let near = Distance { anchor: 0.0, offset: 0.0 };
    let far = Distance { anchor: 0.0, offset: radius };
    let exactness = shading.options.exactness;
    let blocker = match &shading.section {
        None => first_hit_before(scene, exactness, &probe, near, far),
        Some(section) => {
            let kept = kept(section, &probe, scene.header.grid_step as f32);
            first_hit_of(scene, exactness, &probe, near, far, |hit| is_kept(scene, &kept, hit))
        }
    };
    let blocked = match blocker {
        Some(blocker) => 1.0 - (blocker.distance.beyond(0.0) / radius).clamp(0.0, 1.0),
        None => 0.0,
    };
    1.0 - blocked * blocked
}

/// A point of the unit square: the R2 sequence (Roberts 2018), which runs on from pixel to pixel of a tile of 4 × 4, in an order that sets neighbours far
/// apart, so that they err in opposite ways and the eye, which takes the mean, sees less grain. Tiles are moved by a random offset: without it
/// the sequence draws stripes. In whole numbers, so that CPU and GPU agree to the bit.
fn sky_sample(pixel: u32, sample: u32) -> [f32; 2] {
    let (x, y) = (pixel & 0xffff, pixel >> 16);
    let tile = pixel_key(x >> 2, y >> 2);
    let place = (x & 1) << 3 | (y & 1) << 2 | (x & 2) | (y & 2) >> 1;
    let index = (place << 6).wrapping_add(sample);
    let a = hash(tile, 0, 2).wrapping_add(index.wrapping_mul(0xc13f_a9a9));
    let b = hash(tile, 0, 3).wrapping_add(index.wrapping_mul(0x91e1_0da5));
    [unit(a), unit(b)]
}

/// A ray from a hit, `offset` above the surface.
fn leave_surface(
    scene: &Scene<'_>,
    ray: &WorldRay<f32>,
    hit: &RawHit<f32>,
    n: Vector3<f32>,
    direction: Vector3<f32>,
    offset: f32,
) -> WorldRay<f32> {
    let step = scene.header.grid_step as f32;
    let base = super::frames::grid_position(ray.grid, step);
    // The anchor is exact, the offset small: two fused steps.
    let at_anchor = ray.direction.fused(hit.distance.anchor, base);
    let rest = ray.fraction + ray.direction_low * hit.distance.anchor + ray.direction * hit.distance.offset;
    let position = at_anchor + (rest + n * offset);
    let whole =
        vec3(whole_steps(position.x, step), whole_steps(position.y, step), whole_steps(position.z, step));
    let steps = whole * (1.0 / step);
    WorldRay {
        grid: [steps.x as i32, steps.y as i32, steps.z as i32],
        fraction: position - whole,
        direction,
        direction_low: Vector3::default(),
    }
}

/// A direction about `n` with density cos θ / π: a uniform point of the unit sphere added to the normal.
fn cosine_direction(n: Vector3<f32>, a: f32, b: f32) -> Vector3<f32> {
    let z = 1.0 - 2.0 * a;
    let across = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (b * std::f32::consts::TAU).sin_cos();
    let sum = n + vec3(across * cos, across * sin, z);
    let length = sum.length();
    if length > 1e-3 { sum * (1.0 / length) } else { n }
}
