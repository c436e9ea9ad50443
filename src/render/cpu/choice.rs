//! What becomes of the hits of a ray on their way to its answer, for the benches: an even number of hits alone does not say that they are right.

use super::beside::{Settled, settle};
use super::footprint::{LONGEST, same_place};
use super::hit::{body_of, world_slack};
use super::parity::Crossing;
use super::probe::{met_hits, of_each};
use super::ray_space::prepare;
use super::vector::number;
use super::{Kernel, Precision};
use crate::render::{Exactness, Ray};
use crate::scene::Scene;

/// The hits of one ray, counted.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Choice {
    /// Places where it meets a face, before those are left out that its bodies cannot have.
    pub places: usize,
    /// Those that its bodies can have.
    pub own: usize,
    /// Hits of the answer.
    pub hits: usize,
    /// Whether two of those are at one place of a body and from one side.
    pub is_repeated: bool,
    /// Whether some hits of the answer are those of a ray beside it.
    pub is_beside: bool,
}

/// The counts of each ray, with the default exactness.
pub fn choices(scene: &Scene<'_>, rays: &[Ray], precision: Precision) -> Vec<Choice> {
    of_each(scene, rays, precision, |ray| choice::<f64>(scene, ray), |ray| choice::<f32>(scene, ray))
}

fn choice<T: Kernel>(scene: &Scene<'_>, ray: &Ray) -> Choice {
    let Some(prepared) = prepare::<T>(ray, scene.header) else {
        return Choice::default();
    };
    let met = met_hits(scene, Exactness::default(), &prepared);
    let Settled { crossings, places, own, is_beside } = settle(scene, Exactness::default(), &prepared, met);
    let is_repeated = is_repeated(scene, &crossings);
    Choice { places, own, hits: crossings.len(), is_repeated, is_beside }
}

fn is_repeated<T: Kernel>(scene: &Scene<'_>, hits: &[Crossing<T>]) -> bool {
    let body = |c: &Crossing<T>| body_of(scene, &c.hit);
    let slack = |c: &Crossing<T>| world_slack(scene, &c.hit);
    hits.iter().enumerate().any(|(index, own)| {
        let before = hits[..index].iter().rev();
        let apart = |other: &Crossing<T>| own.hit.distance.minus(other.hit.distance);
        let reach = |other: &Crossing<T>| slack(own).max(slack(other));
        before.take_while(|other| apart(other) <= reach(other) * number(2.0 * LONGEST)).any(|other| {
            body(own) == body(other) && same_place(apart(other), own.facing, other.facing, reach(other))
        })
    })
}
