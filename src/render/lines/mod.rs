//! Lines over a picture: the model's edges, and the contours where one surface ends before another.
//!
//! Edges are drawn from the exact curves of the bake, contours from exact hits; nothing is a mesh's. The work is the host's, whatever the device: it
//! projects the curves, asks the device for first hits, and lays strokes over the film. So both devices draw the same lines.
//!
//! 1. `steps`: edges become steps of half a pixel, flat to within 1/16 of a pixel.
//! 2. `visibility`: a step is visible where the first hit towards its middle is not before it.
//! 3. `contour`: between neighbouring pixels with a jump in depth, bisection finds where; crossings are joined cell by cell.
//! 4. `stroke`: what lines cover of each pixel. Lines over each other cover as much as the one that covers more, so that joints and doubles do
//!    not show.

mod contour;
mod contour_cells;
mod hatch;
mod screen;
mod steps;
mod stroke;
#[cfg(test)]
mod tests;
mod visibility;

use self::screen::Screen;
use self::stroke::{Mask, Near};
use super::section::Section;
use super::{Camera, Hit, Ray};
use crate::image::Film;
use crate::scene::{Instance, Scene};
use glam::DVec2;

/// Which edges are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum EdgeChoice {
    /// None; only contours.
    None,
    /// Those where faces meet at an angle, and borders.
    Feature,
    /// Those between tangent faces and seams too.
    All,
}

/// How edges look that something hides.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum HiddenLines {
    /// Not at all.
    Off,
    /// Thin and faint.
    Dim,
    /// Thin and dashed.
    Dashed,
}

/// What lines to draw.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LineOptions {
    /// Which edges.
    pub edges: EdgeChoice,
    /// Whether contours are drawn.
    pub contours: bool,
    /// How hidden edges look.
    pub hidden: HiddenLines,
    /// Pixels; greater than 0.
    pub width: f64,
}

/// The width of hidden lines and of hatch lines, as a share of that of visible ones.
const HIDDEN_WIDTH: f64 = 0.6;
/// Hidden lines nearer than this to visible ones, in widths of these, would touch them and look like a frayed border of theirs: they are left out.
const BESIDE: f64 = 0.5 * (1.0 + HIDDEN_WIDTH);
/// What a dim line covers of what it passes over.
const DIM: f32 = 0.45;
/// Dash and gap, in widths of visible lines, or in pixels where lines are finer.
const DASHES: [f64; 2] = [4.0, 3.0];

/// Answers rays with the first hit of each, if any; where there is a section, with all that is met in it: a device.
pub type FirstHits<'a, E> = dyn FnMut(&[Ray]) -> Result<Vec<Vec<Hit>>, E> + 'a;

/// How far, in pixels, what lines cover of a pixel depends on what others show: as far as a line is wide, and the contour that it is may have ended at an edge
/// beyond. A part of a picture that is rendered with such a border has the lines of the whole picture, to the bit.
pub fn margin(options: &LineOptions) -> usize {
    let beside = if options.hidden == HiddenLines::Off { 0.5 } else { BESIDE + 0.5 * HIDDEN_WIDTH };
    (beside * options.width + 2.0 * contour_cells::TO_EDGE).ceil() as usize + 8
}

/// What the lines of a scene cover of each pixel of `film`, which shows the scene, or part of the picture of it, from `camera`; 0 to 1, top row first.
///
/// # Errors
///
/// Those of the device.
pub fn line_coverage<E>(
    scene: &Scene<'_>,
    camera: &Camera,
    options: &LineOptions,
    section: &Section,
    film: &Film,
    first_hits: &mut FirstHits<'_, E>,
) -> Result<Vec<f32>, E> {
    let screen = Screen::of_film(camera, film);
    let mut mask = Mask::new(film.window());
    let mut near = Near::new(film.window());
    let mut steps = steps::steps(scene, &screen, options);
    let margin = visibility::rounding(scene);
    steps.retain(|step| {
        let is_uncut = scene.instances[step.instance as usize].flags & Instance::UNCUT != 0;
        is_uncut || section.keeps(step.middle, margin)
    });
    let visible = visibility::visible(scene, &screen, &steps, first_hits)?;
    for (step, visible) in steps.iter().zip(&visible) {
        if *visible {
            mask.add(step.ends, options.width);
            near.add(step.ends);
        }
    }
    if options.contours {
        for ends in contour::contours(&screen, film, &near, first_hits)? {
            mask.add(ends, options.width);
            let middle = 0.5 * (ends[0] + ends[1]);
            near.add([ends[0], middle]);
            near.add([middle, ends[1]]);
        }
    }
    if section.caps && !section.is_empty() {
        hatch::add_hatches(scene, section, &screen, film, HIDDEN_WIDTH * options.width, &mut mask);
    }
    if options.hidden != HiddenLines::Off {
        let mut hidden = Mask::new(film.window());
        for (step, _) in steps.iter().zip(&visible).filter(|(_, visible)| !**visible) {
            let is_drawn = options.hidden == HiddenLines::Dim || is_dash(step.along, options.width);
            if is_drawn && !near.is_near(step.at, BESIDE * options.width) {
                hidden.add(step.ends, HIDDEN_WIDTH * options.width);
            }
        }
        let share = if options.hidden == HiddenLines::Dim { DIM } else { 1.0 };
        mask.unite(&hidden, share);
    }
    Ok(mask.into_coverage())
}

/// Whether a dash, not a gap, is at this length of the edge in pixels.
fn is_dash(along: f64, width: f64) -> bool {
    let [dash, gap] = DASHES.map(|length| length * width.max(1.0));
    along.rem_euclid(dash + gap) < dash
}

/// A straight piece of a line in the picture: its ends in pixels, from the left and from the top.
type Ends = [DVec2; 2];
