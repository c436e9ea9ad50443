//! What all mapping functions share: the indexed file, the model in the making, what was already mapped, and the findings.

use super::decode;
use super::rows::{self, RawRecord};
use super::scan::Index;
use super::units::Units;
use super::value::{Entity, Record};
use crate::brep::{Diagnostic, Edge, Id, Model, Severity, Vertex};
use crate::geometry::Surface;
use glam::DVec3;
use std::borrow::Cow;
use std::cell::Cell;
use std::collections::{HashMap, HashSet};

/// Why an entity cannot be mapped.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// The entity at fault.
    pub entity: u64,
    /// Its keyword.
    pub kind: String,
    /// What is wrong.
    pub reason: String,
}

/// The result of a mapping.
pub type Mapped<T> = Result<T, Problem>;

/// A chain of references (a curve's basis, a unit's base, a style's parts) may not be longer than this; longer ones are
/// cyclic or hostile.
pub const MAX_CHAIN: usize = 16;

/// All in all this many times the file's bytes are decoded, plus [`FREE_BYTES`]. Real files need less than one time.
const MOST_DECODINGS: usize = 16;
const FREE_BYTES: usize = 1 << 20;

/// A mapped surface as its faces need it.
#[derive(Debug, Clone, Copy)]
pub struct SurfaceUse {
    /// The surface.
    pub id: Id<Surface>,
    /// Whether its normal is opposite to that of the file's surface.
    pub flipped: bool,
    /// Whether its parameters are those of the file's surface, units aside.
    pub keeps_parameters: bool,
}

/// The state of one import.
pub struct Reader<'a> {
    /// The file.
    pub index: Index<'a>,
    /// What was mapped.
    pub model: Model,
    /// The units of the representation that is being mapped.
    pub units: Units,
    /// Vertices by the entity of the vertex or, in poly loops, of the point.
    pub vertices: HashMap<u64, Id<Vertex>>,
    /// Edges by entity.
    pub edges: HashMap<u64, Id<Edge>>,
    /// Edges of poly loops by their vertices, lower index first.
    pub poly_edges: HashMap<[Id<Vertex>; 2], Id<Edge>>,
    /// Surfaces by entity, those aside that depend on the face.
    pub surfaces: HashMap<u64, SurfaceUse>,
    /// Faces that the file declares and that are neither imported nor reported yet.
    pub open_faces: HashSet<u64>,
    /// Surfaces without topology that were counted as faces.
    pub loose_surfaces: HashSet<u64>,
    /// How many more control points and coedges may be made. Each is named in a list of the file, by at least three bytes; a
    /// list that many entities share is copied for each, and a hostile file would make that quadratic.
    budget: Cell<usize>,
    /// Mapped items, context-dependent shape representations and relationships whose placement the file marks as invisible.
    pub hidden_placements: HashSet<u64>,
    /// How many more bytes of statements may be decoded. A statement is decoded again whenever it is reached again; a long one
    /// that many others refer to would make that quadratic.
    to_decode: Cell<usize>,
    /// Bodies and shells already mapped.
    pub taken_bodies: HashSet<u64>,
}

impl<'a> Reader<'a> {
    /// A reader at the start.
    pub fn new(index: Index<'a>) -> Self {
        let budget = Cell::new(index.bytes.len());
        let to_decode =
            Cell::new(index.bytes.len().saturating_mul(MOST_DECODINGS).saturating_add(FREE_BYTES));
        Self {
            budget,
            to_decode,
            index,
            model: Model::default(),
            units: Units::default(),
            vertices: HashMap::new(),
            edges: HashMap::new(),
            poly_edges: HashMap::new(),
            surfaces: HashMap::new(),
            open_faces: HashSet::new(),
            loose_surfaces: HashSet::new(),
            hidden_placements: HashSet::new(),
            taken_bodies: HashSet::new(),
        }
    }

    /// Decodes entity `id`.
    pub fn entity(&self, id: u64) -> Mapped<Entity<'a>> {
        let statement = self.index.find(id).ok_or_else(|| Problem {
            entity: id,
            kind: "reference".into(),
            reason: if self.index.is_external(id) {
                "the entity stands in another file".into()
            } else {
                "the file has no such entity".into()
            },
        })?;
        let bytes = self.index.bytes;
        let fail = |reason: String| Problem {
            entity: id,
            kind: String::from_utf8_lossy(decode::leading_keyword(&bytes[statement.body.clone()]))
                .into_owned(),
            reason,
        };
        let left = self.to_decode.get().checked_sub(statement.body.len());
        self.to_decode.set(left.ok_or_else(|| fail("the file refers to long statements too often".into()))?);
        decode::decode(bytes, id, statement.body.clone())
            .map_err(|error| fail(format!("line {}: {}", self.index.line(error.at), error.reason)))
    }

    /// The records of entity `id` with their parameters as they are written; none where it is missing, or was read too often.
    pub fn raw_records(&self, id: u64) -> Vec<RawRecord<'a>> {
        let Some(statement) = self.index.find(id) else { return Vec::new() };
        let left = self.to_decode.get().checked_sub(statement.body.len());
        self.to_decode.set(left.unwrap_or(0));
        let body = &self.index.bytes[statement.body.clone()];
        left.map_or_else(Vec::new, |_| rows::records(body))
    }

    /// The numbers of entity `id` where it is plainly `keyword('..',(x,y,z))`.
    pub fn plain_triple(&self, id: u64, keyword: &str) -> Option<DVec3> {
        let body = self.index.find(id)?.body.clone();
        decode::triple(self.index.bytes, body, keyword.as_bytes()).map(DVec3::from_array)
    }

    /// The keyword of entity `id` in upper case; empty where it is complex or missing.
    pub fn keyword(&self, id: u64) -> Cow<'a, str> {
        match self.index.find(id) {
            Some(statement) => {
                let bytes = self.index.bytes;
                decode::upper_case(decode::leading_keyword(&bytes[statement.body.clone()]))
            }
            None => "".into(),
        }
    }

    /// Takes `count` list elements of `entity` from the budget.
    pub fn charge(&self, entity: &Entity, count: usize) -> Mapped<()> {
        let left = self.budget.get().checked_sub(count);
        self.budget.set(left.unwrap_or(0));
        left.map(|_| ()).ok_or_else(|| problem(entity, "the file shares its lists too often"))
    }

    /// The entity that parameter `at` of `record`, a part of entity `owner`, refers to.
    pub fn referred(&self, owner: u64, record: &Record, at: usize) -> Mapped<Entity<'a>> {
        self.entity(reference(owner, record, at)?)
    }

    /// Changes the units in force; what was mapped under other units is not reused.
    pub fn set_units(&mut self, units: Units) {
        if units.millimetres != self.units.millimetres || units.radians != self.units.radians {
            self.vertices.clear();
            self.edges.clear();
            self.poly_edges.clear();
            self.surfaces.clear();
        }
        self.units = units;
    }

    /// Records a finding that costs no face.
    pub fn report(&mut self, severity: Severity, problem: Problem) {
        let Problem { entity, kind, reason } = problem;
        self.model.diagnostics.push(Diagnostic::new(severity, entity, kind, reason));
    }

    /// Records that the declared face `id` is lost.
    pub fn drop_face(&mut self, id: u64, kind: &str, problem: &Problem) {
        if self.open_faces.remove(&id) {
            let reason = if problem.entity == id {
                problem.reason.clone()
            } else {
                format!("{} #{}: {}", problem.kind, problem.entity, problem.reason)
            };
            self.model.diagnostics.push(Diagnostic::dropped_face(id, kind, reason));
        }
    }
}

/// A problem of `entity`.
pub fn problem(entity: &Entity, reason: impl Into<String>) -> Problem {
    Problem { entity: entity.id, kind: entity.kind(), reason: reason.into() }
}

/// Parameter `at` of `record`, a part of entity `owner`, as a reference.
pub fn reference(owner: u64, record: &Record, at: usize) -> Mapped<u64> {
    record.reference(at).ok_or_else(|| Problem {
        entity: owner,
        kind: record.keyword.to_string(),
        reason: format!("parameter {} is no reference", at + 1),
    })
}

/// Parameter `at` of `record`, a part of entity `owner`, as a finite number.
pub fn real(owner: u64, record: &Record, at: usize) -> Mapped<f64> {
    record.real(at).ok_or_else(|| Problem {
        entity: owner,
        kind: record.keyword.to_string(),
        reason: format!("parameter {} is no number", at + 1),
    })
}
