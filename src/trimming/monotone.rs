//! Splitting at the extrema of u and v.

use crate::geometry::{Bezier, Homogeneous2};

/// `curve` cut at its u- and v-extrema; the pieces are monotone in both and share end points bit for bit.
pub fn split_monotone(curve: &Bezier<Homogeneous2>) -> Vec<Bezier<Homogeneous2>> {
    todo!()
}
