//! The camera: where pictures are taken from. Where nothing is said, the whole model is in the picture.

use super::Ray;
use crate::numeric::Aabb;
use glam::{DQuat, DVec3};

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

/// What is known of a camera; the rest follows from what it should show.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Viewpoint {
    /// Unit vector to what is up in the model.
    pub up: DVec3,
    /// Unit vector to the top of the picture, as nearly as the direction lets it; none: `up`.
    pub top: Option<DVec3>,
    /// Unit vector into the picture; none: (−1, 1, −0.5), turned with `up` from +Z. Unused where there is a position.
    pub direction: Option<DVec3>,
    /// The eye; none: as near as shows everything.
    pub position: Option<DVec3>,
    /// What stands in the middle of the picture; none: whatever centres the model.
    pub focal_point: Option<DVec3>,
    /// Angle between the lower and the upper edge of the picture, radians.
    pub view_angle: f64,
    /// Whether rays are parallel.
    pub orthographic: bool,
    /// How far the camera is turned about `up` and the focal point, to the right of who looks, radians.
    pub azimuth: f64,
    /// How far it is then raised over the focal point, radians; beyond a right angle it looks from behind, upside down.
    pub elevation: f64,
    /// The share of the picture, across or upwards, that the points to show fill, in 0..=1.
    pub fill: f64,
    /// The share of the picture's height that they leave free above and below at least, in 0..0.5.
    pub headroom: f64,
}

impl Default for Viewpoint {
    fn default() -> Self {
        Self {
            up: DVec3::Z,
            top: None,
            direction: None,
            position: None,
            focal_point: None,
            view_angle: std::f64::consts::PI / 6.0,
            orthographic: false,
            azimuth: 0.0,
            elevation: 0.0,
            fill: FILL,
            headroom: 0.0,
        }
    }
}

/// The direction of f3d's pictures of STEP files, with +Z up.
const DIRECTION: DVec3 = DVec3::new(-1.0, 1.0, -0.5);

/// The share of the picture that is filled where nothing is said.
const FILL: f64 = 0.95;

/// The eye is never nearer to the focal point than this share of the box's diagonal.
const NEAREST: f64 = 1e-6;

impl Camera {
    /// The ray through `(x, y)` of the picture, both in −1..=1, x to the right, y up, for a picture `aspect` times as wide as high.
    pub fn ray(&self, x: f64, y: f64, aspect: f64) -> Ray {
        let across = self.across(x, y, aspect);
        if self.orthographic {
            Ray { origin: self.position + across, direction: self.forward }
        } else {
            Ray { origin: self.position, direction: (self.forward + across).normalize() }
        }
    }

    /// From [`Self::position`] to the point of such a ray at a depth, which is a distance along the view direction.
    pub fn at_depth(&self, x: f64, y: f64, aspect: f64, depth: f64) -> DVec3 {
        let across = self.across(x, y, aspect);
        if self.orthographic {
            across + self.forward * depth
        } else {
            let towards = self.forward + across;
            towards * (depth / towards.dot(self.forward))
        }
    }

    /// From the middle of the picture to a place in it, as in [`Self::ray`], at distance 1.
    pub fn across(&self, x: f64, y: f64, aspect: f64) -> DVec3 {
        self.right * (x * aspect * self.half_height) + self.up * (y * self.half_height)
    }

    /// The camera for pictures that show all `points` and are `aspect` times as wide as high. No points count as the unit box.
    pub fn new(view: &Viewpoint, points: &[DVec3], aspect: f64) -> Self {
        let unit_box = Aabb { min: DVec3::ZERO, max: DVec3::ONE }.corners();
        let usable = !points.is_empty() && points.iter().all(|point| point.is_finite());
        let points = if usable { points } else { &unit_box };
        let bounds = Aabb::around(points.iter().copied());
        let focal_point = view.focal_point.unwrap_or_else(|| bounds.center());
        let direction = match view.position {
            Some(position) => Some(focal_point - position),
            None => view.direction,
        };
        let default = || DQuat::from_rotation_arc(DVec3::Z, view.up) * DIRECTION.normalize();
        let forward = direction.and_then(DVec3::try_normalize).unwrap_or_else(default);
        let right = right_of(forward, view.top.unwrap_or(view.up));
        let up = right.cross(forward);
        // The frame turns as a whole, so that the picture does not flip where the camera passes above what it looks at.
        let turn =
            DQuat::from_axis_angle(view.up, view.azimuth) * DQuat::from_axis_angle(-right, view.elevation);
        let [forward, right, up] = [forward, right, up].map(|axis| turn * axis);
        let size = bounds.diagonal().max(f64::MIN_POSITIVE);

        // The points as the camera sees them: across, up and away from the focal point.
        let seen = points.iter().map(|&point| {
            let from_focal = point - focal_point;
            DVec3::new(from_focal.dot(right), from_focal.dot(up), from_focal.dot(forward))
        });
        let fill = [view.fill, view.fill.min(1.0 - 2.0 * view.headroom)];
        let centred = view.focal_point.is_some() || view.position.is_some();
        let (half_height, framing) = if view.orthographic {
            let across = Span::of(seen.clone().map(|p| p.x), centred);
            let upwards = Span::of(seen.map(|p| p.y), centred);
            let half_height =
                (upwards.half / fill[1]).max(across.half / aspect / fill[0]).max(size * NEAREST);
            (half_height, DVec3::new(across.middle, upwards.middle, -size))
        } else {
            let tangent = (view.view_angle / 2.0).tan();
            let across = Wedge::around(seen.clone().map(|p| (p.x, p.z)), tangent * aspect * fill[0], centred);
            let upwards = Wedge::around(seen.map(|p| (p.y, p.z)), tangent * fill[1], centred);
            let depth = across.apex.min(upwards.apex).min(-size * NEAREST);
            (tangent, DVec3::new(across.middle, upwards.middle, depth))
        };
        let framed = focal_point + right * framing.x + up * framing.y + forward * framing.z;
        let turned = |position| focal_point + turn * (position - focal_point);
        let position = view.position.map_or(framed, turned);
        Self { position, forward, right, up, half_height, orthographic: view.orthographic }
    }
}

/// The picture's right. Looking along `up`, the top of the picture is what it is on a map: +Y, or −Z where +Y is up.
fn right_of(forward: DVec3, up: DVec3) -> DVec3 {
    [up, DVec3::Y, -DVec3::Z]
        .into_iter()
        .map(|up| forward.cross(up))
        .find(|right| right.length() > 1e-6)
        .expect("no direction is parallel to both y and z")
        .normalize()
}

/// An interval around numbers.
struct Span {
    middle: f64,
    half: f64,
}

impl Span {
    fn of(numbers: impl Iterator<Item = f64> + Clone, centred: bool) -> Self {
        let high = numbers.clone().fold(f64::NEG_INFINITY, f64::max);
        let low = numbers.fold(f64::INFINITY, f64::min);
        if centred {
            Self { middle: 0.0, half: high.max(-low) }
        } else {
            Self { middle: (low + high) / 2.0, half: (high - low) / 2.0 }
        }
    }
}

/// The nearest place from which points are seen within an angle.
struct Wedge {
    /// Offset of the eye across.
    middle: f64,
    /// The greatest depth at which the eye may stand.
    apex: f64,
}

impl Wedge {
    /// The eye at `(e, d)` sees `(x, z)` within the slope `t` where `|x − e| <= (z − d) t`, that is `d t <= z t − x + e` and
    /// `d t <= z t + x − e`. Over all points: `d t <= a + e` and `d t <= b − e`, best at `e = (b − a) / 2`.
    fn around(points: impl Iterator<Item = (f64, f64)> + Clone, t: f64, centred: bool) -> Self {
        let least = |f: &dyn Fn((f64, f64)) -> f64| points.clone().map(f).fold(f64::INFINITY, f64::min);
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

    fn flat_box() -> Aabb {
        Aabb { min: DVec3::new(1000.0, -5.0, 3.0), max: DVec3::new(1080.0, 45.0, 9.0) }
    }

    /// Where a point is in the picture, −1..=1.
    fn project(camera: &Camera, aspect: f64, point: DVec3) -> [f64; 2] {
        let offset = point - camera.position;
        let depth = if camera.orthographic { 1.0 } else { offset.dot(camera.forward) };
        assert!(depth > 0.0, "the point is in front of the eye");
        let scale = depth * camera.half_height;
        [offset.dot(camera.right) / scale / aspect, offset.dot(camera.up) / scale]
    }

    #[test]
    fn the_box_fills_the_picture_and_no_corner_is_cut() {
        for orthographic in [false, true] {
            for direction in
                [DVec3::X, -DVec3::Z, DIRECTION.normalize(), DVec3::new(0.3, -0.9, 0.2).normalize()]
            {
                for aspect in [0.4, 1.0, 2.5] {
                    for focal_point in [None, Some(DVec3::new(1010.0, 0.0, 4.0))] {
                        let direction = Some(direction);
                        let view = Viewpoint { direction, orthographic, focal_point, ..Viewpoint::default() };
                        let camera = Camera::new(&view, &flat_box().corners(), aspect);
                        let seen = flat_box().corners().map(|c| project(&camera, aspect, c));
                        let extent = seen.iter().flatten().fold(0.0, |m: f64, c| m.max(c.abs()));
                        assert!(
                            (extent - FILL).abs() < 1e-9,
                            "{extent} {direction:?} {aspect} {orthographic}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn the_fill_is_what_is_asked_for() {
        for orthographic in [false, true] {
            let view = Viewpoint { fill: 0.5, orthographic, ..Viewpoint::default() };
            let camera = Camera::new(&view, &flat_box().corners(), 1.5);
            let seen = flat_box().corners().map(|c| project(&camera, 1.5, c));
            let extent = seen.iter().flatten().fold(0.0, |m: f64, c| m.max(c.abs()));
            assert!((extent - 0.5).abs() < 1e-9, "{extent}");
        }
    }

    #[test]
    fn headroom_is_left_free_and_costs_no_width() {
        for (orthographic, aspect) in [(false, 1.5), (true, 1.5), (false, 0.2), (true, 0.2)] {
            let view = Viewpoint { headroom: 0.2, orthographic, ..Viewpoint::default() };
            let camera = Camera::new(&view, &flat_box().corners(), aspect);
            let seen = flat_box().corners().map(|c| project(&camera, aspect, c).map(f64::abs));
            let [across, upwards] = [0, 1].map(|axis| seen.iter().map(|c| c[axis]).fold(0.0, f64::max));
            let is_full = (upwards - 0.6).abs() < 1e-9 || upwards < 0.6 && (across - FILL).abs() < 1e-9;
            assert!(is_full && across < FILL + 1e-9, "{across} {upwards}");
        }
    }

    /// As VTK's cameras turn: a positive azimuth takes the eye to the right, a positive elevation up.
    #[test]
    fn azimuth_and_elevation_turn_the_eye_about_the_focal_point() {
        let turned = |azimuth: f64, elevation: f64, position: Option<DVec3>| {
            let (azimuth, elevation) = (azimuth.to_radians(), elevation.to_radians());
            let direction = Some(DVec3::Y);
            let focal_point = Some(DVec3::new(1040.0, 20.0, 6.0));
            let view =
                Viewpoint { direction, position, focal_point, azimuth, elevation, ..Viewpoint::default() };
            Camera::new(&view, &flat_box().corners(), 1.0)
        };
        let is_near = |a: DVec3, b: DVec3| assert!((a - b).length() < 1e-9, "{a} {b}");
        let right = turned(90.0, 0.0, None);
        is_near(right.forward, -DVec3::X);
        is_near(right.up, DVec3::Z);
        let above = turned(0.0, 90.0, None);
        is_near(above.forward, -DVec3::Z);
        is_near(above.up, DVec3::Y);
        let above_right = turned(90.0, 90.0, None);
        is_near(above_right.up, -DVec3::X);
        let moved = turned(90.0, 0.0, Some(DVec3::new(1040.0, -80.0, 6.0)));
        is_near(moved.position, DVec3::new(1140.0, 20.0, 6.0));
        is_near(moved.forward, -DVec3::X);
    }

    #[test]
    fn axes_are_orthonormal_and_up_is_up() {
        for up in [DVec3::X, DVec3::Y, DVec3::Z, -DVec3::Z] {
            let camera = Camera::new(&Viewpoint { up, ..Viewpoint::default() }, &flat_box().corners(), 1.5);
            assert!((camera.right.cross(camera.forward) - camera.up).length() < 1e-12);
            assert!(camera.up.dot(up) > 0.5, "{up}");
            assert!(camera.forward.dot(up) < 0.0, "seen from above");
        }
    }

    #[test]
    fn a_point_and_nothing_can_be_looked_at_straight_down() {
        for points in [[DVec3::ONE].as_slice(), &[]] {
            for orthographic in [false, true] {
                let view = Viewpoint { direction: Some(-DVec3::Z), orthographic, ..Viewpoint::default() };
                let camera = Camera::new(&view, points, 1.0);
                assert!(camera.position.is_finite() && camera.half_height > 0.0);
                assert_eq!(camera.up, DVec3::Y);
            }
        }
    }

    #[test]
    fn a_position_is_kept_and_looks_at_the_model() {
        let position = DVec3::new(0.0, -500.0, 100.0);
        let view = Viewpoint { position: Some(position), ..Viewpoint::default() };
        let camera = Camera::new(&view, &flat_box().corners(), 1.0);
        assert_eq!(camera.position, position);
        let [x, y] = project(&camera, 1.0, flat_box().center());
        assert!(x.abs() < 1e-12 && y.abs() < 1e-12);
    }

    #[test]
    fn the_middle_of_the_picture_is_straight_ahead() {
        let camera = Camera::new(&Viewpoint::default(), &flat_box().corners(), 1.0);
        assert!((camera.ray(0.0, 0.0, 1.0).direction - camera.forward).length() < 1e-15);
        let top = camera.ray(0.0, 1.0, 1.0).direction;
        assert!((top.dot(camera.forward).acos() - std::f64::consts::PI / 12.0).abs() < 1e-12);
    }
}
