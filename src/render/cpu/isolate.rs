//! Where in a leaf of a net Newton's method is to start, cell by cell of a quadtree, from the whole leaf down (after Srijuntongsiri and
//! Vavasis 2007).
//!
//! In units of a cell's half sides the cell is the square [−1, 1]². With F and J the plane values and their derivatives at its middle, S is linear
//! up to `½ B`, B a bound of `|S_ss| + 2 |S_st| + |S_tt|` there. A combination `w · F` of the planes is `n · S` with `n = (w, −w · slope)`, so a
//! root needs `|w · F| <= |w · J| + |n| ½ B` for every w: for both planes, and for both rows of J⁻¹, the Newton step.
//!
//! Let `K = B max |n|` over the rows of J⁻¹, and η the step. J⁻¹ J is off the identity by at most K in the cell, so `K < 1` leaves room for one root,
//! at a distance e from the middle of 1 at most. `K η < ½` is Kantorovich's condition, under which Newton's method does not fail:
//! after the first step `½ K e² <= ½ e` is left, and the derivative's inverse has at most doubled. Both are asked for with a tenth to spare.
//!
//! Of a cell that is quartered only those quarters are looked at that these inequalities, with the cell's own planes and remainder and the quarter's
//! sides, leave open.
//!
//! At the net's end roots may lie beyond a cell by the face's slack, which leaves cells open that are smaller than that: they are not quartered either.
//!
//! A leaf has one bound M of the second derivatives by its own parameters, so that `B = M r²` in a square cell of half side r.
//!
//! **Poles.** Where a side of the net is one point P, every cell at that side holds P, and quarters of them would be looked at by the hundred. There
//! only the direction that leads away from the pole is halved: the leaf falls into bands [τ, 2τ] along the side, which are as much like a square
//! as their images, and quartered from then on; and into what is left at the pole, which gets one search once its image is not much larger than the slack.
//! In a band S_ss along the side is small: the side's control points are equal, so that with n the degree across,
//! `S − P = Σ_{j > 0} Bⱼⁿ(τ) …` and all that is derived from it along the side are at most `1 − B₀ⁿ(τ) <= n τ` of their bounds, which the bake takes about P.
//! `B = M max(n τ r_s², r_s r_t, r_t²)` follows.

use super::bernstein::{NetJet, net_degrees};
use super::leaf::{Domain, LeafRay, Pole, leaf_bend};
use super::newton::newton_fraction;
use super::planes::{plane_jet, plane_norm};
use super::vector::{Vector3, number};
use crate::numeric::Real;

/// Quarterings of a leaf, and cells looked at in one: near tangents would go on for ever.
const MAX_ISOLATION_LEVEL: u32 = 8;
pub const MAX_ISOLATION_CELLS: u32 = 4096;

/// Half the side of a quarter in half sides of its cell, and a sixty-fourth more: quarters overlap by more than what they are looked at beyond their sides.
const QUARTER: f64 = 0.5 + 1.0 / 64.0;

/// Cells at the net's end that are smaller than this share of the slack are not quartered: their parts at the end would all be left open by it, and a search from
/// the middle finds what lies within half of it.
const WITHIN_SLACK: f64 = 0.25;

/// Halvings towards a pole: the slack is at least 2⁻²¹ of the net.
const MAX_POLE_LEVEL: u32 = 21;

/// A rectangle of a leaf's domain, of sides 2^-level.
#[derive(Debug, Clone, Copy, Default)]
pub struct Cell {
    /// Halvings along u and v. They differ by those towards a pole, which come first.
    pub level: [u32; 2],
    /// Along u and v, in sides.
    pub place: [u32; 2],
    /// Of each quartering that led here, four bits from the lowest on: the quarters that may hold a root.
    pub quarters: u32,
}

/// What a cell asks for.
#[derive(Debug, Clone, Copy)]
pub enum Verdict<T> {
    /// Nothing: no root is in it.
    Empty,
    /// A search.
    Search {
        /// Where it starts.
        start: [T; 2],
        /// How sure it is.
        kind: SearchKind,
        /// How far the cell reaches from a pole that it holds, in sides of the leaf; 1 where it holds none.
        across: T,
    },
    /// That its parts are looked at instead: those quarters whose bits are set, at a pole both halves.
    Split(u32),
}

/// How sure a search is to end at a root.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SearchKind {
    /// The leaf has one root at most, and Newton's method finds it.
    Unique,
    /// So it is with a small cell of the leaf.
    Regular,
    /// Nothing is known.
    Open,
}

impl Cell {
    /// Whether it is one of the halves that hold the pole.
    fn is_at_pole(self, pole: Pole) -> bool {
        let last = if pole.is_high { (1 << self.level[pole.axis]) - 1 } else { 0 };
        pole.exists && self.level[1 - pole.axis] == 0 && self.place[pole.axis] == last
    }

    /// The first of the quarters that may hold a root, of which there is one at least, or at the pole the first half.
    pub fn first_part(self, pole: Pole, quarters: u32) -> Self {
        let Self { mut level, mut place, .. } = self;
        if self.is_at_pole(pole) {
            level[pole.axis] += 1;
            place[pole.axis] <<= 1;
            return Self { level, place, ..self };
        }
        let shift = 4 * level[1 - pole.axis];
        let first = quarters.trailing_zeros();
        Self {
            level: level.map(|x| x + 1),
            place: [place[0] << 1 | first & 1, place[1] << 1 | first >> 1],
            quarters: self.quarters & !(15 << shift) | quarters << shift,
        }
    }

    /// The next of four that may hold a root, or of the parent's four, and so on; of two where the parent holds the pole.
    pub fn next_cell(self, pole: Pole) -> Option<Self> {
        let Self { mut level, mut place, quarters } = self;
        while level[1 - pole.axis] > 0 {
            let this = place[0] & 1 | (place[1] & 1) << 1;
            let next = quarters >> (4 * (level[1 - pole.axis] - 1)) & 15 & !((2 << this) - 1);
            if next != 0 {
                let first = next.trailing_zeros();
                place = [place[0] & !1 | first & 1, place[1] & !1 | first >> 1];
                return Some(Self { level, place, quarters });
            }
            level = level.map(|x| x - 1);
            place = place.map(|x| x >> 1);
        }
        while level[pole.axis] > 0 && place[pole.axis] & 1 == 1 {
            level[pole.axis] -= 1;
            place[pole.axis] >>= 1;
        }
        place[pole.axis] += 1;
        (level[pole.axis] > 0).then_some(Self { level, place, quarters })
    }

    /// Whether the net ends at one of its sides: a root may lie beyond that, by the slack.
    pub fn is_at_end<T: Real>(self, domain: &Domain<T>) -> bool {
        (0..2).any(|k| {
            self.place[k] == 0 && domain.low[k] == T::ZERO
                || self.place[k] == (1 << self.level[k]) - 1 && domain.low[k] + domain.size[k] == T::ONE
        })
    }

    /// Half the sides, in sides of the leaf.
    pub fn cell_radius<T: Real>(self) -> [T; 2] {
        self.level.map(|level| number::<T>(0.5) / T::from_f32((1_u32 << level) as f32))
    }

    /// The middle, in local parameters.
    pub fn cell_center<T: Real>(self, at: &LeafRay<'_, T>) -> [T; 2] {
        let radius = self.cell_radius::<T>();
        let middle = |k: usize| {
            at.domain.low[k] + at.domain.size[k] * (number::<T>(f64::from(2 * self.place[k] + 1)) * radius[k])
        };
        [middle(0), middle(1)]
    }

    /// The greatest product of two half sides that second derivatives are to be multiplied with, `reach` being half the sides.
    fn bend_area<T: Real>(self, at: &LeafRay<'_, T>, reach: [T; 2]) -> T {
        let Pole { axis, exists, is_high } = at.pole;
        let (across, along) = (reach[axis], reach[1 - axis]);
        let share = if exists {
            let count = 1 << self.level[axis];
            let steps = if is_high { count - self.place[axis] } else { self.place[axis] + 1 };
            // A cell farther than the farthest point, for Newton's steps.
            bend_at_pole(at, T::from_f32((steps + 1) as f32) / T::from_f32(count as f32))
        } else {
            T::ONE
        };
        (share * along * along).max(across * along).max(across * across)
    }
}

/// The share of the bound of second derivatives along a pole's side that holds as far as `across` from it, in sides of the leaf.
#[inline]
pub fn bend_at_pole<T: Real>(at: &LeafRay<'_, T>, across: T) -> T {
    let (degree_u, degree_v) = net_degrees(at.net);
    T::ONE.min(T::from_f32([degree_u, degree_v][at.pole.axis] as f32) * across)
}

/// What all cells of a leaf have in common (on a GPU each finds it anew: it would take registers).
#[derive(Debug, Clone, Copy)]
pub struct LeafBounds<T> {
    /// Of the second derivatives, see [`leaf_bend`].
    bend: T,
    /// How long the vectors of the two planes are.
    plane_norms: [T; 2],
    /// Of plane values.
    rounding: T,
}

/// The bounds of a leaf.
pub fn leaf_bounds<T: Real>(at: &LeafRay<'_, T>) -> LeafBounds<T> {
    let a = Vector3::<T>::from_f32(at.leaf.tangent_u);
    let b = Vector3::<T>::from_f32(at.leaf.tangent_v);
    let center = Vector3::<T>::from_f32(at.leaf.center);
    let size = center.greatest() + at.ray.origin.greatest() + a.greatest() + b.greatest();
    LeafBounds {
        bend: leaf_bend(at.leaf),
        plane_norms: [[T::ONE, T::ZERO], [T::ZERO, T::ONE]].map(|plane| plane_norm(&at.planes, plane)),
        rounding: size * number::<T>(32.0) * T::EPSILON,
    }
}

/// Whether a cell at the net's end, of half sides `reach`, is smaller than [`WITHIN_SLACK`] of what roots may lie `beyond` it. A tangent is nowhere farther from
/// the leaf's mean than half the bound `bend` of second derivatives.
#[inline]
fn is_within_slack<T: Real>(at: &LeafRay<'_, T>, bend: T, reach: [T; 2], beyond: T) -> bool {
    let side = |tangent: [f32; 3], reach: T| {
        let longest = Vector3::<T>::from_f32(tangent).length() + bend * number(0.5);
        longest * (reach + reach)
    };
    side(at.leaf.tangent_u, reach[0]).max(side(at.leaf.tangent_v, reach[1])) < beyond * number(WITHIN_SLACK)
}

/// Looks at a cell, at whose middle the net has the value and the derivatives of `jet`.
pub fn examine<T: Real>(
    jet: &NetJet<T>,
    at: &LeafRay<'_, T>,
    bounds: &LeafBounds<T>,
    cell: Cell,
) -> Verdict<T> {
    let planes = &at.planes;
    let &LeafBounds { bend, plane_norms, rounding } = bounds;
    // A little more than the cell, so that roots on its edges are in it.
    let reach = cell.cell_radius::<T>().map(|radius| radius * number(1.0 + 1.0 / 64.0));
    let [f, f_s, f_t] = plane_jet(planes, jet, [0, 1].map(|k| at.domain.size[k] * reach[k]));
    let beyond = if cell.is_at_end(&at.domain) { at.slack } else { T::ZERO };
    let curving = bend * cell.bend_area(at, reach);
    let remainder = curving * number(0.5) + rounding + beyond;
    let (determinant, step) = newton_fraction([f, f_s, f_t]);
    let rows = [plane_norm(planes, [f_t[1], -f_t[0]]), plane_norm(planes, [-f_s[1], f_s[0]])];
    let misses = |k: usize| {
        f[k].abs() > f_s[k].abs() + f_t[k].abs() + plane_norms[k] * remainder
            || step[k].abs() > determinant.abs() + rows[k] * remainder
    };
    if misses(0) || misses(1) {
        return Verdict::Empty;
    }
    let middle = cell.cell_center(at);
    if cell.is_at_pole(at.pole) {
        let axis = at.pole.axis;
        let across = reach[axis] + reach[axis];
        // In bands that are not eight times as wide as what is left open the quarters could not be told apart.
        let tangent = [at.leaf.tangent_u, at.leaf.tangent_v][axis];
        let is_small =
            Vector3::<T>::from_f32(tangent).length() * across <= (at.slack + rounding) * number(8.0);
        return if is_small || cell.level[axis] == MAX_POLE_LEVEL {
            Verdict::Search { start: middle, kind: SearchKind::Open, across }
        } else {
            Verdict::Split(0)
        };
    }
    let turning = rows[0].max(rows[1]) * curving;
    let longest = step[0].abs().max(step[1].abs());
    let is_regular = turning < number::<T>(0.9) * determinant.abs()
        && turning * (longest / determinant.abs()) < number::<T>(0.45) * determinant.abs();
    if is_regular {
        let start = [0, 1].map(|k| middle[k] - step[k] / determinant * (at.domain.size[k] * reach[k]));
        let is_large = cell.level[0].max(cell.level[1]) <= 2;
        let kind = if is_large { SearchKind::Unique } else { SearchKind::Regular };
        Verdict::Search { start, kind, across: T::ONE }
    } else if cell.level[1 - at.pole.axis] < MAX_ISOLATION_LEVEL && !is_within_slack(at, bend, reach, beyond)
    {
        let is_empty = |quarter: u32| {
            let side = [0, 1].map(|k| if quarter >> k & 1 == 1 { T::ONE } else { -T::ONE });
            (0..2).any(|k| {
                let value = f[k] + (f_s[k] * side[0] + f_t[k] * side[1]) * number(0.5);
                let off = step[k] + determinant * side[k] * number(0.5);
                value.abs() > (f_s[k].abs() + f_t[k].abs()) * number(QUARTER) + plane_norms[k] * remainder
                    || off.abs() > determinant.abs() * number(QUARTER) + rows[k] * remainder
            })
        };
        match (0..4).filter(|&quarter| !is_empty(quarter)).fold(0, |found, quarter| found | 1 << quarter) {
            0 => Verdict::Empty,
            quarters => Verdict::Split(quarters),
        }
    } else {
        Verdict::Search { start: middle, kind: SearchKind::Open, across: T::ONE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NO_POLE: Pole = Pole { axis: 0, exists: false, is_high: false };

    #[test]
    fn quarters_that_may_hold_a_root_come_in_turn_and_no_others() {
        // The whole leaf's second and fourth quarter, and of the second its first and third.
        let second = Cell::default().first_part(NO_POLE, 0b1010);
        assert_eq!((second.level, second.place), ([1, 1], [1, 0]));
        let first = second.first_part(NO_POLE, 0b0101);
        assert_eq!((first.level, first.place), ([2, 2], [2, 0]));
        let third = first.next_cell(NO_POLE).expect("a quarter");
        assert_eq!((third.level, third.place), ([2, 2], [2, 1]));
        let fourth = third.next_cell(NO_POLE).expect("a quarter");
        assert_eq!((fourth.level, fourth.place), ([1, 1], [1, 1]));
        assert!(fourth.next_cell(NO_POLE).is_none());
    }

    #[test]
    fn all_quarters_fill_the_leaf() {
        let mut cell = Cell::default();
        for _ in 0..MAX_ISOLATION_LEVEL {
            cell = cell.first_part(NO_POLE, 0b1111);
        }
        let mut area = 0.0;
        let mut next = Some(cell);
        while let Some(cell) = next {
            area += 0.25_f64.powi(cell.level[0] as i32);
            next = cell.next_cell(NO_POLE);
        }
        assert!((area - 1.0).abs() < 1e-12, "{area}");
    }
}
