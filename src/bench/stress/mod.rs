//! Scenes that are hard to trace, made in code, and what the tracers make of them.
//!
//! Every scene comes with rays made for it; chords of its sphere are traced as well. Hits are compared with the f64 reference, which says which
//! rays it is certain of, and on closed solids odd rays are counted: a line leaves a body as often as it enters. Where no reference is needed,
//! shapes are compared with themselves in another form (`sameness`). All rays depend on their number alone, so that every finding can be had again.

mod aim;
mod change;
mod draft;
mod nets;
mod places;
mod restart;
mod sameness;
#[cfg(test)]
mod tests;
mod trims;

pub use change::Change;
pub use restart::measure_restarts;
pub use sameness::{SUBJECTS, Sameness, Subject, measure_sameness};

use self::aim::{Aim, aimed_ray};
use super::accuracy::measure_rays;
use super::{Accuracy, chord, is_closed};
use crate::bake::{BakeOptions, bake};
use crate::brep::Model;
use crate::render::cpu::{Precision, probe};
use crate::render::reference::{Reference, widened};
use crate::render::{Hit, Ray};
use crate::scene::{Scene, SceneBuffers, Severity};
use glam::DVec3;

/// A scene by name.
#[derive(Debug, Clone, Copy)]
pub struct Case {
    /// For people and for `--only`.
    pub name: &'static str,
    build: fn() -> Stress,
}

/// A model and what its rays are aimed at.
struct Stress {
    model: Model,
    aim: Aim,
}

/// A scene, baked.
pub struct StressScene {
    buffers: SceneBuffers,
    /// With its f32 numbers as f64 ones.
    narrow: SceneBuffers,
    aim: Aim,
    /// Whether it is made of closed solids alone: then no ray may be odd.
    pub is_closed: bool,
    /// Why the bake dropped faces, one reason each.
    pub dropped: Vec<String>,
}

/// The rays of a measurement.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RayKind {
    /// Made for the scene.
    Made,
    /// Chords of its sphere.
    Chords,
}

/// All scenes.
pub fn cases() -> impl Iterator<Item = &'static Case> {
    nets::CASES.iter().chain(trims::CASES).chain(places::CASES)
}

impl Case {
    /// Makes the scene.
    pub fn scene(&self) -> StressScene {
        let Stress { model, aim } = (self.build)();
        let buffers = baked(&model);
        let narrow = widened(&buffers.scene());
        let is_closed = is_closed(&model, &buffers.scene());
        let findings =
            buffers.metadata.findings.iter().filter(|finding| finding.severity == Severity::Dropped);
        let dropped = findings.map(|finding| finding.reason.clone()).collect();
        StressScene { buffers, narrow, aim, is_closed, dropped }
    }
}

impl StressScene {
    /// Traces `count` rays, from number `first` on, and compares them with the reference; of f32 the tracer's own errors are measured, without
    /// those of the bake.
    pub fn measure(&self, kind: RayKind, precision: Precision, first: u64, count: u64) -> Accuracy {
        let scene = self.buffers.scene();
        let reference = Reference::new(truth(&scene, &self.narrow, precision));
        let radius = scene_radius(&scene);
        measure_rays(&scene, &reference, precision.into(), first, count, &|index| match kind {
            RayKind::Made => aimed_ray(&self.aim, radius, index),
            RayKind::Chords => chord(&scene, index),
        })
    }

    /// The tracer's hits of one ray, and the reference's; none where it is not certain.
    pub fn hits(&self, ray: &Ray, precision: Precision) -> [Vec<Hit>; 2] {
        let scene = self.buffers.scene();
        let reference = Reference::new(truth(&scene, &self.narrow, precision));
        let expected = reference.trace(ray).unwrap_or_default();
        let found = probe(&scene, std::slice::from_ref(ray), precision, false).remove(0);
        [found, expected.iter().map(|expected| expected.hit).collect()]
    }
}

fn baked(model: &Model) -> SceneBuffers {
    bake(model, &BakeOptions { keep_f64: true, ..BakeOptions::default() }, &|_, _| {})
}

/// What a tracer of the precision should find: the hits of exactly the numbers that it computes with.
fn truth<'a>(scene: &Scene<'a>, narrow: &'a SceneBuffers, precision: Precision) -> Scene<'a> {
    match precision {
        Precision::F32 => narrow.scene(),
        Precision::F64 => *scene,
    }
}

/// Half the diagonal of the scene's box, millimetres.
fn scene_radius(scene: &Scene<'_>) -> f64 {
    DVec3::from_array(scene.header.half_size.map(f64::from)).length()
}
