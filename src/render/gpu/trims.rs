//! Whether given points are inside trims: the kernels' trim queries alone, for tests and for the trimming study.

use super::kernels::INCOMPLETE;
use super::{Entry, Gpu, GpuError, GpuScene, Grouping};
use crate::render::Exactness;
use bytemuck::{Pod, Zeroable};

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct TrimParameters {
    query_count: u32,
    reserved: [u32; 3],
}

/// A point of a face's parameter square. 16 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct TrimQuery {
    /// Normalised, within the window.
    pub uv: [f32; 2],
    /// `Face::trim_root`, that of a face of the scene.
    pub root: u32,
    /// Unused, 0.
    pub reserved: u32,
}

impl Gpu {
    /// Whether each point is inside: what [`trim_inside`](crate::render::cpu::trim_inside) says, by the scene's own trim method.
    ///
    /// # Errors
    ///
    /// The device's own.
    pub fn trim_inside(&self, scene: &GpuScene<'_>, queries: &[TrimQuery]) -> Result<Vec<bool>, GpuError> {
        let mut answers = Vec::with_capacity(queries.len());
        for batch in queries.chunks(self.most_elements()) {
            let mut found = self.trim_batch(scene, batch, Grouping::Wide)?;
            if found.contains(&INCOMPLETE) {
                found = self.trim_batch(scene, batch, Grouping::Narrow)?;
            }
            if found.contains(&INCOMPLETE) {
                return Err(GpuError::Incomplete);
            }
            answers.extend(found.iter().map(|&answer| answer == 2));
        }
        Ok(answers)
    }

    fn trim_batch(
        &self,
        scene: &GpuScene<'_>,
        queries: &[TrimQuery],
        grouping: Grouping,
    ) -> Result<Vec<u32>, GpuError> {
        let (bind_group, answers) = self.bind_queries(queries);
        let pipeline = self.pipeline(Entry::Trim, scene, Exactness::Fast, false, grouping)?;
        self.dispatch(&pipeline, scene, &bind_group, queries.len() as u32, grouping)?;
        self.read(&answers, queries.len())
    }

    /// Queries on the device, and where their answers go.
    pub(super) fn bind_queries(&self, queries: &[TrimQuery]) -> (wgpu::BindGroup, wgpu::Buffer) {
        let parameters = TrimParameters { query_count: queries.len() as u32, reserved: [0; 3] };
        let parameters = self.create_uniform("trim parameters", &parameters);
        let input = self.create_input("trim queries", bytemuck::cast_slice(queries));
        let answers = self.create_output("trim answers", 4 * queries.len() as u64);
        (self.bind(Entry::Trim, &[&parameters, &input, &answers]), answers)
    }
}
