//! `--reference`: the picture that a rendered one is compared with.

use super::Failure;
use super::args_reference::ReferenceArguments;
use super::comparison::{Comparison, Format, Limits, load};
use super::output::{Output, Still};
use crate::image::Numbers;

/// A picture to compare with. It is read before the other is written, so that the two may be one file.
#[derive(Debug)]
pub(super) struct Reference<'r> {
    name: String,
    numbers: Numbers,
    format: Format,
    limits: Limits<'r>,
}

/// The reference that is asked for, if any.
///
/// # Errors
///
/// What is rendered is not one picture of the reference's format; the reference cannot be read.
pub(super) fn reference<'r>(
    flags: &'r ReferenceArguments,
    plan: &[Vec<Still>],
) -> anyhow::Result<Option<Reference<'r>>> {
    let Some(path) = &flags.reference else { return Ok(None) };
    let usage = |reason: String| Err(Failure::Usage(reason).into());
    let stills: Vec<&Still> = plan.iter().flatten().collect();
    let [still] = stills[..] else {
        return usage(format!(
            "--reference is compared with one picture, and {} are asked for: leave out all but one, or compare them with `trimray diff`",
            stills.len()
        ));
    };
    if still.frames.len() > 1 {
        return usage("--reference is compared with a still: leave out --frames".to_owned());
    }
    let format = Format::of(path)?;
    let rendered = if matches!(still.output, Output::Exr(_)) { Format::Exr } else { Format::Png };
    if format != rendered {
        return usage(format!(
            "{} and the picture are not of one format: both must be .png, or both .exr",
            path.display()
        ));
    }
    let limits = Limits {
        tolerance: flags.reference_tolerance,
        max_outliers: flags.reference_max_outliers,
        heat: flags.reference_heat.as_deref(),
    };
    limits.check()?;
    let numbers = load(path, format)?;
    Ok(Some(Reference { name: path.display().to_string(), numbers, format, limits }))
}

impl Reference<'_> {
    /// Compares the bytes of a picture with the reference.
    ///
    /// # Errors
    ///
    /// They have not the same pixels or channels; the picture of differences cannot be written.
    pub(super) fn compare(&self, output: &Output, bytes: &[u8]) -> anyhow::Result<Comparison> {
        let rendered = output.path().map_or("the picture".into(), |path| path.display().to_string());
        let numbers = self.format.numbers(bytes)?;
        Comparison::new([(&self.name, &self.numbers), (&rendered, &numbers)], &self.limits)
    }
}
