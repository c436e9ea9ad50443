//! Broken files: none may make import, bake or tracing panic or run without end.
//!
//! STEP files of the fixtures are damaged at random, with fixed seeds: bytes flipped, the end cut off, numbers made huge, negative or senseless, list
//! entries doubled or dropped, references pointed elsewhere. What still reads is baked, and five rays are traced through it.
//! `TRIMRAY_MUTATIONS` sets how many files are broken, `TRIMRAY_MUTATION_FILES` (paths, one a line) which files are, and
//! `TRIMRAY_MUTATION_SEED` the first seed, for long runs by hand.

use glam::DVec3;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;
use trimray::bake::{BakeOptions, bake};
use trimray::render::Ray;
use trimray::render::cpu::{Precision, probe};

/// Broken files of an ordinary run.
const MUTATIONS: u64 = 200;

/// No small file takes nearly as long, on any machine: what does, hangs.
const PATIENCE: Duration = Duration::from_secs(60);

/// What numbers and references are replaced by.
const NUMBERS: [&str; 16] = [
    "1.E300",
    "-1.E300",
    "1.E-300",
    "NAN",
    "-0.",
    "0.",
    "-1.",
    "1.E9",
    "99999999999999999999",
    "-5",
    "0",
    "1",
    "2147483648",
    "1.E",
    "$",
    "*",
];

/// A linear congruential generator.
struct Random(u64);

impl Random {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % count.max(1)
    }
}

fn variable(name: &str) -> Option<u64> {
    std::env::var(name).ok()?.parse().ok()
}

/// Files to break: the smaller fixtures, unless told otherwise.
fn originals() -> Vec<(PathBuf, Vec<u8>)> {
    let paths: Vec<PathBuf> = match std::env::var("TRIMRAY_MUTATION_FILES") {
        Ok(list) => list.lines().map(PathBuf::from).collect(),
        Err(_) => ["chain", "die", "spinning-top", "duct", "elbow"]
            .iter()
            .map(|name| Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name).join("model.step"))
            .collect(),
    };
    let read = |path: PathBuf| {
        let bytes = fs::read(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        (path, bytes)
    };
    paths.into_iter().map(read).collect()
}

/// The stretches of `bytes` that `holds` is true of, entry by entry: numbers, names.
fn tokens(
    bytes: &[u8],
    from: usize,
    starts: impl Fn(u8) -> bool,
    goes_on: impl Fn(u8) -> bool,
) -> Option<[usize; 2]> {
    let begin = from + bytes[from..].iter().position(|&b| starts(b))?;
    let length = bytes[begin + 1..].iter().position(|&b| !goes_on(b))?;
    Some([begin, begin + 1 + length])
}

/// Damages `bytes` once.
fn damage(bytes: &mut Vec<u8>, random: &mut Random) {
    let data = bytes.windows(5).position(|w| w == b"DATA;").unwrap_or(0);
    let place = data + random.below(bytes.len() - data);
    let number = |b: u8| b.is_ascii_digit() || b"+-.E".contains(&b);
    let reference = |from: usize| tokens(bytes, from, |b| b == b'#', |b| b.is_ascii_digit());
    match random.below(10) {
        0 => bytes[place] = random.below(256) as u8,
        1 => bytes[place] ^= 1 << random.below(8),
        2 => bytes.truncate(place),
        3..=5 => {
            // A number, in a list or after a comma.
            let Some([comma, _]) = tokens(bytes, place, |b| b == b',' || b == b'(', |_| false) else {
                return;
            };
            let Some([begin, end]) = tokens(bytes, comma + 1, number, number) else { return };
            bytes.splice(begin..end, NUMBERS[random.below(NUMBERS.len())].bytes());
        }
        6 => {
            // An entry of a list, doubled or dropped.
            let Some([begin, _]) = tokens(bytes, place, |b| b == b',', |_| false) else { return };
            let Some(length) = bytes[begin + 1..].iter().position(|b| b",)".contains(b)) else { return };
            let entry = bytes[begin..=begin + length].to_vec();
            if random.below(2) == 0 {
                bytes.drain(begin..=begin + length);
            } else {
                (0..1 + random.below(3))
                    .for_each(|_| drop(bytes.splice(begin..begin, entry.iter().copied())));
            }
        }
        7 | 8 => {
            let other = data + random.below(bytes.len() - data);
            let (Some([begin, end]), Some([from, to])) = (reference(place), reference(other)) else { return };
            let name = bytes[from..to].to_vec();
            bytes.splice(begin..end, name);
        }
        _ => {
            // A stretch of the file, moved.
            let length = random.below(200).min(bytes.len() - place);
            let stretch: Vec<u8> = bytes[place..place + length].to_vec();
            let other = data + random.below(bytes.len() - data);
            bytes.splice(other..other, stretch);
        }
    }
}

/// How far a broken file came.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Outcome {
    NotRead,
    Empty,
    Traced,
}

fn whole_chain(bytes: &[u8]) -> Outcome {
    let Ok(model) = trimray::step::read(bytes) else { return Outcome::NotRead };
    let baked = bake(&model, &BakeOptions { keep_f64: true, ..BakeOptions::default() }, &|_, _| {});
    let scene = baked.scene();
    trimray::scene::validate(&scene).expect("a baked scene is valid");
    if scene.faces.is_empty() {
        return Outcome::Empty;
    }
    let around = trimray::render::bounds(&scene);
    let (middle, size) = ((around.min + around.max) * 0.5, around.diagonal());
    for direction in [DVec3::X, DVec3::Y, DVec3::NEG_Z, DVec3::ONE, DVec3::new(0.3, -0.8, 0.1)] {
        let direction = direction.normalize();
        let ray = Ray { origin: middle - direction * size, direction };
        for precision in [Precision::F32, Precision::F64] {
            probe(&scene, &[ray], precision, false);
        }
    }
    Outcome::Traced
}

#[test]
fn broken_files_break_nothing() {
    let originals = originals();
    let count = variable("TRIMRAY_MUTATIONS").unwrap_or(MUTATIONS);
    let first = variable("TRIMRAY_MUTATION_SEED").unwrap_or(1);
    let mut outcomes = [0; 3];
    let mut failures = Vec::new();
    for seed in first..first + count {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        let (path, original) = &originals[random.below(originals.len())];
        let mut bytes = original.clone();
        for _ in 0..1 + random.below(4) {
            damage(&mut bytes, &mut random);
        }
        let (sender, receiver) = channel();
        std::thread::spawn(move || {
            // A test that gave up waiting no longer listens.
            let _ = sender.send(catch_unwind(AssertUnwindSafe(|| whole_chain(&bytes))));
        });
        match receiver.recv_timeout(PATIENCE) {
            Ok(Ok(outcome)) => outcomes[outcome as usize] += 1,
            Ok(Err(_)) => failures.push(format!("{} broken with seed {seed} panics", path.display())),
            Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => {
                failures.push(format!("{} broken with seed {seed} does not end", path.display()));
            }
        }
    }
    let [not_read, empty, traced] = outcomes;
    eprintln!("{count} broken files: {traced} traced, {empty} without faces, {not_read} not read");
    assert!(failures.is_empty(), "{failures:#?}");
    assert!(traced * 4 > count, "hardly any file is still read");
}
