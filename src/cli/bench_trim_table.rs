//! The tables of `trimray bench trim`, in the layout of Table 3 of Sloup and Havran 2021: absolute numbers of the reference, then percentages.

use crate::bench::trim::{MethodMeasure, SetMeasure, TrimStatistics};
use crate::render::cpu::TrimCounts;
use crate::scene::TrimMethod;
use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

/// The number of the reference, 3-HS.
const REFERENCE: u32 = 3;

/// The number of the method whose trim memory is the reference, 1-LC.
const MEMORY_REFERENCE: u32 = 1;

/// Columns of percentages, in order: rays per second of primary and random rays, time to build, memory of all, exact tests, memory of trims, trims per
/// second on one thread for primary and random rays.
const PERCENTAGES: usize = 8;

/// A method beside the reference.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Row {
    pub(super) method: TrimMethod,
    /// What the percentages are relative to; exact tests per query.
    absolute: [f64; PERCENTAGES],
    /// See [`PERCENTAGES`]; NaN where the reference is 0 and the method is not.
    percent: [f64; PERCENTAGES],
    /// Steps per query.
    steps: f64,
    /// Curve evaluations per exact test.
    evaluations: f64,
    /// Queries answered otherwise than by the first method, and the greatest distance of one from a curve.
    different: (u64, f64),
}

/// Of all sets together.
fn counts(method: &MethodMeasure) -> TrimCounts {
    method.sets.iter().fold(TrimCounts::default(), |mut all, set| {
        all += set.counts;
        all
    })
}

/// `a / b`, 0 where both are.
pub(super) fn ratio(a: u64, b: u64) -> f64 {
    if a == 0 { 0.0 } else { a as f64 / b as f64 }
}

fn numbers(method: &MethodMeasure) -> [f64; PERCENTAGES] {
    let of_set = |index: usize, get: &dyn Fn(&SetMeasure) -> f64| method.sets.get(index).map_or(0.0, get);
    let counts = counts(method);
    [
        of_set(0, &|set| set.rays.best),
        of_set(1, &|set| set.rays.best),
        method.build_seconds,
        method.total_bytes as f64,
        ratio(counts.exact_tests, counts.queries),
        method.trim_bytes as f64,
        of_set(0, &|set| set.trims.best),
        of_set(1, &|set| set.trims.best),
    ]
}

/// What the numbers of `PERCENTAGES[k]` are relative to: the memory of trims to that of 1-LC, all else to 3-HS; the first method where they are not there.
fn reference(measured: &[MethodMeasure], column: usize) -> Option<&MethodMeasure> {
    let wanted = if column == 5 { MEMORY_REFERENCE } else { REFERENCE };
    measured.iter().find(|method| method.method.number() == wanted).or(measured.first())
}

impl Row {
    /// One for each method.
    pub(super) fn table(measured: &[MethodMeasure]) -> Vec<Self> {
        let references: [f64; PERCENTAGES] =
            std::array::from_fn(|k| reference(measured, k).map_or(0.0, |method| numbers(method)[k]));
        let row = |method: &MethodMeasure| {
            let absolute = numbers(method);
            let percent = std::array::from_fn(|k| match (absolute[k], references[k]) {
                (a, b) if a == b => 0.0,
                (_, 0.0) => f64::NAN,
                (a, b) => (a / b - 1.0) * 100.0,
            });
            let counts = counts(method);
            Self {
                method: method.method,
                absolute: references,
                percent,
                steps: ratio(counts.steps, counts.queries),
                evaluations: ratio(counts.evaluations, counts.exact_tests),
                different: method
                    .sets
                    .iter()
                    .fold((0, 0.0), |(count, worst), set| (count + set.different, set.worst.max(worst))),
            }
        };
        measured.iter().map(row).collect()
    }
}

/// The columns of Table 1.
pub(super) fn write_statistics(out: &mut impl Write, path: &Path, s: &TrimStatistics) -> io::Result<()> {
    let degrees: Vec<String> = s.degrees.iter().map(|(degree, count)| format!("{degree}:{count}")).collect();
    writeln!(
        out,
        "{}: {} surfaces ({} trimmed), {} Bézier nets in {} leaves, {} loops, {} trim curves, {} Bézier trim curves ({})",
        path.display(),
        s.surfaces,
        s.trimmed,
        s.nets,
        s.leaves,
        s.loops,
        s.curves,
        s.bezier_curves,
        degrees.join(" ")
    )
}

fn write_head(out: &mut impl Write) -> io::Result<()> {
    writeln!(
        out,
        "{:<14}{:>10}{:>10}{:>10}{:>10}{:>10}{:>10}{:>7}{:>7}{:>10}{:>10}",
        "",
        "primary",
        "random",
        "build",
        "memory",
        "tests",
        "trim mem",
        "steps",
        "evals",
        "trims pr",
        "trims rnd"
    )
}

fn write_percentages(
    out: &mut impl Write,
    name: &str,
    p: [f64; PERCENTAGES],
    rest: [f64; 2],
) -> io::Result<()> {
    let text = |percent: f64| if percent.is_nan() { "–".to_owned() } else { format!("{percent:+.2}") };
    write!(out, "{name:<14}")?;
    for percent in &p[..6] {
        write!(out, "{:>10}", text(*percent))?;
    }
    write!(out, "{:>7.2}{:>7.2}", rest[0], rest[1])?;
    writeln!(out, "{:>10}{:>10}", text(p[6]), text(p[7]))
}

/// One file's.
pub(super) fn write_table(out: &mut impl Write, rows: &[Row]) -> io::Result<()> {
    write_head(out)?;
    if let Some(row) = rows.first() {
        let [primary, random, build, memory, tests, trims, own_primary, own_random] = row.absolute;
        writeln!(
            out,
            "{:<14}{:>10}{:>10}{:>10}{:>10}{tests:>10.3}{:>10}{:>14}{:>10}{:>10}",
            "absolute",
            format!("{:.3} M/s", primary * 1e-6),
            format!("{:.3} M/s", random * 1e-6),
            format!("{:.1} ms", build * 1e3),
            format!("{:.2} MB", memory * 1e-6),
            format!("{:.2} MB", trims * 1e-6),
            "",
            format!("{:.2} M/s", own_primary * 1e-6),
            format!("{:.2} M/s", own_random * 1e-6)
        )?;
    }
    for row in rows {
        write_percentages(out, &row.method.label(), row.percent, [row.steps, row.evaluations])?;
    }
    for row in rows.iter().filter(|row| row.different.0 > 0) {
        let (count, worst) = row.different;
        let label = row.method.label();
        writeln!(
            out,
            "{label} answers {count} queries otherwise than {}, up to {worst:.1e} from a curve",
            rows[0].method.label()
        )?;
    }
    out.flush()
}

/// One file's trims on a GPU.
pub(super) fn write_device(out: &mut impl Write, name: &str, measured: &[MethodMeasure]) -> io::Result<()> {
    writeln!(out, "trims alone on {name}, the kernel without transfers; answers other than the CPU's")?;
    for method in measured {
        write!(out, "{:<14}", method.method.label())?;
        for device in method.sets.iter().filter_map(|set| set.device) {
            write!(out, "{:>12}{:>8}", format!("{:.2} M/s", device.trims.best * 1e-6), device.different)?;
        }
        writeln!(out)?;
    }
    out.flush()
}

/// The means of the percentages of several files.
pub(super) fn write_means(out: &mut impl Write, tables: &[Vec<Row>]) -> io::Result<()> {
    writeln!(out, "means of {} files", tables.len())?;
    write_head(out)?;
    let Some(first) = tables.first() else { return Ok(()) };
    for (index, row) in first.iter().enumerate() {
        let of_tables = |get: &dyn Fn(&Row) -> f64| {
            let known = tables.iter().map(|rows| get(&rows[index])).filter(|number| !number.is_nan());
            let (sum, count) = known.fold((0.0, 0.0), |(sum, count), number| (sum + number, count + 1.0));
            sum / count
        };
        let percent = std::array::from_fn(|k| of_tables(&|row| row.percent[k]));
        let rest = [of_tables(&|row| row.steps), of_tables(&|row| row.evaluations)];
        write_percentages(out, &row.method.label(), percent, rest)?;
    }
    out.flush()
}

/// Names of the columns of the rows.
pub(super) fn csv_header() -> String {
    "model,method,label,build_seconds,total_bytes,trim_bytes,set,rays_per_second,rays_per_second_median,\
     trims_per_second,trims_per_second_median,threads_trims_per_second,threads_trims_per_second_median,\
     queries,steps,exact_tests,evaluations,different,worst,gpu_trims_per_second,gpu_different\n"
        .to_owned()
}

/// A row for each set of queries.
pub(super) fn csv_row(path: &Path, method: &MethodMeasure) -> String {
    let mut text = String::new();
    let model = path.display().to_string().replace([',', '\n'], " ");
    for (name, set) in ["primary", "random"].iter().zip(&method.sets) {
        let SetMeasure { rays, trims, trims_of_all_threads: all, counts, different, worst, device } = set;
        let on_gpu = device.map_or(",".to_owned(), |d| format!("{:.0},{}", d.trims.best, d.different));
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{model},{},{},{:e},{},{},{name},{:.0},{:.0},{:.0},{:.0},{:.0},{:.0},{},{},{},{},{different},{worst:e},{on_gpu}",
            method.method.number(),
            method.method.label(),
            method.build_seconds,
            method.total_bytes,
            method.trim_bytes,
            rays.best,
            rays.median,
            trims.best,
            trims.median,
            all.best,
            all.median,
            counts.queries,
            counts.steps,
            counts.exact_tests,
            counts.evaluations
        );
    }
    text
}
