//! Trims every face of the fixtures and, where it is there, of a corpus of real files, and holds the result against a
//! fact that knows nothing of trimming: the area vectors of a closed body, `∬ S_u × S_v du dv` with each face's sense,
//! add up to zero. A missing face, a complement instead of a face, a wrong side of a seam or a lost hole all show.
//!
//! The corpus is `../shared/corpus` or what `TRIMRAY_CORPUS` names; `TRIMRAY_FACES=1` prints each face that fails.

use glam::{DVec2, DVec3};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use trimray::brep::{BodyKind, Face, Model};
use trimray::geometry::{Bezier, Homogeneous, Homogeneous2, Surface};
use trimray::trimming::{FaceTrim, TrimError, TrimOptions, trim_face};

/// Rows of a face on which its area is summed.
const ROWS: usize = 192;

/// The four-point Gauss–Legendre rule on [0, 1].
const GAUSS: [(f64, f64); 4] = [
    (0.069_431_844_202_973_7, 0.173_927_422_568_726_9),
    (0.330_009_478_207_571_9, 0.326_072_577_431_273_1),
    (0.669_990_521_792_428_1, 0.326_072_577_431_273_1),
    (0.930_568_155_797_026_3, 0.173_927_422_568_726_9),
];

#[derive(Default)]
struct Count {
    faces: usize,
    trimmed: usize,
    reasons: BTreeMap<&'static str, usize>,
    closed_bodies: usize,
    open_bodies: usize,
    worst_deviation: f64,
}

impl Count {
    fn add(&mut self, other: &Self) {
        self.faces += other.faces;
        self.trimmed += other.trimmed;
        other.reasons.iter().for_each(|(reason, count)| *self.reasons.entry(reason).or_default() += count);
        self.closed_bodies += other.closed_bodies;
        self.open_bodies += other.open_bodies;
        self.worst_deviation = self.worst_deviation.max(other.worst_deviation);
    }
}

fn reason(error: &TrimError) -> &'static str {
    match error {
        TrimError::Unbounded(_) => "unbounded",
        TrimError::OffSurface { .. } => "off surface",
        TrimError::Empty => "empty",
        TrimError::Numeric(_) => "numeric",
    }
}

/// Parameters u where the row at height v enters and leaves the region.
fn crossings(curves: &[Bezier<Homogeneous2>], v: f64) -> Vec<f64> {
    let at = |curve: &Bezier<Homogeneous2>, t: f64| -> DVec2 { curve.eval(t).point() };
    let mut found: Vec<f64> = curves
        .iter()
        .filter_map(|curve| {
            let (a, b) = (at(curve, 0.0).y, at(curve, 1.0).y);
            if (a <= v) == (b <= v) {
                return None;
            }
            let (mut low, mut high) = (0.0, 1.0);
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                if (at(curve, middle).y <= v) == (b > a) { low = middle } else { high = middle }
            }
            Some(at(curve, low).x)
        })
        .collect();
    found.sort_by(f64::total_cmp);
    found
}

/// The area vector and the area of a face.
fn area(surface: &Surface, trim: &FaceTrim) -> (DVec3, f64) {
    let (min, max) = (trim.window.min, trim.window.max);
    let height = (max.y - min.y) / ROWS as f64;
    let (mut vector, mut total) = (DVec3::ZERO, 0.0);
    for row in 0..ROWS {
        let v = min.y + height * (row as f64 + 0.5);
        let whole = vec![min.x, max.x];
        let us = if trim.curves.is_empty() { whole } else { crossings(&trim.curves, v) };
        for pair in us.chunks_exact(2) {
            let parts = 4;
            let width = (pair[1] - pair[0]) / f64::from(parts);
            for part in 0..parts {
                for (x, weight) in GAUSS {
                    let d = surface.derivatives(DVec2::new(pair[0] + width * (f64::from(part) + x), v));
                    let normal = d.du.cross(d.dv) * (weight * width * height);
                    vector += normal;
                    total += normal.length();
                }
            }
        }
    }
    (vector, total)
}

fn trim_all(path: &Path, model: &Model, print: bool) -> Count {
    let mut count = Count::default();
    // Where the reader dropped faces, bodies cannot be closed.
    let is_whole = model.diagnostics.iter().all(|diagnostic| diagnostic.faces == 0);
    let options = TrimOptions::default();
    for part in model.parts.iter() {
        for body in &part.bodies {
            let (mut sum, mut total, mut complete) = (DVec3::ZERO, 0.0, is_whole);
            for &id in &body.faces {
                let face: &Face = &model.faces[id];
                let surface = &model.surfaces[face.surface];
                count.faces += 1;
                match trim_face(model, id, &options) {
                    Ok(trim) => {
                        count.trimmed += 1;
                        count.worst_deviation =
                            trim.edges.iter().map(|edge| edge.distance).fold(count.worst_deviation, f64::max);
                        let (vector, face_area) = area(surface, &trim);
                        sum += if face.same_sense { vector } else { -vector };
                        total += face_area;
                    }
                    Err(error) => {
                        complete = false;
                        *count.reasons.entry(reason(&error)).or_default() += 1;
                        if print {
                            eprintln!("{}: #{} on {}: {error}", path.display(), face.entity, surface.kind());
                        }
                    }
                }
            }
            if body.kind == BodyKind::Solid && complete {
                // Midpoint rows leave about 1e-3; a wrong face of a small part is worth more.
                if sum.length() <= 2e-3 * total {
                    count.closed_bodies += 1;
                } else {
                    count.open_bodies += 1;
                    if print {
                        eprintln!(
                            "{}: body #{} of {} faces is open: {:.1e} of its area",
                            path.display(),
                            body.entity,
                            body.faces.len(),
                            sum.length() / total
                        );
                    }
                }
            }
        }
    }
    count
}

fn step_files(folder: &Path, found: &mut Vec<PathBuf>) {
    let Ok(entries) = std::fs::read_dir(folder) else { return };
    for entry in entries.flatten() {
        let path = entry.path();
        if path.is_dir() {
            step_files(&path, found);
        } else if path.extension().and_then(|e| e.to_str()).is_some_and(|extension| {
            ["step", "stp", "p21"].contains(&extension.to_ascii_lowercase().as_str())
        }) {
            found.push(path);
        }
    }
}

fn sweep(folder: &Path) -> Option<Count> {
    let print = std::env::var_os("TRIMRAY_FACES").is_some();
    let mut files = Vec::new();
    step_files(folder, &mut files);
    files.sort();
    let mut all = Count::default();
    for path in &files {
        let begin = std::time::Instant::now();
        let model = match trimray::import::import(path) {
            Ok(model) => model,
            Err(error) => {
                eprintln!("{}: {error}", path.display());
                continue;
            }
        };
        let read = begin.elapsed();
        let count = trim_all(path, &model, print);
        eprintln!(
            "{}: {} of {} faces trimmed, {} bodies closed, {} open, deviation {:.1e} mm, {:?}; read {:.2} s, trimmed {:.2} s",
            path.display(),
            count.trimmed,
            count.faces,
            count.closed_bodies,
            count.open_bodies,
            count.worst_deviation,
            count.reasons,
            read.as_secs_f64(),
            (begin.elapsed() - read).as_secs_f64()
        );
        all.add(&count);
    }
    eprintln!(
        "{}: {} files, {} of {} faces trimmed, {} bodies closed, {} open, {:?}",
        folder.display(),
        files.len(),
        all.trimmed,
        all.faces,
        all.closed_bodies,
        all.open_bodies,
        all.reasons
    );
    (!files.is_empty()).then_some(all)
}

#[test]
fn fixtures_are_trimmed_and_closed() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");
    let count = sweep(&folder).expect("there are fixtures");
    assert_eq!(count.trimmed, count.faces, "every face is trimmed");
    assert_eq!(count.open_bodies, 0, "every solid is closed");
}

#[test]
fn corpus_is_trimmed_and_closed() {
    let folder = std::env::var_os("TRIMRAY_CORPUS")
        .map_or_else(|| Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/corpus"), PathBuf::from);
    let Some(count) = sweep(&folder) else {
        eprintln!("skipped: no corpus at {}", folder.display());
        return;
    };
    assert!(count.trimmed as f64 >= 0.99 * count.faces as f64, "99 % of all faces are trimmed");
    assert!(count.closed_bodies >= 9 * count.open_bodies, "nine of ten solids are closed");
}
