//! `trimray bench stages`: times from a file to a picture, as a table, as JSON, against an earlier run, and as they grow.

use super::args::General;
use super::args_bench::BenchStages;
use super::bake::size_text;
use super::device::Device;
use crate::bench::{
    FrameLoad, FrameWork, PlotPoint, Stage, Stages, growth_exponent, logarithmic_svg, measure_frames,
    measure_kernel, measure_stages, primary_rays, random_rays,
};
use crate::render::{Coherence, Exactness, Ray};
use crate::scene::Scene;
use anyhow::Context;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs;
use std::io::Write;
use std::path::Path;
use std::time::Instant;

/// A line of JSON. Names of fields stay.
#[derive(Debug, Serialize, Deserialize)]
struct Line {
    file: String,
    /// Copies along each axis.
    copies: u32,
    bytes: usize,
    entities: usize,
    faces: usize,
    /// A face of a part counts once.
    baked_faces: usize,
    leaves: usize,
    cache_bytes: u64,
    /// What computed pictures and rays.
    device: Option<String>,
    /// In a run of the primary rays.
    primary_rays: u64,
    /// In a run of the random rays.
    random_rays: u64,
    /// By the names of stages: the rays that the kernels were timed with.
    #[serde(default)]
    held: BTreeMap<String, Held>,
    /// By the names of stages: the least times.
    seconds: BTreeMap<String, f64>,
    median_seconds: BTreeMap<String, f64>,
}

/// Rays on the device: those of a run that can meet the scene, and how many of them hit it.
#[derive(Debug, Clone, Copy, Serialize, Deserialize)]
struct Held {
    rays: u64,
    hits: u64,
}

impl Line {
    fn least(&self, stage: Stage) -> Option<f64> {
        self.seconds.get(stage.name()).copied()
    }

    /// What a stage works through in a second, with its unit.
    fn rate(&self, stage: Stage) -> Option<String> {
        let seconds = self.least(stage)?.max(1e-9);
        Some(match stage {
            Stage::Read | Stage::Scan | Stage::Decode | Stage::Map | Stage::Import | Stage::Total => {
                format!("{:.1} MB/s", self.bytes as f64 * 1e-6 / seconds)
            }
            Stage::Trims | Stage::TrimTrees | Stage::Bvhs | Stage::Bake => {
                format!("{:.0} faces/s", self.baked_faces as f64 / seconds)
            }
            Stage::Nets | Stage::Leaves => format!("{:.0} leaves/s", self.leaves as f64 / seconds),
            Stage::Write | Stage::Open | Stage::Upload => {
                format!("{:.0} MB/s", self.cache_bytes as f64 * 1e-6 / seconds)
            }
            Stage::Primary => format!("{:.2} Mrays/s", self.primary_rays as f64 * 1e-6 / seconds),
            Stage::Random => format!("{:.2} Mrays/s", self.random_rays as f64 * 1e-6 / seconds),
            Stage::PrimaryKernel | Stage::RandomKernel => {
                let held = self.held.get(stage.name())?;
                format!("{:.2} Mrays/s", held.rays as f64 * 1e-6 / seconds)
            }
            Stage::FirstRay | Stage::KeptFirstRay | Stage::Compile | Stage::FirstFrame | Stage::Frame => {
                return None;
            }
        })
    }
}

pub(super) fn run(command: &BenchStages, general: &General) -> anyhow::Result<()> {
    let earlier = match &command.compare {
        Some(path) => lines_of(path)?,
        None => Vec::new(),
    };
    let mut device = command.frames.then(|| Device::open(command.device, general)).transpose()?;
    #[cfg(feature = "gpu")]
    if let Some(device) = &mut device {
        device.wait();
    }
    let folder = tempfile::tempdir().context("a folder for the baked scene")?;
    let mut out = std::io::stdout().lock();
    let mut plotted = Vec::new();
    for path in &command.inputs {
        let mut grown = Vec::new();
        for &copies in &command.grow {
            let scratch = folder.path().join("scene.trimray");
            let mut stages = measure_stages(path, &scratch, copies, usize::from(command.repeat))
                .with_context(|| path.display().to_string())?;
            let held = match &mut device {
                Some(device) => frames(command, device, &mut stages)?,
                None => BTreeMap::new(),
            };
            let line =
                Line { held, ..line(path, copies, command, &stages, device.as_ref().map(Device::name)) };
            if command.json {
                serde_json::to_writer(&mut out, &line).map_err(std::io::Error::from)?;
                writeln!(out)?;
            } else {
                let was = earlier.iter().find(|was| was.file == line.file && was.copies == copies);
                write_table(&mut out, &line, was)?;
            }
            out.flush()?;
            grown.push(line);
        }
        if grown.len() > 1 {
            if !command.json {
                write_growth(&mut out, &grown)?;
            }
            plotted.extend(plot_points(&grown));
        }
    }
    if let Some(path) = &command.plot {
        let names = command.inputs.iter().filter_map(|input| input.file_name());
        let names: Vec<_> = names.map(|name| name.to_string_lossy()).collect();
        let svg = logarithmic_svg(&names.join(", "), ["faces", "seconds"], &plotted);
        fs::write(path, svg).with_context(|| path.display().to_string())?;
    }
    Ok(())
}

/// Goes on to the device, to pictures and to rays; what kernels were timed with, if there are any.
fn frames(
    command: &BenchStages,
    device: &mut Device<'_>,
    stages: &mut Stages,
) -> anyhow::Result<BTreeMap<String, Held>> {
    let Stages { scene, times, .. } = stages;
    let scene: Scene<'_> = scene.scene();
    let mut held = BTreeMap::new();
    if scene.faces.is_empty() {
        return Ok(held);
    }
    let load = load(command);
    let start = Instant::now();
    let mut renderer = device.renderer(scene)?;
    times.add(Stage::Upload, start.elapsed().as_secs_f64());
    if !command.kernels {
        measure_frames(&scene, &load, times, &mut |work| match work {
            FrameWork::Picture(camera, options) => {
                std::hint::black_box(renderer.render(camera, options, &|_, _| {})?);
                Ok(())
            }
            FrameWork::FirstHits(rays) => {
                std::hint::black_box(renderer.probe(rays, true, Exactness::default())?);
                anyhow::Ok(())
            }
        })?;
    }
    let rays: [(Stage, RayMaker, Coherence); 2] = [
        (Stage::PrimaryKernel, primary_rays, Coherence::Coherent),
        (Stage::RandomKernel, random_rays, Coherence::Incoherent),
    ];
    for (stage, make, coherence) in rays {
        let Some(work) = renderer.hold_rays(|| make(&scene, &load), coherence)? else {
            anyhow::ensure!(!command.kernels, "there is no GPU whose kernels could be timed");
            continue;
        };
        measure_kernel(stage, &load, times, || renderer.run_held(&work))?;
        let (rays, hits) = renderer.count_held(&work)?;
        held.insert(stage.name().to_owned(), Held { rays, hits });
    }
    Ok(held)
}

/// Makes the rays of a stage.
type RayMaker = fn(&Scene<'_>, &FrameLoad) -> Vec<Ray>;

fn load(command: &BenchStages) -> FrameLoad {
    FrameLoad {
        resolution: command.resolution,
        samples: command.rays_per_pixel,
        rays: command.rays,
        warm_ups: usize::from(command.warm_ups),
        repeat: usize::from(command.repeat),
    }
}

fn line(path: &Path, copies: u32, command: &BenchStages, stages: &Stages, device: Option<&str>) -> Line {
    let of = |time: &dyn Fn(Stage) -> Option<f64>| -> BTreeMap<String, f64> {
        Stage::ALL.iter().filter_map(|&stage| Some((stage.name().to_owned(), time(stage)?))).collect()
    };
    let load = load(command);
    Line {
        file: path.display().to_string(),
        copies,
        bytes: stages.bytes,
        entities: stages.entities,
        faces: stages.faces,
        baked_faces: stages.scene.faces.len(),
        leaves: stages.scene.net_leaves.len(),
        cache_bytes: stages.cache_bytes,
        device: device.map(str::to_owned),
        primary_rays: load.primary_rays(),
        random_rays: load.rays,
        held: BTreeMap::new(),
        seconds: of(&|stage| stages.times.least(stage)),
        median_seconds: of(&|stage| stages.times.median(stage)),
    }
}

fn lines_of(path: &Path) -> anyhow::Result<Vec<Line>> {
    let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
    let line = |(index, line): (usize, &str)| {
        serde_json::from_str(line).with_context(|| {
            format!("{}: line {} is not of `bench stages --json`", path.display(), index + 1)
        })
    };
    text.lines().enumerate().filter(|(_, line)| !line.trim().is_empty()).map(line).collect()
}

fn write_table(out: &mut impl Write, line: &Line, was: Option<&Line>) -> std::io::Result<()> {
    write!(
        out,
        "{}: {}, {} entities, {} faces",
        line.file,
        size_text(line.bytes as u64),
        line.entities,
        line.faces
    )?;
    if line.copies > 1 {
        write!(out, " in {0} by {0} by {0} copies", line.copies)?;
    }
    writeln!(
        out,
        ", {} baked, {} leaves, {} as .trimray",
        line.baked_faces,
        line.leaves,
        size_text(line.cache_bytes)
    )?;
    if let Some(device) = &line.device {
        writeln!(out, "  pictures and rays on {device}")?;
    }
    let [earlier, share] = if was.is_some() { ["was, ms", "now / was"] } else { [""; 2] };
    writeln!(out, "  {:<24}{:>11}{:>11}{:>18}{earlier:>11}{share:>11}", "stage", "ms", "median", "rate")?;
    for stage in Stage::ALL {
        let Some(seconds) = line.least(stage) else { continue };
        let median = line.median_seconds.get(stage.name()).copied().unwrap_or(seconds);
        let rate = line.rate(stage).unwrap_or_default();
        write!(out, "  {:<24}{:>11.2}{:>11.2}{rate:>18}", stage.label(), seconds * 1e3, median * 1e3)?;
        if let Some(was) = was.and_then(|was| was.least(stage)) {
            write!(out, "{:>11.2}{:>11.2}", was * 1e3, seconds / was.max(1e-12))?;
        }
        writeln!(out)?;
    }
    Ok(())
}

/// Those stages whose work is made more by copies.
fn growing_stages() -> impl Iterator<Item = Stage> {
    let is_of_file = |stage: &Stage| {
        matches!(stage, Stage::Read | Stage::Scan | Stage::Decode | Stage::Map | Stage::Import | Stage::Total)
    };
    Stage::ALL.into_iter().filter(move |stage| !is_of_file(stage))
}

/// Faces and seconds of a stage.
fn growth(lines: &[Line], stage: Stage) -> Vec<[f64; 2]> {
    lines.iter().filter_map(|line| Some([line.baked_faces as f64, line.least(stage)?])).collect()
}

fn write_growth(out: &mut impl Write, lines: &[Line]) -> std::io::Result<()> {
    writeln!(out, "  time grows like a power of the number of faces, with the exponent")?;
    for stage in growing_stages() {
        if let Some(exponent) = growth_exponent(&growth(lines, stage)) {
            writeln!(out, "  {:<24}{exponent:>11.2}", stage.label())?;
        }
    }
    Ok(())
}

/// Those that a plot shows: as many as it has colours.
const PLOTTED: [Stage; 7] =
    [Stage::Trims, Stage::Bake, Stage::Bvhs, Stage::Write, Stage::FirstRay, Stage::Frame, Stage::Random];

fn plot_points(lines: &[Line]) -> Vec<PlotPoint> {
    let of_stage = |stage: Stage| {
        let series = stage.label().trim().to_owned();
        growth(lines, stage).into_iter().map(move |[x, y]| PlotPoint { series: series.clone(), x, y })
    };
    PLOTTED.into_iter().flat_map(of_stage).collect()
}
