//! `trimray bench trim --json`. Names of fields stay.

use crate::bench::trim::{MethodMeasure, Rate, SetMeasure, TrimStatistics};
use serde::Serialize;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{self, Write};
use std::path::Path;

#[derive(Serialize)]
struct Line<'a> {
    file: Cow<'a, str>,
    surfaces: usize,
    trimmed: usize,
    nets: usize,
    leaves: usize,
    loops: usize,
    trim_curves: usize,
    bezier_trim_curves: usize,
    degrees: &'a BTreeMap<usize, usize>,
    methods: Vec<Method>,
}

#[derive(Serialize)]
struct Method {
    number: u32,
    label: String,
    build_seconds: f64,
    total_bytes: usize,
    trim_bytes: usize,
    primary: Option<Set>,
    random: Option<Set>,
}

/// See [`SetMeasure`].
#[derive(Serialize)]
struct Set {
    rays_per_second: Times,
    trims_per_second: Times,
    trims_per_second_of_all_threads: Times,
    queries: u64,
    steps: u64,
    exact_tests: u64,
    evaluations: u64,
    different: u64,
    worst: f64,
    #[serde(skip_serializing_if = "Option::is_none")]
    gpu_trims_per_second: Option<Times>,
    #[serde(skip_serializing_if = "Option::is_none")]
    gpu_different: Option<u64>,
}

/// See [`Rate`].
#[derive(Serialize)]
struct Times {
    best: f64,
    median: f64,
}

impl From<Rate> for Times {
    fn from(rate: Rate) -> Self {
        Self { best: rate.best, median: rate.median }
    }
}

impl From<&SetMeasure> for Set {
    fn from(set: &SetMeasure) -> Self {
        Self {
            rays_per_second: set.rays.into(),
            trims_per_second: set.trims.into(),
            trims_per_second_of_all_threads: set.trims_of_all_threads.into(),
            queries: set.counts.queries,
            steps: set.counts.steps,
            exact_tests: set.counts.exact_tests,
            evaluations: set.counts.evaluations,
            different: set.different,
            worst: set.worst,
            gpu_trims_per_second: set.device.map(|device| device.trims.into()),
            gpu_different: set.device.map(|device| device.different),
        }
    }
}

impl From<&MethodMeasure> for Method {
    fn from(measured: &MethodMeasure) -> Self {
        Self {
            number: measured.method.number(),
            label: measured.method.label(),
            build_seconds: measured.build_seconds,
            total_bytes: measured.total_bytes,
            trim_bytes: measured.trim_bytes,
            primary: measured.sets.first().map(Set::from),
            random: measured.sets.get(1).map(Set::from),
        }
    }
}

/// One file's line.
pub(super) fn write(
    out: &mut impl Write,
    path: &Path,
    statistics: &TrimStatistics,
    measured: &[MethodMeasure],
) -> io::Result<()> {
    let line = Line {
        file: path.to_string_lossy(),
        surfaces: statistics.surfaces,
        trimmed: statistics.trimmed,
        nets: statistics.nets,
        leaves: statistics.leaves,
        loops: statistics.loops,
        trim_curves: statistics.curves,
        bezier_trim_curves: statistics.bezier_curves,
        degrees: &statistics.degrees,
        methods: measured.iter().map(Method::from).collect(),
    };
    serde_json::to_writer(&mut *out, &line).map_err(io::Error::from)?;
    writeln!(out)?;
    out.flush()
}
