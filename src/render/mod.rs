//! From a scene to hits and pictures, on the CPU and on the GPU.

pub mod camera;
pub mod cpu;
mod environment;
mod first_hits;
mod framing;
#[cfg(feature = "gpu")]
pub mod gpu;
mod ground;
pub mod lines;
mod named_view;
mod options;
mod overrides;
mod paths;
mod ray;
pub mod reference;
pub mod section;
#[cfg(test)]
mod section_tests;
mod sectioned;
mod style;

pub use camera::{Camera, Viewpoint};
pub use environment::Environment;
pub use framing::bounds;
pub use ground::lowest;
pub use named_view::{NAMED_VIEWS, NamedView, REVIEW};
pub use options::{Background, Coherence, Exactness, NetSearch, RenderOptions, Sampling};
pub use overrides::{Overridden, Override, PartOverride, override_looks};
pub use paths::{Ground, PathOptions};
pub use ray::{Hit, Ray};
pub use sectioned::{CAP, first_in_section};
pub use style::Style;
