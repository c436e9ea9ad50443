//! The wgpu tracer: the kernels of `shaders/`, which are the twins of [`super::cpu`] in f32.
//!
//! [`Gpu`] is a device with its pipelines, [`GpuScene`] a scene on it; [`Gpu::render`] and [`Gpu::probe`] mean what their namesakes on
//! the CPU mean. Nothing here panics on a device's whim: a driver that is missing, a scene that is too large, a lost device are
//! errors, and the caller falls back to the CPU.

mod buffers;
mod device;
mod grouping;
mod held;
mod kernels;
mod paths;
mod picture;
mod rays;
mod trims;

pub use buffers::{GpuScene, SCENE_BINDINGS};
pub use device::{AdapterChoice, Gpu};
pub use grouping::Grouping;
pub use held::HeldWork;
pub use kernels::{Entry, FUNCTION_FILES, PATH_FILES, Specialisation, software_source, source};
pub use trims::TrimQuery;

/// Why the GPU cannot be used, or could not finish.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum GpuError {
    /// No adapter counts.
    #[error("no usable GPU: {0}")]
    NoAdapter(String),
    /// The adapter could not be opened.
    #[error("cannot open the GPU: {0}")]
    Device(String),
    /// An array of the scene does not fit a binding.
    #[error("{array} takes {bytes} bytes, more than the {most} that this GPU can bind")]
    TooLarge {
        /// The array.
        array: &'static str,
        /// Its size.
        bytes: u64,
        /// The device's limit.
        most: u64,
    },
    /// The device has no memory left.
    #[error("the GPU is out of memory")]
    OutOfMemory,
    /// A kernel does not compile or a call was wrong.
    #[error("the GPU refused the work: {0}")]
    Invalid(String),
    /// A software device ended a kernel's loops before their end.
    #[error("this software GPU gives up on scenes as complex as this one")]
    Incomplete,
    /// The device was lost, or took too long.
    #[error("the GPU was lost: {0}")]
    Lost(String),
}
