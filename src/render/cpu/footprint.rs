//! What a ray as wide as a face's slack covers of the face's parameters.
//!
//! A face's border is known within its slack, measured beside the ray: across the ray both the errors of hits and the gaps between faces
//! stay small, while along the surface they grow without bound as the ray gets tangent. A hit therefore counts where any of four places belongs
//! to the face at which the surface, taken as flat, meets a ray moved sideways by the slack. All faces of a part are tried in the
//! same directions: where two of them meet, each place is the one's or the other's, so that no ray slips between.

use super::vector::{Vector3, number, vec3};
use crate::numeric::{Eight, Mask, Number, Real};

/// |cos| of the angle between ray and normal below which two hits may always be found as one or not at all (cells of the last level of a leaf's
/// quadtree are 1/256 of it, and the leaf bends by an eighth of its size).
pub const GRAZING: f64 = 1.0 / 1024.0;

/// A ray that goes this many slacks deep into a curved surface may pass it by.
const SHALLOW: f64 = 4.0;

/// No footprint is longer than this many slacks: nearer to a tangent the surface's bend ends it.
pub const LONGEST: f64 = 4096.0;

/// How the surface's parameters change with a ray that is moved sideways by the slack.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Footprint<T: Number> {
    /// Of u and of v, at right angles to the ray: a ray moved by the slack in the direction o meets the surface at the product with o away.
    pub slopes: [Vector3<T>; 2],
    /// Of the angle between the ray and `S_u × S_v`; 0 where that is not known.
    pub cosine: T,
    /// Whether the ray is too near to a tangent to be sure how often it meets the surface here.
    pub is_grazing: T::Mask,
}

impl<T: Number> Footprint<T> {
    /// `yes` where the mask holds, `no` elsewhere.
    #[inline(always)]
    pub fn choose(mask: T::Mask, yes: Self, no: Self) -> Self {
        let vector = |yes: Vector3<T>, no: Vector3<T>| {
            vec3(T::choose(mask, yes.x, no.x), T::choose(mask, yes.y, no.y), T::choose(mask, yes.z, no.z))
        };
        Self {
            slopes: [0, 1].map(|k| vector(yes.slopes[k], no.slopes[k])),
            cosine: T::choose(mask, yes.cosine, no.cosine),
            is_grazing: mask & yes.is_grazing | !mask & no.is_grazing,
        }
    }

    /// In parameters that are `scale` times as great.
    pub fn scaled(self, scale: [T; 2]) -> Self {
        let [by_u, by_v] = self.slopes;
        Self { slopes: [by_u * scale[0], by_v * scale[1]], ..self }
    }

    /// Half the sides of the box around the places at all sides of the ray; at most a quarter of the unit of parameters.
    pub fn extent(self) -> [T; 2] {
        let quarter = number::<T>(0.25);
        self.slopes.map(|slope| {
            let extent = slope.length();
            T::choose(extent.is_less(quarter), extent, quarter)
        })
    }

    /// The place `side` of four around `uv`; `sides` are those of the ray's direction.
    pub fn place(self, uv: [T; 2], sides: [Vector3<T>; 2], side: usize) -> [T; 2] {
        let [u, v] = self.slopes.map(|slope| slope.dot(sides[side >> 1]));
        if side & 1 == 0 { [uv[0] + u, uv[1] + v] } else { [uv[0] - u, uv[1] - v] }
    }
}

impl Footprint<Eight> {
    /// One of the eight footprints.
    pub fn lane(self, lane: usize) -> Footprint<f32> {
        Footprint {
            slopes: self.slopes.map(|slope| slope.lane(lane)),
            cosine: self.cosine.to_array()[lane],
            is_grazing: self.is_grazing.bits() >> lane & 1 == 1,
        }
    }
}

/// Two unit vectors at right angles to `direction` and to each other (Duff et al. 2017, "Building an Orthonormal Basis, Revisited").
pub fn sides<T: Number>(direction: Vector3<T>) -> [Vector3<T>; 2] {
    let d = direction * (T::ONE / direction.length());
    let sign = T::choose(d.z.is_less(T::ZERO), -T::ONE, T::ONE);
    let a = -T::ONE / (sign + d.z);
    let b = d.x * d.y * a;
    [vec3(T::ONE + sign * d.x * d.x * a, sign * b, -sign * d.x), vec3(b, sign + d.y * d.y * a, -d.y)]
}

/// The footprint where a ray of any length of `direction` meets a surface with the tangents `s_u` and `s_v` and a normal curvature of at most
/// `curvature`.
#[inline(always)]
pub fn footprint<T: Number>(
    direction: Vector3<T>,
    s_u: Vector3<T>,
    s_v: Vector3<T>,
    curvature: T,
    slack: T,
) -> Footprint<T> {
    // A ray moved by o meets the surface at s_u du + s_v dv = o + d dt: products with s_v × d and d × s_u leave du and dv.
    let normal = s_u.cross(s_v);
    let determinant = direction.dot(normal);
    let steepness = direction.length() * normal.length();
    // At an angle with this cosine a ray goes cos² / (2 curvature) deep.
    let facing = determinant / steepness;
    let cosine = facing.abs();
    let is_deep = (number::<T>(2.0 * SHALLOW) * curvature * slack).is_less(cosine * cosine);
    let is_grazing = !(number::<T>(GRAZING).is_less(cosine) & is_deep);
    let (by_u, by_v) = (s_v.cross(direction), direction.cross(s_u));
    let least = steepness * number(1.0 / LONGEST);
    let share = slack / T::choose(number::<T>(1.0 / LONGEST).is_less(cosine), determinant, least);
    Footprint { slopes: [by_u * share, by_v * share], cosine: facing, is_grazing }
}

/// The footprint at a pole, which takes in all of the way around; `axis` is the parameter that leads away from it, with the tangent `across`. Of the ray's two
/// sides the one and the other lie a quarter of the unit along the pole, one of them away from it and one beyond it.
pub fn pole_footprint<T: Number>(
    axis: usize,
    [first, second]: [Vector3<T>; 2],
    across: Vector3<T>,
    slack: T,
) -> Footprint<T> {
    let off = (first - second) * (slack / across.length());
    let around = (first + second) * number(0.25);
    let slopes = if axis == 0 { [off, around] } else { [around, off] };
    Footprint { slopes, cosine: T::ZERO, is_grazing: Mask::everywhere(true) }
}

/// Whether two hits of one face, `apart` along the ray, are at one place as far as the face's slack tells, and from one side. The cosines are those of the ray
/// with the normals: between two points of a sheet at most a slack beside the ray it rises by their mean on the way.
#[inline]
pub fn same_place<T: Real>(apart: T, first: T, second: T, slack: T) -> bool {
    let steepness = ((first.abs() + second.abs()) * number(0.5)).max(number(1.0 / LONGEST));
    first * second >= T::ZERO && apart * steepness <= slack * number(2.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_are_at_right_angles() {
        for d in [[0.0, 0.0, 1.0], [0.0, 0.0, -2.0], [1.0, 2.0, -2.0], [-3.0, 0.5, 0.0]] {
            let d = Vector3::<f64>::from_f64(d);
            let [a, b] = sides(d);
            for (x, y) in [(a, d), (b, d), (a, b)] {
                assert!(x.dot(y).abs() < 1e-15);
            }
            assert!((a.length() - 1.0).abs() < 1e-15 && (b.length() - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn places_are_where_moved_rays_meet_the_plane() {
        let (s_u, s_v) = (Vector3::<f64>::from_f64([2.0, 0.0, 0.5]), Vector3::from_f64([1.0, 3.0, 0.0]));
        let d = Vector3::from_f64([0.3, -0.2, 4.0]);
        let o = sides(d);
        let found = footprint(d, s_u, s_v, 0.0, 0.25);
        assert!(!found.is_grazing);
        for side in 0..4 {
            let [u, v] = found.place([0.0; 2], o, side);
            let moved = o[side >> 1] * (if side & 1 == 0 { 0.25 } else { -0.25 });
            let off = s_u * u + s_v * v - moved;
            assert!(off.cross(d).length() < 1e-14 * d.length(), "{off:?}");
        }
        // However the sides are turned about the ray, the farthest place is at the extent.
        let reach = |turn: f64| {
            let side = o[0] * turn.cos() + o[1] * turn.sin();
            found.slopes.map(|slope| slope.dot(side))
        };
        let farthest = |k: usize| (0..1000).map(|i| reach(f64::from(i) * 0.00628)[k]).fold(0.0, f64::max);
        for k in 0..2 {
            assert!((farthest(k) - found.extent()[k]).abs() < 1e-5 * farthest(k), "{k}");
        }
        let along = footprint(s_u + s_v, s_u, s_v, 0.0, 0.25);
        assert!(along.is_grazing && along.extent().iter().all(|e| e.is_finite()));
        assert!(along.cosine.abs() < 1e-12 && found.cosine > 0.9);
    }

    #[test]
    fn places_at_a_pole_lie_around_it_on_both_sides() {
        let (d, across) = (Vector3::<f64>::from_f64([0.1, 0.2, 1.0]), Vector3::from_f64([2.0, 0.0, 0.0]));
        let o = sides(d);
        let at_pole = pole_footprint(0, o, across, 0.5);
        let expected = [[0.25, 0.75], [-0.25, 0.25], [-0.25, 0.75], [0.25, 0.25]];
        for (side, expected) in expected.into_iter().enumerate() {
            let place = at_pole.place([0.0, 0.5], o, side);
            assert!((0..2).all(|k| (place[k] - expected[k]).abs() < 1e-15), "{side}: {place:?}");
        }
    }

    #[test]
    fn places_are_the_same_within_the_slack_and_from_one_side() {
        for (apart, first, second, expected) in [
            (1.9, 1.0, 1.0, true),
            (2.1, 1.0, 1.0, false),
            (3.9, 0.0, 1.0, true),
            (1.9, 1.0, -1.0, false),
            (8000.0, 1e-9, 1e-9, true),
            (8400.0, 1e-9, 1e-9, false),
        ] {
            assert_eq!(same_place(apart, first, second, 1.0), expected, "{apart} {first} {second}");
        }
    }
}
