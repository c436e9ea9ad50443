//! Edges of the model, for lines in pictures. No kernel reads them.

use bytemuck::{Pod, Zeroable};

/// The face of an [`EdgePiece`] where there is none.
pub const NO_FACE: u32 = u32::MAX;

/// What an edge is to the faces on its two sides.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EdgeKind {
    /// Two faces meet at an angle.
    Sharp = 0,
    /// One face ends.
    Boundary = 1,
    /// Two faces go over into each other without an angle.
    Smooth = 2,
    /// A face closes in itself.
    Seam = 3,
}

impl EdgeKind {
    /// By number, as in [`EdgePiece::kind`].
    pub fn from_number(number: u32) -> Option<Self> {
        [Self::Sharp, Self::Boundary, Self::Smooth, Self::Seam]
            .into_iter()
            .find(|kind| *kind as u32 == number)
    }

    /// Whether it shows the shape, and not how the modeller cut the shape into faces.
    pub fn is_feature(self) -> bool {
        matches!(self, Self::Sharp | Self::Boundary)
    }
}

/// A rational Bézier curve: an edge, or a piece of one between knots. 48 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct EdgePiece {
    /// The anchor of the control points in part space, grid steps.
    pub grid: [i32; 3],
    /// Index of the part.
    pub part: u32,
    /// Indices of the faces that meet here, [`NO_FACE`] where there is no second one; any two where there are more.
    pub faces: [u32; 2],
    /// In `edge_points`; `degree + 1` points.
    pub first_point: u32,
    /// At least 1.
    pub degree: u32,
    /// An [`EdgeKind`].
    pub kind: u32,
    /// Number of the edge: its pieces stand one after the other, each beginning where the one before ends.
    pub edge: u32,
    /// Unused, 0.
    pub reserved: [u32; 2],
}
