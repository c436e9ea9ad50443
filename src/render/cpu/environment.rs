//! Light from a direction, and directions where light comes from: what kernels make of an [`Environment`].
//!
//! Light is looked up between four texels, directions are found texel by texel: by the share that a texel has of a row, and a row of all.

use super::vector::{Vector3, vec3};
use crate::numeric::Real;
use crate::render::environment::Environment;
use std::f32::consts::{PI, TAU};

/// A map of light and the axes that it stands in.
#[derive(Debug, Clone, Copy)]
pub struct Surroundings<'a> {
    /// The map.
    pub map: &'a Environment,
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
    let turn = Real::atan2(x, -z);
    let fall = Real::atan2((x * x + z * z).sqrt(), y);
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

/// How densely [`sample_light`] finds a direction, per steradian.
pub fn light_density(surroundings: &Surroundings<'_>, direction: Vector3<f32>) -> f32 {
    let map = surroundings.map;
    let [u, v] = map_place(surroundings, direction);
    let column = ((u * map.width as f32) as u32).min(map.width as u32 - 1);
    let row = ((v * map.height as f32) as u32).min(map.height as u32 - 1);
    texel_density(surroundings, column, row, v)
}

/// The density within a texel, at the height `v` of the map.
fn texel_density(surroundings: &Surroundings<'_>, column: u32, row: u32, v: f32) -> f32 {
    let map = surroundings.map;
    let share = row_share(surroundings, row) * column_share(surroundings, column, row);
    let (sin, _) = Real::sin_cos(v * PI);
    share * (map.width * map.height) as f32 / (TAU * PI * sin.max(1e-5))
}

fn row_share(surroundings: &Surroundings<'_>, row: u32) -> f32 {
    let rows = &surroundings.map.rows;
    rows[row as usize] - if row == 0 { 0.0 } else { rows[row as usize - 1] }
}

fn column_share(surroundings: &Surroundings<'_>, column: u32, row: u32) -> f32 {
    let map = surroundings.map;
    let at = row as usize * map.width + column as usize;
    map.texels[at][3] - if column == 0 { 0.0 } else { map.texels[at - 1][3] }
}

/// A direction by a point of the unit square, where light comes from.
pub fn sample_light(surroundings: &Surroundings<'_>, [a, b]: [f32; 2]) -> LightSample {
    let map = surroundings.map;
    let (mut low, mut high) = (0, map.height as u32 - 1);
    while low < high {
        let middle = (low + high) / 2;
        if map.rows[middle as usize] > b {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    let row = low;
    let first = row as usize * map.width;
    (low, high) = (0, map.width as u32 - 1);
    while low < high {
        let middle = (low + high) / 2;
        if map.texels[first + middle as usize][3] > a {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    let column = low;
    let row_start = map.rows[row as usize] - row_share(surroundings, row);
    let column_start = map.texels[first + column as usize][3] - column_share(surroundings, column, row);
    let down = ((b - row_start) / row_share(surroundings, row).max(1e-20)).clamp(0.0, 1.0);
    let across = ((a - column_start) / column_share(surroundings, column, row).max(1e-20)).clamp(0.0, 1.0);
    let v = (row as f32 + down) / map.height as f32;
    let (sin_turn, cos_turn) = Real::sin_cos(((column as f32 + across) / map.width as f32 - 0.5) * TAU);
    let (sin_fall, cos_fall) = Real::sin_cos(v * PI);
    let local = vec3(sin_fall * sin_turn, cos_fall, -sin_fall * cos_turn);
    let [x, y, z] = surroundings.axes;
    LightSample {
        direction: x * local.x + y * local.y + z * local.z,
        density: texel_density(surroundings, column, row, v),
    }
}

#[cfg(test)]
mod tests {
    use super::super::sobol::sample_pair;
    use super::*;
    use glam::DVec3;

    fn surroundings(map: &Environment) -> Surroundings<'_> {
        Surroundings { map, axes: [vec3(0.0, 1.0, 0.0), vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0)] }
    }

    #[test]
    fn samples_have_the_density_that_is_told_and_find_all_light() {
        let map = Environment::studio();
        let surroundings = surroundings(&map);
        let (n, count) = (vec3(0.0, 0.0, 1.0), 1 << 14);
        let mut sum = 0.0_f64;
        for sample in 0..count {
            let found = sample_light(&surroundings, sample_pair(3, sample, 0, 0));
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
