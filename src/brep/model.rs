//! The types of the model: parts, bodies, faces, loops, edges, vertices.

use super::{Arena, Color, Diagnostics, Id};
use crate::geometry::{Curve, Curve2, Surface};
use glam::{DAffine3, DVec3};
use std::collections::BTreeMap;

/// Everything that a file says about shape, in millimetres and radians.
#[derive(Debug, Clone, Default)]
pub struct Model {
    /// Where the model comes from, for people.
    pub source: Source,
    /// Surfaces; one may carry several faces.
    pub surfaces: Arena<Surface>,
    /// Vertices; shared by edges.
    pub vertices: Arena<Vertex>,
    /// Edges; shared by the faces on their two sides.
    pub edges: Arena<Edge>,
    /// Faces; each belongs to one body.
    pub faces: Arena<Face>,
    /// Parts; each may be placed any number of times.
    pub parts: Arena<Part>,
    /// The parts that stand at the top of the product tree.
    pub roots: Vec<Id<Part>>,
    /// Parts that the file places invisibly, and those in them; one that stands elsewhere as well is visible there.
    /// Sorted.
    pub hidden_parts: Vec<Id<Part>>,
    /// How many B-spline surfaces became elementary ones, by [`Surface::kind`].
    pub recognised: BTreeMap<&'static str, usize>,
    /// Faces that the file declares, imported or not.
    pub declared_faces: usize,
    /// What was repaired, not understood or dropped, with the reason.
    pub diagnostics: Diagnostics,
}

/// Where a model comes from, for people.
#[derive(Debug, Clone, Default)]
pub struct Source {
    /// "STEP" or "IGES".
    pub format: String,
    /// The schema name as the file gives it, such as "AUTOMOTIVE_DESIGN".
    pub schema: String,
    /// The system that wrote the file.
    pub originating_system: String,
    /// The file's own length unit.
    pub unit: LengthUnit,
}

/// A length unit of a file.
#[derive(Debug, Clone)]
pub struct LengthUnit {
    /// "mm", "inch", "m" and so on.
    pub name: String,
    /// How many millimetres one unit is.
    pub millimetres: f64,
}

impl Default for LengthUnit {
    fn default() -> Self {
        Self { name: "mm".into(), millimetres: 1.0 }
    }
}

/// A point where edges meet.
#[derive(Debug, Clone)]
pub struct Vertex {
    /// Position in the part's space, millimetres.
    pub point: DVec3,
    /// The file's entity number.
    pub entity: u64,
}

/// A piece of a curve between two vertices.
#[derive(Debug, Clone)]
pub struct Edge {
    /// The carrier; primary over every pcurve.
    pub curve: Curve,
    /// Curve parameters at `vertices[0]` and `vertices[1]`; `range[0] > range[1]` where the edge runs against its
    /// curve, and a whole period apart where a closed curve is a closed edge.
    pub range: [f64; 2],
    /// Start and end; the same vertex for a closed edge.
    pub vertices: [Id<Vertex>; 2],
    /// The file's parameter-space curves of this edge: hints that are checked before use, never trusted.
    pub pcurves: Vec<Pcurve>,
    /// The file's entity number.
    pub entity: u64,
}

/// A curve in the parameter space of one surface, as the file gives it.
#[derive(Debug, Clone)]
pub struct Pcurve {
    /// The surface whose parameters the curve runs in.
    pub surface: Id<Surface>,
    /// The curve, in the parameterisation of [`Surface`] (angles in radians, lengths in millimetres), with the same
    /// parameter as the edge's curve.
    pub curve: Curve2,
}

/// The use of an edge by a loop.
#[derive(Debug, Clone, Copy)]
pub struct Coedge {
    /// The edge.
    pub edge: Id<Edge>,
    /// Whether the loop runs from the edge's end to its start.
    pub reversed: bool,
}

/// One boundary of a face.
#[derive(Debug, Clone)]
pub enum TrimLoop {
    /// A closed chain of edges. With the face's normal up, the face lies to the left; files often break this rule.
    Edges(Vec<Coedge>),
    /// A single point: an apex, a pole, or "the whole closed surface".
    Vertex(Id<Vertex>),
}

/// A bounded piece of a surface.
#[derive(Debug, Clone)]
pub struct Face {
    /// The carrier.
    pub surface: Id<Surface>,
    /// Whether the face's normal is the surface's normal `S_u × S_v`, or its opposite.
    pub same_sense: bool,
    /// Boundaries in any order; the file's mark for the outer one is not trusted and not kept. None: the whole surface.
    pub loops: Vec<TrimLoop>,
    /// The face's own colour, or the one inherited from its shell, solid or part.
    pub color: Option<Color>,
    /// The file's name of the face; often empty.
    pub name: String,
    /// The file's entity number.
    pub entity: u64,
}

/// Whether a body encloses a volume.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum BodyKind {
    /// Closed shells around a volume.
    Solid,
    /// Open or closed shells without a volume.
    Sheet,
}

/// Connected faces: a solid (its voids included) or a sheet.
#[derive(Debug, Clone)]
pub struct Body {
    /// Whether it encloses a volume.
    pub kind: BodyKind,
    /// The faces of all its shells.
    pub faces: Vec<Id<Face>>,
    /// The file's name of the body; often empty.
    pub name: String,
    /// The file's entity number.
    pub entity: u64,
}

/// A product: its own bodies, and the parts placed in it.
#[derive(Debug, Clone, Default)]
pub struct Part {
    /// The product's name.
    pub name: String,
    /// Bodies in the part's own space.
    pub bodies: Vec<Body>,
    /// Placed parts.
    pub children: Vec<Child>,
    /// The file's entity number.
    pub entity: u64,
}

/// A placement of a part in its parent.
#[derive(Debug, Clone)]
pub struct Child {
    /// What is placed.
    pub part: Id<Part>,
    /// Where; may mirror or scale.
    pub parent_from_child: DAffine3,
    /// The name of the occurrence; empty where the file gives none.
    pub name: String,
    /// A colour that the file gives to this occurrence; overrides the part's own colours.
    pub color: Option<Color>,
    /// The file's entity number.
    pub entity: u64,
}
