//! A model many times over, every copy with shape of its own: large scenes from small files.
//!
//! Sloup and Havran (2021, section 5.1) make their largest scenes so: "by duplicating several models in space without instantiating objects by a
//! reference". Surfaces and edges are copied too, for the bake bounds how often faces may share these, and closed bodies and gaps are found
//! by the edges that faces share.

use super::{Arena, Child, Edge, Face, Id, Model, Part, TrimLoop, Vertex, occurrences};
use crate::geometry::Surface;
use glam::{DAffine3, DVec3};

/// Faces of a replicated model: ten million take tens of gigabytes.
const MOST_FACES: usize = 10_000_000;

/// A flat model is taken to be this thick, as a share of its longest side.
const THINNEST: f64 = 0.1;

/// Room between two copies, as a share of a copy.
const MARGIN: f64 = 0.1;

/// Why a model cannot be replicated.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ReplicateError {
    /// More faces than [`MOST_FACES`], or more placements than a product tree may have.
    #[error("{copies} copies would have too many {what}: {each} each, and {most} are allowed in all")]
    TooMany {
        /// Copies asked for.
        copies: u64,
        /// "faces" or "placements".
        what: &'static str,
        /// In one copy.
        each: usize,
        /// The limit.
        most: usize,
    },
    /// There is no box to put beside another.
    #[error("the model has no extent")]
    NoExtent,
}

/// Where on the grid a copy stands.
type Place = [u32; 3];

/// Copies of `model`, `counts` of them along x, y and z, a step of `size` (that of the model's box) and a margin of 10 % apart.
///
/// Counts of the model, those of lost faces included, grow with the copies; findings are listed once.
pub fn replicate(mut model: Model, counts: [u32; 3], size: DVec3) -> Result<Model, ReplicateError> {
    let copies = counts.iter().map(|&count| u64::from(count.max(1))).fold(1, u64::saturating_mul);
    let placements = occurrences(&model).0.len();
    for (what, each, most) in [
        ("faces", model.faces.len(), MOST_FACES),
        ("placements", placements, super::assembly::MAX_OCCURRENCES),
    ] {
        if copies.saturating_mul(each as u64) > most as u64 {
            return Err(ReplicateError::TooMany { copies, what, each, most });
        }
    }
    if !(size.is_finite() && size.max_element() > 0.0) {
        return Err(ReplicateError::NoExtent);
    }
    let step = size.max(DVec3::splat(size.max_element() * THINNEST)) * (1.0 + MARGIN);
    let one = Lengths::of(&model);
    let roots = std::mem::take(&mut model.roots);
    let hidden = model.hidden_parts.clone();
    let mut grid = Part { name: counts.map(|count| count.to_string()).join(" × "), ..Part::default() };
    for (copy, place) in places(counts).enumerate() {
        let moved = one.times(copy);
        if copy > 0 {
            append_copy(&mut model, one, &moved);
            model.hidden_parts.extend(hidden.iter().map(|&part| shifted(part, moved.parts)));
        }
        for &root in &roots {
            grid.children.push(child(&model, shifted(root, moved.parts), place, step));
        }
    }
    model.roots = vec![model.parts.push(grid)];
    let copies = copies as usize;
    model.declared_faces *= copies;
    model.recognised.values_mut().for_each(|count| *count *= copies);
    model.diagnostics.multiply_faces(copies as u32);
    Ok(model)
}

fn places(counts: [u32; 3]) -> impl Iterator<Item = Place> {
    let [nx, ny, nz] = counts.map(|count| count.max(1));
    (0..nz).flat_map(move |z| (0..ny).flat_map(move |y| (0..nx).map(move |x| [x, y, z])))
}

fn child(model: &Model, part: Id<Part>, place: Place, step: DVec3) -> Child {
    let [x, y, z] = place;
    let offset = DVec3::from_array(place.map(f64::from)) * step;
    Child {
        part,
        parent_from_child: DAffine3::from_translation(offset),
        name: format!("{} ({x}, {y}, {z})", model.parts[part].name),
        color: None,
        entity: model.parts[part].entity,
    }
}

/// How many of each a copy has, or how far the ids of a copy are from those of the first.
#[derive(Clone, Copy)]
struct Lengths {
    surfaces: usize,
    vertices: usize,
    edges: usize,
    faces: usize,
    parts: usize,
}

impl Lengths {
    fn of(model: &Model) -> Self {
        Self {
            surfaces: model.surfaces.len(),
            vertices: model.vertices.len(),
            edges: model.edges.len(),
            faces: model.faces.len(),
            parts: model.parts.len(),
        }
    }

    fn times(self, n: usize) -> Self {
        Self {
            surfaces: self.surfaces * n,
            vertices: self.vertices * n,
            edges: self.edges * n,
            faces: self.faces * n,
            parts: self.parts * n,
        }
    }
}

fn shifted<T>(id: Id<T>, by: usize) -> Id<T> {
    Id::new(id.index() + by)
}

/// Appends the first `count` elements of an arena again, changed.
fn append<T: Clone>(arena: &mut Arena<T>, count: usize, change: impl Fn(&mut T)) {
    for index in 0..count {
        let mut item = arena[Id::new(index)].clone();
        change(&mut item);
        arena.push(item);
    }
}

/// Appends the first copy, `one`, with ids moved by `by`.
fn append_copy(model: &mut Model, one: Lengths, by: &Lengths) {
    append::<Surface>(&mut model.surfaces, one.surfaces, |_| {});
    append::<Vertex>(&mut model.vertices, one.vertices, |_| {});
    append(&mut model.edges, one.edges, |edge: &mut Edge| {
        edge.vertices = edge.vertices.map(|vertex| shifted(vertex, by.vertices));
        edge.pcurves.iter_mut().for_each(|pcurve| pcurve.surface = shifted(pcurve.surface, by.surfaces));
    });
    append(&mut model.faces, one.faces, |face: &mut Face| {
        face.surface = shifted(face.surface, by.surfaces);
        for trim_loop in &mut face.loops {
            match trim_loop {
                TrimLoop::Edges(coedges) => {
                    coedges.iter_mut().for_each(|coedge| coedge.edge = shifted(coedge.edge, by.edges));
                }
                TrimLoop::Vertex(vertex) => *vertex = shifted(*vertex, by.vertices),
            }
        }
    });
    append(&mut model.parts, one.parts, |part: &mut Part| {
        let faces = part.bodies.iter_mut().flat_map(|body| &mut body.faces);
        faces.for_each(|face| *face = shifted(*face, by.faces));
        part.children.iter_mut().for_each(|child| child.part = shifted(child.part, by.parts));
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brep::{Body, BodyKind, Diagnostic, Severity};
    use crate::geometry::Frame;

    fn sheet() -> Model {
        let mut model = Model { declared_faces: 2, ..Model::default() };
        let surface = model.surfaces.push(Surface::Plane { frame: Frame::IDENTITY });
        let face = Face {
            surface,
            same_sense: true,
            loops: Vec::new(),
            color: None,
            name: String::new(),
            entity: 7,
        };
        let face = model.faces.push(face);
        let body = Body { kind: BodyKind::Sheet, faces: vec![face], name: String::new(), entity: 8 };
        let part = Part { name: "sheet".into(), bodies: vec![body], ..Part::default() };
        let part = model.parts.push(part);
        model.roots.push(part);
        model.diagnostics.push(Diagnostic::dropped_face(9, "ADVANCED_FACE", "it is gone"));
        model
    }

    #[test]
    fn every_copy_has_its_own_faces_and_its_own_place() {
        let size = DVec3::new(10.0, 20.0, 0.0);
        let model = replicate(sheet(), [2, 3, 1], size).expect("six copies");
        let (found, is_cut) = occurrences(&model);
        assert_eq!((found.len(), is_cut, model.faces.len(), model.surfaces.len()), (6, false, 6, 6));
        let mut faces: Vec<usize> = Vec::new();
        for (index, occurrence) in found.iter().enumerate() {
            let face = model.parts[occurrence.part].bodies[0].faces[0];
            assert_eq!(model.faces[face].surface.index(), index);
            faces.push(face.index());
            let place = DVec3::new((index % 2) as f64 * 11.0, (index / 2) as f64 * 22.0, 0.0);
            assert!(occurrence.world_from_part.translation.abs_diff_eq(place, 1e-9));
        }
        faces.sort_unstable();
        assert_eq!(faces, [0, 1, 2, 3, 4, 5]);
        assert_eq!(found[5].path, "2 × 3 × 1/sheet (1, 2, 0)");
        assert_eq!(model.declared_faces, 12);
        let lost = model.diagnostics.iter().filter(|d| d.severity == Severity::Dropped);
        assert_eq!(lost.map(|d| d.faces).collect::<Vec<_>>(), [6]);
    }

    #[test]
    fn too_many_copies_are_refused() {
        let size = DVec3::ONE;
        let refused = replicate(sheet(), [u32::MAX; 3], size).expect_err("too many");
        assert!(matches!(refused, ReplicateError::TooMany { what: "faces", .. }), "{refused}");
        let refused = replicate(sheet(), [1001, 1000, 1], size).expect_err("too many");
        assert!(matches!(refused, ReplicateError::TooMany { what: "placements", .. }), "{refused}");
        assert_eq!(replicate(sheet(), [2, 1, 1], DVec3::ZERO).expect_err("flat"), ReplicateError::NoExtent);
    }
}
