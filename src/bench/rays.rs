//! Rays to measure with.

use crate::render::Ray;
use crate::scene::Scene;
use glam::DVec3;

/// Chord `index` of the scene's bounding sphere between two uniform points of it (Halton's sequence in bases 2, 3, 5 and 7, as Sloup and
/// Havran take them), starting outside the sphere.
pub fn chord(scene: &Scene<'_>, index: u64) -> Ray {
    let anchor = DVec3::from_array(scene.header.world_anchor);
    let radius = DVec3::from_array(scene.header.half_size.map(f64::from)).length();
    let from = on_sphere(halton(index + 1, 2), halton(index + 1, 3));
    let to = on_sphere(halton(index + 1, 5), halton(index + 1, 7));
    let direction = (to - from).try_normalize().unwrap_or(DVec3::Z);
    Ray { origin: anchor + from * radius - direction * radius, direction }
}

/// Exponents of ten of the least and the greatest offset of an aimed ray, in sizes of the scene.
const OFFSETS: [f64; 2] = [-9.0, -3.0];

/// Ray `index` past one of `points`, of which there is at least one, at an offset of 10⁻⁹ to 10⁻³ of the scene's size, uniform in its logarithm, in a
/// random direction; starts outside the scene.
pub fn aimed(scene: &Scene<'_>, points: &[DVec3], index: u64) -> Ray {
    let radius = DVec3::from_array(scene.header.half_size.map(f64::from)).length();
    let number = |stream: u64| unit(index, stream);
    let target = points[(number(0) * points.len() as f64) as usize % points.len()];
    let direction = on_sphere(number(1), number(2));
    let offset = 2.0 * radius * 10.0_f64.powf(OFFSETS[0] + (OFFSETS[1] - OFFSETS[0]) * number(3));
    let target = target + on_sphere(number(4), number(5)) * offset;
    Ray { origin: target - direction * (4.0 * radius), direction }
}

/// The point of the unit sphere that belongs to a point of the unit square, area by area.
pub(super) fn on_sphere(a: f64, b: f64) -> DVec3 {
    let z = 1.0 - 2.0 * a;
    let (sin, cos) = (b * std::f64::consts::TAU).sin_cos();
    let across = (1.0 - z * z).max(0.0).sqrt();
    DVec3::new(across * cos, across * sin, z)
}

/// A number in [0, 1) that looks random and depends on its place alone (the mixer of SplitMix64, Steele, Lea and Flood 2014).
pub(super) fn unit(index: u64, stream: u64) -> f64 {
    let mut x = index.wrapping_mul(0x9e37_79b9_7f4a_7c15) ^ stream.wrapping_mul(0xd1b5_4a32_d192_ed03);
    x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((x ^ (x >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Element `index` of Halton's sequence in a base.
fn halton(mut index: u64, base: u64) -> f64 {
    let (mut value, mut scale) = (0.0, 1.0);
    while index > 0 {
        scale /= base as f64;
        value += scale * (index % base) as f64;
        index /= base;
    }
    value
}
