//! `trimray diff`: how much two pictures differ. `trimray merge`: tiles to a picture.

use super::Failure;
use super::args_files::{Diff, Merge};
use crate::image::{BitDepth, ImageDifference, Numbers, diff, encode_film, merge_exr, merge_png, write_file};
use anyhow::Context;
use serde::Serialize;
use std::io::Write;
use std::path::Path;

/// A format of pictures.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Format {
    Png,
    Exr,
}

fn format(path: &Path) -> Result<Format, Failure> {
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("png") => Ok(Format::Png),
        Some("exr") => Ok(Format::Exr),
        _ => Err(Failure::Usage(format!("{} is neither .png nor .exr", path.display()))),
    }
}

/// The format of all of them.
fn common_format<'p>(paths: impl IntoIterator<Item = &'p Path>) -> Result<Format, Failure> {
    let formats: Vec<Format> = paths.into_iter().map(format).collect::<Result<_, _>>()?;
    match formats.windows(2).all(|pair| pair[0] == pair[1]) {
        true => Ok(formats[0]),
        false => Err(Failure::Usage("the files are not all of one format".to_owned())),
    }
}

fn read(path: &Path) -> anyhow::Result<Vec<u8>> {
    std::fs::read(path).with_context(|| path.display().to_string())
}

/// The answer. Names of fields are those of the JSON object: they stay. A difference that is infinite is null.
#[derive(Serialize)]
struct Report<'r> {
    a: String,
    b: String,
    width: usize,
    height: usize,
    tolerance: f64,
    /// Pixels that differ by more than the tolerance.
    outliers: usize,
    greatest: f64,
    within: bool,
    channels: Vec<ChannelReport<'r>>,
}

#[derive(Serialize)]
struct ChannelReport<'r> {
    name: &'r str,
    greatest: f64,
    mean: f64,
    outliers: usize,
}

pub(super) fn run_diff(command: &Diff) -> anyhow::Result<()> {
    let paths = [command.a.as_path(), command.b.as_path()];
    let numbers = match common_format(paths)? {
        Format::Png => Numbers::of_png,
        Format::Exr => Numbers::of_exr,
    };
    if let Some(heat) = &command.heat
        && format(heat)? != Format::Png
    {
        return Err(Failure::Usage(format!("{} must end in .png", heat.display())).into());
    }
    let load = |path: &Path| numbers(&read(path)?).with_context(|| path.display().to_string());
    let (a, b) = (load(&command.a)?, load(&command.b)?);
    let differ = |reason: String| {
        let [a, b] = paths.map(|path| path.display().to_string());
        Failure::Differ { a, b, reason }
    };
    let found = diff(&a, &b, command.tolerance).map_err(|error| differ(error.to_string()))?;
    let within = found.outliers as f64 <= command.max_outliers * found.pixels as f64;
    if let Some(heat) = &command.heat {
        write_file(heat, &encode_film(&found.heat(a.width), BitDepth::Eight)?)?;
    }
    write_report(command, &a, &found, within)?;
    if within {
        return Ok(());
    }
    Err(differ(format!("{} of {} pixels by more than {}", found.outliers, found.pixels, command.tolerance))
        .into())
}

fn write_report(command: &Diff, a: &Numbers, found: &ImageDifference, within: bool) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    if command.json {
        let channels = found.channels.iter().map(|channel| ChannelReport {
            name: &channel.name,
            greatest: channel.greatest,
            mean: channel.mean,
            outliers: channel.outliers,
        });
        let report = Report {
            a: command.a.display().to_string(),
            b: command.b.display().to_string(),
            width: a.width,
            height: a.height,
            tolerance: command.tolerance,
            outliers: found.outliers,
            greatest: found.greatest(),
            within,
            channels: channels.collect(),
        };
        serde_json::to_writer_pretty(&mut out, &report).map_err(std::io::Error::from)?;
        writeln!(out)?;
        return Ok(());
    }
    writeln!(out, "{:<18}{:>12}{:>12}{:>12}", "channel", "greatest", "mean", "outliers")?;
    for channel in &found.channels {
        let [greatest, mean] = [channel.greatest, channel.mean].map(|x| format!("{x:.3e}"));
        writeln!(out, "{:<18}{greatest:>12}{mean:>12}{:>12}", channel.name, channel.outliers)?;
    }
    let share = found.outliers as f64 / found.pixels.max(1) as f64 * 100.0;
    writeln!(
        out,
        "{} of {} pixels ({share:.4} %) differ by more than {}",
        found.outliers, found.pixels, command.tolerance
    )?;
    Ok(())
}

pub(super) fn run_merge(command: &Merge) -> anyhow::Result<()> {
    let paths = command.tiles.iter().map(std::path::PathBuf::as_path).chain([command.output.as_path()]);
    let merge = match common_format(paths)? {
        Format::Png => merge_png,
        Format::Exr => merge_exr,
    };
    let tiles = command.tiles.iter().map(|path| read(path)).collect::<anyhow::Result<Vec<_>>>()?;
    write_file(&command.output, &merge(&tiles)?)?;
    Ok(())
}
