//! Scenes that are kept from one run to the next.

use super::Bench;
use std::fs;

/// The names of what is kept.
fn kept(bench: &Bench) -> Vec<String> {
    let Ok(entries) = fs::read_dir(bench.path("kept")) else { return Vec::new() };
    entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect()
}

fn render(bench: &Bench, flags: &str) -> (Vec<u8>, String) {
    let arguments =
        format!("render -v cube.step -o a.png --resolution 40,30 --samples 2 --device cpu {flags}");
    let outcome = bench.run(&arguments).expect(0);
    (fs::read(bench.path("a.png")).expect("a picture"), outcome.stderr)
}

#[test]
fn a_kept_scene_gives_the_same_picture_and_is_not_baked_again() {
    let bench = Bench::new();
    let (expected, told) = render(&bench, "--no-cache");
    assert!(told.contains("baked in") && kept(&bench).is_empty(), "{told}");
    let (first, told) = render(&bench, "--cache-dir kept");
    assert!(told.contains("baked in"), "{told}");
    assert_eq!(kept(&bench).len(), 1);
    let (second, told) = render(&bench, "--cache-dir kept");
    assert!(told.contains("baked before") && !told.contains("baked in"), "{told}");
    assert!(first == expected && second == expected);
    assert_eq!(kept(&bench).len(), 1);
}

#[test]
fn other_options_and_other_contents_are_other_scenes() {
    let bench = Bench::new();
    render(&bench, "--cache-dir kept");
    render(&bench, "--cache-dir kept --edges feature");
    assert_eq!(kept(&bench).len(), 2);
    fs::write(bench.path("cube.step"), super::cube(11.0, "mm")).expect("written");
    let (_, told) = render(&bench, "--cache-dir kept");
    assert!(told.contains("baked in"), "{told}");
    assert_eq!(kept(&bench).len(), 3);
}

#[test]
fn a_damaged_scene_is_baked_again() {
    let bench = Bench::new();
    let (expected, _) = render(&bench, "--cache-dir kept");
    let path = bench.path("kept").join(&kept(&bench)[0]);
    let bytes = fs::read(&path).expect("kept");
    fs::write(&path, &bytes[..bytes.len() - 9]).expect("cut");
    let (found, told) = render(&bench, "--cache-dir kept");
    assert!(told.contains("baked in") && found == expected, "{told}");
    assert_eq!(fs::read(&path).expect("kept again"), bytes);
}

#[test]
fn a_folder_that_cannot_be_is_told_and_no_error() {
    let bench = Bench::new();
    let (_, told) = render(&bench, "--cache-dir cube.step/kept");
    assert!(told.contains("not kept"), "{told}");
    let outcome = bench.run("render cube.step -o a.png --cache-dir kept --no-cache").expect(2);
    assert!(outcome.stderr.contains("--no-cache"), "{}", outcome.stderr);
}
