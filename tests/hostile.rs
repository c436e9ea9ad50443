//! Broken files: none may make import, bake or tracing panic or run without end.
//!
//! STEP and IGES files of the fixtures are damaged at random, with fixed seeds: bytes flipped, the end cut off, numbers made huge, negative or senseless,
//! list entries doubled or dropped, references pointed elsewhere. What still reads is baked, and five rays are traced through it. Cache files are damaged
//! too: they are refused, or rays through them end. `tools/mutate` does the same with the program and with limits of time and memory.
//! `TRIMRAY_MUTATIONS` sets how many files are broken, `TRIMRAY_MUTATION_FILES` (paths, one a line) which files are, and
//! `TRIMRAY_MUTATION_SEED` the first seed, for long runs by hand.

use glam::DVec3;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;
use trimray::bake::{BakeOptions, bake};
use trimray::cache::{CacheFile, Provenance};
use trimray::render::Ray;
use trimray::render::cpu::{Precision, probe};
use trimray::scene::Scene;

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
        Err(_) => [
            "chain/model.step",
            "spinning-top/model.igs",
            "die/model.step",
            "duct/model.igs",
            "spinning-top/model.step",
            "pawn/model.igs",
            "elbow/model.step",
        ]
        .iter()
        .map(|name| Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name))
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
    let model = match trimray::step::read(bytes) {
        Ok(model) => model,
        Err(_) => match trimray::iges::read(bytes) {
            Ok(model) => model,
            Err(_) => return Outcome::NotRead,
        },
    };
    let lost: u64 = model.diagnostics.iter().map(|d| u64::from(d.faces)).sum();
    assert_eq!(model.declared_faces as u64, model.faces.len() as u64 + lost, "faces lost silently");
    let baked = bake(&model, &BakeOptions { keep_f64: true, ..BakeOptions::default() }, &|_, _| {});
    let scene = baked.scene();
    trimray::scene::validate(&scene).expect("a baked scene is valid");
    if scene.faces.is_empty() {
        return Outcome::Empty;
    }
    trace(&scene);
    Outcome::Traced
}

fn trace(scene: &Scene) {
    let around = trimray::render::bounds(scene);
    let (middle, size) = ((around.min + around.max) * 0.5, around.diagonal());
    for direction in [DVec3::X, DVec3::Y, DVec3::NEG_Z, DVec3::ONE, DVec3::new(0.3, -0.8, 0.1)] {
        let direction = direction.normalize();
        let ray = Ray { origin: middle - direction * size, direction };
        probe(scene, &[ray], Precision::F32, false);
        if scene.has_f64() {
            probe(scene, &[ray], Precision::F64, false);
        }
    }
}

/// What `work` gives; why not, where it panics or does not end.
fn ending<T: Send + 'static>(work: impl FnOnce() -> T + Send + 'static) -> Result<T, &'static str> {
    let (sender, receiver) = channel();
    std::thread::spawn(move || {
        // A test that gave up waiting no longer listens.
        let _ = sender.send(catch_unwind(AssertUnwindSafe(work)));
    });
    match receiver.recv_timeout(PATIENCE) {
        Ok(Ok(result)) => Ok(result),
        Ok(Err(_)) => Err("panics"),
        Err(RecvTimeoutError::Timeout | RecvTimeoutError::Disconnected) => Err("does not end"),
    }
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
        match ending(move || whole_chain(&bytes)) {
            Ok(outcome) => outcomes[outcome as usize] += 1,
            Err(what) => failures.push(format!("{} broken with seed {seed} {what}", path.display())),
        }
    }
    let [not_read, empty, traced] = outcomes;
    eprintln!("{count} broken files: {traced} traced, {empty} without faces, {not_read} not read");
    assert!(failures.is_empty(), "{failures:#?}");
    assert!(traced * 4 > count, "hardly any file is still read");
}

/// The bytes of cache files: of a fixture with trims and nets, with f64 geometry and without.
fn cache_files() -> [Vec<u8>; 2] {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/duct/model.step");
    let model = trimray::step::read(&fs::read(path).expect("a fixture")).expect("a model");
    let folder = tempfile::tempdir().expect("a folder");
    [false, true].map(|keep_f64| {
        let baked = bake(&model, &BakeOptions { keep_f64, ..BakeOptions::default() }, &|_, _| {});
        let path = folder.path().join("a.trimray");
        trimray::cache::write(&path, &baked.scene(), &Provenance::default()).expect("written");
        fs::read(path).expect("read")
    })
}

/// Damages a cache file, and makes its size and the check of its table right again, as a hostile writer would.
fn damage_cache(bytes: &mut Vec<u8>, random: &mut Random) {
    const WORDS: [u32; 8] = [0, 1, u32::MAX, 1 << 31, 0x7f80_0000, 0x7fc0_0000, 0x3f80_0000, 0xffff];
    let table_end = |bytes: &[u8]| {
        let sections = u32::from_le_bytes(bytes[72..76].try_into().expect("four bytes")) as usize;
        (88 + 24 * sections.min(1000)).min(bytes.len())
    };
    // Sections are mostly padding, so half of all damage goes where something is.
    let mut place = random.below(bytes.len());
    while bytes[place] == 0 && random.below(50) > 0 {
        place = random.below(bytes.len());
    }
    if random.below(4) == 0 {
        place = random.below(table_end(bytes));
    }
    match random.below(8) {
        0..=2 => bytes[place] ^= 1 << random.below(8),
        3 => bytes[place] = random.below(256) as u8,
        4..=6 if bytes.len() > place / 4 * 4 + 4 => {
            let word = WORDS[random.below(WORDS.len())];
            bytes[place / 4 * 4..][..4].copy_from_slice(&word.to_le_bytes());
        }
        _ if place >= 88 => bytes.truncate(place),
        _ => {}
    }
    let size = bytes.len() as u64;
    bytes[64..72].copy_from_slice(&size.to_le_bytes());
    let check = blake3::hash(&bytes[88..table_end(bytes)]);
    bytes[80..88].copy_from_slice(&check.as_bytes()[..8]);
}

#[test]
fn broken_cache_files_are_refused_or_safe() {
    let originals = cache_files();
    let count = 3 * variable("TRIMRAY_MUTATIONS").unwrap_or(MUTATIONS);
    let first = variable("TRIMRAY_MUTATION_SEED").unwrap_or(1);
    let (mut traced, mut failures) = (0, Vec::new());
    for seed in first..first + count {
        let mut random = Random(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15));
        let mut bytes = originals[random.below(2)].clone();
        for _ in 0..1 + random.below(3) {
            damage_cache(&mut bytes, &mut random);
        }
        let opened = ending(move || CacheFile::from_bytes(&bytes).map(|file| trace(&file.scene())).is_ok());
        match opened {
            Ok(is_open) => traced += u64::from(is_open),
            Err(what) => failures.push(format!("a cache file broken with seed {seed} {what}")),
        }
    }
    eprintln!("{count} broken cache files: {traced} traced, {} refused", count - traced);
    assert!(failures.is_empty(), "{failures:#?}");
    assert!(traced * 10 > count && traced < count, "{traced} of {count} are traced");
}
