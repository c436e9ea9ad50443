//! Sections.

use super::{Bench, read};
use trimray::image::read_png;

const SMALL: &str = "--resolution 120x90 --samples 4 --device cpu --no-ambient-occlusion";

fn picture(bench: &Bench, flags: &str) -> Vec<u8> {
    bench.run(&format!("render cube.step -o a.png {SMALL} {flags}")).expect(0);
    read(&bench.path("a.png"))
}

/// Pixels that show the model, from a camera that does not follow what is left of it.
fn covered(bench: &Bench, flags: &str) -> f64 {
    picture(
        bench,
        &format!(
            "--no-background --camera-orthographic --camera-focal-point 5,5,5 --camera-direction -Z --up +Y {flags}"
        ),
    );
    let pixels = read_png(&bench.path("a.png")).expect("a picture").pixels;
    pixels.iter().map(|pixel| f64::from(pixel[3]) / 255.0).sum()
}

#[test]
fn a_plane_leaves_one_side_and_closes_it() {
    let bench = Bench::new();
    let whole = picture(&bench, "");
    let low = picture(&bench, "--section z=5mm");
    assert!(low != whole && low != picture(&bench, "--section -z=5"));
    assert_ne!(low, picture(&bench, "--section z=5 --no-caps"));
    for same in ["--section z=50%", "--section z=0.5cm", "--section 0,0,3@5", "--section z=5 -j 1"] {
        assert_eq!(low, picture(&bench, same), "{same}");
    }
    assert_eq!(whole, picture(&bench, "--section z=5 --section-exclude Cube"));
    assert_eq!(whole, picture(&bench, "--section x=11"));
    let all = covered(&bench, "");
    let share = |flags: &str| covered(&bench, flags) / all;
    for (flags, expected) in
        [("--section x=25%", 0.25), ("--section -x=25%", 0.75), ("--section x=50% --section y=50%", 0.25)]
    {
        let found = share(flags);
        assert!((found - expected).abs() < 0.03, "{flags}: {found}");
    }
    assert_eq!(covered(&bench, "--section x=-1"), 0.0);
}

#[test]
fn several_planes_cut_out_a_corner() {
    let bench = Bench::new();
    let all = covered(&bench, "");
    let corner = |planes: &str| {
        let sections: String = planes.split_whitespace().map(|plane| format!("--section {plane} ")).collect();
        covered(&bench, &format!("{sections} --section-mode corner")) / all
    };
    for (planes, expected) in [
        ("x=50% y=50%", 0.75),
        ("x=20% y=50%", 0.6),
        ("x=40% -x=50%", 0.9),
        // A whole edge is gone, but not for who looks from above.
        ("x=50% z=50%", 1.0),
        ("x=25%", 0.25),
    ] {
        let found = corner(planes);
        assert!((found - expected).abs() < 0.03, "{planes}: {found}");
    }
    let two = "--section x=50% --section z=50%";
    assert_eq!(picture(&bench, two), picture(&bench, &format!("{two} --section-mode each")));
    assert_ne!(picture(&bench, two), picture(&bench, &format!("{two} --section-mode corner")));
}

#[test]
fn who_cuts_everything_away_is_told() {
    let bench = Bench::new();
    let told = |flags: &str| {
        let outcome = bench.run(&format!("render cube.step -o a.png {SMALL} {flags}")).expect(0);
        outcome
            .stderr
            .contains("keeps nothing of it: it is from (0.000, 0.000, 0.000) to (10.000, 10.000, 10.000) mm")
    };
    for flags in ["--section x=-1", "--section x=5 --section -y=11", "--section x=-1 --section-mode corner"] {
        assert!(told(flags), "{flags}");
    }
    for flags in [
        "--section x=1",
        "--section x=-1 -q",
        "--section x=-1 --section-exclude Cube",
        "--section x=-1 --section y=5 --section-mode corner",
    ] {
        assert!(!told(flags), "{flags}");
    }
}

#[test]
fn caps_have_lines_around_them() {
    let bench = Bench::new();
    let dark = |flags: &str| {
        picture(&bench, &format!("--section z=5 --edges feature {flags}"));
        let pixels = read_png(&bench.path("a.png")).expect("a picture").pixels;
        pixels.iter().filter(|[r, g, b, _]| r.max(g).max(b) < &40).count()
    };
    // Two of the cap's four sides are before its own body: nothing but the cap ends there.
    assert!(dark("") > dark("--no-silhouettes") + 60);
}

#[test]
fn nonsense_about_sections_is_refused() {
    let bench = Bench::new();
    for (flags, said) in [
        ("--section w=3", "x=10mm"),
        ("--section x=3ft", "x=10mm"),
        ("--section 0,0,0@3", "x=10mm"),
        ("--no-caps", "--section"),
        ("--section-exclude Cube", "--section"),
        ("--section-mode corner", "--section"),
        ("--section x=1 --section-mode quarter", "each, corner"),
        ("--section x=1 --section-exclude Bolt*", "Bolt*"),
        (&"--section x=1 ".repeat(7), "6 planes"),
        ("--section x=1 --aov trim-tests", "--aov"),
        ("--style technical --edges none --aov trim-tests", "--aov"),
        ("--style blueprint --aov trim-tests", "--aov"),
        ("--exposure 1 --aov trim-tests", "--aov"),
        ("--tone-mapping agx --aov trim-tests", "--aov"),
        ("--path-trace --aov trim-tests", "--aov"),
    ] {
        let outcome = bench.run(&format!("render cube.step -o a.png {flags}")).expect(2);
        assert!(outcome.stderr.contains(said), "{flags}: {}", outcome.stderr);
    }
}
