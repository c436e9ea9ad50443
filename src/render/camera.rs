//! The camera: where pictures are taken from.

use super::Ray;
use crate::numeric::Aabb;
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

/// Share of the picture left free around the model.
const MARGIN: f64 = 0.05;

/// Half the angle of the default view, 30°.
pub const DEFAULT_VIEW_ANGLE: f64 = std::f64::consts::PI / 6.0;

impl Camera {
    /// A camera that looks along `direction` and shows `bounds`, filling the picture up to a margin of 5 %.
    ///
    /// `up` is turned to the top of the picture; where it is parallel to the direction, another axis is. A zero direction or an empty
    /// box counts as the default direction (−1, 1, −0.5) or the unit box.
    pub fn framing(bounds: Aabb, direction: DVec3, up: DVec3, aspect: f64, orthographic: bool) -> Self {
        let usable = !bounds.is_empty() && bounds.is_finite();
        let bounds = if usable { bounds } else { Aabb { min: DVec3::ZERO, max: DVec3::ONE } };
        let forward = direction.try_normalize().unwrap_or_else(|| DVec3::new(-1.0, 1.0, -0.5).normalize());
        let right = [up, DVec3::Z, DVec3::Y, DVec3::X]
            .into_iter()
            .filter_map(|up| {
                forward
                    .cross(up.normalize_or_zero())
                    .try_normalize()
                    .filter(|_| forward.cross(up.normalize_or_zero()).length() > 1e-4)
            })
            .next()
            .expect("a direction is not parallel to two axes");
        let up = right.cross(forward);
        let aspect = if aspect.is_finite() && aspect > 0.0 { aspect } else { 1.0 };
        let center = bounds.center();
        let size = bounds.diagonal().max(1e-9);
        let fill = 1.0 - MARGIN;
        let corners = bounds.corners().map(|corner| {
            let c = corner - center;
            DVec3::new(c.dot(right), c.dot(up), c.dot(forward))
        });
        if orthographic {
            let (across, upwards) = (span(&corners, |c| c.x), span(&corners, |c| c.y));
            let half = ((across[1] - across[0]) / aspect).max(upwards[1] - upwards[0]) * 0.5 / fill;
            let middle = right * (across[0] + across[1]) * 0.5 + up * (upwards[0] + upwards[1]) * 0.5;
            let position = center + middle - forward * size;
            return Self { position, forward, right, up, half_height: half.max(size * 1e-6), orthographic };
        }
        let half_height = (DEFAULT_VIEW_ANGLE * 0.5).tan();
        let eye = perspective_eye(&corners, half_height * aspect * fill, half_height * fill);
        let position = center + right * eye.x + up * eye.y + forward * eye.z;
        Self { position, forward, right, up, half_height, orthographic }
    }
}

/// The range of `of` over the corners.
fn span(corners: &[DVec3; 8], of: impl Fn(&DVec3) -> f64) -> [f64; 2] {
    corners
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |range, c| [range[0].min(of(c)), range[1].max(of(c))])
}

/// The nearest eye, in camera axes, from which all corners lie within the slopes `tan_x` and `tan_y`.
///
/// A corner (x, y, z) is inside where `|x − e.x| <= tan_x (z − e.z)`. Per axis this asks for `x − tan z <= e.x − tan e.z` and
/// `x + tan z >= …` on the other side: the two extreme corners meet in one wedge, whose apex is as near as that axis allows.
fn perspective_eye(corners: &[DVec3; 8], tan_x: f64, tan_y: f64) -> DVec3 {
    let apex = |tan: f64, of: fn(&DVec3) -> f64| {
        let high = span(corners, |c| of(c) - tan * c.z)[1];
        let low = span(corners, |c| of(c) + tan * c.z)[0];
        // e − tan z = high and e + tan z = low.
        ((high + low) * 0.5, (low - high) / (2.0 * tan))
    };
    let (x, z_x) = apex(tan_x, |c| c.x);
    let (y, z_y) = apex(tan_y, |c| c.y);
    let nearest = span(corners, |c| c.z)[0];
    DVec3::new(x, y, z_x.min(z_y).min(nearest - 1e-9))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn extremes(camera: &Camera, bounds: Aabb, aspect: f64) -> [f64; 2] {
        let mut reach = [0.0_f64; 2];
        for corner in bounds.corners() {
            let c = corner - camera.position;
            let depth = if camera.orthographic { 1.0 } else { c.dot(camera.forward) };
            assert!(depth > 0.0);
            reach[0] = reach[0].max((c.dot(camera.right) / depth / camera.half_height / aspect).abs());
            reach[1] = reach[1].max((c.dot(camera.up) / depth / camera.half_height).abs());
        }
        reach
    }

    #[test]
    fn framing_fills_the_picture_up_to_the_margin() {
        let bounds = Aabb { min: DVec3::new(1e4, -3.0, 2.0), max: DVec3::new(1e4 + 5.0, 4.0, 2.5) };
        for orthographic in [false, true] {
            for direction in [DVec3::new(-1.0, 1.0, -0.5), DVec3::NEG_Z, DVec3::X, DVec3::ZERO] {
                for aspect in [0.5, 1.0, 5.0 / 3.0] {
                    let camera = Camera::framing(bounds, direction, DVec3::Z, aspect, orthographic);
                    let [x, y] = extremes(&camera, bounds, aspect);
                    assert!((x.max(y) - 0.95).abs() < 1e-6, "{direction} {aspect}: {x} {y}");
                    assert!((camera.right.dot(camera.up)).abs() < 1e-12);
                    assert!((camera.right.cross(camera.forward) - camera.up).length() < 1e-12);
                }
            }
        }
    }
}
