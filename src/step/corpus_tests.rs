//! Sweeps over real files, where they are at hand (`../shared/corpus` beside the repository), and a differential test of the
//! scanner against ruststep.

use super::{decode, read, scan};
use crate::brep::{Model, Severity};
use std::collections::HashSet;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Real STEP files with their contents; empty, with a word about it, where there are none.
fn corpus() -> Vec<(PathBuf, Vec<u8>)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/corpus");
    let root =
        if root.is_dir() { root } else { Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/corpus") };
    let mut files = Vec::new();
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(&folder) else { continue };
        for path in entries.filter_map(|entry| entry.ok().map(|e| e.path())) {
            let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
            if path.is_dir() {
                folders.push(path);
            } else if ["stp", "step", "p21"].contains(&extension.as_str()) {
                let bytes = std::fs::read(&path).expect("a listed file can be read");
                files.push((path, bytes));
            }
        }
    }
    if files.is_empty() {
        eprintln!("skipped: no corpus at {}", root.display());
    }
    files.sort();
    files
}

/// The invariants of every imported model.
pub fn check(model: &Model, name: &str) {
    let lost: usize = model.diagnostics.iter().map(|d| d.faces as usize).sum();
    assert_eq!(model.declared_faces, model.faces.len() + lost, "{name}: a face was lost silently");
    let in_bodies: usize = model.parts.iter().flat_map(|p| &p.bodies).map(|b| b.faces.len()).sum();
    assert_eq!(in_bodies, model.faces.len(), "{name}: each face belongs to one body");
    for edge in model.edges.iter() {
        assert!(edge.range.iter().all(|t| t.is_finite()), "{name}: edge #{} has no range", edge.entity);
    }
    for child in model.parts.iter().flat_map(|p| &p.children) {
        assert!(child.parent_from_child.is_finite(), "{name}");
    }
}

#[test]
fn every_face_of_real_files_is_accounted_for() {
    for (path, bytes) in corpus() {
        let start = Instant::now();
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        match read(&bytes) {
            Ok(model) => {
                let seconds = start.elapsed().as_secs_f64();
                check(&model, &name);
                let colors: HashSet<String> =
                    model.faces.iter().filter_map(|f| f.color).map(|c| format!("{c:?}")).collect();
                let children: usize = model.parts.iter().map(|p| p.children.len()).sum();
                eprintln!(
                    "{name:.50}: {}/{} faces, {} parts, {} roots, {children} placements, {} colours of faces, {} findings, {:.0} ms",
                    model.faces.len(),
                    model.declared_faces,
                    model.parts.len(),
                    model.roots.len(),
                    colors.len(),
                    model.diagnostics.len(),
                    seconds * 1e3,
                );
                for diagnostic in model.diagnostics.iter().take(4) {
                    eprintln!("    {diagnostic}");
                }
            }
            Err(error) => eprintln!("{name}: {error}"),
        }
    }
}

#[test]
fn fixtures_are_read_whole() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");
    let Ok(entries) = std::fs::read_dir(&root) else {
        eprintln!("skipped: no fixtures, as in a published package");
        return;
    };
    for folder in entries.filter_map(|entry| entry.ok().map(|e| e.path())) {
        let Ok(bytes) = std::fs::read(folder.join("model.step")) else { continue };
        let fixture =
            std::fs::read_to_string(folder.join("fixture.toml")).expect("a fixture has a description");
        let fixture: toml::Table = fixture.parse().expect("the description is TOML");
        let model = read(&bytes).expect("a fixture is STEP");
        let name = folder.display().to_string();
        check(&model, &name);
        // Offset surfaces are the only ones that have no exact form.
        let unexpected: Vec<_> = model
            .diagnostics
            .iter()
            .filter(|d| d.kind != "OFFSET_SURFACE" || d.severity == Severity::Dropped)
            .collect();
        assert!(unexpected.is_empty(), "{name}: {unexpected:?}");
        assert_eq!(
            fixture["expect"]["faces"].as_integer(),
            i64::try_from(model.declared_faces).ok(),
            "{name}"
        );
        assert_eq!(fixture["expect"]["unit"].as_str(), Some(model.source.unit.name.as_str()), "{name}");
    }
}

#[test]
fn edges_begin_and_end_at_their_vertices() {
    let mut far = 0;
    let mut all = 0;
    for (path, bytes) in corpus() {
        let Ok(model) = read(&bytes) else { continue };
        for edge in model.edges.iter() {
            all += 1;
            let distance = (0..2)
                .map(|i| edge.curve.point(edge.range[i]).distance(model.vertices[edge.vertices[i]].point))
                .fold(0.0, f64::max);
            if distance > 0.02 {
                far += 1;
                eprintln!("{}: edge #{} is {distance} mm off its vertex", path.display(), edge.entity);
            }
        }
    }
    assert!(far * 500 <= all, "{far} of {all} edges are far from their vertices");
}

/// Entity ids and keywords as ruststep has them; `None` where it refuses the file.
fn with_ruststep(text: &str) -> Option<Vec<(u64, Vec<String>)>> {
    use ruststep::ast::EntityInstance;
    let exchange = std::panic::catch_unwind(|| ruststep::parser::parse(text).ok()).ok()??;
    let mut entities: Vec<_> = exchange
        .data
        .into_iter()
        .flat_map(|section| section.entities)
        .map(|entity| match entity {
            EntityInstance::Simple { id, record } => (id, vec![record.name]),
            EntityInstance::Complex { id, subsuper } => {
                (id, subsuper.0.into_iter().map(|r| r.name).collect())
            }
        })
        .collect();
    entities.sort();
    entities.dedup_by_key(|e| e.0);
    Some(entities)
}

fn with_ours(text: &str) -> Vec<(u64, Vec<String>)> {
    let index = scan::index(text.as_bytes());
    let decoded =
        index.statements.iter().filter_map(|s| decode::decode(index.bytes, s.id, s.body.clone()).ok());
    decoded.map(|e| (e.id, e.records.iter().map(|r| r.keyword.to_string()).collect())).collect()
}

#[test]
fn ruststep_sees_the_same_entities_in_small_files() {
    for data in [
        "#1=A(1,2.5,'x',.T.,$,*,(#2,#3));#2=B((1,2),(3));",
        "#10=(A(1)B('y')C(*));\n#3 = D ( /* c */ ) ;",
        "#1=A(TYPED(1.5));/* #2=B(); */#5=C('a;b''s');",
    ] {
        let text = format!(
            "ISO-10303-21;HEADER;FILE_DESCRIPTION((''),'2;1');FILE_NAME('','',(''),(''),'','','');\
             FILE_SCHEMA(('X'));ENDSEC;DATA;{data}ENDSEC;END-ISO-10303-21;"
        );
        if let Some(theirs) = with_ruststep(&text) {
            assert_eq!(with_ours(&text), theirs, "{data}");
        }
    }
}

#[test]
fn ruststep_sees_the_same_entities_in_real_files() {
    let mut compared = 0;
    // ruststep takes seconds for the largest files and shows nothing new there.
    for (path, bytes) in corpus().into_iter().filter(|(_, bytes)| bytes.len() < 400_000) {
        let Ok(text) = String::from_utf8(bytes) else { continue };
        let Some(theirs) = with_ruststep(&text) else { continue };
        assert_eq!(with_ours(&text), theirs, "{}", path.display());
        compared += 1;
    }
    eprintln!("{compared} files compared with ruststep");
}
