//! Hatch lines of caps as strokes: where the shading of a cap has them, but as crisp as edges and visible in every style.

use super::screen::Screen;
use super::stroke::Mask;
use crate::image::{Film, box_coverage};
use crate::render::cpu::section::{HATCH_SHARE, WorldPlane, WorldSection, hatch_place};
use crate::render::cpu::vector::Vector3;
use crate::render::section::Section;
use crate::scene::Scene;
use glam::{DVec2, DVec3};

/// The share of a cap that lines take at most: those of caps far away are finer.
const MOST: f64 = 0.25;

/// Draws the hatch lines of all caps that a film shows.
pub(super) fn add_hatches(
    scene: &Scene<'_>,
    section: &Section,
    screen: &Screen<'_>,
    film: &Film,
    width: f64,
    mask: &mut Mask,
) {
    let world = WorldSection::new(section, scene.header, screen.camera(), screen.size()[1] as u32);
    let anchor = DVec3::from_array(scene.header.world_anchor);
    for pixel in 0..film.part.len() {
        if film.part[pixel] == 0 || film.face[pixel] != 0 {
            continue;
        }
        let instance = film.part[pixel] - 1;
        let [x, y] = [film.corner[0] + pixel % film.width, film.corner[1] + pixel / film.width];
        let center = DVec2::new(x as f64 + 0.5, y as f64 + 0.5);
        let ray = screen.ray(center);
        let point = ray.at(f64::from(film.depth[pixel]) / screen.depth_of(&ray));
        let off = |k: usize| (section.planes()[k].normal.dot(point) - section.planes()[k].offset).abs();
        let Some(k) = (0..section.planes().len()).min_by(|&a, &b| off(a).total_cmp(&off(b))) else {
            continue;
        };
        let place = |at: DVec2| {
            let (ray, plane) = (screen.ray(at), &section.planes()[k]);
            let t = (plane.offset - plane.normal.dot(ray.origin)) / plane.normal.dot(ray.direction);
            across(&world.planes[k], ray.at(t) - anchor, instance)
        };
        let here = place(center);
        let slope = DVec2::new(place(center + DVec2::X) - here, place(center + DVec2::Y) - here).length();
        // From the middle of the nearest line, in distances of lines, then in pixels.
        let from_line = here - 0.5 * f64::from(HATCH_SHARE);
        let distance = (from_line - from_line.round()).abs() / slope;
        mask.cover(pixel, box_coverage(distance, width.min(MOST / slope)) as f32);
    }
}

fn across(plane: &WorldPlane, point: DVec3, instance: u32) -> f64 {
    f64::from(hatch_place(plane, Vector3::from_f64(point.to_array()), instance))
}
