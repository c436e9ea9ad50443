//! The model: topology and geometry as every format needs them, resolved, owned, f64, in millimetres.
//!
//! This is the first waist of the chain. A [`Model`] has no pointers into a file and knows no format: units are
//! already millimetres and radians, placements are already matrices, inherited colours are already on the faces.
//! Parts that occur several times are stored once and referred to by [`Child`] placements.

mod assembly;
mod closed;
mod diagnostic;
mod id;
mod model;
pub mod primitive;
mod recognise;
mod replicate;
mod select;
#[cfg(test)]
mod select_tests;
mod style;

pub use assembly::{Occurrence, occurrences};
pub use closed::is_closed;
pub use diagnostic::{Diagnostic, Diagnostics, Severity};
pub use id::{Arena, Id};
pub use model::{
    Body, BodyKind, Child, Coedge, Edge, Face, LengthUnit, Model, Part, Pcurve, Source, TrimLoop, Vertex,
};
pub use recognise::recognise_surfaces;
pub use replicate::{ReplicateError, replicate};
pub use select::{Subject, Test, select, subjects};
pub use style::Color;
