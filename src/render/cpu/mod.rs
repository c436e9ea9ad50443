//! The CPU tracer: the kernels of `shaders/`, generic over f32 and f64.

use super::{Camera, Hit, Ray, RenderOptions};
use crate::image::Film;
use crate::scene::Scene;

/// Which number type the kernels compute in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// As on the GPU.
    F32,
    /// Needs a scene with f64 arrays.
    F64,
}

/// All hits of each ray, sorted by t; or only the first of each.
pub fn probe(scene: &Scene<'_>, rays: &[Ray], precision: Precision, first_only: bool) -> Vec<Vec<Hit>> {
    todo!()
}

/// Renders a picture; `progress` is told (done, total) units of work.
pub fn render(
    scene: &Scene<'_>,
    camera: &Camera,
    options: &RenderOptions,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Film {
    todo!()
}
