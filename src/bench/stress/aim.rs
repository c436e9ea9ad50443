//! Rays made for a scene: near tangents, through its features, along the axes, from afar.

use super::super::rays::{on_sphere, unit};
use crate::geometry::{ParameterBox, Surface};
use crate::render::Ray;
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Exponents of ten of the greatest and the least |cos| of a ray that grazes.
const COSINES: [f64; 2] = [-1.0, -7.0];

/// Exponents of ten of the least and the greatest distance of a ray from the point that it passes, in radii of the scene.
const OFFSETS: [f64; 2] = [-10.0, -3.0];

/// How far rays start from their targets, in radii of the scene: outside of its sphere wherever the target is.
const START: f64 = 4.0;

/// What the rays of a scene are aimed at. Directions and choices are uniform, cosines and offsets uniform in their logarithms.
#[derive(Debug, Clone)]
pub(super) enum Aim {
    /// Points of surfaces, nearly along them.
    Grazing(Vec<(Surface, ParameterBox)>),
    /// Exactly these points.
    Through(Vec<DVec3>),
    /// Places beside these points.
    Past(Vec<DVec3>),
    /// Exactly these points, along an axis; the other components of the direction are +0 or −0.
    Along(Vec<DVec3>),
    /// Places within `spread` of these points, from `distance`; both in radii of the scene.
    From {
        /// Where to.
        points: Vec<DVec3>,
        /// At least [`START`], so that rays start outside.
        distance: f64,
        /// How far beside.
        spread: f64,
    },
}

/// Ray `index` of those aimed at a scene whose sphere has the radius `radius`.
pub(super) fn aimed_ray(aim: &Aim, radius: f64, index: u64) -> Ray {
    let number = |stream: u64| unit(index, stream);
    let chosen = |points: &[DVec3]| points[place(number(0), points.len())];
    let direction = on_sphere(number(1), number(2));
    let beside = on_sphere(number(3), number(4));
    let to = |target: DVec3, direction: DVec3, distance: f64| Ray {
        origin: target - direction * (distance * radius),
        direction,
    };
    match aim {
        Aim::Grazing(windows) => {
            let (surface, window) = &windows[place(number(0), windows.len())];
            let uv = window.min + (window.max - window.min) * DVec2::new(number(1), number(2));
            let at = surface.derivatives(uv);
            let normal = at.du.cross(at.dv).normalize_or_zero();
            let (first, second) = normal.any_orthonormal_pair();
            let (sin, cos) = (TAU * number(3)).sin_cos();
            let cosine = 10.0_f64.powf(between(COSINES, number(4)));
            let sign = if number(5) < 0.5 { -1.0 } else { 1.0 };
            let across = (first * cos + second * sin) * (1.0 - cosine * cosine).sqrt();
            to(at.point, (across + normal * (sign * cosine)).normalize(), START)
        }
        Aim::Through(points) => to(chosen(points), direction, START),
        Aim::Past(points) => {
            let offset = radius * 10.0_f64.powf(between(OFFSETS, number(5)));
            to(chosen(points) + beside * offset, direction, START)
        }
        Aim::Along(points) => {
            let zero = |stream: u64| if number(stream) < 0.5 { 0.0 } else { -0.0 };
            let mut direction = DVec3::new(zero(5), zero(6), zero(7));
            direction[place(number(8), 3)] = if number(9) < 0.5 { -1.0 } else { 1.0 };
            to(chosen(points), direction, START)
        }
        Aim::From { points, distance, spread } => {
            to(chosen(points) + beside * (spread * radius * number(5)), direction, *distance)
        }
    }
}

/// The index of one of `count` that belongs to a number in [0, 1).
fn place(number: f64, count: usize) -> usize {
    ((number * count as f64) as usize).min(count - 1)
}

fn between([from, to]: [f64; 2], share: f64) -> f64 {
    from + (to - from) * share
}
