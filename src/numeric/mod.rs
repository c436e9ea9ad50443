//! Real-number tools without geometry: boxes, Bernstein polynomials, roots, the scalar of the tracers and its lanes.

mod aabb;
pub mod bernstein;
mod eight;
mod number;
mod real;
pub mod roots;

pub use aabb::Aabb;
pub use eight::{Eight, Mask8};
pub use number::{Mask, Number, Whole};
pub use real::Real;
