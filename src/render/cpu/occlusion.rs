//! The share of the sky that the pixels' centres see, without the grain of one ray each.
//!
//! The rays of a tile of 4 × 4 pixels are 16 places of one sequence (`sky_sample`), so the mean over any window of 4 × 4 has all of them; a second mean over
//! 3 × 3 such windows, and a third over 3 × 3 of those, take in 400 rays, the nearer ones more often: of a mean that falls off to its sides no stripes show
//! where a tile leaves it. Only pixels of one surface are averaged: those that face the same way and lie in each other's tangent plane.
//! (Heitz et al. 2018 and others filter so; the sizes are those of the sequence.)

use super::bands::rows_per_band;
use super::packet::LANES;
use super::vector::{Vector3, vec3};
use crate::image::filled;
use crate::numeric::{Eight, Mask, Mask8, Number};
use rayon::prelude::*;
use std::array::from_fn;
use std::ops::RangeInclusive;

/// Cosine of the angle between normals that belong together.
const SAME_WAY: f32 = 0.9;

/// Sine of the angle at which a point may lie off the tangent plane of another.
const OFF_PLANE: f32 = 0.25;

/// Pixels across and down of the first window, and from one that a mean is taken over to the next.
const APART: usize = 4;

/// How far, in pixels, the means reach: the first half a window, the others one.
pub const REACH: usize = APART / 2 + 2 * APART;

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

/// Rows whose means one thread finds at a time. The more rows, the fewer are loaded twice.
const ROWS_PER_BAND: RangeInclusive<usize> = 32..=64;

/// Pixels that show nothing beside each row of a band, on both sides: at least as many as one mean reaches beyond its ends.
const BESIDE: usize = 8;

/// The places that the first mean is taken over, and those of the second and the third.
fn places() -> ([[isize; 2]; APART * APART], [[isize; 2]; 9]) {
    let window = APART as isize;
    let near = from_fn(|i| [i as isize % window - window / 2, i as isize / window - window / 2]);
    let far = from_fn(|i| [(i as isize % 3 - 1) * window, (i as isize / 3 - 1) * window]);
    (near, far)
}

/// The means of `open`; values at pixels that show nothing are of no account.
pub fn smooth(surface: &Surface<'_>, open: &[f32]) -> Vec<f32> {
    let (near, far) = places();
    let width = surface.width.max(1);
    let rows_per_band = rows_per_band(open.len() / width, ROWS_PER_BAND);
    let mut means = filled(0.0, open.len());
    let bands = means.par_chunks_mut(width * rows_per_band).enumerate();
    bands.for_each_init(Rows::default, |rows, (band, means)| {
        let count = means.len() / width;
        rows.load(surface, open, band * rows_per_band, count);
        rows.mean_over(&near, 2 * APART, count);
        rows.mean_over(&far, APART, count);
        rows.mean_over(&far, 0, count);
        for (y, means) in means.chunks_mut(width).enumerate() {
            let first = (y + REACH) * rows.stride + BESIDE;
            means.copy_from_slice(&rows.open[first..first + width]);
        }
    });
    means
}

/// Some rows of pixels, coordinate by coordinate, so that eight pixels in a row are one vector, with [`REACH`] more above and below. Around them, and beyond
/// the picture, are pixels that belong to none: they have no normal.
#[derive(Debug, Default)]
struct Rows {
    stride: usize,
    normal: [Vec<f32>; 3],
    position: [Vec<f32>; 3],
    open: Vec<f32>,
    means: Vec<f32>,
}

impl Rows {
    /// `count` rows from `first` on.
    fn load(&mut self, surface: &Surface<'_>, open: &[f32], first: usize, count: usize) {
        let width = surface.width.max(1);
        self.stride = width.next_multiple_of(LANES) + 2 * BESIDE;
        let size = (count + 2 * REACH) * self.stride;
        let Self { normal, position, open: own, means, .. } = self;
        for plane in normal.iter_mut().chain(position.iter_mut()).chain([&mut *own, means]) {
            plane.clear();
            plane.resize(size, 0.0);
        }
        for row in 0..count + 2 * REACH {
            let Some(y) = (first + row).checked_sub(REACH).filter(|y| (y + 1) * width <= open.len()) else {
                continue;
            };
            let from = y * width..(y + 1) * width;
            let to = row * self.stride + BESIDE;
            let to = to..to + width;
            own[to.clone()].copy_from_slice(&open[from.clone()]);
            for (planes, vectors) in [(&mut *normal, surface.normal), (&mut *position, surface.position)] {
                let [x, y, z] = planes.each_mut().map(|plane| &mut plane[to.clone()]);
                for (((x, y), z), vector) in x.iter_mut().zip(y).zip(z).zip(&vectors[from.clone()]) {
                    [*x, *y, *z] = *vector;
                }
            }
        }
    }

    /// Replaces what is open by its means over the places at `offsets` from each pixel, itself among them: in the `count` rows and as many as `around` above and
    /// below, of those around which all places are there. Other rows are of no account from then on.
    fn mean_over<const PLACES: usize>(
        &mut self,
        offsets: &[[isize; 2]; PLACES],
        around: usize,
        count: usize,
    ) {
        let steps = offsets.map(|[dx, dy]| dy * self.stride as isize + dx);
        for row in REACH - around..REACH + count + around {
            let first = row * self.stride + BESIDE;
            for at in (first..first + self.stride - 2 * BESIDE).step_by(LANES) {
                let mean = self.mean(at, steps.map(|step| at.wrapping_add_signed(step)));
                self.means[at..at + LANES].copy_from_slice(&mean.to_array());
            }
        }
        std::mem::swap(&mut self.open, &mut self.means);
    }

    /// The means over some places each of eight pixels in a row, the first at `at`; `places` are those of the first. That of a pixel does not depend on the
    /// others.
    #[inline(always)]
    fn mean<const PLACES: usize>(&self, at: usize, places: [usize; PLACES]) -> Eight {
        let open = eight(&self.open, at);
        // Where all see the same there is nothing to weigh.
        let differs = |any: Mask8, place| any | !is_same(eight(&self.open, place), open);
        let any_differs = places.into_iter().fold(Mask8::everywhere(false), differs);
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
    from_fn(|k| numbers[at..at + LANES][k]).into()
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
        let smoothed = smooth(&Surface { width, normal: &normal, position: &position }, &open);
        for (&(x, y), &value) in pixels.iter().zip(&smoothed) {
            if is_wall(x) {
                assert_eq!(value, 0.0, "{x} {y}");
            } else {
                assert!((value - 0.5).abs() < 0.1, "{x} {y}: {value}");
            }
        }
    }

    /// Bumps and steps over some pixels, some of which show nothing; pictures are no multiple of a vector wide, nor of a band high, and have fewer pixels than
    /// a mean reaches.
    #[test]
    fn means_are_those_pixel_by_pixel() {
        let sizes = [(45, 139), (1, 1), (7, 3), (8, 1), (9, 70)];
        let weighed: usize = sizes.into_iter().map(|(width, height)| compare(width, height)).sum();
        assert!(weighed > 2500, "{weighed}");
    }

    /// How many means of a picture are other than the pixels' own values, on any number of threads.
    fn compare(width: usize, height: usize) -> usize {
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
        let at = |[x, y, z]: [f32; 3]| vec3(x, y, z);
        let mean = |open: &[f32], offsets: &[[isize; 2]], pixel: usize| {
            let (mut sum, mut count, mut differs) = (0.0, 0.0, false);
            for [dx, dy] in offsets {
                let (x, y) = ((pixel % width) as isize + dx, (pixel / width) as isize + dy);
                if !(0..width as isize).contains(&x) || !(0..height as isize).contains(&y) {
                    differs |= open[pixel] != 0.0;
                    continue;
                }
                let other = y as usize * width + x as usize;
                differs |= open[other] != open[pixel];
                let (n, m) = (at(normal[pixel]), at(normal[other]));
                let apart = at(position[other]) - at(position[pixel]);
                let off = apart.dot(n);
                if n.dot(m) > SAME_WAY && off * off <= OFF_PLANE * OFF_PLANE * apart.dot(apart) {
                    sum += open[other];
                    count += 1.0;
                }
            }
            if differs && count > 0.0 { sum / count } else { open[pixel] }
        };
        let mean_over = |open: &[f32], offsets: &[[isize; 2]]| -> Vec<f32> {
            (0..open.len()).map(|pixel| mean(open, offsets, pixel)).collect()
        };
        let (near, far) = places();
        let expected = mean_over(&mean_over(&mean_over(&open, &near), &far), &far);
        for threads in [1, 2, 16] {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            assert_eq!(pool.install(|| smooth(&surface, &open)), expected, "{width} {height} {threads}");
        }
        expected.iter().zip(&open).filter(|(mean, open)| mean != open).count()
    }
}
