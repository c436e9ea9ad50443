//! From the flags of path tracing to what is traced.

use super::args_path::PathArguments;
use crate::image::LightMap;
use crate::render::section::Section;
use crate::render::{Environment, Ground, PathOptions, lowest};
use crate::scene::Scene;
use anyhow::Context;
use glam::{DQuat, DVec3};

/// The light of the pictures of a run; `None` where no paths are traced.
///
/// # Errors
///
/// A map that cannot be read.
pub(super) fn environment(flags: &PathArguments) -> anyhow::Result<Option<Environment>> {
    if !flags.path_trace {
        return Ok(None);
    }
    let mut environment = match &flags.hdri {
        None => Environment::studio(),
        Some(path) => {
            let map = LightMap::read(path).with_context(|| format!("cannot use {}", path.display()))?;
            Environment::from_map([map.width, map.height], &map.light)
                .with_context(|| format!("{} is no map of light", path.display()))?
        }
    };
    environment.brighten(flags.hdri_intensity.unwrap_or(1.0));
    Ok(Some(environment))
}

/// How paths are traced through a scene; `up` is a unit vector.
pub(super) fn path_options(
    flags: &PathArguments,
    environment: Environment,
    scene: &Scene<'_>,
    section: &Section,
    up: DVec3,
) -> PathOptions {
    PathOptions {
        samples: flags.spp.unwrap_or(64),
        max_depth: flags.max_depth.unwrap_or(6),
        seed: flags.seed.unwrap_or(0),
        noise: flags.noise,
        ground: flags.ground.then(|| Ground { up, height: lowest(scene, section, up) }),
        environment,
        axes: flags.hdri.is_some().then(|| map_axes(up, flags.hdri_rotation.unwrap_or(0.0))),
        shows_surroundings: flags.hdri_background,
    }
}

/// To the right of the middle of a map, up, and away from the middle, which without a rotation is where `--view front` looks.
fn map_axes(up: DVec3, degrees: f64) -> [DVec3; 3] {
    let turn = DQuat::from_axis_angle(up, degrees.to_radians()) * DQuat::from_rotation_arc(DVec3::Z, up);
    [turn * DVec3::X, up, turn * -DVec3::Y]
}
