//! The f64 reference that judges the tracers is judged itself: by equations, and by Open CASCADE's hits on real files.

use glam::DVec3;
use std::path::{Path, PathBuf};
use trimray::bake::{BakeOptions, bake};
use trimray::bench::chord;
use trimray::brep::{Body, BodyKind, Face, Model, Part};
use trimray::geometry::{BsplineSurface, Frame, Homogeneous, Surface};
use trimray::import::import;
use trimray::render::Ray;
use trimray::render::reference::Reference;
use trimray::scene::SceneBuffers;

/// Rays at each surface.
const RAYS: u64 = 4000;

const MAJOR: f64 = 2.0;
const MINOR: f64 = 0.5;

/// A hit is off the equation by so much at most, over the size.
const TOLERANCE: f64 = 1e-12;

fn wide() -> BakeOptions {
    BakeOptions { keep_f64: true, ..BakeOptions::default() }
}

fn scene_of(surface: Surface) -> SceneBuffers {
    let mut model = Model { declared_faces: 1, ..Model::default() };
    let surface = model.surfaces.push(surface);
    let (color, name) = (None, String::new());
    let face = model.faces.push(Face { surface, same_sense: true, loops: vec![], color, name, entity: 1 });
    let body = Body { kind: BodyKind::Solid, faces: vec![face], name: String::new(), entity: 2 };
    let part = Part { name: "part".into(), bodies: vec![body], children: vec![], entity: 3 };
    let part = model.parts.push(part);
    model.roots.push(part);
    bake(&model, &wide(), &|_, _| {})
}

/// A full turn around z of a full circle around (`major`, 0), or of a half one where that is 0, in rational quadratics.
fn turned_circle(major: f64, minor: f64) -> Surface {
    let corners: [[i32; 2]; 9] =
        [[0, -1], [1, -1], [1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1]];
    let weight = |index: usize| if index.is_multiple_of(2) { 1.0 } else { std::f64::consts::FRAC_1_SQRT_2 };
    let profile = if major > 0.0 { &corners[..] } else { &corners[..5] };
    let points = corners.iter().enumerate().flat_map(|(i, around)| {
        profile.iter().enumerate().map(move |(j, along)| {
            let radius = major + minor * f64::from(along[0]);
            let [x, y] = around.map(|c| radius * f64::from(c));
            Homogeneous::new(DVec3::new(x, y, minor * f64::from(along[1])), weight(i) * weight(j))
        })
    });
    let knots = |pieces: usize| {
        let inner = (0..=pieces).flat_map(|k| [k as f64; 2]);
        std::iter::once(0.0).chain(inner).chain(std::iter::once(pieces as f64)).collect()
    };
    let spline = BsplineSurface::new([2, 2], [knots(4), knots(profile.len() / 2)], points.collect());
    Surface::Bspline(spline.expect("valid knots"))
}

/// Changes of sign of a function along a ray's way through the scene, at steps of a 4000th of it.
fn crossings(ray: &Ray, length: f64, off: fn(DVec3) -> f64) -> usize {
    let signs: Vec<bool> = (0..=4000).map(|k| off(ray.at(length * f64::from(k) / 4000.0)) > 0.0).collect();
    signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

#[test]
fn the_reference_agrees_with_equations() {
    let frame = Frame::IDENTITY;
    let sphere: fn(DVec3) -> f64 = |p| p.length() - MAJOR;
    let torus: fn(DVec3) -> f64 = |p| (p.truncate().length() - MAJOR).hypot(p.z) - MINOR;
    let cases = [
        ("sphere", Surface::Sphere { frame, radius: MAJOR }, sphere),
        ("sphere as nets", turned_circle(0.0, MAJOR), sphere),
        ("torus", Surface::Torus { frame, major: MAJOR, minor: MINOR }, torus),
        ("torus as nets", turned_circle(MAJOR, MINOR), torus),
    ];
    for (name, surface, off) in cases {
        let buffers = scene_of(surface);
        let scene = buffers.scene();
        assert_eq!(scene.faces.len(), 1, "{name}: {:?}", scene.metadata.findings);
        let reference = Reference::new(buffers.scene());
        let (mut certain, mut hits, mut worst) = (0, 0, 0.0f64);
        for ray in (0..RAYS).map(|index| chord(&buffers.scene(), index)) {
            let Some(found) = reference.trace(&ray) else { continue };
            certain += 1;
            hits += found.len();
            for expected in &found {
                let at = ray.at(expected.hit.t);
                worst = worst.max(off(at).abs());
                let step = 1e-6;
                let slope = |axis: DVec3| (off(at + axis * step) - off(at - axis * step)) / (2.0 * step);
                let normal = DVec3::new(slope(DVec3::X), slope(DVec3::Y), slope(DVec3::Z)).normalize();
                assert!(normal.dot(expected.hit.normal).abs() > 1.0 - 1e-9, "{name}: {ray:?} {expected:?}");
            }
            // Two crossings within a step have the sign of none.
            let seen = crossings(&ray, 4.0 * (MAJOR + MINOR), off);
            let is_close =
                |pair: &[trimray::render::reference::ExpectedHit]| pair[1].hit.t - pair[0].hit.t < 0.01;
            assert!(seen <= found.len(), "{name}: {ray:?}");
            if !found.windows(2).any(is_close) {
                assert_eq!(found.len(), seen, "{name}: {ray:?}");
            }
        }
        eprintln!("{name}: {certain} of {RAYS} rays are certain, {hits} hits off by {worst:.1e} mm at most");
        assert!(certain > RAYS * 99 / 100 && hits as u64 > RAYS / 3, "{name}: {certain} {hits}");
        assert!(worst <= TOLERANCE * (MAJOR + MINOR), "{name}: {worst:e}");
    }
}

#[test]
fn what_touches_is_not_certain() {
    let beside = |distance: f64| Ray { origin: DVec3::new(-9.0, 0.3, distance), direction: DVec3::X };
    // The ray y = 0.3, z = h is at the distance |(0.3, h)| from the sphere's centre.
    let touching = (MAJOR * MAJOR - 0.09_f64).sqrt();
    for surface in [Surface::Sphere { frame: Frame::IDENTITY, radius: MAJOR }, turned_circle(0.0, MAJOR)] {
        let buffers = scene_of(surface);
        let reference = Reference::new(buffers.scene());
        let count = |height: f64| reference.trace(&beside(height)).map(|hits| hits.len());
        assert_eq!(count(touching), None);
        assert_eq!(count(touching + 1e-8), None);
        assert_eq!(count(touching - 1e-8), None);
        assert_eq!(count(touching + 1e-3), Some(0));
        assert_eq!(count(touching - 1e-3), Some(2));
    }
}

/// Files of the corpus with at most so many bytes; the reference looks at every face.
const MOST_BYTES: u64 = 400_000;

/// Open CASCADE's hits are good to 10⁻⁷; as in its comparison with the tracer, over the diagonal.
const SAME_PLACE: f64 = 1e-6;

fn files_below(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let path = entry.path();
        if path.is_dir() {
            files_below(&path, found);
        } else if entry.metadata().is_ok_and(|data| data.len() <= MOST_BYTES) {
            found.push(path);
        }
    }
}

/// Distances, those closer than the tolerance once.
fn apart(mut distances: Vec<f64>, tolerance: f64) -> Vec<f64> {
    distances.sort_by(f64::total_cmp);
    distances.dedup_by(|next, last| *next - *last <= tolerance);
    distances
}

#[test]
fn the_reference_agrees_with_open_cascade() {
    let shared = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared");
    let (corpus, oracle) = (shared.join("corpus"), shared.join("oracle"));
    let mut files = Vec::new();
    files_below(&corpus, &mut files);
    files.sort();
    if files.is_empty() || !oracle.exists() {
        eprintln!("skipped: there are no files beside this repository to compare with");
        return;
    }
    let (mut models, mut alike, mut compared, mut errors) = (0, 0, 0, Vec::new());
    for path in files {
        let below = path.strip_prefix(&corpus).expect("it is below").to_string_lossy();
        let name = format!("{}.json", below.replace('/', "__").replace(' ', "_"));
        let Ok(text) = std::fs::read_to_string(oracle.join(name)) else { continue };
        let answers: serde_json::Value = serde_json::from_str(&text).expect("JSON");
        let (Some(rays), Ok(model)) = (answers["rays"].as_array(), import(&path)) else { continue };
        let numbers = |value: &serde_json::Value| -> Vec<f64> {
            value.as_array().into_iter().flatten().filter_map(serde_json::Value::as_f64).collect()
        };
        let corners = numbers(&answers["bbox"]);
        let diagonal = DVec3::from_slice(&corners).distance(DVec3::from_slice(&corners[3..]));
        let buffers = bake(&model, &wide(), &|_, _| {});
        let reference = Reference::new(buffers.scene());
        let (mut certain, mut agreeing) = (0, 0);
        for ray in rays {
            let hits = ray["hits"].as_array().expect("hits");
            if hits.iter().any(|hit| hit[4] == "ON") {
                continue;
            }
            let [origin, direction] = ["o", "d"].map(|key| DVec3::from_slice(&numbers(&ray[key])));
            let Some(found) = reference.trace(&Ray { origin, direction }) else { continue };
            let tolerance = SAME_PLACE * diagonal;
            let ours = apart(found.iter().map(|expected| expected.hit.t).collect(), tolerance);
            let theirs = apart(hits.iter().filter_map(|hit| hit[0].as_f64()).collect(), tolerance);
            let is_same = |(a, b): (&f64, &f64)| (a - b).abs() <= tolerance;
            let agrees = ours.len() == theirs.len() && ours.iter().zip(&theirs).all(is_same);
            certain += 1;
            agreeing += usize::from(agrees);
            if agrees {
                errors.extend(ours.iter().zip(&theirs).map(|(a, b)| (a - b).abs() / diagonal));
            }
        }
        eprintln!("{}: {agreeing} of {certain} certain rays agree", path.display());
        models += 1;
        alike += usize::from(certain > 0 && agreeing * 100 >= certain * 99);
        compared += certain;
    }
    errors.sort_by(f64::total_cmp);
    let median = errors.get(errors.len() / 2).copied().unwrap_or(f64::INFINITY);
    eprintln!(
        "{models} files: on {alike} agree 99 % of the certain rays, {compared} in all; median error {median:.1e}"
    );
    // On the others Open CASCADE reads or mends a face otherwise.
    assert!(models >= 30 && compared > 5000, "{models} {compared}");
    assert!(alike + 4 >= models && median < 1e-9, "{alike} of {models}, {median:e}");
}
