//! The share of the sky that the pixels' centres see, without the grain of one ray each.
//!
//! The rays of a tile of 4 × 4 pixels are 16 places of one sequence (`sky_sample`), so the mean over any window of 4 × 4 has all of them; a second mean over
//! 3 × 3 such windows, and a third over 3 × 3 of those, take in 400 rays, the nearer ones more often: of a mean that falls off to its sides no stripes show
//! where a tile leaves it. Only pixels of one surface are averaged: those that face the same way and lie in each other's tangent plane.
//! (Heitz et al. 2018 and others filter so; the sizes are those of the sequence.)

use super::packet::LANES;
use super::vector::{Vector3, vec3};
use crate::numeric::{Eight, Mask, Mask8, Number};
use rayon::prelude::*;
use smallvec::SmallVec;

/// Cosine of the angle between normals that belong together.
const SAME_WAY: f32 = 0.9;

/// Sine of the angle at which a point may lie off the tangent plane of another.
const OFF_PLANE: f32 = 0.25;

/// How far, in pixels, the means reach.
pub const REACH: usize = 10;

/// What the filter looks at: arrays of all pixels, row by row.
#[derive(Debug, Clone, Copy)]
pub struct Surface<'a> {
    /// Pixels across.
    pub width: usize,
    /// Unit normals; 0 where nothing is.
    pub normal: &'a [[f32; 3]],
    /// Points.
    pub position: &'a [[f32; 3]],
}

/// Rows whose means one thread finds at a time.
const ROWS_PER_BAND: usize = 16;

/// Pixels that show nothing beside each row of a band, on both sides: at least as many as a mean reaches beyond its ends.
const BESIDE: usize = 8;

/// The means of `open`; values at pixels that show nothing are of no account.
pub fn smooth(surface: &Surface<'_>, mut open: Vec<f32>) -> Vec<f32> {
    let near: Vec<[isize; 2]> = (-2..2).flat_map(|dy| (-2..2).map(move |dx| [dx, dy])).collect();
    let far: Vec<[isize; 2]> = (-1..2).flat_map(|dy| (-1..2).map(move |dx| [4 * dx, 4 * dy])).collect();
    let mut means = vec![0.0; open.len()];
    mean_over(surface, &open, &near, &mut means);
    mean_over(surface, &means, &far, &mut open);
    mean_over(surface, &open, &far, &mut means);
    means
}

/// Writes the means of `open` over the places at `offsets` from each pixel, itself among them.
fn mean_over(surface: &Surface<'_>, open: &[f32], offsets: &[[isize; 2]], means: &mut [f32]) {
    let width = surface.width.max(1);
    let reach = offsets.iter().flatten().map(|offset| offset.unsigned_abs()).max().unwrap_or(0);
    let bands = means.par_chunks_mut(width * ROWS_PER_BAND).enumerate();
    bands.for_each_init(Rows::default, |rows, (band, means)| {
        rows.load(surface, open, band * ROWS_PER_BAND, means.len() / width, reach);
        let steps = offsets.iter().map(|&[dx, dy]| dy * rows.stride as isize + dx);
        let steps: SmallVec<[isize; 16]> = steps.collect();
        for (y, row) in means.chunks_mut(width).enumerate() {
            let first = (y + reach) * rows.stride + BESIDE;
            for (x, means) in row.chunks_mut(LANES).enumerate() {
                let at = first + x * LANES;
                let mean = rows.means(at, steps.iter().map(|&step| at.wrapping_add_signed(step)));
                means.copy_from_slice(&mean.to_array()[..means.len()]);
            }
        }
    });
}

/// Some rows of pixels, coordinate by coordinate, so that eight pixels in a row are one vector. Around them, and beyond the picture, are pixels that belong to
/// none: they have no normal.
#[derive(Debug, Default)]
struct Rows {
    stride: usize,
    normal: [Vec<f32>; 3],
    position: [Vec<f32>; 3],
    open: Vec<f32>,
}

impl Rows {
    /// `count` rows from `first` on, and `reach` above and below.
    fn load(&mut self, surface: &Surface<'_>, open: &[f32], first: usize, count: usize, reach: usize) {
        let width = surface.width.max(1);
        self.stride = width.next_multiple_of(LANES) + 2 * BESIDE;
        let size = (count + 2 * reach) * self.stride;
        for plane in self.normal.iter_mut().chain(&mut self.position).chain([&mut self.open]) {
            plane.clear();
            plane.resize(size, 0.0);
        }
        for row in 0..count + 2 * reach {
            let Some(y) = (first + row).checked_sub(reach).filter(|y| (y + 1) * width <= open.len()) else {
                continue;
            };
            let from = y * width..(y + 1) * width;
            let to = row * self.stride + BESIDE;
            self.open[to..to + width].copy_from_slice(&open[from.clone()]);
            for (x, (n, p)) in surface.normal[from.clone()].iter().zip(&surface.position[from]).enumerate() {
                for k in 0..3 {
                    self.normal[k][to + x] = n[k];
                    self.position[k][to + x] = p[k];
                }
            }
        }
    }

    /// The means over some places each of eight pixels in a row, the first at `at`; `places` are those of the first. That of a pixel does not depend on the
    /// others.
    #[inline(always)]
    fn means(&self, at: usize, places: impl Iterator<Item = usize> + Clone) -> Eight {
        let open = eight(&self.open, at);
        // Where all see the same there is nothing to weigh.
        let differs = |any: Mask8, place| any | !is_same(eight(&self.open, place), open);
        let any_differs = places.clone().fold(Mask8::everywhere(false), differs);
        if !any_differs.any() {
            return open;
        }
        let [n, p] = [&self.normal, &self.position].map(|planes| vector(planes, at));
        let (mut sum, mut count) = (Eight::ZERO, Eight::ZERO);
        for place in places {
            let apart = vector(&self.position, place) - p;
            let off = apart.dot(n);
            let belongs = Eight::splat(SAME_WAY).is_less(n.dot(vector(&self.normal, place)))
                & (off * off).is_at_most(apart.dot(apart) * Eight::splat(OFF_PLANE * OFF_PLANE));
            sum += Number::choose(belongs, eight(&self.open, place), Eight::ZERO);
            count += Number::choose(belongs, Eight::ONE, Eight::ZERO);
        }
        Number::choose(any_differs & Eight::ZERO.is_less(count), sum / count, open)
    }
}

/// Which of the pairs are equal.
#[inline(always)]
fn is_same(a: Eight, b: Eight) -> Mask8 {
    a.is_at_most(b) & b.is_at_most(a)
}

/// Eight numbers in a row.
#[inline(always)]
fn eight(numbers: &[f32], at: usize) -> Eight {
    std::array::from_fn(|k| numbers[at..at + LANES][k]).into()
}

/// Eight vectors in a row.
#[inline(always)]
fn vector(planes: &[Vec<f32>; 3], at: usize) -> Vector3<Eight> {
    vec3(eight(&planes[0], at), eight(&planes[1], at), eight(&planes[2], at))
}

#[cfg(test)]
mod tests {
    use super::super::test_scenes::Random;
    use super::*;

    /// A floor and a wall that meet in the middle column; the floor sees 0 or 1 by turns, the wall nothing.
    #[test]
    fn means_stay_on_their_surface() {
        let (width, height) = (32, 24);
        let is_wall = |x: usize| x >= 16;
        let pixels: Vec<(usize, usize)> = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).collect();
        let normal: Vec<_> =
            pixels.iter().map(|&(x, _)| if is_wall(x) { [1.0, 0.0, 0.0] } else { [0.0, 0.0, 1.0] }).collect();
        let position: Vec<_> = pixels.iter().map(|&(x, y)| [x as f32, y as f32, 0.0]).collect();
        let open: Vec<f32> =
            pixels.iter().map(|&(x, y)| if is_wall(x) { 0.0 } else { ((x + y) % 2) as f32 }).collect();
        let smoothed = smooth(&Surface { width, normal: &normal, position: &position }, open);
        for (&(x, y), &value) in pixels.iter().zip(&smoothed) {
            if is_wall(x) {
                assert_eq!(value, 0.0, "{x} {y}");
            } else {
                assert!((value - 0.5).abs() < 0.1, "{x} {y}: {value}");
            }
        }
    }

    /// Bumps and steps over some pixels, some of which show nothing; the picture is no multiple of a vector wide, nor of a band high.
    #[test]
    fn means_are_those_pixel_by_pixel() {
        let (width, height) = (45, 39);
        let mut random = Random(1);
        let mut next = || random.unit() as f32;
        let (mut normal, mut position, mut open) = (Vec::new(), Vec::new(), Vec::new());
        for (y, x) in (0..height).flat_map(|y| (0..width).map(move |x| (y, x))) {
            let tilt = 0.4 * (next() - 0.5);
            let is_there = next() > 0.1;
            normal.push(if is_there { [tilt, 0.0, (1.0 - tilt * tilt).sqrt()] } else { [0.0; 3] });
            position.push(if is_there { [x as f32, y as f32, (x / 11) as f32 + next()] } else { [0.0; 3] });
            open.push(next());
        }
        let surface = Surface { width, normal: &normal, position: &position };
        let offsets = [[0, 0], [-4, 0], [3, -4], [4, 4], [0, 1]];
        let mut means = vec![0.0; open.len()];
        mean_over(&surface, &open, &offsets, &mut means);
        let at = |[x, y, z]: [f32; 3]| vec3(x, y, z);
        let mut weighed = 0;
        for pixel in (0..open.len()).filter(|&pixel| normal[pixel] != [0.0; 3]) {
            let (mut sum, mut count) = (0.0, 0.0);
            for [dx, dy] in offsets {
                let (x, y) = ((pixel % width) as isize + dx, (pixel / width) as isize + dy);
                if !(0..width as isize).contains(&x) || !(0..height as isize).contains(&y) {
                    continue;
                }
                let other = y as usize * width + x as usize;
                let (n, m) = (at(normal[pixel]), at(normal[other]));
                let apart = at(position[other]) - at(position[pixel]);
                let off = apart.dot(n);
                if n.dot(m) > SAME_WAY && off * off <= OFF_PLANE * OFF_PLANE * apart.dot(apart) {
                    sum += open[other];
                    count += 1.0;
                }
            }
            weighed += usize::from(count > 1.0);
            assert_eq!(means[pixel], sum / count, "{pixel}");
        }
        assert!(weighed > 500, "{weighed}");
    }
}
