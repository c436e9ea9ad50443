//! `trimray bench`: measurements.

use super::args::{General, PrecisionChoice};
use super::args_bench::{Bench, BenchCommand};
use super::{bench_accuracy, bench_leaks, bench_rays, bench_stages, bench_stress, bench_trim, bench_work};
use crate::render::Ray;
use crate::render::cpu::Precision;

pub(super) fn run(command: &Bench, general: &General) -> anyhow::Result<()> {
    match &command.command {
        BenchCommand::Stages(command) => bench_stages::run(command, general),
        BenchCommand::Accuracy(command) => bench_accuracy::run(command, general),
        BenchCommand::Work(command) => bench_work::run(command),
        BenchCommand::Leaks(command) => bench_leaks::run(command),
        BenchCommand::Rays(command) => bench_rays::run(command, general),
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
