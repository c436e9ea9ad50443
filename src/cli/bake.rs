//! `trimray bake`: a model preprocessed into a `.trimray` file.

use super::Failure;
use super::args::{Bake, General};
use super::load::{Purpose, is_baked, load, nothing};
use crate::bake::BakeOptions;
use crate::cache::{self, Provenance};
use std::io::Write;
use std::time::Instant;

pub(super) fn run(command: &Bake, general: &General) -> anyhow::Result<()> {
    let input = &command.input;
    if is_baked(input) {
        return Err(Failure::Usage(format!("{} is baked already", input.display())).into());
    }
    let output = command.output.clone().unwrap_or_else(|| input.with_extension("trimray"));
    if !is_baked(&output) {
        let reason = format!("{} must end in .trimray: that tells a baked file", output.display());
        return Err(Failure::Usage(reason).into());
    }
    let start = Instant::now();
    let purpose = Purpose {
        keep_f64: command.keep_f64,
        edges: command.edges,
        strict: command.import.strict,
        selection: command.selection.clone(),
        trim_method: command.trim_method,
        quality: command.bake_quality,
        copies: command.replicate,
        kept_scenes: None,
    };
    let options = purpose.bake_options();
    let loaded = load(input, purpose, general)?;
    let scene = loaded.scene();
    if scene.faces.is_empty() {
        return Err(nothing(input, &scene, "bake").into());
    }
    cache::write(&output, &scene, &provenance(&options, loaded.source_hash()))?;
    if !general.quiet {
        let source_size = std::fs::metadata(input).map_or(0, |m| m.len());
        let baked_size = std::fs::metadata(&output).map_or(0, |m| m.len());
        writeln!(
            std::io::stderr(),
            "{}: {} faces, {} from {} in {:.2} s",
            output.display(),
            scene.faces.len(),
            size_text(baked_size),
            size_text(source_size),
            start.elapsed().as_secs_f64()
        )?;
    }
    Ok(())
}

/// What a scene is baked from and how, for its file.
pub(super) fn provenance(options: &BakeOptions, source_hash: [u8; 32]) -> Provenance {
    Provenance {
        source_hash,
        distortion: options.distortion,
        trim_tolerance: options.trim.relative_tolerance,
    }
}

/// A size for people.
pub(super) fn size_text(bytes: u64) -> String {
    let bytes = bytes as f64;
    match bytes {
        b if b < 1e3 => format!("{b} B"),
        b if b < 1e6 => format!("{:.1} kB", b / 1e3),
        b if b < 1e9 => format!("{:.1} MB", b / 1e6),
        b => format!("{:.2} GB", b / 1e9),
    }
}
