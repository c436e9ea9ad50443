//! Arguments to calls, results to text.
//!
//! stdout carries only what was asked for; progress, warnings and notices go to stderr. Exit codes: 0 done, 1 cannot read or write,
//! 2 usage, 3 partial import under `--strict`, 4 nothing to render, 5 pictures differ.

mod args;
mod args_bench;
mod args_bench_trim;
mod args_cache;
mod args_camera;
mod args_files;
mod args_material;
mod args_output;
mod args_path;
mod args_reference;
mod args_section;
mod args_select;
mod args_style;
mod bake;
mod bench;
mod bench_accuracy;
mod bench_leaks;
mod bench_rays;
mod bench_stages;
mod bench_stress;
mod bench_trim;
mod bench_trim_degrees;
mod bench_trim_json;
mod bench_trim_table;
mod bench_work;
mod comparison;
mod device;
mod diff;
mod id_map;
mod info;
mod load;
mod materials;
mod output;
mod path;
mod pattern;
mod probe;
mod progress;
mod ray_lines;
mod ray_report;
mod reference;
mod render;
mod render_report;
mod report;
mod section;
mod selection;
mod sheet;
mod style;
mod tree;
mod view;
mod window;

use args::{Arguments, Command};
use clap::Parser;
use clap::error::{ContextKind, ContextValue, ErrorKind};
use std::io::Write;
use std::path::Path;
use std::process::ExitCode;

/// Ends that have an exit code of their own; every other error is 1.
#[derive(Debug, thiserror::Error)]
enum Failure {
    /// Arguments that make no sense together.
    #[error("{0}")]
    Usage(String),
    /// `--strict`, and something was dropped.
    #[error(
        "{path}: shape was dropped ({dropped} of {declared} faces, {findings} findings), and --strict was given; nothing was written"
    )]
    Partial { path: String, dropped: u64, declared: u64, findings: usize },
    /// Of several inputs, some could not be rendered; each was told when it happened.
    #[error("{failed} of {inputs} inputs failed")]
    Batch { failed: usize, inputs: usize, exit_code: u8 },
    /// Pictures that should be the same are not.
    #[error("{a} and {b} differ: {reason}")]
    Differ { a: String, b: String, reason: String },
    /// No face to show.
    #[error("{path}: nothing to {verb}: {reason}")]
    Nothing { path: String, verb: &'static str, reason: String },
}

impl Failure {
    fn exit_code(&self) -> u8 {
        match self {
            Self::Usage(_) => 2,
            Self::Partial { .. } => 3,
            Self::Batch { exit_code, .. } => *exit_code,
            Self::Nothing { .. } => 4,
            Self::Differ { .. } => 5,
        }
    }
}

/// Runs the command line.
pub fn main() -> ExitCode {
    let arguments = Arguments::try_parse().unwrap_or_else(|error| refuse(&error));
    start_log(&arguments.general);
    let result = start_threads(&arguments.general).and_then(|()| match &arguments.command {
        Command::Render(command) => render::run(command, &arguments.general),
        Command::Bake(command) => bake::run(command, &arguments.general),
        Command::Info(command) => info::run(command, &arguments.general),
        Command::Probe(command) => probe::run(command, &arguments.general),
        Command::Bench(command) => bench::run(command, &arguments.general),
        Command::Diff(command) => diff::run_diff(command),
        Command::Merge(command) => diff::run_merge(command),
    });
    match result {
        Ok(()) => ExitCode::SUCCESS,
        // The reader of a pipe has seen enough: no error of ours.
        Err(error) if is_broken_pipe(&error) => ExitCode::SUCCESS,
        Err(error) => {
            let _ = writeln!(std::io::stderr(), "trimray: {error:#}");
            ExitCode::from(exit_code(&error))
        }
    }
}

/// Extensions of files that may be rendered.
const MODELS: [&str; 6] = ["step", "stp", "p21", "iges", "igs", "trimray"];

/// Ends with what clap says of wrong arguments, or of the request for help; who names a model where a command stands is told which one renders it.
fn refuse(error: &clap::Error) -> ! {
    let word = match (error.kind(), error.get(ContextKind::InvalidSubcommand)) {
        (ErrorKind::InvalidSubcommand, Some(ContextValue::String(word))) => Path::new(word),
        _ => error.exit(),
    };
    let extension = word.extension().map(|extension| extension.to_string_lossy().to_ascii_lowercase());
    if !extension.is_some_and(|extension| MODELS.contains(&extension.as_str())) {
        error.exit();
    }
    let (model, picture) = (word.display(), word.with_extension("png"));
    let picture = picture.file_name().map(Path::new).unwrap_or(&picture).display();
    let _ = writeln!(
        std::io::stderr(),
        "trimray: {model} is no command: `trimray render {model} -o {picture}` makes a picture of it, `trimray help` tells all"
    );
    std::process::exit(2)
}

fn exit_code(error: &anyhow::Error) -> u8 {
    error.downcast_ref::<Failure>().map_or(1, Failure::exit_code)
}

fn is_broken_pipe(error: &anyhow::Error) -> bool {
    error
        .chain()
        .filter_map(|cause| cause.downcast_ref::<std::io::Error>())
        .any(|cause| cause.kind() == std::io::ErrorKind::BrokenPipe)
}

fn start_log(general: &args::General) {
    let level = match (general.quiet, general.verbose) {
        (true, _) => log::LevelFilter::Off,
        (false, 0) => log::LevelFilter::Error,
        (false, 1) => log::LevelFilter::Info,
        (false, _) => log::LevelFilter::Debug,
    };
    env_logger::Builder::new()
        .filter_level(level.min(log::LevelFilter::Error))
        .filter_module("trimray", level)
        .parse_default_env()
        .format_timestamp(None)
        .init();
}

fn start_threads(general: &args::General) -> anyhow::Result<()> {
    if let Some(threads) = general.threads {
        rayon::ThreadPoolBuilder::new().num_threads(usize::from(threads)).build_global()?;
    }
    Ok(())
}
