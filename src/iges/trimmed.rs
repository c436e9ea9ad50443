//! Faces without topology: trimmed surfaces (144 with 142), bounded surfaces (143 with 141), bounded planes (108), and surfaces
//! that stand alone.

use super::boundary::{self, Bound, trim_loop};
use super::curve::{self, Piece};
use super::directory::{Mapped, Problem};
use super::lifted;
use super::placement;
use super::reader::{Form, Reader, SurfaceUse};
use super::rounds;
use super::style;
use crate::brep::{Color, Face, Id, Severity, TrimLoop};
use crate::geometry::invert_surface;
use crate::numeric::Aabb;
use glam::DAffine3;

/// A curve farther than this share of its loop's size from its surface belongs to another one.
const OFF_SURFACE: f64 = 1e-2;

/// How many curves of a loop are compared with the surface that they should lie on.
const MOST_COMPARED: usize = 4;

impl Reader<'_> {
    /// The face of a 144, a 143 or a surface that stands alone.
    pub fn loose_face(&mut self, entity: u32, inherited: Option<Color>) -> Mapped<Id<Face>> {
        let mut face = match self.entry(entity).kind {
            144 => self.trimmed(entity),
            143 => self.bounded(entity),
            108 => self.bounded_plane(entity),
            _ => self.bare(entity),
        }?;
        face.color = style::color(&self.file, entity).or(inherited).or_else(|| self.color_of_surface(entity));
        Ok(self.model.faces.push(face))
    }

    /// Trimmed surfaces without a colour may have one on the surface that they trim.
    fn color_of_surface(&self, entity: u32) -> Option<Color> {
        let at = match self.entry(entity).kind {
            144 => 1,
            143 => 2,
            _ => return None,
        };
        let surface = self.file.parameters(entity).and_then(|p| p.reference(at)).ok()?;
        style::color(&self.file, surface)
    }

    fn new_face(&self, entity: u32, used: &SurfaceUse, loops: Vec<TrimLoop>) -> Face {
        let same_sense = !used.flipped;
        let entity = entity.into();
        Face { surface: used.id, same_sense, loops, color: None, name: String::new(), entity }
    }

    /// Entity 144: surface, whether it has an outer boundary, how many inner ones, the outer one, the inner ones.
    fn trimmed(&mut self, entity: u32) -> Mapped<Face> {
        let parameters = self.file.parameters(entity)?;
        let place = placement::of(&self.file, entity, &self.unit)?;
        let surface = parameters.reference(1)?;
        let outer = if parameters.integer(2)? == 0 { 0 } else { parameters.pointer(4)? };
        let inner = parameters.count(3, 1)?;
        let form = if outer == 0 { Form::Bounded } else { Form::Recognised };
        let used = self.surface(surface, &place, form)?;
        let mut loops = Vec::new();
        if outer != 0 {
            loops.extend(self.curve_on_surface(outer, surface, &used, &place)?);
        }
        for i in 0..inner {
            match self.curve_on_surface(parameters.reference(5 + i)?, surface, &used, &place) {
                Ok(found) => loops.extend(found),
                // Without a hole a face is too large, but without the face there is a hole of its own size.
                Err(problem) => self.report(Severity::Warning, hole_lost(problem)),
            }
        }
        if outer == 0 {
            self.bound_naturally(entity, &used, &mut loops)?;
        }
        let mut face = self.new_face(entity, &used, loops);
        face.name = style::name(&self.file, &parameters, 5 + inner);
        Ok(face)
    }

    /// Entity 142: how it was made, surface, curve in the parameter plane, curve in space, which one counts. Curves that
    /// stand in its place are taken for the curve in space.
    fn curve_on_surface(
        &mut self,
        entity: u32,
        surface: u32,
        used: &SurfaceUse,
        outer: &DAffine3,
    ) -> Mapped<Vec<TrimLoop>> {
        let bounds = if self.entry(entity).kind == 142 {
            let parameters = self.file.parameters(entity)?;
            let place = placement::of(&self.file, entity, outer)?;
            let (flat, curve) = (parameters.pointer(3)?, parameters.pointer(4)?);
            let flat: Vec<u32> = (flat != 0).then_some(flat).into_iter().collect();
            self.bounds_of(&parameters.problem("it has no curve"), &flat, curve, surface, used, &place)?
        } else {
            curve::pieces(&self.file, entity, outer)?.into_iter().map(Bound::from).collect()
        };
        let meeting = boundary::meeting(&bounds, self.resolution);
        let trim = trim_loop(&mut self.model, bounds, self.resolution);
        let surface = &self.model.surfaces[used.id];
        let ordered = trim.map(|trim| rounds::around(&self.model, trim, surface, used.flipped, meeting));
        Ok(ordered.unwrap_or_default())
    }

    /// The curve in space where it can be read, else those in the parameter plane.
    fn bounds_of(
        &mut self,
        none: &Problem,
        flat: &[u32],
        curve: u32,
        surface: u32,
        used: &SurfaceUse,
        place: &DAffine3,
    ) -> Mapped<Vec<Bound>> {
        let in_space = match curve {
            0 => Err(none.clone()),
            curve => curve::pieces(&self.file, curve, place),
        };
        match in_space {
            Ok(pieces) if !pieces.is_empty() && (flat.is_empty() || !self.lies_elsewhere(&pieces, used)) => {
                Ok(pieces.into_iter().map(Bound::from).collect())
            }
            Ok(_) if flat.is_empty() => Err(none.clone()),
            Err(problem) if flat.is_empty() => Err(problem),
            result => {
                let problem = result.err().filter(|_| curve != 0);
                let reason =
                    problem.as_ref().map_or("the curve in space is not on the surface", |p| &p.reason);
                if curve != 0 {
                    let reason = format!("{reason}; the parameter curve counts instead");
                    let entity = problem.as_ref().map_or(curve, |p| p.entity);
                    self.report(
                        Severity::Repaired,
                        Problem { entity, kind: self.entry(entity).kind, reason },
                    );
                }
                let mut bounds = Vec::new();
                for &flat in flat {
                    bounds.append(&mut lifted::bounds(self, flat, surface, used, place)?);
                }
                Ok(bounds)
            }
        }
    }

    /// Whether a curve in space has nothing to do with its surface: some files carry a dummy beside a good parameter curve.
    fn lies_elsewhere(&self, pieces: &[Piece], used: &SurfaceUse) -> bool {
        let size = Aabb::around(pieces.iter().flat_map(|p| [p.at(0.0), p.at(0.5), p.at(1.0)])).diagonal();
        let off = OFF_SURFACE * size + self.resolution;
        let surface = &self.model.surfaces[used.id];
        let step = pieces.len().div_ceil(MOST_COMPARED).max(1);
        let distant = |piece: &Piece| invert_surface(surface, piece.at(0.5), None).distance > off;
        pieces.iter().step_by(step).any(distant)
    }

    /// Entity 143: type, surface, how many boundaries, these.
    fn bounded(&mut self, entity: u32) -> Mapped<Face> {
        let parameters = self.file.parameters(entity)?;
        let place = placement::of(&self.file, entity, &self.unit)?;
        let surface = parameters.reference(2)?;
        let count = parameters.count(3, 1)?;
        let form = if count == 0 { Form::Bounded } else { Form::Recognised };
        let used = self.surface(surface, &place, form)?;
        let mut loops = Vec::new();
        for i in 0..count {
            let boundary = parameters.reference(4 + i)?;
            let bounds = if self.entry(boundary).kind == 141 {
                self.boundary(boundary, surface, &used, &place)?
            } else {
                curve::pieces(&self.file, boundary, &place)?.into_iter().map(Bound::from).collect()
            };
            loops.extend(trim_loop(&mut self.model, bounds, self.resolution));
        }
        if count == 0 {
            self.bound_naturally(entity, &used, &mut loops)?;
        }
        let mut face = self.new_face(entity, &used, loops);
        face.name = style::name(&self.file, &parameters, 4 + count);
        Ok(face)
    }

    /// Entity 141: type, which curves count, surface, how many curves; then for each the curve in space, its sense, how
    /// many parameter curves, these.
    fn boundary(
        &mut self,
        entity: u32,
        surface: u32,
        used: &SurfaceUse,
        outer: &DAffine3,
    ) -> Mapped<Vec<Bound>> {
        let parameters = self.file.parameters(entity)?;
        let place = placement::of(&self.file, entity, outer)?;
        let mut bounds = Vec::new();
        let mut at = 5;
        for _ in 0..parameters.count(4, 3)? {
            let (curve, sense, flats) =
                (parameters.pointer(at)?, parameters.integer(at + 1)?, parameters.count(at + 2, 1)?);
            let flat = parameters.references(at + 3, flats);
            let none = parameters.problem("it has no curve");
            let mut found = self.bounds_of(&none, &flat, curve, surface, used, &place)?;
            // Parameter curves have a direction of their own.
            if sense == 2 && found.iter().all(|bound| bound.pcurve.is_none()) {
                found.reverse();
                found.iter_mut().for_each(|bound| bound.piece = bound.piece.clone().reversed());
            }
            bounds.append(&mut found);
            at += 3 + flats;
        }
        Ok(bounds)
    }

    /// Entity 108, form 1: the four coefficients, a closed curve. Its holes (form -1) refer to it by a single parent group.
    fn bounded_plane(&mut self, entity: u32) -> Mapped<Face> {
        let parameters = self.file.parameters(entity)?;
        let place = placement::of(&self.file, entity, &self.unit)?;
        let unit = self.unit;
        let used = self.surface(entity, &unit, Form::Bounded)?;
        let pieces = curve::pieces(&self.file, parameters.reference(5)?, &place)?;
        let bounds = pieces.into_iter().map(Bound::from).collect();
        let mut loops: Vec<TrimLoop> =
            trim_loop(&mut self.model, bounds, self.resolution).into_iter().collect();
        for hole in self.plane_holes.get(&entity).cloned().unwrap_or_default() {
            let pieces = self.file.parameters(hole).and_then(|p| p.reference(5)).and_then(|curve| {
                let place = placement::of(&self.file, hole, &self.unit)?;
                curve::pieces(&self.file, curve, &place)
            });
            match pieces {
                Ok(pieces) => {
                    let bounds = pieces.into_iter().map(Bound::from).collect();
                    loops.extend(trim_loop(&mut self.model, bounds, self.resolution));
                }
                Err(problem) => self.report(Severity::Warning, hole_lost(problem)),
            }
        }
        let mut face = self.new_face(entity, &used, loops);
        face.name = style::name(&self.file, &parameters, 10);
        Ok(face)
    }

    /// A surface that no other entity uses: a face as large as its parameters.
    fn bare(&mut self, entity: u32) -> Mapped<Face> {
        let unit = self.unit;
        let used = self.surface(entity, &unit, Form::Bounded)?;
        let mut loops = Vec::new();
        self.bound_naturally(entity, &used, &mut loops)?;
        let mut face = self.new_face(entity, &used, loops);
        face.name = style::label(&self.file, entity);
        Ok(face)
    }

    /// Makes a surface's own bounds the outer boundary: nothing to do where it has no holes, else a loop along its sides.
    fn bound_naturally(&mut self, entity: u32, used: &SurfaceUse, loops: &mut Vec<TrimLoop>) -> Mapped<()> {
        let kind = self.entry(entity).kind;
        let surface = &self.model.surfaces[used.id];
        let domain = surface.domain();
        if !(domain.min.is_finite() && domain.max.is_finite()) {
            let reason = format!("a {} without an outer boundary has no end", surface.kind());
            return Err(Problem { entity, kind, reason });
        }
        if loops.is_empty() {
            return Ok(());
        }
        let sides = lifted::sides(surface, entity).map_err(|reason| Problem { entity, kind, reason })?;
        loops.extend(trim_loop(&mut self.model, sides, self.resolution));
        Ok(())
    }
}

fn hole_lost(problem: Problem) -> Problem {
    Problem { reason: format!("hole lost: {}", problem.reason), ..problem }
}
