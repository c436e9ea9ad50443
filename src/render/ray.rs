//! Rays and hits, as the outside sees them: f64, model space, millimetres.

use glam::DVec3;

/// A half-line in model space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Ray {
    /// Where it starts, millimetres.
    pub origin: DVec3,
    /// Where it goes; a unit vector.
    pub direction: DVec3,
}

impl Ray {
    /// The point at a distance, millimetres.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin + self.direction * t
    }
}

/// A point where a ray meets a face.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hit {
    /// Distance along the ray, millimetres.
    pub t: f64,
    /// Outward unit normal of the face (by its orientation, not turned to the ray), model space.
    pub normal: DVec3,
    /// Surface parameters of the face (radians and millimetres, as in the geometry module).
    pub uv: [f64; 2],
    /// Index of the face.
    pub face: u32,
    /// Index of the instance.
    pub instance: u32,
}
