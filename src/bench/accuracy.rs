//! The hits of the tracers against those of the f64 reference: what is missed, what is made up, how far the rest is off, and what a ray costs.
//!
//! Two references: one traces exactly the baked f32 numbers, so that what differs is the tracer's own error; the other traces the model's
//! f64 numbers, which shows the error of baking too. Only rays that the reference is certain of count; the others are told apart.

use super::misclassified::{WrongHits, count_misclassified};
use super::rays::chord;
use crate::render::cpu::{Precision, probe_alone};
use crate::render::reference::{ExpectedHit, Reference, TOLERANCE};
use crate::render::{Exactness, Hit, Ray};
use crate::scene::Scene;
use glam::DVec3;
use rayon::prelude::*;
use std::time::Instant;

/// Rays that are traced at once.
const BATCH: u64 = 1 << 14;

/// A hit answers an expected one of the same face within this many tolerances, divided by |cos| of the angle to the normal.
const SAME_HIT: f64 = 64.0;

/// Hits with |cos| above this are steep.
const STEEP: f64 = 0.2;

/// Who is judged.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Tracer {
    /// The numbers it computes with.
    pub precision: Precision,
    /// How it searches nets.
    pub exactness: Exactness,
}

impl From<Precision> for Tracer {
    fn from(precision: Precision) -> Self {
        Self { precision, exactness: Exactness::default() }
    }
}

/// Errors of many hits.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Quantiles {
    /// Half are below.
    pub median: f64,
    /// 99 of 100 are below.
    pub p99: f64,
    /// 999 of 1000 are below.
    pub p999: f64,
    /// The greatest.
    pub max: f64,
}

/// What the comparison found.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Accuracy {
    /// Rays traced.
    pub rays: u64,
    /// Those of which the reference is certain.
    pub certain: u64,
    /// Hits of those by the reference.
    pub hits: u64,
    /// Of these, those that the tracer does not have.
    pub missed: u64,
    /// Hits that the tracer has and the reference has not.
    pub phantom: u64,
    /// Of both, those whose place on the surface both have: a trim was decided otherwise.
    pub misclassified: u64,
    /// |difference of distances| over the size of the net or of the carrier's piece.
    pub distance: Quantiles,
    /// The same of the hits with |cos| of the angle to the normal above [`STEEP`]: elsewhere any error of a position counts 1 / |cos| times.
    pub steep_distance: Quantiles,
    /// Angle between the normals, radians.
    pub normal: Quantiles,
    /// Difference of the surface parameters, as a length along the surface over that size.
    pub parameters: Quantiles,
    /// Rays with an odd number of hits by the tracer, certain or not.
    pub odd: u64,
    /// The first ray with a hit missed or made up.
    pub wrong: Option<Ray>,
    /// The first ray with an odd number of hits.
    pub odd_ray: Option<Ray>,
    /// Of a ray with all its hits, on one thread's share of time, seconds.
    pub seconds: f64,
}

/// Traces `count` chords of the scene's sphere, from number `first` on, and compares them with the reference. Rays start `distance` radii of the scene
/// before the sphere.
pub fn measure_accuracy(
    scene: &Scene<'_>,
    reference: &Reference<'_>,
    tracer: Tracer,
    distance: f64,
    first: u64,
    count: u64,
) -> Accuracy {
    let radius = DVec3::from_array(scene.header.half_size.map(f64::from)).length();
    let ray = |index: u64| {
        let Ray { origin, direction } = chord(scene, index);
        Ray { origin: origin - direction * (distance * radius), direction }
    };
    measure_rays(scene, reference, tracer, first, count, &ray)
}

/// [`measure_accuracy`] with the rays of choice, by their number.
pub(super) fn measure_rays(
    scene: &Scene<'_>,
    reference: &Reference<'_>,
    tracer: Tracer,
    first: u64,
    count: u64,
    ray: &dyn Fn(u64) -> Ray,
) -> Accuracy {
    let mut result = Accuracy { rays: count, ..Accuracy::default() };
    let (mut distances, mut steep, mut angles, mut parameters) = (vec![], vec![], vec![], vec![]);
    let mut wrong: Vec<WrongHits> = Vec::new();
    let mut elapsed = 0.0;
    for start in (first..first + count).step_by(BATCH as usize) {
        let rays: Vec<Ray> = (start..(start + BATCH).min(first + count)).map(ray).collect();
        let clock = Instant::now();
        let found = probe_alone(scene, &rays, tracer.precision, tracer.exactness);
        elapsed += clock.elapsed().as_secs_f64();
        let compared: Vec<Option<Comparison>> = rays
            .par_iter()
            .zip(&found)
            .map(|(ray, found)| reference.trace(ray).map(|expected| compare(&expected, found)))
            .collect();
        for (ray, _) in rays.iter().zip(&found).filter(|(_, hits)| hits.len() % 2 == 1) {
            result.odd += 1;
            result.odd_ray = result.odd_ray.or(Some(*ray));
        }
        for (ray, comparison) in rays.iter().zip(compared) {
            let Some(comparison) = comparison else { continue };
            let Comparison { errors, missed, phantom } = comparison;
            result.certain += 1;
            result.hits += (errors.len() + missed.len()) as u64;
            result.missed += missed.len() as u64;
            result.phantom += phantom.len() as u64;
            if !(missed.is_empty() && phantom.is_empty()) {
                wrong.push(WrongHits { ray: *ray, missed, phantom });
            }
            for HitError { distance, angle, along, facing } in errors {
                distances.push(distance);
                angles.push(angle);
                parameters.push(along);
                if facing > STEEP {
                    steep.push(distance);
                }
            }
        }
    }
    result.distance = quantiles(distances);
    result.steep_distance = quantiles(steep);
    result.normal = quantiles(angles);
    result.parameters = quantiles(parameters);
    result.wrong = wrong.first().map(|wrong| wrong.ray);
    result.misclassified = count_misclassified(scene, reference, tracer, &wrong);
    result.seconds = elapsed * rayon::current_num_threads() as f64 / count.max(1) as f64;
    result
}

/// Of a hit that both have.
#[derive(Debug)]
struct HitError {
    distance: f64,
    angle: f64,
    along: f64,
    /// |cos| of the angle between the ray and the normal.
    facing: f64,
}

/// One ray's.
#[derive(Debug, Default)]
struct Comparison {
    errors: Vec<HitError>,
    missed: Vec<ExpectedHit>,
    phantom: Vec<Hit>,
}

fn compare(expected: &[ExpectedHit], found: &[Hit]) -> Comparison {
    let mut result = Comparison { phantom: found.to_vec(), ..Comparison::default() };
    for own in expected {
        let left = &mut result.phantom;
        let apart = |other: &Hit| (other.t - own.hit.t).abs();
        let nearest = (0..left.len())
            .filter(|&i| is_same_hit(own, &left[i]))
            .min_by(|&a, &b| apart(&left[a]).total_cmp(&apart(&left[b])));
        match nearest {
            Some(i) => {
                let other = left.swap_remove(i);
                let (distance, angle) = (apart(&other) / own.size, angle(&other, &own.hit));
                let along = distance_along(own, &other) / own.size;
                result.errors.push(HitError { distance, angle, along, facing: own.facing });
            }
            None => result.missed.push(*own),
        }
    }
    result
}

/// Whether a hit answers an expected one.
pub(super) fn is_same_hit(expected: &ExpectedHit, found: &Hit) -> bool {
    let ExpectedHit { hit, size, facing, .. } = expected;
    let limit = SAME_HIT * TOLERANCE * size / facing;
    (found.face, found.instance) == (hit.face, hit.instance) && (found.t - hit.t).abs() <= limit
}

/// The difference of the surface parameters, as a length.
fn distance_along(expected: &ExpectedHit, found: &Hit) -> f64 {
    let [u, v] = [0, 1].map(|k| {
        let apart = found.uv[k] - expected.hit.uv[k];
        let period = expected.period[k];
        let turns = if period > 0.0 { (apart / period).round() } else { 0.0 };
        (apart - turns * period) * expected.lengths[k]
    });
    u.hypot(v)
}

fn angle(a: &Hit, b: &Hit) -> f64 {
    a.normal.cross(b.normal).length().atan2(a.normal.dot(b.normal))
}

pub(super) fn quantiles(mut values: Vec<f64>) -> Quantiles {
    values.sort_by(f64::total_cmp);
    let at = |share: f64| {
        let index = (values.len() as f64 * share) as usize;
        values.get(index.min(values.len().saturating_sub(1))).copied().unwrap_or(0.0)
    };
    Quantiles { median: at(0.5), p99: at(0.99), p999: at(0.999), max: at(1.0) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bake::{BakeOptions, bake};
    use crate::render::reference::widened;
    use crate::scene::{SceneBuffers, TRIM_INSIDE, primitive};

    fn fixture(name: &str) -> SceneBuffers {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name);
        let model = crate::import::import(&path.join("model.step")).expect("a fixture");
        bake(&model, &BakeOptions { keep_f64: true, ..BakeOptions::default() }, &|_, _| {})
    }

    fn measured(scene: &SceneBuffers, truth: &SceneBuffers) -> Accuracy {
        measure_accuracy(&scene.scene(), &Reference::new(truth.scene()), Precision::F32.into(), 0.0, 0, 4000)
    }

    #[test]
    fn tracers_agree_with_the_reference() {
        for name in ["knob", "flask", "chain"] {
            let scene = fixture(name);
            let found = measured(&scene, &widened(&scene.scene()));
            assert!(found.certain >= 3990 && found.hits > 500, "{name}: {found:?}");
            assert_eq!((found.missed, found.phantom), (0, 0), "{name}: {found:?}");
            assert!(found.distance.median < 1e-7 && found.distance.p99 < 2e-6, "{name}: {found:?}");
            assert!(found.steep_distance.p999 < 1e-6, "{name}: {found:?}");
            assert!(found.parameters.median < 2e-7 && found.parameters.max > 0.0, "{name}: {found:?}");
            // The same from ten thousand radii away.
            let reference = widened(&scene.scene());
            let reference = Reference::new(reference.scene());
            let far = measure_accuracy(&scene.scene(), &reference, Precision::F32.into(), 1e4, 0, 4000);
            assert_eq!((far.missed, far.phantom), (0, 0), "{name}: {far:?}");
            assert!(far.steep_distance.p999 < 1e-6, "{name}: {far:?}");
        }
    }

    #[test]
    fn wrong_tracers_are_noticed() {
        let truth = fixture("knob");
        let mut bare = truth.clone();
        // A leaf whose slab is nowhere: its hits are missed.
        let leaf = bare.primitives.iter().position(|word| word & primitive::NET_LEAF_BIT != 0);
        let leaf = bare.primitives[leaf.expect("a net")] & !primitive::NET_LEAF_BIT;
        for leaf in &mut bare.net_leaves[leaf as usize..][..8] {
            leaf.center = leaf.center.map(|x| x + 1e6);
        }
        let found = measured(&bare, &truth);
        assert!(found.missed > 0 && found.misclassified == 0, "{found:?}");
        // A net that reaches out: hits where none should be, and others that are off.
        let mut moved = truth.clone();
        moved.net_points.iter_mut().for_each(|p| p[0] += 0.01 * p[3]);
        let found = measured(&moved, &truth);
        assert!(found.missed > 0 && found.phantom > 0, "{found:?}");
        // Holes that are closed.
        let mut open = truth.clone();
        for face in &mut open.faces {
            face.trim_root = TRIM_INSIDE;
        }
        for leaf in &mut open.net_leaves {
            leaf.trim = TRIM_INSIDE;
        }
        let found = measured(&open, &truth);
        assert!(found.phantom > 0 && found.misclassified * 10 > found.phantom * 9, "{found:?}");
        // Faces that are holes: the places are there, but the trims say no.
        let found = measured(&truth, &open);
        assert!(found.missed > 0 && found.misclassified * 10 > found.missed * 9, "{found:?}");
    }
}
