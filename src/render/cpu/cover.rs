//! Whether a hit belongs to a face: the trim window and the trim tree, each as wide as the hit's footprint.

use super::footprint::Footprint;
use super::tally::Tally;
use super::trim::{trim_inside_tallied, trim_point};
use super::vector::{Vector3, number};
use crate::numeric::Real;
use crate::scene::{Face, Scene};

/// How a hit lies to the border of its face.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cover {
    /// It is none.
    Outside,
    /// A hit, as near to the border as the slack.
    Border,
    /// A hit, and so are the places around it, as far as the slack; the border may still be near.
    Near,
    /// A hit, whatever the errors.
    Inside,
}

/// A normalised parameter, wrapped to where it is nearest to the window [0, 1].
#[inline]
pub fn to_window<T: Real>(parameter: T, period: T) -> T {
    if !(period > T::ZERO) {
        return parameter;
    }
    let p = parameter - (parameter / period).floor() * period;
    if p > T::ONE && p - T::ONE > period - p { p - period } else { p }
}

/// Whether a place is outside of the window whatever the footprint, which reaches a quarter of the window at most.
#[inline]
pub fn is_far_outside<T: Real>(uv: [T; 2]) -> bool {
    let half = number::<T>(0.5);
    !uv.iter().all(|&x| x > -half && x < T::ONE + half)
}

/// How a hit at the normalised parameters `at` (already wrapped, rounded by `margin` at most) lies to a face. `sides` tells those of the ray's direction, in
/// the space of the footprint.
pub fn cover<T: Real>(
    scene: &Scene<'_>,
    face: &Face,
    period: [T; 2],
    at: [T; 2],
    margin: [T; 2],
    footprint: &Footprint<T>,
    sides: impl FnOnce() -> [Vector3<T>; 2],
    tally: &mut impl Tally,
) -> Cover {
    let extent = footprint.extent();
    let reach = [extent[0] + margin[0], extent[1] + margin[1]];
    let passes_by = |k: usize| at[k] < -reach[k] || at[k] > T::ONE + reach[k];
    if passes_by(0) || passes_by(1) {
        return Cover::Outside;
    }
    // Also where the window closes in itself: beyond a seam the tree goes on at the other end.
    let is_near_end = |k: usize| at[k] < reach[k] || at[k] > T::ONE - reach[k];
    let clamped = |uv: [T; 2]| uv.map(|x| x.max(T::ZERO).min(T::ONE));
    let in_window = |uv: [T; 2]| (0..2).all(|k| uv[k] >= -margin[k] && uv[k] <= T::ONE + margin[k]);
    let center = trim_point(scene, face.trim_root, clamped(at), extent, tally);
    let is_inside = center.inside && in_window(at);
    if !(center.is_near || is_near_end(0) || is_near_end(1)) {
        return if is_inside { Cover::Inside } else { Cover::Outside };
    }
    if face.flags & Face::ALONE != 0 {
        return if is_inside { Cover::Border } else { Cover::Outside };
    }
    let sides = sides();
    let mut belongs = |side: usize| {
        let [u, v] = footprint.place(at, sides, side);
        let place = [to_window(u, period[0]), to_window(v, period[1])];
        in_window(place) && trim_inside_tallied(scene, face.trim_root, clamped(place), tally)
    };
    match is_inside {
        true if (0..4).all(&mut belongs) => Cover::Near,
        true => Cover::Border,
        false if (0..4).any(&mut belongs) => Cover::Border,
        false => Cover::Outside,
    }
}

/// What four roundings of `low · scale`, which a normalised parameter was measured from, make of it.
#[inline]
pub fn window_margin<T: Real>(low: T, scale: T) -> T {
    number::<T>(4.0) * T::EPSILON * (low * scale).abs()
}
