//! trimray reads trimmed B-rep models from STEP and IGES, bakes them into one memory-mappable file and ray traces
//! the exact surfaces, on the GPU and on the CPU. Nothing is tessellated anywhere.
//!
//! # Bird's eye
//!
//! ```text
//! bytes ─step, iges→ brep::Model ─trimming, bake→ scene::Scene ─cache→ file ─mmap→ scene::Scene ─render→ image::Film → exr, png
//!              f64, exact                   Pod arrays, f32 (+ f64 on request)
//! ```
//!
//! There are two waists. All format mess ends in [`brep::Model`]: resolved, owned, f64, in millimetres, without
//! pointers into the file. All geometry mess ends in [`scene::Scene`]: flat Pod arrays that are at once the cache
//! file, the memory map and the GPU's buffers.
//!
//! # The chain
//!
//! Imports go one way: `numeric ◀ geometry ◀ brep ◀ {step, iges} ◀ import`, `brep ◀ trimming`, `numeric ◀ scene ◀ cache`,
//! `brep, trimming, scene ◀ bake`, `numeric ◀ image`, `scene, image ◀ render`, everything `◀ bench`, `cli` `◀ main`.
//! `tests/architecture.rs` holds it.
//!
//! # Invariants
//!
//! * Nothing to the right of [`scene::Scene`] knows a knot vector; nothing to the right of [`brep::Model`] knows STEP or IGES.
//! * Only `cli`, `cache`, `image` and `import` touch files. Only `render::gpu` names wgpu.
//! * No input can panic the importer: a broken statement costs itself, a broken face costs itself, and both are in
//!   the diagnostics.
//! * Every face that a file declares is either in the model or in the diagnostics.
//! * A cache file is validated before use: every count, index and bound.

pub mod bake;
pub mod bench;
pub mod brep;
pub mod cache;
pub mod cli;
pub mod geometry;
pub mod iges;
pub mod image;
pub mod import;
pub mod numeric;
pub mod render;
pub mod scene;
pub mod step;
pub mod trimming;
