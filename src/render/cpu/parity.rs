//! Which of a ray's hits a closed body can have.
//!
//! Faces are traced as wide as their slack, so that the hits found hold all true ones; where two faces overlap, or a ray grazes an edge outside the body,
//! there are more. Those are near a border or near a tangent, and known as such. A line leaves a body as often as it enters: of the uncertain
//! hits the fewest are left out that make it so, those near a border before others. Certain hits always stay; where they alone contradict, as when a face is missing, so do all.

use super::Kernel;
use super::footprint::GRAZING;
use super::hit::{body_of, world_slack};
use super::trace::{Certainty, RawHit};
use super::vector::number;
use crate::scene::Scene;
use smallvec::SmallVec;

/// How many times a ray may enter a body before it leaves.
const DEEPEST: usize = 8;

/// A hit and how the ray passes it.
#[derive(Debug, Clone, Copy)]
pub struct Crossing<T> {
    /// The hit.
    pub hit: RawHit<T>,
    /// Outward normal times direction, of length at most 1: negative where the ray enters.
    pub facing: T,
}

/// Leaves the hits that their bodies can have; `crossings` are in order along the ray, whose origin may be known to lie outside of all bodies.
pub fn consistent<T: Kernel>(
    scene: &Scene<'_>,
    starts_outside: bool,
    crossings: Vec<Crossing<T>>,
) -> Vec<Crossing<T>> {
    if crossings.iter().all(|crossing| crossing.hit.is_certain()) {
        return crossings;
    }
    let body = |index: usize| body_of(scene, &crossings[index].hit);
    let mut order: Vec<usize> = (0..crossings.len()).collect();
    order.sort_by_key(|&index| body(index));
    let mut kept = vec![true; crossings.len()];
    for of_body in order.chunk_by(|&a, &b| body(a) == body(b)) {
        let own: Vec<Crossing<T>> = of_body.iter().map(|&index| crossings[index]).collect();
        let is_closed = scene.body_infos[body(of_body[0]).1 as usize].is_closed();
        let in_turn = if is_closed { in_turn(&own, starts_outside) } else { None };
        let stays = in_turn.unwrap_or_else(|| without_overlaps(scene, &own));
        of_body.iter().zip(stays).for_each(|(&index, stays)| kept[index] = stays);
    }
    crossings.into_iter().zip(kept).filter_map(|(crossing, stays)| stays.then_some(crossing)).collect()
}

/// The closed bodies with an odd number of hits, of all hits' instances and bodies: a ray from outside leaves a body as often as it enters.
pub fn odd_bodies(scene: &Scene<'_>, bodies: impl Iterator<Item = (u32, u32)>) -> SmallVec<[(u32, u32); 2]> {
    let mut bodies: SmallVec<[(u32, u32); 16]> = bodies.collect();
    bodies.sort_unstable();
    let is_closed = |body: u32| scene.body_infos[body as usize].is_closed();
    let is_odd = |of_body: &&[(u32, u32)]| of_body.len() % 2 == 1 && is_closed(of_body[0].1);
    bodies.chunk_by(|a, b| a == b).filter(is_odd).map(|of_body| of_body[0]).collect()
}

/// Which hits stay so that the ray leaves as often as it enters; `None` where the certain ones do not.
///
/// Enters and leaves in turn, if that can be; else up to [`DEEPEST`] times before it leaves, for some solids overlap themselves or have voids
/// turned the wrong way, and where that keeps more of the hits that their faces have around them too. A body whose faces are all turned inside out is as good as another. At last the order does not count: where
/// the ray grazes a face, that of its hits is not known.
fn in_turn<T: Kernel>(crossings: &[Crossing<T>], starts_outside: bool) -> Option<Vec<bool>> {
    let ordered = (1..=DEEPEST).flat_map(|deepest| {
        [false, true].map(|is_turned| Way { starts_outside, outside: 0, deepest, is_turned })
    });
    let unordered = Way { starts_outside, outside: DEEPEST / 2, deepest: DEEPEST, is_turned: false };
    let (way, cost, mut stays) = ordered.chain([unordered]).find_map(|way| {
        let (cost, stays) = least_left_out(crossings, &way)?;
        Some((way, cost, stays))
    })?;
    // Hits near borders may go as the way asks, for faces overlap there; hits inside their faces only where no deeper way keeps more of them.
    let mut inside = cost / INSIDE_COST;
    for deepest in way.deepest + 1..=DEEPEST {
        if inside == 0 {
            break;
        }
        if let Some((cost, deeper)) = least_left_out(crossings, &Way { deepest, ..way })
            && cost / INSIDE_COST < inside
        {
            (inside, stays) = (cost / INSIDE_COST, deeper);
        }
    }
    Some(stays)
}

/// What it costs to leave out a hit that its face has around it too, where one near a border costs 1: more than all of those.
const INSIDE_COST: u64 = 1 << 32;

/// What a ray may do.
#[derive(Debug, Clone, Copy)]
struct Way {
    /// Whether it is known to start outside.
    starts_outside: bool,
    /// The depth that is outside: so many times it may leave before it has entered.
    outside: usize,
    /// The greatest depth, counted from the least.
    deepest: usize,
    /// Whether normals point inwards.
    is_turned: bool,
}

/// The search over prefixes: what costs least to be left out of the first ones so that the ray has then entered so many times more than left; the
/// cost, and which hits stay.
fn least_left_out<T: Kernel>(crossings: &[Crossing<T>], way: &Way) -> Option<(u64, Vec<bool>)> {
    const NEVER: u64 = u64::MAX;
    let Way { starts_outside, outside, deepest, is_turned } = *way;
    // By depth, as far as `deepest`.
    let mut left_out = [NEVER; DEEPEST + 1];
    left_out[outside..=if starts_outside { outside } else { deepest }].fill(0);
    // By hit and by the depth it leads to: the depth it comes from, where the hit stays.
    let mut choices: Vec<[Option<usize>; DEEPEST + 1]> = Vec::with_capacity(crossings.len());
    for Crossing { hit, facing } in crossings {
        let is_sideways = facing.abs() < number(GRAZING);
        let enters = (*facing < T::ZERO) != is_turned;
        let before = left_out;
        let mut choice = [None; DEEPEST + 1];
        for depth in 0..=deepest {
            left_out[depth] = match hit.certainty {
                Certainty::Certain => NEVER,
                Certainty::Own => before[depth].saturating_add(INSIDE_COST),
                Certainty::Border => before[depth].saturating_add(1),
            };
            let outer = depth.checked_sub(1).filter(|_| enters || is_sideways);
            let inner = Some(depth + 1).filter(|&inner| inner <= deepest && (!enters || is_sideways));
            for from in [outer, inner].into_iter().flatten() {
                if before[from] < NEVER && before[from] <= left_out[depth] {
                    left_out[depth] = before[from];
                    choice[depth] = Some(from);
                }
            }
        }
        choices.push(choice);
    }
    if left_out[outside] == NEVER {
        return None;
    }
    let mut stays = vec![false; crossings.len()];
    let mut depth = outside;
    for (index, choice) in choices.iter().enumerate().rev() {
        if let Some(from) = choice[depth] {
            stays[index] = true;
            depth = from;
        }
    }
    Some((left_out[outside], stays))
}

/// Where nothing is known of inside and outside: of hits at one place and from one side the certain ones and those of other faces without a border there, or
/// one where there is none.
fn without_overlaps<T: Kernel>(scene: &Scene<'_>, crossings: &[Crossing<T>]) -> Vec<bool> {
    one_of_each(crossings, |crossing| world_slack(scene, &crossing.hit))
}

/// [`without_overlaps`] with the slack of a crossing's face. More than two hits may be at one place, where four leaves meet, and those of the other side
/// of a fold may be between them.
fn one_of_each<T: Kernel>(crossings: &[Crossing<T>], slack: impl Fn(&Crossing<T>) -> T) -> Vec<bool> {
    let mut stays = vec![true; crossings.len()];
    let slacks: Vec<T> = crossings.iter().map(slack).collect();
    let widest = slacks.iter().fold(T::ZERO, |widest, &slack| slack.max(widest));
    let mut staying: Vec<usize> = Vec::with_capacity(crossings.len());
    for index in 0..crossings.len() {
        let own = &crossings[index];
        // Those that go for this one, if it stays.
        let mut replaced: SmallVec<[usize; 4]> = SmallVec::new();
        for &before in staying.iter().rev() {
            let other = &crossings[before];
            let apart = own.hit.distance.minus(other.hit.distance);
            // No pair is farther apart than this.
            if apart * number(GRAZING) > (slacks[index] + widest) * number(2.0) {
                break;
            }
            let reach = (slacks[index] + slacks[before]) * number(2.0);
            let steepness = own.facing.abs().min(other.facing.abs()).max(number(GRAZING));
            let is_same = (own.facing < T::ZERO) == (other.facing < T::ZERO) && apart * steepness <= reach;
            if !is_same {
                continue;
            }
            // Where faces overlap there is a border of that whose hit goes.
            let may_go = |one: &RawHit<T>, other: &RawHit<T>| match one.certainty {
                Certainty::Certain => false,
                Certainty::Own => one.face == other.face && one.instance == other.instance,
                Certainty::Border => true,
            };
            if may_go(&own.hit, &other.hit) {
                stays[index] = false;
                break;
            }
            if may_go(&other.hit, &own.hit) {
                replaced.push(before);
            }
        }
        if stays[index] {
            replaced.into_iter().for_each(|before| stays[before] = false);
            staying.retain(|&before| stays[before]);
            staying.push(index);
        }
    }
    stays
}

#[cfg(test)]
mod tests {
    use super::super::ray_space::Distance;
    use super::*;

    /// A hit that enters (−1) or leaves (1), certain or not.
    fn crossing(facing: f32, is_certain: bool) -> Crossing<f32> {
        let certainty = if is_certain { Certainty::Certain } else { Certainty::Border };
        let distance = Distance { anchor: 0.0, offset: 0.0 };
        let hit =
            RawHit { distance, instance: 0, face: 0, net: 0, uv: [0.0; 2], certainty, is_shallow: false };
        Crossing { hit, facing }
    }

    fn stays(crossings: &[(f32, bool)]) -> Option<Vec<bool>> {
        let crossings: Vec<_> =
            crossings.iter().map(|&(facing, certain)| crossing(facing, certain)).collect();
        in_turn(&crossings, true)
    }

    #[test]
    fn overlaps_are_left_out() {
        let all = Some(vec![true, true]);
        assert_eq!(stays(&[(-1.0, true), (1.0, true)]), all);
        assert_eq!(stays(&[(-1.0, false), (1.0, false)]), all);
        assert_eq!(stays(&[(-1.0, false), (-1.0, true), (1.0, true)]), Some(vec![false, true, true]));
        assert_eq!(stays(&[(-1.0, false), (-1.0, false), (1.0, true)]).map(|s| s[2]), Some(true));
        assert_eq!(stays(&[(-1.0, false)]), Some(vec![false]));
        assert_eq!(stays(&[(1.0, true), (-1.0, true)]), all, "inside out");
        assert_eq!(stays(&[(1.0, false), (-1.0, false)]), Some(vec![false, false]));
        assert_eq!(stays(&[(-1e-6, false), (-1.0, true)]).map(|s| s.len()), Some(2));
    }

    #[test]
    fn certain_hits_stay() {
        assert_eq!(stays(&[(-1.0, true)]), None);
        assert_eq!(stays(&[(-1.0, true), (-1.0, true), (1.0, false)]), None);
        let nested = [(-1.0, true), (-1.0, true), (-1.0, false), (1.0, false), (1.0, true)];
        assert_eq!(stays(&nested), Some(vec![true, true, false, true, true]));
        let late = [(1e-6, false), (-1.0, true), (-1.0, true), (1.0, true)];
        assert_eq!(stays(&late), Some(vec![true; 4]));
        let from_inside = in_turn(&[crossing(1.0, true)], false);
        assert_eq!(from_inside, Some(vec![true]));
    }

    /// A solid that overlaps itself, where a ray grazes what is inside of it.
    #[test]
    fn what_a_face_has_around_it_stays_where_any_way_keeps_it() {
        let of = |facing: f32, certainty: Certainty| {
            let mut own = crossing(facing, true);
            own.hit.certainty = certainty;
            own
        };
        let stays = |inner: Certainty| {
            let crossings =
                [(-0.4, Certainty::Certain), (-0.01, inner), (0.01, inner), (0.8, Certainty::Certain)];
            in_turn(&crossings.map(|(facing, certainty)| of(facing, certainty)), true)
        };
        assert_eq!(stays(Certainty::Own), Some(vec![true; 4]));
        assert_eq!(stays(Certainty::Border), Some(vec![true, false, false, true]));
        let odd = [of(-0.4, Certainty::Certain), of(-0.3, Certainty::Own), of(0.8, Certainty::Certain)];
        assert_eq!(in_turn(&odd, true), Some(vec![true, false, true]));
        let backwards = [of(0.3, Certainty::Own), of(-0.3, Certainty::Own)];
        assert_eq!(
            in_turn(&backwards, true),
            Some(vec![false, false]),
            "no body is turned for hits that may be none"
        );
    }

    #[test]
    fn one_hit_of_each_place_and_side_stays() {
        let stays = |crossings: &[(f32, bool)]| {
            let crossings: Vec<_> =
                crossings.iter().map(|&(facing, certain)| crossing(facing, certain)).collect();
            one_of_each(&crossings, |_| 1e-6)
        };
        assert_eq!(stays(&[(-1.0, false); 4]), [true, false, false, false]);
        assert_eq!(
            stays(&[(-1.0, false), (1.0, false), (-1.0, false), (1.0, false)]),
            [true, true, false, false]
        );
        assert_eq!(stays(&[(-1.0, false), (-1.0, true), (-1.0, false)]), [false, true, false]);
        assert_eq!(stays(&[(-1.0, true), (-1.0, true)]), [true, true]);
    }

    #[test]
    fn a_hit_without_a_border_is_no_other_face_s() {
        let of = |face: u32, certainty: Certainty| {
            let mut own = crossing(-0.4, true);
            (own.hit.face, own.hit.certainty) = (face, certainty);
            own
        };
        let stays = |crossings: &[Crossing<f32>]| one_of_each(crossings, |_| 1e-6);
        let (certain, inside, border) = (Certainty::Certain, Certainty::Own, Certainty::Border);
        assert_eq!(stays(&[of(0, certain), of(1, inside)]), [true, true]);
        assert_eq!(stays(&[of(0, inside), of(1, certain)]), [true, true]);
        assert_eq!(stays(&[of(0, certain), of(0, inside)]), [true, false]);
        assert_eq!(stays(&[of(0, inside), of(0, inside)]), [true, false]);
        assert_eq!(stays(&[of(0, border), of(1, inside)]), [false, true]);
        assert_eq!(stays(&[of(1, inside), of(0, border)]), [true, false]);
    }

    #[test]
    fn a_hit_between_does_not_hide_one_of_a_wider_face() {
        let at = |offset: f32, facing: f32, face: u32| {
            let mut own = crossing(facing, false);
            (own.hit.distance.offset, own.hit.face) = (offset, face);
            own
        };
        let crossings = [at(0.0, 0.01, 1), at(0.1, -1.0, 0), at(1.1, 0.01, 0)];
        let slack = |crossing: &Crossing<f32>| if crossing.hit.face == 1 { 1e-2 } else { 1e-6 };
        assert_eq!(one_of_each(&crossings, slack), [true, true, false]);
    }
}
