//! From the model to the scene: nets, leaves, BVHs, trim trees; f64 until `narrow`.

mod bvh;
mod materials;
mod metadata;
mod narrow;
mod region;
mod trim_query;
#[cfg(test)]
mod trim_tests;
mod trim_tree;

use crate::brep::Model;
use crate::scene::SceneBuffers;
use crate::trimming::TrimOptions;

/// How to bake.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BakeOptions {
    /// The distortion ρ below which a net's sub-domain is a leaf.
    pub distortion: f64,
    /// How closely trims follow edges.
    pub trim: TrimOptions,
    /// Whether the scene carries f64 geometry beside the f32.
    pub keep_f64: bool,
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self { distortion: 0.125, trim: TrimOptions::default(), keep_f64: false }
    }
}

/// Bakes a model. Faces that cannot be baked are in the metadata's diagnostics, after the model's own.
///
/// The result depends on the model and the options alone, not on threads. `progress` is told (done, total) faces, from any thread.
pub fn bake(model: &Model, options: &BakeOptions, progress: &(dyn Fn(usize, usize) + Sync)) -> SceneBuffers {
    todo!()
}
