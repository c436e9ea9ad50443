//! Surfaces that are faces by themselves (ISO 10303-42: geometric_set, curve_bounded_surface, rectangular_trimmed_surface),
//! without any topology: their bounds are curves, parameters, or their own ends.
//!
//! A surface counts as a declared face once a representation is found to hold it. One without an end is no face: such
//! surfaces stand in sets as references for dimensions and features.

use super::map_composite::{MEETING, Piece, turn};
use super::map_style::Styles;
use super::map_topology::{FACE_KEYWORDS, reverse};
use super::reader::{MAX_CHAIN, Mapped, Problem, Reader, SurfaceUse, problem, real, reference};
use super::value::{Entity, Record};
use crate::brep::{Body, BodyKind, Coedge, Color, Edge, Face, Id, Severity, TrimLoop, Vertex};
use crate::geometry::{ParameterBox, Surface, iso_curve, to_bspline};
use crate::numeric::Aabb;
use glam::DVec2;
use std::f64::consts::TAU;

/// Pieces of a boundary shorter than this share of it are points.
const NO_LENGTH: f64 = 1e-8;

/// What an angle may lack of a full turn to be one: files keep nine digits.
const FULL_TURN: f64 = TAU - 1e-7;

impl Reader<'_> {
    /// A sheet of the faces and surfaces `items` that stand in representation or set `id` without a shell around them.
    pub fn loose_sheet(
        &mut self,
        id: u64,
        items: &[u64],
        styles: &Styles,
        color: Option<Color>,
    ) -> Option<Body> {
        let mut faces = Vec::new();
        let (mut endless, mut curves) = (Vec::new(), Vec::new());
        for item in self.patches(items) {
            let Ok(entity) = self.entity(item) else { continue };
            if FACE_KEYWORDS.iter().any(|keyword| entity.is(keyword)) || entity.is("ORIENTED_FACE") {
                self.face_or_report(item, false, styles, color, &mut faces);
            } else if is_endless(self, item, 0) {
                endless.push(item);
            } else if !is_loose_surface(self, item) {
                curves.push(item);
            } else if self.loose_surfaces.insert(item) {
                self.model.declared_faces += 1;
                self.open_faces.insert(item);
                match self.loose_face(&entity) {
                    Ok(mut face) => {
                        face.color = styles.of(item).or(color);
                        self.open_faces.remove(&item);
                        faces.push(self.model.faces.push(face));
                    }
                    Err(problem) => self.drop_face(item, &entity.kind(), &problem),
                }
            }
        }
        for (left_out, what) in [(endless, "surfaces without bounds"), (curves, "curves and points")] {
            if let Some(&first) = left_out.first() {
                let kind = self.keyword(first).into_owned();
                let reason = format!("{} {what} are left out", left_out.len());
                self.report(Severity::Note, Problem { entity: first, kind, reason });
            }
        }
        (!faces.is_empty()).then_some(Body { kind: BodyKind::Sheet, faces, name: String::new(), entity: id })
    }

    /// The items with every RECTANGULAR_COMPOSITE_SURFACE(name, rows of patches) replaced by the surfaces of its patches.
    fn patches(&self, items: &[u64]) -> Vec<u64> {
        let mut surfaces = Vec::new();
        for &item in items {
            if self.keyword(item) != "RECTANGULAR_COMPOSITE_SURFACE" {
                surfaces.push(item);
                continue;
            }
            let Ok(entity) = self.entity(item) else { continue };
            let rows = entity.first().list(1).iter().filter_map(|row| row.list());
            let patches: Vec<u64> = rows.flatten().filter_map(|v| v.reference()).collect();
            if self.charge(&entity, patches.len()).is_err() {
                continue;
            }
            // SURFACE_PATCH(parent, u transition, v transition, u sense, v sense).
            let parents = patches.iter().filter_map(|&patch| self.entity(patch).ok()?.first().reference(0));
            surfaces.extend(parents);
        }
        surfaces
    }

    fn loose_face(&mut self, entity: &Entity) -> Mapped<Face> {
        let record = entity.first();
        let (used, mut loops) = self.self_bounded(entity)?;
        if used.flipped {
            loops.iter_mut().for_each(reverse);
        }
        Ok(Face {
            surface: used.id,
            same_sense: !used.flipped,
            loops,
            color: None,
            name: record.text(0),
            entity: entity.id,
        })
    }

    /// A surface with its own bounds.
    pub fn self_bounded(&mut self, entity: &Entity) -> Mapped<(SurfaceUse, Vec<TrimLoop>)> {
        let record = entity.first();
        match &*record.keyword {
            "CURVE_BOUNDED_SURFACE" if entity.records.len() == 1 => self.curve_bounded(entity),
            "RECTANGULAR_TRIMMED_SURFACE" => self.rectangle(entity),
            "SURFACE_OF_REVOLUTION" => {
                // All of its profile, which a closed form would not end where the profile does.
                let profile = self.curve(reference(entity.id, record, 1)?)?;
                let axis = self.placement(reference(entity.id, record, 2)?)?;
                match profile.trim {
                    Some(range) => {
                        let spline = to_bspline::curve_to_bspline(
                            &profile.curve,
                            [range[0].min(range[1]), range[0].max(range[1])],
                        );
                        let id =
                            self.model.surfaces.push(Surface::Bspline(to_bspline::revolve(&spline, &axis)));
                        Ok((SurfaceUse { id, flipped: false, keeps_parameters: false }, Vec::new()))
                    }
                    None => Ok((self.surface(entity.id, &[])?, Vec::new())),
                }
            }
            _ => Ok((self.surface(entity.id, &[])?, Vec::new())),
        }
    }

    /// `CURVE_BOUNDED_SURFACE(name, basis, boundaries, implicit outer)`.
    fn curve_bounded(&mut self, entity: &Entity) -> Mapped<(SurfaceUse, Vec<TrimLoop>)> {
        let record = entity.first();
        let basis = reference(entity.id, record, 1)?;
        let mut loops = Vec::new();
        for id in record.references(2) {
            loops.extend(self.boundary(id)?);
        }
        if record.logical(3) != Some(true) && !loops.is_empty() {
            let samples = self.samples(&loops);
            return Ok((self.surface(basis, &samples)?, loops));
        }
        let (used, mut outer) = match self.entity(basis)? {
            trimmed if trimmed.is("RECTANGULAR_TRIMMED_SURFACE") => self.rectangle(&trimmed)?,
            _ => (self.surface(basis, &[])?, Vec::new()),
        };
        let domain = self.model.surfaces[used.id].domain();
        if !(domain.min.is_finite() && domain.max.is_finite()) && outer.is_empty() {
            return Err(problem(entity, "a surface without an end is its own outer bound"));
        }
        if outer.is_empty() && !loops.is_empty() {
            outer = self.iso_loops(used.id, domain, entity.id);
        }
        outer.extend(loops);
        Ok((used, outer))
    }

    /// The loop along a boundary curve; `None` where it has no length.
    fn boundary(&mut self, id: u64) -> Mapped<Option<TrimLoop>> {
        let pieces = self.closed_pieces(id)?;
        Ok((!pieces.is_empty()).then(|| self.ring(pieces)))
    }

    /// The pieces of a closed curve, each of which begins where the one before ends; none where it has no length.
    pub fn closed_pieces(&mut self, id: u64) -> Mapped<Vec<Piece>> {
        let mut pieces = Vec::new();
        for repair in self.pieces(id, 0, &mut pieces)? {
            self.report(Severity::Repaired, repair);
        }
        let entity = self.entity(id)?;
        let samples = pieces.iter().flat_map(|p| (0..=4).map(|i| p.at(f64::from(i) / 4.0)));
        let size = Aabb::around(samples).diagonal();
        pieces.retain(|piece| piece.reach() > NO_LENGTH * size);
        turn(&mut pieces, size);
        let gap = |i: usize| {
            let next = &pieces[(i + 1) % pieces.len()];
            pieces[i].at(1.0).distance(next.at(0.0))
        };
        if (0..pieces.len()).any(|i| gap(i) > MEETING * size) {
            return Err(problem(&entity, "the boundary is not closed"));
        }
        Ok(pieces)
    }

    /// `RECTANGULAR_TRIMMED_SURFACE(name, basis, u1, u2, v1, v2, usense, vsense)`.
    pub fn rectangle(&mut self, entity: &Entity) -> Mapped<(SurfaceUse, Vec<TrimLoop>)> {
        let record = entity.first();
        let id = reference(entity.id, record, 1)?;
        let basis = self.entity(id)?;
        let turned = record.logical(6) != record.logical(7);
        let new = |reader: &mut Self, surface| {
            let id = reader.model.surfaces.push(surface);
            (SurfaceUse { id, flipped: turned, keeps_parameters: false }, Vec::new())
        };
        match &*basis.first().keyword {
            "SURFACE_OF_LINEAR_EXTRUSION" => {
                let curve = self.curve(reference(id, basis.first(), 1)?)?.curve;
                let axis = self.vector(reference(id, basis.first(), 2)?)?;
                let u = self.trim(entity, record, 0, self.curve_scale(&curve), curve.period())?;
                let v = self.trim(entity, record, 1, 1.0, None)?;
                let profile = to_bspline::curve_to_bspline(&curve, u);
                return Ok(new(self, Surface::Bspline(to_bspline::extrude(&profile, axis, v))));
            }
            "SURFACE_OF_REVOLUTION" => {
                let curve = self.curve(reference(id, basis.first(), 1)?)?.curve;
                let axis = self.placement(reference(id, basis.first(), 2)?)?;
                let u = self.trim(entity, record, 0, self.units.radians, Some(TAU))?;
                let v = self.trim(entity, record, 1, self.curve_scale(&curve), curve.period())?;
                let profile = to_bspline::curve_to_bspline(&curve, v);
                return Ok(new(self, Surface::Bspline(to_bspline::revolve_between(&profile, &axis, u))));
            }
            _ => {}
        }
        let used = self.surface(id, &[])?;
        let surface = self.model.surfaces[used.id].clone();
        let (scale, periods) = (self.parameter_scale(&surface), surface.periods());
        let u = self.trim(entity, record, 0, scale.x, periods[0])?;
        let v = self.trim(entity, record, 1, scale.y, periods[1])?;
        let flipped = used.flipped ^ turned;
        if let Surface::Bspline(spline) = &surface {
            let piece =
                spline.piece(u, v).ok_or_else(|| problem(entity, "nothing is left of the surface"))?;
            let (piece, loops) = new(self, Surface::Bspline(piece));
            return Ok((SurfaceUse { flipped, ..piece }, loops));
        }
        let range = ParameterBox { min: DVec2::new(u[0], v[0]), max: DVec2::new(u[1], v[1]) };
        let loops = self.iso_loops(used.id, range, entity.id);
        Ok((SurfaceUse { flipped, ..used }, loops))
    }

    /// The ascending range of one parameter; at most one period.
    fn trim(
        &self,
        entity: &Entity,
        record: &Record,
        axis: usize,
        scale: f64,
        period: Option<f64>,
    ) -> Mapped<[f64; 2]> {
        let at = 2 + 2 * axis;
        let [from, to] = [real(entity.id, record, at)? * scale, real(entity.id, record, at + 1)? * scale];
        let range = match period {
            None => [from.min(to), from.max(to)],
            Some(period) => {
                let [from, to] =
                    if record.logical(6 + axis) == Some(false) { [to, from] } else { [from, to] };
                let length = (to - from).rem_euclid(period);
                [from, from + if length > 0.0 { length } else { period }]
            }
        };
        let good = range[0] < range[1] && range.iter().all(|t| t.is_finite());
        good.then_some(range).ok_or_else(|| problem(entity, "the trimmed range is empty"))
    }

    /// The loops around a rectangle of parameters: one of four sides, or two where it closes on itself, or none where it does
    /// along both parameters. Sides that are a point are left out, or are a vertex where they would be a loop.
    fn iso_loops(&mut self, surface: Id<Surface>, range: ParameterBox, entity: u64) -> Vec<TrimLoop> {
        let carrier = self.model.surfaces[surface].clone();
        let ParameterBox { min, max } = range;
        let closes = match &carrier {
            Surface::Bspline(spline) => spline.closed,
            _ => {
                let periods = carrier.periods();
                [0, 1].map(|i| periods[i].is_some() && max[i] - min[i] >= FULL_TURN)
            }
        };
        // Counter-clockwise in the parameter plane: the constant parameter, its value, the range, against the curve or not.
        let sides = [
            (1, min.y, [min.x, max.x], false),
            (0, max.x, [min.y, max.y], false),
            (1, max.y, [min.x, max.x], true),
            (0, min.x, [min.y, max.y], true),
        ];
        let mut pieces = Vec::new();
        for (axis, value, along, against) in sides {
            let range = if against { [along[1], along[0]] } else { along };
            let piece = Piece { curve: iso_curve(&carrier, axis, value), range, entity };
            // A side on which the surface closes is a seam, inside of the face.
            if !closes[axis] {
                pieces.push((piece, closes[1 - axis]));
            }
        }
        let size = pieces.iter().map(|(piece, _)| piece.reach()).fold(0.0, f64::max);
        let is_point = |piece: &Piece| piece.reach() <= NO_LENGTH * size;
        let mut loops = Vec::new();
        let mut chain = Vec::new();
        for (piece, is_ring) in pieces {
            if !is_ring {
                chain.extend((!is_point(&piece)).then_some(piece));
            } else if is_point(&piece) {
                let vertex = Vertex { point: piece.at(0.0), entity };
                loops.push(TrimLoop::Vertex(self.model.vertices.push(vertex)));
            } else {
                loops.push(self.ring(vec![piece]));
            }
        }
        if !chain.is_empty() {
            loops.push(self.ring(chain));
        }
        loops
    }

    /// The loop of pieces that meet.
    fn ring(&mut self, pieces: Vec<Piece>) -> TrimLoop {
        let vertices: Vec<_> = pieces
            .iter()
            .map(|piece| self.model.vertices.push(Vertex { point: piece.at(0.0), entity: piece.entity }))
            .collect();
        let count = vertices.len();
        let coedge = |(i, Piece { curve, range, entity }): (usize, Piece)| {
            let vertices = [vertices[i], vertices[(i + 1) % count]];
            let edge = Edge { curve, range, vertices, pcurves: Vec::new(), entity };
            Coedge { edge: self.model.edges.push(edge), reversed: false }
        };
        TrimLoop::Edges(pieces.into_iter().enumerate().map(coedge).collect())
    }
}

/// Surfaces that a set may hold as faces.
pub fn is_loose_surface(reader: &Reader, id: u64) -> bool {
    let keyword = reader.keyword(id);
    if keyword.is_empty() {
        return reader.entity(id).is_ok_and(|e| e.is("SURFACE") || e.is("B_SPLINE_SURFACE"));
    }
    keyword.ends_with("_SURFACE")
        || ["B_SPLINE_SURFACE_WITH_KNOTS", "SURFACE_OF_REVOLUTION", "SURFACE_REPLICA"].contains(&&*keyword)
        || is_endless_keyword(&keyword)
}

/// Whether a surface has no end, as it stands or as what it is made from.
fn is_endless(reader: &Reader, id: u64, depth: usize) -> bool {
    let keyword = reader.keyword(id);
    if is_endless_keyword(&keyword) {
        return true;
    }
    let basis = || reader.entity(id).ok()?.first().reference(1);
    match &*keyword {
        "SURFACE_REPLICA" | "OFFSET_SURFACE" if depth < MAX_CHAIN => {
            basis().is_some_and(|basis| is_endless(reader, basis, depth + 1))
        }
        "SURFACE_OF_REVOLUTION" => basis()
            .and_then(|id| reader.curve(id).ok())
            .is_some_and(|curve| curve.range().iter().any(|t| !t.is_finite())),
        _ => false,
    }
}

fn is_endless_keyword(keyword: &str) -> bool {
    ["PLANE", "CYLINDRICAL_SURFACE", "CONICAL_SURFACE", "SURFACE_OF_LINEAR_EXTRUSION"].contains(&keyword)
}
