//! Where pictures go: the templates `{model}`, `{view}` and `{frame}`, the format by extension, '-' for stdout.

use super::Failure;
use crate::image::{BitDepth, Film, encode_exr, encode_film, write_file};
use std::collections::HashSet;
use std::io::Write;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The place of one picture.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) enum Output {
    /// PNG bytes on stdout.
    Stdout,
    /// A PNG file.
    Png(PathBuf),
    /// An OpenEXR file.
    Exr(PathBuf),
}

/// A file and what it shows: of several views a sheet, of several frames an animation.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Still {
    pub(super) output: Output,
    /// Indices of views.
    pub(super) views: Range<usize>,
    /// Indices of frames.
    pub(super) frames: Range<u32>,
}

/// What is to be put on pictures.
#[derive(Debug, Clone, Copy)]
pub(super) struct Subjects<'a> {
    pub(super) inputs: &'a [PathBuf],
    /// Names of views; none: one without a name.
    pub(super) views: &'a [&'a str],
    /// At least 1.
    pub(super) frames: u32,
}

/// The files of each input, decided before any work is done.
pub(super) fn plan(template: &str, subjects: &Subjects<'_>) -> Result<Vec<Vec<Still>>, Failure> {
    let usage = |reason: String| Err(Failure::Usage(reason));
    let has_views = template.contains("{view}");
    let has_frames = fill_frame(template, 0) != template;
    if has_views && subjects.views.is_empty() {
        return usage(format!("`{template}` has {{view}}, but no --view is given"));
    }
    let views = subjects.views.len().max(1);
    let view_step = if has_views { 1 } else { views };
    let view_groups: Vec<Range<usize>> =
        (0..views).step_by(view_step).map(|first| first..first + view_step).collect();
    let frame_step = if has_frames { 1 } else { subjects.frames };
    let frame_groups: Vec<Range<u32>> =
        (0..subjects.frames).step_by(frame_step as usize).map(|first| first..first + frame_step).collect();
    let mut taken: HashSet<Output> = HashSet::new();
    let mut plan = Vec::with_capacity(subjects.inputs.len());
    for input in subjects.inputs {
        let mut stills = Vec::new();
        for (views, frames) in view_groups.iter().flat_map(|v| frame_groups.iter().map(move |f| (v, f))) {
            let view = subjects.views.get(views.start).copied().unwrap_or_default();
            let name = with_model(&fill_frame(&template.replace("{view}", view), frames.start), input);
            let output = output(&name)?;
            if frames.len() > 1 && matches!(output, Output::Exr(_)) {
                return usage(format!("an EXR file holds one frame: put {{frame}} in `{template}`"));
            }
            if !taken.insert(output.clone()) {
                return usage(format!(
                    "`{template}` names one file for several pictures; put {{model}} in it, and give each input its own name"
                ));
            }
            stills.push(Still { output, views: views.clone(), frames: frames.clone() });
        }
        plan.push(stills);
    }
    Ok(plan)
}

/// The template with the input's name without its extension for `{model}`.
pub(super) fn with_model(template: &str, input: &Path) -> String {
    let model = input.file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default();
    template.replace("{model}", &model)
}

/// The template with the frame's number for `{frame}`, `{frame:4}` and `{frame:04}`: all but the first with so many digits.
fn fill_frame(template: &str, frame: u32) -> String {
    let mut filled = String::new();
    let mut rest = template;
    while let Some(start) = rest.find("{frame") {
        let after = &rest[start + "{frame".len()..];
        let field = after.split_once('}');
        let digits = field.and_then(|(format, tail)| match format.strip_prefix(':') {
            None if format.is_empty() => Some((0, tail)),
            Some(digits) => {
                digits.parse::<usize>().ok().filter(|&digits| digits <= 16).map(|digits| (digits, tail))
            }
            None => None,
        });
        filled += &rest[..start];
        match digits {
            Some((digits, tail)) => {
                filled += &format!("{frame:0digits$}");
                rest = tail;
            }
            None => {
                filled += "{frame";
                rest = after;
            }
        }
    }
    filled + rest
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
        _ => Err(Failure::Usage(format!(
            "`{name}` is neither .png (which --frames animates) nor .exr, nor '-' for a PNG on stdout"
        ))),
    }
}

impl Output {
    /// The bytes of a picture; the names of its parts are for Cryptomatte.
    pub(super) fn encode(
        &self,
        film: &Film,
        depth: BitDepth,
        part_names: &[String],
    ) -> anyhow::Result<Vec<u8>> {
        Ok(match self {
            Self::Stdout | Self::Png(_) => encode_film(film, depth)?,
            Self::Exr(_) => encode_exr(film, part_names)?,
        })
    }

    /// Writes a picture's bytes.
    pub(super) fn write(&self, bytes: &[u8]) -> anyhow::Result<()> {
        match self {
            Self::Stdout => write_stdout(bytes)?,
            Self::Png(path) | Self::Exr(path) => write_file(path, bytes)?,
        }
        Ok(())
    }

    /// Whether it shows the light of a screen, not that of the scene.
    pub(super) fn is_shown(&self) -> bool {
        !matches!(self, Self::Exr(_))
    }

    /// The file, if it is one.
    pub(super) fn path(&self) -> Option<&Path> {
        match self {
            Self::Stdout => None,
            Self::Png(path) | Self::Exr(path) => Some(path),
        }
    }
}

fn write_stdout(bytes: &[u8]) -> std::io::Result<()> {
    let mut stdout = std::io::stdout().lock();
    stdout.write_all(bytes)?;
    stdout.flush()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn named(
        template: &str,
        inputs: &[&str],
        views: &[&str],
        frames: u32,
    ) -> Result<Vec<Vec<Still>>, Failure> {
        let inputs: Vec<PathBuf> = inputs.iter().map(PathBuf::from).collect();
        plan(template, &Subjects { inputs: &inputs, views, frames })
    }

    fn files(template: &str, inputs: &[&str], views: &[&str], frames: u32) -> Vec<String> {
        let stills = named(template, inputs, views, frames).expect("a plan").concat();
        stills
            .iter()
            .map(|still| still.output.path().map_or("-".into(), |p| p.display().to_string()))
            .collect()
    }

    #[test]
    fn templates_name_one_file_for_each_picture() {
        assert_eq!(files("out/{model}.PNG", &["a/b.step", "c.d.stp"], &[], 1), ["out/b.PNG", "out/c.d.PNG"]);
        assert_eq!(files("-", &["a.step"], &[], 1), ["-"]);
        assert_eq!(files("x.exr", &["a.step"], &[], 1), ["x.exr"]);
        assert_eq!(files("{model}-{view}.png", &["a.step"], &["top", "iso"], 1), ["a-top.png", "a-iso.png"]);
        assert_eq!(files("{frame:03}{view}.exr", &["a.step"], &["top"], 2), ["000top.exr", "001top.exr"]);
        assert_eq!(files("{frame}-{frame:2}.png", &["a.step"], &[], 11)[10], "10-10.png");
        assert_eq!(files("{frame:x}{frames}.png", &["a.step"], &[], 1), ["{frame:x}{frames}.png"]);
    }

    #[test]
    fn what_has_no_name_of_its_own_is_put_together() {
        let stills = named("x.png", &["a.step"], &["top", "iso"], 5).expect("a plan").concat();
        assert_eq!(stills, [Still { output: Output::Png("x.png".into()), views: 0..2, frames: 0..5 }]);
        let stills = named("{view}.png", &["a.step"], &["top", "iso"], 5).expect("a plan").concat();
        assert_eq!(stills[1], Still { output: Output::Png("iso.png".into()), views: 1..2, frames: 0..5 });
    }

    #[test]
    fn clashing_and_foreign_names_are_usage_errors() {
        for (template, inputs, views, frames) in [
            ("x.png", &["a.step", "b.step"][..], &[][..], 1),
            ("-", &["a.step", "b.step"], &[], 1),
            ("{model}.png", &["a/x.step", "b/x.stp"], &[], 1),
            ("x.jpg", &["a.step"], &[], 1),
            ("png", &["a.step"], &[], 1),
            ("{view}.png", &["a.step"], &[], 1),
            ("{view}.png", &["a.step"], &["top", "top"], 1),
            ("x.exr", &["a.step"], &[], 2),
        ] {
            assert_eq!(named(template, inputs, views, frames).expect_err(template).exit_code(), 2);
        }
    }
}
