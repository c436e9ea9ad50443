//! What an edge is to its faces, by the exact normals along it.

use crate::brep::{Edge, Face, Id, Model};
use crate::geometry::{invert_curve, invert_surface};
use crate::scene::EdgeKind;
use glam::{DVec2, DVec3};

/// Faces that meet at a smaller angle than this, degrees, go over into each other: modellers are exact to a tenth of a degree, and what is fitted
/// is off by more.
const SMOOTH_ANGLE: f64 = 2.0;

/// Where along an edge its faces are compared; its ends may be poles.
const PLACES: [f64; 5] = [0.05, 0.3, 0.5, 0.7, 0.95];

/// What an edge is to the faces that use it, each as often as it does.
pub(super) fn kind(model: &Model, edge: &Edge, faces: &[Id<Face>]) -> EdgeKind {
    match faces {
        [] | [_] => EdgeKind::Boundary,
        [a, b] if a == b => EdgeKind::Seam,
        [a, b] if is_smooth(model, edge, *a, *b) => EdgeKind::Smooth,
        _ => EdgeKind::Sharp,
    }
}

/// Whether two faces have the same normal along an edge; poles, where there is none, are left out.
fn is_smooth(model: &Model, edge: &Edge, a: Id<Face>, b: Id<Face>) -> bool {
    let mut seeds = [None; 2];
    let mut compared = false;
    for place in PLACES {
        let point = point_at(edge, place);
        let [a, b] = [(a, 0), (b, 1)].map(|(face, side)| normal(model, face, point, &mut seeds[side]));
        let (Some(a), Some(b)) = (a, b) else { continue };
        if a.dot(b) < SMOOTH_ANGLE.to_radians().cos() {
            return false;
        }
        compared = true;
    }
    compared
}

/// The outward unit normal of a face where it is nearest to `point`.
fn normal(model: &Model, face: Id<Face>, point: DVec3, seed: &mut Option<DVec2>) -> Option<DVec3> {
    let face = &model.faces[face];
    let surface = &model.surfaces[face.surface];
    let inversion = invert_surface(surface, point, *seed);
    *seed = Some(inversion.uv).filter(|uv| uv.is_finite());
    let at = surface.derivatives(inversion.uv);
    let normal = at.du.cross(at.dv);
    // Where the parameters run along each other rounding is all that is left of the product.
    let is_usable = normal.length() > 1e-6 * at.du.length() * at.dv.length();
    let normal = if is_usable { normal.try_normalize() } else { None };
    normal.map(|normal| if face.same_sense { normal } else { -normal })
}

fn point_at(edge: &Edge, share: f64) -> DVec3 {
    edge.curve.point(edge.range[0] * (1.0 - share) + edge.range[1] * share)
}

/// Whether two edges run from the same point to the same point, in either direction, and `a` nowhere farther than `apart` from `b`.
pub(super) fn runs_along(a: &Edge, b: &Edge, apart: f64) -> bool {
    let ends = [a, b].map(|edge| [0.0, 1.0].map(|share| point_at(edge, share)));
    let is_near = |p: DVec3, q: DVec3| p.distance(q) <= apart;
    let [[a0, a1], [b0, b1]] = ends;
    let ends_meet = is_near(a0, b0) && is_near(a1, b1) || is_near(a0, b1) && is_near(a1, b0);
    ends_meet && PLACES.iter().all(|&share| is_on(b, point_at(a, share), apart))
}

/// Whether a point is on an edge.
fn is_on(edge: &Edge, point: DVec3, apart: f64) -> bool {
    let (low, high) = (edge.range[0].min(edge.range[1]), edge.range[0].max(edge.range[1]));
    let mut t = invert_curve(&edge.curve, point, None);
    if let Some(period) = edge.curve.period() {
        t += ((low - t) / period).ceil() * period;
        // Just before the start is just before the end of a closed curve too.
        if t > high && t - period > low - 1e-6 * period {
            t -= period;
        }
    }
    let margin = 1e-3 * (high - low);
    t >= low - margin && t <= high + margin && edge.curve.point(t).distance(point) <= apart
}
