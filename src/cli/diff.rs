//! `trimray diff`: how much two pictures differ. `trimray merge`: tiles to a picture.

use super::Failure;
use super::args_files::{Diff, Merge};
use super::comparison::{Comparison, Format, Limits, load, read};
use crate::image::{merge_exr, merge_png, write_file};
use std::io::Write;
use std::path::Path;

/// The format of all of them.
fn common_format<'p>(paths: impl IntoIterator<Item = &'p Path>) -> Result<Format, Failure> {
    let formats: Vec<Format> = paths.into_iter().map(Format::of).collect::<Result<_, _>>()?;
    match formats.windows(2).all(|pair| pair[0] == pair[1]) {
        true => Ok(formats[0]),
        false => Err(Failure::Usage("the files are not all of one format".to_owned())),
    }
}

pub(super) fn run_diff(command: &Diff) -> anyhow::Result<()> {
    let paths = [command.a.as_path(), command.b.as_path()];
    let format = common_format(paths)?;
    let Diff { tolerance, max_outliers, .. } = *command;
    let limits = Limits { tolerance, max_outliers, heat: command.heat.as_deref() };
    limits.check()?;
    let (a, b) = (load(&command.a, format)?, load(&command.b, format)?);
    let names = paths.map(|path| path.display().to_string());
    let comparison = Comparison::new([(&names[0], &a), (&names[1], &b)], &limits)?;
    let mut out = std::io::stdout().lock();
    if command.json {
        serde_json::to_writer_pretty(&mut out, &comparison).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        comparison.write_table(&mut out)?;
    }
    Ok(comparison.verdict()?)
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
