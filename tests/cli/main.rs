//! The binary as its users meet it: what it prints, what it writes, how it ends.

mod bench;
mod camera;
mod cube;
mod kept;
mod light;
mod material;
mod output;
mod reference;
mod section;
mod selection;
mod stages;
mod style;

use assert_cmd::Command;
use cube::cube;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::TempDir;

/// A folder with a 10 mm cube in it.
struct Bench {
    folder: TempDir,
}

impl Bench {
    fn new() -> Self {
        let bench = Self { folder: tempfile::tempdir().expect("a temporary folder") };
        fs::write(bench.path("cube.step"), cube(10.0, "mm")).expect("written");
        bench
    }

    fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Runs trimray in the folder; arguments are split at spaces.
    fn run(&self, arguments: &str) -> Outcome {
        self.run_with(arguments, "")
    }

    fn run_with(&self, arguments: &str, stdin: &str) -> Outcome {
        let mut command = Command::cargo_bin("trimray").expect("the binary is built");
        command.current_dir(self.folder.path()).args(arguments.split_whitespace()).write_stdin(stdin);
        let output = command.output().expect("it runs");
        Outcome {
            code: output.status.code().expect("it was not killed"),
            stdout: output.stdout,
            stderr: String::from_utf8(output.stderr).expect("UTF-8"),
        }
    }

    fn probe(&self, arguments: &str, rays: &str) -> Vec<Value> {
        let outcome = self.run_with(&format!("probe {arguments} --rays -"), rays);
        outcome.expect(0).text().lines().map(|line| serde_json::from_str(line).expect("JSON")).collect()
    }
}

struct Outcome {
    code: i32,
    stdout: Vec<u8>,
    stderr: String,
}

impl Outcome {
    fn expect(self, code: i32) -> Self {
        assert_eq!(self.code, code, "{}", self.stderr);
        self
    }

    fn text(&self) -> &str {
        std::str::from_utf8(&self.stdout).expect("UTF-8")
    }
}

const RAYS: &str = "# from above, from the side, past it, from inside\n\n\
    5 4 30 0 0 -1\n-20 2 3 5 0 0\n50 50 50 1 0 0\n5 5 5 1 0.5 0.25\n3 4 -7 0.1 0.2 3\n";

#[test]
fn help_shows_every_command_and_examples() {
    let bench = Bench::new();
    let outcome = bench.run("--help").expect(0);
    for word in ["render", "bake", "info", "probe", "Examples", "Exit codes"] {
        assert!(outcome.text().contains(word), "{word}");
    }
    for command in ["render", "bake", "info", "probe"] {
        assert!(bench.run(&format!("{command} --help")).expect(0).text().contains("Usage"));
    }
}

#[test]
fn a_model_without_a_command_is_told_which_one_renders_it() {
    let bench = Bench::new();
    for name in ["cube.step", "folder/part.IGS"] {
        let outcome = bench.run(&format!("{name} --output a.png")).expect(2);
        assert!(outcome.stderr.contains(&format!("trimray render {name} -o")), "{}", outcome.stderr);
    }
    assert!(bench.run("paint").expect(2).stderr.contains("unrecognized"));
    bench.run("--help").expect(0);
}

#[test]
fn wrong_usage_ends_with_2() {
    let bench = Bench::new();
    for arguments in [
        "",
        "paint cube.step",
        "render cube.step",
        "render cube.step -o cube.jpg",
        "render cube.step cube.step -o one.png",
        "render cube.step -o a.png --resolution 0,5",
        "render cube.step -o a.png --camera-direction 0,0,0",
        "render cube.step -o a.png --samples 0",
        "bake cube.trimray",
        "probe cube.step",
        "probe cube.step --rays - --precision f16",
    ] {
        let outcome = bench.run(arguments).expect(2);
        assert!(!outcome.stderr.is_empty() && outcome.stdout.is_empty(), "{arguments}");
    }
}

#[test]
fn what_cannot_be_read_ends_with_1_and_is_named() {
    let bench = Bench::new();
    fs::write(bench.path("empty.step"), "").expect("written");
    fs::write(bench.path("text.step"), "this is no model").expect("written");
    fs::write(bench.path("text.trimray"), "this is no scene").expect("written");
    for name in ["missing.step", "missing.trimray", "empty.step", "text.step", "text.trimray"] {
        for command in ["info", "render -o a.png", "probe --rays -"] {
            let outcome = bench.run(&format!("{command} {name}")).expect(1);
            assert!(outcome.stderr.contains(name), "{}", outcome.stderr);
        }
    }
    let outcome = bench.run("render cube.step -o text.step/a.png --resolution 8,8 --device cpu").expect(1);
    assert!(outcome.stderr.contains("text.step"), "{}", outcome.stderr);
}

#[test]
fn a_file_cut_anywhere_is_answered_or_refused() {
    let bench = Bench::new();
    let text = cube(10.0, "mm");
    for share in 0..20 {
        fs::write(bench.path("cut.step"), &text[..text.len() * share / 20]).expect("written");
        let outcome = bench.run("info cut.step --json");
        match outcome.code {
            0 => drop(serde_json::from_slice::<Value>(&outcome.stdout).expect("JSON")),
            1 => assert!(outcome.stderr.contains("cut.step"), "{}", outcome.stderr),
            other => panic!("exit code {other}: {}", outcome.stderr),
        }
    }
}

#[test]
fn partial_imports_are_told_and_refused_under_strict() {
    let bench = Bench::new();
    let text = cube(10.0, "mm");
    let broken = text.replacen("=PLANE(", "=PLAIN(", 1);
    fs::write(bench.path("broken.step"), broken).expect("written");
    let outcome = bench.run("bake broken.step").expect(0);
    assert!(outcome.stderr.contains("1 of 6 faces dropped"), "{}", outcome.stderr);
    fs::remove_file(bench.path("broken.trimray")).expect("it was written");
    let outcome = bench.run("bake broken.step --strict").expect(3);
    assert!(outcome.stderr.contains("--strict"), "{}", outcome.stderr);
    assert!(!bench.path("broken.trimray").exists());
    let info = json(&bench.run("info broken.step --json").expect(0));
    assert_eq!(info["faces"]["dropped"], 1);
    assert_eq!(info["faces"]["imported"], 5);
    let dropped =
        info["diagnostics"].as_array().expect("a list").iter().filter(|d| d["severity"] == "dropped");
    assert!(dropped.count() > 0);
}

#[test]
fn nothing_to_render_ends_with_4() {
    let bench = Bench::new();
    let text = cube(10.0, "mm");
    fs::write(bench.path("bare.step"), text.replace("=ADVANCED_FACE(", "=ADVANCED_FARCE(")).expect("written");
    for command in ["render -o a.png", "bake"] {
        bench.run(&format!("{command} bare.step")).expect(4);
    }
    assert!(!bench.path("a.png").exists());
    bench.run("info bare.step").expect(0);
}

fn json(outcome: &Outcome) -> Value {
    serde_json::from_slice(&outcome.stdout).expect("JSON")
}

#[test]
fn info_counts_what_is_there() {
    let bench = Bench::new();
    let info = json(&bench.run("info cube.step --json").expect(0));
    assert_eq!(info["file"], "cube.step");
    assert_eq!(info["format"], "STEP");
    assert!(info["schema"].as_str().expect("text").contains("AUTOMOTIVE_DESIGN"));
    assert_eq!(info["unit"], "mm");
    assert_eq!(info["solids"], 1);
    assert_eq!(info["parts"].as_array().map(Vec::len), Some(1));
    assert_eq!(info["parts"][0]["name"], "Cube");
    assert_eq!(info["instances"].as_array().map(Vec::len), Some(1));
    let expected = serde_json::json!({
        "declared": 6, "imported": 6, "skipped": 0, "hidden": 0, "dropped": 0, "occurrences": 6,
        "by_kind": { "plane": 6, "cylinder": 0, "cone": 0, "sphere": 0, "torus": 0, "nets": 0 },
    });
    assert_eq!(info["faces"], expected);
    for axis in 0..3 {
        let bound = |corner: usize| info["bbox"][corner][axis].as_f64().expect("a number");
        assert!(bound(0) <= 0.0 && bound(0) > -0.01, "{}", bound(0));
        assert!(bound(1) >= 10.0 && bound(1) < 10.01, "{}", bound(1));
    }
    let text = bench.run("info cube.step").expect(0);
    assert!(text.text().contains("6 of 6 declared") && text.text().contains("Cube"), "{}", text.text());
}

#[test]
fn lengths_are_millimetres_whatever_the_unit() {
    let bench = Bench::new();
    fs::write(bench.path("inch.step"), cube(10.0, "inch")).expect("written");
    let hits = bench.probe("inch.step", "100 100 500 0 0 -1\n");
    assert_close(&hits[0]["hits"][0]["t"], 500.0 - 254.0);
    let info = json(&bench.run("info inch.step --json").expect(0));
    assert_eq!(info["unit_millimetres"], 25.4);
}

fn assert_close(value: &Value, expected: f64) {
    let value = value.as_f64().expect("a number");
    assert!((value - expected).abs() < 1e-9, "{value} is not {expected}");
}

#[test]
fn probe_answers_in_order_with_exact_hits() {
    let bench = Bench::new();
    let answers = bench.probe("cube.step", RAYS);
    assert_eq!(answers.len(), 5);
    let first = &answers[0]["hits"];
    assert_eq!(first.as_array().map(Vec::len), Some(2));
    assert_close(&first[0]["t"], 20.0);
    assert_close(&first[1]["t"], 30.0);
    for (axis, (p, n)) in [(5.0, 0.0), (4.0, 0.0), (10.0, 1.0)].into_iter().enumerate() {
        assert_close(&first[0]["p"][axis], p);
        assert_close(&first[0]["n"][axis], n);
    }
    assert_eq!(first[0]["part"], "Cube");
    assert!(first[0]["entity"].as_str().is_some_and(|e| e.starts_with('#') && e.len() > 1));
    assert_ne!(first[0]["face"], first[1]["face"]);
    // The length of the direction does not matter.
    assert_close(&answers[1]["hits"][0]["t"], 20.0);
    assert_eq!(answers[2], serde_json::json!({ "hits": [] }));
    // From inside there is one wall ahead.
    assert_eq!(answers[3]["hits"].as_array().map(Vec::len), Some(1));
    let firsts = bench.probe("cube.step --hits first", RAYS);
    for (first, all) in firsts.iter().zip(&answers) {
        assert_eq!(
            first["hits"].as_array().map(Vec::len),
            Some(all["hits"].as_array().map_or(0, |h| h.len().min(1)))
        );
        assert_eq!(first["hits"][0], all["hits"][0]);
    }
}

#[test]
fn exactness_is_one_of_three() {
    let bench = Bench::new();
    let exact = bench.probe("cube.step", RAYS);
    for mode in ["fast", "balanced", "exact"] {
        assert_eq!(bench.probe(&format!("cube.step --exactness {mode}"), RAYS), exact, "{mode}");
        let picture =
            format!("render cube.step -o {mode}.png --resolution 8,8 --samples 1 --exactness {mode}");
        bench.run(&picture).expect(0);
        assert!(bench.path(&format!("{mode}.png")).exists());
    }
    for command in ["probe cube.step --rays -", "render cube.step -o wrong.png"] {
        let outcome = bench.run(&format!("{command} --exactness sloppy")).expect(2);
        for word in ["sloppy", "fast", "balanced", "exact"] {
            assert!(outcome.stderr.contains(word), "{word}: {}", outcome.stderr);
        }
        assert!(!bench.path("wrong.png").exists());
    }
}

#[test]
fn a_wrong_ray_is_named_after_the_good_ones_are_answered() {
    let bench = Bench::new();
    let outcome = bench.run_with("probe cube.step --rays -", "5 5 30 0 0 -1\n5 5 30 0 0 0\n").expect(1);
    assert!(outcome.stderr.contains("line 2"), "{}", outcome.stderr);
    assert_eq!(outcome.text().lines().count(), 1);
    bench.run("probe cube.step --rays missing.txt").expect(1);
}

#[test]
fn a_baked_scene_answers_as_the_model_does() {
    let bench = Bench::new();
    let outcome = bench.run("bake cube.step --keep-f64").expect(0);
    assert!(outcome.stderr.contains("cube.trimray"), "{}", outcome.stderr);
    assert_eq!(outcome.stdout, b"");
    for precision in ["f32", "f64"] {
        let arguments = |file: &str| format!("{file} --precision {precision} --device cpu");
        assert_eq!(bench.probe(&arguments("cube.step"), RAYS), bench.probe(&arguments("cube.trimray"), RAYS));
    }
    let infos =
        ["cube.step", "cube.trimray"].map(|f| json(&bench.run(&format!("info --json {f}")).expect(0)));
    for key in ["file", "schema", "faces", "parts", "instances", "bbox", "unit"] {
        assert_eq!(infos[0][key], infos[1][key], "{key}");
    }
}

/// Methods of every structure, by number and by name.
#[test]
fn finer_pieces_have_the_same_hits() {
    let bench = Bench::new();
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/mug/model.step");
    fs::copy(fixture, bench.path("mug.step")).expect("copied");
    let rays: String =
        (0..200).map(|i| format!("{} {} 500 0.01 0.02 -1\n", i % 20 * 5 - 50, i / 20 * 9 - 45)).collect();
    let mut found = Vec::new();
    for quality in ["fast", "balanced", "best"] {
        bench
            .run(&format!("bake mug.step -o {quality}.trimray --bake-quality {quality} --keep-f64"))
            .expect(0);
        let size = fs::metadata(bench.path(&format!("{quality}.trimray"))).expect("a file").len();
        let hits: Vec<Vec<f64>> = bench
            .probe(&format!("{quality}.trimray --precision f64"), &rays)
            .iter()
            .map(|line| {
                line["hits"]
                    .as_array()
                    .expect("hits")
                    .iter()
                    .map(|hit| hit["t"].as_f64().expect("t"))
                    .collect()
            })
            .collect();
        found.push((size, hits));
    }
    assert!(found[0].0 < found[1].0 && found[1].0 < found[2].0);
    assert!(found[0].1.iter().flatten().count() > 50);
    for (_, hits) in &found[1..] {
        for (a, b) in hits.iter().zip(&found[0].1) {
            assert_eq!(a.len(), b.len());
            assert!(a.iter().zip(b).all(|(a, b)| (a - b).abs() < 1e-9), "{a:?} {b:?}");
        }
    }
    bench.run("bake mug.step --bake-quality superb").expect(2);
}

#[test]
fn trim_methods_give_the_same_hits() {
    let bench = Bench::new();
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/flange/model.step");
    fs::copy(fixture, bench.path("flange.step")).expect("copied");
    let rays: String = (0..400)
        .map(|i| {
            let (x, y) = (f64::from(i % 20 - 10) * 7.31 + 0.137, f64::from(i / 20 - 10) * 7.17 + 0.071);
            format!("{x} {y} 1000 0.013 0.007 -1\n")
        })
        .collect();
    let expected = bench.probe("flange.step --precision f32", &rays);
    let hits = |answer: &Value| answer["hits"].as_array().expect("hits").len();
    assert!(expected.iter().map(hits).sum::<usize>() > 20);
    for method in ["1", "hs+b", "12", "kcs-sf19", "KCS+RBEM"] {
        bench.run(&format!("bake flange.step -o {method}.trimray --trim-method {method}")).expect(0);
        let answers = bench.probe(&format!("{method}.trimray --precision f32"), &rays);
        assert_eq!(answers, expected, "{method}");
    }
    bench.run("bake flange.step --trim-method quadtree").expect(2);
}

#[test]
fn a_scene_without_f64_says_so() {
    let bench = Bench::new();
    bench.run("bake cube.step").expect(0);
    let outcome = bench.run_with("probe cube.trimray --rays - --precision f64", RAYS).expect(1);
    assert!(outcome.stderr.contains("--keep-f64"), "{}", outcome.stderr);
    let outcome = bench.run_with("probe cube.trimray --rays - --device cpu", RAYS).expect(0);
    assert!(outcome.stderr.contains("f32"), "{}", outcome.stderr);
    assert_eq!(outcome.text().lines().count(), 5);
}

#[test]
fn baking_twice_gives_the_same_bytes_on_any_number_of_threads() {
    let bench = Bench::new();
    bench.run("bake cube.step -o one.trimray -j 1").expect(0);
    bench.run("bake cube.step -o two.trimray -j 3").expect(0);
    assert!(read(&bench.path("one.trimray")) == read(&bench.path("two.trimray")));
}

fn read(path: &Path) -> Vec<u8> {
    fs::read(path).expect("it was written")
}

#[test]
fn cut_and_flipped_scenes_are_refused() {
    let bench = Bench::new();
    bench.run("bake cube.step").expect(0);
    let bytes = read(&bench.path("cube.trimray"));
    for share in 0..16 {
        fs::write(bench.path("cut.trimray"), &bytes[..bytes.len() * share / 16]).expect("written");
        let outcome = bench.run("info cut.trimray").expect(1);
        assert!(outcome.stderr.contains("cut.trimray"), "{}", outcome.stderr);
    }
    for at in (0..bytes.len()).step_by(bytes.len() / 40) {
        let mut bytes = bytes.clone();
        bytes[at] ^= 0xff;
        fs::write(bench.path("flipped.trimray"), bytes).expect("written");
        let outcome = bench.run_with("probe flipped.trimray --rays - --device cpu -q", RAYS);
        assert!([0, 1, 4].contains(&outcome.code), "byte {at}: {} {}", outcome.code, outcome.stderr);
    }
}

#[test]
fn pictures_have_the_size_and_the_background_asked_for() {
    let bench = Bench::new();
    let small = "--resolution 40,30 --samples 2 --device cpu";
    bench.run(&format!("render cube.step -o a.png {small} --background-color #ff0000")).expect(0);
    let picture = trimray::image::read_png(&bench.path("a.png")).expect("a PNG");
    assert_eq!((picture.width, picture.height), (40, 30));
    assert_eq!(picture.pixels[0], [255, 0, 0, 255]);
    assert_ne!(picture.pixels[40 * 15 + 20][..3], [255, 0, 0], "the cube is in the middle");

    let outcome = bench.run(&format!("render cube.step -o - {small} --no-background")).expect(0);
    let picture = trimray::image::decode_png(&outcome.stdout).expect("a PNG on stdout");
    assert_eq!(picture.pixels[0], [0; 4]);
    assert_eq!(picture.pixels[40 * 15 + 20][3], 255);
    assert!(outcome.stderr.contains("CPU"), "{}", outcome.stderr);

    bench.run(&format!("render cube.step -o a.exr {small}")).expect(0);
    assert!(read(&bench.path("a.exr")).starts_with(&[0x76, 0x2f, 0x31, 0x01]));
}

#[test]
fn several_inputs_make_several_pictures() {
    let bench = Bench::new();
    fs::write(bench.path("other.step"), cube(3.0, "mm")).expect("written");
    let outcome =
        bench.run("render cube.step other.step -o {model}.png --resolution 8x8 --samples 1 --device cpu -q");
    assert_eq!(outcome.expect(0).stderr, "");
    assert!(bench.path("cube.png").exists() && bench.path("other.png").exists());
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    let bench = Bench::new();
    let rays = "5 4 30 0 0 -1\n".repeat(20_000);
    fs::write(bench.path("rays.txt"), rays).expect("written");
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_trimray"))
        .current_dir(bench.folder.path())
        .args(["probe", "cube.step", "--rays", "rays.txt"])
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("it runs");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert!(output.status.success());
    assert_eq!(String::from_utf8_lossy(&output.stderr), "");
}

#[test]
fn copies_have_faces_of_their_own() {
    let bench = Bench::new();
    bench.run("bake cube.step -o cubes.trimray --replicate 3,2,2").expect(0);
    let outcome = bench.run("info cubes.trimray --json").expect(0);
    let info: Value = serde_json::from_str(outcome.text()).expect("JSON");
    assert_eq!((&info["faces"]["declared"], &info["faces"]["imported"]), (&72.into(), &72.into()));
    assert_eq!((&info["faces"]["occurrences"], &info["solids"]), (&72.into(), &12.into()));
    assert_eq!(info["parts"].as_array().expect("parts").len(), 12);
    let size = [0, 1, 2].map(|k| {
        let corner = |end: usize| info["bbox"][end][k].as_f64().expect("a number");
        corner(1) - corner(0)
    });
    // Three cubes of 10 mm and two margins of 1 mm; two cubes and a margin.
    assert!((size[0] - 32.0).abs() < 1e-3 && (size[1] - 21.0).abs() < 1e-3, "{size:?}");
    // Through the three cubes of a row, with 1 mm between them.
    let answers = bench.probe("cubes.trimray", "-20 5 5 1 0 0\n-20 16 16 1 0 0\n-20 10.5 5 1 0 0\n");
    let distances = |answer: &Value| -> Vec<f64> {
        let hits = answer["hits"].as_array().expect("hits");
        hits.iter().map(|hit| hit["t"].as_f64().expect("a number").round()).collect()
    };
    assert_eq!(distances(&answers[0]), [20.0, 30.0, 31.0, 41.0, 42.0, 52.0]);
    assert_eq!(distances(&answers[1]), distances(&answers[0]));
    assert_eq!(distances(&answers[2]), [0.0; 0]);
    let refused = bench.run("bake cube.step -o cubes.trimray --replicate 2000,1000,1").expect(1);
    assert!(refused.stderr.contains("too many"), "{}", refused.stderr);
    bench.run("bake cube.step -o cubes.trimray --replicate 2,2").expect(2);
}

#[test]
fn pictures_of_trim_tests_are_black_where_nothing_is_tested() {
    let bench = Bench::new();
    // A cube's faces are their windows: no trims.
    bench.run("render cube.step -o heat.png --resolution 40x30 --aov trim-tests").expect(0);
    let picture = trimray::image::read_png(&bench.path("heat.png")).expect("a picture");
    assert!(picture.pixels.iter().all(|pixel| *pixel == [0, 0, 0, 255]));
    bench.run("render cube.step -o heat.exr --resolution 40x30 --aov trim-tests").expect(0);
    let refused = bench.run("render cube.step -o no.png --aov trim-tests --device gpu").expect(2);
    assert!(refused.stderr.contains("CPU"), "{}", refused.stderr);
}
