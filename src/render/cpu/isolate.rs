//! Where in a leaf of a net Newton's method is to start, cell by cell of a quadtree, from the whole leaf down (after Srijuntongsiri and
//! Vavasis 2007).
//!
//! In a cell of half width r about a point with plane values F and derivatives J (by the leaf's own parameters), S is linear up to
//! `½ B r²` with B a bound of `|S_ss| + 2 |S_st| + |S_tt|`. A combination `w · F` of the planes is `n · S` with `n = (w, −w · slope)`, so a root
//! needs `|w · F| <= |w · J| r + |n| ½ B r²` for every w: for both planes, and for both rows of J⁻¹, the Newton step.
//!
//! Let `K = B max |n|` over the rows of J⁻¹, and η the step. J⁻¹ J is off the identity by at most K r in the cell, so `K r < 1` leaves room for one root,
//! at a distance e from the middle of r at most. `K η < ½` is Kantorovich's condition, under which Newton's method does not fail:
//! after the first step `½ K e² <= ½ e` is left, and the derivative's inverse has at most doubled. Both are asked for with a tenth to spare.

use super::bernstein::NetJet;
use super::net::{Domain, LeafRay};
use super::planes::plane_values;
use super::vector::{Vector3, number};
use crate::numeric::Real;
use crate::scene::bend_bound;

/// Quarterings of a leaf, and cells looked at in one: near tangents would go on for ever.
const MAX_ISOLATION_LEVEL: u32 = 8;
pub const MAX_ISOLATION_CELLS: u32 = 4096;

/// A square of a leaf's domain, of side 2^-level.
#[derive(Debug, Clone, Copy, Default)]
pub struct Cell {
    /// Quarterings.
    pub level: u32,
    /// Along u and v, in sides.
    pub place: [u32; 2],
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
        /// Whether it cannot fail and the cell is large enough to say so of the leaf.
        unique: bool,
    },
    /// That its quarters are looked at instead.
    Split,
}

impl Cell {
    /// The first quarter.
    pub fn first_quarter(self) -> Self {
        Self { level: self.level + 1, place: self.place.map(|x| 2 * x) }
    }

    /// The next of four, or of the parent's four.
    pub fn next_cell(self) -> Option<Self> {
        let Self { mut level, mut place } = self;
        while level > 0 && place[0] & place[1] & 1 == 1 {
            level -= 1;
            place = place.map(|x| x >> 1);
        }
        place = if place[0] & 1 == 0 { [place[0] + 1, place[1]] } else { [place[0] - 1, place[1] + 1] };
        (level > 0).then_some(Self { level, place })
    }

    /// Whether the net ends at one of its sides: a root may lie beyond that, by the slack.
    pub fn is_at_end<T: Real>(self, domain: &Domain<T>) -> bool {
        let last = (1 << self.level) - 1;
        (0..2).any(|k| {
            self.place[k] == 0 && domain.low[k] == T::ZERO
                || self.place[k] == last && domain.low[k] + domain.size[k] == T::ONE
        })
    }

    /// Half the side.
    pub fn cell_radius<T: Real>(self) -> T {
        number::<T>(0.5) / T::from_f32((1_u32 << self.level) as f32)
    }

    /// The middle, in local parameters.
    pub fn cell_center<T: Real>(self, at: &LeafRay<'_, T>) -> [T; 2] {
        let radius = self.cell_radius::<T>();
        let middle = |k: usize| {
            at.domain.low[k] + at.domain.size[k] * (T::from_f32((2 * self.place[k] + 1) as f32) * radius)
        };
        [middle(0), middle(1)]
    }
}

/// Looks at a cell, at whose middle the net has the value and the derivatives of `jet`.
pub fn examine<T: Real>(jet: &NetJet<T>, at: &LeafRay<'_, T>, cell: Cell) -> Verdict<T> {
    let NetJet { value, by_u, by_v } = jet;
    let planes = &at.planes;
    let a = Vector3::<T>::from_f32(at.leaf.tangent_u);
    let b = Vector3::<T>::from_f32(at.leaf.tangent_v);
    let bend = T::from_f32(bend_bound(at.leaf.certificate >> 24)) * a.length().min(b.length());
    let norm = |w: [T; 2]| {
        let along = w[0] * planes.slope[0] + w[1] * planes.slope[1];
        (w[0] * w[0] + w[1] * w[1] + along * along).sqrt()
    };
    let plane_norms = [norm([T::ONE, T::ZERO]), norm([T::ZERO, T::ONE])];
    let center = Vector3::<T>::from_f32(at.leaf.center);
    let size = center.greatest() + at.ray.origin.greatest() + a.greatest() + b.greatest();
    let rounding = size * number::<T>(32.0) * T::EPSILON;
    let scale = T::ONE / value[3];
    let f = plane_values(planes, *value).map(|x| x * scale);
    let slopes = |derivative: [T; 4], size: T| {
        let d = plane_values(planes, derivative);
        [0, 1].map(|k| (d[k] - f[k] * derivative[3]) * scale * size)
    };
    let (f_s, f_t) = (slopes(*by_u, at.domain.size[0]), slopes(*by_v, at.domain.size[1]));
    // A little more than the cell, so that roots on its edges are in it.
    let reach = cell.cell_radius::<T>() * number(1.0 + 1.0 / 64.0);
    let beyond = if cell.is_at_end(&at.domain) { at.slack } else { T::ZERO };
    let remainder = bend * number(0.5) * reach * reach + rounding + beyond;
    let determinant = f_s[0] * f_t[1] - f_s[1] * f_t[0];
    let step = [f[0] * f_t[1] - f[1] * f_t[0], f_s[0] * f[1] - f_s[1] * f[0]];
    let rows = [norm([f_t[1], -f_t[0]]), norm([-f_s[1], f_s[0]])];
    let room = reach * determinant.abs();
    let misses = |k: usize| {
        f[k].abs() > (f_s[k].abs() + f_t[k].abs()) * reach + plane_norms[k] * remainder
            || step[k].abs() > room + rows[k] * remainder
    };
    if misses(0) || misses(1) {
        return Verdict::Empty;
    }
    let curving = rows[0].max(rows[1]) * bend;
    let longest = step[0].abs().max(step[1].abs());
    let is_regular = curving * reach < number::<T>(0.9) * determinant.abs()
        && curving * (longest / determinant.abs()) < number::<T>(0.45) * determinant.abs();
    let middle = cell.cell_center(at);
    if is_regular {
        let start = [0, 1].map(|k| middle[k] - step[k] / determinant * at.domain.size[k]);
        Verdict::Search { start, unique: cell.level <= 2 }
    } else if cell.level < MAX_ISOLATION_LEVEL {
        Verdict::Split
    } else {
        Verdict::Search { start: middle, unique: false }
    }
}
