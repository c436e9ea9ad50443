//! The last digits of a file are no information: a model whose points (not its directions and radii) are off by some roundings is the same model, with every face,
//! and rays meet it where they met it. What is decided by equality of coordinates, or by a sign near 0, shows here.

mod baked;

use baked::{baked, fixtures};
use trimray::bench::chord;
use trimray::brep::Model;
use trimray::render::cpu::{Precision, probe};
use trimray::render::{Hit, Ray};

/// Millimetres: thousands of roundings of f64, and nothing to a tolerance of any kernel.
const NOISE: f64 = 1e-10;

/// Rays at each fixture.
const RAYS: u64 = 400;

/// Hits may move by this share of the model's size: the noise, over the cosine of a grazing ray.
const TOLERANCE: f64 = 1e-8;

/// Numbers in −1..1.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }
}

/// A file's text with the coordinates of its points moved, and how many.
fn shaken(text: &str, random: &mut Random) -> (String, usize) {
    let mut points = text.split("CARTESIAN_POINT");
    let mut out = points.next().unwrap_or_default().to_owned();
    let mut moved = 0;
    for point in points {
        // `('name', (x, y, z))…`; a name has neither quotes nor brackets.
        let (name, rest) = point[1..].split_once('(').expect("a list of coordinates");
        let (coordinates, rest) = rest.split_once(')').expect("its end");
        let shake = |number: &str| {
            let value: f64 = number.trim().parse().unwrap_or_else(|_| panic!("{number:?} in {point:.100}"));
            moved += 1;
            format!("{:E}", value + NOISE * random.next())
        };
        let coordinates: Vec<String> = coordinates.split(',').map(shake).collect();
        out += &format!("CARTESIAN_POINT({name}({}){rest}", coordinates.join(","));
    }
    (out, moved)
}

#[test]
fn the_last_digits_change_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut random = Random(1);
    let (mut count, mut moved, mut hits, mut wrong) = (0, 0, 0, Vec::new());
    for path in fixtures() {
        let text = std::fs::read_to_string(&path).expect("text");
        let (text, numbers) = shaken(&text, &mut random);
        let other_path = folder.path().join("shaken.step");
        std::fs::write(&other_path, text).expect("a file");
        let ((model, own), (other_model, other)) = (baked(&path), baked(&other_path));
        let findings = |model: &Model| model.diagnostics.iter().map(|d| d.reason.clone()).collect::<Vec<_>>();
        assert_eq!(findings(&other_model), findings(&model), "{}", path.display());
        assert_eq!(other.face_infos.len(), own.face_infos.len(), "{}", path.display());
        let (own, other) = (own.scene(), other.scene());
        let rays: Vec<Ray> = (0..RAYS).map(|index| chord(&own, index)).collect();
        let size = own.header.half_size.iter().map(|&x| f64::from(x)).fold(0.0, f64::max);
        // Faces of parts that touch are met in any order.
        let is_same = |a: &Hit, b: &Hit| {
            a.face == b.face && (a.t - b.t).abs() <= TOLERANCE * size && a.normal.dot(b.normal) > 1.0 - 1e-6
        };
        let found = [&own, &other].map(|scene| probe(scene, &rays, Precision::F64, false));
        for ((ray, a), b) in rays.iter().zip(&found[0]).zip(&found[1]) {
            hits += a.len();
            if a.len() != b.len() || !a.iter().all(|a| b.iter().any(|b| is_same(a, b))) {
                wrong.push(format!("{}: {ray:?}\n{a:?}\n{b:?}", path.display()));
            }
        }
        count += 1;
        moved += numbers;
    }
    eprintln!("{count} fixtures, {moved} coordinates moved, {hits} hits, {} rays changed", wrong.len());
    assert!(count >= 20 && moved > 10_000 && hits > 5000, "{count} {moved} {hits}");
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}
