//! The camera: where pictures are taken from.

use super::Ray;
use glam::DVec3;

/// A pinhole or orthographic camera in model space.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Camera {
    /// The eye, millimetres.
    pub position: DVec3,
    /// Unit vector into the picture.
    pub forward: DVec3,
    /// Unit vector to the right of the picture.
    pub right: DVec3,
    /// Unit vector to the top of the picture.
    pub up: DVec3,
    /// Half the picture's height: its tangent seen from the eye, or millimetres where orthographic.
    pub half_height: f64,
    /// Whether rays are parallel.
    pub orthographic: bool,
}

impl Camera {
    /// The ray through `(x, y)` of the picture, both in −1..=1, x to the right, y up, for a picture `aspect` times as wide as high.
    pub fn ray(&self, x: f64, y: f64, aspect: f64) -> Ray {
        let across = self.right * (x * aspect * self.half_height) + self.up * (y * self.half_height);
        if self.orthographic {
            Ray { origin: self.position + across, direction: self.forward }
        } else {
            Ray { origin: self.position, direction: (self.forward + across).normalize() }
        }
    }
}
