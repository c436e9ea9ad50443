//! The share of the sky that the pixels' centres see, without the grain of one ray each.
//!
//! The rays of a tile of 4 × 4 pixels are 16 places of one sequence (`sky_sample`), so the mean over any window of 4 × 4 has all of them; a second mean over
//! 3 × 3 such windows, and a third over 3 × 3 of those, take in 400 rays, the nearer ones more often: of a mean that falls off to its sides no stripes show
//! where a tile leaves it. Only pixels of one surface are averaged: those that face the same way and lie in each other's tangent plane.
//! (Heitz et al. 2018 and others filter so; the sizes are those of the sequence.)

use super::vector::Vector3;
use rayon::prelude::*;

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

/// The means of `open`; values at pixels that show nothing are of no account.
pub fn smooth(surface: &Surface<'_>, open: &[f32]) -> Vec<f32> {
    let near: Vec<[isize; 2]> = (-2..2).flat_map(|dy| (-2..2).map(move |dx| [dx, dy])).collect();
    let far: Vec<[isize; 2]> = (-1..2).flat_map(|dy| (-1..2).map(move |dx| [4 * dx, 4 * dy])).collect();
    let once = mean_over(surface, open, &near);
    let twice = mean_over(surface, &once, &far);
    mean_over(surface, &twice, &far)
}

fn mean_over(surface: &Surface<'_>, open: &[f32], offsets: &[[isize; 2]]) -> Vec<f32> {
    let width = surface.width;
    let height = open.len() / width.max(1);
    let steps: Vec<isize> = offsets.iter().map(|&[dx, dy]| dy * width as isize + dx).collect();
    let reach = offsets.iter().flatten().map(|offset| offset.unsigned_abs()).max().unwrap_or(0);
    let is_inside = |place: usize, size: usize| place >= reach && place + reach < size;
    let mean = |y: usize, x: usize| {
        let at = y * width + x;
        if surface.normal[at] == [0.0; 3] {
            return open[at];
        }
        if is_inside(x, width) && is_inside(y, height) {
            return mean_of(surface, open, at, steps.iter().map(|&step| at.wrapping_add_signed(step)));
        }
        let places = offsets.iter().filter_map(|&[dx, dy]| {
            let (x, y) = (x.checked_add_signed(dx)?, y.checked_add_signed(dy)?);
            (x < width && y < height).then_some(y * width + x)
        });
        mean_of(surface, open, at, places)
    };
    let mut means = vec![0.0; open.len()];
    means
        .par_chunks_mut(width.max(1))
        .enumerate()
        .for_each(|(y, row)| row.iter_mut().enumerate().for_each(|(x, value)| *value = mean(y, x)));
    means
}

/// The mean over those of some places that show the surface of pixel `at`, which is one of them.
#[inline(always)]
fn mean_of(
    surface: &Surface<'_>,
    open: &[f32],
    at: usize,
    places: impl Iterator<Item = usize> + Clone,
) -> f32 {
    // Where all see the same there is nothing to weigh.
    if places.clone().all(|place| open[place] == open[at]) {
        return open[at];
    }
    let (mut sum, mut count) = (0.0, 0.0);
    for place in places.filter(|&place| belongs(surface, at, place)) {
        sum += open[place];
        count += 1.0;
    }
    sum / count
}

/// Whether two pixels show one surface.
fn belongs(surface: &Surface<'_>, at: usize, place: usize) -> bool {
    let [n, m, p, q] =
        [surface.normal[at], surface.normal[place], surface.position[at], surface.position[place]]
            .map(|[x, y, z]| Vector3 { x, y, z });
    if at == place {
        return true;
    }
    let apart = q - p;
    let off = apart.dot(n);
    n.dot(m) > SAME_WAY && off * off <= OFF_PLANE * OFF_PLANE * apart.dot(apart)
}

#[cfg(test)]
mod tests {
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
}
