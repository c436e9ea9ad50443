//! Views, turns and frames.

use super::{Bench, Outcome};
use trimray::image::{Picture, compare, read_png};

const SMALL: &str = "--resolution 60,40 --samples 2 --device cpu -q";

fn render(bench: &Bench, output: &str, flags: &str) -> Outcome {
    bench.run(&format!("render cube.step -o {output} {SMALL} {flags}"))
}

fn picture(bench: &Bench, flags: &str) -> Picture {
    render(bench, "picture.png", flags).expect(0);
    read_png(&bench.path("picture.png")).expect("a picture")
}

/// Within a few pixels: cameras that come about in different ways differ in their last bits.
fn assert_alike(a: &Picture, b: &Picture) {
    let difference = compare(a, b, 16).expect("one size");
    assert!(difference.outliers < 0.01, "{difference:?}");
}

/// The share of the picture's height, width that is not white.
fn extent(picture: &Picture) -> [f64; 2] {
    let drawn = |x: usize, y: usize| picture.pixels[y * picture.width + x] != [255; 4];
    let columns = (0..picture.width).filter(|&x| (0..picture.height).any(|y| drawn(x, y))).count();
    let rows = (0..picture.height).filter(|&y| (0..picture.width).any(|x| drawn(x, y))).count();
    [columns as f64 / picture.width as f64, rows as f64 / picture.height as f64]
}

#[test]
fn views_are_files_or_cells_of_a_sheet() {
    let bench = Bench::new();
    render(&bench, "{model}-{view}.png", "--view front,iso").expect(0);
    let files =
        ["front", "iso"].map(|view| read_png(&bench.path(&format!("cube-{view}.png"))).expect("a view"));
    render(&bench, "sheet.png", "--view front,iso").expect(0);
    let sheet = read_png(&bench.path("sheet.png")).expect("a sheet");
    assert_eq!((sheet.width, sheet.height), (120, 40));
    for (index, pixel) in sheet.pixels.iter().enumerate() {
        let (x, y) = (index % 120, index / 120);
        assert_eq!(*pixel, files[x / 60].pixels[y * 60 + x % 60]);
    }
    render(&bench, "review.png", "--view review").expect(0);
    let review = read_png(&bench.path("review.png")).expect("a sheet");
    assert_eq!((review.width, review.height), (180, 80));
    render(&bench, "review.exr", "--view review --no-background").expect(0);
}

#[test]
fn labels_name_views_where_they_are_asked_for() {
    let bench = Bench::new();
    let size = "--samples 2 --device cpu -q --resolution 200,120";
    let render = |name: &str, flags: &str| {
        bench.run(&format!("render cube.step -o {name} {size} {flags}")).expect(0);
        read_png(&bench.path(name)).expect("a picture")
    };
    let small = "--view front,iso --fit 0.5";
    let (plain, named) = (render("a.png", small), render("b.png", &format!("{small} --labels")));
    let changed = |from: usize, to: usize| {
        (0..plain.pixels.len())
            .filter(|i| (from..to).contains(&(i % 400)) && plain.pixels[*i] != named.pixels[*i])
            .collect::<Vec<_>>()
    };
    let (front, iso) = (changed(0, 200), changed(200, 400));
    assert!(front.len() > iso.len() && iso.len() > 40, "{} {}", front.len(), iso.len());
    assert!(front.iter().chain(&iso).all(|i| i % 200 < 100 && i / 400 < 24), "in the corner");
    assert!(front.iter().any(|&i| named.pixels[i][..3].iter().all(|&code| code < 60)), "in dark ink");
    // The model keeps below the words.
    let named = render("b.png", "--view front,iso --labels");
    let above = named.pixels.iter().enumerate().filter(|(i, _)| i / 400 < 22 && i % 200 >= 100);
    assert!(above.clone().count() > 4000 && above.into_iter().all(|(_, pixel)| *pixel == [255; 4]));
    let blue = "--view top --style blueprint --edges none --fit 0.5";
    let (plain, named) = (render("a.png", blue), render("b.png", &format!("{blue} --labels")));
    let differs = |i: &usize| plain.pixels[*i] != named.pixels[*i];
    let written: Vec<usize> = (0..plain.pixels.len()).filter(differs).collect();
    assert!(written.iter().any(|&i| named.pixels[i][..3].iter().all(|&code| code > 200)), "in light ink");
    assert!(bench.run("render cube.step -o a.png --labels").expect(2).stderr.contains("--view"));
}

#[test]
fn the_camera_turns_as_f3d_turns_it() {
    let bench = Bench::new();
    let flat = "--camera-orthographic --no-ambient-occlusion";
    let right = picture(&bench, &format!("--view right {flat}"));
    assert_alike(&picture(&bench, &format!("--view front --camera-azimuth-angle 90 {flat}")), &right);
    assert_alike(
        &picture(&bench, &format!("--camera-direction +Y --camera-azimuth-angle 90 {flat}")),
        &right,
    );
    let top = picture(&bench, "--view top");
    assert_alike(&picture(&bench, "--view front --camera-elevation-angle 90"), &top);
    let by_angle = picture(&bench, "--camera-view-angle 30");
    assert_alike(&picture(&bench, "--camera-focal-length 44.7846"), &by_angle);
    assert_ne!(picture(&bench, "--camera-focal-length 20"), by_angle);
}

#[test]
fn the_model_fills_what_it_is_asked_to() {
    let bench = Bench::new();
    for (fit, share) in [("", 0.95), ("--fit 1", 1.0), ("--fit 0.4", 0.4)] {
        let [_, height] = extent(&picture(&bench, &format!("--view front {fit}")));
        assert!((height - share).abs() < 0.06, "{fit}: {height}");
    }
}

#[test]
fn a_turn_is_an_animation_or_numbered_files() {
    let bench = Bench::new();
    render(&bench, "turn.png", "--frames 4 --frame-rate 10").expect(0);
    let bytes = std::fs::read(bench.path("turn.png")).expect("written");
    let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().expect("a PNG");
    assert_eq!(reader.info().animation_control.expect("animated").num_frames, 4);
    render(&bench, "turn{frame:03}.png", "--frames 4").expect(0);
    let mut shades = Vec::new();
    for frame in 0..4 {
        let file = read_png(&bench.path(&format!("turn{frame:03}.png"))).expect("a frame");
        let mut codes = vec![0; reader.output_buffer_size().expect("small")];
        reader.next_frame(&mut codes).expect("a frame");
        let expected: Vec<u8> = file.pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect();
        assert!(codes == expected, "frame {frame}");
        shades.push(file);
    }
    // A cube looks the same after a quarter turn.
    assert_alike(&shades[0], &shades[1]);
    render(&bench, "eighth{frame}.png", "--frames 8").expect(0);
    let eighth = read_png(&bench.path("eighth1.png")).expect("a frame");
    assert!(compare(&eighth, &shades[0], 16).expect("one size").outliers > 0.05);
}

#[test]
fn wrong_views_are_refused_with_the_right_ones() {
    let bench = Bench::new();
    for (output, flags, words) in [
        ("a.png", "--view sideways", &["sideways", "front", "review"][..]),
        ("a.png", "--view front --camera-direction +X", &["--camera-direction"]),
        ("{view}.png", "", &["--view"]),
        ("{view}.png", "--view top,top", &["several"]),
        ("a.exr", "--frames 3", &["{frame}"]),
        ("a.png", "--frames 0", &["1"]),
        ("a.png", "--fit 1.5", &["0.01", "1"]),
        ("a.png", "--camera-azimuth-angle 700", &["-360", "360"]),
        ("a.png", "--camera-focal-length 0", &["100000"]),
        ("a.png", "--camera-focal-length 50 --camera-view-angle 20", &["--camera-view-angle"]),
        ("a.png", "--view review --resolution 9000,9000", &["sheet"]),
    ] {
        let outcome = bench.run(&format!("render cube.step -o {output} {flags}")).expect(2);
        for word in words {
            assert!(outcome.stderr.contains(word), "{flags}: {}", outcome.stderr);
        }
    }
}
