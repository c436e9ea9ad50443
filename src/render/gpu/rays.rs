//! Hits of given rays.
//!
//! Rays are prepared on the host in f64 and hits are sorted, merged and finished there, by the CPU tracer's own functions; only the search
//! for hits is the kernel's. All hits are kept, however many a ray has: the kernel counts them and stores those that fit, and rays
//! with more get a second pass with as much room as they were counted to need. Both passes meet the hits in the same order.

use super::kernels::{INCOMPLETE, MOST_HARDWARE_ELEMENTS};
use super::{Entry, Gpu, GpuError, GpuScene, Grouping};
use crate::render::cpu::Kernel;
use crate::render::cpu::hit::{finish_hit, hit_normal};
use crate::render::cpu::probe::{consistent_hits, settled};
use crate::render::cpu::ray_space::{Distance, PreparedRay, prepare};
use crate::render::cpu::trace::{Certainty, RawHit, is_shallow};
use crate::render::cpu::{self, NO_NET};
use crate::render::{Exactness, Hit, Ray};
use crate::scene::Scene;
use bytemuck::{Pod, Zeroable};
use rayon::prelude::*;

/// Slots per ray of the first pass.
const FIRST_SLOTS: u32 = 8;
/// Slots of one dispatch of rays with many hits, 32 bytes each; also what a single ray may have.
const BATCH_SLOTS: u32 = 1 << 20;

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct ProbeParameters {
    ray_count: u32,
    first_only: u32,
    rays_per_group: u32,
    reserved: u32,
}

// The least that Vulkan lets a kernel bind.
const _: () = assert!(MOST_HARDWARE_ELEMENTS * FIRST_SLOTS as usize * size_of::<ProbeHit>() <= 128 << 20);

/// A ray as the kernel reads it. 64 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct ProbeRay {
    grid: [i32; 3],
    near_anchor: f32,
    fraction: [f32; 3],
    near_offset: f32,
    direction: [f32; 3],
    first_slot: u32,
    direction_low: [f32; 3],
    slots: u32,
}

/// A hit as the kernel writes it. 32 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
pub struct ProbeHit {
    distance: [f32; 2],
    uv: [f32; 2],
    instance: u32,
    face: u32,
    net: u32,
    certainty: u32,
}

/// What is asked of all rays.
#[derive(Clone, Copy)]
struct Wanted {
    first_only: bool,
    exactness: Exactness,
    /// Without the help of rays beside.
    alone: bool,
}

/// What rays have been found to hit, and which of the first hits are not certain to be hits: those of all hits decide.
struct Answers {
    hits: Vec<Vec<Hit>>,
    uncertain: Vec<usize>,
}

/// A ray on its way: which one of the caller's, and how many slots it needs.
#[derive(Clone, Copy)]
pub(super) struct Pending {
    pub(super) index: usize,
    pub(super) prepared: PreparedRay<f32>,
    pub(super) slots: u32,
}

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
        self.probe_with(scene, rays, first_only, Exactness::default())
    }

    /// [`Gpu::probe`] with the exactness of choice.
    ///
    /// # Errors
    ///
    /// The device's own.
    pub fn probe_with(
        &self,
        scene: &GpuScene<'_>,
        rays: &[Ray],
        first_only: bool,
        exactness: Exactness,
    ) -> Result<Vec<Vec<Hit>>, GpuError> {
        self.probe_wanted(scene, rays, Wanted { first_only, exactness, alone: false })
    }

    /// As [`cpu::probe_alone`].
    ///
    /// # Errors
    ///
    /// The device's own.
    pub fn probe_alone(&self, scene: &GpuScene<'_>, rays: &[Ray]) -> Result<Vec<Vec<Hit>>, GpuError> {
        let exactness = Exactness::default();
        self.probe_wanted(scene, rays, Wanted { first_only: false, exactness, alone: true })
    }

    fn probe_wanted(
        &self,
        scene: &GpuScene<'_>,
        rays: &[Ray],
        wanted: Wanted,
    ) -> Result<Vec<Vec<Hit>>, GpuError> {
        let Wanted { first_only, exactness, alone } = wanted;
        let mut answers = Answers { hits: vec![Vec::new(); rays.len()], uncertain: Vec::new() };
        let slots = if first_only { 1 } else { FIRST_SLOTS };
        let most = self.most_elements();
        for (first, batch) in (0..).step_by(most).zip(rays.chunks(most)) {
            let pending: Vec<Pending> = (first..)
                .zip(batch)
                .filter_map(|(index, ray)| {
                    prepare::<f32>(ray, scene.scene.header).map(|prepared| Pending { index, prepared, slots })
                })
                .collect();
            let cut_short = self.probe_twice(scene, &pending, wanted, Grouping::Shared, &mut answers)?;
            let left = self.probe_twice(scene, &cut_short, wanted, Grouping::Narrow, &mut answers)?;
            // What a software device gives up on, a few rays through poles, the twin answers.
            let given_up: Vec<Ray> = left.iter().map(|ray| rays[ray.index]).collect();
            let hits = match alone {
                true => cpu::probe_alone(&scene.scene, &given_up, cpu::Precision::F32, exactness),
                false => cpu::probe_with(&scene.scene, &given_up, cpu::Precision::F32, first_only, exactness),
            };
            for (ray, hits) in left.iter().zip(hits) {
                answers.hits[ray.index] = hits;
            }
        }
        if !answers.uncertain.is_empty() {
            let uncertain: Vec<Ray> = answers.uncertain.iter().map(|&index| rays[index]).collect();
            let all = self.probe_wanted(scene, &uncertain, Wanted { first_only: false, ..wanted })?;
            for (index, hits) in answers.uncertain.into_iter().zip(all) {
                answers.hits[index] = hits.into_iter().take(1).collect();
            }
        }
        Ok(answers.hits)
    }

    /// Answers rays, in a second pass those with many hits; returns those whose loops were cut short.
    fn probe_twice(
        &self,
        scene: &GpuScene<'_>,
        pending: &[Pending],
        wanted: Wanted,
        grouping: Grouping,
        answers: &mut Answers,
    ) -> Result<Vec<Pending>, GpuError> {
        let (crowded, mut cut_short) = self.probe_batch(scene, pending, wanted, grouping, answers)?;
        for group in groups(&crowded) {
            cut_short.extend(self.probe_batch(scene, group, wanted, grouping, answers)?.1);
        }
        for ray in &mut cut_short {
            ray.slots = ray.slots.min(FIRST_SLOTS);
        }
        Ok(cut_short)
    }

    /// Answers those rays whose hits fit; returns the others with the room they need, and those whose loops were cut short.
    fn probe_batch(
        &self,
        scene: &GpuScene<'_>,
        pending: &[Pending],
        wanted: Wanted,
        grouping: Grouping,
        answers: &mut Answers,
    ) -> Result<(Vec<Pending>, Vec<Pending>), GpuError> {
        let (mut crowded, mut cut_short) = (Vec::new(), Vec::new());
        if pending.is_empty() {
            return Ok((crowded, cut_short));
        }
        let (hits, found) = self.dispatch_rays(scene, pending, wanted, grouping)?;
        let mut first_slot = 0;
        let mut met: Vec<(Pending, Vec<RawHit<f32>>)> = Vec::with_capacity(pending.len());
        for (ray, &answer) in pending.iter().zip(&found) {
            let of_ray = &hits[first_slot..first_slot + ray.slots as usize];
            first_slot += ray.slots as usize;
            if answer == INCOMPLETE {
                cut_short.push(*ray);
                continue;
            }
            let count = answer - 1;
            let kept = &of_ray[..count.min(ray.slots) as usize];
            if count > ray.slots && ray.slots < BATCH_SLOTS {
                crowded.push(Pending { slots: count.min(BATCH_SLOTS), ..*ray });
                continue;
            }
            let mut raw = kept.iter().map(|hit| raw_hit(hit, &scene.scene)).collect::<Result<Vec<_>, _>>()?;
            if wanted.first_only && raw.iter().any(|hit| !hit.is_certain()) {
                answers.uncertain.push(ray.index);
                continue;
            }
            if count > ray.slots {
                raw.iter_mut().for_each(|hit| hit.certainty = Certainty::Border);
            }
            met.push((*ray, raw));
        }
        let of_ray = |(ray, raw): (Pending, Vec<RawHit<f32>>)| {
            let (scene, prepared) = (&scene.scene, &ray.prepared);
            let polished = |mut hit: RawHit<f32>| {
                hit.is_shallow = is_shallow(hit_normal(scene, &hit).dot(prepared.ray.direction));
                f32::polished(scene, &prepared.ray, hit)
            };
            let raw: Vec<_> = raw.into_iter().map(polished).collect();
            let hits = match wanted {
                Wanted { first_only: true, .. } => raw,
                Wanted { alone: true, .. } => consistent_hits(scene, prepared, raw),
                _ => settled(scene, wanted.exactness, prepared, raw),
            };
            (ray.index, hits.iter().map(|hit| finish_hit(scene, hit, prepared.start)).collect())
        };
        let found: Vec<(usize, Vec<Hit>)> = met.into_par_iter().map(of_ray).collect();
        for (index, hits) in found {
            answers.hits[index] = hits;
        }
        Ok((crowded, cut_short))
    }

    fn dispatch_rays(
        &self,
        scene: &GpuScene<'_>,
        pending: &[Pending],
        wanted: Wanted,
        grouping: Grouping,
    ) -> Result<(Vec<ProbeHit>, Vec<u32>), GpuError> {
        let mut slots = 0;
        let rays: Vec<ProbeRay> = pending
            .iter()
            .map(|ray| {
                let first_slot = slots;
                slots += ray.slots;
                probe_ray(ray, first_slot)
            })
            .collect();
        let (bind_group, hits, found) = self.bind_rays(&rays, slots, wanted.first_only, grouping);
        let pipeline = self.pipeline(Entry::Probe, scene, wanted.exactness, false, grouping)?;
        self.dispatch(&pipeline, scene, &bind_group, rays.len() as u32, grouping)?;
        Ok((self.read(&hits, slots as usize)?, self.read(&found, rays.len())?))
    }

    /// Rays on the device, and where their hits go, and for each [`INCOMPLETE`] or 1 + the number of its hits.
    pub(super) fn bind_rays(
        &self,
        rays: &[ProbeRay],
        slots: u32,
        first_only: bool,
        grouping: Grouping,
    ) -> (wgpu::BindGroup, wgpu::Buffer, wgpu::Buffer) {
        let ray_count = rays.len() as u32;
        let parameters = ProbeParameters {
            ray_count,
            first_only: first_only.into(),
            rays_per_group: grouping.elements_per_group(ray_count, self.is_software()),
            reserved: 0,
        };
        let parameters = self.create_uniform("probe parameters", &parameters);
        let input = self.create_input("probe rays", bytemuck::cast_slice(rays));
        let hits = self.create_output("probe hits", u64::from(slots) * size_of::<ProbeHit>() as u64);
        let found = self.create_output("probe answers", 4 * rays.len() as u64);
        (self.bind(Entry::Probe, &[&parameters, &input, &hits, &found]), hits, found)
    }
}

/// Cuts rays into groups whose slots fit one dispatch.
fn groups(rays: &[Pending]) -> Vec<&[Pending]> {
    let mut groups = Vec::new();
    let mut rest = rays;
    while !rest.is_empty() {
        let mut slots = 0;
        let fitting = rest
            .iter()
            .take_while(|ray| {
                slots += ray.slots;
                slots <= BATCH_SLOTS
            })
            .count();
        let (group, others) = rest.split_at(fitting.max(1));
        groups.push(group);
        rest = others;
    }
    groups
}

pub(super) fn probe_ray(ray: &Pending, first_slot: u32) -> ProbeRay {
    let PreparedRay { ray: world, near, .. } = ray.prepared;
    ProbeRay {
        grid: world.grid,
        near_anchor: near.anchor,
        fraction: world.fraction.to_array(),
        near_offset: near.offset,
        direction: world.direction.to_array(),
        first_slot,
        direction_low: world.direction_low.to_array(),
        slots: ray.slots,
    }
}

/// A hit whose indices are in range, as a device that works writes them.
fn raw_hit(hit: &ProbeHit, scene: &Scene<'_>) -> Result<RawHit<f32>, GpuError> {
    let in_range = (hit.instance as usize) < scene.instances.len()
        && (hit.face as usize) < scene.faces.len()
        && (hit.net == NO_NET || (hit.net as usize) < scene.nets.len());
    if !in_range {
        return Err(GpuError::Lost("it answered with a face that does not exist".to_owned()));
    }
    Ok(RawHit {
        distance: Distance { anchor: hit.distance[0], offset: hit.distance[1] },
        instance: hit.instance,
        face: hit.face,
        net: hit.net,
        uv: hit.uv,
        certainty: Certainty::from_word(hit.certainty),
        // The device does not say; see where it is asked.
        is_shallow: false,
    })
}
