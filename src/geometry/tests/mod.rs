//! Tests of the room as a whole: random B-splines against finite differences, and against their other forms.

mod bspline;
mod invert;
mod samples;
mod to_bspline;
