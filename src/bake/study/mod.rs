//! The structures of the trimming study, methods 1 to 29 of Table 2 of Sloup and Havran 2021, from a face's [`Region`].
//!
//! All hold the region's bi-monotone pieces as elements with control points of their own and share the region's f32 vertices, so that parities counted
//! at a height agree bit for bit. The words and the rule of parity are those of [`crate::scene::trim_study`].

mod boxing;
mod curvesets;
mod elements;
mod heights;
mod kd;
mod list;
mod slabs;
#[cfg(test)]
mod tests;

use super::region::Region;
use crate::geometry::{Bezier, ParameterBox};
use crate::scene::{TrimMethod, TrimStructure};
use crate::trimming::FaceTrim;
use glam::DVec2;

/// The words and control points of one face.
#[derive(Debug, Default)]
pub(super) struct Structure {
    /// The first is the scene's to set.
    pub words: Vec<u32>,
    /// `(w·u, w·v, w)`.
    pub points: Vec<[f32; 3]>,
    /// The highest degree of an element.
    pub max_degree: u32,
}

/// Builds the structure of `method`, which is not the default one. The window's border bounds a region without curves.
pub(super) fn build(region: &Region, method: TrimMethod) -> Result<Structure, String> {
    if !region.is_bounded {
        let window = ParameterBox { min: DVec2::ZERO, max: DVec2::ONE };
        let corners = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];
        let side =
            |i: usize| Bezier { points: vec![corners[i].extend(1.0), corners[(i + 1) % 4].extend(1.0)] };
        let curves = (0..4).map(side).collect();
        return build(&Region::new(&FaceTrim { curves, ..FaceTrim::whole(window) })?, method);
    }
    match method.structure() {
        TrimStructure::List => Ok(list::build(region, method)),
        TrimStructure::Slabs => slabs::build(region, method),
        _ => kd::build(region, method),
    }
}
