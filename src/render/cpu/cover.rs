//! Whether a hit belongs to a face: the trim window and the trim tree, each as wide as the hit's footprint.

use super::footprint::Footprint;
use super::tally::Tally;
use super::trim::{trim_inside_tallied, trim_point};
use super::vector::{Vector3, number};
use crate::numeric::{Mask, Number, Real};
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
#[inline(always)]
pub fn to_window<T: Number>(parameter: T, period: T) -> T {
    let is_periodic = T::ZERO.is_less(period);
    if !is_periodic.any() {
        return parameter;
    }
    let p = parameter - (parameter / period).floor() * period;
    let is_nearer_before = T::ONE.is_less(p) & (period - p).is_less(p - T::ONE);
    T::choose(is_periodic, T::choose(is_nearer_before, p - period, p), parameter)
}

/// Whether a place is outside of the window whatever the footprint, which reaches a quarter of the window at most.
#[inline(always)]
pub fn is_far_outside<T: Number>(uv: [T; 2]) -> T::Mask {
    let half = number::<T>(0.5);
    let [u, v] = uv.map(|x| (-half).is_less(x) & x.is_less(T::ONE + half));
    !(u & v)
}

/// Where a hit lies in its face's window, and how far around it the window and the trims are of account.
#[derive(Debug, Clone, Copy)]
pub struct Place<T> {
    /// Normalised parameters, wrapped.
    pub at: [T; 2],
    /// What they are rounded by, at most.
    pub margin: [T; 2],
    /// Half the sides of the box around the footprint.
    pub extent: [T; 2],
}

impl<T: Number> Place<T> {
    /// Whether the window passes by.
    #[inline(always)]
    pub fn is_outside(&self) -> T::Mask {
        let [u, v] = [0, 1].map(|k| {
            let reach = self.extent[k] + self.margin[k];
            self.at[k].is_less(-reach) | (T::ONE + reach).is_less(self.at[k])
        });
        u | v
    }
}

/// How a hit at a place that is not [outside](Place::is_outside) lies to a face. `footprint` tells its footprint and the sides of the ray's direction, in
/// the space of the footprint: they are needed near borders alone.
#[inline]
pub fn cover<T: Real>(
    scene: &Scene<'_>,
    face: &Face,
    period: [T; 2],
    place: &Place<T>,
    footprint: impl FnOnce() -> (Footprint<T>, [Vector3<T>; 2]),
    tally: &mut impl Tally,
) -> Cover {
    let &Place { at, margin, extent } = place;
    let reach = [extent[0] + margin[0], extent[1] + margin[1]];
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
    let (footprint, sides) = footprint();
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
#[inline(always)]
pub fn window_margin<T: Number>(low: T, scale: T) -> T {
    number::<T>(4.0) * T::EPSILON * (low * scale).abs()
}
