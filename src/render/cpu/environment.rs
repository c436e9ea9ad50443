//! Light from a direction, and directions where light comes from: what kernels make of an [`Environment`].
//!
//! Light is looked up between four texels, directions are found texel by texel: by the share that a texel has of a row, and a row of all.

use super::vector::{Vector3, vec3};
use crate::render::environment::Environment;
use std::f32::consts::{PI, TAU};

/// A map of light and the axes that it stands in.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings<'a> {
    /// The map.
    pub map: &'a Environment,
    /// What light on the ground is sampled by, as the map's own [`Environment::shares`]; empty where there is no ground.
    pub on_ground: &'a [f32],
    /// World-space unit vectors: what the map calls x, y and z.
    pub axes: [Vector3<f32>; 3],
}

/// A direction of the map and how densely it is found, per steradian.
#[derive(Debug, Clone, Copy)]
pub struct LightSample {
    /// A unit vector, world space.
    pub direction: Vector3<f32>,
    /// Per steradian.
    pub density: f32,
}

/// The place of a world-space direction on the map, both in 0..=1.
fn map_place(surroundings: &Surroundings<'_>, direction: Vector3<f32>) -> [f32; 2] {
    let [x, y, z] = surroundings.axes.map(|axis| axis.dot(direction));
    let turn = f32::atan2(x, -z);
    let fall = f32::atan2((x * x + z * z).sqrt(), y);
    [turn / TAU + 0.5, fall / PI]
}

/// The light that comes from a direction.
pub fn light_from(surroundings: &Surroundings<'_>, direction: Vector3<f32>) -> [f32; 3] {
    let map = surroundings.map;
    let (width, height) = (map.width as u32, map.height as u32);
    let [u, v] = map_place(surroundings, direction);
    let (x, y) = (u * width as f32 - 0.5, v * height as f32 - 0.5);
    let (left, top) = (x.floor(), y.floor());
    let (right_share, low_share) = (x - left, y - top);
    let column = |x: f32| ((x + width as f32) as u32) % width;
    let row = |y: f32| (y.max(0.0) as u32).min(height - 1);
    let texel = |x: f32, y: f32| map.texels[(row(y) * width + column(x)) as usize];
    let corners =
        [texel(left, top), texel(left + 1.0, top), texel(left, top + 1.0), texel(left + 1.0, top + 1.0)];
    std::array::from_fn(|k| {
        let above = corners[0][k] + (corners[1][k] - corners[0][k]) * right_share;
        let below = corners[2][k] + (corners[3][k] - corners[2][k]) * right_share;
        above + (below - above) * low_share
    })
}

/// How densely [`sample_light`] finds a direction by the light of the map, per steradian.
pub fn light_density(surroundings: &Surroundings<'_>, direction: Vector3<f32>) -> f32 {
    let map = surroundings.map;
    let [u, v] = map_place(surroundings, direction);
    let column = ((u * map.width as f32) as u32).min(map.width as u32 - 1);
    let row = ((v * map.height as f32) as u32).min(map.height as u32 - 1);
    let share = share_at(&map.shares, 0, row)
        * share_at(&map.shares, map.height as u32 + row * map.width as u32, column);
    texel_density(surroundings, share, v)
}

/// The density within a texel of a share of all weight, at the height `v` of the map.
fn texel_density(surroundings: &Surroundings<'_>, share: f32, v: f32) -> f32 {
    let map = surroundings.map;
    let (sin, _) = f32::sin_cos(v * PI);
    share * (map.width * map.height) as f32 / (TAU * PI * sin.max(1e-5))
}

/// What entry `index` adds to the sums that begin at `first`.
fn share_at(shares: &[f32], first: u32, index: u32) -> f32 {
    let at = (first + index) as usize;
    shares[at] - if index == 0 { 0.0 } else { shares[at - 1] }
}

/// The first of `count` entries from `first` on whose sum is greater than `wanted`, or the last.
fn find_share(shares: &[f32], first: u32, count: u32, wanted: f32) -> u32 {
    let (mut low, mut high) = (0, count - 1);
    while low < high {
        let middle = (low + high) / 2;
        if shares[(first + middle) as usize] > wanted {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    low
}

/// A direction by a point of the unit square, where light comes from, or light on the ground.
pub fn sample_light(surroundings: &Surroundings<'_>, on_ground: bool, [a, b]: [f32; 2]) -> LightSample {
    let map = surroundings.map;
    let shares = if on_ground { surroundings.on_ground } else { &map.shares };
    let (width, height) = (map.width as u32, map.height as u32);
    let row = find_share(shares, 0, height, b);
    let first = height + row * width;
    let column = find_share(shares, first, width, a);
    let (of_row, of_column) = (share_at(shares, 0, row), share_at(shares, first, column));
    // How far into the texel, counted back from its end.
    let up = ((shares[row as usize] - b) / of_row.max(1e-20)).clamp(0.0, 1.0);
    let back = ((shares[(first + column) as usize] - a) / of_column.max(1e-20)).clamp(0.0, 1.0);
    let v = ((row + 1) as f32 - up) / height as f32;
    let (sin_turn, cos_turn) = f32::sin_cos((((column + 1) as f32 - back) / width as f32 - 0.5) * TAU);
    let (sin_fall, cos_fall) = f32::sin_cos(v * PI);
    let local = vec3(sin_fall * sin_turn, cos_fall, -sin_fall * cos_turn);
    let [x, y, z] = surroundings.axes;
    LightSample {
        direction: x * local.x + y * local.y + z * local.z,
        density: texel_density(surroundings, of_row * of_column, v),
    }
}

#[cfg(test)]
mod tests {
    use super::super::sobol::sample_pair;
    use super::*;
    use glam::DVec3;

    fn surroundings(map: &Environment) -> Surroundings<'_> {
        Surroundings {
            map,
            on_ground: &[],
            axes: [vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0)],
        }
    }

    #[test]
    fn samples_have_the_density_that_is_told_and_find_all_light() {
        let map = Environment::studio();
        let surroundings = surroundings(&map);
        let (n, count) = (vec3(0.0, 0.0, 1.0), 1 << 14);
        let mut sum = 0.0_f64;
        for sample in 0..count {
            let found = sample_light(&surroundings, false, sample_pair(3, sample, 0, 0));
            assert!((found.direction.length() - 1.0).abs() < 1e-5);
            let told = light_density(&surroundings, found.direction);
            assert!((told / found.density - 1.0).abs() < 0.5, "{told} {}", found.density);
            let light = light_from(&surroundings, found.direction);
            let light = super::super::bsdf::luminance(light) * found.direction.dot(n).max(0.0);
            sum += f64::from(light / found.density);
        }
        let expected = map.irradiance(DVec3::Y);
        let found = sum / f64::from(count);
        assert!((found / expected - 1.0).abs() < 0.01, "{found} {expected}");
    }

    #[test]
    fn the_map_stands_upright() {
        let mut light = vec![[0.0; 3]; 16 * 8];
        for (texel, light) in light.iter_mut().enumerate() {
            let (x, y) = (texel % 16, texel / 16);
            *light = [(y < 2) as u32 as f32, (x >= 8) as u32 as f32, (4..12).contains(&x) as u32 as f32];
        }
        let map = Environment::from_map([16, 8], &light).expect("light");
        let surroundings = surroundings(&map);
        // Up is +z, the middle of the map is −x, and right of that is +y.
        assert_eq!(light_from(&surroundings, vec3(0.0, 0.0, 1.0))[0], 1.0);
        assert_eq!(light_from(&surroundings, vec3(0.0, 0.0, -1.0))[0], 0.0);
        assert_eq!(light_from(&surroundings, vec3(0.0, 1.0, 0.0))[1], 1.0);
        assert_eq!(light_from(&surroundings, vec3(0.0, -1.0, 0.0))[1], 0.0);
        assert_eq!(light_from(&surroundings, vec3(-1.0, 0.0, 0.0))[2], 1.0);
        assert_eq!(light_from(&surroundings, vec3(1.0, 0.0, 0.0))[2], 0.0);
    }
}
