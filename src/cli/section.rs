//! From the flags of sections to a section, and to the instances that it leaves whole.

use super::Failure;
use super::args_section::SectionArguments;
use crate::render::bounds;
use crate::render::section::{MAX_PLANES, Section, SectionPlane};
use crate::scene::{Instance, Scene};
use std::path::Path;

/// The section of a scene that is asked for.
///
/// # Errors
///
/// Too many planes.
pub(super) fn section(flags: &SectionArguments, scene: &Scene<'_>) -> Result<Section, Failure> {
    let bounds = bounds(scene);
    let planes: Vec<SectionPlane> = flags.section.iter().map(|flag| flag.plane(&bounds)).collect();
    Section::new(&planes, flags.section_mode.into(), !flags.no_caps).ok_or_else(|| {
        Failure::Usage(format!("{} sections are too many: {MAX_PLANES} planes are the most", planes.len()))
    })
}

/// Whether a section keeps nothing of a scene, as its box tells; what is left whole by itself is not looked at.
pub(super) fn is_empty(section: &Section, scene: &Scene<'_>) -> bool {
    let is_whole = |instance: &Instance| instance.flags & Instance::UNCUT != 0;
    !section.is_empty()
        && section.keeps_none_of(&bounds(scene).corners())
        && !scene.instances.iter().any(is_whole)
}

/// Marks those of a scene's instances that no plane cuts.
///
/// # Errors
///
/// A pattern that means no part.
pub(super) fn exclude(
    flags: &SectionArguments,
    scene: &Scene<'_>,
    instances: &mut [Instance],
    path: &Path,
) -> Result<(), Failure> {
    for pattern in &flags.section_exclude {
        let mut is_meant = false;
        for (instance, info) in instances.iter_mut().zip(&scene.metadata.instances) {
            let part = &scene.metadata.parts[instance.part as usize];
            let name = info.path.rsplit('/').next().unwrap_or_default();
            let means_it = pattern.means_place(&info.path, name, &[part.entity])
                || pattern.means_place(&part.name, &part.name, &[])
                || pattern.means_entity(part.entity);
            if means_it {
                instance.flags |= Instance::UNCUT;
                is_meant = true;
            }
        }
        if !is_meant {
            let reason = format!(
                "--section-exclude {pattern}: {} has no part of that name; `trimray info` tells its parts",
                path.display()
            );
            return Err(Failure::Usage(reason));
        }
    }
    Ok(())
}
