//! Every fixture, from its file to counts, hits and pictures, through the binary.
//!
//! A fixture is a folder with a CAD file (`model.step`, some in `model.igs` too), what another CAD kernel says of it (`fixture.toml` and the ray hits in
//! `hits.json`; see `tools/fixtures`) and a small picture (`golden.png`). `TRIMRAY_BLESS=1` rewrites the pictures. The pictures of a GPU
//! are compared where there is one; `REQUIRE_GPU=1` makes its absence an error.

use rayon::prelude::*;
use serde::Deserialize;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use trimray::image::{Picture, compare, read_png};

/// `fixture.toml`, as far as it is checked here.
#[derive(Deserialize)]
struct Described {
    expect: Expected,
    camera: Camera,
    tolerance: Tolerance,
}

#[derive(Deserialize)]
struct Expected {
    unit: String,
    solids: u64,
    faces: u64,
    face_occurrences: u64,
    surfaces: BTreeMap<String, u64>,
    parts: usize,
    instances: usize,
    bbox: [f64; 6],
    closed: bool,
}

#[derive(Deserialize)]
struct Camera {
    direction: [f64; 3],
}

#[derive(Deserialize)]
struct Tolerance {
    outliers: f64,
}

/// `hits.json`: rays and where another kernel says they hit.
#[derive(Deserialize)]
struct Oracle {
    bbox: [f64; 6],
    rays: Vec<OracleRay>,
}

#[derive(Deserialize)]
struct OracleRay {
    o: [f64; 3],
    d: [f64; 3],
    /// t, face, u, v, and "IN" or "ON".
    hits: Vec<(f64, i64, f64, f64, String)>,
}

struct Fixture {
    name: String,
    folder: PathBuf,
    described: Described,
}

impl Fixture {
    fn model(&self) -> PathBuf {
        self.folder.join("model.step")
    }
}

fn fixtures() -> Vec<Fixture> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");
    let mut fixtures = Vec::new();
    for entry in fs::read_dir(root).expect("fixtures can be listed") {
        let folder = entry.expect("an entry").path();
        if !folder.is_dir() {
            continue;
        }
        let name = folder.file_name().expect("a name").to_string_lossy().into_owned();
        let text = fs::read_to_string(folder.join("fixture.toml")).expect("every fixture is described");
        let described = toml::from_str(&text).unwrap_or_else(|error| panic!("{name}/fixture.toml: {error}"));
        fixtures.push(Fixture { name, folder, described });
    }
    fixtures.sort_by(|a, b| a.name.cmp(&b.name));
    assert!(fixtures.len() >= 16, "only {} fixtures were found", fixtures.len());
    fixtures
}

/// Runs `check` on every fixture, prints what it found, and fails if any fixture fails.
fn check_all(what: &str, check: impl Fn(&Fixture) -> Result<String, String> + Sync) {
    let fixtures = fixtures();
    let results: Vec<_> = fixtures.par_iter().map(|fixture| (&fixture.name, check(fixture))).collect();
    let mut failed = 0;
    for (name, result) in &results {
        match result {
            Ok(found) => eprintln!("{what}: {name}: {found}"),
            Err(reason) => eprintln!("{what}: {name}: FAILED: {reason}"),
        }
        failed += usize::from(result.is_err());
    }
    eprintln!("{what}: {} fixtures ran, {failed} failed", results.len());
    assert_eq!(failed, 0, "{what}: {failed} of {} fixtures failed; reasons are above", results.len());
}

fn trimray(arguments: &[&dyn AsRef<std::ffi::OsStr>]) -> Result<Output, String> {
    let output = Command::new(env!("CARGO_BIN_EXE_trimray"))
        .args(arguments.iter().map(|a| a.as_ref()))
        .output()
        .map_err(|e| e.to_string())?;
    if output.status.success() {
        Ok(output)
    } else {
        Err(String::from_utf8_lossy(&output.stderr).into_owned())
    }
}

/// The first that does not hold is the error.
macro_rules! ensure {
    ($holds:expr, $($reason:tt)+) => {
        if !$holds {
            return Err(format!($($reason)+));
        }
    };
}

#[test]
fn counts_and_sizes_are_those_of_the_exporter() {
    check_all("counts", |fixture| {
        let output = trimray(&[&"info", &"--json", &fixture.model()])?;
        let info: Value = serde_json::from_slice(&output.stdout).map_err(|e| e.to_string())?;
        let expected = &fixture.described.expect;
        for (what, found, wanted) in [
            ("unit", &info["unit"], Value::from(expected.unit.as_str())),
            ("solids", &info["solids"], expected.solids.into()),
            ("declared faces", &info["faces"]["declared"], expected.faces.into()),
            ("dropped faces", &info["faces"]["dropped"], 0.into()),
            ("baked faces", &info["faces"]["imported"], expected.faces.into()),
            ("face occurrences", &info["faces"]["occurrences"], expected.face_occurrences.into()),
            ("parts", &list(&info["parts"]).len().into(), expected.parts.into()),
            ("instances", &list(&info["instances"]).len().into(), expected.instances.into()),
        ] {
            ensure!(*found == wanted, "{what}: {found}, expected {wanted}; {}", info["diagnostics"]);
        }
        check_kinds(&info["faces"]["by_kind"], &expected.surfaces)?;
        check_box(&info["bbox"], &expected.bbox)?;
        Ok(format!("{} faces in {} instances", expected.faces, expected.instances))
    });
}

fn list(value: &Value) -> &[Value] {
    value.as_array().map_or(&[], Vec::as_slice)
}

/// Analytic surfaces stay what they are; swept ones and splines become nets, or the analytic surface that they are in truth.
fn check_kinds(found: &Value, surfaces: &BTreeMap<String, u64>) -> Result<(), String> {
    let wanted = |kind: &str| surfaces.get(kind).copied().unwrap_or(0);
    let mut total = 0;
    for kind in ["plane", "cylinder", "cone", "sphere", "torus"] {
        let count = found[kind].as_u64().unwrap_or(0);
        ensure!(count >= wanted(kind), "{count} faces of kind {kind}, expected {}", wanted(kind));
        total += count;
    }
    total += found["nets"].as_u64().unwrap_or(0);
    let declared: u64 = surfaces.values().sum();
    ensure!(total == declared, "{total} faces of known kinds, expected {declared}");
    Ok(())
}

/// The box holds the model, and is not much larger: boxes of curved faces are bounds, not extents.
fn check_box(found: &Value, expected: &[f64; 6]) -> Result<(), String> {
    let size = distance(&expected[..3], &expected[3..]);
    for axis in 0..3 {
        let corner = |i: usize| found[i][axis].as_f64().unwrap_or(f64::NAN);
        let outside = [expected[axis] - corner(0), corner(1) - expected[3 + axis]];
        for gap in outside {
            ensure!((-1e-5 * size..=0.1 * size).contains(&gap), "box {found}, expected {expected:?}");
        }
    }
    Ok(())
}

fn distance(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// Share of rays that must agree with the other kernel, which is not always right either.
const AGREEING: f64 = 0.99;

#[test]
fn rays_hit_where_another_kernel_says() {
    check_all("hits", |fixture| check_hits(fixture, "model.step"));
}

#[test]
fn rays_hit_the_same_in_iges() {
    check_all("IGES hits", |fixture| {
        if fixture.folder.join("model.igs").exists() {
            check_hits(fixture, "model.igs")
        } else {
            Ok("left out: it has no IGES file".into())
        }
    });
}

fn check_hits(fixture: &Fixture, model: &str) -> Result<String, String> {
    let text = fs::read_to_string(fixture.folder.join("hits.json")).map_err(|e| e.to_string())?;
    let oracle: Oracle = serde_json::from_str(&text).map_err(|e| e.to_string())?;
    let tolerance = 1e-6 * distance(&oracle.bbox[..3], &oracle.bbox[3..]);
    let folder = tempfile::tempdir().map_err(|e| e.to_string())?;
    let rays = folder.path().join("rays.txt");
    let lines: Vec<String> = oracle.rays.iter().map(|r| join(&[r.o, r.d].concat())).collect();
    fs::write(&rays, lines.join("\n")).map_err(|e| e.to_string())?;
    let output = trimray(&[&"probe", &fixture.folder.join(model), &"--rays", &rays, &"--precision", &"f64"])?;
    let answers = String::from_utf8(output.stdout).map_err(|e| e.to_string())?;
    ensure!(answers.lines().count() == oracle.rays.len(), "{} answers", answers.lines().count());
    let (mut used, mut agree, mut odd, mut first_wrong) = (0, 0, 0, None);
    for (index, (ray, line)) in oracle.rays.iter().zip(answers.lines()).enumerate() {
        let answer: Value = serde_json::from_str(line).map_err(|e| e.to_string())?;
        let ours: Vec<f64> = list(&answer["hits"]).iter().filter_map(|hit| hit["t"].as_f64()).collect();
        odd += usize::from(fixture.described.expect.closed) * (ours.len() % 2);
        if ray.hits.iter().any(|hit| hit.4 == "ON") {
            continue;
        }
        used += 1;
        if same_hits(&ours, &ray.hits.iter().map(|hit| hit.0).collect::<Vec<_>>(), tolerance) {
            agree += 1;
        } else {
            first_wrong.get_or_insert(index);
        }
    }
    let found = format!("{agree} of {used} rays agree, {odd} odd");
    ensure!(
        used > 50 && f64::from(agree) >= AGREEING * f64::from(used),
        "{found}, first not: {first_wrong:?}"
    );
    ensure!(odd * 100 <= oracle.rays.len(), "{found} on a closed model");
    Ok(found)
}

fn join(numbers: &[f64]) -> String {
    numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
}

/// Whether both have the same hits, where hits within the tolerance count once.
fn same_hits(ours: &[f64], theirs: &[f64], tolerance: f64) -> bool {
    let [ours, theirs] = [ours, theirs].map(|hits| {
        let mut hits = hits.to_vec();
        hits.sort_by(f64::total_cmp);
        hits.dedup_by(|next, kept| *next - *kept <= tolerance);
        hits
    });
    ours.len() == theirs.len() && ours.iter().zip(&theirs).all(|(a, b)| (a - b).abs() <= tolerance)
}

#[test]
fn hits_are_compared_as_sets_within_the_tolerance() {
    assert!(same_hits(&[1.0, 2.0], &[2.005, 1.0, 1.001], 0.01));
    assert!(!same_hits(&[1.0, 2.0], &[1.0], 0.01));
    assert!(!same_hits(&[1.0], &[1.02], 0.01));
}

/// Differences of channels up to this are no outliers.
const THRESHOLD: u8 = 6;

/// Resolution and samples of a golden picture, and of one that a software driver of a GPU renders in seconds.
const GOLDEN: [&str; 2] = ["--resolution=320,240", "--samples=4"];
#[cfg(feature = "gpu")]
const SMALL: [&str; 2] = ["--resolution=112,84", "--samples=2"];

fn picture(
    fixture: &Fixture,
    [resolution, samples]: [&str; 2],
    device: &str,
    folder: &Path,
) -> Result<(Picture, PathBuf), String> {
    let file = folder.join(format!("{}-{device}.png", fixture.name));
    let direction = fixture.described.camera.direction.map(|c| c.to_string()).join(",");
    trimray(&[
        &"render",
        &fixture.model(),
        &"-o",
        &file,
        &resolution,
        &samples,
        &format!("--camera-direction={direction}"),
        &format!("--device={device}"),
    ])?;
    let picture = read_png(&file).map_err(|e| e.to_string())?;
    Ok((picture, file))
}

/// How far `picture` is from the golden one; an error where it is too far.
fn check_picture(fixture: &Fixture, picture: &Picture) -> Result<String, String> {
    let golden = read_png(&fixture.folder.join("golden.png")).map_err(|e| e.to_string())?;
    check_alike(fixture, picture, &golden)
}

fn check_alike(fixture: &Fixture, picture: &Picture, expected: &Picture) -> Result<String, String> {
    let difference = compare(picture, expected, THRESHOLD).map_err(|e| e.to_string())?;
    let found = format!("{:.3} % outliers, mean {:.3}", difference.outliers * 100.0, difference.mean);
    ensure!(difference.outliers <= fixture.described.tolerance.outliers, "{found}");
    Ok(found)
}

#[test]
fn pictures_of_the_cpu_are_golden() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    check_all("CPU pictures", |fixture| {
        let (picture, file) = picture(fixture, GOLDEN, "cpu", folder.path())?;
        let colors: std::collections::HashSet<_> = picture.pixels.iter().collect();
        ensure!(colors.len() > 20, "only {} colours: nothing is shown", colors.len());
        if std::env::var_os("TRIMRAY_BLESS").is_some() {
            fs::copy(file, fixture.folder.join("golden.png")).map_err(|e| e.to_string())?;
        }
        check_picture(fixture, &picture)
    });
}

#[test]
#[cfg(feature = "gpu")]
fn pictures_of_the_gpu_are_those_of_the_cpu() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let required = std::env::var_os("REQUIRE_GPU").is_some_and(|value| value == "1");
    if let Err(reason) = picture(&fixtures()[0], SMALL, "gpu", folder.path())
        && !required
    {
        eprintln!("skipped, REQUIRE_GPU=1 would make it an error: {reason}");
        return;
    }
    check_all("GPU pictures", |fixture| {
        let [on_gpu, on_cpu] = ["gpu", "cpu"].map(|device| picture(fixture, SMALL, device, folder.path()));
        check_alike(fixture, &on_gpu?.0, &on_cpu?.0)
    });
}

#[test]
fn a_wrong_picture_is_found() {
    let fixture = fixtures().swap_remove(0);
    let mut picture = read_png(&fixture.folder.join("golden.png")).expect("a golden picture");
    assert!(check_picture(&fixture, &picture).is_ok());
    let (width, height) = (picture.width, picture.height);
    for y in height / 2 - 16..height / 2 + 16 {
        for x in width / 2 - 16..width / 2 + 16 {
            let pixel = &mut picture.pixels[y * width + x];
            pixel[0] = pixel[0].wrapping_add(128);
        }
    }
    assert!(check_picture(&fixture, &picture).is_err());
}
