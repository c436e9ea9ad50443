//! From a scene to hits and pictures, on the CPU and on the GPU.

pub mod camera;
pub mod cpu;
mod framing;
#[cfg(feature = "gpu")]
pub mod gpu;
pub mod lines;
mod options;
mod ray;
pub mod reference;
pub mod section;
#[cfg(test)]
mod section_tests;
mod sectioned;
mod style;

pub use camera::{Camera, Viewpoint};
pub use framing::bounds;
pub use options::{Background, Exactness, RenderOptions};
pub use ray::{Hit, Ray};
pub use sectioned::{CAP, first_in_section};
pub use style::Style;
