//! Looks that win over the file's.

use super::{Bench, read};
use std::fs;
use std::path::Path;
use trimray::image::read_png;

const SMALL: &str = "--resolution 90x60 --samples 4 --device cpu --no-ambient-occlusion -q";

/// The mean of the pixels that the model covers, 0 to 255, and what it covers.
fn mean(bench: &Bench, flags: &str) -> ([f64; 3], f64) {
    bench.run(&format!("render {flags} -o a.png --no-background {SMALL}")).expect(0);
    let pixels = read_png(&bench.path("a.png")).expect("a picture").pixels;
    let covered: f64 = pixels.iter().map(|pixel| f64::from(pixel[3]) / 255.0).sum();
    let sum = |k: usize| pixels.iter().map(|p| f64::from(p[k]) * f64::from(p[3]) / 255.0).sum::<f64>();
    ([0, 1, 2].map(|k| sum(k) / covered), covered)
}

#[test]
fn flags_win_over_the_file() {
    let bench = Bench::new();
    let ([r, g, b], covered) = mean(&bench, "cube.step --color #c02010");
    assert!(r > 2.0 * g && g > b, "{r} {g} {b}");
    let (_, seen) = mean(&bench, "cube.step --opacity 0.5");
    assert!(seen < 0.9 * covered && seen > 0.5 * covered, "{seen} of {covered}");
    let picture = |flags: &str| {
        mean(&bench, flags);
        read(&bench.path("a.png"))
    };
    let plain = picture("cube.step");
    assert!(plain == picture("cube.step --roughness 0.45 --metallic 0 --opacity 1"));
    let metal = picture("cube.step --metallic 1");
    assert!(metal != plain && metal != picture("cube.step --metallic 1 --roughness 0.1"));
}

#[test]
fn a_file_of_looks_means_parts() {
    let bench = Bench::new();
    let fixture = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/chain/model.step");
    fs::copy(fixture, bench.path("chain.step")).expect("copied");
    bench.run("bake chain.step").expect(0);
    let written = |text: &str| fs::write(bench.path("looks.toml"), text).expect("written");
    written("['link 2']\ncolor = '#ff0000'\n['pair 2']\ncolor = [0.0, 1.0, 0.0]\n");
    for file in ["chain.step", "chain.trimray"] {
        let all = format!("{file} --color 0,0,1");
        let ([r, g, b], _) = mean(&bench, &all);
        assert!(b > 2.0 * r.max(g), "{r} {g} {b}");
        let ([r, g, b], _) = mean(&bench, &format!("{all} --materials looks.toml"));
        assert!(r.min(g).min(b) > 20.0, "{r} {g} {b}");
        let of_pair = mean(&bench, &format!("{all} --materials looks.toml --only link?2 --only pair?2")).0;
        assert!(of_pair[2] < of_pair[0].min(of_pair[1]), "{of_pair:?}");
    }
}

#[test]
fn faces_have_looks_of_their_own() {
    let bench = Bench::new();
    let top = bench.probe("cube.step", "5 4 30 0 0 -1\n")[0]["hits"][0]["entity"].clone();
    let top = top.as_str().expect("a number").to_owned();
    fs::write(bench.path("looks.toml"), format!("['{top}']\ncolor = '#00ff00'\n")).expect("written");
    let green = |view: &str| {
        let ([r, g, b], _) = mean(&bench, &format!("cube.step --materials looks.toml --view {view}"));
        g > 2.0 * r.max(b)
    };
    assert!(green("top") && !green("bottom"));
}

#[test]
fn nonsense_about_looks_is_refused() {
    let bench = Bench::new();
    for (name, text) in [
        ("shine.toml", "[Cube]\nshine = 1"),
        ("range.toml", "[Cube]\nopacity = 1.5"),
        ("nothing.toml", "[Kube]\nopacity = 0.5"),
        ("broken.toml", "[Cube"),
        ("good.toml", "[Cube]\nopacity = 0.5"),
    ] {
        fs::write(bench.path(name), text).expect("written");
    }
    for (flags, said) in [
        ("--color beige", "#rrggbb"),
        ("--roughness 1.1", "from 0 to 1"),
        ("--metallic -1", "from 0 to 1"),
        ("--opacity nan", "from 0 to 1"),
        ("--materials shine.toml", "`shine`"),
        ("--materials range.toml", "from 0 to 1"),
        ("--materials nothing.toml", "`Cube`"),
        ("--materials broken.toml", "broken.toml"),
        ("--style technical --color 1,0,0", "looks of their own"),
    ] {
        let outcome = bench.run(&format!("render cube.step -o a.png {flags}")).expect(2);
        assert!(outcome.stderr.contains(said), "{flags}: {}", outcome.stderr);
    }
    let missing = bench.run("render cube.step -o a.png --materials missing.toml").expect(1);
    assert!(missing.stderr.contains("missing.toml"), "{}", missing.stderr);
    bench.run(&format!("render cube.step -o a.png --materials good.toml {SMALL}")).expect(0);
}
