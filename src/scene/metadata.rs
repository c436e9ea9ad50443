//! What people want to know of a scene and no kernel reads: names, units, counts, diagnostics.

use serde::{Deserialize, Serialize};

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
    /// One per face.
    pub faces: Vec<FaceInfo>,
    /// One per instance.
    pub instances: Vec<InstanceInfo>,
    /// Faces that the file declares.
    pub declared_faces: u64,
    /// Solids over all occurrences.
    pub solids: u64,
    /// What was repaired, skipped or dropped: (severity 0 note, 1 warning, 2 dropped; entity; keyword; reason; faces lost).
    pub diagnostics: Vec<(u8, u64, String, String, u32)>,
}

/// A part.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct PartInfo {
    /// The product's name.
    pub name: String,
    /// The file's entity number.
    pub entity: u64,
}

/// A face.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct FaceInfo {
    /// The file's entity number.
    pub entity: u64,
    /// Surface parameters of normalised (0, 0), and the window's size, f64.
    pub uv_low: [f64; 2],
    /// See `uv_low`.
    pub uv_size: [f64; 2],
}

/// An instance.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct InstanceInfo {
    /// Names from the root, joined by `/`.
    pub path: String,
}
