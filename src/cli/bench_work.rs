//! `trimray bench work`: run time against error, as a table, as CSV and as a plot.

use super::args_bench::BenchWork;
use crate::bench::{PlotPoint, WorkPoint, logarithmic_svg, measure_work};
use crate::import::import;
use anyhow::Context;
use std::fmt::Write as _;
use std::fs;
use std::io::Write;

/// The columns of the rows, which tools/rival writes too.
const COLUMNS: &str =
    "model,series,setting,build_seconds,bytes,nanoseconds,median,p99,p999,max,compared,missed,phantom";

pub(super) fn run(command: &BenchWork) -> anyhow::Result<()> {
    let model = import(&command.input)?;
    let rival = match &command.rival {
        None => Vec::new(),
        Some(path) => {
            let text = fs::read_to_string(path).with_context(|| path.display().to_string())?;
            rows_of(&text).with_context(|| path.display().to_string())?
        }
    };
    let points = measure_work(&model, command.first, command.rays);
    let mut out = std::io::stdout().lock();
    write_table(&mut out, &points)?;
    let name = command.input.display().to_string();
    if let Some(path) = &command.csv {
        fs::write(path, csv_of(&name, &points)).with_context(|| path.display().to_string())?;
    }
    if let Some(path) = &command.plot {
        let own =
            points.iter().map(|p| PlotPoint { series: p.series.clone(), x: p.error.p999, y: p.nanoseconds });
        let all: Vec<PlotPoint> = own.chain(rival).collect();
        let labels = ["99.9th percentile of the error, in diagonals", "nanoseconds a ray"];
        fs::write(path, logarithmic_svg(&name, labels, &all)).with_context(|| path.display().to_string())?;
    }
    Ok(())
}

fn write_table(out: &mut impl Write, points: &[WorkPoint]) -> std::io::Result<()> {
    writeln!(
        out,
        "{:<14}{:>12}{:>10}{:>11}{:>8}{:>10}{:>10}{:>10}{:>10}{:>8}{:>9}",
        "",
        "setting",
        "bake, ms",
        "bytes",
        "ns/ray",
        "median",
        "p99.9",
        "max",
        "certain",
        "missed",
        "phantom"
    )?;
    for p in points {
        writeln!(
            out,
            "{:<14}{:>12}{:>10.1}{:>11}{:>8.0}{:>10.1e}{:>10.1e}{:>10.1e}{:>10}{:>8}{:>9}",
            p.series,
            p.setting,
            p.build_seconds * 1e3,
            p.bytes,
            p.nanoseconds,
            p.error.median,
            p.error.p999,
            p.error.max,
            p.certain,
            p.missed,
            p.phantom
        )?;
    }
    out.flush()
}

fn csv_of(model: &str, points: &[WorkPoint]) -> String {
    let mut text = format!("{COLUMNS}\n");
    let model = model.replace([',', '\n'], " ");
    for p in points {
        let q = p.error;
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{model},{},{},{:e},{},{:.1},{:e},{:e},{:e},{:e},{},{},{}",
            p.series,
            p.setting,
            p.build_seconds,
            p.bytes,
            p.nanoseconds,
            q.median,
            q.p99,
            q.p999,
            q.max,
            p.certain,
            p.missed,
            p.phantom
        );
    }
    text
}

/// The points of rows as [`csv_of`] writes them.
fn rows_of(text: &str) -> anyhow::Result<Vec<PlotPoint>> {
    let mut lines = text.lines();
    anyhow::ensure!(lines.next() == Some(COLUMNS), "its first line should be `{COLUMNS}`");
    lines
        .enumerate()
        .map(|(index, line)| {
            let fields: Vec<&str> = line.split(',').collect();
            let number = |k: usize| {
                let field = fields.get(k).copied().unwrap_or_default();
                field.parse::<f64>().with_context(|| format!("line {}: `{field}` is no number", index + 2))
            };
            let series = fields.get(1).copied().unwrap_or_default().to_owned();
            Ok(PlotPoint { series, x: number(8)?, y: number(5)? })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::Quantiles;

    #[test]
    fn rows_are_read_as_they_are_written() {
        let error = Quantiles { median: 1e-9, p99: 1e-8, p999: 2.5e-7, max: 1e-6 };
        let point = WorkPoint {
            series: "exact f32".to_owned(),
            setting: "0.125".to_owned(),
            build_seconds: 0.5,
            bytes: 1000,
            nanoseconds: 321.5,
            error,
            certain: 10,
            missed: 1,
            phantom: 2,
        };
        let rows = rows_of(&csv_of("a,b", &[point])).expect("rows");
        assert_eq!(rows, [PlotPoint { series: "exact f32".to_owned(), x: 2.5e-7, y: 321.5 }]);
        assert!(rows_of("model\n").is_err());
        assert!(rows_of(&format!("{COLUMNS}\na,b,c\n")).is_err());
    }
}
