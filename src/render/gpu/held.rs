//! Work whose inputs are on the device already and whose answers stay there: what the kernels do, without the way there and back.
//!
//! A bench that times [`Gpu::probe`] on a fast device times the bus and the host, which prepares rays and sorts hits. Here only the kernel runs, over
//! all that was brought before, as often as is asked. What it finds can be counted, so that no bench times a kernel that finds nothing.

use super::rays::{Pending, probe_ray};
use super::trims::TrimQuery;
use super::{Entry, Gpu, GpuError, GpuScene, Grouping};
use crate::render::cpu::ray_space::prepare;
use crate::render::{Coherence, Exactness, Ray};
use rayon::prelude::*;

/// What a kernel is to do, on the device. It belongs to the scene that it was made for.
pub struct HeldWork {
    pipeline: wgpu::ComputePipeline,
    grouping: Grouping,
    batches: Vec<Batch>,
}

struct Batch {
    bind_group: wgpu::BindGroup,
    count: u32,
    /// A word for each element: 0 where there is no answer, 1 + the number of hits of a ray, 1 or 2 for a point outside or inside.
    answers: wgpu::Buffer,
}

impl HeldWork {
    /// Elements of all batches: rays, or trim queries.
    pub fn count(&self) -> u64 {
        self.batches.iter().map(|batch| u64::from(batch.count)).sum()
    }
}

impl Gpu {
    /// Brings rays to the device, to be traced to their first hits. Those that cannot meet the scene stay behind.
    ///
    /// # Errors
    ///
    /// The device's own.
    pub fn hold_rays(
        &self,
        scene: &GpuScene<'_>,
        rays: &[Ray],
        exactness: Exactness,
        coherence: Coherence,
    ) -> Result<HeldWork, GpuError> {
        let grouping = match coherence {
            Coherence::Coherent => Grouping::Wide,
            Coherence::Incoherent => Grouping::Shared,
        };
        let pipeline = self.pipeline(Entry::Probe, scene, exactness, false, grouping)?;
        let mut batches = Vec::new();
        for batch in rays.chunks(self.most_elements()) {
            let prepared: Vec<_> =
                batch.par_iter().filter_map(|ray| prepare::<f32>(ray, scene.scene.header)).collect();
            let rays: Vec<_> = (0..)
                .zip(prepared)
                .map(|(slot, prepared)| probe_ray(&Pending { index: 0, prepared, slots: 1 }, slot))
                .collect();
            if rays.is_empty() {
                continue;
            }
            let count = rays.len() as u32;
            let (bind_group, _, answers) = self.bind_rays(&rays, count, true, grouping);
            batches.push(Batch { bind_group, count, answers });
        }
        self.check()?;
        Ok(HeldWork { pipeline, grouping, batches })
    }

    /// Brings points to the device, to be told whether they are inside their trims.
    ///
    /// # Errors
    ///
    /// The device's own.
    pub fn hold_queries(&self, scene: &GpuScene<'_>, queries: &[TrimQuery]) -> Result<HeldWork, GpuError> {
        let grouping = Grouping::Wide;
        let pipeline = self.pipeline(Entry::Trim, scene, Exactness::Fast, false, grouping)?;
        let of_batch = |queries: &[TrimQuery]| {
            let (bind_group, answers) = self.bind_queries(queries);
            Batch { bind_group, count: queries.len() as u32, answers }
        };
        let batches = queries.chunks(self.most_elements()).map(of_batch).collect();
        self.check()?;
        Ok(HeldWork { pipeline, grouping, batches })
    }

    /// Does the work so many times, all batches in one submission, and waits for its end.
    ///
    /// # Errors
    ///
    /// The device's own.
    pub fn run_held(&self, scene: &GpuScene<'_>, work: &HeldWork, times: usize) -> Result<(), GpuError> {
        let mut encoder = self.device.create_command_encoder(&Default::default());
        for batch in &work.batches {
            encoder.clear_buffer(&batch.answers, 0, None);
        }
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&work.pipeline);
        pass.set_bind_group(0, &scene.bind_group, &[]);
        for batch in (0..times).flat_map(|_| &work.batches) {
            pass.set_bind_group(1, &batch.bind_group, &[]);
            pass.dispatch_workgroups(work.grouping.workgroups(batch.count, self.is_software()), 1, 1);
        }
        drop(pass);
        self.run(encoder.finish())
    }

    /// How many rays of work that has been done have hits, or how many points are inside. Those that a software device gives up on
    /// have none.
    ///
    /// # Errors
    ///
    /// The device's own.
    pub fn count_held(&self, work: &HeldWork) -> Result<u64, GpuError> {
        Ok(self.held_answers(work)?.into_iter().filter(|&answer| answer > 1).count() as u64)
    }

    /// What has been found for each element in the last run: 0 where a software device gave up, 1 for a ray without hits or a point outside, more for others.
    ///
    /// # Errors
    ///
    /// The device's own.
    pub fn held_answers(&self, work: &HeldWork) -> Result<Vec<u32>, GpuError> {
        let of_batches: Result<Vec<Vec<u32>>, GpuError> =
            work.batches.iter().map(|batch| self.read(&batch.answers, batch.count as usize)).collect();
        Ok(of_batches?.concat())
    }
}
