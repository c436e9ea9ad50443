//! `trimray probe`: rays in, exact hits out, a line each.

use super::Failure;
use super::args::{DeviceChoice, General, HitsChoice, PrecisionChoice, Probe};
use super::device::Device;
use super::load::{Purpose, load, nothing};
use super::ray_lines::{RAYS_AT_A_TIME, RayLines};
use super::ray_report::RayReport;
use crate::render::cpu::{Precision, RayCounts, count_steps};
use crate::render::{Exactness, Hit, Ray};
use crate::scene::Scene;
use anyhow::bail;
use rayon::prelude::*;
use serde::Serialize;
use std::io::{BufWriter, Write};

pub(super) fn run(command: &Probe, general: &General) -> anyhow::Result<()> {
    let mut lines = RayLines::open(&command.rays)?;
    let wants_f64 = match (command.precision, command.device) {
        (Some(PrecisionChoice::F64), DeviceChoice::Gpu) => {
            return Err(Failure::Usage("the GPU computes in f32".into()).into());
        }
        (Some(precision), _) => precision == PrecisionChoice::F64,
        (None, device) => device != DeviceChoice::Gpu,
    };
    let purpose = Purpose {
        keep_f64: wants_f64,
        strict: command.import.strict,
        kept_scenes: command.cache.kept_scenes(),
        selection: command.selection.clone(),
        ..Purpose::default()
    };
    let loaded = load(&command.input, purpose, general)?;
    let scene = loaded.scene();
    // A file of wires has no face to hit, and saying so by misses is true; a file of which no face could be read is not answered.
    if scene.faces.is_empty() && scene.metadata.declared_faces > 0 {
        return Err(nothing(&command.input, &scene, "probe").into());
    }
    let precision = precision(command, wants_f64, &scene, general)?;
    let choice = if precision == Precision::F64 { DeviceChoice::Cpu } else { command.device };
    let device = Device::open(choice, general)?;
    let mut prober = device.prober(scene, precision, command.exactness.into())?;
    let first_only = command.hits == HitsChoice::First;
    let mut out = BufWriter::with_capacity(1 << 16, std::io::stdout().lock());
    let mut counts = RayCounts::default();
    loop {
        let batch = lines.batch();
        let answered = batch.rays.len();
        let hits = prober.probe(&batch.rays, first_only)?;
        if command.stats {
            let rays = batch.rays.par_iter().copied();
            counts += count_steps(&scene, rays, Exactness::from(command.exactness), first_only);
        }
        for (ray, hits) in batch.rays.iter().zip(&hits) {
            write_hits(&mut out, &scene, ray, hits)?;
        }
        // What was read before a wrong line is answered before the complaint.
        out.flush()?;
        batch.end?;
        if answered < RAYS_AT_A_TIME {
            break;
        }
    }
    if command.stats {
        RayReport::of(&counts).write(&mut std::io::stderr())?;
    }
    Ok(())
}

fn precision(
    command: &Probe,
    wants_f64: bool,
    scene: &Scene<'_>,
    general: &General,
) -> anyhow::Result<Precision> {
    if !wants_f64 {
        return Ok(Precision::F32);
    }
    if scene.has_f64() {
        return Ok(Precision::F64);
    }
    let file = command.input.display();
    if command.precision.is_some() {
        bail!("{file}: baked without f64 geometry; bake it with --keep-f64, or ask for --precision f32");
    }
    if !general.quiet {
        writeln!(std::io::stderr(), "{file}: baked without f64 geometry, answering in f32")?;
    }
    Ok(Precision::F32)
}

/// What people get of a hit.
#[derive(Serialize)]
struct HitLine<'a> {
    t: f64,
    p: [f64; 3],
    n: [f64; 3],
    u: f64,
    v: f64,
    face: u32,
    entity: String,
    part: &'a str,
}

#[derive(Serialize)]
struct HitsLine<'a> {
    hits: Vec<HitLine<'a>>,
}

fn write_hits(out: &mut impl Write, scene: &Scene<'_>, ray: &Ray, hits: &[Hit]) -> anyhow::Result<()> {
    let hits = hits.iter().map(|hit| hit_line(scene, ray, hit)).collect();
    serde_json::to_writer(&mut *out, &HitsLine { hits }).map_err(std::io::Error::from)?;
    out.write_all(b"\n")?;
    Ok(())
}

fn hit_line<'a>(scene: &Scene<'a>, ray: &Ray, hit: &Hit) -> HitLine<'a> {
    let face = scene.face_infos.get(hit.face as usize);
    let part =
        scene.instances.get(hit.instance as usize).and_then(|i| scene.metadata.parts.get(i.part as usize));
    HitLine {
        t: hit.t,
        p: ray.at(hit.t).to_array(),
        n: hit.normal.to_array(),
        u: hit.uv[0],
        v: hit.uv[1],
        face: hit.face,
        entity: face.map(|f| format!("#{}", f.entity)).unwrap_or_default(),
        part: part.map_or("", |p| &p.name),
    }
}
