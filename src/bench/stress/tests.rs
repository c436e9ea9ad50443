//! A small part of the stress in every run of the tests, and that it would notice.

use super::*;

const RAYS: u64 = 200;

#[test]
fn nothing_is_missed() {
    for case in cases() {
        let clock = std::time::Instant::now();
        let scene = case.scene();
        for precision in [Precision::F32, Precision::F64] {
            for kind in [RayKind::Made, RayKind::Chords] {
                let found = scene.measure(kind, precision, 0, RAYS);
                eprintln!("{} {precision:?} {kind:?}: {found:?} {:?}", case.name, clock.elapsed());
            }
        }
    }
}
