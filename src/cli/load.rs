//! From INPUT to a scene: a CAD file is imported and baked in memory, a `.trimray` file is mapped.

use super::Failure;
use super::args::{BakeQuality, General};
use super::args_cache::KeptScenes;
use super::args_select::SelectionArguments;
use super::bake::provenance;
use super::progress::Progress;
use super::report;
use super::selection::{select_of_model, select_of_scene};
use crate::bake::{BakeOptions, KeptScene, bake, replicate_side_by_side};
use crate::brep::Model;
use crate::cache::{CacheFile, Key};
use crate::import::{Source, import};
use crate::scene::{Scene, SceneBuffers, Severity, TrimMethod, validate};
use anyhow::Context;
use std::path::Path;
use std::time::Instant;

/// A scene and where it lives.
pub(super) enum Loaded {
    /// With the BLAKE3 hash of what it was baked from.
    Baked(Box<SceneBuffers>, [u8; 32]),
    Mapped(Box<CacheFile>),
    /// Part of a mapped one.
    Selected(Box<CacheFile>, Box<KeptScene>),
}

impl Loaded {
    pub(super) fn scene(&self) -> Scene<'_> {
        match self {
            Self::Baked(buffers, _) => buffers.scene(),
            Self::Mapped(file) => file.scene(),
            Self::Selected(file, kept) => kept.of(&file.scene()),
        }
    }

    /// BLAKE3 of the CAD file that the scene comes from.
    pub(super) fn source_hash(&self) -> [u8; 32] {
        match self {
            Self::Baked(_, source_hash) => *source_hash,
            Self::Mapped(file) | Self::Selected(file, _) => file.provenance().source_hash,
        }
    }
}

/// What the caller does with the scene.
#[derive(Clone, Default)]
pub(super) struct Purpose {
    /// What of the model is taken.
    pub(super) selection: SelectionArguments,
    /// Whether f64 geometry is needed.
    pub(super) keep_f64: bool,
    /// Whether the model's edges are needed.
    pub(super) edges: bool,
    /// Whether a dropped face ends the command.
    pub(super) strict: bool,
    /// What trim queries of a model that is baked now search in.
    pub(super) trim_method: TrimMethod,
    /// How finely free-form faces of a model that is baked now are divided.
    pub(super) quality: BakeQuality,
    /// Copies along x, y and z of a model that is baked now.
    pub(super) copies: Option<[u32; 3]>,
    /// Scenes that were baked before; `None` to bake anew whatever there is.
    pub(super) kept_scenes: Option<KeptScenes>,
}

/// Whether the path names a baked scene.
pub(super) fn is_baked(path: &Path) -> bool {
    path.extension().is_some_and(|e| e.eq_ignore_ascii_case("trimray"))
}

/// Reads `path`, reports on stderr what was dropped, and obeys `--strict`.
pub(super) fn load(path: &Path, purpose: Purpose, general: &General) -> anyhow::Result<Loaded> {
    let loaded = if is_baked(path) {
        let start = Instant::now();
        let file = match &purpose.kept_scenes {
            Some(kept) => kept.store.open(path)?,
            None => CacheFile::open(path)?,
        };
        log::info!("opened in {:.2} s", start.elapsed().as_secs_f64());
        if purpose.edges && !file.scene().metadata.has_edges {
            let reason = format!(
                "{} was baked without edges: bake the model again with `trimray bake --edges`",
                path.display()
            );
            return Err(Failure::Usage(reason).into());
        }
        match select_of_scene(&file.scene(), &purpose.selection, path)? {
            Some(kept) => Loaded::Selected(Box::new(file), kept),
            None => Loaded::Mapped(Box::new(file)),
        }
    } else {
        find_or_bake(path, &purpose, general)?
    };
    let scene = loaded.scene();
    if !general.quiet {
        report::warn(path, scene.metadata, general.verbose > 0);
    }
    let findings = scene.metadata.findings.iter().filter(|f| f.severity == Severity::Dropped).count();
    if purpose.strict && findings > 0 {
        let dropped = scene.metadata.missing_faces(Severity::Dropped);
        let declared = scene.metadata.declared_faces;
        let path = path.display().to_string();
        return Err(Failure::Partial { path, dropped, declared, findings }.into());
    }
    Ok(loaded)
}

/// A scene that was kept, or a new one, which is kept if that is worth it.
fn find_or_bake(path: &Path, purpose: &Purpose, general: &General) -> anyhow::Result<Loaded> {
    let start = Instant::now();
    let (source, source_hash) = Source::open_hashed(path)?;
    let options = purpose.bake_options();
    let bake = || import_and_bake(path, &source, purpose, &options, general).map(Box::new);
    let Some(kept) = &purpose.kept_scenes else {
        return Ok(Loaded::Baked(bake()?, source_hash));
    };
    let how = format!("{:?}", (&options, &purpose.selection, purpose.copies, file_name(path)));
    let key = Key::new(source_hash, &how);
    if let Some(file) = kept.store.find(&key) {
        log::info!("found as it was baked before, in {:.2} s", start.elapsed().as_secs_f64());
        return Ok(Loaded::Mapped(Box::new(file)));
    }
    let buffers = bake()?;
    if start.elapsed().as_secs_f64() >= kept.least_seconds {
        let provenance = provenance(&options, source_hash);
        if let Err(error) = kept.store.keep(&key, &buffers.scene(), &provenance) {
            log::warn!("the baked scene is not kept: {error}; --no-cache does not try");
        }
    }
    Ok(Loaded::Baked(buffers, source_hash))
}

fn import_and_bake(
    path: &Path,
    source: &Source,
    purpose: &Purpose,
    options: &BakeOptions,
    general: &General,
) -> anyhow::Result<SceneBuffers> {
    let start = Instant::now();
    let model = source.scan()?.map();
    let model = select_and_copy(model, path, &purpose.selection, purpose.copies, options)?;
    let imported = Instant::now();
    let progress = Progress::new(format!("Baking {}", file_name(path)), general);
    let mut buffers = bake(&model, options, &|done, total| progress.tell(done, total));
    drop(progress);
    buffers.metadata.file_name = file_name(path);
    validate(&buffers.scene())
        .with_context(|| format!("{}: the baked scene is unsound; please report this", path.display()))?;
    log::info!(
        "imported in {:.2} s, baked in {:.2} s",
        (imported - start).as_secs_f64(),
        imported.elapsed().as_secs_f64()
    );
    Ok(buffers)
}

impl Purpose {
    pub(super) fn bake_options(&self) -> BakeOptions {
        BakeOptions {
            distortion: self.quality.distortion(),
            keep_f64: self.keep_f64,
            edges: self.edges,
            trim_method: self.trim_method,
            ..BakeOptions::default()
        }
    }
}

/// Imports a model, or what of it is wanted, once or as copies side by side.
pub(super) fn import_copies(
    path: &Path,
    selection: &SelectionArguments,
    copies: Option<[u32; 3]>,
    options: &BakeOptions,
) -> anyhow::Result<Model> {
    select_and_copy(import(path)?, path, selection, copies, options)
}

fn select_and_copy(
    mut model: Model,
    path: &Path,
    selection: &SelectionArguments,
    copies: Option<[u32; 3]>,
    options: &BakeOptions,
) -> anyhow::Result<Model> {
    select_of_model(&mut model, selection, path)?;
    let Some(copies) = copies else { return Ok(model) };
    replicate_side_by_side(model, copies, options).with_context(|| path.display().to_string())
}

fn file_name(path: &Path) -> String {
    path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default()
}

/// The error for a scene without faces.
pub(super) fn nothing(path: &Path, scene: &Scene<'_>, verb: &'static str) -> Failure {
    let reason = match scene.metadata.declared_faces {
        0 => "the file has no faces".to_owned(),
        declared if scene.metadata.missing_faces(Severity::Dropped) > 0 => {
            format!("all {declared} faces were dropped")
        }
        declared => format!("all {declared} faces are hidden"),
    };
    Failure::Nothing { path: path.display().to_string(), verb, reason }
}
