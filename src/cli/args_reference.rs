//! Comparison with a reference as clap sees it.

use super::args_files::{parse_share, parse_tolerance};
use clap::Args;
use std::path::PathBuf;

/// Comparison with a reference.
#[derive(Debug, Args)]
#[command(next_help_heading = "Comparison")]
pub(super) struct ReferenceArguments {
    /// Compare the picture with this one, of the same format, as `trimray diff` does; it is written in any case. Ends with exit code 5 where they differ.
    #[arg(long, value_name = "FILE")]
    pub(super) reference: Option<PathBuf>,
    /// The greatest difference of a channel that counts as none; channels of PNG files count from 0 to 1.
    #[arg(long, value_name = "T", default_value_t = 0.0, value_parser = parse_tolerance, requires = "reference")]
    pub(super) reference_tolerance: f64,
    /// The share of pixels that may differ by more.
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = parse_share, requires = "reference")]
    pub(super) reference_max_outliers: f64,
    /// Write a picture of where they differ: black where they are the same, red where they differ most.
    #[arg(long, value_name = "FILE.png", requires = "reference")]
    pub(super) reference_heat: Option<PathBuf>,
}
