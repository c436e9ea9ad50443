//! `--only`, `--hide` and `--focus`.

use super::{Bench, json, read};
use serde_json::Value;
use std::collections::BTreeSet;
use std::path::Path;
use trimray::image::{compare, read_png};

/// A chain of six links of one part, in three pairs, as a CAD file and baked; and rays down through all of it.
fn chain() -> (Bench, String) {
    let bench = Bench::new();
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/chain/model.step");
    std::fs::copy(fixture, bench.path("chain.step")).expect("copied");
    bench.run("bake chain.step --keep-f64").expect(0);
    let info = json(&bench.run("info chain.step --json").expect(0));
    let bound = |end: usize, axis: usize| info["bbox"][end][axis].as_f64().expect("a number");
    let at = |axis: usize, share: f64| bound(0, axis) + share * (bound(1, axis) - bound(0, axis));
    let rays = (0..1200)
        .map(|i| {
            let (x, y) = (at(0, (f64::from(i % 40) + 0.4) / 40.0), at(1, (f64::from(i / 40) + 0.3) / 30.0));
            format!("{x} {y} 1000 0 0 -1\n")
        })
        .collect();
    (bench, rays)
}

/// The links that are left, by the names of their placements.
fn links(bench: &Bench, arguments: &str) -> BTreeSet<String> {
    let flags = "--resolution 4,4 --samples 1 --device cpu -q";
    bench.run(&format!("render {arguments} -o links.png --id-map links.json {flags}")).expect(0);
    let map: Value = serde_json::from_slice(&read(&bench.path("links.json"))).expect("JSON");
    let parts = map["parts"].as_array().expect("parts").iter();
    parts.map(|part| part["path"].as_str().expect("a path").to_owned()).collect()
}

#[test]
fn what_is_chosen_is_there_and_nothing_else() {
    let (bench, _) = chain();
    for file in ["chain.step", "chain.trimray"] {
        let found = |flags: &str| links(&bench, &format!("{file} {flags}")).len();
        assert_eq!(found(""), 6, "{file}");
        assert_eq!(found("--only link?2"), 1);
        assert_eq!(found("--only link?2 --only *4"), 2);
        assert_eq!(found("--only pair?2"), 2);
        assert_eq!(found("--hide **/pair?1/*"), 4);
        assert_eq!(found("--hide chain/pair?1 --hide link?3"), 3);
        assert_eq!(found("--only pair?* --hide link?5"), 5);
    }
}

/// Hits of what is left do not depend on whether it was chosen from the model or from the baked scene.
#[test]
fn a_baked_scene_is_chosen_from_as_the_model_is() {
    let (bench, rays) = chain();
    let hits = |file: &str| bench.probe(&format!("{file} --precision f64 --hide link?2"), &rays);
    let (of_model, of_scene) = (hits("chain.step"), hits("chain.trimray"));
    let mut compared = 0;
    for (a, b) in of_model.iter().zip(&of_scene) {
        let (a, b) = (a["hits"].as_array().expect("hits"), b["hits"].as_array().expect("hits"));
        assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(b) {
            let t = |hit: &Value| hit["t"].as_f64().expect("a number");
            assert!((t(a) - t(b)).abs() < 1e-9 && a["part"] == b["part"] && a["entity"] == b["entity"]);
            compared += 1;
        }
    }
    eprintln!("{compared} hits compared");
    assert!(compared > 100, "{compared}");
    let picture = |file: &str| {
        let flags = "--only pair?2 --resolution 60,40 --samples 4 --device cpu -q";
        bench.run(&format!("render {file} -o part.png {flags}")).expect(0);
        read_png(&bench.path("part.png")).expect("a picture")
    };
    let difference = compare(&picture("chain.step"), &picture("chain.trimray"), 16).expect("one size");
    assert!(difference.outliers < 0.05, "{difference:?}");
}

#[test]
fn faces_are_chosen_by_their_numbers() {
    let bench = Bench::new();
    bench.run("bake cube.step").expect(0);
    let down = "5 4 30 0 0 -1\n";
    let whole = bench.probe("cube.step", down);
    let top = whole[0]["hits"][0]["entity"].as_str().expect("a number").to_owned();
    for file in ["cube.step", "cube.trimray"] {
        let hits =
            |flags: String| bench.probe(&format!("{file} {flags} --device cpu -q"), down)[0]["hits"].clone();
        let without = hits(format!("--hide {top}"));
        assert_eq!(without.as_array().map(Vec::len), Some(1), "{file}");
        assert_ne!(without[0]["entity"], top);
        let alone = hits(format!("--only {top}"));
        assert_eq!((alone.as_array().map(Vec::len), &alone[0]["entity"]), (Some(1), &top.clone().into()));
    }
    let baked = bench.run(&format!("bake cube.step -o open.trimray --hide {top}")).expect(0);
    assert!(baked.stderr.contains("5 faces"), "{}", baked.stderr);
    let info = json(&bench.run("info open.trimray --json").expect(0));
    let counts = ["declared", "imported", "hidden", "dropped"].map(|key| info["faces"][key].as_u64());
    assert_eq!(counts, [Some(6), Some(5), Some(1), Some(0)]);
}

#[test]
fn what_matches_nothing_is_an_error_with_advice() {
    let (bench, _) = chain();
    for file in ["chain.step", "chain.trimray"] {
        let wrong = |flags: &str| bench.run(&format!("render {file} -o a.png {flags}"));
        let outcome = wrong("--hide lnk?2").expect(2);
        assert!(
            outcome.stderr.contains("`lnk?2`") && outcome.stderr.contains("`link 2`"),
            "{}",
            outcome.stderr
        );
        let outcome = wrong("--only screw").expect(2);
        assert!(outcome.stderr.contains("`pair 1`"), "{}", outcome.stderr);
        let outcome = wrong("--only #999999").expect(2);
        assert!(outcome.stderr.contains("#999999"), "{}", outcome.stderr);
        wrong("--hide chain").expect(4);
        assert!(!bench.path("a.png").exists());
    }
}

#[test]
fn the_focus_fills_the_picture_and_the_rest_is_drawn() {
    let (bench, _) = chain();
    let flags = "--resolution 60,40 --samples 1 --device cpu -q --view front --no-background";
    let covered = |flags: &str| {
        bench.run(&format!("render chain.step -o focus.png {flags}")).expect(0);
        let picture = read_png(&bench.path("focus.png")).expect("a picture");
        picture.pixels.iter().filter(|pixel| pixel[3] > 0).count()
    };
    let whole = covered(flags);
    let alone = covered(&format!("{flags} --only link?1"));
    let focused = covered(&format!("{flags} --focus link?1"));
    assert!(focused > alone && focused > whole, "{whole} {alone} {focused}");
    bench.run(&format!("render chain.step -o focus.png {flags} --focus nothing")).expect(2);
}

#[test]
fn edges_go_with_the_faces_that_they_bound() {
    let bench = Bench::new();
    bench.run("bake cube.step --edges").expect(0);
    let whole = bench.probe("cube.step", "5 4 30 0 0 -1\n");
    let top = whole[0]["hits"][0]["entity"].as_str().expect("a number").to_owned();
    let dark = |file: &str, flags: &str| {
        let lines = "--edges feature --resolution 90,60 --samples 1 --device cpu --camera-focal-point 5,5,5";
        bench.run(&format!("render {file} -o lines.png {lines} {flags}")).expect(0);
        let picture = read_png(&bench.path("lines.png")).expect("a picture");
        picture.pixels.iter().filter(|[r, g, b, _]| r.max(g).max(b) < &60).count() as f64
    };
    let alone = format!("--only {top} --camera-position 40,-30,40");
    let (of_model, of_scene) = (dark("cube.step", &alone), dark("cube.trimray", &alone));
    let all = dark("cube.trimray", "--camera-position 40,-30,40");
    eprintln!("{of_model} {of_scene} of {all} dark pixels");
    assert!(of_model > 20.0 && (of_scene / of_model - 1.0).abs() < 0.1, "{of_model} {of_scene}");
    assert!(all > 1.3 * of_model, "{all} {of_model}");
}

/// Taken apart, the same from the model and from the baked scene; taken apart by nothing, what it was.
#[test]
fn an_assembly_is_taken_apart() {
    let (bench, _) = chain();
    let picture = |file: &str, flags: &str| {
        let size = "--resolution 60,45 --samples 4 --device cpu -q --camera-orthographic --view top";
        bench.run(&format!("render {file} -o {file}.png {size} {flags}")).expect(0);
        read(&bench.path(&format!("{file}.png")))
    };
    let whole = picture("chain.step", "");
    assert!(picture("chain.step", "--explode 0") == whole);
    let apart = picture("chain.step", "--explode 1.5");
    assert!(apart != whole && picture("chain.trimray", "--explode 1.5") == apart);
    // Links that hang in each other overlap as seen from above; the model is smaller in a picture that shows it all.
    let covered = |flags: &str| {
        picture("chain.step", flags);
        let pixels = read_png(&bench.path("chain.step.png")).expect("a picture").pixels;
        pixels.iter().filter(|pixel| **pixel != [255; 4]).count()
    };
    let [whole, apart] = ["", "--explode 2"].map(covered);
    assert!(apart < whole && apart > whole / 20, "{whole} {apart}");
    for share in ["-1", "11", "far"] {
        let outcome = bench.run(&format!("render chain.step -o a.png --explode={share}")).expect(2);
        assert!(outcome.stderr.contains("from 0 (as it is) to 10"), "{}", outcome.stderr);
    }
}
