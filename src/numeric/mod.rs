//! Real-number tools without geometry: boxes, Bernstein polynomials, roots, the scalar trait of the tracers.

mod aabb;
pub mod bernstein;
mod real;
pub mod roots;

pub use aabb::Aabb;
pub use real::Real;
