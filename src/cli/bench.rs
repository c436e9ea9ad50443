//! `trimray bench`: measurements.

use super::args::{General, PrecisionChoice};
use super::args_bench::{Bench, BenchCommand, BenchStages};
use super::bake::size_text;
use super::{bench_accuracy, bench_leaks, bench_stress, bench_trim, bench_work};
use crate::bench::{Stages, measure_stages};
use crate::render::Ray;
use crate::render::cpu::Precision;
use serde::Serialize;
use std::io::Write;
use std::path::Path;

pub(super) fn run(command: &Bench, general: &General) -> anyhow::Result<()> {
    match &command.command {
        BenchCommand::Stages(command) => stages(command),
        BenchCommand::Accuracy(command) => bench_accuracy::run(command, general),
        BenchCommand::Work(command) => bench_work::run(command),
        BenchCommand::Leaks(command) => bench_leaks::run(command),
        BenchCommand::Stress(command) => bench_stress::run(command),
        BenchCommand::Trim(command) => bench_trim::run(command, general),
    }
}

/// The precisions that a bench computes in, and their names: the one that was asked for, or both.
pub(super) fn precisions(
    wanted: Option<PrecisionChoice>,
) -> impl Iterator<Item = (&'static str, Precision)> + Clone {
    let all = [("f32", PrecisionChoice::F32, Precision::F32), ("f64", PrecisionChoice::F64, Precision::F64)];
    let is_wanted = move |choice| wanted.is_none_or(|wanted| wanted == choice);
    all.into_iter()
        .filter(move |&(_, choice, _)| is_wanted(choice))
        .map(|(name, _, precision)| (name, precision))
}

/// An upper bound of a share of `count` things; nothing is known where there are none.
pub(super) fn rate_text(count: u64, bound: f64) -> String {
    if count == 0 { "-".to_owned() } else { format!("{bound:.0e}") }
}

/// Origin and direction of a ray, for JSON.
pub(super) fn ray_numbers(ray: Ray) -> [[f64; 3]; 2] {
    [ray.origin.to_array(), ray.direction.to_array()]
}

/// A line of JSON. Names of fields stay.
#[derive(Serialize)]
struct Line<'a> {
    file: std::borrow::Cow<'a, str>,
    bytes: usize,
    entities: usize,
    faces: usize,
    baked_faces: usize,
    seconds: Times,
}

/// See [`crate::bench::Seconds`].
#[derive(Serialize)]
struct Times {
    read: f64,
    scan: f64,
    decode: f64,
    map: f64,
    trims: f64,
    bake: f64,
    import: f64,
    total: f64,
}

fn stages(command: &BenchStages) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    for path in &command.inputs {
        let stages = measure_stages(path, usize::from(command.repeat))?;
        if command.json {
            serde_json::to_writer(&mut out, &line(path, &stages)).map_err(std::io::Error::from)?;
            writeln!(out)?;
        } else {
            write_table(&mut out, path, &stages)?;
        }
    }
    Ok(())
}

fn line<'a>(path: &'a Path, stages: &Stages) -> Line<'a> {
    let s = stages.seconds;
    let seconds = Times {
        read: s.read,
        scan: s.scan,
        decode: s.decode,
        map: s.map,
        trims: s.trims,
        bake: s.bake,
        import: s.import,
        total: s.total,
    };
    Line {
        file: path.to_string_lossy(),
        bytes: stages.bytes,
        entities: stages.entities,
        faces: stages.faces,
        baked_faces: stages.baked_faces,
        seconds,
    }
}

fn write_table(out: &mut impl Write, path: &Path, stages: &Stages) -> std::io::Result<()> {
    let Stages { bytes, entities, faces, baked_faces, seconds } = *stages;
    writeln!(
        out,
        "{}: {}, {entities} entities, {faces} faces, {baked_faces} baked",
        path.display(),
        size_text(bytes as u64)
    )?;
    writeln!(out, "  {:<24}{:>10}{:>10}{:>12}", "stage", "ms", "MB/s", "faces/s")?;
    for (stage, time) in [
        ("read", seconds.read),
        ("scan", seconds.scan),
        ("decode, on its own", seconds.decode),
        ("map, which decodes too", seconds.map),
        ("trims", seconds.trims),
        ("bake", seconds.bake),
        ("file to model", seconds.import),
        ("file to baked scene", seconds.total),
    ] {
        let rate = |amount: f64| amount / time.max(1e-9);
        writeln!(
            out,
            "  {stage:<24}{:>10.2}{:>10.1}{:>12.0}",
            time * 1e3,
            rate(bytes as f64 * 1e-6),
            rate(faces as f64)
        )?;
    }
    Ok(())
}
