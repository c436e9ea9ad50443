//! Every IGES file of the corpus and of the fixtures that stands beside the repository or in it.

use crate::brep::{Model, Severity};
use std::path::{Path, PathBuf};

fn files_below(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        let Ok(entries) = std::fs::read_dir(folder) else { continue };
        for path in entries.filter_map(|entry| entry.ok().map(|entry| entry.path())) {
            let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
            if path.is_dir() {
                folders.push(path);
            } else if extension.is_some_and(|e| e == "igs" || e == "iges") {
                found.push(path);
            }
        }
    }
    found.sort();
    found
}

fn lost(model: &Model) -> usize {
    model.diagnostics.iter().map(|d| d.faces as usize).sum()
}

#[test]
fn corpus_is_read_without_loss() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let places = ["../shared/corpus", "../../shared/corpus"].map(|place| root.join(place));
    let corpus = places.iter().find(|place| place.is_dir()).unwrap_or(&places[0]);
    let files = files_below(corpus);
    if files.is_empty() {
        eprintln!("skipped: no corpus at {}", corpus.display());
        return;
    }
    for path in files {
        let bytes = std::fs::read(&path).expect("a readable file");
        let name = path.strip_prefix(corpus).expect("below the corpus").display().to_string();
        match super::read(&bytes) {
            Ok(model) => {
                eprintln!("{name}: {} of {} faces", model.faces.len(), model.declared_faces);
                for finding in model.diagnostics.iter().filter(|d| d.severity > Severity::Note) {
                    eprintln!("    {finding}");
                }
                assert_eq!(model.faces.len() + lost(&model), model.declared_faces, "{name}");
                // What is cut off cannot be read.
                let is_cut =
                    model.diagnostics.iter().any(|d| d.reason.contains("without a terminate record"));
                assert!(is_cut || lost(&model) == 0, "{name}");
            }
            Err(error) => eprintln!("{name}: {error}"),
        }
    }
}

#[test]
fn fixtures_have_as_many_faces_as_their_step_twins() {
    let fixtures = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");
    let files = files_below(&fixtures);
    assert!(files.len() >= 5, "the fixtures are in the repository");
    for path in files {
        let model = super::read(&std::fs::read(&path).expect("a readable file")).expect("an IGES file");
        let step = std::fs::read(path.with_extension("step")).expect("a twin");
        let expected = step
            .split(|b| *b == b'\n')
            .filter(|line| line.windows(14).any(|w| w == b"=ADVANCED_FACE" || w == b"ADVANCED_FACE("))
            .count();
        eprintln!(
            "{}: {} of {} faces, twin {expected}",
            path.display(),
            model.faces.len(),
            model.declared_faces
        );
        assert_eq!((model.faces.len(), lost(&model)), (expected, 0), "{}", path.display());
    }
}
