//! The faces of a solid that a flat profile sweeps: straight on, about an axis, or one after the other.
//!
//! The sides are planes, cylinders, cones, spheres and tori where they are, else B-splines, both exactly. The profile's first and
//! last position are the caps; a full turn has none. Neighbouring faces share their edges.

use super::map_composite::Piece;
use super::map_swept::{recognise_extrusion, revolved_circle, revolved_line};
use crate::brep::{Coedge, Edge, Face, Id, Model, TrimLoop, Vertex};
use crate::geometry::{Curve, Frame, Surface, invert_surface, to_bspline};
use glam::{DAffine3, DVec3};
use std::f64::consts::TAU;

/// Angles that lack less than this of a full turn are one: files keep nine digits.
const FULL_TURN: f64 = TAU - 1e-7;

/// Points nearer to the axis than this share of the profile's size lie on it.
const ON_AXIS: f64 = 1e-9;

/// How a profile moves.
#[derive(Debug, Clone, Copy)]
pub enum Motion {
    /// By a vector.
    Along(DVec3),
    /// About the z axis of a frame, by an angle greater than 0 and at most a full turn.
    About(Frame, f64),
}

impl Motion {
    fn is_full_turn(&self) -> bool {
        matches!(self, Self::About(_, angle) if *angle >= FULL_TURN)
    }

    /// Where the profile comes to.
    pub fn transform(&self) -> DAffine3 {
        match self {
            Self::Along(vector) => DAffine3::from_translation(*vector),
            Self::About(axis, angle) => {
                let outer = axis.outer_from_local();
                outer * DAffine3::from_rotation_z(*angle) * outer.inverse()
            }
        }
    }

    /// The velocity of `point` at the start.
    fn velocity(&self, point: DVec3) -> DVec3 {
        match self {
            Self::Along(vector) => *vector,
            Self::About(axis, _) => axis.z.cross(point - axis.origin),
        }
    }

    /// The way of `point`; `None` where it stays.
    fn path(&self, point: DVec3, size: f64, entity: u64) -> Option<Piece> {
        match self {
            Self::Along(vector) => {
                let curve = Curve::Line { origin: point, direction: *vector };
                Some(Piece { curve, range: [0.0, 1.0], entity })
            }
            Self::About(axis, angle) => {
                let local = axis.local_point(point);
                let radius = local.truncate().length();
                let origin = axis.origin + axis.z * local.z;
                let frame = Frame::from_axes(origin, Some(axis.z), Some(point - origin));
                let range = [0.0, if self.is_full_turn() { TAU } else { *angle }];
                (radius > ON_AXIS * size).then_some(Piece {
                    curve: Curve::Circle { frame, radius },
                    range,
                    entity,
                })
            }
        }
    }

    /// The surface that `piece` sweeps.
    fn surface(&self, piece: &Piece) -> Surface {
        let range = [piece.range[0].min(piece.range[1]), piece.range[0].max(piece.range[1])];
        match self {
            Self::Along(vector) => {
                if let Some((surface, _)) = recognise_extrusion(&piece.curve, vector.normalize()) {
                    return surface;
                }
                let profile = to_bspline::curve_to_bspline(&piece.curve, range);
                Surface::Bspline(to_bspline::extrude(&profile, *vector, [0.0, 1.0]))
            }
            Self::About(axis, angle) => {
                let known = match &piece.curve {
                    Curve::Line { origin, direction } => {
                        let samples: Vec<DVec3> = [0.0, 0.5, 1.0].map(|s| piece.at(s)).to_vec();
                        revolved_line(axis, *origin, direction.normalize(), &samples).map(|m| m.surface)
                    }
                    Curve::Circle { frame, radius } => revolved_circle(axis, frame, *radius),
                    _ => None,
                };
                // A spindle torus has a second sheet, which the profile does not sweep.
                let is_spindle =
                    |s: &Surface| matches!(s, Surface::Torus { major, minor, .. } if minor > major);
                if let Some(surface) = known.filter(|surface| !is_spindle(surface)) {
                    return surface;
                }
                let profile = to_bspline::curve_to_bspline(&piece.curve, range);
                Surface::Bspline(if self.is_full_turn() {
                    to_bspline::revolve(&profile, axis)
                } else {
                    to_bspline::revolve_between(&profile, axis, [0.0, *angle])
                })
            }
        }
    }
}

/// Closed loops of pieces in a plane: one around, others inside of it.
#[derive(Debug, Clone)]
pub struct Profile {
    /// In any order and direction.
    pub loops: Vec<Vec<Piece>>,
    /// Normal of the plane, either way.
    pub normal: DVec3,
}

/// A loop's edges as they run, and how they run on their curves.
struct Ring {
    pieces: Vec<Piece>,
    edges: Vec<Coedge>,
    vertices: Vec<Id<Vertex>>,
}

/// The faces of the solid that `profile` sweeps by `motions`, one after the other, its normals outwards. `closed`: the last motion
/// ends where the first began.
pub fn sweep(
    model: &mut Model,
    mut profile: Profile,
    motions: &[Motion],
    closed: bool,
    entity: u64,
) -> Result<Vec<Face>, &'static str> {
    let Some(first) = motions.first() else { return Err("nothing moves the profile") };
    let samples = |pieces: &[Piece]| -> Vec<DVec3> {
        pieces.iter().flat_map(|p| (0..16).map(|i| p.at(f64::from(i) / 16.0))).collect()
    };
    let all: Vec<DVec3> = profile.loops.iter().flat_map(|pieces| samples(pieces)).collect();
    let centre = all.iter().copied().sum::<DVec3>() / all.len().max(1) as f64;
    let size = all.iter().map(|p| p.distance(centre)).fold(0.0, f64::max);
    profile.normal = profile.normal.normalize_or_zero();
    // The profile has to be left behind all over, to one side.
    let speeds: Vec<f64> = all.iter().map(|&p| first.velocity(p).dot(profile.normal)).collect();
    let fastest = speeds.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
    if fastest.abs() <= ON_AXIS * size {
        return Err("the profile moves in its own plane");
    }
    if speeds.iter().any(|speed| speed * fastest.signum() < -1e-6 * fastest.abs()) {
        return Err("the axis of revolution crosses the profile");
    }
    profile.normal *= fastest.signum();
    orient(&mut profile, &samples);
    let mut sweep = Sweep { model, entity, size, faces: Vec::new() };
    let mut rings: Vec<Ring> = profile.loops.into_iter().map(|pieces| sweep.ring(pieces)).collect();
    let mut normal = profile.normal;
    let is_ring = closed || (motions.len() == 1 && first.is_full_turn());
    if !is_ring {
        sweep.cap(&rings, -normal, true);
    }
    for motion in motions {
        let transform = motion.transform();
        rings = rings.iter().map(|ring| sweep.sides(ring, normal, motion, &transform)).collect();
        normal = transform.transform_vector3(normal);
    }
    if !is_ring {
        sweep.cap(&rings, normal, false);
    }
    Ok(sweep.faces)
}

/// The outer loop counter-clockwise about the normal, the others clockwise: the profile then lies to their left.
fn orient(profile: &mut Profile, samples: &impl Fn(&[Piece]) -> Vec<DVec3>) {
    let area = |pieces: &[Piece]| -> f64 {
        let points = samples(pieces);
        let Some(&origin) = points.first() else { return 0.0 };
        let next = points.iter().cycle().skip(1);
        points.iter().zip(next).map(|(a, b)| (*a - origin).cross(*b - origin).dot(profile.normal)).sum()
    };
    let areas: Vec<f64> = profile.loops.iter().map(|pieces| area(pieces)).collect();
    let outer = (0..areas.len()).max_by(|&a, &b| areas[a].abs().total_cmp(&areas[b].abs()));
    for (i, pieces) in profile.loops.iter_mut().enumerate() {
        if (areas[i] < 0.0) == (Some(i) == outer) {
            pieces.reverse();
            pieces.iter_mut().for_each(|piece| piece.range.reverse());
        }
    }
}

struct Sweep<'m> {
    model: &'m mut Model,
    entity: u64,
    size: f64,
    faces: Vec<Face>,
}

impl Sweep<'_> {
    fn vertex(&mut self, point: DVec3) -> Id<Vertex> {
        self.model.vertices.push(Vertex { point, entity: self.entity })
    }

    fn edge(&mut self, Piece { curve, range, .. }: Piece, vertices: [Id<Vertex>; 2]) -> Coedge {
        let edge = Edge { curve, range, vertices, pcurves: Vec::new(), entity: self.entity };
        Coedge { edge: self.model.edges.push(edge), reversed: false }
    }

    fn ring(&mut self, pieces: Vec<Piece>) -> Ring {
        let vertices: Vec<_> = pieces.iter().map(|piece| self.vertex(piece.at(0.0))).collect();
        let count = vertices.len();
        let edges = pieces
            .iter()
            .enumerate()
            .map(|(i, piece)| self.edge(piece.clone(), [vertices[i], vertices[(i + 1) % count]]));
        Ring { edges: edges.collect(), pieces, vertices }
    }

    fn cap(&mut self, rings: &[Ring], outwards: DVec3, reversed: bool) {
        let origin = self.model.vertices[rings[0].vertices[0]].point;
        let frame = Frame::from_axes(origin, Some(outwards), None);
        let run = |ring: &Ring| {
            let edges = ring.edges.iter().map(|c| Coedge { reversed, ..*c });
            TrimLoop::Edges(if reversed { edges.rev().collect() } else { edges.collect() })
        };
        let loops = rings.iter().map(run).collect();
        self.face(Surface::Plane { frame }, true, loops);
    }

    fn face(&mut self, surface: Surface, same_sense: bool, loops: Vec<TrimLoop>) {
        let surface = self.model.surfaces.push(surface);
        let face = Face { surface, same_sense, loops, color: None, name: String::new(), entity: self.entity };
        self.faces.push(face);
    }

    /// The faces that the pieces of a loop sweep; returns the loop as it arrives.
    fn sides(&mut self, ring: &Ring, normal: DVec3, motion: &Motion, transform: &DAffine3) -> Ring {
        let count = ring.pieces.len();
        let is_full_turn = motion.is_full_turn();
        let ways: Vec<Option<Piece>> =
            ring.pieces.iter().map(|piece| motion.path(piece.at(0.0), self.size, self.entity)).collect();
        let end = if is_full_turn {
            Ring { pieces: ring.pieces.clone(), edges: ring.edges.clone(), vertices: ring.vertices.clone() }
        } else {
            self.arrived(ring, transform, &ways)
        };
        let paths: Vec<Option<Coedge>> = ways
            .into_iter()
            .enumerate()
            // The ends of a single piece meet on a closed side, which needs no edge there.
            .map(|(i, way)| {
                (count > 1).then_some(())?;
                Some(self.edge(way?, [ring.vertices[i], end.vertices[i]]))
            })
            .collect();
        for (i, piece) in ring.pieces.iter().enumerate() {
            let next = (i + 1) % count;
            let is_on_axis = |s: f64| motion.path(piece.at(s), self.size, self.entity).is_none();
            if [0.0, 0.25, 0.5, 0.75, 1.0].into_iter().all(is_on_axis) {
                continue;
            }
            let surface = motion.surface(piece);
            let back = |coedge: Coedge| Coedge { reversed: true, ..coedge };
            let loops = if is_full_turn {
                let rings = [paths[next], paths[i].map(back)];
                let closed = |(coedge, vertex): (Option<Coedge>, Id<Vertex>)| match coedge {
                    Some(coedge) => Some(TrimLoop::Edges(vec![coedge])),
                    // A plane has no pole: its middle is like any other point.
                    None if count == 1 || matches!(surface, Surface::Plane { .. }) => None,
                    None => Some(TrimLoop::Vertex(vertex)),
                };
                rings.into_iter().zip([ring.vertices[next], ring.vertices[i]]).filter_map(closed).collect()
            } else if count == 1 {
                vec![TrimLoop::Edges(vec![ring.edges[i]]), TrimLoop::Edges(vec![back(end.edges[i])])]
            } else {
                let around = [Some(ring.edges[i]), paths[next], Some(back(end.edges[i])), paths[i].map(back)];
                vec![TrimLoop::Edges(around.into_iter().flatten().collect())]
            };
            let same_sense = self.points_out(&surface, piece, normal);
            self.face(surface, same_sense, loops);
        }
        end
    }

    /// The loop at the end of a motion; points that stay keep their vertex.
    fn arrived(&mut self, ring: &Ring, transform: &DAffine3, ways: &[Option<Piece>]) -> Ring {
        let pieces: Vec<Piece> = ring
            .pieces
            .iter()
            .map(|piece| Piece { curve: piece.curve.transformed(transform), ..piece.clone() })
            .collect();
        let vertices: Vec<_> = (0..pieces.len())
            .map(|i| match ways[i] {
                Some(_) => self.vertex(pieces[i].at(0.0)),
                None => ring.vertices[i],
            })
            .collect();
        let count = vertices.len();
        let edges = pieces
            .iter()
            .enumerate()
            .map(|(i, piece)| self.edge(piece.clone(), [vertices[i], vertices[(i + 1) % count]]));
        Ring { edges: edges.collect(), pieces, vertices }
    }

    /// Whether the surface's normal points away from the profile, which lies to the left of its loop.
    fn points_out(&self, surface: &Surface, piece: &Piece, normal: DVec3) -> bool {
        let middle = 0.5 * (piece.range[0] + piece.range[1]);
        let along = piece.curve.derivatives(middle).first * (piece.range[1] - piece.range[0]);
        let point = piece.curve.point(middle);
        let at = surface.derivatives(invert_surface(surface, point, None).uv);
        at.du.cross(at.dv).dot(along.cross(normal)) > 0.0
    }
}
