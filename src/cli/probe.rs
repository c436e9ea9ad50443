//! `trimray probe`: rays in, exact hits out, a line each.

use super::Failure;
use super::args::{DeviceChoice, General, HitsChoice, PrecisionChoice, Probe};
use super::device::Device;
use super::load::{Purpose, load, nothing};
use super::ray_report::RayReport;
use crate::render::cpu::{Precision, RayCounts, count_steps};
use crate::render::{Exactness, Hit, Ray};
use crate::scene::Scene;
use anyhow::{Context, bail, ensure};
use glam::DVec3;
use rayon::prelude::*;
use serde::Serialize;
use std::fs::File;
use std::io::{BufRead, BufReader, BufWriter, Read, Write};
use std::path::Path;

/// Rays answered at a time: enough to keep every core busy, few enough to keep memory small.
const BATCH: usize = 1 << 15;

pub(super) fn run(command: &Probe, general: &General) -> anyhow::Result<()> {
    let rays: Box<dyn BufRead> = if command.rays == Path::new("-") {
        Box::new(std::io::stdin().lock())
    } else {
        let file = File::open(&command.rays).with_context(|| command.rays.display().to_string())?;
        Box::new(BufReader::new(file))
    };
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
    let mut lines =
        RayLines { reader: rays, name: command.rays.display().to_string(), number: 0, text: Vec::new() };
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
        if answered < BATCH {
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

/// Lines of rays, a batch at a time.
struct RayLines {
    reader: Box<dyn BufRead>,
    name: String,
    number: usize,
    text: Vec<u8>,
}

/// Rays, and whether something was wrong after the last of them.
struct Batch {
    rays: Vec<Ray>,
    end: anyhow::Result<()>,
}

impl RayLines {
    /// The next [`BATCH`] rays; fewer at the end or before a wrong line.
    fn batch(&mut self) -> Batch {
        let mut rays = Vec::new();
        while rays.len() < BATCH {
            match self.next_ray() {
                Ok(Some(ray)) => rays.push(ray),
                Ok(None) => break,
                Err(error) => return Batch { rays, end: Err(error) },
            }
        }
        Batch { rays, end: Ok(()) }
    }

    fn next_ray(&mut self) -> anyhow::Result<Option<Ray>> {
        loop {
            self.text.clear();
            self.number += 1;
            // No ray needs more than a few hundred bytes; a file without line ends must not fill the memory.
            let read = (&mut self.reader).take(MAX_LINE).read_until(b'\n', &mut self.text);
            let context = || format!("{}: line {}", self.name, self.number);
            if read.with_context(context)? == 0 {
                return Ok(None);
            }
            let line = str::from_utf8(&self.text).with_context(context)?.trim();
            if !line.is_empty() && !line.starts_with('#') {
                return parse_ray(line).with_context(context).map(Some);
            }
        }
    }
}

/// Bytes that a line may have.
const MAX_LINE: u64 = 4096;

fn parse_ray(line: &str) -> anyhow::Result<Ray> {
    let mut numbers = [0.0; 6];
    let mut words = line.split_whitespace();
    for number in &mut numbers {
        let word = words.next().context("expected six numbers: ox oy oz dx dy dz")?;
        *number = word.parse().ok().with_context(|| format!("`{word}` is no number"))?;
        ensure!(f64::is_finite(*number), "`{word}` is not finite");
    }
    ensure!(words.next().is_none(), "more than six numbers");
    let [x, y, z, dx, dy, dz] = numbers;
    // Scaled first, so that neither tiny nor huge directions underflow or overflow in their length.
    let direction = DVec3::new(dx, dy, dz);
    let direction =
        (direction / direction.abs().max_element()).try_normalize().context("the direction is 0")?;
    Ok(Ray { origin: DVec3::new(x, y, z), direction })
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
    let face = scene.metadata.faces.get(hit.face as usize);
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

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &'static str) -> RayLines {
        RayLines { reader: Box::new(text.as_bytes()), name: "rays".into(), number: 0, text: Vec::new() }
    }

    #[test]
    fn rays_are_normalised_and_comments_skipped() {
        let batch = lines("# a comment\n\n0 1 2  0 0 -5\r\n1e3\t0 0 3 0 4").batch();
        batch.end.expect("all lines are good");
        let down = Ray { origin: DVec3::new(0.0, 1.0, 2.0), direction: -DVec3::Z };
        let slanted = Ray { origin: DVec3::new(1000.0, 0.0, 0.0), direction: DVec3::new(0.6, 0.0, 0.8) };
        assert_eq!(batch.rays[0], down);
        assert!((batch.rays[1].direction - slanted.direction).length() < 1e-15);
        assert_eq!(batch.rays[1].origin, slanted.origin);
    }

    #[test]
    fn a_wrong_line_is_named() {
        for (text, wanted) in [
            ("0 0 0 0 0 1\n0 0 0 0 0 0\n", "rays: line 2: the direction is 0"),
            ("#\n0 0 0 0 0\n", "rays: line 2: expected six numbers"),
            ("0 0 0 0 0 1 7\n", "rays: line 1: more than six"),
            ("0 0 zero 0 0 1\n", "rays: line 1: `zero` is no number"),
            ("0 0 nan 0 0 1\n", "rays: line 1: `nan` is not finite"),
            ("0 0 0 inf 0 1\n", "rays: line 1: `inf` is not finite"),
        ] {
            let error = lines(text).batch().end.expect_err(text);
            assert!(format!("{error:#}").starts_with(wanted), "{error:#}");
        }
    }

    #[test]
    fn tiny_and_huge_directions_are_directions() {
        for scale in ["1e-300", "1e300"] {
            let ray = parse_ray(&format!("0 0 0 {scale} 0 {scale}")).expect("a ray");
            assert!((ray.direction.length() - 1.0).abs() < 1e-12);
        }
    }
}
