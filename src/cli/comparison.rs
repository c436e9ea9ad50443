//! Two pictures side by side: formats by extension, what they may differ by, and what is told of it.

use super::Failure;
use crate::image::{BitDepth, ImageDifference, ImageError, Numbers, diff, encode_film, write_file};
use anyhow::Context;
use serde::Serialize;
use std::io::Write;
use std::path::Path;

/// A format of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Format {
    Png,
    Exr,
}

impl Format {
    /// That of a file, by its extension.
    pub(super) fn of(path: &Path) -> Result<Self, Failure> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        match extension.as_deref() {
            Some("png") => Ok(Self::Png),
            Some("exr") => Ok(Self::Exr),
            _ => Err(Failure::Usage(format!("{} is neither .png nor .exr", path.display()))),
        }
    }

    /// The numbers in the bytes of a file.
    pub(super) fn numbers(self, bytes: &[u8]) -> Result<Numbers, ImageError> {
        match self {
            Self::Png => Numbers::of_png(bytes),
            Self::Exr => Numbers::of_exr(bytes),
        }
    }
}

/// Reads a whole file.
pub(super) fn read(path: &Path) -> anyhow::Result<Vec<u8>> {
    std::fs::read(path).with_context(|| path.display().to_string())
}

/// The numbers in a file of the format.
pub(super) fn load(path: &Path, format: Format) -> anyhow::Result<Numbers> {
    format.numbers(&read(path)?).with_context(|| path.display().to_string())
}

/// What two pictures may differ by, and where it is shown.
#[derive(Debug, Clone, Copy)]
pub(super) struct Limits<'l> {
    /// The greatest difference of a channel that counts as none.
    pub(super) tolerance: f64,
    /// The share of pixels that may differ by more.
    pub(super) max_outliers: f64,
    /// A PNG file of where they differ.
    pub(super) heat: Option<&'l Path>,
}

impl Limits<'_> {
    /// Refuses a picture of differences that is no PNG file.
    pub(super) fn check(&self) -> Result<(), Failure> {
        match self.heat {
            Some(heat) if Format::of(heat)? != Format::Png => {
                Err(Failure::Usage(format!("{} must end in .png", heat.display())))
            }
            _ => Ok(()),
        }
    }
}

/// The answer. Names of fields are those of the JSON object: they stay. A difference that is infinite is null.
#[derive(Debug, Serialize)]
pub(super) struct Comparison {
    a: String,
    b: String,
    width: usize,
    height: usize,
    tolerance: f64,
    /// Pixels that differ by more than the tolerance.
    outliers: usize,
    greatest: f64,
    within: bool,
    channels: Vec<ChannelReport>,
}

#[derive(Debug, Serialize)]
struct ChannelReport {
    name: String,
    greatest: f64,
    mean: f64,
    outliers: usize,
}

impl Comparison {
    /// Compares two pictures by their names and numbers, and shows where they differ if that is asked for.
    ///
    /// # Errors
    ///
    /// They have not the same pixels or channels; the picture of differences cannot be written.
    pub(super) fn new([a, b]: [(&str, &Numbers); 2], limits: &Limits<'_>) -> anyhow::Result<Self> {
        let differ = |reason: String| Failure::Differ { a: a.0.to_owned(), b: b.0.to_owned(), reason };
        let found = diff(a.1, b.1, limits.tolerance).map_err(|error| differ(error.to_string()))?;
        if let Some(heat) = limits.heat {
            write_file(heat, &encode_film(&found.heat(a.1.width), BitDepth::Eight)?)?;
        }
        let within = found.outliers as f64 <= limits.max_outliers * found.pixels as f64;
        let greatest = found.greatest();
        let ImageDifference { outliers, channels, .. } = found;
        let channels = channels.into_iter().map(|channel| ChannelReport {
            name: channel.name,
            greatest: channel.greatest,
            mean: channel.mean,
            outliers: channel.outliers,
        });
        Ok(Self {
            a: a.0.to_owned(),
            b: b.0.to_owned(),
            width: a.1.width,
            height: a.1.height,
            tolerance: limits.tolerance,
            outliers,
            greatest,
            within,
            channels: channels.collect(),
        })
    }

    /// Fails where the pictures differ by more than they may.
    pub(super) fn verdict(&self) -> Result<(), Failure> {
        if self.within {
            return Ok(());
        }
        let pixels = self.width * self.height;
        let reason = format!("{} of {pixels} pixels by more than {}", self.outliers, self.tolerance);
        Err(Failure::Differ { a: self.a.clone(), b: self.b.clone(), reason })
    }

    /// Writes a table of the channels and a sentence.
    pub(super) fn write_table(&self, out: &mut impl Write) -> std::io::Result<()> {
        writeln!(out, "{:<18}{:>12}{:>12}{:>12}", "channel", "greatest", "mean", "outliers")?;
        for channel in &self.channels {
            let [greatest, mean] = [channel.greatest, channel.mean].map(|x| format!("{x:.3e}"));
            writeln!(out, "{:<18}{greatest:>12}{mean:>12}{:>12}", channel.name, channel.outliers)?;
        }
        let pixels = self.width * self.height;
        let share = self.outliers as f64 / pixels.max(1) as f64 * 100.0;
        let (outliers, tolerance) = (self.outliers, self.tolerance);
        writeln!(out, "{outliers} of {pixels} pixels ({share:.4} %) differ by more than {tolerance}")
    }
}
