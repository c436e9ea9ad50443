//! From the camera flags to cameras: one for each view and frame.

use super::args_camera::{CameraArguments, REVIEW_NAME};
use crate::image::label_share;
use crate::render::section::Section;
use crate::render::{Camera, NamedView, REVIEW, Viewpoint};
use crate::scene::Scene;

/// Half the height of film of 36 by 24 mm.
const HALF_FILM: f64 = 12.0;

/// Words never take more of a picture's height: where they are as high as that, the model is behind them.
const MOST_HEADROOM: f64 = 0.25;

/// The names of the views, in order; none where the flags describe the only one.
pub(super) fn names(arguments: &CameraArguments) -> Vec<&str> {
    let expand = |name| match name {
        REVIEW_NAME => REVIEW.to_vec(),
        name => vec![name],
    };
    arguments.view.iter().map(String::as_str).flat_map(expand).collect()
}

/// Each view's cameras, one a frame, for pictures of the resolution that show a section of the scene.
pub(super) fn cameras(
    arguments: &CameraArguments,
    scene: &Scene<'_>,
    section: &Section,
    [width, height]: [u32; 2],
) -> Vec<Vec<Camera>> {
    let aspect = f64::from(width) / f64::from(height);
    let headroom = if arguments.labels { label_share(height).min(MOST_HEADROOM) } else { 0.0 };
    let viewpoints = viewpoints(arguments, headroom);
    let cameras = viewpoints.iter().map(|viewpoint| match arguments.frames {
        1 => vec![Camera::framing_section(viewpoint, scene, section, aspect)],
        frames => Camera::turntable(viewpoint, scene, section, aspect, frames),
    });
    cameras.collect()
}

fn viewpoints(arguments: &CameraArguments, headroom: f64) -> Vec<Viewpoint> {
    let view_angle = match arguments.camera_focal_length {
        Some(millimetres) => 2.0 * (HALF_FILM / millimetres).atan(),
        None => arguments.camera_view_angle.to_radians(),
    };
    let described = Viewpoint {
        up: arguments.up,
        top: None,
        direction: arguments.camera_direction,
        position: arguments.camera_position,
        focal_point: arguments.camera_focal_point,
        view_angle,
        orthographic: arguments.camera_orthographic,
        azimuth: arguments.camera_azimuth_angle.to_radians(),
        elevation: arguments.camera_elevation_angle.to_radians(),
        fill: arguments.fit,
        headroom,
    };
    let named = names(arguments).into_iter().filter_map(NamedView::named);
    let viewpoints: Vec<Viewpoint> = named.map(|view| view.of(&described)).collect();
    if viewpoints.is_empty() { vec![described] } else { viewpoints }
}
