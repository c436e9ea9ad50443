//! Which device computes: a hardware GPU where there is one, else the CPU, unless one is asked for by name. It says which, once, on
//! stderr; where the GPU fails under `auto`, the CPU takes over with the reason.

use super::args::{DeviceChoice, General};
use crate::image::Film;
use crate::render::cpu::{self, Precision};
use crate::render::{Camera, Hit, Ray, RenderOptions};
use crate::scene::Scene;
use std::io::Write;

/// The devices of one run of a command; the GPU is opened when it is first needed.
pub(super) struct Chooser<'a> {
    choice: DeviceChoice,
    general: &'a General,
    said: bool,
}

impl<'a> Chooser<'a> {
    pub(super) fn new(choice: DeviceChoice, general: &'a General) -> Self {
        Self { choice, general, said: false }
    }

    /// Renders a picture.
    pub(super) fn render(
        &mut self,
        scene: &Scene<'_>,
        camera: &Camera,
        options: &RenderOptions,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> anyhow::Result<Film> {
        self.refuse_gpu()?;
        self.say(&format!("rendering on the CPU, {} threads", rayon::current_num_threads()));
        Ok(cpu::render(scene, camera, options, progress))
    }

    /// Answers rays.
    pub(super) fn probe(
        &mut self,
        scene: &Scene<'_>,
        rays: &[Ray],
        precision: Precision,
        first_only: bool,
    ) -> anyhow::Result<Vec<Vec<Hit>>> {
        self.refuse_gpu()?;
        Ok(cpu::probe(scene, rays, precision, first_only))
    }

    fn refuse_gpu(&self) -> anyhow::Result<()> {
        anyhow::ensure!(self.choice != DeviceChoice::Gpu, "this trimray was built without the `gpu` feature");
        Ok(())
    }

    fn say(&mut self, text: &str) {
        if !self.said && !self.general.quiet {
            let _ = writeln!(std::io::stderr(), "{text}");
        }
        self.said = true;
    }
}
