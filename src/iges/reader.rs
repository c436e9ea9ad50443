//! What all mapping functions share: the file, the model in the making, what was already mapped, and the findings.

use super::directory::{Directory, Entry, Mapped, Parameters, Problem};
use super::surface::{ParameterMap, sheet};
use crate::brep::{Diagnostic, Edge, Id, Model, Severity, Vertex};
use crate::geometry::Surface;
use glam::DAffine3;
use std::collections::{HashMap, HashSet};
use std::rc::Rc;

/// A mapped surface as its faces need it.
#[derive(Debug, Clone)]
pub struct SurfaceUse {
    /// The surface.
    pub id: Id<Surface>,
    /// Whether its normal is opposite to that of the file's surface.
    pub flipped: bool,
    /// From the file's parameters to the surface's.
    pub parameters: Rc<ParameterMap>,
}

/// Whether surfaces that are elementary in the end become so, or stay the B-splines that the file's parameters run on.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Form {
    /// Elementary where possible.
    Recognised,
    /// As the file gives it, within its own bounds.
    Bounded,
}

/// The state of one import.
pub struct Reader<'a> {
    /// The file.
    pub file: Directory<'a>,
    /// What was mapped.
    pub model: Model,
    /// From the file's units to millimetres.
    pub unit: DAffine3,
    /// The least distance that the sending system tells apart, millimetres.
    pub resolution: f64,
    /// Surfaces that stand where the file's own space has them.
    pub surfaces: HashMap<(u32, Form), SurfaceUse>,
    /// Vertices by list and index.
    pub vertices: HashMap<(u32, u32), Id<Vertex>>,
    /// Edges by list and index; several where the edge's curve is composite.
    pub edges: HashMap<(u32, u32), Rc<[Id<Edge>]>>,
    /// Lists of vertices and edges.
    pub lists: HashMap<u32, Rc<Parameters>>,
    /// Faces that the file declares and that are neither imported nor reported yet.
    pub open_faces: HashSet<u32>,
    /// Shells already mapped, or hidden.
    pub taken_shells: HashSet<u32>,
    /// The holes of bounded planes, by plane.
    pub plane_holes: HashMap<u32, Vec<u32>>,
}

impl<'a> Reader<'a> {
    /// A reader at the start.
    pub fn new(file: Directory<'a>, millimetres: f64, resolution: f64) -> Self {
        Self {
            file,
            model: Model::default(),
            unit: DAffine3::from_scale(glam::DVec3::splat(millimetres)),
            resolution,
            surfaces: HashMap::new(),
            vertices: HashMap::new(),
            edges: HashMap::new(),
            lists: HashMap::new(),
            open_faces: HashSet::new(),
            taken_shells: HashSet::new(),
            plane_holes: HashMap::new(),
        }
    }

    /// The entry of `entity`; that of nothing where there is none.
    pub fn entry(&self, entity: u32) -> Entry {
        self.file.entry(entity).copied().unwrap_or_default()
    }

    /// Surface `entity`, placed in `outer`.
    pub fn surface(&mut self, entity: u32, outer: &DAffine3, form: Form) -> Mapped<SurfaceUse> {
        let in_place = *outer == self.unit;
        // Only what comes as a B-spline has two forms.
        let has_two = matches!(self.file.kind(entity), 114 | 118 | 120 | 122 | 128 | 140);
        let form = if has_two { form } else { Form::Bounded };
        if let Some(known) = self.surfaces.get(&(entity, form)).filter(|_| in_place) {
            return Ok(known.clone());
        }
        let sheet = sheet(&self.file, entity, outer, form)?;
        if sheet.deviation > 0.0 {
            let reason = format!("the offset is fitted within {:.1e} mm", sheet.deviation);
            self.report(Severity::Repaired, Problem { entity, kind: self.entry(entity).kind, reason });
        }
        if form == Form::Recognised && !matches!(sheet.surface, Surface::Bspline(_)) {
            *self.model.recognised.entry(sheet.surface.kind()).or_default() += 1;
        }
        let used = SurfaceUse {
            id: self.model.surfaces.push(sheet.surface),
            flipped: sheet.flipped,
            parameters: Rc::new(sheet.parameters),
        };
        if in_place {
            self.surfaces.insert((entity, form), used.clone());
        }
        Ok(used)
    }

    /// A list of vertices or edges, decoded once.
    pub fn list(&mut self, entity: u32, kind: u32) -> Mapped<Rc<Parameters>> {
        let list = match self.lists.get(&entity) {
            Some(known) => known.clone(),
            None => {
                let list = Rc::new(self.file.parameters(entity)?);
                self.lists.insert(entity, list.clone());
                list
            }
        };
        if list.kind != kind {
            return Err(list.problem(format!("expected an entity of type {kind}")));
        }
        Ok(list)
    }

    /// Records a finding that costs no face.
    pub fn report(&mut self, severity: Severity, problem: Problem) {
        let Problem { entity, kind, reason } = problem;
        self.model.diagnostics.push(Diagnostic::new(severity, entity.into(), kind_name(kind), reason));
    }

    /// Records that the declared face `entity` is lost.
    pub fn drop_face(&mut self, entity: u32, problem: &Problem) {
        if !self.open_faces.remove(&entity) {
            return;
        }
        let reason = match problem {
            Problem { entity: culprit, reason, .. } if *culprit == entity => reason.clone(),
            Problem { entity: culprit, kind, reason } => format!("entity {kind} at {culprit}: {reason}"),
        };
        let kind = self.entry(entity).kind.to_string();
        self.model.diagnostics.push(Diagnostic::dropped_face(entity.into(), kind, reason));
    }

    /// Records that the declared face `entity` is not wanted.
    pub fn hide_face(&mut self, entity: u32, reason: &str) {
        if self.open_faces.remove(&entity) {
            let kind = self.entry(entity).kind.to_string();
            self.model.diagnostics.push(Diagnostic::hidden_face(entity.into(), kind, reason));
        }
    }
}

/// The type number, for people; the file itself has none.
fn kind_name(kind: u32) -> String {
    if kind == 0 { "file".into() } else { kind.to_string() }
}
