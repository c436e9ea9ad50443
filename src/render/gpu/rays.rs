//! Hits of given rays.

use super::{Gpu, GpuError, GpuScene};
use crate::render::{Hit, Ray};

impl Gpu {
    /// All hits of each ray, sorted by t; or only the first of each.
    ///
    /// # Errors
    ///
    /// The device's own.
    pub fn probe(
        &self,
        scene: &GpuScene<'_>,
        rays: &[Ray],
        first_only: bool,
    ) -> Result<Vec<Vec<Hit>>, GpuError> {
        todo!()
    }
}
