//! The flags of the folder of baked scenes, as clap sees them.

use crate::cache::Store;
use clap::Args;
use std::path::PathBuf;

/// Bakes that take longer, seconds, are kept in the user's folder: below that reading one back saves nothing that anyone would notice.
const WORTH_KEEPING: f64 = 0.1;

/// Where scenes are kept from one run to the next.
#[derive(Debug, Clone, Default, Args)]
pub(super) struct CacheArguments {
    /// Keep what is baked from CAD files in this folder, and look there first [default: the user's folder for caches, trimray in it].
    ///
    /// A scene is found again by the file's contents, the options of the bake and the program; the folder is kept below 4 GB. What is found there is checked
    /// every time, in the user's own folder once, as `.trimray` files are, until they change.
    #[arg(long, value_name = "FOLDER", conflicts_with = "no_cache", help_heading = "Cache")]
    pub(super) cache_dir: Option<PathBuf>,
    /// Keep nothing, look for nothing that was kept, and check `.trimray` files as if they had never been opened.
    #[arg(long, help_heading = "Cache")]
    pub(super) no_cache: bool,
}

/// Scenes that were kept, and what more is.
#[derive(Debug, Clone)]
pub(super) struct KeptScenes {
    pub(super) store: Store,
    /// Seconds that a bake has to take to be kept.
    pub(super) least_seconds: f64,
}

impl CacheArguments {
    pub(super) fn kept_scenes(&self) -> Option<KeptScenes> {
        match &self.cache_dir {
            _ if self.no_cache => None,
            Some(folder) => Some(KeptScenes { store: Store::new(folder.clone()), least_seconds: 0.0 }),
            None => Store::of_user().map(|store| KeptScenes { store, least_seconds: WORTH_KEEPING }),
        }
    }
}
