//! The fixtures, baked with their f64 geometry.

use std::path::{Path, PathBuf};
use trimray::bake::{BakeOptions, bake};
use trimray::brep::Model;
use trimray::import::import;
use trimray::scene::SceneBuffers;

/// All that are STEP files, in order.
pub fn fixtures() -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");
    let entries = std::fs::read_dir(folder).expect("fixtures can be listed");
    let models = entries.map(|entry| entry.expect("an entry").path().join("model.step"));
    let mut models: Vec<PathBuf> = models.filter(|path| path.exists()).collect();
    models.sort();
    models
}

/// A file's model and scene.
pub fn baked(path: &Path) -> (Model, SceneBuffers) {
    let model = import(path).expect("a STEP file");
    let buffers = bake(&model, &BakeOptions { keep_f64: true, ..BakeOptions::default() }, &|_, _| {});
    (model, buffers)
}
