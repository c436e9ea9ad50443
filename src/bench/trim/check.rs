//! Whether all methods tell the same of the same points, and the truth: a judge that counts crossings of the f64 curves.
//!
//! Half of the points are uniform over each trimmed face's window, half lie beside its curves, at 10⁻⁶ to 10⁻² of the window. Points nearer than
//! 10⁻⁶ to a curve are not judged: f32 leaves them open.

use crate::bake::{TrimJudge, TrimRegions, retrim};
use crate::bench::rays::unit;
use crate::render::cpu::{TrimQuery, answer};
use crate::scene::{Scene, SceneBuffers, TRIM_INSIDE, TrimMethod};
use rayon::prelude::*;

/// How near to a curve, in windows, points are not judged.
const BAND: f64 = 1e-6;

/// Exponents of ten of the distances of points beside curves.
const OFFSETS: [f64; 2] = [-6.0, -2.0];

/// Points that are decided together.
const POINTS_PER_TASK: u64 = 4096;

/// How one method did.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MethodCheck {
    /// Which one.
    pub method: TrimMethod,
    /// Points of which it tells otherwise than the judge.
    pub wrong: u64,
    /// The first of these.
    pub example: Option<TrimQuery>,
}

/// How all did.
#[derive(Debug, Clone, PartialEq)]
pub struct TrimCheck {
    /// Faces with trim curves.
    pub faces: usize,
    /// Points asked for.
    pub points: u64,
    /// Points that the judge decided.
    pub judged: u64,
    /// One for each method.
    pub methods: Vec<MethodCheck>,
}

/// Checks `methods` on `count` points, spread evenly over all trimmed faces; the scene has the last method's structures in the end.
///
/// # Errors
///
/// The reason why a method cannot hold the scene's trims.
pub fn check_methods(
    scene: &mut SceneBuffers,
    regions: &TrimRegions,
    methods: &[TrimMethod],
    count: u64,
) -> Result<TrimCheck, String> {
    let judged = judged_points(regions, count);
    let mut checks = Vec::with_capacity(methods.len());
    for &method in methods {
        retrim(scene, regions, method)?;
        let wrong = wrong_answers(&scene.scene(), &judged);
        checks.push(MethodCheck { method, wrong: wrong.len() as u64, example: wrong.first().copied() });
    }
    let faces = trimmed_faces(regions).len();
    Ok(TrimCheck {
        faces,
        points: points_per_face(faces, count) * faces as u64,
        judged: judged.iter().map(|points| points.len() as u64).sum(),
        methods: checks,
    })
}

fn trimmed_faces(regions: &TrimRegions) -> Vec<usize> {
    (0..regions.len()).filter(|&face| regions.is_trimmed(face)).collect()
}

fn points_per_face(faces: usize, count: u64) -> u64 {
    count.div_ceil(faces.max(1) as u64)
}

/// Points of all trimmed faces that are not in the band, with the judge's answers.
fn judged_points(regions: &TrimRegions, count: u64) -> Vec<Vec<(TrimQuery, bool)>> {
    let faces = trimmed_faces(regions);
    let each = points_per_face(faces.len(), count);
    let tasks: Vec<(usize, u64)> = faces
        .iter()
        .flat_map(|&face| (0..each).step_by(POINTS_PER_TASK as usize).map(move |first| (face, first)))
        .collect();
    tasks
        .par_iter()
        .map(|&(face, first)| {
            let judge = regions.judge(face);
            (first..each.min(first + POINTS_PER_TASK))
                .filter_map(|index| {
                    let number = |stream: u64| unit(index, (face as u64) << 3 | stream);
                    let uv = point(&judge, index % 2 == 1, &number);
                    let inside = judge.inside(uv.map(f64::from), BAND)?;
                    Some((TrimQuery { face: face as u32, uv }, inside))
                })
                .collect()
        })
        .collect()
}

/// The points of which the scene's structures tell otherwise. Faces whose trims are never asked, as no leaf of theirs is cut by them, are left out.
fn wrong_answers(scene: &Scene<'_>, judged: &[Vec<(TrimQuery, bool)>]) -> Vec<TrimQuery> {
    let is_asked = |query: &TrimQuery| scene.faces[query.face as usize].trim_root != TRIM_INSIDE;
    let is_wrong =
        |&&(query, inside): &&(TrimQuery, bool)| is_asked(&query) && answer(scene, &query) != inside;
    judged
        .par_iter()
        .flat_map_iter(|points| points.iter().filter(is_wrong).map(|&(query, _)| query))
        .collect()
}

/// A point of the window, beside a curve or anywhere.
fn point(judge: &TrimJudge, is_beside: bool, number: &dyn Fn(u64) -> f64) -> [f32; 2] {
    let anywhere = [number(0), number(1)];
    let uv = match judge.place(number(2)).filter(|_| is_beside) {
        None => anywhere,
        Some((place, across)) => {
            let exponent = OFFSETS[0] + (OFFSETS[1] - OFFSETS[0]) * number(3);
            let offset = 10.0_f64.powf(exponent) * if number(4) < 0.5 { 1.0 } else { -1.0 };
            [0, 1].map(|k| place[k] + across[k] * offset)
        }
    };
    uv.map(|x| x.clamp(0.0, 1.0) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::{BakeOptions, bake_with_regions};
    use std::path::{Path, PathBuf};

    fn baked(path: &Path) -> (SceneBuffers, TrimRegions) {
        let model = crate::import::import(path).expect("a readable file");
        bake_with_regions(&model, &BakeOptions::default(), &|_, _| {})
    }

    fn fixture(name: &str) -> PathBuf {
        Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name).join("model.step")
    }

    fn assert_all_agree(path: &Path, count: u64) {
        let (mut scene, regions) = baked(path);
        let methods: Vec<TrimMethod> = TrimMethod::all().collect();
        let found = check_methods(&mut scene, &regions, &methods, count).expect("all methods hold it");
        let name = path.display();
        // Points beside curves along the window's borders are held to the window, so half of these lie on the curves.
        assert!(found.judged * 4 > found.points * 3, "{name}: {} of {}", found.judged, found.points);
        let wrong: Vec<_> = found.methods.iter().filter(|method| method.wrong > 0).collect();
        assert!(wrong.is_empty(), "{name}: {wrong:?}");
    }

    #[test]
    fn all_methods_tell_the_truth() {
        for name in ["knob", "gear", "die", "flask", "propeller"] {
            assert_all_agree(&fixture(name), 20_000);
        }
    }

    #[test]
    #[ignore = "minutes, and real files: run with --ignored"]
    fn all_methods_tell_the_truth_of_real_files() {
        let mut folders = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/corpus")];
        let mut checked = 0;
        while let Some(folder) = folders.pop() {
            let Ok(entries) = folder.read_dir() else { continue };
            for path in entries.filter_map(|entry| entry.ok().map(|e| e.path())) {
                let extension =
                    path.extension().map(|e| e.to_string_lossy().to_lowercase()).unwrap_or_default();
                if path.is_dir() {
                    folders.push(path);
                } else if ["stp", "step", "p21", "igs", "iges"].contains(&extension.as_str())
                    && crate::import::import(&path).is_ok()
                {
                    assert_all_agree(&path, 100_000);
                    checked += 1;
                }
            }
        }
        eprintln!("{checked} files");
    }

    #[test]
    fn wrong_answers_are_found() {
        let (mut scene, regions) = baked(&fixture("knob"));
        let judged = judged_points(&regions, 5000);
        retrim(&mut scene, &regions, TrimMethod::PACKED).expect("the default holds everything");
        assert_eq!(wrong_answers(&scene.scene(), &judged), []);
        // Each trimmed face asks the structure of the next.
        let faces = trimmed_faces(&regions);
        let roots: Vec<u32> = faces.iter().map(|&face| scene.faces[face].trim_root).collect();
        for (index, &face) in faces.iter().enumerate() {
            scene.faces[face].trim_root = roots[(index + 1) % roots.len()];
        }
        assert!(wrong_answers(&scene.scene(), &judged).len() > 100);
    }
}
