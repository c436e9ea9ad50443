//! The first half of a face's bake: its trim, checked and normalised, and its box. After it the scene's size is known.

use super::narrow;
use super::region::Region;
use crate::brep::{Face, Id, Model};
use crate::geometry::{Bezier, Homogeneous, Homogeneous2, ParameterBox, Surface};
use crate::numeric::Aabb;
use crate::trimming::{EdgeDeviation, FaceTrim, TrimOptions, trim_face};
use glam::DVec2;
use std::f64::consts::SQRT_2;

/// Deviations count up to this share of the face: beyond it, closing a gap would change the shape more than the gap does.
const MOST_DEVIATION: f64 = 1.0 / 1024.0;

/// What f32 loses between a ray and its place among trim curves, as a share of the numbers on the way: eight roundings.
const ROUNDINGS: f64 = 8.0 / (1 << 24) as f64;

/// A face that can be baked.
#[derive(Debug)]
pub(super) struct Outline {
    /// The window of surface parameters; finite, with an area.
    pub window: ParameterBox,
    /// The trimmed region in window units.
    pub region: Region,
    /// A box around the face in the part's own coordinates; finite.
    pub bounds: Aabb,
    /// How far the face's edges may be from their images, in order of the edges.
    pub edges: Vec<EdgeDeviation>,
    /// The diagonal of the box around the edges, millimetres.
    pub size: f64,
    /// What trimming repaired.
    pub repairs: Vec<String>,
    /// What trimming left out.
    pub losses: Vec<String>,
}

impl Outline {
    /// How far beside a ray, millimetres, the border of the baked face may be from the edge that bounds it in the model, where the numbers of its
    /// carrier reach as far as `reach`.
    ///
    /// The image of an edge is off by its deviation; a hit, its parameters and the trim curves by the roundings of f32 at the size of the face and of its
    /// carrier, [`ROUNDINGS`] of it together. The face is tried at four places around the ray (see `render::cpu::footprint`), which notice
    /// every straight border within 1/√2 of their distance.
    pub(super) fn slack(&self, reach: f64) -> f64 {
        let size = self.bounds.diagonal();
        let deviation = self.edges.iter().map(|edge| edge.distance).fold(0.0, f64::max);
        SQRT_2 * (deviation.min(MOST_DEVIATION * size) + ROUNDINGS * (size + reach))
    }
}

/// Trims a face; fails with the reason where nothing can be baked.
pub(super) fn outline(model: &Model, id: Id<Face>, options: &TrimOptions) -> Result<Outline, String> {
    let mut trim = trim_face(model, id, options).map_err(|error| error.to_string())?;
    let tight = trim.window;
    let surface = &model.surfaces[model.faces[id].surface];
    if !trim.curves.is_empty() && matches!(surface, Surface::Bspline(_)) {
        trim.window = widened(tight, surface);
    }
    let size = trim.window.max - trim.window.min;
    if !(trim.window.min.is_finite() && trim.window.max.is_finite()) {
        return Err("its trim window is not finite".into());
    }
    // A window narrower than the spacing of f64 numbers in it cannot be divided.
    let spacing = trim.window.min.abs().max(trim.window.max.abs()) * (8.0 * f64::EPSILON);
    if !size.cmpgt(spacing.max(DVec2::splat(f64::MIN_POSITIVE))).all() || !(DVec2::ONE / size).is_finite() {
        return Err("its trim window has no area".into());
    }
    let region = Region::new(&trim)?;
    let bounds = match surface {
        // The hull of the trim curves is tighter than the window where a plane's axes are not the face's.
        Surface::Plane { frame } if !trim.curves.is_empty() => {
            Aabb::around(trim.curves.iter().flat_map(hull).map(|p| frame.point(p.point().extend(0.0))))
        }
        _ => surface.bounds(tight),
    };
    if bounds.is_empty() || !bounds.is_finite() {
        return Err("its box is not finite".into());
    }
    if !narrow::is_within_reach(&bounds) {
        return Err(format!("it reaches farther than {:e} mm", narrow::FARTHEST));
    }
    let FaceTrim { window, edges, size, repairs, losses, .. } = trim;
    Ok(Outline { window, region, bounds, edges, size, repairs, losses })
}

/// Control points of the sixteenths of `curve`: their hull leaves the curve by 1/256 of what that of the whole does.
fn hull(curve: &Bezier<Homogeneous2>) -> Vec<Homogeneous2> {
    let mut pieces = vec![curve.clone()];
    for _ in 0..4 {
        pieces = pieces.iter().flat_map(|piece| piece.split(0.5)).collect();
    }
    pieces.into_iter().flat_map(|piece| piece.points).collect()
}

/// The window, a little wider where the surface goes on beyond it.
///
/// A leaf of a net may reach over the border of the window. What lies there is held to the border by the kernels, so that the border itself has to be
/// outside the trim curves.
fn widened(window: ParameterBox, surface: &Surface) -> ParameterBox {
    let domain = surface.domain();
    let periods = surface.periods();
    let mut wide = window;
    for k in 0..2 {
        let size = window.max[k] - window.min[k];
        let margin = size / 1024.0;
        match periods[k] {
            Some(period) if period - size > period * 1e-9 => {
                let margin = margin.min((period - size) * 0.25);
                wide.min[k] -= margin;
                wide.max[k] += margin;
            }
            Some(_) => {}
            None => {
                if window.min[k] > domain.min[k] + size * 1e-9 {
                    wide.min[k] -= margin;
                }
                if window.max[k] < domain.max[k] - size * 1e-9 {
                    wide.max[k] += margin;
                }
            }
        }
    }
    wide
}
