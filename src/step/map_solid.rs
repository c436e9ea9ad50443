//! Solids whose faces the file does not list (ISO 10303-42: swept_area_solid, swept_face_solid, swept_disk_solid, csg_primitive,
//! csg_solid): they are made here, exactly, by sweeping profiles. The faces that are made count as declared.
//!
//! Boolean results need intersections of surfaces and are not read, but for unions of solids that are apart.

use super::map_composite::{MEETING, Piece};
use super::map_geometry::positive_length;
use super::map_style::Styles;
use super::reader::{MAX_CHAIN, Mapped, Reader, problem, real, reference};
use super::sweep::{Motion, Profile, sweep};
use super::value::{Entity, Record};
use crate::brep::{Body, BodyKind, Coedge, Color, Face, Severity, TrimLoop};
use crate::geometry::{Curve, Frame, Surface, to_bspline};
use crate::numeric::Aabb;
use glam::{DAffine3, DMat3, DVec2, DVec3};
use std::f64::consts::{FRAC_PI_2, TAU};

impl Reader<'_> {
    /// The solid `entity` of one of the kinds whose faces are made.
    pub fn generated_body(
        &mut self,
        entity: &Entity,
        styles: &Styles,
        color: Option<Color>,
        depth: usize,
    ) -> Mapped<Body> {
        self.taken_bodies.insert(entity.id);
        if depth > MAX_CHAIN {
            return Err(problem(entity, "solids refer to each other in a circle"));
        }
        if entity.is("SOLID_REPLICA") {
            return self.replica(entity, styles, color, depth);
        }
        let faces = self.made_faces(entity, depth)?;
        self.model.declared_faces += faces.len();
        let faces = faces.into_iter().map(|face| self.model.faces.push(Face { color, ..face })).collect();
        Ok(Body { kind: BodyKind::Solid, faces, name: entity.first().text(0), entity: entity.id })
    }

    /// The faces of a solid, none of them in the model yet.
    fn made_faces(&mut self, entity: &Entity, depth: usize) -> Mapped<Vec<Face>> {
        let record = entity.first();
        let length = |reader: &Self, at| positive_length(reader, entity, record, at);
        let motion = match &*record.keyword {
            "CSG_SOLID" | "BOOLEAN_RESULT" => return self.tree(entity, depth),
            "RECTANGULAR_PYRAMID" => return self.pyramid(entity),
            "TETRAHEDRON" | "CONVEX_HEXAHEDRON" => return self.faceted_primitive(entity),
            "ELLIPSOID" => return self.ellipsoid(entity, record),
            "SWEPT_DISK_SOLID" => return self.swept_disk(entity, record),
            "EXTRUDED_AREA_SOLID" | "EXTRUDED_FACE_SOLID" => {
                let direction = self.direction(reference(entity.id, record, 2)?)?.normalize_or_zero();
                Motion::Along(direction * length(self, 3)?)
            }
            "REVOLVED_AREA_SOLID" | "REVOLVED_FACE_SOLID" => {
                let axis = self.placement(reference(entity.id, record, 2)?)?;
                about(axis, real(entity.id, record, 3)? * self.units.radians)
                    .ok_or_else(|| problem(entity, "the angle is 0"))?
            }
            "BLOCK" | "RIGHT_ANGULAR_WEDGE" => {
                let frame = self.placement(reference(entity.id, record, 1)?)?;
                let [x, y, z] = [length(self, 2)?, length(self, 3)?, length(self, 4)?];
                let top = if record.keyword == "BLOCK" {
                    x
                } else {
                    real(entity.id, record, 5)? * self.units.millimetres
                };
                let corners = [[0.0, 0.0], [x, 0.0], [top, y], [0.0, y]].map(DVec2::from_array);
                return self.swept(entity, polygon(&frame, &corners), &[Motion::Along(frame.z * z)], false);
            }
            "RIGHT_CIRCULAR_CYLINDER" => {
                let frame = self.placement(reference(entity.id, record, 1)?)?;
                let motion = Motion::Along(frame.z * length(self, 2)?);
                return self.swept(entity, disk(&frame, &[length(self, 3)?]), &[motion], false);
            }
            "RIGHT_CIRCULAR_CONE" => {
                let frame = self.placement(reference(entity.id, record, 1)?)?;
                let (height, radius) =
                    (length(self, 2)?, real(entity.id, record, 3)? * self.units.millimetres);
                let half_angle = real(entity.id, record, 4)? * self.units.radians;
                let far = radius + height * half_angle.tan();
                if !(radius >= 0.0 && far > 0.0 && half_angle.abs() < FRAC_PI_2) {
                    return Err(problem(entity, "a cone without such a radius or angle"));
                }
                let corners =
                    [[0.0, 0.0], [radius, 0.0], [far, height], [0.0, height]].map(DVec2::from_array);
                let profile = polygon(&meridian(&frame), &corners);
                return self.swept(entity, profile, &[Motion::About(frame, TAU)], false);
            }
            "SPHERE" => {
                let radius = length(self, 1)?;
                let frame =
                    Frame { origin: self.point(reference(entity.id, record, 2)?)?, ..Frame::IDENTITY };
                let profile = half_disk(&meridian(&frame), radius);
                return self.swept(entity, profile, &[Motion::About(frame, TAU)], false);
            }
            "TORUS" => {
                let frame = self.placement(reference(entity.id, record, 1)?)?;
                let (major, minor) = (length(self, 2)?, length(self, 3)?);
                if minor >= major {
                    return Err(problem(entity, "a torus that meets itself bounds no solid"));
                }
                let tube = meridian(&Frame { origin: frame.origin + frame.x * major, ..frame });
                return self.swept(entity, disk(&tube, &[minor]), &[Motion::About(frame, TAU)], false);
            }
            "HALF_SPACE_SOLID" | "BOXED_HALF_SPACE" => {
                return Err(problem(entity, "a half space has no end; it only serves to cut others"));
            }
            _ => return Err(problem(entity, "this kind of solid is not read")),
        };
        let area = reference(entity.id, record, 1)?;
        let profile =
            if record.keyword.contains("FACE") { self.face_profile(area)? } else { self.area_profile(area)? };
        self.swept(entity, profile, &[motion], false)
    }

    fn swept(
        &mut self,
        entity: &Entity,
        profile: Profile,
        motions: &[Motion],
        closed: bool,
    ) -> Mapped<Vec<Face>> {
        sweep(&mut self.model, profile, motions, closed, entity.id).map_err(|reason| problem(entity, reason))
    }

    /// A CURVE_BOUNDED_SURFACE in a plane.
    fn area_profile(&mut self, id: u64) -> Mapped<Profile> {
        let area = self.entity(id)?;
        let record = area.record("CURVE_BOUNDED_SURFACE");
        let record = record.ok_or_else(|| problem(&area, "expected a CURVE_BOUNDED_SURFACE"))?;
        let at = if area.records.len() > 1 { 0 } else { 1 };
        let basis = self.map_surface(reference(id, record, at)?, &[], 0)?.surface;
        let Surface::Plane { frame } = basis else {
            return Err(problem(&area, "the swept area is not flat"));
        };
        let mut loops = Vec::new();
        for boundary in record.references(at + 1) {
            loops.push(self.closed_pieces(boundary)?);
        }
        loops.retain(|pieces| !pieces.is_empty());
        if loops.is_empty() {
            return Err(problem(&area, "the swept area has no bounds"));
        }
        Ok(Profile { loops, normal: frame.z })
    }

    /// A FACE_SURFACE in a plane.
    fn face_profile(&mut self, id: u64) -> Mapped<Profile> {
        let entity = self.entity(id)?;
        let face = self.face(&entity, false)?;
        let Surface::Plane { frame } = &self.model.surfaces[face.surface] else {
            return Err(problem(&entity, "the swept face is not flat"));
        };
        let mut loops = Vec::new();
        for trim in &face.loops {
            let TrimLoop::Edges(coedges) = trim else { continue };
            let piece = |c: &Coedge| {
                let edge = &self.model.edges[c.edge];
                let [a, b] = edge.range;
                Piece {
                    curve: edge.curve.clone(),
                    range: if c.reversed { [b, a] } else { [a, b] },
                    entity: id,
                }
            };
            loops.push(coedges.iter().map(piece).collect());
        }
        if loops.is_empty() {
            return Err(problem(&entity, "the swept face has no bounds"));
        }
        Ok(Profile { loops, normal: frame.z })
    }

    /// `SWEPT_DISK_SOLID(name, directrix, radius, inner radius, start, end)`: along lines and arcs that join smoothly.
    fn swept_disk(&mut self, entity: &Entity, record: &Record) -> Mapped<Vec<Face>> {
        let directrix = reference(entity.id, record, 1)?;
        let mut radii = vec![positive_length(self, entity, record, 2)?];
        radii.extend(record.real(3).map(|inner| inner * self.units.millimetres).filter(|inner| *inner > 0.0));
        let mut pieces = Vec::new();
        for repair in self.pieces(directrix, 0, &mut pieces)? {
            self.report(Severity::Repaired, repair);
        }
        // The parameters of a composite curve count through its segments: those are taken as a whole.
        if let [piece] = pieces.as_mut_slice() {
            let scale = self.curve_scale(&piece.curve);
            let [low, high] = [piece.range[0].min(piece.range[1]), piece.range[0].max(piece.range[1])];
            let end = |at: usize, other: f64| record.real(at).map_or(other, |t| (t * scale).clamp(low, high));
            let (from, to) = (end(4, low), end(5, high));
            if from < to {
                piece.range = if piece.range[0] <= piece.range[1] { [from, to] } else { [to, from] };
            }
        }
        let Some(first) = pieces.first() else { return Err(problem(entity, "the directrix has no length")) };
        let (start, direction) = (first.at(0.0), tangent(first, 0.0));
        let frame = Frame::from_axes(start, Some(direction), None);
        let mut motions = Vec::with_capacity(pieces.len());
        let mut end = (start, direction);
        for piece in &pieces {
            let is_smooth = tangent(piece, 0.0).dot(end.1) > 1.0 - MEETING;
            if !is_smooth {
                return Err(problem(entity, "the directrix has a corner"));
            }
            motions.push(match &piece.curve {
                Curve::Line { .. } => Motion::Along(piece.at(1.0) - piece.at(0.0)),
                Curve::Circle { frame, radius } if *radius > radii[0] => {
                    about(*frame, piece.range[1] - piece.range[0])
                        .ok_or_else(|| problem(entity, "an arc without length"))?
                }
                Curve::Circle { .. } => {
                    return Err(problem(entity, "an arc of the directrix is narrower than the disk"));
                }
                _ => return Err(problem(entity, "only lines and arcs are followed")),
            });
            end = (piece.at(1.0), tangent(piece, 1.0));
        }
        let closed = motions.len() > 1
            && end.0.distance(start) <= MEETING * radii[0]
            && end.1.dot(direction) > 1.0 - MEETING;
        self.swept(entity, disk(&frame, &radii), &motions, closed)
    }

    /// `ELLIPSOID(name, position, semi-axes 1, 2, 3)`: a sphere, stretched.
    fn ellipsoid(&mut self, entity: &Entity, record: &Record) -> Mapped<Vec<Face>> {
        let frame = self.placement(reference(entity.id, record, 1)?)?;
        let axes = [2, 3, 4].map(|at| positive_length(self, entity, record, at));
        let [a, b, c] = axes;
        let stretch = DMat3::from_diagonal(DVec3::new(a?, b?, c?));
        let transform = frame.outer_from_local() * DAffine3::from_mat3(stretch);
        let circle = Curve::Circle { frame: meridian(&Frame::IDENTITY), radius: 1.0 };
        let profile = to_bspline::curve_to_bspline(&circle, [-FRAC_PI_2, FRAC_PI_2]);
        let mut surface = to_bspline::revolve(&profile, &Frame::IDENTITY);
        for point in &mut surface.points {
            *point = (transform.transform_vector3(point.truncate()) + transform.translation * point.w)
                .extend(point.w);
        }
        let surface = self.model.surfaces.push(Surface::Bspline(surface));
        let (loops, name) = (Vec::new(), String::new());
        Ok(vec![Face { surface, same_sense: true, loops, color: None, name, entity: entity.id }])
    }

    /// `CSG_SOLID(name, root)` and `BOOLEAN_RESULT(name, operator, first, second)`.
    fn tree(&mut self, entity: &Entity, depth: usize) -> Mapped<Vec<Face>> {
        if depth > MAX_CHAIN {
            return Err(problem(entity, "solids refer to each other in a circle"));
        }
        // A tree may use a branch again and again.
        self.charge(entity, 1)?;
        let record = entity.first();
        if record.keyword == "CSG_SOLID" {
            let root = self.referred(entity.id, record, 1)?;
            return self.made_faces(&root, depth + 1);
        }
        let operator = record.get(1).enumeration().unwrap_or_default();
        if operator != "UNION" {
            let reason = format!("the {} of two solids is not computed", operator.to_lowercase());
            return Err(problem(entity, reason));
        }
        let operands = [self.referred(entity.id, record, 2)?, self.referred(entity.id, record, 3)?];
        let first = self.made_faces(&operands[0], depth + 1)?;
        let second = self.made_faces(&operands[1], depth + 1)?;
        let boxes = [&first, &second].map(|faces| self.box_around(faces));
        let is_apart = boxes[0].min.cmpgt(boxes[1].max).any() || boxes[1].min.cmpgt(boxes[0].max).any();
        if !is_apart {
            return Err(problem(entity, "the union of two solids that may meet is not computed"));
        }
        Ok(first.into_iter().chain(second).collect())
    }

    /// A box that holds the faces: their edges, and all of the surfaces that bulge beyond those.
    fn box_around(&self, faces: &[Face]) -> Aabb {
        let mut bounds = Aabb::EMPTY;
        for face in faces {
            let surface = &self.model.surfaces[face.surface];
            let domain = surface.domain();
            if domain.min.is_finite() && domain.max.is_finite() {
                bounds = bounds.union(surface.bounds(domain));
            }
            for trim in &face.loops {
                let TrimLoop::Edges(coedges) = trim else { continue };
                for edge in coedges.iter().map(|c| &self.model.edges[c.edge]) {
                    let around = match &edge.curve {
                        Curve::Circle { frame, radius } => Aabb::around([frame.origin]).grown(*radius),
                        Curve::Ellipse { frame, radii } => {
                            Aabb::around([frame.origin]).grown(radii[0].max(radii[1]))
                        }
                        curve => {
                            let spline = to_bspline::curve_to_bspline(curve, edge.range);
                            Aabb::around(spline.points.iter().map(|p| p.truncate() / p.w))
                        }
                    };
                    bounds = bounds.union(around);
                }
            }
        }
        bounds
    }
}

/// A turn about the z axis, or about its opposite for a negative angle.
fn about(axis: Frame, angle: f64) -> Option<Motion> {
    let turned = Frame { y: -axis.y, z: -axis.z, ..axis };
    let frame = if angle < 0.0 { turned } else { axis };
    (angle != 0.0 && angle.is_finite()).then_some(Motion::About(frame, angle.abs().min(TAU)))
}

/// The unit tangent in the direction of a piece.
fn tangent(piece: &Piece, s: f64) -> DVec3 {
    let [a, b] = piece.range;
    (piece.curve.derivatives(a + s * (b - a)).first * (b - a)).normalize_or_zero()
}

/// The plane through the z axis of `frame`: its x is x, its y is z.
fn meridian(frame: &Frame) -> Frame {
    Frame { y: frame.z, z: -frame.y, ..*frame }
}

/// A polygon in the plane of `frame`, without sides that have no length.
fn polygon(frame: &Frame, corners: &[DVec2]) -> Profile {
    let next = corners.iter().cycle().skip(1);
    let sides = corners.iter().zip(next).filter(|(a, b)| a != b).map(|(a, b)| {
        let [origin, end] = [a, b].map(|p| frame.point(p.extend(0.0)));
        Piece { curve: Curve::Line { origin, direction: end - origin }, range: [0.0, 1.0], entity: 0 }
    });
    Profile { loops: vec![sides.collect()], normal: frame.z }
}

/// Circles about the origin of `frame`.
fn disk(frame: &Frame, radii: &[f64]) -> Profile {
    let circle = |radius: &f64| {
        vec![Piece { curve: Curve::Circle { frame: *frame, radius: *radius }, range: [0.0, TAU], entity: 0 }]
    };
    Profile { loops: radii.iter().map(circle).collect(), normal: frame.z }
}

/// The half of a disk with positive x.
fn half_disk(frame: &Frame, radius: f64) -> Profile {
    let arc =
        Piece { curve: Curve::Circle { frame: *frame, radius }, range: [-FRAC_PI_2, FRAC_PI_2], entity: 0 };
    let [top, bottom] = [1.0, -1.0].map(|side| frame.origin + frame.y * (side * radius));
    let axis = Curve::Line { origin: top, direction: bottom - top };
    Profile { loops: vec![vec![arc, Piece { curve: axis, range: [0.0, 1.0], entity: 0 }]], normal: frame.z }
}
