//! The flags that choose parts of a model, as clap sees them.

use super::pattern::Pattern;
use clap::Args;

/// What of the model is taken.
#[derive(Debug, Clone, Default, Args)]
pub(super) struct SelectionArguments {
    /// Take only what matches: a name or a path of the product tree, as `trimray info` shows it, with * and ?, or #123, the file's number of a part,
    /// body or face.
    ///
    /// What is below a match belongs to it. A pattern without / is compared with names, one with / with paths from the root; * and ? do not
    /// stand for /, but ** does. May be given several times.
    #[arg(long, value_name = "PATTERN", help_heading = "Selection")]
    pub(super) only: Vec<Pattern>,
    /// Leave out what matches, also of what --only takes. May be given several times.
    #[arg(long, value_name = "PATTERN", help_heading = "Selection")]
    pub(super) hide: Vec<Pattern>,
}

impl SelectionArguments {
    /// Whether everything is taken.
    pub(super) fn is_all(&self) -> bool {
        self.only.is_empty() && self.hide.is_empty()
    }
}
