//! Right-handed orthonormal frames.

use glam::{DAffine3, DMat3, DVec3};

/// An origin and three orthonormal axes, `z = x × y`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Where local (0, 0, 0) lies.
    pub origin: DVec3,
    /// Unit vector.
    pub x: DVec3,
    /// Unit vector.
    pub y: DVec3,
    /// Unit vector.
    pub z: DVec3,
}

impl Frame {
    /// The frame of world coordinates.
    pub const IDENTITY: Self = Self { origin: DVec3::ZERO, x: DVec3::X, y: DVec3::Y, z: DVec3::Z };

    /// ISO 10303-42 `axis2_placement_3d`: `z` along `axis`, `x` along `reference` made orthogonal to it.
    ///
    /// Missing directions take their defaults (axis +Z; reference: the standard's `first_proj_axis`, +X or, where the
    /// axis is along X, +Y). A zero, non-finite or parallel direction counts as
    /// missing.
    pub fn from_axes(origin: DVec3, axis: Option<DVec3>, reference: Option<DVec3>) -> Self {
        let z = axis.and_then(DVec3::try_normalize).unwrap_or(DVec3::Z);
        let across = |direction: DVec3| (direction - z * direction.dot(z)).try_normalize();
        let usable = |v: &DVec3| {
            across(v.normalize_or_zero()).is_some() && v.normalize_or_zero().cross(z).length() > 1e-9
        };
        let fallback = if z.x.abs() < 0.999_999 { DVec3::X } else { DVec3::Y };
        let x = across(reference.filter(usable).unwrap_or(fallback).normalize_or_zero())
            .expect("the fallback is not parallel to the axis");
        Self { origin, x, y: z.cross(x), z }
    }

    /// The point with local coordinates `local`.
    pub fn point(&self, local: DVec3) -> DVec3 {
        self.origin + self.vector(local)
    }

    /// The vector with local coordinates `local`.
    pub fn vector(&self, local: DVec3) -> DVec3 {
        self.x * local.x + self.y * local.y + self.z * local.z
    }

    /// Local coordinates of `point`.
    pub fn local_point(&self, point: DVec3) -> DVec3 {
        self.local_vector(point - self.origin)
    }

    /// Local coordinates of `vector`.
    pub fn local_vector(&self, vector: DVec3) -> DVec3 {
        DVec3::new(vector.dot(self.x), vector.dot(self.y), vector.dot(self.z))
    }

    /// The frame moved by a similarity: origin, x and y go along; z goes along, or opposite to it under a mirror, so that
    /// the frame stays right-handed.
    pub fn transformed(&self, transform: &DAffine3) -> Self {
        let x = transform.transform_vector3(self.x).try_normalize().unwrap_or(self.x);
        let y = transform.transform_vector3(self.y);
        let y = (y - x * y.dot(x)).try_normalize().unwrap_or_else(|| x.any_orthonormal_vector());
        Self { origin: transform.transform_point3(self.origin), x, y, z: x.cross(y) }
    }

    /// The matrix that takes local to outer coordinates.
    pub fn outer_from_local(&self) -> DAffine3 {
        DAffine3::from_mat3_translation(DMat3::from_cols(self.x, self.y, self.z), self.origin)
    }
}
