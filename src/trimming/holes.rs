//! Whether the loops of a face of a closed surface are holes in it, or its outer boundary.

use super::outline::Chain;
use super::segment::{end, samples, start};
use super::target::Target;
use crate::geometry::invert_surface;
use glam::{DVec2, DVec3};

/// Vertices of a face that are asked: more tell no more, and files may have any number.
const MAX_VERTICES: usize = 64;

/// Whether the loops, none of which goes round the surface, are holes. `backwards` tells whether the largest runs clockwise around its inside; `vertices`
/// are those that bound the face each by itself.
///
/// Open Cascade writes faces on left-handed surfaces with the direction of their loops wrong (tori and spheres of
/// fillets, above all), but it never leaves an outer boundary out: its closed faces have seams, or loops of a vertex at poles. Kernels that do leave it out
/// write directions correctly. So a hole is believed in faces without seams, and only where a hole looks like one: cut by
/// one curve, or by two halves of one (patches of fillets have three sides or more), or where a vertex lies in none of the loops: then the face does not either.
pub(super) fn are_holes(
    target: &Target,
    chains: &[Chain],
    largest: &Chain,
    backwards: bool,
    vertices: &[DVec3],
) -> bool {
    if backwards && largest.edges <= 2 {
        return true;
    }
    if vertices.is_empty() {
        return false;
    }
    let pieces = pieces(target, chains);
    vertices.iter().take(MAX_VERTICES).any(|&vertex| lies_outside(target, chains, &pieces, vertex))
}

/// A piece of a loop, about straight.
struct Piece {
    uv: [DVec2; 2],
    points: [DVec3; 2],
}

impl Piece {
    /// Whether a point may lie on it. Of a curve that turns by half a radian a sixteenth of the chord's length is beside the chord.
    fn is_near(&self, point: DVec3, tolerance: f64) -> bool {
        let [a, b] = self.points;
        let along = b - a;
        let share = ((point - a).dot(along) / along.length_squared()).clamp(0.0, 1.0);
        let foot = if share.is_finite() { a + along * share } else { a };
        point.distance(foot) <= tolerance + along.length() / 16.0
    }

    /// Whether the ray from `p` along u meets it.
    fn is_crossed(&self, p: DVec2) -> bool {
        let [a, b] = self.uv;
        (a.y > p.y) != (b.y > p.y) && a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x) > p.x
    }
}

fn pieces(target: &Target, chains: &[Chain]) -> Vec<Piece> {
    let mut pieces = Vec::new();
    for segment in chains.iter().flat_map(|chain| &chain.segments) {
        let places: Vec<DVec2> = samples(segment).chain([end(segment)]).collect();
        let ends = places.windows(2).map(|ends| [ends[0], ends[1]]);
        pieces.extend(ends.map(|uv| Piece { uv, points: uv.map(|place| target.surface.point(place)) }));
    }
    pieces
}

/// Whether a vertex lies in none of the loops, nor on one: loops of a file may have shrunk to a vertex of the face's own boundary.
fn lies_outside(target: &Target, chains: &[Chain], pieces: &[Piece], vertex: DVec3) -> bool {
    if let Some(pole) = target.pole_at(vertex) {
        let axis = target.poles[pole].axis;
        let touches = |p: DVec2| p[axis] == target.pole_value(pole, p[axis]);
        return !chains.iter().flat_map(|chain| &chain.segments).any(|segment| touches(start(segment)));
    }
    if pieces.iter().any(|piece| piece.is_near(vertex, target.tolerance)) {
        return false;
    }
    let foot = invert_surface(target.surface, vertex, None).uv;
    let images = |axis: usize| target.periods[axis].map_or(vec![0.0], |period| vec![-period, 0.0, period]);
    let is_inside = |p: DVec2| pieces.iter().filter(|piece| piece.is_crossed(p)).count() % 2 == 1;
    let across = images(1);
    !images(0).iter().any(|&u| across.iter().any(|&v| is_inside(foot + DVec2::new(u, v))))
}
