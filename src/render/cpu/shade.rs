//! The look of a hit: a hemisphere of soft light, a key and a fill light that move with the camera, ambient occlusion.

use super::hit::hit_normal;
use super::light::{
    AMBIENT_DOWN, AMBIENT_UP, AMBIENT_WEIGHT, FILL_COLOR, FILL_FROM, GLOSS, KEY_COLOR, KEY_FROM,
    LEAST_ROUGHNESS, METAL_BOX, METAL_DOWN, METAL_LIGHT, METAL_UP, RIM_COLOR, SPECULAR_REFLECTANCE,
    SURFACE_OFFSET,
};
use super::ray_space::{Distance, GridStep, WorldRay, scene_radius, whole_steps};
use super::section::{Cut, NO_PLANE, Seen, WorldSection, hatch, section_plane};
use super::trace::RawHit;
use super::vector::{Vector3, vec3};
use crate::render::{Camera, RenderOptions};
use crate::scene::{Material, NO_MATERIAL, Scene};

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
    pub(super) section: Option<WorldSection>,
}

impl<'a, 's> Shading<'a, 's> {
    /// Of a scene as a camera sees it.
    pub fn new(scene: &'a Scene<'s>, camera: &Camera, options: &'a RenderOptions) -> Self {
        let height = options.resolution[1];
        let section = (!options.section.is_empty())
            .then(|| WorldSection::new(&options.section, scene.header, camera, height));
        Self { scene, lights: Lights::from_camera(camera), options, section }
    }

    /// The way of a ray through the section.
    pub(super) fn cut(&self, ray: &WorldRay<f32>, near: Distance<f32>) -> Option<Cut> {
        let step = self.scene.header.grid_step as f32;
        self.section.as_ref().map(|section| Cut::new(section, ray, near, step))
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

/// The normal of what is seen, towards the eye.
pub(super) fn visible_normal(shading: &Shading<'_, '_>, ray: &WorldRay<f32>, seen: &Seen) -> Vector3<f32> {
    let outward = match &shading.section {
        Some(section) if seen.cap != NO_PLANE => section_plane(section, seen.cap).normal,
        _ => hit_normal(shading.scene, &seen.hit),
    };
    if outward.dot(ray.direction) > 0.0 { -outward } else { outward }
}

/// The look of a face as an instance shows it: the occurrence's, else the face's.
pub fn hit_material(scene: &Scene<'_>, instance: u32, face: u32) -> Material {
    let of_instance = scene.instances[instance as usize].material;
    let own = if of_instance == NO_MATERIAL { scene.faces[face as usize].material } else { of_instance };
    scene.materials[(own + scene.instances[instance as usize].material_shift) as usize]
}

/// How far from a surface secondary rays start.
pub(super) fn surface_offset(scene: &Scene<'_>) -> f32 {
    (scene_radius(scene.header) * SURFACE_OFFSET) as f32
}

/// Linear light by how much of the sky a surface sees.
#[derive(Debug, Clone, Copy)]
pub(super) struct SkyLight {
    /// Without any sky.
    pub dark: [f32; 3],
    /// Under the whole sky.
    pub lit: [f32; 3],
}

impl SkyLight {
    /// Where a share of the sky is open: it runs straight from one to the other.
    pub fn at(&self, open: f32) -> [f32; 3] {
        std::array::from_fn(|k| self.dark[k] + (self.lit[k] - self.dark[k]) * open)
    }
}

/// The light that what is seen sends back along the ray.
pub(super) fn seen_light(
    shading: &Shading<'_, '_>,
    ray: &WorldRay<f32>,
    seen: &Seen,
    n: Vector3<f32>,
    material: &Material,
) -> SkyLight {
    let share = match &shading.section {
        Some(section) if seen.cap != NO_PLANE => {
            let step = shading.scene.header.grid_step as f32;
            let origin = super::frames::grid_position(ray.grid, step) + ray.fraction;
            let point = origin + ray.direction * seen.hit.distance.beyond(0.0);
            hatch(section_plane(section, seen.cap), point, seen.hit.instance)
        }
        _ => 1.0,
    };
    let view = -ray.direction;
    let highlights = highlights(&shading.lights, n, view, material);
    let light = |open| {
        shade_surface(&shading.lights, n, view, material, &highlights, open).map(|light| light * share)
    };
    SkyLight { dark: light(0.0), lit: light(1.0) }
}

/// What does not depend on the sky that a surface sees: for the key and the fill light how much the coat gleams, and how much metal mirrors, if it is metal. Once for
/// what it is without any sky and under all of it; powers cost a GPU less, and its text has none of this.
struct Highlights {
    gleam: [f32; 2],
    mirror: Option<[f32; 2]>,
}

fn highlights(lights: &Lights, n: Vector3<f32>, view: Vector3<f32>, material: &Material) -> Highlights {
    let gloss = gloss_of(material.roughness);
    // However smooth the surface, the lights are as wide as they are.
    let width = gloss / (1.0 + gloss / METAL_BOX);
    let both = [lights.key, lights.fill];
    Highlights {
        gleam: both.map(|light| specular(n, view, light, gloss)),
        mirror: (material.metallic > 0.0).then(|| both.map(|light| lobe(n, view, light, width))),
    }
}

/// The light of the environment on a surface with normal `n`, seen from `view`; `open` is the share of the sky that it sees, on which it depends linearly.
#[inline(always)]
fn shade_surface(
    lights: &Lights,
    n: Vector3<f32>,
    view: Vector3<f32>,
    material: &Material,
    highlights: &Highlights,
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
    let gleam = highlights.gleam[0] * soft + 0.25 * highlights.gleam[1] * soft;
    let mirrored = highlights.mirror.map_or([0.0; 3], |mirror| mirrored(lights, n, view, mirror, open));
    let mut out = [0.0; 3];
    for k in 0..3 {
        let ambient = (AMBIENT_DOWN[k] + (AMBIENT_UP[k] - AMBIENT_DOWN[k]) * sky) * AMBIENT_WEIGHT * open;
        let diffuse = ambient + key * KEY_COLOR[k] + fill * FILL_COLOR[k];
        let skin = material.rgb[k] * diffuse * (1.0 - material.metallic);
        out[k] = skin + gleam * KEY_COLOR[k] + rim * RIM_COLOR[k];
        out[k] += material.rgb[k] * mirrored[k] * material.metallic;
    }
    out
}

/// What a surface with normal `n` would mirror of the environment if it were of white metal.
fn mirrored(
    lights: &Lights,
    n: Vector3<f32>,
    view: Vector3<f32>,
    [key, fill]: [f32; 2],
    open: f32,
) -> [f32; 3] {
    let soft = 0.35 + 0.65 * open;
    let height = 0.5 + 0.5 * (n * (2.0 * n.dot(view)) - view).dot(lights.up);
    let sky = height * height * (3.0 - 2.0 * height);
    let (key, fill) = (METAL_LIGHT * key * soft, METAL_LIGHT * fill * soft);
    std::array::from_fn(|k| {
        let ambient = (METAL_DOWN[k] + (METAL_UP[k] - METAL_DOWN[k]) * sky) * open;
        ambient + key * KEY_COLOR[k] + fill * FILL_COLOR[k]
    })
}

/// Blinn's exponent for a roughness: his lobe is as wide as that of a microfacet distribution of width α = roughness² where the exponent is 2/α² − 2
/// (Walter et al. 2007). [`GLOSS`] is that of the default roughness, to the bit.
fn gloss_of(roughness: f32) -> f32 {
    let finer = Material::DEFAULT_ROUGHNESS / roughness.max(LEAST_ROUGHNESS);
    (GLOSS + 2.0) * (finer * finer) * (finer * finer) - 2.0
}

/// Blinn's highlight, normalised so that its energy does not depend on the gloss.
fn specular(n: Vector3<f32>, view: Vector3<f32>, light: Vector3<f32>, gloss: f32) -> f32 {
    if n.dot(light) <= 0.0 {
        return 0.0;
    }
    SPECULAR_REFLECTANCE * (gloss + 8.0) / 8.0 * lobe(n, view, light, gloss) * n.dot(light)
}

/// Blinn's lobe: 1 where the light is mirrored to the eye.
fn lobe(n: Vector3<f32>, view: Vector3<f32>, light: Vector3<f32>, gloss: f32) -> f32 {
    let half = view + light;
    let length = half.length();
    if length < 1e-6 {
        return 0.0;
    }
    (n.dot(half) / length).max(0.0).powf(gloss)
}

/// A ray from a hit, `offset` above the surface.
pub(super) fn leave_surface(
    scene: &Scene<'_>,
    ray: &WorldRay<f32>,
    hit: &RawHit<f32>,
    n: Vector3<f32>,
    direction: Vector3<f32>,
    offset: f32,
) -> WorldRay<f32> {
    let step = GridStep::of(scene.header);
    let base = super::frames::grid_position(ray.grid, step.size);
    // The anchor is exact, the offset small: two fused steps.
    let at_anchor = ray.direction.fused(hit.distance.anchor, base);
    let rest = ray.fraction + ray.direction_low * hit.distance.anchor + ray.direction * hit.distance.offset;
    let position = at_anchor + (rest + n * offset);
    let whole =
        vec3(whole_steps(position.x, step), whole_steps(position.y, step), whole_steps(position.z, step));
    let steps = whole * step.per_size;
    WorldRay {
        grid: [steps.x as i32, steps.y as i32, steps.z as i32],
        fraction: position - whole,
        direction,
        direction_low: Vector3::default(),
    }
}

/// A direction about `n` with density cos θ / π: a uniform point of the unit sphere added to the normal.
pub(super) fn cosine_direction(n: Vector3<f32>, a: f32, b: f32) -> Vector3<f32> {
    let z = 1.0 - 2.0 * a;
    let across = (1.0 - z * z).max(0.0).sqrt();
    let (sin, cos) = (b * std::f32::consts::TAU).sin_cos();
    let sum = n + vec3(across * cos, across * sin, z);
    let length = sum.length();
    if length > 1e-3 { sum * (1.0 / length) } else { n }
}
