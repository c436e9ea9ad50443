//! Curves and surfaces in f64: evaluation, inversion, exact conversion and decomposition into Bézier form.
//!
//! Everything that approximates takes its tolerance as an argument. Lengths are millimetres, angles radians.
//! Parameterisations are those of ISO 10303-42, with angles in radians.

mod analytic;
mod bezier;
mod blossom;
mod bounds;
mod bspline;
mod curve;
mod decompose;
mod fit;
mod fit_curve;
mod frame;
mod invert;
mod iso;
mod join;
mod knots;
mod offset;
mod recognise;
mod surface;
pub mod to_bspline;

pub use bezier::{Bezier, BezierPatch, Homogeneous, Homogeneous2, Homogeneous3};
pub use bspline::{BsplineCurve, BsplineSurface};
pub use curve::{Curve, Curve2, CurveDerivatives};
pub use decompose::{CurveSpan, PatchSpan, decompose_curve, decompose_surface, patch_points};
pub use fit::{Fit, fit_surface};
pub use fit_curve::{CurveFit, fit_curve};
pub use frame::Frame;
pub use invert::{Inversion, invert_curve, invert_surface};
pub use iso::iso_curve;
pub use join::{elevated, join_curves, join_spans};
pub use knots::{KnotError, KnotVector};
pub use offset::{Offset, offset_surface};
pub use recognise::{RECOGNITION_TOLERANCE, recognise};
pub use surface::{ParameterBox, Singularity, Surface, SurfaceDerivatives};

#[cfg(test)]
mod tests;
