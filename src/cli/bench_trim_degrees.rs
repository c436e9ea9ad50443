//! `trimray bench trim --degrees`: the time of trims by the degree of the curves, as a table and as a plot.

use super::args_bench_trim::BenchTrim;
use super::bench_trim::Study;
use crate::bake::Lines;
use crate::bench::trim::{DEGREE_METHODS, DegreePoint, measure_degrees, query_sets};
use crate::bench::{PlotLine, lines_svg};
use crate::scene::TrimMethod;
use std::io::{self, Write};
use std::path::Path;

/// The number of the method whose time at the least degree is 1: 3-HS.
const REFERENCE: u32 = 3;

/// Random queries, asked of the methods of Figure 9 or of those asked for.
pub(super) fn measure(
    study: &mut Study,
    command: &BenchTrim,
    degrees: &[usize],
) -> Result<Vec<DegreePoint>, String> {
    let Study { scene, regions, options, .. } = study;
    let methods: Vec<TrimMethod> = if command.methods.is_all {
        DEGREE_METHODS.iter().filter_map(|&number| TrimMethod::from_number(number)).collect()
    } else {
        command.methods.list.clone()
    };
    let sets = query_sets(scene, regions, options)?;
    let Some(random) = sets.last() else { return Ok(Vec::new()) };
    measure_degrees(scene, regions, &random.queries, &methods, degrees, options)
}

/// A method's name; with what becomes of lines where it matters.
fn name(point: &DegreePoint) -> String {
    match (point.method, point.lines) {
        (method, Lines::Kept) => format!("{}, lines kept", method.label()),
        (method, Lines::Elevated) => method.label(),
    }
}

/// Names in order of the methods, each with its degrees and its times relative to 3-HS (or the first method) at the least degree.
fn series(points: &[DegreePoint]) -> Vec<(String, Vec<(usize, f64)>)> {
    let is_reference = |point: &&DegreePoint| point.method.number() == REFERENCE;
    let unit = points.iter().find(is_reference).or(points.first()).map_or(1.0, |point| point.nanoseconds);
    let mut series: Vec<(String, Vec<(usize, f64)>)> = Vec::new();
    for point in points {
        let name = name(point);
        let at = series.iter().position(|(other, _)| *other == name).unwrap_or_else(|| {
            series.push((name, Vec::new()));
            series.len() - 1
        });
        series[at].1.push((point.degree, point.nanoseconds / unit));
    }
    series
}

/// One file's table.
pub(super) fn write(out: &mut impl Write, path: &Path, points: &[DegreePoint]) -> io::Result<()> {
    let series = series(points);
    let Some((_, first)) = series.first() else { return Ok(()) };
    writeln!(
        out,
        "{}: time of a trim by degree, all curves raised, lines too where not said otherwise",
        path.display()
    )?;
    write!(out, "{:<24}", "")?;
    for (degree, _) in first {
        write!(out, "{degree:>7}")?;
    }
    writeln!(out)?;
    for (name, times) in &series {
        write!(out, "{name:<24}")?;
        for (_, time) in times {
            write!(out, "{time:>7.2}")?;
        }
        writeln!(out)?;
    }
    out.flush()
}

/// One file's lines of the plot.
pub(super) fn lines(path: &Path, many_files: bool, points: &[DegreePoint]) -> Vec<PlotLine> {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    let line = |(name, times): (String, Vec<(usize, f64)>)| PlotLine {
        name: if many_files { format!("{stem}: {name}") } else { name },
        points: times.into_iter().map(|(degree, time)| [degree as f64, time]).collect(),
    };
    series(points).into_iter().map(line).collect()
}

/// The plot.
pub(super) fn svg(lines: &[PlotLine]) -> String {
    let labels = ["degree of the trim curves", "time of a trim, relative"];
    lines_svg("Trims by degree", labels, lines)
}
