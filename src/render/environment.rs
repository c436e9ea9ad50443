//! Light from all around: a map of the sphere, as pictures of it have it (longitude across, latitude down), with the sums that light is sampled by.
//!
//! The studio of the default look is such a map too, so that there is one way to look light up and one to sample it.

use super::cpu::bsdf::luminance;
use super::cpu::light::{
    AMBIENT_DOWN, AMBIENT_UP, AMBIENT_WEIGHT, FILL_COLOR, FILL_FROM, KEY_COLOR, KEY_FROM,
};
use glam::DVec3;
use rayon::prelude::*;
use std::f64::consts::{PI, TAU};

/// Columns of the studio's map; half as many rows.
const STUDIO_WIDTH: usize = 512;
/// Where the sky of the studio is brightest, as [`KEY_FROM`] has directions.
const SKY_FROM: [f64; 3] = [0.0, 1.0, 0.25];
/// Tangents of half the angles that the key light fills, across and upwards; its borders are as soft as half of that again.
const KEY_SIZE: [f64; 2] = [0.45, 0.36];
/// The same of the fill light.
const FILL_SIZE: [f64; 2] = [0.5, 0.7];

/// How many times as bright as in the default look the key light is …
const KEY_GAIN: f32 = 1.6;
/// … and the sky: the default look knows of no shadow that the key throws.
const SKY_GAIN: f32 = 0.8;

/// What no direction is sampled less than, of the mean.
const LEAST_SHARE: f64 = 0.02;

/// A map of light. In its own axes y is up and −z is what the middle of the map shows, x to the right of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Environment {
    /// Texels across.
    pub(super) width: usize,
    /// Texels down.
    pub(super) height: usize,
    /// Rows from the top: linear red, green and blue light, and 0.
    pub(super) texels: Vec<[f32; 4]>,
    /// Where light comes from.
    pub(super) shares: Shares,
}

/// What directions are sampled by: the share of all weight up to each row's end, then, row by row, the share of the row's weight up to each texel's end.
pub(super) type Shares = Vec<f32>;

impl Environment {
    /// Of a map of linear light with rows from the top; `None` where the sizes do not fit or any light is negative, infinite or not a number.
    pub fn from_map([width, height]: [usize; 2], light: &[[f32; 3]]) -> Option<Self> {
        let is_light = |texel: &[f32; 3]| texel.iter().all(|c| c.is_finite() && *c >= 0.0);
        if width == 0 || height == 0 || light.len() != width * height || !light.par_iter().all(is_light) {
            return None;
        }
        let texels = light.par_iter().map(|&[red, green, blue]| [red, green, blue, 0.0]).collect();
        let mut map = Self { width, height, texels, shares: Shares::new() };
        map.shares = map.shares_by(|_, brightness| brightness);
        Some(map)
    }

    /// Sums to sample by: `weight` is told the direction of a texel, in the map's axes, and how bright the map is there.
    fn shares_by(&self, weight: impl Fn(DVec3, f64) -> f64 + Sync) -> Shares {
        let (width, height) = (self.width, self.height);
        let brightness: Vec<f32> =
            self.texels.par_iter().map(|&[red, green, blue, _]| luminance([red, green, blue])).collect();
        let mean = brightness.iter().map(|&b| f64::from(b)).sum::<f64>() / brightness.len() as f64;
        // Light is looked up between texels, so each has the weight of the brightest around it.
        let weight_at = |x: usize, y: usize| {
            let rows = y.saturating_sub(1)..(y + 2).min(height);
            let columns = [(x + width - 1) % width, x, (x + 1) % width];
            let around = rows.flat_map(|row| columns.map(|column| brightness[row * width + column]));
            let brightest = f64::from(around.fold(0.0, f32::max)) + LEAST_SHARE * mean;
            weight(direction_of(x as f64 + 0.5, y as f64 + 0.5, [width, height]), brightest)
                + f64::MIN_POSITIVE
        };
        let mut of_columns = vec![0.0; width * height];
        let row_weights: Vec<f64> = of_columns
            .par_chunks_mut(width)
            .enumerate()
            .map(|(y, row)| {
                let weights: Vec<f64> = (0..width).map(|x| weight_at(x, y)).collect();
                for (own, share) in row.iter_mut().zip(shares(&weights)) {
                    *own = share;
                }
                weights.iter().sum::<f64>() * (PI * (y as f64 + 0.5) / height as f64).sin()
            })
            .collect();
        shares(&row_weights).chain(of_columns).collect()
    }

    /// What to sample the light by that a surface receives whose normal is `n`, a unit vector in the map's axes.
    pub(super) fn received_shares(&self, n: DVec3) -> Shares {
        self.shares_by(|direction, brightness| brightness * direction.dot(n).max(0.0))
    }

    /// The studio of the default look: a sky, a key and a fill light, in the axes of a camera.
    pub fn studio() -> Self {
        let (width, height) = (STUDIO_WIDTH, STUDIO_WIDTH / 2);
        let key = SoftBox::new(KEY_FROM, KEY_SIZE);
        let fill = SoftBox::new(FILL_FROM, FILL_SIZE);
        let sky = DVec3::from_array(SKY_FROM).normalize();
        let directions: Vec<DVec3> = (0..width * height)
            .map(|texel| {
                direction_of((texel % width) as f64 + 0.5, (texel / width) as f64 + 0.5, [width, height])
            })
            .collect();
        // What a box of light 1 gives to a surface that faces it, of π.
        let given = |of: &SoftBox| {
            let cell = TAU / width as f64 * PI / height as f64;
            let lit = |d: &DVec3| of.share(*d) * d.dot(of.towards).max(0.0) * (1.0 - d.y * d.y).sqrt();
            directions.iter().map(lit).sum::<f64>() * cell / PI
        };
        let (key_given, fill_given) = (given(&key), given(&fill));
        let light: Vec<[f32; 3]> = directions
            .iter()
            .map(|&direction| {
                let height = 0.5 + 0.5 * direction.dot(sky) as f32;
                let key = (key.share(direction) / key_given) as f32;
                let fill = (fill.share(direction) / fill_given) as f32;
                std::array::from_fn(|k| {
                    let ambient = AMBIENT_DOWN[k] + (AMBIENT_UP[k] - AMBIENT_DOWN[k]) * height;
                    ambient * AMBIENT_WEIGHT * SKY_GAIN + key * KEY_GAIN * KEY_COLOR[k] + fill * FILL_COLOR[k]
                })
            })
            .collect();
        Self::from_map([width, height], &light).expect("the studio's light is finite")
    }

    /// The luminance that a surface with the normal `n`, a unit vector in the map's axes, receives.
    pub(super) fn irradiance(&self, n: DVec3) -> f64 {
        let size = [self.width, self.height];
        let row = |y: usize| {
            let ring = (PI * (y as f64 + 0.5) / self.height as f64).sin();
            let texel = |x: usize| {
                let [red, green, blue, _] = self.texels[y * self.width + x];
                let direction = direction_of(x as f64 + 0.5, y as f64 + 0.5, size);
                f64::from(luminance([red, green, blue])) * direction.dot(n).max(0.0)
            };
            (0..self.width).map(texel).sum::<f64>() * ring
        };
        let rows: Vec<f64> = (0..self.height).into_par_iter().map(row).collect();
        rows.iter().sum::<f64>() * (TAU / self.width as f64) * (PI / self.height as f64)
    }

    /// The mean luminance over the sphere.
    pub(super) fn mean(&self) -> f64 {
        let row = |(y, row): (usize, &[[f32; 4]])| {
            let ring = (PI * (y as f64 + 0.5) / self.height as f64).sin();
            let sum: f64 = row.iter().map(|&[r, g, b, _]| f64::from(luminance([r, g, b]))).sum();
            [sum * ring, ring * self.width as f64]
        };
        let rows = self.texels.chunks(self.width).enumerate().map(row);
        let [sum, weight] = rows.fold([0.0, 0.0], |[a, b], [c, d]| [a + c, b + d]);
        sum / weight
    }

    /// Makes all light so many times as bright; `factor` is finite and not negative.
    pub fn brighten(&mut self, factor: f32) {
        for texel in &mut self.texels {
            texel[..3].iter_mut().for_each(|channel| *channel = (*channel * factor).min(f32::MAX));
        }
    }
}

/// The direction of a place of a map, in texels.
fn direction_of(x: f64, y: f64, [width, height]: [usize; 2]) -> DVec3 {
    let (turn, fall) = ((x / width as f64 - 0.5) * TAU, y / height as f64 * PI);
    DVec3::new(fall.sin() * turn.sin(), fall.cos(), -fall.sin() * turn.cos())
}

/// The sums up to each weight, of the sum of all, which is positive; the last is 1.
fn shares(weights: &[f64]) -> impl Iterator<Item = f32> {
    let all: f64 = weights.iter().sum();
    let last = weights.len() - 1;
    let mut sum = 0.0;
    weights.iter().enumerate().map(move |(index, weight)| {
        sum += weight / all;
        if index == last { 1.0 } else { sum.min(1.0) as f32 }
    })
}

/// A rectangle of light far away.
struct SoftBox {
    towards: DVec3,
    across: DVec3,
    upwards: DVec3,
    size: [f64; 2],
}

impl SoftBox {
    fn new(from: [f64; 3], size: [f64; 2]) -> Self {
        let towards = DVec3::from_array(from).normalize();
        let across = DVec3::Y.cross(towards).normalize();
        Self { towards, across, upwards: towards.cross(across), size }
    }

    /// The share of its light that comes from a direction.
    fn share(&self, direction: DVec3) -> f64 {
        let depth = direction.dot(self.towards);
        if depth <= 0.0 {
            return 0.0;
        }
        let place = [direction.dot(self.across) / depth, direction.dot(self.upwards) / depth];
        let inside = |k: usize| {
            let beyond = ((place[k].abs() / self.size[k] - 0.75) * 2.0).clamp(0.0, 1.0);
            1.0 - beyond * beyond * (3.0 - 2.0 * beyond)
        };
        inside(0) * inside(1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_surface_that_faces_the_studios_key_is_not_much_brighter_than_in_the_default_look() {
        let studio = Environment::studio();
        let key = DVec3::from_array(KEY_FROM).normalize();
        let light = studio.irradiance(key) / PI;
        assert!((1.0..1.6).contains(&light), "{light}");
        assert!(studio.irradiance(-key) / PI < 0.5);
    }

    #[test]
    fn even_light_is_even() {
        let map = Environment::from_map([16, 8], &[[0.5; 3]; 128]).expect("light");
        assert!((map.irradiance(DVec3::X) / PI - 0.5).abs() < 0.02);
        assert!((map.mean() - 0.5).abs() < 1e-9);
        let shares = &map.shares;
        assert_eq!((shares.len(), shares[7], shares.last()), (8 + 128, 1.0, Some(&1.0)));
        assert!((shares[3] - 0.5).abs() < 1e-6 && (shares[8 + 7] - 0.5).abs() < 1e-6);
        let from_above = map.received_shares(DVec3::Y);
        assert!((from_above[3] - 1.0).abs() < 1e-6 && from_above[2] < 1.0);
    }

    #[test]
    fn what_is_no_light_is_refused() {
        assert!(Environment::from_map([2, 2], &[[0.0; 3]; 4]).is_some());
        assert!(Environment::from_map([2, 2], &[[0.0; 3]; 3]).is_none());
        assert!(Environment::from_map([0, 2], &[]).is_none());
        for wrong in [f32::NAN, f32::INFINITY, -1.0] {
            assert!(Environment::from_map([1, 1], &[[wrong; 3]]).is_none());
        }
    }
}
