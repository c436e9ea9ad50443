//! Which wrong hits are the trims' fault: their places on the surface are right, and only inside or outside was told otherwise.

use super::accuracy::{Tracer, is_same_hit};
use crate::render::cpu::{Untrimmed, probe_alone};
use crate::render::reference::{ExpectedHit, Reference};
use crate::render::{Hit, Ray};
use crate::scene::Scene;
use rayon::prelude::*;

/// The hits of a ray that tracer and reference do not share.
#[derive(Debug)]
pub(super) struct WrongHits {
    /// The ray.
    pub ray: Ray,
    /// What the reference alone has.
    pub missed: Vec<ExpectedHit>,
    /// What the tracer alone has.
    pub phantom: Vec<Hit>,
}

/// How many of the hits the other side would have had without trims, and without closed bodies, of whose hits some are left out. A missed one in a
/// leaf that the bake left out as wholly trimmed away is not among them, nor a made-up one of which the reference is not certain there.
pub(super) fn count_misclassified(
    scene: &Scene<'_>,
    reference: &Reference<'_>,
    tracer: Tracer,
    wrong: &[WrongHits],
) -> u64 {
    if wrong.is_empty() {
        return 0;
    }
    let bare = Untrimmed::new(scene);
    let bare = bare.scene(scene);
    let bare_truth = Untrimmed::new(reference.scene());
    let bare_truth = Reference::new(bare_truth.scene(reference.scene()));
    let count = |WrongHits { ray, missed, phantom }: &WrongHits| {
        let found = &probe_alone(&bare, &[*ray], tracer.precision, tracer.exactness)[0];
        let is_met = |expected: &&ExpectedHit| found.iter().any(|hit| is_same_hit(expected, hit));
        let expected = bare_truth.trace(ray).unwrap_or_default();
        let is_there = |hit: &&Hit| expected.iter().any(|expected| is_same_hit(expected, hit));
        (missed.iter().filter(is_met).count() + phantom.iter().filter(is_there).count()) as u64
    };
    wrong.par_iter().map(count).sum()
}
