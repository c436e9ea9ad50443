//! Where pictures go: the `{model}` template, the format by extension, '-' for stdout.

use super::Failure;
use crate::image::{Film, Picture, encode_png, write_exr, write_png};
use std::io::Write;
use std::path::{Path, PathBuf};

/// The place of one picture.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum Output {
    /// PNG bytes on stdout.
    Stdout,
    /// A PNG file.
    Png(PathBuf),
    /// An OpenEXR file.
    Exr(PathBuf),
}

/// The place of each input's picture, decided before any work is done.
pub(super) fn outputs(template: &str, inputs: &[PathBuf]) -> Result<Vec<Output>, Failure> {
    let mut outputs: Vec<Output> = Vec::with_capacity(inputs.len());
    for input in inputs {
        let model = input.file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default();
        let output = output(&template.replace("{model}", &model))?;
        if outputs.contains(&output) {
            let reason = format!(
                "`{template}` names one picture for several inputs; put {{model}} in it, and give each input its own name"
            );
            return Err(Failure::Usage(reason));
        }
        outputs.push(output);
    }
    Ok(outputs)
}

fn output(name: &str) -> Result<Output, Failure> {
    if name == "-" {
        return Ok(Output::Stdout);
    }
    let path = PathBuf::from(name);
    let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
    match extension.as_deref() {
        Some("png") => Ok(Output::Png(path)),
        Some("exr") => Ok(Output::Exr(path)),
        _ => Err(Failure::Usage(format!("`{name}` is neither .png nor .exr, nor '-' for a PNG on stdout"))),
    }
}

impl Output {
    /// Writes the picture.
    pub(super) fn write(&self, film: &Film) -> anyhow::Result<()> {
        match self {
            Self::Stdout => {
                let mut stdout = std::io::stdout().lock();
                stdout.write_all(&encode_png(&Picture::from(film))?)?;
                stdout.flush()?;
            }
            Self::Png(path) => write_png(path, film)?,
            Self::Exr(path) => write_exr(path, film)?,
        }
        Ok(())
    }

    /// The file, if it is one.
    pub(super) fn path(&self) -> Option<&Path> {
        match self {
            Self::Stdout => None,
            Self::Png(path) | Self::Exr(path) => Some(path),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(template: &str, inputs: &[&str]) -> Result<Vec<Output>, Failure> {
        outputs(template, &inputs.iter().map(PathBuf::from).collect::<Vec<_>>())
    }

    #[test]
    fn templates_name_one_picture_for_each_input() {
        let found = named("out/{model}.PNG", &["a/b.step", "c.d.stp"]).expect("two names");
        assert_eq!(found, [Output::Png("out/b.PNG".into()), Output::Png("out/c.d.PNG".into())]);
        assert_eq!(named("-", &["a.step"]).expect("stdout"), [Output::Stdout]);
        assert_eq!(named("x.exr", &["a.step"]).expect("a file"), [Output::Exr("x.exr".into())]);
    }

    #[test]
    fn clashing_and_foreign_names_are_usage_errors() {
        for (template, inputs) in [
            ("x.png", &["a.step", "b.step"][..]),
            ("-", &["a.step", "b.step"]),
            ("{model}.png", &["a/x.step", "b/x.stp"]),
            ("x.jpg", &["a.step"]),
            ("png", &["a.step"]),
        ] {
            assert_eq!(named(template, inputs).expect_err(template).exit_code(), 2);
        }
    }
}
