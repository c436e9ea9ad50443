//! Lines and styles.

use super::{Bench, read};
use trimray::image::read_png;

const SMALL: &str = "--resolution 120x90 --samples 2 --device cpu --no-ambient-occlusion";

/// Pixels darker and lighter than all of the shaded cube and its background.
fn count(bench: &Bench, name: &str, is: impl Fn([u8; 4]) -> bool) -> usize {
    read_png(&bench.path(name)).expect("a picture").pixels.into_iter().filter(|&pixel| is(pixel)).count()
}

#[test]
fn edges_are_drawn_where_they_are_asked_for() {
    let bench = Bench::new();
    let dark = |name: &str| count(&bench, name, |[r, g, b, _]| r.max(g).max(b) < 40);
    bench.run(&format!("render cube.step -o plain.png {SMALL}")).expect(0);
    bench.run(&format!("render cube.step -o edges.png {SMALL} --edges feature")).expect(0);
    bench.run(&format!("render cube.step -o wide.png {SMALL} --edges feature --edge-width 4")).expect(0);
    assert_eq!(dark("plain.png"), 0);
    assert!(dark("edges.png") > 100 && dark("wide.png") > 2 * dark("edges.png"));
    bench.run(&format!("render cube.step -o red.png {SMALL} --edges all --edge-color #ff0000")).expect(0);
    assert!(count(&bench, "red.png", |[r, g, b, _]| r > 200 && g.max(b) < 60) > 100);
    bench.run(&format!("render cube.step -o dim.png {SMALL} --edges all --hidden-lines dim")).expect(0);
    assert_ne!(read(&bench.path("dim.png")), read(&bench.path("edges.png")));
    for same in ["--edges feature -j 1", "--edges", "-e --edge-width 1.5"] {
        bench.run(&format!("render cube.step -o again.png {SMALL} {same}")).expect(0);
        assert_eq!(read(&bench.path("again.png")), read(&bench.path("edges.png")), "{same}");
    }
}

#[test]
fn a_baked_scene_has_edges_where_the_bake_was_asked_for_them() {
    let bench = Bench::new();
    bench.run("bake cube.step").expect(0);
    let outcome = bench.run(&format!("render cube.trimray -o a.png {SMALL} --edges feature")).expect(2);
    assert!(outcome.stderr.contains("bake --edges"), "{}", outcome.stderr);
    bench.run(&format!("render cube.trimray -o a.png {SMALL}")).expect(0);
    bench.run("bake cube.step --edges").expect(0);
    for name in ["cube.trimray -o a.png", "cube.step -o b.png"] {
        bench.run(&format!("render {name} {SMALL} --edges feature")).expect(0);
    }
    assert_eq!(read(&bench.path("a.png")), read(&bench.path("b.png")));
}

#[test]
fn styles_have_their_own_paper_and_lines() {
    let bench = Bench::new();
    bench.run(&format!("render cube.step -o technical.png {SMALL} --style technical")).expect(0);
    let is_ink = |[r, g, b, _]: [u8; 4]| r.max(g).max(b) < 40;
    assert!(count(&bench, "technical.png", is_ink) > 100);
    assert!(count(&bench, "technical.png", |[r, g, b, _]| r.min(g).min(b) > 220) > 120 * 90 / 2);
    bench.run(&format!("render cube.step -o blue.png {SMALL} --style blueprint")).expect(0);
    assert!(count(&bench, "blue.png", |[r, _, b, _]| b / 2 > r) > 120 * 90 / 2);
    assert!(count(&bench, "blue.png", |[r, g, b, _]| r.min(g).min(b) > 200) > 100);
    bench.run(&format!("render cube.step -o bare.png {SMALL} --style technical --edges none")).expect(0);
    assert_eq!(count(&bench, "bare.png", is_ink), 0);
    bench.run(&format!("render cube.step -o clear.png {SMALL} --style technical --no-background")).expect(0);
    assert!(count(&bench, "clear.png", |pixel| pixel[3] == 0) > 120 * 90 / 10);
}

#[test]
fn exr_files_have_a_layer_of_lines() {
    let bench = Bench::new();
    let has_layer = |name: &str| read(&bench.path(name)).windows(7).any(|bytes| bytes == b"edges.A");
    bench.run(&format!("render cube.step -o a.exr {SMALL}")).expect(0);
    bench.run(&format!("render cube.step -o b.exr {SMALL} --edges feature")).expect(0);
    assert_eq!((has_layer("a.exr"), has_layer("b.exr")), (false, true));
}

#[test]
fn merged_tiles_have_the_lines_of_the_whole() {
    let bench = Bench::new();
    for (extension, flags) in [
        ("png", "--edges feature"),
        ("png", "--edges all --edge-width 9 --hidden-lines dashed"),
        ("png", "--edges all --section z=60% --section x=50% --section-mode corner --hidden-lines dim"),
        ("exr", "--edges feature --section z=60% --hidden-lines dim --layers normal"),
    ] {
        let render = |name: &str, more: &str| {
            let line = format!("render cube.step -o {name}.{extension} {SMALL} {flags} {more}");
            bench.run(&line).expect(0);
        };
        let merged = |tiles: &str| {
            bench.run(&format!("merge {tiles} -o merged.{extension}")).expect(0);
            read(&bench.path(&format!("merged.{extension}")))
        };
        render("whole", "");
        let whole = read(&bench.path(&format!("whole.{extension}")));
        (1..=4).for_each(|tile| render(&format!("tile{tile}"), &format!("--tile {tile}/4")));
        let tiles: Vec<String> = (1..=4).map(|tile| format!("tile{tile}.{extension}")).collect();
        assert!(merged(&tiles.join(" ")) == whole, "{flags}");
        for (name, part) in [("a", "0,0.43,0,0.5"), ("b", "0.43,1,0,0.5"), ("c", "0,1,0.5,1")] {
            render(name, &format!("--cropwindow {part}"));
        }
        assert!(merged(&format!("a.{extension} b.{extension} c.{extension}")) == whole, "{flags}");
    }
}

#[test]
fn nonsense_about_lines_is_refused() {
    let bench = Bench::new();
    for (flags, said) in [
        ("--edges some", "feature"),
        ("--edges feature --edge-width 0", "0.1 to 64"),
        ("--edges feature --edge-width nan", "0.1 to 64"),
        ("--edges feature --edge-color blue", "#rrggbb"),
        ("--edge-width 2", "--edges"),
        ("--hidden-lines dim", "--edges"),
        ("--edges none --no-silhouettes", "--edges"),
        ("--style cubist", "technical"),
    ] {
        let outcome = bench.run(&format!("render cube.step -o a.png {flags}")).expect(2);
        assert!(outcome.stderr.contains(said), "{flags}: {}", outcome.stderr);
    }
}
