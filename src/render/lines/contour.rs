//! Contours: where one surface ends before another, or before nothing.
//!
//! Between neighbouring pixel centres the depth jumps where the hit of one is not explained by the tangent plane of the other, either way. A jump is
//! halved with exact rays until the place is known to 1/256 of a pixel; what is steep but whole has no jump left by then.

use super::contour_cells::{Crossing, lines_of_cell};
use super::screen::Screen;
use super::stroke::Near;
use super::{Ends, FirstHits};
use crate::image::Film;
use crate::render::sectioned::CAP;
use crate::render::{Hit, Ray};
use glam::{DVec2, DVec3};
use rayon::prelude::*;
use std::collections::HashMap;

/// Halvings of the way between two pixels.
const HALVINGS: usize = 8;

/// A lesser jump, in widths of a pixel, is none.
const LEAST_JUMP: f64 = 0.2;

/// Contours this near to a drawn edge, pixels, are its own.
const ON_EDGE: f64 = 0.4;

/// What is seen at a place of the picture.
#[derive(Clone, Copy)]
struct Sight {
    at: DVec2,
    ray: Ray,
    /// Distance along the ray and normal towards the eye.
    hit: Option<(f64, DVec3)>,
    /// 1 + the instance whose cap is seen; 0 where it is none.
    cap: u32,
}

/// Caps whose normals differ by more than this cosine are in different planes.
const SAME_PLANE: f64 = 1.0 - 1e-6;

impl Sight {
    /// What a ray's first hit shows.
    fn new(at: DVec2, ray: Ray, hit: Option<&Hit>) -> Self {
        let towards_eye = |normal: DVec3| if normal.dot(ray.direction) > 0.0 { -normal } else { normal };
        let cap = hit.filter(|hit| hit.face == CAP).map_or(0, |hit| hit.instance + 1);
        Self { at, ray, hit: hit.map(|hit| (hit.t, towards_eye(hit.normal))), cap }
    }

    /// How far along `ray` the tangent plane at this hit is.
    fn plane_along(&self, ray: &Ray) -> Option<f64> {
        let (t, normal) = self.hit?;
        Some((self.ray.at(t) - ray.origin).dot(normal) / ray.direction.dot(normal))
    }
}

/// How far it is from what is seen at one place to what is seen at another, in widths of a pixel; infinite where only one has a hit and as good as infinite
/// where a cap ends or meets another, 0 where nothing does.
#[derive(Debug, Clone, Copy)]
struct Jump {
    /// Along the rays: what the tangent plane of neither explains.
    depth: f64,
    /// Of each from the other's tangent plane, the farther one. The plane of a surface seen edge on may meet by chance what lies behind it, but the plane
    /// of that does not meet the surface; and nothing is far from the plane of a surface that goes on, however steep.
    apart: f64,
}

impl Jump {
    const NONE: Self = Self { depth: 0.0, apart: 0.0 };

    fn surely(pixels: f64) -> Self {
        Self { depth: pixels, apart: pixels }
    }

    fn is_some(&self) -> bool {
        self.depth > LEAST_JUMP || self.apart > LEAST_JUMP
    }
}

/// The jump between two places.
fn jump(screen: &Screen<'_>, a: &Sight, b: &Sight) -> Jump {
    let (Some((t_a, normal_a)), Some((t_b, normal_b))) = (a.hit, b.hit) else {
        return if a.hit.is_some() == b.hit.is_some() { Jump::NONE } else { Jump::surely(f64::INFINITY) };
    };
    if a.cap != b.cap || a.cap != 0 && normal_a.dot(normal_b) < SAME_PLANE {
        return Jump::surely(f64::MAX);
    }
    let misses = |from: &Sight, to: &Sight, t: f64| {
        from.plane_along(&to.ray).map_or(f64::INFINITY, |explained| (explained - t).abs())
    };
    let pixel = screen.pixel_size(t_a.min(t_b));
    let between = b.ray.at(t_b) - a.ray.at(t_a);
    Jump {
        depth: misses(a, b, t_b).min(misses(b, a, t_a)) / pixel,
        apart: normal_a.dot(between).abs().max(normal_b.dot(between).abs()) / pixel,
    }
}

/// The contours of what a film shows that no drawn edge shows.
pub(super) fn contours<E>(
    screen: &Screen<'_>,
    film: &Film,
    near: &Near,
    first_hits: &mut FirstHits<'_, E>,
) -> Result<Vec<Ends>, E> {
    let Film { width, height, corner: [left, top], .. } = *film;
    let sight = |x: usize, y: usize| {
        let at = DVec2::new((left + x) as f64 + 0.5, (top + y) as f64 + 0.5);
        let ray = screen.ray(at);
        let pixel = y * width + x;
        let hit = (film.part[pixel] != 0).then(|| {
            let normal = DVec3::from_array(film.normal[pixel].map(f64::from));
            (f64::from(film.depth[pixel]) / screen.depth_of(&ray), normal)
        });
        let cap = if film.face[pixel] == 0 { film.part[pixel] } else { 0 };
        Sight { at, ray, hit, cap }
    };
    let in_row = |y: usize| {
        let pairs = (0..width)
            .flat_map(move |x| [(Side::Right, x + 1, y), (Side::Below, x, y + 1)].map(|to| (x, to)));
        let inside = pairs.filter(move |(_, (_, x, y))| *x < width && *y < height);
        inside.filter_map(move |(x, (side, to_x, to_y))| {
            let (from, to) = (sight(x, y), sight(to_x, to_y));
            jump(screen, &from, &to).is_some().then_some(Open { side, pixel: y * width + x, from, to })
        })
    };
    let mut open: Vec<Open> = (0..height).into_par_iter().flat_map_iter(in_row).collect();
    halve(screen, &mut open, first_hits)?;
    let crossings: HashMap<(Side, usize), Crossing> = open.iter().map(Open::crossing).collect();
    // The cells on both sides of each crossing, by their upper left pixel.
    let mut cells: Vec<usize> = open
        .iter()
        .flat_map(|open| match open.side {
            Side::Right => [Some(open.pixel), open.pixel.checked_sub(width)],
            Side::Below => [Some(open.pixel), (open.pixel % width).checked_sub(1).map(|_| open.pixel - 1)],
        })
        .flatten()
        .filter(|cell| cell % width + 1 < width && cell / width + 1 < height)
        .collect();
    cells.sort_unstable();
    cells.dedup();
    let mut lines = Vec::new();
    for cell in cells {
        let sides =
            [(Side::Right, cell), (Side::Below, cell + 1), (Side::Right, cell + width), (Side::Below, cell)];
        lines_of_cell(sides.map(|side| crossings.get(&side).copied()), near, &mut lines);
    }
    lines.retain(|&[a, b]| ![a, 0.5 * (a + b), b].iter().all(|&place| near.is_near(place, ON_EDGE)));
    Ok(lines)
}

/// Which neighbour of a pixel.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
enum Side {
    Right,
    Below,
}

/// Two places between which something ends, on the way from a pixel to its neighbour.
struct Open {
    side: Side,
    pixel: usize,
    from: Sight,
    to: Sight,
}

impl Open {
    fn crossing(&self) -> ((Side, usize), Crossing) {
        let distances = [self.from, self.to].into_iter().filter_map(|sight| sight.hit).map(|hit| hit.0);
        let depth = distances.fold(f64::INFINITY, f64::min);
        ((self.side, self.pixel), Crossing { at: 0.5 * (self.from.at + self.to.at), depth })
    }
}

/// Narrows each pair of places down to where the jump is; pairs without one are dropped.
fn halve<E>(screen: &Screen<'_>, open: &mut Vec<Open>, first_hits: &mut FirstHits<'_, E>) -> Result<(), E> {
    for _ in 0..HALVINGS {
        let middles: Vec<DVec2> = open.iter().map(|open| 0.5 * (open.from.at + open.to.at)).collect();
        let rays: Vec<Ray> = middles.iter().map(|&at| screen.ray(at)).collect();
        let hits = first_hits(&rays)?;
        let mut kept = Vec::with_capacity(open.len());
        for ((open, at), (ray, hits)) in open.drain(..).zip(middles).zip(rays.into_iter().zip(hits)) {
            let middle = Sight::new(at, ray, hits.first());
            // Before it ends a surface may turn away so fast that this looks like a lesser jump.
            let [first, second] = [jump(screen, &open.from, &middle), jump(screen, &middle, &open.to)];
            if first.is_some() || second.is_some() {
                let (from, to) =
                    if first.apart >= second.apart { (open.from, middle) } else { (middle, open.to) };
                kept.push(Open { from, to, ..open });
            }
        }
        *open = kept;
    }
    // Ends that are still what the film showed are asked again: at the border of a face it may err, and all of a ray's hits know better.
    let rays: Vec<Ray> = open.iter().flat_map(|open| [open.from.ray, open.to.ray]).collect();
    let hits = first_hits(&rays)?;
    for (open, hits) in open.iter_mut().zip(hits.chunks_exact(2)) {
        open.from = Sight::new(open.from.at, open.from.ray, hits[0].first());
        open.to = Sight::new(open.to.at, open.to.ray, hits[1].first());
    }
    open.retain(|open| jump(screen, &open.from, &open.to).depth > LEAST_JUMP);
    Ok(())
}
