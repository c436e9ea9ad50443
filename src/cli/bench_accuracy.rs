//! `trimray bench accuracy`: hits against the reference.

use super::args::General;
use super::args_bench::BenchAccuracy;
use super::bench::ray_numbers;
use super::load::{Purpose, load};
use crate::bench::{Accuracy, Quantiles, Tracer, measure_accuracy};
use crate::render::cpu::Precision;
use crate::render::reference::{Reference, widened};
use anyhow::Context;
use serde::Serialize;
use std::fs;
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
    misclassified: u64,
    distance: Errors,
    steep_distance: Errors,
    normal: Errors,
    parameters: Errors,
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
    let mut csv = match &command.csv {
        None => None,
        Some(path) => {
            let mut file = fs::File::create(path).with_context(|| path.display().to_string())?;
            writeln!(file, "{COLUMNS}")?;
            Some(file)
        }
    };
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
            let tracer = Tracer { precision: kind, exactness: command.exactness.into() };
            let accuracy =
                measure_accuracy(&scene, &reference, tracer, command.distance, command.first, command.rays);
            let line = line(path, precision, against, &accuracy);
            if let Some(file) = &mut csv {
                file.write_all(csv_row(&line).as_bytes())?;
            }
            if command.json {
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
        misclassified,
        distance,
        steep_distance,
        normal,
        parameters,
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
        misclassified,
        distance: errors(distance),
        steep_distance: errors(steep_distance),
        normal: errors(normal),
        parameters: errors(parameters),
        microseconds: seconds * 1e6,
        wrong: wrong.map(ray_numbers),
    }
}

/// The columns of [`csv_row`].
const COLUMNS: &str = "file,precision,against,rays,certain,hits,missed,phantom,misclassified,microseconds,\
    distance_median,distance_p99,distance_p999,distance_max,steep_median,steep_p99,steep_p999,steep_max,\
    normal_median,normal_p99,normal_p999,normal_max,uv_median,uv_p99,uv_p999,uv_max";

fn csv_row(line: &Line<'_>) -> String {
    let Line {
        precision, against, rays, certain, hits, missed, phantom, misclassified, microseconds, ..
    } = line;
    let file = line.file.replace([',', '\n'], " ");
    let counts = format!(
        "{file},{precision},{against},{rays},{certain},{hits},{missed},{phantom},{misclassified},{microseconds:.3}"
    );
    let errors = [&line.distance, &line.steep_distance, &line.normal, &line.parameters];
    let of = |Errors { median, p99, p999, max }: &Errors| format!(",{median:e},{p99:e},{p999:e},{max:e}");
    counts + &errors.map(of).concat() + "\n"
}

fn write_head(out: &mut impl Write) -> std::io::Result<()> {
    writeln!(
        out,
        "{:<4}{:<8}{:>10}{:>10}{:>8}{:>9}{:>7}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>8}  file",
        "",
        "against",
        "certain",
        "hits",
        "missed",
        "phantom",
        "trims",
        "median",
        "p99.9",
        "steep",
        "max",
        "angle",
        "uv",
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
    let Accuracy { certain, hits, missed, phantom, misclassified, distance, .. } = found;
    writeln!(
        out,
        "{precision:<4}{against:<8}{certain:>10}{hits:>10}{missed:>8}{phantom:>9}{misclassified:>7}{:>10.1e}{:>10.1e}{:>10.1e}{:>10.1e}{:>10.1e}{:>10.1e}{:>8.2}  {}",
        distance.median,
        distance.p999,
        found.steep_distance.p999,
        distance.max,
        found.normal.p999,
        found.parameters.p999,
        found.seconds * 1e6,
        path.display()
    )
}
