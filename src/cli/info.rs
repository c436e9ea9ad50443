//! `trimray info`: what is in a file, for people and as JSON.

use super::args::{General, Info};
use super::bake::size_text;
use super::load::{Purpose, load};
use super::{report, tree};
use crate::scene::{EdgeGap, FaceKind, Finding, Scene, Severity, section_bytes};
use serde::Serialize;
use std::collections::BTreeMap;
use std::io::Write;

/// Lines of the product tree, unless -v asks for all.
const TREE_LINES: usize = 40;

pub(super) fn run(command: &Info, general: &General) -> anyhow::Result<()> {
    // The findings are part of the answer here, so they are not told on stderr too.
    let quiet = General { quiet: true, verbose: general.verbose, threads: None };
    let purpose = Purpose {
        strict: command.import.strict,
        kept_scenes: command.cache.kept_scenes(),
        ..Purpose::default()
    };
    let loaded = load(&command.input, purpose, &quiet)?;
    let summary = Summary::of(&loaded.scene());
    let mut out = std::io::stdout().lock();
    if command.json {
        serde_json::to_writer_pretty(&mut out, &summary).map_err(std::io::Error::from)?;
        writeln!(out)?;
    } else {
        write_text(&mut out, &summary, general.verbose > 0)?;
        let findings = report::lines(loaded.scene().metadata, general.verbose > 0);
        writeln!(out, "findings{}", if findings.is_empty() { "   none" } else { "" })?;
        for line in findings {
            writeln!(out, "  {line}")?;
        }
    }
    Ok(())
}

/// The answer. Names of fields are those of the JSON object: they stay.
#[derive(Serialize)]
struct Summary<'a> {
    file: &'a str,
    format: &'a str,
    schema: &'a str,
    originating_system: &'a str,
    unit: &'a str,
    unit_millimetres: f64,
    parts: Vec<PartSummary<'a>>,
    instances: Vec<InstanceSummary<'a>>,
    solids: u64,
    faces: FaceCounts,
    /// B-spline surfaces of the file that became elementary ones, by kind.
    recognised: &'a BTreeMap<String, u64>,
    /// The edge whose faces may be farthest apart, and how far, millimetres; absent where no faces share an edge.
    largest_gap: Option<EdgeGap>,
    nets: usize,
    leaves: usize,
    trim_segments: usize,
    trim_nodes: usize,
    /// Bytes by section, and "total".
    bytes: BTreeMap<&'static str, usize>,
    /// Least and greatest corner, millimetres; absent without faces.
    bbox: Option<[[f64; 3]; 2]>,
    /// What was repaired, guessed, hidden or dropped, entity by entity.
    diagnostics: &'a [Finding],
}

#[derive(Serialize)]
struct PartSummary<'a> {
    name: &'a str,
    entity: u64,
    faces: usize,
    instances: usize,
}

#[derive(Serialize)]
struct InstanceSummary<'a> {
    path: &'a str,
    part: u32,
}

#[derive(Serialize)]
struct FaceCounts {
    /// By the file; always `imported` + `skipped`.
    declared: u64,
    /// In the scene, each part once.
    imported: usize,
    /// `hidden` + `dropped`.
    skipped: u64,
    /// The file says that they are invisible.
    hidden: u64,
    dropped: u64,
    /// In the scene, each part as often as it is placed.
    occurrences: usize,
    by_kind: BTreeMap<&'static str, usize>,
}

impl<'a> Summary<'a> {
    fn of(scene: &Scene<'a>) -> Self {
        let metadata = scene.metadata;
        let mut faces_of = vec![0; scene.parts.len()];
        let mut by_kind: BTreeMap<&'static str, usize> = KINDS.iter().map(|&(_, name)| (name, 0)).collect();
        for face in scene.faces {
            if let Some(count) = faces_of.get_mut(face.part as usize) {
                *count += 1;
            }
            if let Some(&(_, name)) = KINDS.iter().find(|(kind, _)| *kind as u32 == face.kind) {
                *by_kind.entry(name).or_default() += 1;
            }
        }
        let mut instances_of = vec![0; scene.parts.len()];
        for instance in scene.instances {
            if let Some(count) = instances_of.get_mut(instance.part as usize) {
                *count += 1;
            }
        }
        let is_shown = |part: usize| instances_of[part] > 0 && scene.parts[part].node_count > 0;
        let imported = (0..scene.parts.len()).filter(|&part| is_shown(part)).map(|part| faces_of[part]).sum();
        let occurrences =
            faces_of.iter().zip(&instances_of).map(|(faces, instances)| faces * instances).sum();
        let parts =
            (metadata.parts.iter().zip(&faces_of).zip(&instances_of)).map(|((part, &faces), &instances)| {
                PartSummary { name: &part.name, entity: part.entity, faces, instances }
            });
        let instances = (metadata.instances.iter().zip(scene.instances))
            .map(|(info, instance)| InstanceSummary { path: &info.path, part: instance.part });
        let bounds = crate::render::bounds(scene);
        let [hidden, dropped] = [Severity::Hidden, Severity::Dropped].map(|s| metadata.missing_faces(s));
        Self {
            file: &metadata.file_name,
            format: &metadata.format,
            schema: &metadata.schema,
            originating_system: &metadata.originating_system,
            unit: &metadata.unit,
            unit_millimetres: metadata.unit_millimetres,
            parts: parts.collect(),
            instances: instances.collect(),
            solids: metadata.solids,
            faces: FaceCounts {
                declared: metadata.declared_faces,
                imported,
                skipped: hidden + dropped,
                hidden,
                dropped,
                occurrences,
                by_kind,
            },
            recognised: &metadata.recognised,
            largest_gap: metadata.largest_gap,
            nets: scene.nets.len(),
            leaves: scene.net_leaves.len(),
            trim_segments: scene.trim_segments.len(),
            trim_nodes: scene.trim_nodes.len(),
            bytes: section_bytes(scene),
            bbox: (!scene.faces.is_empty()).then(|| [bounds.min.to_array(), bounds.max.to_array()]),
            diagnostics: &metadata.findings,
        }
    }
}

const KINDS: [(FaceKind, &str); 6] = [
    (FaceKind::Plane, "plane"),
    (FaceKind::Cylinder, "cylinder"),
    (FaceKind::Cone, "cone"),
    (FaceKind::Sphere, "sphere"),
    (FaceKind::Torus, "torus"),
    (FaceKind::Nets, "nets"),
];

fn write_text(out: &mut impl Write, summary: &Summary<'_>, all: bool) -> std::io::Result<()> {
    writeln!(out, "file       {}", summary.file)?;
    writeln!(out, "format     {} {}", summary.format, summary.schema)?;
    if !summary.originating_system.is_empty() {
        writeln!(out, "written by {}", summary.originating_system)?;
    }
    writeln!(out, "unit       {} ({} mm)", summary.unit, summary.unit_millimetres)?;
    if let Some([min, max]) = summary.bbox {
        let [x, y, z] = [0, 1, 2].map(|axis| max[axis] - min[axis]);
        writeln!(out, "size       {x:.3} × {y:.3} × {z:.3} mm")?;
        writeln!(out, "box        {} to {}", point_text(min), point_text(max))?;
    }
    let (parts, instances) = (summary.parts.len(), summary.instances.len());
    writeln!(out, "parts      {parts}, placed {instances} times; {} solids", summary.solids)?;
    let faces = &summary.faces;
    write!(out, "faces      {} of {} declared, {} dropped", faces.imported, faces.declared, faces.dropped)?;
    if faces.hidden > 0 {
        write!(out, ", {} hidden in the file", faces.hidden)?;
    }
    writeln!(out)?;
    for (kind, count) in faces.by_kind.iter().filter(|(_, count)| **count > 0) {
        writeln!(out, "  {kind:<9}{count}")?;
    }
    if !summary.recognised.is_empty() {
        let kinds: Vec<String> =
            summary.recognised.iter().map(|(kind, count)| format!("{count} {kind}")).collect();
        writeln!(out, "recognised {} among the B-spline surfaces", kinds.join(", "))?;
    }
    if let Some(EdgeGap { entity, distance }) = summary.largest_gap {
        writeln!(out, "gaps       below {distance:.1e} mm, the largest at edge #{entity}")?;
    }
    writeln!(out, "nets       {} in {} leaves", summary.nets, summary.leaves)?;
    writeln!(out, "trims      {} segments, {} nodes", summary.trim_segments, summary.trim_nodes)?;
    writeln!(out, "bytes      {}", size_text(summary.bytes["total"] as u64))?;
    for (section, &bytes) in summary.bytes.iter().filter(|(name, bytes)| **name != "total" && **bytes > 0) {
        writeln!(out, "  {section:<15}{}", size_text(bytes as u64))?;
    }
    let tree = tree::lines(summary.instances.iter().map(|instance| instance.path));
    let shown = if all { tree.len() } else { TREE_LINES };
    writeln!(out, "tree")?;
    for line in tree.iter().take(shown) {
        writeln!(out, "  {line}")?;
    }
    if tree.len() > shown {
        writeln!(out, "  and {} more lines (-v shows all)", tree.len() - shown)?;
    }
    Ok(())
}

/// A point to a thousandth of a millimetre, without signs of zeros.
pub(super) fn point_text(point: [f64; 3]) -> String {
    let [x, y, z] = point.map(|x| (x * 1e3).round() / 1e3 + 0.0);
    format!("({x:.3}, {y:.3}, {z:.3})")
}
