//! Solids, surface models and shells with the faces that the file lists (ISO 10303-42, clauses 5 and 6).

use super::map_style::Styles;
use super::map_topology::{BODY_KEYWORDS, FACE_KEYWORDS, GENERATED};
use super::reader::{MAX_CHAIN, Mapped, Problem, Reader, problem, reference};
use crate::brep::{Body, BodyKind, Color, Face, Id, Severity};

/// Keywords of solids that consist of declared faces.
const SOLID_KEYWORDS: [&str; 4] =
    ["MANIFOLD_SOLID_BREP", "BREP_WITH_VOIDS", "FACETED_BREP", "FACETED_BREP_AND_BREP_WITH_VOIDS"];

impl Reader<'_> {
    /// The solid, surface model or shell `id` with every face that could be mapped; `None` where it was mapped before.
    pub fn body(&mut self, id: u64, styles: &Styles, inherited: Option<Color>) -> Mapped<Option<Body>> {
        self.body_in_chain(id, styles, inherited, 0)
    }

    /// Body `id`, `depth` references down a chain of solids.
    pub fn body_in_chain(
        &mut self,
        id: u64,
        styles: &Styles,
        inherited: Option<Color>,
        depth: usize,
    ) -> Mapped<Option<Body>> {
        let entity = self.entity(id)?;
        if self.taken_bodies.contains(&id) {
            return Ok(None);
        }
        let color = styles.of(id).or(inherited);
        if BODY_KEYWORDS[..GENERATED].iter().any(|keyword| entity.is(keyword)) {
            return self.generated_body(&entity, styles, color, depth).map(Some);
        }
        let record = BODY_KEYWORDS.iter().find_map(|keyword| entity.record(keyword));
        let record = record.ok_or_else(|| problem(&entity, "this kind of body is not supported"))?;
        let is_solid = SOLID_KEYWORDS.iter().any(|k| entity.is(k));
        let is_model = entity.is("SHELL_BASED_SURFACE_MODEL") || entity.is("FACE_BASED_SURFACE_MODEL");
        let shells: Vec<u64> = if is_solid || is_model {
            self.taken_bodies.insert(id);
            let all = entity.records.iter().flat_map(|r| &r.parameters);
            all.flat_map(|p| {
                p.reference().into_iter().chain(p.list().into_iter().flatten().filter_map(|v| v.reference()))
            })
            .collect()
        } else {
            vec![id]
        };
        let mut faces = Vec::new();
        for shell in shells {
            if let Err(problem) = self.shell(shell, styles, color, &mut faces) {
                self.report(Severity::Dropped, problem);
            }
        }
        let name = record.text(0);
        let kind = if is_solid { BodyKind::Solid } else { BodyKind::Sheet };
        Ok((!faces.is_empty()).then_some(Body { kind, faces, name, entity: id }))
    }

    fn shell(
        &mut self,
        id: u64,
        styles: &Styles,
        inherited: Option<Color>,
        faces: &mut Vec<Id<Face>>,
    ) -> Mapped<()> {
        let (mut id, mut reversed, mut color) = (id, false, inherited);
        for _ in 0..MAX_CHAIN {
            let entity = self.entity(id)?;
            if !self.taken_bodies.insert(id) {
                return Ok(());
            }
            color = styles.of(id).or(color);
            let record = entity.first();
            if matches!(&*record.keyword, "ORIENTED_CLOSED_SHELL" | "ORIENTED_OPEN_SHELL") {
                reversed ^= record.logical(3) == Some(false);
                id = reference(id, record, 2)?;
                continue;
            }
            let list = entity.records.iter().find_map(|r| r.parameters.iter().find_map(|p| p.list()));
            let list = list.ok_or_else(|| problem(&entity, "the shell has no list of faces"))?;
            for face in list.iter().filter_map(|v| v.reference()) {
                self.face_or_report(face, reversed, styles, color, faces);
            }
            return Ok(());
        }
        Err(Problem {
            entity: id,
            kind: "ORIENTED_CLOSED_SHELL".into(),
            reason: "shells refer to each other in a circle".into(),
        })
    }

    /// Adds face `id`, or reports it.
    pub fn face_or_report(
        &mut self,
        id: u64,
        reversed: bool,
        styles: &Styles,
        color: Option<Color>,
        faces: &mut Vec<Id<Face>>,
    ) {
        let (mut face_id, mut reversed) = (id, reversed);
        for _ in 0..MAX_CHAIN {
            let entity = match self.entity(face_id) {
                Ok(entity) => entity,
                Err(problem) if self.open_faces.contains(&face_id) => {
                    return self.drop_face(face_id, &problem.kind.clone(), &problem);
                }
                Err(problem) => return self.report(Severity::Dropped, problem),
            };
            if let Some(oriented) = entity.record("ORIENTED_FACE") {
                reversed ^= oriented.logical(3) == Some(false);
                let Some(element) = oriented.reference(2) else {
                    return self.report(Severity::Dropped, problem(&entity, "the face has no element"));
                };
                face_id = element;
                continue;
            }
            if !self.open_faces.contains(&face_id) {
                if !FACE_KEYWORDS.iter().any(|keyword| entity.is(keyword)) {
                    self.report(Severity::Dropped, problem(&entity, "this kind of face is not supported"));
                }
                return;
            }
            match self.face(&entity, reversed) {
                Ok(mut face) => {
                    face.color = styles.of(face_id).or(color);
                    self.open_faces.remove(&face_id);
                    faces.push(self.model.faces.push(face));
                }
                Err(problem) => self.drop_face(face_id, &entity.kind(), &problem),
            }
            return;
        }
        let reason = "faces refer to each other in a circle".into();
        self.report(Severity::Dropped, Problem { entity: id, kind: "ORIENTED_FACE".into(), reason });
    }
}
