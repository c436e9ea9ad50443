//! From a scene to hits and pictures, on the CPU and on the GPU.

pub mod camera;
pub mod cpu;
mod framing;
#[cfg(feature = "gpu")]
pub mod gpu;
mod options;
mod ray;
pub mod reference;

pub use camera::{Camera, Viewpoint};
pub use framing::bounds;
pub use options::{Background, Exactness, RenderOptions, Sampling};
pub use ray::{Hit, Ray};
