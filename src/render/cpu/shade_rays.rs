//! What the rays through pixels show, eight at a time.

use super::camera::pixel_key;
use super::light::OCCLUSION_RADIUS;
use super::packet::{LANES, Segment};
use super::pixels::{
    BESIDE_ALL, BESIDE_LEFT, CAP, Center, Neighbour, Refined, SEE_THROUGH, contrast, perceived,
};
use super::ray_space::{Distance, WorldRay, prepare, scene_radius};
use super::section::{Cut, NO_PLANE, Seen, first_seen_of_each};
use super::shade::{
    Shading, cosine_direction, hit_material, leave_surface, seen_light, surface_offset, visible_normal,
};
use super::sobol::{hash, unit};
use super::trace::RawHit;
use super::vector::Vector3;
use crate::render::{Camera, Ray};
use crate::scene::Scene;
use bytemuck::Zeroable;
use std::array::from_fn;

/// See-through faces that are blended along a ray; the last of so many counts as opaque.
const MAX_LAYERS: usize = 8;

/// Cosine of the angle between normals under one sky.
pub const SAME_WAY: f32 = 0.9;

/// How close to a neighbour samples tell of it, in pixels.
pub const CLOSE: f32 = 0.25;

/// The contrast from which a sample shows something else.
pub const OTHER: f32 = 8.0 / 255.0;

/// What is seen where nothing is.
pub fn empty_center() -> Center {
    Center { open: 1.0, ..Center::zeroed() }
}

/// A ray on its way through what is seen, and through the section.
type Way = (Segment, Option<Cut>);

fn way(shading: &Shading<'_, '_>, segment: Segment) -> Way {
    (segment, shading.cut(&segment.ray, segment.near))
}

/// The first thing that each ray sees.
fn see(shading: &Shading<'_, '_>, ways: &mut [Option<Way>; LANES]) -> [Option<Seen>; LANES] {
    first_seen_of_each(shading.scene, shading.options.exactness, ways)
}

/// The normals of what is seen, towards the eye.
fn normals(
    shading: &Shading<'_, '_>,
    ways: &[Option<Way>; LANES],
    seen: &[Option<Seen>; LANES],
) -> [Option<Vector3<f32>>; LANES] {
    from_fn(|lane| Some(visible_normal(shading, &ways[lane]?.0.ray, &seen[lane]?)))
}

/// What the rays through the centres of up to eight pixels show, and what they see of the sky by one ray each. A pixel is given by its ray and its key.
pub fn shade_centers(shading: &Shading<'_, '_>, camera: &Camera, pixels: &[(Ray, u32)]) -> [Center; LANES] {
    let scene = shading.scene;
    let prepared: [_; LANES] =
        from_fn(|lane| pixels.get(lane).and_then(|(ray, _)| prepare::<f32>(ray, scene.header)));
    let mut ways = from_fn(|lane| prepared[lane].as_ref().map(|ray| way(shading, Segment::of(ray))));
    let seen = see(shading, &mut ways);
    let normals = normals(shading, &ways, &seen);
    let open = if shading.options.ambient_occlusion {
        let asked = from_fn(|lane| {
            let (way, seen, (_, pixel)) = (ways[lane]?, seen[lane]?, pixels.get(lane)?);
            Some(sky_ray(shading, &way.0.ray, &seen.hit, normals[lane]?, sky_sample(*pixel, 0, 1)))
        });
        openness_of_each(shading, asked)
    } else {
        [1.0; LANES]
    };
    let center = |lane: usize| {
        let (prepared, seen, n, (ray, _)) = (prepared[lane]?, seen[lane]?, normals[lane]?, pixels.get(lane)?);
        let hit = seen.hit;
        let material = hit_material(scene, hit.instance, hit.face);
        let light = seen_light(shading, &prepared.ray, &seen, n, &material);
        let see_through = if material.opacity < 1.0 { SEE_THROUGH } else { 0 };
        Some(Center {
            normal: n.to_array(),
            depth: ((prepared.start + hit.distance.to_f64()) * ray.direction.dot(camera.forward)) as f32,
            dark: light.dark,
            lit: light.lit,
            open: open[lane],
            flags: see_through | if seen.cap == NO_PLANE { 0 } else { CAP },
            instance: hit.instance + 1,
            face: hit.face + 1,
            net: hit.net,
            uv: hit.uv,
            ..empty_center()
        })
    };
    from_fn(|lane| center(lane).unwrap_or_else(empty_center))
}

/// What a ray through a pixel shows.
#[derive(Debug, Clone, Copy, Default)]
pub struct Shaded {
    /// Linear light, premultiplied, with coverage.
    pub color: [f32; 4],
    /// Of the first thing that is hit, as in [`Center`]; none where nothing is.
    pub lit: Option<[f32; 3]>,
    /// Its instance and face, indices.
    pub first: Option<(u32, u32)>,
}

/// The light along up to eight rays through places of a pixel, front to back through see-through faces. A sample is given by its ray and its number.
pub fn shade_samples(
    shading: &Shading<'_, '_>,
    samples: &[(Ray, u32)],
    pixel: u32,
    around: &[Neighbour; 5],
) -> [Shaded; LANES] {
    let scene = shading.scene;
    let mut shaded = [Shaded::default(); LANES];
    let mut ways = from_fn(|lane| {
        let prepared = prepare::<f32>(&samples.get(lane)?.0, scene.header)?;
        Some(way(shading, Segment::of(&prepared)))
    });
    for layer in 1..=MAX_LAYERS {
        let seen = see(shading, &mut ways);
        let normals = normals(shading, &ways, &seen);
        let open = if shading.options.ambient_occlusion {
            openness_of_samples(shading, &ways, &seen, &normals, samples, (pixel, layer, around))
        } else {
            [1.0; LANES]
        };
        for lane in 0..LANES {
            let (Some(way), Some(seen), Some(n)) = (&mut ways[lane], seen[lane], normals[lane]) else {
                ways[lane] = None;
                continue;
            };
            let shaded = &mut shaded[lane];
            let hit = seen.hit;
            let material = hit_material(scene, hit.instance, hit.face);
            let light = seen_light(shading, &way.0.ray, &seen, n, &material);
            if layer == 1 {
                shaded.lit = Some(light.lit);
                shaded.first = Some((hit.instance, hit.face));
            }
            let lit = light.at(open[lane]);
            // What lies behind the last layer is not looked for: the layer stands for it.
            let opacity = if layer == MAX_LAYERS { 1.0 } else { material.opacity };
            let color = &mut shaded.color;
            let left = (1.0 - color[3]) * opacity;
            for k in 0..3 {
                color[k] += lit[k] * left;
            }
            color[3] += left;
            if color[3] > 0.995 {
                let full = 1.0 / color[3];
                *color = [color[0] * full, color[1] * full, color[2] * full, 1.0];
                ways[lane] = None;
                continue;
            }
            let skip = surface_offset(scene);
            way.0.near = Distance { anchor: hit.distance.anchor, offset: hit.distance.offset + skip };
        }
        if ways.iter().all(Option::is_none) {
            break;
        }
    }
    shaded
}

/// What samples see of the sky: what pixels around know of it, where they do.
fn openness_of_samples(
    shading: &Shading<'_, '_>,
    ways: &[Option<Way>; LANES],
    seen: &[Option<Seen>; LANES],
    normals: &[Option<Vector3<f32>>; LANES],
    samples: &[(Ray, u32)],
    (pixel, layer, around): (u32, usize, &[Neighbour; 5]),
) -> [f32; LANES] {
    let known: [f32; LANES] = from_fn(|lane| match (&seen[lane], normals[lane]) {
        (Some(seen), Some(n)) if layer == 1 => known_openness(around, seen, n),
        _ => -1.0,
    });
    let asked = from_fn(|lane| {
        let (way, seen, n, (_, sample)) = (ways[lane]?, seen[lane]?, normals[lane]?, samples.get(lane)?);
        let place = sky_sample(pixel, *sample, shading.options.samples);
        (known[lane] < 0.0).then(|| sky_ray(shading, &way.0.ray, &seen.hit, n, place))
    });
    let found = openness_of_each(shading, asked);
    from_fn(|lane| if known[lane] < 0.0 { found[lane] } else { known[lane] })
}

/// What the pixels around know of the sky over a hit: that of the first that shows the same face turned the same way, else negative.
fn known_openness(around: &[Neighbour; 5], seen: &Seen, n: Vector3<f32>) -> f32 {
    let face = if seen.cap == NO_PLANE { seen.hit.face + 1 } else { 0 };
    for neighbour in around {
        let is_same = neighbour.face == face && neighbour.instance == seen.hit.instance + 1;
        let [x, y, z] = neighbour.normal;
        if is_same && n.dot(Vector3 { x, y, z }) > SAME_WAY {
            return neighbour.open;
        }
    }
    -1.0
}

/// Bits from [`BESIDE_LEFT`] on: the neighbours whose centres do not show what a sample shows at `place`, in 0..1, close to them; all of them where
/// none shows it that is not alone with it.
pub fn beside(shaded: &Shaded, place: [f32; 2], refined: &Refined) -> u32 {
    let is_close = [place[0] < CLOSE, place[0] > 1.0 - CLOSE, place[1] < CLOSE, place[1] > 1.0 - CLOSE];
    let sample = shaded.lit.map(perceived);
    let (mut flags, mut shown) = (0, 0);
    for side in 0..4 {
        let neighbour = &refined.around[side + 1];
        let differs = match sample {
            Some(sample) => is_other([sample, neighbour.perceived], [1, neighbour.instance]),
            None => neighbour.instance != 0,
        };
        shown += u32::from(!differs && neighbour.is_alone == 0);
        if differs && is_close[side] {
            flags |= BESIDE_LEFT << side;
        }
    }
    if shown == 0 { BESIDE_ALL } else { flags }
}

/// Whether two places show different things: their lights under the whole sky, as the eye sees them, and 0 for an instance where there is none.
pub fn is_other(perceived: [[f32; 3]; 2], instance: [u32; 2]) -> bool {
    (instance[0] == 0) != (instance[1] == 0)
        || instance[0] != 0 && contrast(perceived[0], perceived[1]) > OTHER
}

/// How far away the sky begins.
fn sky_distance(scene: &Scene<'_>) -> f32 {
    (scene_radius(scene.header) * OCCLUSION_RADIUS) as f32
}

/// A ray from a hit as far as the sky, drawn from a cosine distribution by two numbers in 0..1.
fn sky_ray(
    shading: &Shading<'_, '_>,
    ray: &WorldRay<f32>,
    hit: &RawHit<f32>,
    n: Vector3<f32>,
    [a, b]: [f32; 2],
) -> Segment {
    let scene = shading.scene;
    let direction = cosine_direction(n, a, b);
    let ray = leave_surface(scene, ray, hit, n, direction, surface_offset(scene));
    let [near, far] = [0.0, sky_distance(scene)].map(|offset| Distance { anchor: 0.0, offset });
    Segment { ray, near, far }
}

/// What rays see of the sky; 1 for none.
fn openness_of_each(shading: &Shading<'_, '_>, asked: [Option<Segment>; LANES]) -> [f32; LANES] {
    let mut ways = asked.map(|asked| asked.map(|segment| way(shading, segment)));
    let distance = sky_distance(shading.scene);
    see(shading, &mut ways).map(|seen| openness(seen, distance))
}

/// The share of the sky seen by a ray; near blockers count more than far ones.
fn openness(seen: Option<Seen>, distance: f32) -> f32 {
    let blocked = match seen {
        Some(blocker) => 1.0 - (blocker.hit.distance.beyond(0.0) / distance).clamp(0.0, 1.0),
        None => 0.0,
    };
    1.0 - blocked * blocked
}

/// A point of the unit square: the R2 sequence (Roberts 2018), which runs on from pixel to pixel of a tile of 4 × 4, in an order that sets neighbours far
/// apart, so that they err in opposite ways and the eye, which takes the mean, sees less grain. Tiles are moved by a random offset: without it
/// the sequence draws stripes. In whole numbers, so that CPU and GPU agree to the bit. A pixel takes `samples` of it, one after the other.
fn sky_sample(pixel: u32, sample: u32, samples: u32) -> [f32; 2] {
    let (x, y) = (pixel & 0xffff, pixel >> 16);
    let tile = pixel_key(x >> 2, y >> 2);
    let place = (x & 1) << 3 | (y & 1) << 2 | (x & 2) | (y & 2) >> 1;
    let index = place.wrapping_mul(samples).wrapping_add(sample);
    let a = hash(tile, 0, 2).wrapping_add(index.wrapping_mul(0xc13f_a9a9));
    let b = hash(tile, 0, 3).wrapping_add(index.wrapping_mul(0x91e1_0da5));
    [unit(a), unit(b)]
}
