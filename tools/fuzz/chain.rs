//! What the targets share: invariants of an import, rays through a scene, and a mutation that keeps to the syntax.

use glam::DVec3;
use libfuzzer_sys::fuzzer_mutate;
use trimray::brep::{Model, Severity};
use trimray::render::cpu::{Precision, probe};
use trimray::render::{Ray, bounds};
use trimray::scene::Scene;

/// Holds the invariant of every import: declared faces are imported or in the diagnostics.
pub fn check(model: &Model) {
    let lost: u64 = model.diagnostics.iter().map(|d| u64::from(d.faces)).sum();
    assert_eq!(model.declared_faces as u64, model.faces.len() as u64 + lost, "faces lost silently");
    let reasons_given =
        model.diagnostics.iter().all(|d| d.severity != Severity::Dropped || !d.reason.is_empty());
    assert!(reasons_given, "a finding without a reason");
}

/// Sends a few rays through a scene, in both precisions where it has both.
pub fn trace(scene: &Scene) {
    let around = bounds(scene);
    let (middle, size) = ((around.min + around.max) * 0.5, around.diagonal());
    for direction in [DVec3::X, DVec3::NEG_Z, DVec3::ONE, DVec3::new(0.3, -0.8, 0.1)] {
        let direction = direction.normalize();
        let ray = Ray { origin: middle - direction * size, direction };
        probe(scene, &[ray], Precision::F32, false);
        if scene.has_f64() {
            probe(scene, &[ray], Precision::F64, false);
        }
    }
}

/// A mutation of a text file: three times in four a token (a number, a name, a reference) is replaced by another token of the
/// file or by a hostile one, or a piece between commas is doubled or dropped; else bytes change as they would.
pub fn mutate_text(data: &mut [u8], size: usize, max_size: usize, seed: u32) -> usize {
    const HOSTILE: [&[u8]; 16] = [
        b"1.E300",
        b"-1.E300",
        b"1.E-300",
        b"NAN",
        b"-0.",
        b"0.",
        b"-1.",
        b"1.E9",
        b"99999999999999999999",
        b"-5",
        b"0",
        b"1",
        b"2147483648",
        b"()",
        b"$",
        b"*",
    ];
    let mut random = u64::from(seed).wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1;
    let mut below = |count: usize| {
        random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (random >> 33) as usize % count.max(1)
    };
    let kind = below(8);
    if kind < 2 || size == 0 {
        return fuzzer_mutate(data, size, max_size);
    }
    let text = &data[..size];
    let is_part = |b: &u8| b.is_ascii_alphanumeric() || b"#+-._$*".contains(b);
    let token = |from: usize| {
        let begin = from + text[from..].iter().position(is_part)?;
        let length = text[begin..].iter().position(|b| !is_part(b)).unwrap_or(size - begin);
        Some(begin..begin + length)
    };
    let (place, other) = (below(size), below(size));
    let Some(range) = token(place) else { return fuzzer_mutate(data, size, max_size) };
    let new: Vec<u8> = match kind {
        2..=4 => token(other).map_or(Vec::new(), |range| text[range].to_vec()),
        5 | 6 => HOSTILE[below(HOSTILE.len())].to_vec(),
        _ if below(2) == 0 => Vec::new(),
        _ => [&text[range.clone()], b",", &text[range.clone()]].concat(),
    };
    let changed = [&text[..range.start], &new, &text[range.end..]].concat();
    if changed.len() > max_size {
        return fuzzer_mutate(data, size, max_size);
    }
    data[..changed.len()].copy_from_slice(&changed);
    changed.len()
}
