//! What a tessellated item says, read from its text: parameters of simple and complex instances, and where the triangles are.

use super::map_tessellated::is_tessellated;
use super::reader::Reader;
use super::rows::RawRecord;
use super::scan::instance_name;
use super::value::Value;
use glam::DVec3;

/// How triangles are written.
pub enum Triangles<'a> {
    /// Three numbers each.
    Single(&'a [u8]),
    /// Strips and fans.
    StripsAndFans(&'a [u8], &'a [u8]),
    /// Ten control points each.
    Cubic(&'a [u8]),
}

/// The triangles of an item, and how they name points.
pub struct Parts<'a> {
    /// Numbers of points that the triangles' numbers stand for; without any, these are points themselves.
    pub pnindex: &'a [u8],
    /// The triangles.
    pub shape: Triangles<'a>,
}

/// The parameters of a tessellated item, its name aside, whether it is a simple or a complex instance.
pub struct Fields<'a> {
    /// The item's name.
    pub name: String,
    parameters: Vec<&'a [u8]>,
    /// The placement of a repositioned item.
    pub location: Option<u64>,
}

impl<'a> Fields<'a> {
    /// Those of item `id`.
    pub fn of(reader: &Reader<'a>, id: u64) -> Self {
        let mut records = reader.raw_records(id);
        let reference = |text: &[u8]| single_reference(text);
        if let [record] = records.as_mut_slice() {
            let mut parameters = std::mem::take(&mut record.parameters);
            let name = if parameters.is_empty() { Vec::new() } else { parameters.remove(0).to_vec() };
            let is_moved = record.keyword.starts_with("REPOSITIONED");
            let location = if is_moved { parameters.pop().and_then(reference) } else { None };
            return Self { name: text_of(&name), parameters, location };
        }
        let of = |keyword: &str| records.iter().find(|r| r.keyword == keyword);
        let own = |record: &RawRecord| {
            is_tessellated(&record.keyword) && !record.keyword.starts_with("REPOSITIONED")
        };
        let inherited = ["TESSELLATED_FACE", "TESSELLATED_SURFACE_SET"].into_iter().filter_map(of);
        let parameters =
            inherited.chain(records.iter().filter(|r| own(r))).flat_map(|r| r.parameters.clone());
        let name = of("REPRESENTATION_ITEM").and_then(|r| r.parameters.first());
        let location = of("REPOSITIONED_TESSELLATED_ITEM").and_then(|r| r.parameters.last());
        Self {
            name: name.map(|name| text_of(name)).unwrap_or_default(),
            location: location.and_then(|text| reference(text)),
            parameters: parameters.collect(),
        }
    }

    fn get(&self, at: usize) -> &'a [u8] {
        self.parameters.get(at).copied().unwrap_or_default()
    }

    /// The list of points of an item with triangles.
    pub fn coordinates(&self) -> Option<u64> {
        single_reference(self.get(0))
    }

    /// The link of a solid or shell to what it was made from.
    pub fn last_reference(&self) -> Option<u64> {
        single_reference(self.parameters.last()?)
    }

    /// The items of a container.
    pub fn children(&self) -> Vec<u64> {
        let text = self.get(0);
        memchr::memchr_iter(b'#', text).filter_map(|at| instance_name(text, at)).map(|(id, _)| id).collect()
    }

    /// Coordinates, count, normals; a face then has a link; then, but for cubic ones, the indirection, and the triangles.
    pub fn triangles(&self, kind: &str) -> Parts<'a> {
        let at = if kind.ends_with("FACE") { 4 } else { 3 };
        match kind {
            "CUBIC_BEZIER_TRIANGULATED_FACE" => Parts {
                pnindex: &[],
                shape: Triangles::Cubic(self.parameters.last().copied().unwrap_or_default()),
            },
            "COMPLEX_TRIANGULATED_FACE" | "COMPLEX_TRIANGULATED_SURFACE_SET" => Parts {
                pnindex: self.get(at),
                shape: Triangles::StripsAndFans(self.get(at + 1), self.get(at + 2)),
            },
            _ => Parts { pnindex: self.get(at), shape: Triangles::Single(self.get(at + 1)) },
        }
    }
}

fn single_reference(text: &[u8]) -> Option<u64> {
    let at = memchr::memchr(b'#', text)?;
    instance_name(text, at).map(|(id, _)| id)
}

fn text_of(parameter: &[u8]) -> String {
    let quoted = parameter.trim_ascii().strip_prefix(b"'").and_then(|text| text.strip_suffix(b"'"));
    Value::Text(quoted.unwrap_or_default()).text().unwrap_or_default()
}

/// Which three of a cubic triangle's control points are its corners: those that span the most, whatever the order of the
/// points. The others lie between them unless the triangle is curved beyond recognition.
pub fn corners_of_cubic(points: &[Option<DVec3>]) -> [usize; 3] {
    let mut best = ([usize::MAX; 3], -1.0);
    // Ten points make 120 triangles; more points are none of a cubic one.
    for i in 0..points.len().min(10) {
        for j in i + 1..points.len().min(10) {
            for k in j + 1..points.len().min(10) {
                let [Some(a), Some(b), Some(c)] = [i, j, k].map(|at| points[at]) else { continue };
                let area = (b - a).cross(c - a).length();
                if area > best.1 {
                    best = ([i, j, k], area);
                }
            }
        }
    }
    best.0
}
