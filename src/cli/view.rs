//! From the camera flags to a camera: where nothing is said, the whole model is in the picture.

use super::args::View;
use crate::numeric::Aabb;
use crate::render::Camera;
use crate::scene::Header;
use glam::{DQuat, DVec3};

/// The direction of f3d's STEP pictures, with +Z up.
const DIRECTION: DVec3 = DVec3::new(-1.0, 1.0, -0.5);

/// The share of the picture that the model's box may fill, in each direction.
const FILL: f64 = 0.95;

/// The box around the whole scene in model space.
pub(super) fn bounds(header: &Header) -> Aabb {
    let anchor = DVec3::from_array(header.world_anchor);
    let half = glam::Vec3::from_array(header.half_size).as_dvec3();
    Aabb { min: anchor - half, max: anchor + half }
}

/// The camera for pictures of `bounds` that are `aspect` times as wide as high.
pub(super) fn camera(view: &View, bounds: Aabb, aspect: f64) -> Camera {
    let focal_point = view.camera_focal_point.unwrap_or_else(|| bounds.center());
    let forward = match (view.camera_position, view.camera_direction) {
        (Some(position), _) => (focal_point - position).try_normalize(),
        (None, direction) => direction,
    };
    let forward =
        forward.unwrap_or_else(|| (DQuat::from_rotation_arc(DVec3::Z, view.up) * DIRECTION).normalize());
    // Looking along the up direction, up in the picture is what it is on a map: +Y, or -Z where +Y is up.
    let right = [view.up, DVec3::Y, -DVec3::Z]
        .into_iter()
        .map(|up| forward.cross(up))
        .find(|right| right.length() > 1e-6)
        .map_or(DVec3::X, DVec3::normalize);
    let up = right.cross(forward);
    let tangent = (view.camera_view_angle.to_radians() / 2.0).tan();
    let size = bounds.diagonal().max(f64::MIN_POSITIVE);

    // The box as the camera sees it: across, up and away from the focal point.
    let corners = bounds.corners().map(|corner| {
        let from_focal = corner - focal_point;
        DVec3::new(from_focal.dot(right), from_focal.dot(up), from_focal.dot(forward))
    });
    let centred = view.camera_focal_point.is_some() || view.camera_position.is_some();
    let mut camera = Camera {
        position: focal_point,
        forward,
        right,
        up,
        half_height: tangent,
        orthographic: view.camera_orthographic,
    };
    if view.camera_orthographic {
        let across = Span::of(corners.map(|c| c.x), centred);
        let along = Span::of(corners.map(|c| c.y), centred);
        let centre = focal_point + right * across.middle + up * along.middle;
        camera.half_height = (along.half.max(across.half / aspect) / FILL).max(size * 1e-6);
        camera.position = view.camera_position.unwrap_or(centre - forward * size);
    } else if let Some(position) = view.camera_position {
        camera.position = position;
    } else {
        let across = Wedge::around(corners.map(|c| (c.x, c.z)), tangent * aspect * FILL, centred);
        let along = Wedge::around(corners.map(|c| (c.y, c.z)), tangent * FILL, centred);
        let depth = across.apex.min(along.apex).min(-size * 1e-6);
        camera.position = focal_point + right * across.middle + up * along.middle + forward * depth;
    }
    camera
}

/// An interval around numbers.
struct Span {
    middle: f64,
    half: f64,
}

impl Span {
    fn of(numbers: [f64; 8], centred: bool) -> Self {
        let high = numbers.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let low = numbers.into_iter().fold(f64::INFINITY, f64::min);
        if centred {
            Self { middle: 0.0, half: high.max(-low) }
        } else {
            Self { middle: (low + high) / 2.0, half: (high - low) / 2.0 }
        }
    }
}

/// The narrow place from which points are seen within an angle.
struct Wedge {
    /// Offset of the eye across.
    middle: f64,
    /// The greatest depth at which the eye may stand.
    apex: f64,
}

impl Wedge {
    /// The eye at `(e, d)` sees `(x, z)` within the angle where `|x - e| <= (z - d) t`, that is `d t <= z t - x + e` and
    /// `d t <= z t + x - e`. Over all points: `d t <= a + e` and `d t <= b - e`, best at `e = (b - a) / 2`.
    fn around(points: [(f64, f64); 8], t: f64, centred: bool) -> Self {
        let least = |f: &dyn Fn((f64, f64)) -> f64| points.into_iter().map(f).fold(f64::INFINITY, f64::min);
        let a = least(&|(x, z)| z * t - x);
        let b = least(&|(x, z)| z * t + x);
        if centred {
            Self { middle: 0.0, apex: a.min(b) / t }
        } else {
            Self { middle: (b - a) / 2.0, apex: (a + b) / (2.0 * t) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view() -> View {
        View {
            up: DVec3::Z,
            camera_direction: None,
            camera_position: None,
            camera_focal_point: None,
            camera_view_angle: 30.0,
            camera_orthographic: false,
        }
    }

    fn flat_box() -> Aabb {
        Aabb { min: DVec3::new(1000.0, -5.0, 3.0), max: DVec3::new(1080.0, 45.0, 9.0) }
    }

    /// Where a point is in the picture, −1..=1.
    fn project(camera: &Camera, aspect: f64, point: DVec3) -> [f64; 2] {
        let offset = point - camera.position;
        let scale = if camera.orthographic { 1.0 } else { offset.dot(camera.forward) } * camera.half_height;
        [offset.dot(camera.right) / scale / aspect, offset.dot(camera.up) / scale]
    }

    #[test]
    fn the_box_fills_the_picture_and_no_corner_is_cut() {
        for orthographic in [false, true] {
            for direction in
                [DVec3::X, -DVec3::Z, DIRECTION.normalize(), DVec3::new(0.3, -0.9, 0.2).normalize()]
            {
                for aspect in [0.4, 1.0, 2.5] {
                    for focal in [None, Some(DVec3::new(1010.0, 0.0, 4.0))] {
                        let view = View {
                            camera_direction: Some(direction),
                            camera_orthographic: orthographic,
                            camera_focal_point: focal,
                            ..view()
                        };
                        let camera = camera(&view, flat_box(), aspect);
                        let seen = flat_box().corners().map(|c| project(&camera, aspect, c));
                        let extent = seen.iter().flatten().fold(0.0, |m: f64, c| m.max(c.abs()));
                        assert!((extent - FILL).abs() < 1e-9, "{extent} {direction} {aspect} {orthographic}");
                    }
                }
            }
        }
    }

    #[test]
    fn axes_are_orthonormal_and_up_is_up() {
        for up in [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::Z] {
            let camera = camera(&View { up, ..view() }, flat_box(), 1.5);
            assert!((camera.right.cross(camera.forward) - camera.up).length() < 1e-12);
            assert!(camera.up.dot(up) > 0.5, "{up}");
            assert!(camera.forward.dot(up) < 0.0, "seen from above");
        }
    }

    #[test]
    fn looking_straight_down_and_at_a_point_is_fine() {
        let point = Aabb { min: DVec3::ONE, max: DVec3::ONE };
        for orthographic in [false, true] {
            let view =
                View { camera_direction: Some(-DVec3::Z), camera_orthographic: orthographic, ..view() };
            let camera = camera(&view, point, 1.0);
            assert!(camera.position.is_finite() && camera.half_height > 0.0 && camera.right.is_normalized());
        }
    }

    #[test]
    fn a_position_is_kept_and_looks_at_the_model() {
        let position = DVec3::new(0.0, -500.0, 100.0);
        let camera = camera(&View { camera_position: Some(position), ..view() }, flat_box(), 1.0);
        assert_eq!(camera.position, position);
        let [x, y] = project(&camera, 1.0, flat_box().center());
        assert!(x.abs() < 1e-12 && y.abs() < 1e-12);
    }
}
