//! B-spline faces: one net for each Bézier span under the trim window, each stored once, with its leaves.
//!
//! Spans of one surface share their boundary rows bit for bit, and so do their nets: all are relative to the same origin, and weights are scaled by one
//! factor for the whole face.

use super::faces::PartSpace;
use super::leaves::{self, Domain, Leaf, Side, Trim};
use super::narrow;
use super::outline::Outline;
use super::slab;
use super::trim_tree::TrimTree;
use crate::geometry::{BezierPatch, BsplineSurface, PatchSpan, decompose_surface};
use crate::numeric::Aabb;
use crate::scene::{Net, NetLeaf, TRIM_INSIDE};
use glam::{DVec2, DVec3, DVec4};

/// The highest degree that kernels evaluate.
const MAX_DEGREE: usize = 25;

/// The nets of a face; indices count from its own arrays.
#[derive(Debug, Default)]
pub(super) struct Nets {
    /// Records; `face` is not set.
    pub nets: Vec<Net>,
    /// Leaves; `trim` is 0 or `TRIM_INSIDE`.
    pub leaves: Vec<NetLeaf>,
    /// Part-space boxes of the leaves.
    pub boxes: Vec<Aabb>,
    /// Homogeneous control points relative to the face's origin.
    pub points: Vec<DVec4>,
    /// Whether any part of the nets is not inside.
    pub is_mixed: bool,
}

/// Origin of face space in part space (on the grid), and the nets.
pub(super) fn bake_nets(
    surface: &BsplineSurface,
    period: DVec2,
    outline: &Outline,
    tree: &TrimTree,
    space: &PartSpace,
    distortion: f64,
    max_leaves: usize,
) -> Result<(DVec3, Nets), String> {
    if surface.u_knots.degree().max(surface.v_knots.degree()) > MAX_DEGREE {
        return Err("its degree is above 25".into());
    }
    let origin = narrow::snap(outline.bounds.center() - space.center, space.grid_step);
    let heaviest = surface.points.iter().map(|p| p.w).fold(0.0, f64::max);
    if !(heaviest > 0.0 && surface.points.iter().all(|p| p.is_finite() && p.w > 0.0)) {
        return Err("its control points are not finite or weights not positive".into());
    }
    let first_weight = surface.points[0].w;
    let is_rational = surface.points.iter().any(|p| p.w != first_weight);
    let trim = Trim { region: &outline.region, tree, period };
    let face_size = outline.bounds.diagonal();
    let mut nets = Nets::default();
    for span in decompose_surface(surface) {
        let domain = normalised_domain(&span, outline);
        let patch = in_face_space(span.patch, origin + space.center, heaviest, is_rational);
        if !patch.points.iter().all(|p| p.is_finite() && p.as_vec4().is_finite() && p.w > 0.0) {
            return Err("a control point is beyond single precision".into());
        }
        let points = patch.points.clone();
        let degrees = patch.degrees;
        let (found, left_out) = leaves::leaves(patch, &domain, &trim, distortion, max_leaves, face_size);
        nets.is_mixed |= left_out;
        if found.is_empty() {
            continue;
        }
        let index = nets.nets.len() as u32;
        nets.nets.push(Net {
            first_point: nets.points.len() as u32,
            degrees: degrees[0] as u32 | (degrees[1] as u32) << 8 | u32::from(is_rational) << 16,
            face: 0,
            reserved: 0,
            uv_low: narrow::pair(domain.low),
            uv_size: narrow::pair(domain.size),
        });
        nets.points.extend(points);
        for leaf in &found {
            nets.add_leaf(leaf, index, origin);
        }
    }
    if nets.leaves.is_empty() {
        return Err("its trims leave nothing of the surface".into());
    }
    Ok((origin, nets))
}

impl Nets {
    fn add_leaf(&mut self, leaf: &Leaf, net: u32, origin: DVec3) {
        let axis = |k: usize| leaf.index[k] | u32::from(leaf.level[k]) << 12;
        self.is_mixed |= leaf.side == Side::Mixed;
        self.leaves.push(NetLeaf {
            domain: axis(0) | axis(1) << 16,
            net,
            trim: if leaf.side == Side::Inside { TRIM_INSIDE } else { 0 },
            ..slab::leaf(&leaf.patch, &leaf.fit)
        });
        let bounds = slab::bounds(&leaf.patch);
        self.boxes.push(Aabb { min: bounds.min + origin, max: bounds.max + origin });
    }
}

/// A span's rectangle in normalised parameters.
fn normalised_domain(span: &PatchSpan, outline: &Outline) -> Domain {
    let scale = DVec2::ONE / (outline.window.max - outline.window.min);
    let low = DVec2::new(span.u[0], span.v[0]);
    let high = DVec2::new(span.u[1], span.v[1]);
    Domain { low: (low - outline.window.min) * scale, size: (high - low) * scale }
}

/// A patch relative to `origin` (the part's own coordinates), weights at most 1, and exactly 1 where all are equal.
fn in_face_space(patch: BezierPatch, origin: DVec3, heaviest: f64, is_rational: bool) -> BezierPatch {
    let moved = |p: &DVec4| {
        if is_rational {
            (p.truncate() - origin * p.w).extend(p.w) / heaviest
        } else {
            (p.truncate() / p.w - origin).extend(1.0)
        }
    };
    BezierPatch { degrees: patch.degrees, points: patch.points.iter().map(moved).collect() }
}
