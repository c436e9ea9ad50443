//! Every method against an even-odd count over the region's curves in f64.

use super::super::region::{Piece, Region, parameter_at};
use super::super::trim_tests::{Loop, Random, beside_planes, circle, polygon, rectangle, star, trim};
use super::super::{BakeOptions, TrimRegions, bake_with_regions, retrim};
use super::build;
use crate::geometry::Homogeneous;
use crate::import::import;
use crate::render::cpu::{TrimCounts, trim_counted, trim_inside};
use crate::scene::{Scene, SceneBuffers, TRIM_INSIDE, TrimMethod, TrimStructure, validate};
use glam::DVec2;
use std::path::Path;

/// Answers may differ this close to a curve, in shares of the window.
const BAND: f64 = 1e-6;

fn point_of(region: &Region, piece: &Piece, t: f64) -> DVec2 {
    match piece.curve {
        Some(curve) => region.curves[curve as usize].eval(piece.t[0] + t * (piece.t[1] - piece.t[0])).point(),
        None => {
            let [a, b] = [piece.low, piece.high].map(|p| DVec2::from_array(p.map(f64::from)));
            a + (b - a) * t
        }
    }
}

fn is_inside(region: &Region, at: DVec2) -> bool {
    let passes = |piece: &&Piece| {
        if !(f64::from(piece.low[1]) <= at.y && at.y < f64::from(piece.high[1])) {
            return false;
        }
        let u = match piece.curve {
            Some(curve) => {
                let curve = &region.curves[curve as usize];
                curve.eval(parameter_at(&curve.points, 1, at.y, piece.t, true)).point().x
            }
            None => {
                let share = (at.y - f64::from(piece.low[1])) / f64::from(piece.high[1] - piece.low[1]);
                point_of(region, piece, share).x
            }
        };
        u <= at.x
    };
    region.pieces.iter().filter(passes).count() % 2 == 1
}

/// Distance from the nearest curve, within a thousandth of itself.
fn distance(region: &Region, at: DVec2) -> f64 {
    let to_piece = |piece: &Piece| {
        let mut range = [0.0, 1.0];
        let mut least = f64::INFINITY;
        for _ in 0..8 {
            let t = |i: usize| range[0] + (range[1] - range[0]) * i as f64 / 16.0;
            let of = |i: usize| point_of(region, piece, t(i)).distance(at);
            let best = (0..=16).min_by(|&a, &b| of(a).total_cmp(&of(b))).expect("seventeen");
            least = least.min(of(best));
            range = [t(best.saturating_sub(1)), t((best + 1).min(16))];
        }
        least
    };
    region.pieces.iter().map(to_piece).fold(f64::INFINITY, f64::min)
}

/// Random points, points that share coordinates with vertices, and points beside curves.
fn points(region: &Region, random: &mut Random, count: usize) -> Vec<[f32; 2]> {
    (0..count)
        .map(|i| {
            let mut at = DVec2::new(random.next(), random.next());
            let piece = &region.pieces[(random.next() * region.pieces.len() as f64) as usize];
            match i % 4 {
                1 => {
                    let vertex = if i % 8 == 1 { piece.low } else { piece.high };
                    at[i / 8 % 2] = f64::from(vertex[i / 8 % 2]);
                }
                2 | 3 => {
                    let away = [1e-2, 1e-3, 1e-4, 1e-5, 3e-6][i / 4 % 5];
                    at = point_of(region, piece, random.next()) + (at - DVec2::splat(0.5)) * 2.0 * away;
                }
                _ => {}
            }
            at.to_array().map(|x| x.clamp(0.0, 1.0) as f32)
        })
        .collect()
}

/// Compares one region, whose root is given, on `count` points; returns how many differ within the band.
fn compare(name: &str, region: &Region, scene: &SceneBuffers, root: u32, count: usize) -> usize {
    let scene = scene.scene();
    let mut random = Random(17);
    let mut within = 0;
    for point in points(region, &mut random, count) {
        let at = DVec2::from_array(point.map(f64::from));
        let expected = is_inside(region, at);
        let single = trim_inside(&scene, root, point);
        let double = trim_inside(&scene, root, point.map(f64::from));
        let counted = trim_counted(&scene, root, point, &mut TrimCounts::default());
        assert_eq!(single, counted, "{name}: {point:?} counted");
        if single != expected || double != expected {
            let distance = distance(region, at);
            assert!(
                distance <= BAND,
                "{name}: {point:?}, {distance:e} from a curve, {single} {double} not {expected}"
            );
            within += 1;
        }
    }
    within
}

/// Methods 1 to 29.
fn methods() -> impl Iterator<Item = TrimMethod> {
    TrimMethod::all().filter(|method| method.structure() != TrimStructure::Packed)
}

fn check(name: &str, loops: Vec<Loop>, count: usize) {
    let region = Region::new(&trim(loops)).expect("a region");
    for method in methods() {
        let mut structure = build(&region, method).expect("a structure");
        structure.words[0] = 0;
        let mut scene = SceneBuffers::default();
        scene.header.trim_method = method.number();
        scene.trim_nodes = structure.words;
        scene.trim_points = structure.points;
        compare(&format!("{name}, {}", method.label()), &region, &scene, 0, count);
    }
}

#[test]
fn loops_of_all_kinds() {
    let p = |x: f64, y: f64| DVec2::new(x, y);
    let mut random = Random(5);
    let unit = || rectangle(DVec2::ZERO, DVec2::ONE);
    let hole = |a: f64, b: f64| rectangle(DVec2::splat(a), DVec2::splat(b));
    check("circle", vec![circle(DVec2::ZERO, 1.0)], 1000);
    check("ring", vec![circle(DVec2::ZERO, 1.0), circle(p(0.1, 0.0), 0.7)], 1000);
    check("rectangle", vec![unit()], 500);
    check("holes", vec![unit(), hole(0.25, 0.5), hole(0.5, 0.75), circle(p(0.7, 0.2), 0.15)], 1000);
    check("star", vec![star(DVec2::ZERO, 1.0, 40, &mut random)], 1000);
    check("star of 300", vec![star(DVec2::ZERO, 1.0, 300, &mut random)], 300);
    check("bow tie", vec![polygon(&[p(0.0, 0.0), p(1.0, 1.0), p(1.0, 0.0), p(0.0, 1.0)])], 1000);
    check("sliver", vec![polygon(&[p(0.0, 0.0), p(1.0, 1.0), p(1.0, 1.0001), p(0.0, 1e-4)])], 1000);
    check("overlapping", vec![circle(p(0.0, 0.0), 1.0), circle(p(1.0, 0.0), 1.0)], 1000);
    check("touching", vec![circle(p(0.0, 0.0), 1.0), circle(p(2.0, 0.0), 1.0)], 1000);
    let stairs: Vec<DVec2> = (0..8)
        .flat_map(|i| [p(f64::from(i), f64::from(i)), p(f64::from(i + 1), f64::from(i))])
        .chain([p(8.0, 8.0), p(0.0, 8.0)])
        .collect();
    check("stairs", vec![polygon(&stairs)], 1000);
    for seed in 0..10 {
        check("near planes", vec![beside_planes(&mut Random(seed))], 200);
    }
}

#[test]
fn a_region_without_curves_is_its_window() {
    for method in methods() {
        let structure = build(&Region::default(), method).expect("a structure");
        let mut scene = SceneBuffers::default();
        scene.header.trim_method = method.number();
        scene.trim_nodes = structure.words;
        scene.trim_points = structure.points;
        for point in [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [0.3, 0.7]] {
            assert!(trim_inside(&scene.scene(), 0, point), "{} {point:?}", method.label());
        }
    }
}

fn fixture(name: &str) -> (SceneBuffers, TrimRegions) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name).join("model.step");
    baked(&path)
}

fn baked(path: &Path) -> (SceneBuffers, TrimRegions) {
    let model = import(path).expect("a readable file");
    bake_with_regions(&model, &BakeOptions::default(), &|_, _| {})
}

#[test]
fn faces_of_fixtures() {
    for name in ["mug", "elbow"] {
        let (mut scene, regions) = fixture(name);
        let original = scene.clone();
        let mut queries = 0;
        for method in TrimMethod::all() {
            retrim(&mut scene, &regions, method).expect("a structure");
            validate(&scene.scene()).unwrap_or_else(|error| panic!("{name}, {}: {error}", method.label()));
            for (face, region) in regions.regions.iter().enumerate() {
                let root = scene.faces[face].trim_root;
                if root != TRIM_INSIDE && !region.pieces.is_empty() {
                    let name = format!("{name}, {}, face {face}", method.label());
                    compare(&name, region, &scene, root, 200);
                    queries += 200;
                }
            }
        }
        assert!(queries > 20_000, "{name}: {queries}");
        retrim(&mut scene, &regions, TrimMethod::PACKED).expect("the default");
        // Back where it started, nothing has changed.
        assert!(scene.trim_nodes == original.trim_nodes);
        assert_eq!(scene.trim_segments, original.trim_segments);
        assert_eq!(scene.net_leaves, original.net_leaves);
        assert_eq!(scene.faces, original.faces);
        assert_eq!(scene.header, original.header);
    }
}

/// Broken words are refused or, where they are sound by chance, answered.
#[test]
fn broken_words_do_no_harm() {
    let (mut scene, regions) = fixture("mug");
    let mut random = Random(23);
    let mut refused = 0;
    for method in methods() {
        retrim(&mut scene, &regions, method).expect("a structure");
        let sound = scene.trim_nodes.clone();
        for _ in 0..100 {
            scene.trim_nodes.clone_from(&sound);
            let at = (random.next() * sound.len() as f64) as usize;
            scene.trim_nodes[at] = match (random.next() * 4.0) as u32 {
                0 => (random.next() * f64::from(u32::MAX)) as u32,
                1 => (random.next() * sound.len() as f64) as u32,
                2 => sound[at] ^ 1 << (random.next() * 32.0) as u32,
                _ => u32::MAX,
            };
            if validate(&scene.scene()).is_err() {
                refused += 1;
                continue;
            }
            for face in scene.faces.iter().filter(|face| face.trim_root != TRIM_INSIDE) {
                for _ in 0..20 {
                    trim_inside(&scene.scene(), face.trim_root, [random.next() as f32, random.next() as f32]);
                }
            }
        }
    }
    assert!(refused > 300, "{refused}");
}

/// Bytes of the trim arrays.
fn bytes(scene: &Scene<'_>) -> usize {
    size_of_val(scene.trim_nodes) + size_of_val(scene.trim_points) + size_of_val(scene.trim_segments)
}

/// What Table 3 of Sloup and Havran 2021 tells whatever the machine, on the files that `TRIMRAY_STUDY` names, apart by colons: tests and steps on uniform points, by face.
#[test]
#[ignore = "a measurement"]
fn table_3() {
    let Ok(files) = std::env::var("TRIMRAY_STUDY") else { return };
    let mut rows: Vec<(TrimCounts, usize, f64)> = vec![Default::default(); 30];
    for file in files.split(':') {
        let (mut scene, regions) = baked(Path::new(file));
        let trimmed = regions.regions.iter().filter(|region| region.is_bounded).count();
        let curves: usize = regions.regions.iter().map(|region| region.pieces.len()).sum();
        let curved: usize =
            regions.regions.iter().flat_map(|region| &region.pieces).filter(|p| p.curve.is_some()).count();
        eprintln!("{file}: {trimmed} trimmed faces, {curves} pieces, {curved} of them curved");
        for method in TrimMethod::all() {
            let start = std::time::Instant::now();
            retrim(&mut scene, &regions, method).expect("a structure");
            let seconds = start.elapsed().as_secs_f64();
            let mut random = Random(1);
            let mut counts = TrimCounts::default();
            let view = scene.scene();
            let per_face = (4_000_000 / view.faces.len()).clamp(20, 2000);
            for (face, region) in view.faces.iter().zip(&regions.regions) {
                if !region.is_bounded || face.trim_root == TRIM_INSIDE {
                    continue;
                }
                for _ in 0..per_face {
                    let uv = [random.next() as f32, random.next() as f32];
                    trim_counted(&view, face.trim_root, uv, &mut counts);
                }
            }
            let row = &mut rows[method.number() as usize - 1];
            row.0 += counts;
            row.1 += bytes(&view);
            row.2 += seconds;
        }
    }
    let reference = rows[2].0.exact_tests as f64 / rows[2].0.queries as f64;
    let list = rows[0].1 as f64;
    eprintln!("3-HS: {reference:.4} tests per query; 1-LC: {list} bytes");
    for (method, (counts, bytes, seconds)) in TrimMethod::all().zip(&rows) {
        let per_query = |count: u64| count as f64 / counts.queries.max(1) as f64;
        eprintln!(
            "{:12} tests {:+8.2} %  memory {:+8.2} %  steps {:5.2}  evaluations per test {:5.2}  {seconds:.3} s",
            method.label(),
            (per_query(counts.exact_tests) / reference - 1.0) * 100.0,
            (*bytes as f64 / list - 1.0) * 100.0,
            per_query(counts.steps),
            counts.evaluations as f64 / counts.exact_tests.max(1) as f64,
        );
    }
}
