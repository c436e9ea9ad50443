//! From the camera flags to a camera.

use super::args::View;
use crate::numeric::Aabb;
use crate::render::{Camera, Viewpoint};
use crate::scene::Header;
use glam::{DVec3, Vec3};

/// The box around the whole scene in model space.
pub(super) fn bounds(header: &Header) -> Aabb {
    let anchor = DVec3::from_array(header.world_anchor);
    let half = Vec3::from_array(header.half_size).as_dvec3();
    Aabb { min: anchor - half, max: anchor + half }
}

/// The camera for pictures of the resolution.
pub(super) fn camera(view: &View, header: &Header, [width, height]: [u32; 2]) -> Camera {
    let viewpoint = Viewpoint {
        up: view.up,
        direction: view.camera_direction,
        position: view.camera_position,
        focal_point: view.camera_focal_point,
        view_angle: view.camera_view_angle.to_radians(),
        orthographic: view.camera_orthographic,
    };
    Camera::new(&viewpoint, bounds(header), f64::from(width) / f64::from(height))
}
