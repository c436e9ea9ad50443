//! `trimray bench accuracy`: hits against the reference.

use super::args::General;
use super::args_bench::BenchAccuracy;
use super::bench::ray_numbers;
use super::load::{Purpose, load};
use crate::bench::{Accuracy, Quantiles, measure_accuracy};
use crate::render::cpu::Precision;
use crate::render::reference::{Reference, widened};
use serde::Serialize;
use std::io::Write;
use std::path::Path;

/// A line of JSON. Names of fields stay.
#[derive(Serialize)]
struct Line<'a> {
    file: std::borrow::Cow<'a, str>,
    precision: &'static str,
    against: &'static str,
    rays: u64,
    certain: u64,
    hits: u64,
    missed: u64,
    phantom: u64,
    distance: Errors,
    steep_distance: Errors,
    normal: Errors,
    microseconds: f64,
    /// Origin and direction of the first ray with a hit missed or made up.
    #[serde(skip_serializing_if = "Option::is_none")]
    wrong: Option<[[f64; 3]; 2]>,
}

/// See [`Quantiles`].
#[derive(Serialize)]
struct Errors {
    median: f64,
    p99: f64,
    p999: f64,
    max: f64,
}

pub(super) fn run(command: &BenchAccuracy, general: &General) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    if !command.json {
        write_head(&mut out)?;
    }
    for path in &command.inputs {
        let loaded = load(path, Purpose { keep_f64: true, ..Purpose::default() }, general)?;
        let scene = loaded.scene();
        anyhow::ensure!(scene.has_f64(), "{}: bake it with --keep-f64", path.display());
        let baked = widened(&scene);
        let cases = [
            ("f32", Precision::F32, "tracer", baked.scene()),
            ("f32", Precision::F32, "total", scene),
            ("f64", Precision::F64, "tracer", scene),
        ];
        for (precision, kind, against, truth) in cases {
            let reference = Reference::new(truth);
            let accuracy =
                measure_accuracy(&scene, &reference, kind, command.distance, command.first, command.rays);
            if command.json {
                let line = line(path, precision, against, &accuracy);
                serde_json::to_writer(&mut out, &line).map_err(std::io::Error::from)?;
                writeln!(out)?;
            } else {
                write_row(&mut out, path, precision, against, &accuracy)?;
            }
            out.flush()?;
        }
    }
    Ok(())
}

fn line<'a>(path: &'a Path, precision: &'static str, against: &'static str, found: &Accuracy) -> Line<'a> {
    let Accuracy {
        rays,
        certain,
        hits,
        missed,
        phantom,
        distance,
        steep_distance,
        normal,
        seconds,
        wrong,
        ..
    } = *found;
    let errors = |q: Quantiles| Errors { median: q.median, p99: q.p99, p999: q.p999, max: q.max };
    Line {
        file: path.to_string_lossy(),
        precision,
        against,
        rays,
        certain,
        hits,
        missed,
        phantom,
        distance: errors(distance),
        steep_distance: errors(steep_distance),
        normal: errors(normal),
        microseconds: seconds * 1e6,
        wrong: wrong.map(ray_numbers),
    }
}

fn write_head(out: &mut impl Write) -> std::io::Result<()> {
    writeln!(
        out,
        "{:<4}{:<8}{:>10}{:>10}{:>8}{:>9}{:>10}{:>10}{:>10}{:>10}{:>10}{:>8}  file",
        "",
        "against",
        "certain",
        "hits",
        "missed",
        "phantom",
        "median",
        "p99.9",
        "steep",
        "max",
        "angle",
        "µs/ray"
    )
}

fn write_row(
    out: &mut impl Write,
    path: &Path,
    precision: &str,
    against: &str,
    found: &Accuracy,
) -> std::io::Result<()> {
    let Accuracy { certain, hits, missed, phantom, distance, steep_distance, normal, seconds, .. } = found;
    writeln!(
        out,
        "{precision:<4}{against:<8}{certain:>10}{hits:>10}{missed:>8}{phantom:>9}{:>10.1e}{:>10.1e}{:>10.1e}{:>10.1e}{:>10.1e}{:>8.2}  {}",
        distance.median,
        distance.p999,
        steep_distance.p999,
        distance.max,
        normal.p999,
        seconds * 1e6,
        path.display()
    )
}
