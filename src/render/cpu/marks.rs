//! Which pixels ask for all their samples by what the centres show: those where light bends between neighbours, where something else begins, where surfaces
//! step, and those with something behind what is seen through.

use super::pixels::perceived;
use super::vector::Vector3;
use crate::image::Film;
use crate::render::Camera;
use rayon::prelude::*;

/// How far the light of three pixels in a row may bend, as the eye sees it: the centre's light is then within a twenty-fourth of it of the mean.
const MOST_BEND: f32 = 4.0 / 255.0;

/// Pixels by which a surface may step towards the viewer unsampled.
const MOST_STEP: f32 = 1.0;

/// Rows of pixels that one thread looks at, one after the other, for those that ask for samples.
const ROWS_MARKED_TOGETHER: usize = 16;

/// What is known of the centres, row by row.
#[derive(Debug, Clone, Copy)]
pub struct Shown<'a> {
    /// By whose pixels steps are measured.
    pub camera: &'a Camera,
    /// With the plain layers.
    pub film: &'a Film,
    /// Linear light under the whole sky.
    pub lit: &'a [[f32; 3]],
    /// Where light passes through.
    pub see_through: &'a [bool],
    /// Points, or nothing where steps are not looked for.
    pub positions: &'a [[f32; 3]],
}

/// The pixels to the left, to the right, above and below.
pub fn neighbours(film: &Film, pixel: usize) -> [Option<usize>; 4] {
    let (x, y) = (pixel % film.width, pixel / film.width);
    [
        (x > 0).then(|| pixel - 1),
        (x + 1 < film.width).then(|| pixel + 1),
        (y > 0).then(|| pixel - film.width),
        (y + 1 < film.height).then(|| pixel + film.width),
    ]
}

/// Which pixels ask for all samples by what the centres show.
pub fn marks(shown: &Shown<'_>) -> Vec<bool> {
    let &Shown { camera, film, lit, see_through, positions } = shown;
    let step = pixel_steps(camera, film.whole[1]);
    // Of three rows, what the eye makes of them: the pixel's own and those above and below.
    let is_marked = |pixel: usize, perceived: &[Vec<[f32; 3]>; 3]| {
        let beside = neighbours(film, pixel);
        let shows_other = |other: usize| (film.part[other] == 0) != (film.part[pixel] == 0);
        if beside.iter().flatten().any(|&other| shows_other(other)) {
            return true;
        }
        if film.part[pixel] == 0 {
            return false;
        }
        let x = pixel % film.width;
        let bends = |a: [f32; 3], b: [f32; 3]| {
            (0..3).any(|k| (a[k] + b[k] - 2.0 * perceived[1][x][k]).abs() > MOST_BEND)
        };
        let steps = |other: usize| {
            !positions.is_empty() && {
                let [n, m, p, q] =
                    [film.normal[pixel], film.normal[other], positions[pixel], positions[other]]
                        .map(|[x, y, z]| Vector3 { x, y, z });
                let apart = q - p;
                apart.dot(n).abs().min(apart.dot(m).abs()) > MOST_STEP * step.at(film.depth[pixel])
            }
        };
        see_through[pixel]
            || bends(perceived[1][x.saturating_sub(1)], perceived[1][(x + 1).min(film.width - 1)])
            || bends(perceived[0][x], perceived[2][x])
            || beside.into_iter().flatten().any(steps)
    };
    let mut is_asked = vec![false; film.part.len()];
    let width = film.width.max(1);
    let row_of = |y: usize| y * width..(y + 1) * width;
    let perceive = |y: usize| lit[row_of(y)].iter().map(|&light| perceived(light)).collect();
    is_asked.par_chunks_mut(width * ROWS_MARKED_TOGETHER).enumerate().for_each(|(band, rows)| {
        let top = band * ROWS_MARKED_TOGETHER;
        let around = top.saturating_sub(1) * width..(top * width + rows.len() + width).min(film.part.len());
        if film.part[around].iter().all(|&part| part == 0) {
            return;
        }
        let mut seen = [top.saturating_sub(1), top, (top + 1).min(film.height - 1)].map(perceive);
        for (y, row) in (top..).zip(rows.chunks_mut(width)) {
            if y > top {
                seen.rotate_left(1);
                seen[2] = perceive((y + 1).min(film.height - 1));
            }
            for (x, is_asked) in row.iter_mut().enumerate() {
                *is_asked = is_marked(y * width + x, &seen);
            }
        }
    });
    is_asked
}

/// How wide pixels are.
struct PixelSteps {
    at_eye: f32,
    by_depth: f32,
}

impl PixelSteps {
    /// Millimetres at a depth.
    fn at(&self, depth: f32) -> f32 {
        self.at_eye + self.by_depth * depth
    }
}

fn pixel_steps(camera: &Camera, height: usize) -> PixelSteps {
    let step = (2.0 * camera.half_height / height.max(1) as f64) as f32;
    if camera.orthographic {
        PixelSteps { at_eye: step, by_depth: 0.0 }
    } else {
        PixelSteps { at_eye: 0.0, by_depth: step }
    }
}
