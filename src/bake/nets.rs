//! B-spline faces: one net for each Bézier span under the trim window, each stored once, with its leaves.
//!
//! Spans of one surface share their boundary rows bit for bit, and so do their nets: all are relative to the same origin, and weights are scaled by one
//! factor for the whole face.

use super::faces::PartSpace;
use super::leaves::{self, Domain, Fineness, Leaf, Side, Trim, View};
use super::narrow;
use super::outline::Outline;
use super::slab;
use super::times::{BakeTimes, timed};
use super::trim_tree::TrimTree;
use crate::geometry::{BezierPatch, BsplineSurface, PatchSpan, decompose_surface};
use crate::numeric::Aabb;
use crate::scene::{MAX_DEGREE, Net, NetLeaf, TRIM_INSIDE};
use glam::{DVec2, DVec3, DVec4};
use rayon::prelude::*;

/// Patches that are made before they are baked.
const SPANS_AT_ONCE: usize = 256;

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
    /// The diagonal of the largest net's box, millimetres.
    pub reach: f64,
    /// What they took.
    pub times: BakeTimes,
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
    if surface.u_knots.degree().max(surface.v_knots.degree()) > MAX_DEGREE as usize {
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
    let fineness = Fineness { distortion, large: space.large_leaf };
    let bake_span = |span: PatchSpan, views: &[View]| -> Result<BakedSpan, String> {
        let domain = normalised_domain(span.u, span.v, outline);
        let (patch, nets) = timed(|| in_face_space(span.patch, origin + space.center, heaviest, is_rational));
        if !patch.points.iter().all(|p| p.is_finite() && p.as_vec4().is_finite() && p.as_vec4().w > 0.0) {
            return Err("a control point is beyond single precision".into());
        }
        let (points, degrees) = (patch.points.clone(), patch.degrees);
        let point_sides = slab::point_sides(&patch);
        let reach = slab::bounds(&patch).diagonal();
        let ((found, is_cut), leaves) =
            timed(|| leaves::leaves(patch, &domain, &trim, views, &fineness, max_leaves, face_size));
        let times = BakeTimes { nets, leaves, ..BakeTimes::default() };
        let is_mixed = is_cut || found.iter().any(|leaf| leaf.side == Side::Mixed);
        let leaves = found.iter().map(|leaf| leaf_and_box(leaf, origin)).collect();
        Ok(BakedSpan { domain, degrees, point_sides, points, leaves, is_mixed, reach, times })
    };
    let ends = surface.domain();
    let bake_strip = |strip: Vec<PatchSpan>| -> Result<Vec<BakedSpan>, String> {
        let whole = normalised_domain(strip[0].u, [ends.min.y, ends.max.y], outline);
        let views = leaves::views(&whole, &trim);
        strip.into_par_iter().map(|span| bake_span(span, &views)).collect()
    };
    let mut nets = Nets::default();
    let mut spans = decompose_surface(surface);
    // The spans of one large face are as many tasks, but not all of its patches are in memory.
    loop {
        let (strips, seconds) = timed(|| strips(spans.by_ref().take(SPANS_AT_ONCE)));
        nets.times.nets += seconds;
        if strips.is_empty() {
            break;
        }
        let baked = strips.into_par_iter().map(bake_strip).collect::<Result<Vec<_>, _>>()?;
        for span in baked.into_iter().flatten() {
            nets.add(span, is_rational);
        }
    }
    if nets.leaves.is_empty() {
        return Err("its trims leave nothing of the surface".into());
    }
    Ok((origin, nets))
}

/// One net before the nets of its face have their indices.
struct BakedSpan {
    domain: Domain,
    degrees: [usize; 2],
    point_sides: u32,
    points: Vec<DVec4>,
    leaves: Vec<(NetLeaf, Aabb)>,
    is_mixed: bool,
    reach: f64,
    times: BakeTimes,
}

impl Nets {
    /// Makes leaves and boxes hold what lies within `slack` of them.
    pub(super) fn grow(&mut self, slack: f64) {
        self.leaves.iter_mut().for_each(|leaf| slab::grow(leaf, slack));
        self.boxes.iter_mut().for_each(|bounds| *bounds = bounds.grown(slack));
    }

    fn add(&mut self, span: BakedSpan, is_rational: bool) {
        self.is_mixed |= span.is_mixed;
        self.times = self.times + span.times;
        if span.leaves.is_empty() {
            return;
        }
        self.reach = self.reach.max(span.reach);
        let net = self.nets.len() as u32;
        self.nets.push(Net {
            first_point: self.points.len() as u32,
            degrees: span.degrees[0] as u32
                | (span.degrees[1] as u32) << 8
                | u32::from(is_rational) << 16
                | span.point_sides,
            face: 0,
            reserved: 0,
            uv_low: narrow::pair(span.domain.low),
            uv_size: narrow::pair(span.domain.size),
        });
        self.points.extend(span.points);
        for (leaf, bounds) in span.leaves {
            self.leaves.push(NetLeaf { net, ..leaf });
            self.boxes.push(bounds);
        }
    }
}

/// The record of a leaf, its net aside, and its box in part space.
fn leaf_and_box(leaf: &Leaf, origin: DVec3) -> (NetLeaf, Aabb) {
    let axis = |k: usize| leaf.index[k] | u32::from(leaf.level[k]) << 12;
    let record = NetLeaf {
        domain: axis(0) | axis(1) << 16,
        trim: if leaf.side == Side::Inside { TRIM_INSIDE } else { 0 },
        ..slab::leaf(&leaf.patch, &leaf.fit)
    };
    let bounds = slab::bounds(&leaf.patch);
    (record, Aabb { min: bounds.min + origin, max: bounds.max + origin })
}

/// The spans, those that follow each other with the same `u` together.
fn strips(spans: impl Iterator<Item = PatchSpan>) -> Vec<Vec<PatchSpan>> {
    let mut strips: Vec<Vec<PatchSpan>> = Vec::new();
    for span in spans {
        match strips.last_mut().filter(|strip| strip[0].u == span.u) {
            Some(strip) => strip.push(span),
            None => strips.push(vec![span]),
        }
    }
    strips
}

/// A rectangle of surface parameters in normalised ones.
fn normalised_domain(u: [f64; 2], v: [f64; 2], outline: &Outline) -> Domain {
    let scale = DVec2::ONE / (outline.window.max - outline.window.min);
    let low = DVec2::new(u[0], v[0]);
    let high = DVec2::new(u[1], v[1]);
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
