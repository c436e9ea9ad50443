//! Work that a device holds finds what the same work finds on its way there and back.

use super::{chords, gpu, synthetic};
use trimray::render::gpu::TrimQuery;
use trimray::render::{Coherence, Exactness};
use trimray::scene::TRIM_INSIDE;

#[test]
fn held_work_finds_what_other_work_finds() {
    let Some(gpu) = gpu() else { return };
    let buffers = synthetic::every_kind();
    let scene = buffers.scene();
    let on_gpu = gpu.upload(&scene).unwrap();

    let mut rays = chords(&scene, 3_000);
    let expected =
        gpu.probe(&on_gpu, &rays, true).unwrap().iter().filter(|hits| !hits.is_empty()).count() as u64;
    // Those that pass by stay behind.
    let beside = rays[0].origin * 1e3;
    rays.push(trimray::render::Ray { origin: beside, direction: beside.any_orthogonal_vector() });
    let found = [Coherence::Coherent, Coherence::Incoherent].map(|coherence| {
        let held = gpu.hold_rays(&on_gpu, &rays, Exactness::default(), coherence).unwrap();
        gpu.run_held(&on_gpu, &held, 2).unwrap();
        let found = gpu.count_held(&held).unwrap();
        eprintln!("{}: {found} of {} {coherence:?} rays hit, {expected} others", gpu.name(), held.count());
        assert_eq!(held.count(), 3_000);
        // What is not certain to be a hit is looked at again on the way back, and a software device gives up on some.
        assert!(expected > 100 && found.abs_diff(expected) <= expected / 50, "{found} {expected}");
        gpu.held_answers(&held).unwrap()
    });
    // Shared out or not, a ray finds what it finds, but for a device that gives up, and for compilers that round otherwise.
    let both = found[0].iter().zip(&found[1]).filter(|&(&one, &other)| one != 0 && other != 0);
    let (same, differ): (Vec<_>, Vec<_>) = both.partition(|(one, other)| one == other);
    eprintln!("{} answers of both are the same, {} differ", same.len(), differ.len());
    assert!(same.len() > 2_900 && differ.len() <= 3, "{} {differ:?}", same.len());

    let roots: Vec<u32> =
        scene.faces.iter().map(|face| face.trim_root).filter(|&root| root != TRIM_INSIDE).collect();
    let at = |index: u32| TrimQuery {
        uv: [(index % 61) as f32 / 61.0, (index % 47) as f32 / 47.0],
        root: roots[index as usize % roots.len()],
        reserved: 0,
    };
    let queries: Vec<TrimQuery> = (0..2_000).map(at).collect();
    let expected =
        gpu.trim_inside(&on_gpu, &queries).unwrap().into_iter().filter(|&inside| inside).count() as u64;
    let held = gpu.hold_queries(&on_gpu, &queries).unwrap();
    gpu.run_held(&on_gpu, &held, 2).unwrap();
    assert!(expected > 0 && expected < held.count());
    assert_eq!((gpu.count_held(&held).unwrap(), held.count()), (expected, 2_000));
}
