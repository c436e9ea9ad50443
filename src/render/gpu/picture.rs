//! Pictures: one sample of one tile a dispatch.

use super::{Gpu, GpuError, GpuScene};
use crate::image::Film;
use crate::render::{Camera, RenderOptions};

impl Gpu {
    /// Renders a picture; `progress` is told (done, total) units of work.
    ///
    /// # Errors
    ///
    /// The device's own.
    pub fn render(
        &self,
        scene: &GpuScene<'_>,
        camera: &Camera,
        options: &RenderOptions,
        progress: &(dyn Fn(usize, usize) + Sync),
    ) -> Result<Film, GpuError> {
        todo!()
    }
}
