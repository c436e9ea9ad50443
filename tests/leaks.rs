//! No ray slips between the faces of a closed solid: each sees an even number of walls, in f32 and in f64, also where it is aimed at edges.
//!
//! The GPU's share is in tests/equivalence.

mod baked;

use baked::{baked, fixtures};
use trimray::bench::{aimed, count_aimed_leaks, count_uniform_leaks, edge_points, is_closed};
use trimray::brep::Model;
use trimray::render::Ray;
use trimray::render::cpu::{Precision, probe};
use trimray::scene::SceneBuffers;

/// Rays of each kind, fixture and precision.
const RAYS: u64 = 20_000;

#[test]
fn closed_fixtures_do_not_leak() {
    let (mut closed, mut rays, mut repeated, mut beside, mut odd) = (0, 0, 0, 0, Vec::new());
    for path in fixtures() {
        let (model, buffers) = baked(&path);
        let scene = buffers.scene();
        if !is_closed(&model, &scene) {
            continue;
        }
        closed += 1;
        let points = edge_points(&model);
        for precision in [Precision::F32, Precision::F64] {
            let uniform = count_uniform_leaks(&scene, precision, 0, RAYS, 1);
            let aimed = count_aimed_leaks(&scene, precision, &points, 0, RAYS, 1);
            for leaks in [uniform, aimed] {
                rays += leaks.rays;
                repeated += leaks.repeated;
                beside += leaks.beside;
                odd.extend(
                    leaks.shown.iter().map(|ray| format!("{}, {precision:?}: {ray:?}", path.display())),
                );
            }
        }
    }
    eprintln!(
        "{closed} closed fixtures, {rays} rays, {} odd, {repeated} with a place twice, {beside} by others",
        odd.len()
    );
    assert!(closed >= 20, "only {closed} fixtures are closed");
    assert!(odd.is_empty(), "{odd:#?}");
    // Faces meet within their slack, so that no ray needs another to answer for it.
    assert_eq!(beside, 0);
}

#[test]
fn leaks_are_noticed() {
    let path =
        fixtures().into_iter().find(|path| path.to_string_lossy().contains("bracket")).expect("a fixture");
    let (model, sound) = baked(&path);
    let points = edge_points(&model);
    // Faces as narrow as they are: rays slip between them, or meet two, and others have to answer for them.
    let mut narrow = sound.clone();
    narrow.faces.iter_mut().for_each(|face| face.slack = 0.0);
    let leaks = count_aimed_leaks(&narrow.scene(), Precision::F32, &points, 0, RAYS, 0);
    assert!(leaks.odd + leaks.beside > RAYS / 100, "{leaks:?}");
    // A face that is not there: the slack of others does not stand in for it.
    let mut broken = sound.clone();
    broken.faces[0].uv_low[0] += 1e6;
    let leaks = count_uniform_leaks(&broken.scene(), Precision::F32, 0, RAYS, 0);
    assert!(leaks.odd > 0, "{leaks:?}");
}

fn fixture(name: &str) -> (Model, SceneBuffers) {
    baked(&fixtures().into_iter().find(|path| path.to_string_lossy().contains(name)).expect("a fixture"))
}

/// A ray that runs along a blade of the propeller, within its slack over a tenth of a millimetre, before it goes through it.
#[test]
fn a_grazed_face_does_not_hide_a_hit_behind() {
    let (_, buffers) = fixture("propeller");
    let origin = [-406.1428595112035, -276.43805732469366, -157.363363309528];
    let direction = [0.8176066501293169, 0.45167589347541964, 0.3570829776361486];
    let ray = Ray { origin: origin.into(), direction: direction.into() };
    for precision in [Precision::F32, Precision::F64] {
        let hits = probe(&buffers.scene(), &[ray], precision, false).remove(0);
        let distances: Vec<f64> = hits.iter().map(|hit| hit.t).collect();
        for expected in [440.6109, 442.4265, 456.6462, 466.2265] {
            assert!(distances.iter().any(|t| (t - expected).abs() < 1e-3), "{precision:?}: {distances:?}");
        }
        // In f32 the blade may be met where it is within the slack: once from either side.
        let most = if precision == Precision::F32 { 6 } else { 4 };
        assert!(distances.len().is_multiple_of(2) && distances.len() <= most, "{precision:?}: {distances:?}");
    }
}

/// Past an edge the nearest face, wider than it is by its slack, may be met where the body is not.
#[test]
fn the_first_hit_is_the_first_of_all() {
    let (model, buffers) = fixture("flange");
    let (scene, points) = (buffers.scene(), edge_points(&model));
    let rays: Vec<Ray> = (0..4000).map(|index| aimed(&scene, &points, index)).collect();
    for precision in [Precision::F32, Precision::F64] {
        let (first, all) = (probe(&scene, &rays, precision, true), probe(&scene, &rays, precision, false));
        for ((ray, first), all) in rays.iter().zip(&first).zip(&all) {
            let [first, expected] = [first, all].map(|hits| hits.first().map(|hit| (hit.face, hit.t)));
            assert_eq!(first, expected, "{precision:?} {ray:?}");
        }
    }
}
