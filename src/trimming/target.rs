//! The surface onto which edges are taken, with what every step needs to know about it.

use super::TrimError;
use super::pole::{Pole, poles};
use crate::brep::Id;
use crate::geometry::{ParameterBox, Surface, invert_surface};
use glam::{DVec2, DVec3};

/// An edge may lie off its surface by this share of the face's size. Most files are off by less than 1e-3 of it, small
/// faces of bad ones by up to 4e-2; an edge that is farther away belongs to another surface.
pub(super) const OFF_SURFACE: f64 = 5e-2;

/// A surface, its parameter plane, and the tolerances of one face.
pub(super) struct Target<'a> {
    pub(super) id: Id<Surface>,
    pub(super) surface: &'a Surface,
    pub(super) periods: [Option<f64>; 2],
    pub(super) domain: ParameterBox,
    pub(super) poles: Vec<Pole>,
    /// Greatest distance in space between an edge and its image, millimetres.
    pub(super) tolerance: f64,
    /// Diagonal of the box around the face's edges, millimetres.
    pub(super) size: f64,
}

/// The point of the surface under a point of an edge.
#[derive(Clone, Copy)]
pub(super) struct Foot {
    pub(super) uv: DVec2,
    pub(super) distance: f64,
}

impl<'a> Target<'a> {
    pub(super) fn new(
        id: Id<Surface>,
        surface: &'a Surface,
        relative_tolerance: f64,
        size: f64,
        magnitude: f64,
    ) -> Self {
        // No image can be closer than the rounding of coordinates of this magnitude, some 100 roundings of 2⁻⁵³.
        let tolerance = (relative_tolerance * size).max(1e-14 * magnitude);
        Self {
            id,
            surface,
            periods: surface.periods(),
            domain: surface.domain(),
            poles: poles(surface),
            tolerance,
            size,
        }
    }

    /// How close to a pole a point must be to be the pole.
    pub(super) fn pole_tolerance(&self) -> f64 {
        (1e-6 * self.size).max(2.0 * self.tolerance)
    }

    /// The pole at `point`.
    pub(super) fn pole_at(&self, point: DVec3) -> Option<usize> {
        let distance = |pole: &Pole| pole.point.distance(point);
        (0..self.poles.len())
            .filter(|&i| distance(&self.poles[i]) <= self.pole_tolerance() + 2.0 * self.poles[i].radius)
            .min_by(|&a, &b| distance(&self.poles[a]).total_cmp(&distance(&self.poles[b])))
    }

    /// The value of the pole's constant parameter that is nearest to `near`: whole periods apart where it wraps.
    pub(super) fn pole_value(&self, pole: usize, near: f64) -> f64 {
        let Pole { axis, value, .. } = self.poles[pole];
        value + self.periods[axis].map_or(0.0, |period| ((near - value) / period).round() * period)
    }

    /// Whether two poles are one point in space: the two of a spindle torus that is almost a horn torus are.
    pub(super) fn is_same_pole(&self, a: usize, b: usize) -> bool {
        let (first, second) = (&self.poles[a], &self.poles[b]);
        a == b
            || (first.axis == second.axis
                && first.point.distance(second.point) <= 2.0 * self.pole_tolerance())
    }

    /// The whole periods that bring `from` nearest to `to`.
    pub(super) fn nearest_shift(&self, from: DVec2, to: DVec2) -> DVec2 {
        let along =
            |axis: usize| self.periods[axis].map_or(0.0, |p| ((to[axis] - from[axis]) / p).round() * p);
        DVec2::new(along(0), along(1))
    }

    /// `uv` moved into the domain along parameters that do not wrap.
    pub(super) fn clamped(&self, mut uv: DVec2) -> DVec2 {
        for axis in 0..2 {
            if self.periods[axis].is_none() {
                uv[axis] = uv[axis].max(self.domain.min[axis]).min(self.domain.max[axis]);
            }
        }
        uv
    }

    /// Lengths of S_u and S_v: millimetres per unit of parameter.
    pub(super) fn metric(&self, uv: DVec2) -> DVec2 {
        let d = self.surface.derivatives(uv);
        DVec2::new(d.du.length(), d.dv.length())
    }

    /// The foot of `point`: near `seed` where that leads to one, else the globally closest, unwrapped towards `seed`.
    ///
    /// A local foot much farther than `expected`, the distance of neighbouring points, is doubted. The flag tells
    /// whether the seed was given up.
    pub(super) fn foot(
        &self,
        point: DVec3,
        seed: Option<DVec2>,
        expected: f64,
        entity: u64,
    ) -> Result<(Foot, bool), TrimError> {
        let local = invert_surface(self.surface, point, seed);
        let usable = |uv: DVec2, distance: f64| uv.is_finite() && distance.is_finite();
        let suspicious = (1e-4 * self.size + self.tolerance).max(2.0 * expected);
        if usable(local.uv, local.distance) && (seed.is_none() || local.distance <= suspicious) {
            return self
                .checked(Foot { uv: local.uv, distance: local.distance }, entity)
                .map(|foot| (foot, false));
        }
        let global = invert_surface(self.surface, point, None);
        if !usable(global.uv, global.distance) {
            return Err(TrimError::Numeric(format!("edge #{entity} has no finite image")));
        }
        if usable(local.uv, local.distance) && local.distance <= 2.0 * global.distance {
            return self
                .checked(Foot { uv: local.uv, distance: local.distance }, entity)
                .map(|foot| (foot, false));
        }
        let shift = seed.map_or(DVec2::ZERO, |seed| self.nearest_shift(global.uv, seed));
        self.checked(Foot { uv: global.uv + shift, distance: global.distance }, entity)
            .map(|foot| (foot, true))
    }

    fn checked(&self, foot: Foot, entity: u64) -> Result<Foot, TrimError> {
        self.check_distance(foot.distance, entity).map(|()| foot)
    }

    /// An error where an edge is too far away to belong to the surface.
    pub(super) fn check_distance(&self, distance: f64, entity: u64) -> Result<(), TrimError> {
        if distance <= OFF_SURFACE * self.size + self.tolerance {
            Ok(())
        } else {
            Err(TrimError::OffSurface { entity, distance })
        }
    }
}
