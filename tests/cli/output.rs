//! Depths, layers, parts of pictures, reports, and comparison of pictures.

use super::{Bench, json, read};
use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;

/// The channels of an EXR file as f32, by name.
fn channels(path: &Path) -> BTreeMap<String, Vec<f32>> {
    let image = exr::prelude::read_first_flat_layer_from_file(path).expect("an EXR file");
    let list = image.layer_data.channel_data.list.into_iter();
    list.map(|channel| (channel.name.to_string(), channel.sample_data.values_as_f32().collect())).collect()
}

const SMALL: &str = "--resolution 60,40 --samples 4 --device cpu -q";

fn caster() -> Bench {
    let bench = Bench::new();
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/caster/model.step");
    std::fs::copy(fixture, bench.path("caster.step")).expect("copied");
    bench.run("bake caster.step -q").expect(0);
    bench
}

#[test]
fn folders_are_made_before_the_work_is_done() {
    let bench = Bench::new();
    bench.run(&format!("render cube.step -o new/deep/{{model}}.png {SMALL}")).expect(0);
    assert!(bench.path("new/deep/cube.png").is_file());
    let outcome = bench.run(&format!("render nothing.step -o cube.step/a.png {SMALL}")).expect(1);
    let said = "trimray: cube.step: ";
    assert!(
        outcome.stderr.starts_with(said) && outcome.stderr.matches("os error").count() == 1,
        "{}",
        outcome.stderr
    );
}

#[test]
fn sixteen_bits_are_finer_than_eight() {
    let bench = Bench::new();
    for (name, flags) in [("8", ""), ("16", "--bit-depth 16"), ("16t", "--bit-depth 16 --no-background")] {
        bench.run(&format!("render cube.step -o {name}.png {SMALL} {flags}")).expect(0);
    }
    let decode = |name: &str| {
        let bytes = read(&bench.path(&format!("{name}.png")));
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
        let mut samples = vec![0; reader.output_buffer_size().expect("small")];
        let frame = reader.next_frame(&mut samples).expect("a picture");
        (frame.bit_depth, frame.color_type, samples)
    };
    let (shallow, deep) = (decode("8"), decode("16"));
    assert_eq!((deep.0, deep.1), (png::BitDepth::Sixteen, png::ColorType::Rgb));
    assert_eq!(decode("16t").1, png::ColorType::Rgba);
    let pairs = deep.2.chunks_exact(2).map(|pair| u16::from_be_bytes([pair[0], pair[1]]));
    for (code, fine) in shallow.2.iter().zip(pairs) {
        assert!((f64::from(fine) / 257.0 - f64::from(*code)).abs() <= 0.51, "{code} {fine}");
    }
    for wrong in ["a.png --bit-depth 12", "a.exr --bit-depth 16", "a.png --layers depth"] {
        bench.run(&format!("render cube.step -o {wrong}")).expect(2);
    }
}

#[test]
fn an_exr_file_has_the_layers_that_are_asked_for() {
    let bench = caster();
    let render = |name: &str, flags: &str| {
        bench.run(&format!("render caster.trimray -o {name} {SMALL} {flags}")).expect(0);
        channels(&bench.path(name))
    };
    let all = render("all.exr", "--no-background --id-map map.json");
    let expected = "A B CryptoObject00.A CryptoObject00.B CryptoObject00.G CryptoObject00.R CryptoObject01.A \
        CryptoObject01.B CryptoObject01.G CryptoObject01.R CryptoObject02.A CryptoObject02.B CryptoObject02.G \
        CryptoObject02.R G R albedo.B albedo.G albedo.R depth.Z gaussian_curvature.V id.face id.part mean_curvature.V normal.X normal.Y normal.Z \
        position.X position.Y position.Z uv.U uv.V";
    assert_eq!(
        all.keys().map(String::as_str).collect::<Vec<_>>(),
        expected.split_whitespace().collect::<Vec<_>>()
    );
    let some = render("some.exr", "--layers depth,uv --no-background");
    assert_eq!(
        some.keys().map(String::as_str).collect::<Vec<_>>(),
        ["A", "B", "G", "R", "depth.Z", "uv.U", "uv.V"]
    );
    assert!(some["depth.Z"] == all["depth.Z"] && some["uv.U"] == all["uv.U"] && some["R"] == all["R"]);
    assert_eq!(render("none.exr", "--layers none").len(), 4);
    bench.run("render caster.trimray -o a.exr --layers colour").expect(2);

    let map: Value = serde_json::from_slice(&read(&bench.path("map.json"))).expect("JSON");
    let hashes: BTreeMap<u32, usize> = map["parts"]
        .as_array()
        .expect("parts")
        .iter()
        .enumerate()
        .map(|(index, part)| {
            assert_eq!(part["id"], index + 1);
            (u32::from_str_radix(part["hash"].as_str().expect("text"), 16).expect("hex"), index + 1)
        })
        .collect();
    assert_eq!(hashes.len(), 10, "ten placements, each with a name of its own");
    let mut covered = 0;
    for pixel in 0..60 * 40 {
        let shares: f32 = ["00.G", "00.A", "01.G", "01.A", "02.G", "02.A"]
            .iter()
            .map(|name| all[&format!("CryptoObject{name}")][pixel])
            .sum();
        assert!((shares - all["A"][pixel]).abs() < 2e-3, "opaque parts cover what alpha says");
        let id = all["CryptoObject00.R"][pixel].to_bits();
        if all["CryptoObject00.G"][pixel] == 1.0 {
            assert_eq!(hashes[&id], all["id.part"][pixel] as usize);
            let color = |layer: &str| ["R", "G", "B"].map(|c| all[&format!("{layer}.{c}")][pixel]);
            assert!(color("albedo").iter().all(|&c| (0.0..=1.0).contains(&c) && c > 0.0));
            covered += 1;
        }
    }
    eprintln!("{covered} pixels of one part compared");
    assert!(covered > 300, "{covered}");
}

#[test]
fn curvatures_are_those_of_the_surface() {
    let bench = caster();
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/chain/model.step");
    std::fs::copy(fixture, bench.path("chain.step")).expect("copied");
    bench.run(&format!("render cube.step -o cube.exr {SMALL} --layers curvature")).expect(0);
    let cube = channels(&bench.path("cube.exr"));
    assert_eq!(cube.len(), 6, "{:?}", cube.keys());
    assert!(cube["mean_curvature.V"].iter().all(|&mean| mean == 0.0), "a cube is flat");
    bench.run(&format!("render chain.step -o chain.exr {SMALL} --layers curvature,id")).expect(0);
    let chain = channels(&bench.path("chain.exr"));
    let bent = (0..60 * 40).filter(|&pixel| chain["id.face"][pixel] > 0.0);
    let (mut hollow, mut saddles, mut round) = (0, 0, 0);
    for pixel in bent {
        let [mean, gaussian] = ["mean", "gaussian"].map(|name| chain[&format!("{name}_curvature.V")][pixel]);
        assert!(gaussian <= mean * mean * 1.0001, "{mean} {gaussian}");
        hollow += usize::from(mean < 0.0);
        saddles += usize::from(gaussian < 0.0);
        round += usize::from(gaussian > 0.0);
    }
    eprintln!("{hollow} hollow, {saddles} saddles, {round} round");
    assert!(hollow == 0 && saddles > 20 && round > 20, "{hollow} {saddles} {round}");
}

#[test]
fn positions_are_on_the_surface() {
    let bench = Bench::new();
    bench.run(&format!("render cube.step -o cube.exr {SMALL} --layers position,id,normal")).expect(0);
    let all = channels(&bench.path("cube.exr"));
    let mut seen = 0;
    for pixel in (0..60 * 40).filter(|&pixel| all["id.face"][pixel] > 0.0) {
        let [position, normal] = ["position", "normal"]
            .map(|layer| ["X", "Y", "Z"].map(|k| f64::from(all[&format!("{layer}.{k}")][pixel])));
        let axis = (0..3).find(|&k| normal[k].abs() > 0.5).expect("an axis");
        let wall = if normal[axis] > 0.0 { 10.0 } else { 0.0 };
        assert!((position[axis] - wall).abs() < 1e-4, "{position:?} {normal:?}");
        seen += 1;
    }
    eprintln!("{seen} positions compared");
    assert!(seen > 500, "{seen}");
}

#[test]
fn merged_tiles_are_the_picture_byte_for_byte() {
    let bench = caster();
    for (extension, flags) in [("png", "--no-background"), ("png", "--bit-depth 16"), ("exr", "")] {
        let render = |name: &str, more: &str| {
            bench
                .run(&format!("render caster.trimray -o {name}.{extension} {SMALL} {flags} {more}"))
                .expect(0);
        };
        render("whole", "");
        for tile in 1..=3 {
            render(&format!("tile{tile}"), &format!("--tile {tile}/3"));
        }
        let e = extension;
        bench.run(&format!("merge tile3.{e} tile1.{e} tile2.{e} -o merged.{e}")).expect(0);
        assert!(
            read(&bench.path(&format!("merged.{e}"))) == read(&bench.path(&format!("whole.{e}"))),
            "{e} {flags}"
        );
        for (name, part) in [("a", "0,0.3,0,0.5"), ("b", "0.3,1,0,0.5"), ("c", "0,1,0.5,1")] {
            render(name, &format!("--cropwindow {part}"));
        }
        bench.run(&format!("merge a.{e} b.{e} c.{e} -o merged.{e}")).expect(0);
        assert!(
            read(&bench.path(&format!("merged.{e}"))) == read(&bench.path(&format!("whole.{e}"))),
            "{e} {flags}"
        );
        let outcome = bench.run(&format!("merge a.{e} b.{e} -o merged.{e}")).expect(1);
        assert!(outcome.stderr.contains("1200 pixels are in no tile"), "{}", outcome.stderr);
    }
    for wrong in [
        "--tile 0/3",
        "--tile 4/3",
        "--cropwindow 0,1,0.5",
        "--cropwindow 0.5,0.4,0,1",
        "--tile 1/2 --view review",
        "--cropwindow 0.001,0.002,0,1",
        "--tile 1/2 --frames 3",
    ] {
        bench.run(&format!("render cube.step -o a.png --resolution 60,40 {wrong}")).expect(2);
    }
}

#[test]
fn a_report_tells_all_inputs_and_the_worst_end_counts() {
    let bench = Bench::new();
    std::fs::write(bench.path("broken.step"), "nonsense").expect("written");
    let bare = super::cube(10.0, "mm").replace("=ADVANCED_FACE(", "=ADVANCED_FARCE(");
    std::fs::write(bench.path("bare.step"), bare).expect("written");
    let outcome = bench.run(&format!("render cube.step --json -o a.png {SMALL}")).expect(0);
    let report = json(&outcome);
    let first = &report["inputs"][0];
    assert_eq!((&first["input"], &first["error"]), (&"cube.step".into(), &Value::Null));
    assert_eq!(first["faces"], serde_json::json!({ "declared": 6, "drawn": 6, "hidden": 0, "dropped": 0 }));
    assert_eq!((&first["files"][0]["path"], &first["files"][0]["width"]), (&"a.png".into(), &60.into()));
    assert!(first["device"].as_str().expect("text").contains("CPU"));
    assert!(first["seconds"]["render"].as_f64().expect("a number") > 0.0);

    let batch = format!("render bare.step cube.step -o {{model}}.png {SMALL} --json");
    let outcome = bench.run(&batch).expect(4);
    assert!(bench.path("cube.png").exists(), "the rest goes on");
    assert!(outcome.stderr.contains("bare.step") && outcome.stderr.contains("1 of 2"), "{}", outcome.stderr);
    let report = json(&outcome);
    assert_eq!(report["exit_code"], 4);
    assert!(report["inputs"][0]["error"].as_str().expect("an error").contains("bare.step"));
    assert_eq!(report["inputs"][1]["error"], Value::Null);
    bench.run(&format!("render bare.step broken.step cube.step -o {{model}}.png {SMALL}")).expect(1);
    bench.run("render cube.step -o - --json").expect(2);
    bench.run(&format!("render cube.step bare.step -o {{model}}.png --id-map map.json {SMALL}")).expect(2);
}

#[test]
fn pictures_are_compared() {
    let bench = Bench::new();
    let render = |name: &str, flags: &str| {
        bench.run(&format!("render cube.step -o {name} {SMALL} {flags}")).expect(0);
    };
    render("a.png", "");
    render("b.png", "--camera-azimuth-angle 3");
    render("a.exr", "");
    render("b.exr", "--layers depth");
    let same = bench.run("diff a.png a.png").expect(0);
    assert!(same.text().contains("0 of 2400 pixels"), "{}", same.text());
    let outcome = bench.run("diff a.png b.png --json --heat heat.png").expect(5);
    assert!(outcome.stderr.contains("differ"), "{}", outcome.stderr);
    let found = json(&outcome);
    assert_eq!((&found["within"], &found["width"]), (&false.into(), &60.into()));
    let outliers = found["outliers"].as_u64().expect("a count");
    assert!(outliers > 20 && found["channels"].as_array().map(Vec::len) == Some(4));
    let heat = trimray::image::read_png(&bench.path("heat.png")).expect("a picture");
    let black = heat.pixels.iter().filter(|pixel| pixel[..3] == [0; 3]).count();
    assert!(heat.pixels.contains(&[255, 0, 0, 255]) && black as u64 >= 2400 - outliers);
    bench.run("diff a.png b.png --tolerance 1").expect(0);
    bench.run("diff a.png b.png --max-outliers 1").expect(0);
    bench.run("diff a.exr a.exr").expect(0);
    let outcome = bench.run("diff a.exr b.exr").expect(5);
    assert!(outcome.stderr.contains("only one has the channel"), "{}", outcome.stderr);
    bench.run("diff a.png a.exr").expect(2);
    bench.run("diff a.png missing.png").expect(1);
    bench.run("diff a.png a.png --tolerance -1").expect(2);
}

/// A cube seen from the front: each ray that meets it needs one face, and no other step of nets or trims.
#[test]
fn stats_count_what_rays_take() {
    let bench = Bench::new();
    let flags = "--resolution 40,40 --samples 4 --device cpu --view front";
    let outcome = bench.run(&format!("render cube.step -o a.png {flags} --stats")).expect(0);
    assert!(
        outcome.stderr.contains("1600 rays, ") && outcome.stderr.contains(" analytic faces"),
        "{}",
        outcome.stderr
    );
    let rays = &json(&bench.run(&format!("render cube.step -o a.png {flags} --stats --json")).expect(0))["inputs"]
        [0]["rays"];
    let count = |name: &str| rays[name].as_u64().unwrap_or_else(|| panic!("{name} in {rays}"));
    assert_eq!(count("rays"), 1600);
    assert!(count("hit") > 1000 && count("hit") < 1600 && count("nodes") >= count("hit"), "{rays}");
    assert!(count("faces") >= count("hit") && count("faces") < 2 * count("hit"), "{rays}");
    assert_eq!(count("leaves") + count("newton_steps") + count("exact_trim_tests"), 0, "{rays}");
    assert!(
        json(&bench.run(&format!("render cube.step -o a.png {flags} --json")).expect(0))["inputs"][0]
            .get("rays")
            .is_none()
    );
    let outcome =
        bench.run_with("probe cube.step --rays - --stats", "5 4 30 0 0 -1\n50 50 50 1 0 0\n").expect(0);
    assert_eq!(outcome.text().lines().count(), 2);
    assert!(outcome.stderr.contains("2 rays, 50.0 % of them with a hit"), "{}", outcome.stderr);
}
