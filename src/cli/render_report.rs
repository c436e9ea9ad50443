//! What `trimray render --json` tells. Names of fields are those of the JSON object: they stay.

use super::Failure;
use super::comparison::Comparison;
use super::exit_code;
use super::ray_report::RayReport;
use crate::scene::{Scene, Severity};
use serde::Serialize;
use std::io::Write;
use std::path::Path;

/// The whole run.
#[derive(Debug, Default, Serialize)]
pub(super) struct RunReport {
    /// One per input, in order.
    inputs: Vec<InputReport>,
    /// With which the program ends.
    exit_code: u8,
}

/// One input.
#[derive(Debug, Default, Serialize)]
pub(super) struct InputReport {
    pub(super) input: String,
    /// What went wrong, if anything; files that were written before are listed all the same.
    pub(super) error: Option<String>,
    /// What computed; empty where nothing did.
    pub(super) device: String,
    pub(super) faces: FaceReport,
    pub(super) files: Vec<FileReport>,
    /// With `--reference`, as `diff --json` tells it: a is the reference.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) reference: Option<Comparison>,
    /// With `--stats`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) rays: Option<RayReport>,
    pub(super) seconds: Seconds,
}

/// Faces of an input, each part once.
#[derive(Debug, Default, Serialize)]
pub(super) struct FaceReport {
    declared: u64,
    drawn: u64,
    hidden: u64,
    dropped: u64,
}

impl FaceReport {
    pub(super) fn of(scene: &Scene<'_>) -> Self {
        let [hidden, dropped] =
            [Severity::Hidden, Severity::Dropped].map(|s| scene.metadata.missing_faces(s));
        let declared = scene.metadata.declared_faces;
        Self { declared, drawn: declared.saturating_sub(hidden + dropped), hidden, dropped }
    }
}

/// One file.
#[derive(Debug, Serialize)]
pub(super) struct FileReport {
    pub(super) path: String,
    pub(super) width: usize,
    pub(super) height: usize,
    /// Names, in the order of a sheet's cells; none where flags describe the only one.
    pub(super) views: Vec<String>,
    /// Numbers of the first frame and the one behind the last.
    pub(super) frames: [u32; 2],
}

/// Wall time by stage.
#[derive(Debug, Default, Serialize)]
pub(super) struct Seconds {
    /// Reading, importing and baking, or mapping a baked file.
    pub(super) load: f64,
    /// Framing, sending the scene to the device, tracing.
    pub(super) render: f64,
    /// Encoding and writing.
    pub(super) write: f64,
}

impl RunReport {
    /// Adds an input. Where there are several, a failure does not end the run but is told at once.
    pub(super) fn add(
        &mut self,
        mut report: InputReport,
        input: &Path,
        result: anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        report.input = input.display().to_string();
        if let Err(error) = &result {
            report.error = Some(format!("{error:#}"));
            self.exit_code = worse(self.exit_code, exit_code(error));
        }
        self.inputs.push(report);
        result
    }

    /// Writes the object to stdout.
    pub(super) fn write(&self) -> anyhow::Result<()> {
        let mut out = std::io::stdout().lock();
        serde_json::to_writer_pretty(&mut out, self).map_err(std::io::Error::from)?;
        writeln!(out)?;
        Ok(())
    }

    /// How a run of several inputs ends.
    pub(super) fn outcome(&self) -> Result<(), Failure> {
        let failed = self.inputs.iter().filter(|input| input.error.is_some()).count();
        match failed {
            0 => Ok(()),
            _ => Err(Failure::Batch { failed, inputs: self.inputs.len(), exit_code: self.exit_code }),
        }
    }
}

/// Of two exit codes the worse: wrong usage, then what cannot be read or written, then nothing to render, then shape that was dropped.
fn worse(a: u8, b: u8) -> u8 {
    const ORDER: [u8; 5] = [0, 3, 4, 1, 2];
    let rank = |code| ORDER.iter().position(|&other| other == code).unwrap_or(ORDER.len());
    if rank(a) >= rank(b) { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_worst_end_of_several_counts() {
        assert_eq!([worse(0, 3), worse(3, 4), worse(1, 4), worse(2, 1), worse(0, 0)], [3, 4, 1, 2, 0]);
        let mut report = RunReport::default();
        report.add(InputReport::default(), Path::new("a"), Ok(())).expect("well");
        assert!(report.outcome().is_ok());
        let nothing = Failure::Nothing { path: "b".into(), verb: "render", reason: "it is empty".into() };
        assert!(report.add(InputReport::default(), Path::new("b"), Err(nothing.into())).is_err());
        assert_eq!(report.outcome().expect_err("one failed").exit_code(), 4);
    }
}
