//! Pictures compared with a reference as they are rendered.

use super::{Bench, json, read};
use serde_json::Value;

const SMALL: &str = "--resolution 60,40 --samples 4 --device cpu";

#[test]
fn a_picture_is_compared_with_its_reference() {
    let bench = Bench::new();
    let render = |flags: &str| bench.run(&format!("render cube.step {SMALL} {flags}"));
    for extension in ["png", "exr"] {
        render(&format!("-o old.{extension}")).expect(0);
        let outcome = render(&format!("-o new.{extension} --reference old.{extension}")).expect(0);
        assert!(
            outcome.stderr.contains("0 of 2400 pixels") && outcome.stdout.is_empty(),
            "{}",
            outcome.stderr
        );
    }
    let turned = "--camera-azimuth-angle 3 --reference old.png";
    let outcome = render(&format!("-o new.png {turned} --reference-heat heat.png")).expect(5);
    assert!(outcome.stderr.contains("old.png and new.png differ"), "{}", outcome.stderr);
    assert_ne!(read(&bench.path("new.png")), read(&bench.path("old.png")), "it is written in any case");
    let heat = trimray::image::read_png(&bench.path("heat.png")).expect("a picture");
    assert!(heat.pixels.contains(&[255, 0, 0, 255]));
    render(&format!("-o new.png {turned} --reference-tolerance 1")).expect(0);
    render(&format!("-o new.png {turned} --reference-max-outliers 1")).expect(0);
    let quiet = render(&format!("-o new.png {turned} --reference-tolerance 1 -q")).expect(0);
    assert_eq!(quiet.stderr, "");
    let shown = render("-o - --reference old.png").expect(0);
    assert!(shown.stdout == read(&bench.path("old.png")));
    let outcome = bench.run("render cube.step --resolution 30,40 -o new.png --reference old.png").expect(5);
    assert!(outcome.stderr.contains("30 by 40"), "{}", outcome.stderr);
    // The earlier picture in the same place.
    render(&format!("-o old.png {turned}")).expect(5);
    render(&format!("-o old.png {turned}")).expect(0);
}

#[test]
fn the_report_tells_what_diff_tells() {
    let bench = Bench::new();
    let render = |flags: &str| bench.run(&format!("render cube.step {SMALL} {flags}"));
    render("-o old.png").expect(0);
    let outcome = render("-o new.png --background-color #ff0000 --reference old.png --json").expect(5);
    let report = json(&outcome);
    let found = &report["inputs"][0]["reference"];
    assert_eq!(
        (&found["a"], &found["within"], &report["exit_code"]),
        (&"old.png".into(), &false.into(), &5.into())
    );
    assert_eq!(report["inputs"][0]["files"][0]["path"], "new.png");
    assert_eq!(found, &json(&bench.run("diff old.png new.png --json").expect(5)));
    let plain = json(&render("-o new.png --json").expect(0));
    assert_eq!(plain["inputs"][0].get("reference"), None::<&Value>);
}

#[test]
fn nonsense_about_references_is_refused() {
    let bench = Bench::new();
    bench.run(&format!("render cube.step -o old.png {SMALL}")).expect(0);
    for (flags, said) in [
        ("-o a.png --reference old.exr", "one format"),
        ("-o a.exr --reference old.png", "one format"),
        ("-o a.png --reference old.jpg", ".png nor .exr"),
        ("-o a.png --reference-tolerance 0.1", "--reference"),
        ("-o a.png --reference old.png --reference-tolerance nan", "not negative"),
        ("-o a.png --reference old.png --reference-max-outliers 2", "from 0 to 1"),
        ("-o a.png --reference old.png --reference-heat heat.exr", ".png"),
        ("-o {view}.png --view top,front --reference old.png", "one picture, and 2"),
        ("cube.step -o {model}.png --reference old.png", "{model}"),
        ("-o a.png --frames 3 --reference old.png", "--frames"),
    ] {
        let outcome = bench.run(&format!("render cube.step {flags}")).expect(2);
        assert!(outcome.stderr.contains(said), "{flags}: {}", outcome.stderr);
    }
    bench.run("render cube.step -o a.png --reference missing.png").expect(1);
    assert!(!bench.path("a.png").exists(), "it is missed before anything is rendered");
}
