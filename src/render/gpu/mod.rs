//! The wgpu tracer.
