//! What each method costs: time to build, bytes, whole rays, trims alone, and counts that do not depend on the machine.
//!
//! Queries are traced once and asked of every method in the same order, so that methods differ in nothing but their structures. As Sloup and Havran
//! do (2021, section 5.2), some runs warm up and the fastest of the others counts; the median is kept beside it.

use crate::bake::{TrimRegions, retrim};
use crate::bench::rays::chord;
use crate::bench::work::on_one_thread;
use crate::render::cpu::{
    Precision, TrimCounts, TrimQuery, answers_counted, count_inside, pixel_ray, probe_with, trim_queries,
};
use crate::render::{Camera, Exactness, Ray, Viewpoint};
use crate::scene::{Scene, SceneBuffers, TrimMethod, section_bytes};
use rayon::prelude::*;
use std::hint::black_box;
use std::time::Instant;

/// One warm-up for so many runs that count: 5 for 15.
const RUNS_PER_WARM_UP: usize = 3;

/// How often structures are built.
const BUILDS: usize = 3;

/// Queries of one task where all threads work.
const QUERIES_PER_TASK: usize = 4096;

/// How to measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct StudyOptions {
    /// Pixels across and down: a primary ray each.
    pub resolution: [u32; 2],
    /// How many random rays.
    pub rays: u64,
    /// How many queries of each kind of rays are kept.
    pub most_queries: usize,
    /// How many rays of each kind are traced to the end when whole rays are timed; queries come from all.
    pub timed_rays: usize,
    /// How many runs count.
    pub runs: usize,
}

/// Rays and the queries that they make, in order.
pub struct QuerySet {
    /// "primary" or "random".
    pub name: &'static str,
    /// Whole rays to be timed: neighbours from the middle of all.
    pub rays: Vec<Ray>,
    /// On the way to the first hits.
    pub queries: Vec<TrimQuery>,
}

/// Things per second.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Rate {
    /// Of the fastest run.
    pub best: f64,
    /// Of the median run.
    pub median: f64,
}

/// A method on one set of queries.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SetMeasure {
    /// First hits, on all threads.
    pub rays: Rate,
    /// Trims alone, on one thread.
    pub trims: Rate,
    /// Trims alone, on all threads.
    pub trims_of_all_threads: Rate,
    /// What the queries cost.
    pub counts: TrimCounts,
    /// Queries that the method answers otherwise than the first one measured.
    pub different: u64,
    /// The greatest distance, in windows, from a trim curve of such a query.
    pub worst: f64,
    /// Trims alone on a GPU, where there is one.
    pub device: Option<DeviceMeasure>,
}

/// A method on one set of queries on a GPU.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct DeviceMeasure {
    /// Trims alone.
    pub trims: Rate,
    /// Queries that the GPU answers otherwise than the CPU does in f32.
    pub different: u64,
}

/// What asks a set of queries beside the CPU, whose answers it is told; nothing where there is no such device.
pub type Beside<'a> = &'a dyn Fn(&Scene<'_>, &QuerySet, &[bool]) -> Result<Option<DeviceMeasure>, String>;

/// A method.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodMeasure {
    /// Which one.
    pub method: TrimMethod,
    /// To build its structures from regions, on one thread.
    pub build_seconds: f64,
    /// Of the whole scene.
    pub total_bytes: usize,
    /// Of the sections of trims: nodes, segments, points.
    pub trim_bytes: usize,
    /// On each set of queries.
    pub sets: Vec<SetMeasure>,
}

/// Primary rays of the default camera and random chords, with their queries; the scene has the structures of 1-LC in the end, with which every trimmed
/// face asks.
///
/// # Errors
///
/// The reason why 1-LC cannot hold the scene's trims.
pub fn query_sets(
    scene: &mut SceneBuffers,
    regions: &TrimRegions,
    options: &StudyOptions,
) -> Result<Vec<QuerySet>, String> {
    let list = TrimMethod::from_number(1).ok_or("there is no method 1")?;
    retrim(scene, regions, list)?;
    let scene = &scene.scene();
    let [width, height] = options.resolution;
    let camera = Camera::framing(&Viewpoint::default(), scene, f64::from(width) / f64::from(height));
    let pixel = |index: u32| {
        let (x, y) = (index % width, index / width);
        pixel_ray(&camera, options.resolution, f64::from(x) + 0.5, f64::from(y) + 0.5)
    };
    let primary: Vec<Ray> = (0..width * height).map(pixel).collect();
    let random: Vec<Ray> = (0..options.rays).map(|index| chord(scene, index)).collect();
    let set = |(name, rays): (&'static str, Vec<Ray>)| {
        let queries = trim_queries(scene, &rays, true, options.most_queries);
        let first = rays.len().saturating_sub(options.timed_rays) / 2;
        let rays = rays.into_iter().skip(first).take(options.timed_rays).collect();
        QuerySet { name, rays, queries }
    };
    Ok([("primary", primary), ("random", random)].into_iter().map(set).collect())
}

/// Measures `methods` one after the other; the scene has the last one's structures in the end. Each is told to `done`.
///
/// # Errors
///
/// The reason why a method cannot hold the scene's trims, or what is asked beside failed.
pub fn measure_methods(
    scene: &mut SceneBuffers,
    regions: &TrimRegions,
    sets: &[QuerySet],
    methods: &[TrimMethod],
    options: &StudyOptions,
    beside: Beside<'_>,
    done: &dyn Fn(usize, usize),
) -> Result<Vec<MethodMeasure>, String> {
    let mut measured = Vec::with_capacity(methods.len());
    let mut expected: Vec<Vec<bool>> = Vec::new();
    for (index, &method) in methods.iter().enumerate() {
        done(index, methods.len());
        let build_seconds = build(scene, regions, method)?;
        let scene = scene.scene();
        let bytes = section_bytes(&scene);
        let mut of_sets = Vec::with_capacity(sets.len());
        for (at, set) in sets.iter().enumerate() {
            let (answers, counts) = answers_counted(&scene, &set.queries);
            let expected = match expected.get(at) {
                Some(expected) => expected,
                None => {
                    expected.push(answers.clone());
                    &answers
                }
            };
            let (different, worst) = differences(regions, &set.queries, &answers, expected);
            let device = beside(&scene, set, &answers)?;
            of_sets.push(SetMeasure { counts, different, worst, device, ..time(&scene, set, options.runs) });
        }
        let of_trims = bytes.iter().filter(|(name, _)| name.starts_with("trim_"));
        measured.push(MethodMeasure {
            method,
            build_seconds,
            total_bytes: bytes["total"],
            trim_bytes: of_trims.map(|(_, bytes)| bytes).sum(),
            sets: of_sets,
        });
    }
    Ok(measured)
}

/// The least time of some retrims, on one thread.
fn build(scene: &mut SceneBuffers, regions: &TrimRegions, method: TrimMethod) -> Result<f64, String> {
    on_one_thread(|| {
        let mut seconds = f64::INFINITY;
        for _ in 0..BUILDS {
            let clock = Instant::now();
            retrim(scene, regions, method)?;
            seconds = seconds.min(clock.elapsed().as_secs_f64());
        }
        Ok(seconds)
    })
}

fn differences(
    regions: &TrimRegions,
    queries: &[TrimQuery],
    answers: &[bool],
    expected: &[bool],
) -> (u64, f64) {
    let different = (queries.iter().zip(answers).zip(expected))
        .filter(|((_, answer), expected)| answer != expected)
        .map(|((query, _), _)| regions.judge(query.face as usize).distance(query.uv.map(f64::from)));
    different.fold((0, 0.0), |(count, worst), distance| (count + 1, distance.max(worst)))
}

/// Rates alone.
fn time(scene: &Scene<'_>, set: &QuerySet, runs: usize) -> SetMeasure {
    let trace = || probe_with(scene, &set.rays, Precision::F32, true, Exactness::default()).len();
    let ask_all = || {
        let tasks = set.queries.par_chunks(QUERIES_PER_TASK);
        tasks.map(|queries| count_inside(scene, queries)).sum::<usize>()
    };
    SetMeasure {
        rays: rate(set.rays.len(), runs, trace),
        trims: trim_rate(scene, &set.queries, runs),
        trims_of_all_threads: rate(set.queries.len(), runs, ask_all),
        ..SetMeasure::default()
    }
}

/// Trims per second on one thread.
pub(super) fn trim_rate(scene: &Scene<'_>, queries: &[TrimQuery], runs: usize) -> Rate {
    on_one_thread(|| rate(queries.len(), runs, || count_inside(scene, queries)))
}

/// How fast `work` does `amount` of it.
pub(super) fn rate(amount: usize, runs: usize, work: impl Fn() -> usize) -> Rate {
    for _ in 0..runs / RUNS_PER_WARM_UP {
        black_box(work());
    }
    let mut seconds: Vec<f64> = (0..runs.max(1))
        .map(|_| {
            let clock = Instant::now();
            black_box(work());
            clock.elapsed().as_secs_f64()
        })
        .collect();
    seconds.sort_by(f64::total_cmp);
    let per_second = |seconds: f64| amount as f64 / seconds.max(1e-9);
    Rate { best: per_second(seconds[0]), median: per_second(seconds[seconds.len() / 2]) }
}
