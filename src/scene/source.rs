//! What bodies and faces are in the source: records beside those of the kernels, which need not be read for a picture.

use bytemuck::{Pod, Zeroable};

/// A body of the source. 16 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Pod, Zeroable)]
pub struct BodyInfo {
    /// The file's entity number.
    pub entity: u64,
    /// 1 where its faces enclose a volume, else 0: a solid all of whose faces are here and meet in all of their edges.
    pub is_closed: u32,
    /// Unused, 0.
    pub reserved: u32,
}

impl BodyInfo {
    /// A body of this entity number.
    pub fn new(entity: u64, is_closed: bool) -> Self {
        Self { entity, is_closed: is_closed.into(), reserved: 0 }
    }

    /// Whether its faces enclose a volume.
    pub fn is_closed(&self) -> bool {
        self.is_closed != 0
    }
}

/// A face of the source. 40 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, Default, PartialEq, Pod, Zeroable)]
pub struct FaceInfo {
    /// The file's entity number.
    pub entity: u64,
    /// Surface parameters of normalised (0, 0), and the window's size, f64.
    pub uv_low: [f64; 2],
    /// See `uv_low`.
    pub uv_size: [f64; 2],
}
