//! What people want to know of a scene and no kernel reads: names, units, counts, diagnostics.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Names, units, counts, diagnostics.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Metadata {
    /// File name of the source without its folder.
    pub file_name: String,
    /// "STEP" or "IGES".
    pub format: String,
    /// Schema of the source.
    pub schema: String,
    /// The system that wrote the source.
    pub originating_system: String,
    /// Name of the source's own length unit.
    pub unit: String,
    /// Millimetres in one such unit.
    pub unit_millimetres: f64,
    /// One per part of the scene.
    pub parts: Vec<PartInfo>,
    /// One per instance.
    pub instances: Vec<InstanceInfo>,
    /// Faces that the file declares.
    pub declared_faces: u64,
    /// Solids over all occurrences.
    pub solids: u64,
    /// How many B-spline surfaces of the source became elementary ones, by kind.
    pub recognised: BTreeMap<String, u64>,
    /// Whether the scene has the model's edges; a model without any has none either.
    pub has_edges: bool,
    /// The edge whose faces may be farthest apart; absent where no two faces share an edge.
    pub largest_gap: Option<EdgeGap>,
    /// What was repaired, guessed, hidden or dropped.
    pub findings: Vec<Finding>,
}

impl Metadata {
    /// How many declared faces are not in the scene for findings of this severity.
    pub fn missing_faces(&self, severity: Severity) -> u64 {
        self.findings.iter().filter(|f| f.severity == severity).map(|f| u64::from(f.faces)).sum()
    }
}

/// How far the two faces of an edge may be apart along it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct EdgeGap {
    /// The file's entity number of the edge.
    pub entity: u64,
    /// A bound; millimetres.
    pub distance: f64,
}

/// How bad a finding is.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Odd but harmless, or not needed.
    Note,
    /// Left out because the file says that it is invisible.
    Hidden,
    /// Mended as its author plainly meant.
    Repaired,
    /// Guessed.
    Warning,
    /// Shape that is lost.
    Dropped,
}

/// What was found about one entity of the source.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Finding {
    /// How bad it is.
    pub severity: Severity,
    /// The file's entity number; 0 where it concerns the whole file.
    pub entity: u64,
    /// The entity's keyword or type number.
    pub kind: String,
    /// What happened and why.
    pub reason: String,
    /// How many declared faces are not in the scene because of it.
    pub faces: u32,
}

/// A part.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PartInfo {
    /// The product's name.
    pub name: String,
    /// The file's entity number.
    pub entity: u64,
}

/// An instance.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct InstanceInfo {
    /// Names from the root, joined by `/`.
    pub path: String,
}
