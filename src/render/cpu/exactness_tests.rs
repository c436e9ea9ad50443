//! What each exactness finds of a ray that grazes a leaf.

use super::test_scenes::{Random, TestFace, TestNet, scene_of};
use super::{Precision, Step, count_steps, probe_with};
use crate::render::{Exactness, Hit, Ray};
use glam::{DAffine3, DVec3};
use rayon::prelude::*;

/// A barrel vault `z = u (1 − u)` over the unit square, in one leaf.
fn vault() -> TestNet {
    let points = [0.0, 0.5, 0.0]
        .iter()
        .zip([0.0, 0.5, 1.0])
        .flat_map(|(&z, x)| [0.0, 1.0].map(|y| [x, y, z, 1.0]))
        .collect();
    TestNet { degrees: [2, 1], points, level: 0 }
}

/// Half the distance between the two hits of [`grazing`] rays.
const REACHES: [f64; 5] = [0.3, 0.1, 0.05, 0.02, 0.01];

/// A ray just under the ridge, which it crosses at a right angle: it meets the vault at `u = ½ ± reach`.
fn grazing(reach: f64) -> Ray {
    Ray { origin: DVec3::new(-3.0, 0.4, 0.25 - reach * reach), direction: DVec3::X }
}

fn hits(ray: Ray, precision: Precision, exactness: Exactness) -> Vec<Hit> {
    let scene = scene_of(&[TestFace::nets(vault())], &[DAffine3::IDENTITY]);
    probe_with(&scene.scene(), &[ray], precision, false, exactness).remove(0)
}

#[test]
fn exact_finds_both_hits_of_grazing_rays() {
    for precision in [Precision::F32, Precision::F64] {
        for reach in REACHES {
            let hits = hits(grazing(reach), precision, Exactness::Exact);
            assert_eq!(hits.len(), 2, "{precision:?} {reach}: {hits:?}");
            for (hit, side) in hits.iter().zip([-1.0, 1.0]) {
                let expected = 3.5 + side * reach;
                assert!((hit.t - expected).abs() < 1e-4, "{precision:?} {reach}: {hit:?}");
            }
        }
    }
}

#[test]
fn fast_loses_one_of_two_and_balanced_none_where_the_ray_enters_and_leaves_beside_them() {
    for reach in REACHES {
        let count = |exactness| hits(grazing(reach), Precision::F64, exactness).len();
        assert_eq!(count(Exactness::Fast), 1, "{reach}");
        assert_eq!(count(Exactness::Balanced), 2, "{reach}");
    }
}

/// Certified pairs are searched once, whatever is asked for: the same hit to the last bit.
#[test]
fn steep_rays_are_the_same_in_all_modes() {
    for place in 0..20 {
        let origin = DVec3::new(0.02 + 0.045 * f64::from(place), 0.3, 5.0);
        let ray = Ray { origin, direction: DVec3::new(0.02, 0.01, -1.0).normalize() };
        let [fast, balanced, exact] = [Exactness::Fast, Exactness::Balanced, Exactness::Exact]
            .map(|exactness| hits(ray, Precision::F64, exactness));
        assert_eq!(exact.len(), 1, "{place}");
        assert_eq!([&fast[0].t, &balanced[0].t], [&exact[0].t; 2], "{place}");
    }
}

/// Where a face may be met as far beyond its ends as it is wide, all of its cells are open: they are not quartered to the last.
#[test]
fn what_is_smaller_than_its_slack_takes_few_cells() {
    let mut scene = scene_of(&[TestFace::nets(vault())], &[DAffine3::IDENTITY]);
    scene.faces[0].slack = 1.2;
    let mut random = Random(7);
    let rays: Vec<Ray> = (0..200)
        .map(|_| {
            let target = DVec3::new(random.unit(), random.unit(), 0.25 * random.unit());
            let direction = random.direction();
            Ray { origin: target - direction * 4.0, direction }
        })
        .collect();
    let counts = count_steps(&scene.scene(), rays.into_par_iter(), Exactness::Exact, false);
    let [leaves, cells] = [Step::DividedLeaf, Step::Cell].map(|step| counts.of(step));
    eprintln!("{leaves} leaves, {cells} cells");
    assert!(leaves > 50 && cells > leaves, "{leaves} {cells}");
    // An eighth of the leaf's sides, of 1 and half the bend of 2, is below a quarter of the slack. Of some leaves a few cells inside are smaller.
    assert!(cells <= leaves * (1 + 4 + 16 + 64), "{leaves} {cells}");
}
