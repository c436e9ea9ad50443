//! A small part of the stress in every run of the tests, and that it would notice.

use super::draft::{analytic_solids, egg_solid};
use super::sameness::compare;
use super::*;
use glam::DAffine3;

const RAYS: u64 = 100;

/// Scenes on which f32 is known to make up hits, within some of its roundings of the surface: control points that are large beside the surface,
/// degenerate nets, singular points, silhouettes.
const BEYOND_F32: [&str; 5] = ["chebyshev", "crowded-knots", "cusp", "degree-25", "strip"];

/// The end of its spike is thinner than what trimming tells from nothing.
const DROPS_A_FACE: &str = "sliver-spike";

#[test]
fn nothing_is_missed() {
    for case in cases() {
        let scene = case.scene();
        assert_eq!(scene.dropped.len(), usize::from(case.name == DROPS_A_FACE), "{}", case.name);
        for precision in [Precision::F32, Precision::F64] {
            for kind in [RayKind::Made, RayKind::Chords] {
                let found = scene.measure(kind, precision, 0, RAYS);
                let Accuracy { certain, hits, missed, phantom, odd, .. } = found;
                let place = format!("{} {precision:?} {kind:?}", case.name);
                eprintln!(
                    "{place}: {certain} certain, {hits} hits, {missed} missed, {phantom} made up, {odd} odd"
                );
                if precision == Precision::F64 || !BEYOND_F32.contains(&case.name) {
                    assert_eq!((missed, phantom), (0, 0), "{place}: {:?}", found.wrong);
                }
                assert!(!scene.is_closed || odd == 0, "{place}: {:?}", found.odd_ray);
            }
        }
    }
}

#[test]
fn other_forms_have_the_same_hits() {
    for subject in SUBJECTS {
        for change in Change::ALL {
            for precision in [Precision::F32, Precision::F64] {
                let found = measure_sameness(subject, change, precision, 0, RAYS);
                eprintln!("{} {} {precision:?}: {found:?}", subject.name, change.name());
                assert!(found.hits > 0 && found.certain > RAYS / 2);
                assert_eq!((found.different, found.apart), (0, 0), "{} {}", subject.name, change.name());
            }
        }
    }
}

#[test]
fn names_are_different() {
    let mut names: Vec<&str> =
        cases().map(|case| case.name).chain(SUBJECTS.iter().map(|subject| subject.name)).collect();
    let count = names.len();
    names.sort_unstable();
    names.dedup();
    assert_eq!(names.len(), count);
}

#[test]
fn wrong_hits_are_noticed() {
    let case = cases().find(|case| case.name == "features-net").expect("a scene");
    let mut scene = case.scene();
    // The truth is a little elsewhere.
    scene.narrow.net_points_f64.iter_mut().for_each(|point| point[0] += 1e-3 * point[3]);
    let found = scene.measure(RayKind::Chords, Precision::F32, 0, RAYS);
    assert!(found.missed > 0 && found.phantom > 0 && found.wrong.is_some(), "{found:?}");
    // Half of the surface is missing, and with it the far or the near wall.
    let half = scene.buffers.net_leaves.iter_mut().filter(|leaf| leaf.center[0] > 0.0);
    half.for_each(|leaf| leaf.center[0] += 1e6);
    let found = scene.measure(RayKind::Chords, Precision::F32, 0, RAYS);
    assert!(found.odd > 0 && found.odd_ray.is_some(), "{found:?}");
}

#[test]
fn differences_are_noticed() {
    let (base, other) = (baked(&egg_solid()), baked(&analytic_solids()));
    let (base, other) = (base.scene(), other.scene());
    let rays: Vec<Ray> = (0..RAYS).map(|index| chord(&base, index)).collect();
    let found = compare(&base, &other, &rays, &DAffine3::IDENTITY, Precision::F64);
    assert!(found.different > 0 && found.wrong.is_some(), "{found:?}");
    let shift = DAffine3::from_translation(DVec3::X * 1e-9);
    let found = compare(&base, &base, &rays, &shift, Precision::F64);
    assert!(found.apart > 0 && found.greatest < 1e-8, "{found:?}");
}
