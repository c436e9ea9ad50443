//! Axis-aligned boxes in f64.

use glam::{DAffine3, DVec3};

/// The points `p` with `min <= p <= max`; empty where `min > max`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Aabb {
    /// Least corner.
    pub min: DVec3,
    /// Greatest corner.
    pub max: DVec3,
}

impl Aabb {
    /// The box without points.
    pub const EMPTY: Self = Self { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    /// The smallest box around `points`.
    pub fn around(points: impl IntoIterator<Item = DVec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, |bounds, p| bounds.including(p))
    }

    /// The box with `point` added.
    pub fn including(self, point: DVec3) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// The smallest box around both.
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// The box grown by `margin` on every side.
    pub fn grown(self, margin: f64) -> Self {
        Self { min: self.min - margin, max: self.max + margin }
    }

    /// Whether there is no point in it.
    pub fn is_empty(self) -> bool {
        !(self.min.cmple(self.max).all())
    }

    /// Whether both corners are finite numbers.
    pub fn is_finite(self) -> bool {
        self.min.is_finite() && self.max.is_finite()
    }

    /// The midpoint.
    pub fn center(self) -> DVec3 {
        (self.min + self.max) * 0.5
    }

    /// Extents along the axes.
    pub fn size(self) -> DVec3 {
        self.max - self.min
    }

    /// The length of the diagonal; 0 for the empty box.
    pub fn diagonal(self) -> f64 {
        if self.is_empty() { 0.0 } else { self.size().length() }
    }

    /// The eight corners.
    pub fn corners(self) -> [DVec3; 8] {
        std::array::from_fn(|i| {
            let pick = |bit: usize, low: f64, high: f64| if i >> bit & 1 == 0 { low } else { high };
            DVec3::new(
                pick(0, self.min.x, self.max.x),
                pick(1, self.min.y, self.max.y),
                pick(2, self.min.z, self.max.z),
            )
        })
    }

    /// The box around the transformed corners.
    pub fn transformed(self, transform: DAffine3) -> Self {
        if self.is_empty() {
            self
        } else {
            Self::around(self.corners().map(|c| transform.transform_point3(c)))
        }
    }
}
