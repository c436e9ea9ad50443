//! Constructive solids: block (150), wedge (152), cylinder (154), cone (156), sphere (158), torus (160), solid of revolution (162),
//! solid of linear extrusion (164), ellipsoid (168).
//!
//! Sides of the two swept solids are the swept surfaces of their profile, each as large as its own parameters; their ends are planes
//! trimmed by the profile.

use super::boundary::{Bound, trim_loop};
use super::curve::{self, Piece};
use super::directory::{Mapped, Parameters};
use super::reader::Reader;
use super::spans;
use super::style;
use super::swept::turned;
use crate::brep::{Body, BodyKind, Color, Face, Id, TrimLoop, primitive};
use crate::geometry::{BsplineSurface, Curve, Frame, Homogeneous, Homogeneous3, Surface, to_bspline};
use crate::numeric::Aabb;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// The ends of a closed profile meet within this share of its size.
const CLOSED: f64 = 1e-5;

/// A piece of a profile nearer to the axis than this share of its size makes no surface.
const ON_AXIS: f64 = 1e-9;

impl Reader<'_> {
    /// A constructive solid in its own space, millimetres. Its faces are declared as it is read.
    pub fn constructive(&mut self, entity: u32, inherited: Option<Color>) -> Mapped<Body> {
        let parameters = self.file.parameters(entity)?;
        let (faces, own) = match parameters.kind {
            162 => (self.revolved_solid(&parameters)?, 8),
            164 => (self.extruded_solid(&parameters)?, 5),
            _ => self.primitive(&parameters)?,
        };
        self.model.declared_faces += faces.len();
        let color = style::color(&self.file, entity).or(inherited);
        for face in &faces {
            self.model.faces[*face].color = color;
        }
        let name = style::name(&self.file, &parameters, 1 + own);
        Ok(Body { kind: BodyKind::Solid, faces, name, entity: entity.into() })
    }

    /// The faces of a primitive, and how many parameters it has.
    fn primitive(&mut self, parameters: &Parameters) -> Mapped<(Vec<Id<Face>>, usize)> {
        let millimetres = self.unit.matrix3.x_axis.x;
        let entity = parameters.entity.into();
        let length = |at: usize| Ok(parameters.real(at)? * millimetres);
        let origin = |at: usize| Ok(self.unit.transform_point3(parameters.point(at)?));
        // An origin, then x and z.
        let two_axes = |at: usize| -> Mapped<Frame> {
            let x = parameters.direction(at + 3, DVec3::X)?;
            let z = parameters.direction(at + 6, DVec3::Z)?;
            Ok(Frame::from_axes(origin(at)?, Some(z), Some(x)))
        };
        let one_axis = |at: usize| -> Mapped<Frame> {
            Ok(Frame::from_axes(origin(at)?, Some(parameters.direction(at + 3, DVec3::Z)?), None))
        };
        let size = |at: usize| -> Mapped<DVec3> { Ok(parameters.point(at)? * millimetres) };
        let all_positive = |size: DVec3| size.min_element() > 0.0 && size.is_finite();
        let model = &mut self.model;
        let (faces, own) = match parameters.kind {
            150 => {
                let (size, frame) = (size(1)?, two_axes(4)?);
                let faces =
                    all_positive(size).then(|| primitive::block(model, &frame, size, entity)).flatten();
                (faces, 12)
            }
            152 => {
                let (size, short, frame) = (size(1)?, length(4)?, two_axes(5)?);
                let mut polygon = vec![[0.0, 0.0], [size.x, 0.0], [short, size.y], [0.0, size.y]];
                if short == 0.0 {
                    polygon.pop();
                }
                let possible = all_positive(size) && (0.0..size.x).contains(&short);
                let faces =
                    possible.then(|| primitive::prism(model, &frame, &polygon, size.z, entity)).flatten();
                (faces, 13)
            }
            154 => {
                let (height, radius, frame) = (length(1)?, length(2)?, one_axis(3)?);
                (primitive::frustum(model, &frame, [radius; 2], height, entity), 8)
            }
            156 => {
                let (height, radii, frame) = (length(1)?, [length(2)?, length(3)?], one_axis(4)?);
                (primitive::frustum(model, &frame, radii, height, entity), 9)
            }
            158 => {
                let (radius, center) = (length(1)?, origin(2)?);
                let frame = Frame::from_axes(center, None, None);
                (primitive::sphere(model, &frame, radius, entity), 4)
            }
            160 => {
                let (radii, frame) = ([length(1)?, length(2)?], one_axis(3)?);
                (primitive::torus(model, &frame, radii, entity), 8)
            }
            _ => {
                let (size, frame) = (size(1)?, two_axes(4)?);
                let faces = all_positive(size).then(|| {
                    let surface = ellipsoid(&frame, size);
                    vec![self.whole_face(surface, true, parameters.entity)]
                });
                (faces, 12)
            }
        };
        let faces = faces.ok_or_else(|| parameters.problem("its sizes make no solid"))?;
        Ok((faces, own))
    }

    /// A face as large as its surface's parameters.
    fn whole_face(&mut self, surface: BsplineSurface, same_sense: bool, entity: u32) -> Id<Face> {
        self.push_face(Surface::Bspline(surface), same_sense, Vec::new(), entity)
    }

    fn push_face(
        &mut self,
        surface: Surface,
        same_sense: bool,
        loops: Vec<TrimLoop>,
        entity: u32,
    ) -> Id<Face> {
        let surface = self.model.surfaces.push(surface);
        let (color, name) = (None, String::new());
        self.model.faces.push(Face { surface, same_sense, loops, color, name, entity: entity.into() })
    }

    /// Entity 162: a planar curve, the share of a turn, a point and the direction of the axis. An open curve is closed by
    /// perpendiculars to the axis (form 0), or by a line between its ends (form 1).
    fn revolved_solid(&mut self, parameters: &Parameters) -> Mapped<Vec<Id<Face>>> {
        let mut profile = self.profile(parameters)?;
        let share = match parameters.values.get(2) {
            Some(super::value::Value::Number(share)) => *share,
            _ => 1.0,
        };
        if !(share > 0.0 && share <= 1.0) {
            return Err(parameters.problem("the share of a turn is not in (0, 1]"));
        }
        let origin = self.unit.transform_point3(parameters.point(3)?);
        let axis = parameters.direction(6, DVec3::Z)?;
        let foot = |point: DVec3| origin + axis * (point - origin).dot(axis);
        let size = size(&profile);
        let off_axis = |piece: &Piece| {
            (0..=4).map(|i| piece.at(f64::from(i) / 4.0)).any(|p| p.distance(foot(p)) > ON_AXIS * size)
        };
        if let Some([start, end]) = open_ends(&profile, size) {
            let corners = match self.entry(parameters.entity).form {
                1 => vec![end, start],
                _ => vec![end, foot(end), foot(start), start],
            };
            let lines = corners.windows(2).filter(|w| w[0].distance(w[1]) > ON_AXIS * size);
            profile.extend(lines.map(|w| line(w[0], w[1], parameters.entity)));
        }
        let angle = share * TAU;
        let frame = plane(&profile).ok_or_else(|| parameters.problem("the profile spans no plane"))?;
        let middle = profile.iter().map(|piece| piece.at(0.5) - origin).sum::<DVec3>();
        let outwards = frame.z.dot(axis.cross(middle)) > 0.0;
        let mut faces = Vec::new();
        for piece in profile.iter().filter(|piece| off_axis(piece)) {
            let spans = spans::of_curve(&piece.curve, piece.range, [0.0, 1.0]);
            let spline = spans::joined(&spans).map_err(|error| parameters.problem(error.to_string()))?;
            let (surface, _) = turned(&spline, origin, axis, [0.0, angle], [0.0, angle]);
            let surface = surface.map_err(|error| parameters.problem(error.to_string()))?;
            faces.push(self.whole_face(surface, outwards, parameters.entity));
        }
        if share < 1.0 {
            let turn = DAffine3::from_translation(origin)
                * DAffine3::from_quat(DQuat::from_axis_angle(axis, angle))
                * DAffine3::from_translation(-origin);
            faces.extend(self.ends(parameters.entity, &profile, frame, &turn, outwards));
        }
        Ok(faces)
    }

    /// Entity 164: a closed planar curve, a length, a direction.
    fn extruded_solid(&mut self, parameters: &Parameters) -> Mapped<Vec<Id<Face>>> {
        let profile = self.profile(parameters)?;
        if open_ends(&profile, size(&profile)).is_some() {
            return Err(parameters.problem("the profile is not closed"));
        }
        let length = parameters.real(2)? * self.unit.matrix3.x_axis.x;
        if !(length > 0.0 && length.is_finite()) {
            return Err(parameters.problem("the solid has no length"));
        }
        let along = parameters.direction(3, DVec3::Z)? * length;
        let frame = plane(&profile).ok_or_else(|| parameters.problem("the profile spans no plane"))?;
        let outwards = frame.z.dot(along) > 0.0;
        let mut faces = Vec::new();
        for piece in &profile {
            let spans = spans::of_curve(&piece.curve, piece.range, [0.0, 1.0]);
            let spline = spans::joined(&spans).map_err(|error| parameters.problem(error.to_string()))?;
            let side = to_bspline::extrude(&spline, along, [0.0, 1.0]);
            faces.push(self.whole_face(side, outwards, parameters.entity));
        }
        let place = DAffine3::from_translation(along);
        faces.extend(self.ends(parameters.entity, &profile, frame, &place, outwards));
        Ok(faces)
    }

    fn profile(&self, parameters: &Parameters) -> Mapped<Vec<Piece>> {
        let pieces = curve::pieces(&self.file, parameters.reference(1)?, &self.unit)?;
        if pieces.is_empty() {
            return Err(parameters.problem("the profile is empty"));
        }
        Ok(pieces)
    }

    /// The planes at the two ends of a swept solid: `frame` at its start, moved by `place` at its end. The profile runs
    /// counter-clockwise about the frame's axis; `outwards` tells whether that axis points the way the profile goes.
    fn ends(
        &mut self,
        entity: u32,
        profile: &[Piece],
        frame: Frame,
        place: &DAffine3,
        outwards: bool,
    ) -> [Id<Face>; 2] {
        let moved =
            profile.iter().map(|p| Piece { curve: p.curve.transformed(place), ..p.clone() }).collect();
        let ends = [(profile.to_vec(), frame, !outwards), (moved, frame.transformed(place), outwards)];
        ends.map(|(pieces, frame, same_sense)| {
            let bounds = pieces.into_iter().map(Bound::from).collect();
            let loops = trim_loop(&mut self.model, bounds, self.resolution).into_iter().collect();
            self.push_face(Surface::Plane { frame }, same_sense, loops, entity)
        })
    }
}

fn line(start: DVec3, end: DVec3, entity: u32) -> Piece {
    let curve = Curve::Line { origin: start, direction: end - start };
    Piece { curve, range: [0.0, 1.0], own: [0.0, 1.0], entity }
}

fn size(pieces: &[Piece]) -> f64 {
    Aabb::around(pieces.iter().flat_map(|p| (0..=4).map(|i| p.at(f64::from(i) / 4.0)))).diagonal()
}

/// Start and end where they are apart.
fn open_ends(pieces: &[Piece], size: f64) -> Option<[DVec3; 2]> {
    let (first, last) = (pieces.first()?, pieces.last()?);
    let (start, end) = (first.ends()[0], last.ends()[1]);
    (start.distance(end) > CLOSED * size).then_some([start, end])
}

/// The plane of a closed chain of curves: its normal is twice the area vector of a polygon along it (Newell).
fn plane(pieces: &[Piece]) -> Option<Frame> {
    let points: Vec<DVec3> =
        pieces.iter().flat_map(|p| (0..16).map(move |i| p.at(f64::from(i) / 16.0))).collect();
    let origin = *points.first()?;
    let next = points.iter().skip(1).chain([&origin]);
    let normal: DVec3 = points.iter().zip(next).map(|(a, b)| (*a - origin).cross(*b - origin)).sum();
    normal.try_normalize().map(|normal| Frame::from_axes(origin, Some(normal), None))
}

/// The ellipsoid with half axes `radii` along those of `frame`: a rational B-spline.
fn ellipsoid(frame: &Frame, radii: DVec3) -> BsplineSurface {
    // From pole to pole in the x-z plane.
    let meridian = Frame::from_axes(DVec3::ZERO, Some(-DVec3::Y), Some(DVec3::X));
    let circle = Curve::Circle { frame: meridian, radius: 1.0 };
    let half = to_bspline::curve_to_bspline(&circle, [-FRAC_PI_2, FRAC_PI_2]);
    let sphere = to_bspline::revolve(&half, &Frame::IDENTITY);
    let axes = DMat3::from_cols(frame.x * radii.x, frame.y * radii.y, frame.z * radii.z);
    let place = DAffine3::from_mat3_translation(axes, frame.origin);
    let moved = |point: &Homogeneous3| {
        let inside = place.transform_point3(Homogeneous::point(*point));
        <Homogeneous3 as Homogeneous>::new(inside, point.w)
    };
    BsplineSurface { points: sphere.points.iter().map(moved).collect(), ..sphere }
}
