//! Path tracing, maps of light, tones.

use super::{Bench, read};
use std::fs;
use trimray::image::read_png;

const SMALL: &str = "--resolution 72x54 --device cpu -q";

fn pixels(bench: &Bench, flags: &str) -> Vec<[u8; 4]> {
    bench.run(&format!("render cube.step -o a.png {SMALL} {flags}")).expect(0);
    read_png(&bench.path("a.png")).expect("a picture").pixels
}

fn picture(bench: &Bench, flags: &str) -> Vec<u8> {
    pixels(bench, flags);
    read(&bench.path("a.png"))
}

/// A Radiance file of 16 by 8 pixels, dark but for `bright` ones (column, row).
fn map(bench: &Bench, name: &str, bright: &[(usize, usize)]) {
    let mut bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 8 +X 16\n".to_vec();
    for row in 0..8 {
        for column in 0..16 {
            let is_bright = bright.contains(&(column, row));
            bytes.extend(if is_bright { [128, 128, 128, 135] } else { [128, 128, 128, 125] });
        }
    }
    fs::write(bench.path(name), bytes).expect("written");
}

#[test]
fn a_picture_depends_on_its_seed_alone() {
    let bench = Bench::new();
    let flags = "--path-trace --spp 8 --ground";
    let one = picture(&bench, flags);
    assert!(one == picture(&bench, &format!("{flags} --seed 0 -j 1")));
    assert!(one == picture(&bench, "--raytracing --raytracing-samples 8 --ground --max-depth 6"));
    assert!(one != picture(&bench, &format!("{flags} --seed 1")));
    let open = |depth: u32| picture(&bench, &format!("{flags} --section x=5 --no-caps --max-depth {depth}"));
    assert!(open(1) != open(6));
    assert!(one != picture(&bench, "--path-trace --spp 8"));
}

#[test]
fn tiles_are_parts_of_the_whole_even_where_noise_ends_early() {
    let bench = Bench::new();
    for flags in ["--spp 4", "--spp 64 --noise 0.02"] {
        let flags = format!("{SMALL} --path-trace --ground {flags}");
        bench.run(&format!("render cube.step -o whole.png {flags}")).expect(0);
        for tile in 1..=3 {
            bench.run(&format!("render cube.step -o {tile}.png --tile {tile}/3 {flags}")).expect(0);
        }
        bench.run("merge 1.png 2.png 3.png -o joined.png").expect(0);
        assert!(read(&bench.path("whole.png")) == read(&bench.path("joined.png")), "{flags}");
    }
}

#[test]
fn the_ground_catches_shadows() {
    let bench = Bench::new();
    let covered = |flags: &str| -> f64 {
        let flags = format!("--path-trace --spp 16 --no-background --fit 0.5 {flags}");
        pixels(&bench, &flags).iter().map(|pixel| f64::from(pixel[3]) / 255.0).sum()
    };
    let (alone, on_ground) = (covered(""), covered("--ground"));
    assert!(on_ground > 1.1 * alone && on_ground < 3.0 * alone, "{alone} {on_ground}");
    let shadow = pixels(&bench, "--path-trace --spp 64 --no-background --fit 0.5 --ground");
    let faint = shadow.iter().filter(|pixel| (1..120).contains(&pixel[3]));
    assert!(faint.clone().count() > 100);
    assert!(faint.clone().filter(|pixel| pixel[0] < 40).count() > 100, "shadows are dark");
    // Turned over, the other side is down.
    assert_ne!(
        picture(&bench, "--path-trace --ground --spp 4"),
        picture(&bench, "--path-trace --ground --spp 4 --up -Z")
    );
}

#[test]
fn a_map_lights_from_where_it_is_bright() {
    let bench = Bench::new();
    map(&bench, "right.hdr", &[(12, 3), (12, 4)]);
    let side = |flags: &str| {
        let flags =
            format!("--path-trace --spp 16 --view front --camera-azimuth-angle 45 --hdri right.hdr {flags}");
        let pixels = pixels(&bench, &flags);
        let sum = |columns: std::ops::Range<usize>| -> u32 {
            let row = &pixels[27 * 72..28 * 72];
            row[columns].iter().map(|pixel| u32::from(pixel[0])).sum()
        };
        (sum(24..34), sum(38..48))
    };
    let (left, right) = side("");
    assert!(right > left + 200, "{left} {right}");
    let (left, right) = side("--hdri-rotation 180");
    assert!(left > right, "{left} {right}");
    let sky = |flags: &str| {
        let flags =
            format!("--path-trace --spp 4 --hdri right.hdr --hdri-background --tone-mapping none {flags}");
        pixels(&bench, &flags)[0]
    };
    assert!(sky("")[0] < 128 && sky("")[3] == 255);
    assert!(sky("--hdri-intensity 4")[0] > sky("")[0]);
}

#[test]
fn an_exr_map_is_a_map_too_and_tones_leave_exr_files_alone() {
    let bench = Bench::new();
    let exr = |name: &str, flags: &str| {
        bench.run(&format!("render cube.step -o {name} {SMALL} --path-trace --spp 4 {flags}")).expect(0);
        read(&bench.path(name))
    };
    let plain = exr("a.exr", "");
    assert!(plain == exr("b.exr", "--tone-mapping agx --exposure 2"));
    assert!(plain != exr("c.exr", "--hdri a.exr"));
    let shown = |flags: &str| picture(&bench, &format!("--path-trace --spp 4 {flags}"));
    let as_it_is = shown("");
    assert!(as_it_is == shown("--tone-mapping none"));
    for other in ["--tone-mapping agx", "--tone-mapping neutral", "--exposure -1"] {
        assert!(as_it_is != shown(other), "{other}");
    }
    assert!(shown("--hdri a.exr") == shown("--hdri a.exr --tone-mapping neutral"));
    let default = picture(&bench, "");
    assert!(default == picture(&bench, "--tone-mapping none --exposure 0"));
    assert!(default != picture(&bench, "--tone-mapping agx"));
    // The background is a screen's light already.
    for flags in ["", "--tone-mapping agx", "--exposure -2"] {
        assert_eq!(pixels(&bench, flags)[0], [255; 4], "{flags}");
    }
}

#[test]
fn sections_selections_and_lines_go_with_paths() {
    let bench = Bench::new();
    let base = "--path-trace --spp 4 --ground";
    let plain = picture(&bench, base);
    for flags in
        ["--section x=5", "--section x=5 --no-caps", "--edges feature", "--opacity 0.4", "--metallic 1"]
    {
        assert!(plain != picture(&bench, &format!("{base} {flags}")), "{flags}");
    }
    let has_layer = |flags: &str| {
        bench.run(&format!("render cube.step -o a.exr {SMALL} {base} {flags}")).expect(0);
        read(&bench.path("a.exr")).windows(7).any(|bytes| bytes == b"depth.Z")
    };
    assert!(has_layer("") && !has_layer("--layers none"));
}

#[test]
fn nonsense_about_light_is_refused() {
    let bench = Bench::new();
    map(&bench, "map.hdr", &[]);
    for (flags, said) in [
        ("--spp 4", "--path-trace"),
        ("--ground", "--path-trace"),
        ("--hdri map.hdr", "--path-trace"),
        ("--path-trace --spp 0", "1.."),
        ("--path-trace --max-depth 65", "1..=64"),
        ("--path-trace --seed -1", "-1"),
        ("--path-trace --noise 0", "0.00001 to 1"),
        ("--path-trace --noise nan", "0.00001 to 1"),
        ("--path-trace --samples 4", "--samples"),
        ("--path-trace --hdri-rotation 10", "--hdri"),
        ("--path-trace --hdri-intensity -1", "0 to 1000000"),
        ("--path-trace --hdri map.hdr --hdri-background --no-background", "--no-background"),
        ("--path-trace --style technical", "light of their own"),
        ("--tone-mapping filmic", "agx"),
        ("--exposure 21", "-20 to 20"),
    ] {
        let outcome = bench.run(&format!("render cube.step -o a.png {flags}")).expect(2);
        assert!(outcome.stderr.contains(said), "{flags}: {}", outcome.stderr);
    }
    fs::write(bench.path("text.hdr"), "this is no map").expect("written");
    for name in ["text.hdr", "missing.exr", "cube.step"] {
        let outcome = bench.run(&format!("render cube.step -o a.png --path-trace --hdri {name}")).expect(1);
        assert!(outcome.stderr.contains(name), "{}", outcome.stderr);
    }
}
