//! From the camera flags to a camera.

use super::args::View;
use crate::render::section::Section;
use crate::render::{Camera, Viewpoint};
use crate::scene::Scene;

/// The camera for pictures of a section in the resolution.
pub(super) fn camera(view: &View, scene: &Scene<'_>, section: &Section, [width, height]: [u32; 2]) -> Camera {
    let viewpoint = Viewpoint {
        up: view.up,
        direction: view.camera_direction,
        position: view.camera_position,
        focal_point: view.camera_focal_point,
        view_angle: view.camera_view_angle.to_radians(),
        orthographic: view.camera_orthographic,
    };
    Camera::framing_section(&viewpoint, scene, section, f64::from(width) / f64::from(height))
}
