//! The views that people know by name.
//!
//! As in drawings and in FreeCAD: with +Z up the front view looks along +Y, right is +X, and from above +Y is the top of the picture. Where
//! another direction is up, all of them turn with it.

use super::Viewpoint;
use glam::{DQuat, DVec3};

/// A direction to look in, for models that have +Z up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NamedView {
    /// What it is called.
    pub name: &'static str,
    /// Into the picture; not normalised.
    direction: DVec3,
    /// To the top of the picture, as nearly as the direction lets it.
    top: DVec3,
}

const fn view(name: &'static str, direction: [f64; 3], top: DVec3) -> NamedView {
    NamedView { name, direction: DVec3::from_array(direction), top }
}

/// All of them. The isometric ones are named by the corner of the box that is nearest.
pub const NAMED_VIEWS: [NamedView; 14] = [
    view("iso", [-1.0, 1.0, -1.0], DVec3::Z),
    view("front", [0.0, 1.0, 0.0], DVec3::Z),
    view("back", [0.0, -1.0, 0.0], DVec3::Z),
    view("left", [1.0, 0.0, 0.0], DVec3::Z),
    view("right", [-1.0, 0.0, 0.0], DVec3::Z),
    view("top", [0.0, 0.0, -1.0], DVec3::Y),
    view("bottom", [0.0, 0.0, 1.0], DVec3::NEG_Y),
    view("iso-front-left", [1.0, 1.0, -1.0], DVec3::Z),
    view("iso-back-left", [1.0, -1.0, -1.0], DVec3::Z),
    view("iso-back-right", [-1.0, -1.0, -1.0], DVec3::Z),
    view("iso-front-right-bottom", [-1.0, 1.0, 1.0], DVec3::Z),
    view("iso-front-left-bottom", [1.0, 1.0, 1.0], DVec3::Z),
    view("iso-back-left-bottom", [1.0, -1.0, 1.0], DVec3::Z),
    view("iso-back-right-bottom", [-1.0, -1.0, 1.0], DVec3::Z),
];

/// What shows a part from all sides on one sheet of three by two: top above front and right beside it, as third-angle drawings have them, and two
/// opposite corners, which together show every side of a box.
pub const REVIEW: [&str; 6] = ["top", "iso", "iso-back-left-bottom", "front", "right", "back"];

impl NamedView {
    /// The view of that name.
    pub fn named(name: &str) -> Option<Self> {
        NAMED_VIEWS.into_iter().find(|view| view.name == name)
    }

    /// `viewpoint` looking this way.
    pub fn of(&self, viewpoint: &Viewpoint) -> Viewpoint {
        let turn = DQuat::from_rotation_arc(DVec3::Z, viewpoint.up);
        let direction = Some((turn * self.direction).normalize());
        Viewpoint { top: Some(turn * self.top), direction, ..*viewpoint }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Camera;

    fn axes(name: &str, up: DVec3) -> [DVec3; 3] {
        let view = NamedView::named(name).expect("a view").of(&Viewpoint { up, ..Viewpoint::default() });
        let camera = Camera::new(&view, &[], 1.0);
        [camera.right, camera.up, camera.forward].map(|axis| (axis * 1e9).round() / 1e9)
    }

    #[test]
    fn views_are_those_of_drawings() {
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        for (name, right, up) in [
            ("front", x, z),
            ("back", -x, z),
            ("right", y, z),
            ("left", -y, z),
            ("top", x, y),
            ("bottom", x, -y),
        ] {
            assert_eq!(axes(name, z), [right, up, up.cross(right)], "{name}");
        }
    }

    #[test]
    fn views_turn_with_what_is_up() {
        let (x, y, z) = (DVec3::X, DVec3::Y, DVec3::Z);
        assert_eq!(axes("front", y), [x, y, -z]);
        assert_eq!(axes("top", y), [x, -z, -y]);
        assert_eq!(axes("right", y), [-z, y, -x]);
    }

    #[test]
    fn names_are_told_apart_and_the_review_has_known_ones() {
        for (index, view) in NAMED_VIEWS.iter().enumerate() {
            assert!(NAMED_VIEWS[..index].iter().all(|other| other.name != view.name), "{}", view.name);
            assert!(NAMED_VIEWS[..index].iter().all(|other| other.direction != view.direction));
        }
        assert!(REVIEW.iter().all(|name| NamedView::named(name).is_some()));
    }
}
