//! Tessellated shape of AP242 (ISO 10303-42: tessellated_item and its subtypes), as planar facets: each triangle with an area
//! becomes a face on a plane, and facets of one body share their vertices and edges as those of poly loops do.
//!
//! A tessellation mostly stands beside the exact shape that it was made from. Where a product has exact shape, or the item is
//! linked to an exact one that was imported, the tessellation is left out with a note. What annotations are drawn with is
//! never shape.
//!
//! Faces are counted by triangles: each with an area that an imported item lists, or that its strips and fans make, is
//! declared. Points are
//! welded where their coordinates are equal, since many systems write a list of points for each face.
//!
//! Invariants: each triangulated item is imported once, so that work and memory are linear in the file; each list of points
//! is read once.

use super::catalog::Catalog;
use super::map_assembly::{Assembly, Representation};
use super::map_style::Styles;
use super::reader::{MAX_CHAIN, Problem, Reader};
use super::rows::for_each_row;
use super::tessellated_item::{Fields, Triangles, corners_of_cubic};
use super::value::Value;
use crate::brep::{Body, BodyKind, Coedge, Color, Diagnostic, Face, Id, Part, Severity, TrimLoop, Vertex};
use crate::geometry::{Frame, Surface};
use glam::{DAffine3, DVec3};
use std::collections::{HashMap, HashSet};
use std::rc::Rc;

/// Items that hold triangles.
const TRIANGULATED: [&str; 5] = [
    "TRIANGULATED_FACE",
    "COMPLEX_TRIANGULATED_FACE",
    "TRIANGULATED_SURFACE_SET",
    "COMPLEX_TRIANGULATED_SURFACE_SET",
    "CUBIC_BEZIER_TRIANGULATED_FACE",
];

/// Items that hold other tessellated items, the outer ones first.
const CONTAINERS: [&str; 5] = [
    "TESSELLATED_SOLID",
    "TESSELLATED_SHELL",
    "REPOSITIONED_TESSELLATED_GEOMETRIC_SET",
    "TESSELLATED_GEOMETRIC_SET",
    "REPOSITIONED_TESSELLATED_ITEM",
];

/// A triangle lower than this part of its longest side has no plane: its corners, kept with seven digits by most systems, do
/// not say which way it faces.
const LEAST_HEIGHT: f64 = 1e-9;

/// Whether this is a keyword of tessellated surfaces.
pub fn is_tessellated(keyword: &str) -> bool {
    TRIANGULATED.contains(&keyword) || CONTAINERS.contains(&keyword)
}

/// The keyword that says which tessellated surface item `id` is.
fn kind(reader: &Reader, id: u64) -> Option<&'static str> {
    let known = |keyword: &str| TRIANGULATED.into_iter().chain(CONTAINERS).find(|known| *known == keyword);
    let keyword = reader.keyword(id);
    if !keyword.is_empty() {
        return known(&keyword);
    }
    // A complex instance is what its most specific part says, and the containers are ordered by that.
    let records = reader.raw_records(id);
    TRIANGULATED.into_iter().chain(CONTAINERS).find(|known| records.iter().any(|r| r.keyword == *known))
}

/// Maps the tessellated items of all representations, where the product has no exact shape.
pub fn map(reader: &mut Reader, assembly: &mut Assembly, catalog: &Catalog, styles: &Styles) {
    if catalog.tessellated.is_empty() {
        return;
    }
    let mut work = Tessellation::new(reader, catalog, styles);
    // What has bodies by now has exact ones.
    let exact: HashSet<Id<Part>> =
        reader.model.parts.ids().filter(|&part| !reader.model.parts[part].bodies.is_empty()).collect();
    for at in 0..assembly.order.len() {
        let id = assembly.order[at];
        let Representation { items, context, .. } = assembly.representations[&id].clone();
        let items: Vec<u64> = items.into_iter().filter(|item| work.kinds.contains_key(item)).collect();
        if items.is_empty() {
            continue;
        }
        if assembly.known_part(id).is_some_and(|part| exact.contains(&part)) {
            work.leave_out(reader, items);
            continue;
        }
        assembly.use_units(reader, context);
        if reader.model.faces.is_empty() {
            reader.model.source.unit = reader.units.length_unit();
        }
        for item in items {
            if let Some(body) = work.body(reader, item, styles.of(id)) {
                let part = assembly.part(reader, id);
                reader.model.parts[part].bodies.push(body);
            }
        }
    }
    if reader.model.faces.is_empty() && reader.open_faces.is_empty() {
        map_loose(reader, assembly, catalog, &mut work);
    }
    work.report(reader, catalog);
}

/// Tessellated items that stand in no representation, where the file has no other shape: a part of their own.
fn map_loose(reader: &mut Reader, assembly: &mut Assembly, catalog: &Catalog, work: &mut Tessellation) {
    let context = assembly.order.iter().find_map(|r| assembly.representations[r].context);
    assembly.use_units(reader, context);
    reader.model.source.unit = reader.units.length_unit();
    let mut items = catalog.tessellated.clone();
    let rank = |id: &u64| {
        CONTAINERS
            .iter()
            .position(|container| work.kinds.get(id) == Some(container))
            .unwrap_or(CONTAINERS.len())
    };
    items.sort_by_key(rank);
    let bodies: Vec<Body> = items.into_iter().filter_map(|item| work.body(reader, item, None)).collect();
    if !bodies.is_empty() {
        let reason = format!("{} bodies stand outside of any product; imported as one part", bodies.len());
        reader.report(Severity::Note, Problem { entity: 0, kind: "PRODUCT".into(), reason });
        reader.model.parts.push(Part { bodies, ..Part::default() });
    }
}

/// A count, and the entity where it began.
#[derive(Debug, Default)]
struct Tally {
    first: u64,
    count: usize,
}

impl Tally {
    fn add(&mut self, id: u64) {
        if self.count == 0 {
            self.first = id;
        }
        self.count += 1;
    }
}

/// The state of mapping tessellated items.
struct Tessellation<'s> {
    styles: &'s Styles,
    /// All tessellated surfaces by entity: looking at a long one each time that another names it would be quadratic.
    kinds: HashMap<u64, &'static str>,
    /// Lists of points by entity, as the file gives them.
    points: HashMap<u64, Rc<Vec<DVec3>>>,
    /// Vertices of the body in the making, by their coordinates' bits.
    welded: HashMap<[u64; 3], Id<Vertex>>,
    /// Containers and triangulated items that were met.
    taken: HashSet<u64>,
    /// What annotations are drawn with, and all below.
    annotations: HashSet<u64>,
    imported: Tally,
    left_out: Tally,
    flat: Tally,
    astray: Tally,
    curved: Tally,
}

impl<'s> Tessellation<'s> {
    fn new(reader: &Reader, catalog: &Catalog, styles: &'s Styles) -> Self {
        let drawn = |&id: &u64| {
            let entity = reader.entity(id).ok()?;
            entity.records.iter().flat_map(|r| &r.parameters).filter_map(Value::reference).next_back()
        };
        let known = |&id: &u64| kind(reader, id).map(|kind| (id, kind));
        let kinds: HashMap<u64, &'static str> = catalog.tessellated.iter().filter_map(known).collect();
        let mut annotations = HashSet::new();
        let mut waiting: Vec<u64> = catalog.tessellated_annotations.iter().filter_map(drawn).collect();
        while let Some(id) = waiting.pop() {
            if annotations.insert(id) && kinds.get(&id).is_some_and(|kind| CONTAINERS.contains(kind)) {
                waiting.extend(Fields::of(reader, id).children());
            }
        }
        Self {
            styles,
            kinds,
            points: HashMap::new(),
            welded: HashMap::new(),
            taken: HashSet::new(),
            annotations,
            imported: Tally::default(),
            left_out: Tally::default(),
            flat: Tally::default(),
            astray: Tally::default(),
            curved: Tally::default(),
        }
    }

    /// Marks `items` and all below them as met and returns those that hold triangles.
    fn skip(&mut self, reader: &Reader, mut items: Vec<u64>) -> Vec<u64> {
        let mut skipped = Vec::new();
        while let Some(id) = items.pop() {
            let Some(kind) = self.kinds.get(&id).filter(|_| self.taken.insert(id)) else { continue };
            if TRIANGULATED.contains(kind) {
                skipped.push(id);
            } else {
                items.extend(Fields::of(reader, id).children());
            }
        }
        skipped
    }

    /// Leaves `items` out, since exact shape stands beside them.
    fn leave_out(&mut self, reader: &Reader, items: Vec<u64>) {
        for id in self.skip(reader, items) {
            self.left_out.add(id);
        }
    }

    /// The body of a tessellated item; `None` where nothing of it is to be imported.
    fn body(&mut self, reader: &mut Reader, id: u64, inherited: Option<Color>) -> Option<Body> {
        let kind = *self.kinds.get(&id).filter(|_| !self.taken.contains(&id))?;
        let fields = Fields::of(reader, id);
        let linked =
            matches!(kind, "TESSELLATED_SOLID" | "TESSELLATED_SHELL").then(|| fields.last_reference());
        if linked.flatten().is_some_and(|exact| reader.taken_bodies.contains(&exact)) {
            self.leave_out(reader, vec![id]);
            return None;
        }
        self.welded.clear();
        let mut faces = Vec::new();
        self.item(reader, id, Place { world_from_item: DAffine3::IDENTITY, depth: 0 }, inherited, &mut faces);
        let body_kind = if kind == "TESSELLATED_SOLID" { BodyKind::Solid } else { BodyKind::Sheet };
        (!faces.is_empty()).then_some(Body { kind: body_kind, faces, name: fields.name, entity: id })
    }

    fn item(
        &mut self,
        reader: &mut Reader,
        id: u64,
        place: Place,
        inherited: Option<Color>,
        faces: &mut Vec<Id<Face>>,
    ) {
        let Some(&kind) = self.kinds.get(&id) else { return };
        if reader.taken_bodies.contains(&id) {
            // The file marks it as invisible, and that was said.
            self.skip(reader, vec![id]);
            return;
        }
        if self.annotations.contains(&id) || place.depth > MAX_CHAIN || !self.taken.insert(id) {
            return;
        }
        let color = self.styles.of(id).or(inherited);
        let fields = Fields::of(reader, id);
        if TRIANGULATED.contains(&kind) {
            self.triangulated(reader, id, kind, &fields, place.world_from_item, color, faces);
            return;
        }
        let mut inner = Place { depth: place.depth + 1, ..place };
        if let Some(location) = fields.location {
            match reader.transform(location) {
                Ok(moved) => inner.world_from_item = place.world_from_item * moved,
                Err(problem) => reader.report(Severity::Warning, problem),
            }
        }
        for child in fields.children() {
            self.item(reader, child, inner, color, faces);
        }
    }

    /// Makes a face of each triangle of a triangulated item.
    fn triangulated(
        &mut self,
        reader: &mut Reader,
        id: u64,
        kind: &str,
        fields: &Fields,
        world_from_item: DAffine3,
        color: Option<Color>,
        faces: &mut Vec<Id<Face>>,
    ) {
        let points = fields.coordinates().map(|list| self.coordinates(reader, list)).unwrap_or_default();
        // Points by the numbers that triangles name, from 1.
        let corner = |number: f64, pnindex: &[f64]| -> Option<DVec3> {
            let at = |number: f64, count: usize| {
                (number.fract() == 0.0 && number >= 1.0 && number <= count as f64)
                    .then(|| number as usize - 1)
            };
            let number = if pnindex.is_empty() { number } else { pnindex[at(number, pnindex.len())?] };
            points.get(at(number, points.len())?).copied().filter(|point| point.is_finite())
        };
        let parts = fields.triangles(kind);
        let mut pnindex = Vec::new();
        for_each_row(parts.pnindex, |row| pnindex.extend_from_slice(row));
        let millimetres = reader.units.millimetres;
        let mut triangle = |work: &mut Self, numbers: [f64; 3]| {
            let corners = numbers.map(|number| corner(number, &pnindex));
            let [Some(a), Some(b), Some(c)] = corners else {
                reader.model.declared_faces += 1;
                return work.astray.add(id);
            };
            let corners = [a, b, c].map(|p| world_from_item.transform_point3(p * millimetres));
            match work.facet(reader, corners, id, color) {
                Some(face) => {
                    reader.model.declared_faces += 1;
                    work.imported.add(id);
                    faces.push(face);
                }
                None => work.flat.add(id),
            }
        };
        match parts.shape {
            Triangles::Single(text) => for_each_row(text, |row| {
                let numbers = if row.len() == 3 { [row[0], row[1], row[2]] } else { [f64::NAN; 3] };
                triangle(self, numbers);
            }),
            Triangles::StripsAndFans(strips, fans) => {
                for_each_row(strips, |row| {
                    for (at, w) in row.windows(3).enumerate() {
                        // Every other triangle of a strip runs the other way round.
                        triangle(self, if at % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] });
                    }
                });
                for_each_row(fans, |row| {
                    for w in row.get(1..).unwrap_or_default().windows(2) {
                        triangle(self, [row[0], w[0], w[1]]);
                    }
                });
            }
            Triangles::Cubic(text) => for_each_row(text, |row| {
                let points: Vec<Option<DVec3>> = row.iter().map(|&number| corner(number, &pnindex)).collect();
                let numbers = corners_of_cubic(&points).map(|at| row.get(at).copied().unwrap_or(f64::NAN));
                self.curved.add(id);
                triangle(self, numbers);
            }),
        }
    }

    /// A COORDINATES_LIST(name, count, points), in the file's units; what is no point is not finite.
    fn coordinates(&mut self, reader: &Reader, list: u64) -> Rc<Vec<DVec3>> {
        let read = || {
            let mut points = Vec::new();
            let records = reader.raw_records(list);
            let text =
                records.iter().find(|r| r.keyword == "COORDINATES_LIST").and_then(|r| r.parameters.last());
            for_each_row(text.copied().unwrap_or_default(), |row| {
                points.push(if row.len() == 3 { DVec3::from_slice(row) } else { DVec3::NAN });
            });
            Rc::new(points)
        };
        self.points.entry(list).or_insert_with(read).clone()
    }

    /// The planar face between three corners, counter-clockwise seen from outside; `None` where they span no plane.
    fn facet(
        &mut self,
        reader: &mut Reader,
        corners: [DVec3; 3],
        entity: u64,
        color: Option<Color>,
    ) -> Option<Id<Face>> {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        let longest = a.distance_squared(b).max(b.distance_squared(c)).max(c.distance_squared(a));
        // Twice the area is the longest side times the height upon it.
        let has_plane = normal.is_finite() && normal.length() > LEAST_HEIGHT * longest;
        if !has_plane {
            return None;
        }
        let vertices = corners.map(|point| {
            // Both zeros are one.
            let key = point.to_array().map(|x| (x + 0.0).to_bits());
            *self.welded.entry(key).or_insert_with(|| reader.model.vertices.push(Vertex { point, entity }))
        });
        let coedges = (0..3).map(|i| {
            let (edge, reversed) = reader.poly_edge(vertices[i], vertices[(i + 1) % 3], entity);
            Coedge { edge, reversed }
        });
        let loops = vec![TrimLoop::Edges(coedges.collect())];
        let frame = Frame::from_axes(a, Some(normal), Some(b - a));
        let surface = reader.model.surfaces.push(Surface::Plane { frame });
        let face = Face { surface, same_sense: true, loops, color, name: String::new(), entity };
        Some(reader.model.faces.push(face))
    }

    /// Says what was imported, what was left out and why.
    fn report(self, reader: &mut Reader, catalog: &Catalog) {
        let mut others = Tally::default();
        for &id in catalog.tessellated.iter().filter(|id| !self.taken.contains(id)) {
            if self.kinds.get(&id).is_some_and(|kind| TRIANGULATED.contains(kind)) {
                others.add(id);
            }
        }
        let mut say = |severity, tally: &Tally, reason: &str, lost: bool| {
            if tally.count > 0 {
                let kind = self.kinds.get(&tally.first).copied().unwrap_or_default();
                let reason = format!("{} {reason}", tally.count);
                let mut diagnostic = Diagnostic::new(severity, tally.first, kind, reason);
                diagnostic.faces = if lost { u32::try_from(tally.count).unwrap_or(u32::MAX) } else { 0 };
                reader.model.diagnostics.push(diagnostic);
            }
        };
        let imported = "triangles of tessellated geometry imported as planar facets";
        say(Severity::Note, &self.imported, imported, false);
        say(
            Severity::Warning,
            &self.curved,
            "curved triangles imported as planar facets by their corners",
            false,
        );
        say(Severity::Note, &self.flat, "triangles without an area are left out", false);
        say(Severity::Dropped, &self.astray, "triangles name points that the file does not have", true);
        say(Severity::Note, &self.left_out, "tessellations left out beside exact shape", false);
        say(
            Severity::Note,
            &others,
            "tessellations left out: of annotations, or of no shape representation",
            false,
        );
    }
}

/// Where an item stands in its body, and how deep in containers.
#[derive(Debug, Clone, Copy)]
struct Place {
    world_from_item: DAffine3,
    depth: usize,
}
