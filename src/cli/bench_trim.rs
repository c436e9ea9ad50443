//! `trimray bench trim`: the trimming study.

use super::args::General;
use super::args_bench_trim::BenchTrim;
use super::args_select::SelectionArguments;
use super::bench_trim_table::{
    Row, csv_header, csv_row, write_device, write_means, write_statistics, write_table,
};
use super::load::import_copies;
use super::progress::Progress;
use super::{bench_trim_degrees, bench_trim_json};
use crate::bake::{BakeOptions, TrimRegions, bake_with_regions};
#[cfg(feature = "gpu")]
use crate::bench::trim::measure_on_gpu;
use crate::bench::trim::{
    DeviceMeasure, MethodMeasure, QuerySet, StudyOptions, TrimStatistics, check_methods, measure_methods,
    query_sets, statistics,
};
#[cfg(feature = "gpu")]
use crate::render::gpu::{AdapterChoice, Gpu};
use crate::scene::{Scene, SceneBuffers};
use anyhow::{Context, anyhow};
use std::fs;
use std::io::Write;
use std::path::Path;

pub(super) fn run(command: &BenchTrim, general: &General) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    let mut csv = csv_header();
    let mut tables: Vec<Vec<Row>> = Vec::new();
    let mut curves = Vec::new();
    let device = if command.gpu { Some(Device::open()?) } else { None };
    for path in &command.inputs {
        let mut study = Study::open(path, command, general)?;
        if let Some(count) = command.check {
            check(&mut out, path, &mut study, command, count)?;
        } else if let Some(degrees) = &command.degrees {
            let points = bench_trim_degrees::measure(&mut study, command, &degrees.0)
                .map_err(|reason| anyhow!("{}: {reason}", path.display()))?;
            bench_trim_degrees::write(&mut out, path, &points)?;
            curves.extend(bench_trim_degrees::lines(path, command.inputs.len() > 1, &points));
        } else {
            let measured = measure(&mut study, path, command, device.as_ref(), general)?;
            let rows = Row::table(&measured);
            if command.json {
                bench_trim_json::write(&mut out, path, &study.statistics, &measured)?;
            } else {
                write_statistics(&mut out, path, &study.statistics)?;
                write_table(&mut out, &rows)?;
                if let Some(device) = &device {
                    write_device(&mut out, &device.name(), &measured)?;
                }
            }
            csv.extend(measured.iter().map(|method| csv_row(path, method)));
            tables.push(rows);
        }
    }
    if tables.len() > 1 && !command.json {
        write_means(&mut out, &tables)?;
    }
    if let Some(path) = &command.csv {
        fs::write(path, csv).with_context(|| path.display().to_string())?;
    }
    if let Some(path) = &command.plot {
        let svg = bench_trim_degrees::svg(&curves);
        fs::write(path, svg).with_context(|| path.display().to_string())?;
    }
    Ok(())
}

/// A baked model that can be trimmed anew.
pub(super) struct Study {
    pub(super) scene: SceneBuffers,
    pub(super) regions: TrimRegions,
    pub(super) statistics: TrimStatistics,
    pub(super) options: StudyOptions,
}

impl Study {
    fn open(path: &Path, command: &BenchTrim, general: &General) -> anyhow::Result<Self> {
        let bake_options = BakeOptions::default();
        let model = import_copies(path, &SelectionArguments::default(), command.replicate, &bake_options)?;
        let progress = Progress::new(format!("Baking {}", path.display()), general);
        let tell = |done, total| progress.tell(done, total);
        let (scene, regions) = bake_with_regions(&model, &bake_options, &tell);
        anyhow::ensure!(!scene.faces.is_empty(), "{}: it has no faces to trim", path.display());
        let options = StudyOptions {
            resolution: command.resolution,
            rays: command.rays,
            most_queries: command.queries as usize,
            timed_rays: command.timed_rays as usize,
            runs: usize::from(command.repeat),
        };
        Ok(Self { statistics: statistics(&model, &scene, &regions), scene, regions, options })
    }
}

/// A GPU, or a software driver that poses as one.
struct Device {
    #[cfg(feature = "gpu")]
    gpu: Gpu,
}

#[cfg(feature = "gpu")]
impl Device {
    fn open() -> anyhow::Result<Self> {
        Ok(Self { gpu: Gpu::new(AdapterChoice::Any)? })
    }

    fn name(&self) -> String {
        self.gpu.name().to_owned()
    }

    fn measure(
        &self,
        scene: &Scene<'_>,
        set: &QuerySet,
        expected: &[bool],
        runs: usize,
    ) -> Result<DeviceMeasure, String> {
        measure_on_gpu(&self.gpu, scene, set, expected, runs)
    }
}

#[cfg(not(feature = "gpu"))]
impl Device {
    fn open() -> anyhow::Result<Self> {
        Err(anyhow!("this trimray was built without the `gpu` feature"))
    }

    fn name(&self) -> String {
        String::new()
    }

    fn measure(&self, _: &Scene<'_>, _: &QuerySet, _: &[bool], _: usize) -> Result<DeviceMeasure, String> {
        Err("there is no GPU".to_owned())
    }
}

fn measure(
    study: &mut Study,
    path: &Path,
    command: &BenchTrim,
    device: Option<&Device>,
    general: &General,
) -> anyhow::Result<Vec<MethodMeasure>> {
    let Study { scene, regions, options, .. } = study;
    let in_file = |reason: String| anyhow!("{}: {reason}", path.display());
    let sets = query_sets(scene, regions, options).map_err(in_file)?;
    let progress = Progress::new(format!("Measuring {}", path.display()), general);
    let tell = |done, total| progress.tell(done, total);
    let beside = |scene: &Scene<'_>, set: &QuerySet, answers: &[bool]| {
        device.map(|device| device.measure(scene, set, answers, options.runs)).transpose()
    };
    measure_methods(scene, regions, &sets, &command.methods.list, options, &beside, &tell).map_err(in_file)
}

fn check(
    out: &mut impl Write,
    path: &Path,
    study: &mut Study,
    command: &BenchTrim,
    count: u64,
) -> anyhow::Result<()> {
    let found = check_methods(&mut study.scene, &study.regions, &command.methods.list, count)
        .map_err(|reason| anyhow!("{}: {reason}", path.display()))?;
    let wrong: u64 = found.methods.iter().map(|method| method.wrong).sum();
    writeln!(
        out,
        "{}: {} trimmed faces, {} points, {} judged, {} methods, {wrong} wrong answers",
        path.display(),
        found.faces,
        found.points,
        found.judged,
        found.methods.len()
    )?;
    for method in found.methods.iter().filter(|method| method.wrong > 0) {
        write!(out, "  {:<14}{:>10}", method.method.label(), method.wrong)?;
        if let Some(query) = method.example {
            let [u, v] = query.uv;
            let judge = study.regions.judge(query.face as usize);
            let distance = judge.distance([f64::from(u), f64::from(v)]);
            write!(out, "  such as ({u}, {v}) of face {}, {distance:.1e} from a curve", query.face)?;
        }
        writeln!(out)?;
    }
    out.flush()?;
    Ok(())
}
