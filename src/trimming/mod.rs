//! From the edges of a face to closed loops of bi-monotone curves in its parameter plane.
//!
//! The 3-D edge is primary. Its image in the parameter plane is found in closed form where there is one and otherwise by
//! marching projection (each point seeded by the one before) and tolerance-driven fitting; the file's own pcurves are
//! used only where they lie on the edge. Periodic parameters are unwrapped into the universal cover, seams and poles become
//! straight segments, and what comes out is a set of exactly closed loops (neighbouring segments share their end points
//! bit for bit), so that inside is "an odd number of crossings", whatever the file's flags say.

mod align;
mod chain;
mod fit;
mod holes;
mod loops;
mod monotone;
mod outline;
mod pcurve;
mod pole;
mod region;
mod segment;
mod straighten;
mod target;
mod wrap;

#[cfg(test)]
mod damage_tests;
#[cfg(test)]
mod deviation_tests;
#[cfg(test)]
mod hole_tests;
#[cfg(test)]
mod tests;

pub use loops::trim_face;
pub use monotone::split_monotone;

use crate::brep::{Edge, Id};
use crate::geometry::{Bezier, Homogeneous2, ParameterBox};

/// How closely the parameter curves follow the edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrimOptions {
    /// The greatest distance in space between an edge and its image on the surface's parameter plane, as a share of the
    /// diagonal of the edge's face.
    pub relative_tolerance: f64,
}

impl Default for TrimOptions {
    fn default() -> Self {
        Self { relative_tolerance: 1e-7 }
    }
}

/// The trimmed region of one face in the parameter plane of its surface.
#[derive(Debug, Clone, PartialEq)]
pub struct FaceTrim {
    /// The smallest rectangle around the region; finite; at most one period wide along periodic parameters (up to rounding). It need not
    /// start in the surface's own domain: parameters are wrapped into it.
    pub window: ParameterBox,
    /// Closed loops of bi-monotone rational curves, in surface parameters: a point is inside where a ray from it crosses an odd number of
    /// them. Empty: the whole window is inside. Each curve has `v` not decreasing or not increasing over all of it, and `u` too. The curves
    /// come in any order and direction, but each end point is shared bit for bit by an even number of them.
    pub curves: Vec<Bezier<Homogeneous2>>,
    /// How far the face's edges may be from their images, in order of the edges, each once; edges without length are
    /// left out.
    pub edges: Vec<EdgeDeviation>,
    /// The diagonal of the box around the edges, millimetres; 0 for a face without edges.
    pub size: f64,
    /// What had to be repaired, for people: "gap of 0.01 mm closed", …
    pub repairs: Vec<String>,
    /// What could not be taken and makes the face larger than its author wanted it, for people: holes.
    pub losses: Vec<String>,
}

impl FaceTrim {
    /// The face that fills `window`.
    pub fn whole(window: ParameterBox) -> Self {
        let (curves, edges, repairs, losses) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        Self { window, curves, edges, size: 0.0, repairs, losses }
    }
}

/// How far an edge may be from its image on one surface.
///
/// Two faces of one edge come apart by the sum of their two distances at most: both images stay that near to the edge.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EdgeDeviation {
    /// The edge.
    pub edge: Id<Edge>,
    /// No point of the image, taken to the surface, is farther from the edge, and none of the edge farther from the
    /// image; millimetres.
    pub distance: f64,
}

/// Why a face cannot be trimmed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TrimError {
    /// The loops bound no finite region.
    #[error("the face has no finite boundary: {0}")]
    Unbounded(String),
    /// An edge lies too far off the surface.
    #[error("edge #{entity} lies {distance:.3e} mm off the surface")]
    OffSurface {
        /// The edge.
        entity: u64,
        /// How far.
        distance: f64,
    },
    /// The region has no area.
    #[error("the face is thinner than the tolerance: its loops enclose no area")]
    Empty,
    /// Numbers that are not finite, or marching that does not converge.
    #[error("{0}")]
    Numeric(String),
}
