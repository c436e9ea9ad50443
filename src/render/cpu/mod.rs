//! The CPU tracer: the kernels of `shaders/`, generic over f32 and f64.
//!
//! Data-oriented on purpose: ids and slices in, plain structs out, no recursion, no allocation per ray, stacks of fixed size. A function
//! here and the WGSL function of the same name are one algorithm in two texts, but for what changes no hit: the order of the walk and what it leaves
//! out (`bvh`, `trace`, `torus`).

#![allow(
    clippy::neg_cmp_op_on_partial_ord,
    reason = "negated on purpose: a comparison with what is not a number takes the safe way"
)]

pub(super) mod adaptive;
pub(super) mod analytic;
mod bands;
mod beam;
pub(super) mod bernstein;
mod beside;
pub(super) mod bsdf;
pub(super) mod bvh;
pub(super) mod camera;
mod choice;
pub(super) mod cover;
pub(super) mod curvature;
pub(super) mod environment;
pub(super) mod footprint;
pub(super) mod frames;
mod heat;
pub(super) mod hit;
mod isolate;
mod lanes;
mod leaf;
pub(super) mod light;
mod marks;
mod net;
mod newton;
mod occlusion;
mod packet;
mod packet_bvh;
pub(super) mod parity;
pub(super) mod path;
mod paths;
pub(super) mod pixels;
mod planes;
mod polish;
pub(super) mod probe;
mod queries;
pub(super) mod ray_space;
mod render;
pub(super) mod section;
pub(super) mod shade;
pub(super) mod shade_rays;
mod slab;
pub(super) mod sobol;
mod tally;
mod torus;
pub(super) mod trace;
pub(super) mod trim;
mod trim_curve;
pub(super) mod trim_study;
pub(super) mod vector;

#[cfg(test)]
mod adaptive_tests;
#[cfg(test)]
mod exactness_tests;
#[cfg(test)]
mod packet_tests;
#[cfg(test)]
pub(super) mod test_scenes;
#[cfg(test)]
mod tests;

pub use self::camera::{pixel_key, pixel_ray, sample_offset};
pub use self::choice::{Choice, choices};
pub use self::heat::render_trim_tests;
pub use self::paths::{render_paths, take_path_samples};
pub use self::probe::{first_distances, probe, probe_alone, probe_with};
pub use self::queries::{TrimQuery, Untrimmed, answer, answers_counted, count_inside, trim_queries};
pub use self::render::render;
#[cfg(feature = "gpu")]
pub(super) use self::render::{find_centers, take_samples};
pub use self::tally::{RayCounts, Step, count_steps, count_steps_of_picture};
pub use self::trim::{trim_counted, trim_inside};
pub use self::trim_study::TrimCounts;
pub use frames::Kernel;

/// Which number type the kernels compute in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Precision {
    /// As on the GPU.
    F32,
    /// Needs a scene with f64 arrays.
    F64,
}

/// The net of hits on analytic faces.
pub const NO_NET: u32 = u32::MAX;
