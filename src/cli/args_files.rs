//! The flags of commands that work on pictures alone, as clap sees them.

use clap::Args;
use std::path::PathBuf;

/// Compares two pictures number by number.
///
/// Channels of PNG files count from 0 to 1, those of EXR files are taken as they are. Ends with exit code 5 where the pictures differ.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  trimray diff before.png after.png
  trimray diff cpu.png gpu.png --tolerance 0.02 --max-outliers 0.001 --heat where.png")]
pub(super) struct Diff {
    /// A PNG or EXR file.
    #[arg(value_name = "A")]
    pub(super) a: PathBuf,
    /// A file of the same format.
    #[arg(value_name = "B")]
    pub(super) b: PathBuf,
    /// The greatest difference of a channel that counts as none.
    #[arg(long, value_name = "T", default_value_t = 0.0, value_parser = parse_tolerance)]
    pub(super) tolerance: f64,
    /// The share of pixels that may differ by more.
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, value_parser = parse_share)]
    pub(super) max_outliers: f64,
    /// Write a picture of where they differ: black where they are the same, red where they differ most.
    #[arg(long, value_name = "FILE.png")]
    pub(super) heat: Option<PathBuf>,
    /// The numbers as one JSON object.
    #[arg(long)]
    pub(super) json: bool,
}

/// Joins the tiles of a picture, as `render --tile` and `--cropwindow` write them: the file is the same as that of the whole picture rendered at once.
#[derive(Debug, Args)]
#[command(after_help = "\
Examples:
  for i in 1 2 3 4; do trimray render plant.trimray -o tile$i.exr --tile $i/4; done
  trimray merge tile1.exr tile2.exr tile3.exr tile4.exr -o plant.exr")]
pub(super) struct Merge {
    /// PNG or EXR files, all of one format, that cover the whole picture, in any order.
    #[arg(required = true, value_name = "TILE")]
    pub(super) tiles: Vec<PathBuf>,
    /// The file to write, of the same format.
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: PathBuf,
}

pub(super) fn parse_tolerance(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(tolerance) if tolerance >= 0.0 && tolerance.is_finite() => Ok(tolerance),
        _ => Err("expected a number that is not negative".into()),
    }
}

pub(super) fn parse_share(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if (0.0..=1.0).contains(&share) => Ok(share),
        _ => Err("expected a share from 0 to 1".into()),
    }
}
