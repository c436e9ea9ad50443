//! Run time against error: what a first hit costs and how far it is off, for each setting of the tracer: the size of leaves with each exactness, the numbers, where
//! Newton's method stops, and who decides trims.
//!
//! Truth are the model's f64 numbers by the [`Reference`], for the rays that it is certain of; errors are distances along the ray over the scene's
//! diagonal, so that they stand beside those of a mesh (`tools/rival`). Times are of one thread, the least of several runs.

use super::accuracy::{Quantiles, quantiles};
use super::rays::chord;
use crate::bake::{BakeOptions, bake};
use crate::brep::Model;
use crate::render::cpu::{Precision, probe_with};
use crate::render::reference::Reference;
use crate::render::{Exactness, Hit, NetSearch, Ray};
use crate::scene::{Scene, SceneBuffers, TRIM_INSIDE, TrimMethod, section_bytes};
use glam::DVec3;
use rayon::prelude::*;
use std::time::Instant;

/// Distortions that leaves are split to; the middle one is the bake's default.
const DISTORTIONS: [f64; 5] = [0.5, 0.25, 0.125, 0.0625, 0.03125];

/// Steps, in `√ε`, below which Newton's method has converged, beside the default of 1: a smaller one costs steps, a greater one digits.
const NEWTON_STOPS: [f32; 5] = [1.0 / 64.0, 8.0, 64.0, 256.0, 1024.0];

/// Trim methods beside the default: a list, slabs with boxing, Sloup and Havran's kd-tree with all improvements, our bands without curves.
const TRIM_METHODS: [u32; 4] = [1, 4, 12, 31];

/// Runs of which the fastest counts.
const RUNS: usize = 5;

/// A first hit this far off, in diagonals, is another hit.
const ELSEWHERE: f64 = 1e-2;

/// One setting, measured.
#[derive(Debug, Clone, PartialEq)]
pub struct WorkPoint {
    /// Exactness, precision and what the settings change.
    pub series: String,
    /// The setting: the distortion ρ, a step in `√ε`, or a trim method.
    pub setting: String,
    /// From the model to the scene, seconds, on all threads.
    pub build_seconds: f64,
    /// Of the scene in memory.
    pub bytes: usize,
    /// For a ray's first hit, on one thread.
    pub nanoseconds: f64,
    /// |difference of distances| over the scene's diagonal.
    pub error: Quantiles,
    /// Rays that the reference is certain of.
    pub certain: u64,
    /// Of these, those whose first hit is not there or elsewhere.
    pub missed: u64,
    /// Of these, those that hit where there is nothing.
    pub phantom: u64,
}

/// What the reference says of a ray: nothing, or its first hit's distance, if it has one.
type Truth = Option<Option<f64>>;

/// Measures all settings on `count` chords, from number `first` on.
pub fn measure_work(model: &Model, first: u64, count: u64) -> Vec<WorkPoint> {
    let options = BakeOptions { keep_f64: true, ..BakeOptions::default() };
    let buffers = bake(model, &options, &|_, _| {});
    let scene = buffers.scene();
    let rays: Vec<Ray> = (first..first + count).map(|index| chord(&scene, index)).collect();
    let reference = Reference::new(scene);
    let nearest = |ray: &Ray| reference.trace(ray).map(|hits| hits.first().map(|found| found.hit.t));
    let truth: Vec<Truth> = rays.par_iter().map(nearest).collect();
    let has_nets = !scene.nets.is_empty();
    let distortions: &[f64] = if has_nets { &DISTORTIONS } else { &[options.distortion] };
    let judge = |series: &str, setting: String, built: &(Scene<'_>, f64), precision, search: NetSearch| {
        let measured = measure(&built.0, precision, search, &rays, &truth);
        WorkPoint { series: series.to_owned(), setting, build_seconds: built.1, ..measured }
    };
    let exact = NetSearch::from(Exactness::Exact);
    let mut points = Vec::new();
    for &distortion in distortions {
        let (narrow, seconds) = timed_bake(model, &BakeOptions { distortion, ..BakeOptions::default() });
        let built = (narrow.scene(), seconds);
        for (series, exactness) in [
            ("fast f32", Exactness::Fast),
            ("balanced f32", Exactness::Balanced),
            ("exact f32", Exactness::Exact),
        ] {
            points.push(judge(series, distortion.to_string(), &built, Precision::F32, exactness.into()));
        }
        if distortion == options.distortion {
            let wide = (scene, seconds);
            points.push(judge("exact f64", distortion.to_string(), &wide, Precision::F64, exact));
            for newton_stop in if has_nets { &NEWTON_STOPS[..] } else { &[] } {
                let search = NetSearch { newton_stop: *newton_stop, ..exact };
                let setting = newton_stop.to_string();
                points.push(judge("Newton's stop", setting, &built, Precision::F32, search));
            }
        }
    }
    if scene.faces.iter().any(|face| face.trim_root != TRIM_INSIDE) {
        for trim_method in TRIM_METHODS.iter().filter_map(|&number| TrimMethod::from_number(number)) {
            let (other, seconds) = timed_bake(model, &BakeOptions { trim_method, ..BakeOptions::default() });
            let built = (other.scene(), seconds);
            points.push(judge("trim method", trim_method.name().to_owned(), &built, Precision::F32, exact));
        }
    }
    points
}

/// A scene and the seconds that its bake took.
fn timed_bake(model: &Model, options: &BakeOptions) -> (SceneBuffers, f64) {
    let clock = Instant::now();
    let scene = bake(model, options, &|_, _| {});
    (scene, clock.elapsed().as_secs_f64())
}

/// One setting; what the caller knows is left empty.
fn measure(
    scene: &Scene<'_>,
    precision: Precision,
    search: NetSearch,
    rays: &[Ray],
    truth: &[Truth],
) -> WorkPoint {
    let (found, seconds) = on_one_thread(|| {
        let mut seconds = f64::INFINITY;
        let mut found = Vec::new();
        for _ in 0..RUNS {
            let clock = Instant::now();
            found = probe_with(scene, rays, precision, true, search);
            seconds = seconds.min(clock.elapsed().as_secs_f64());
        }
        (found, seconds)
    });
    let diagonal = 2.0 * DVec3::from_array(scene.header.half_size.map(f64::from)).length();
    let mut errors = Vec::with_capacity(rays.len());
    let (mut certain, mut missed, mut phantom) = (0, 0, 0);
    for (hits, truth) in found.iter().zip(truth) {
        let Some(truth) = truth else { continue };
        certain += 1;
        match (truth, hits.first()) {
            (Some(t), Some(Hit { t: other, .. })) if (t - other).abs() <= ELSEWHERE * diagonal => {
                errors.push((t - other).abs() / diagonal);
            }
            (Some(_), _) => missed += 1,
            (None, Some(_)) => phantom += 1,
            (None, None) => {}
        }
    }
    WorkPoint {
        series: String::new(),
        setting: String::new(),
        build_seconds: 0.0,
        bytes: section_bytes(scene)["total"],
        nanoseconds: seconds * 1e9 / rays.len().max(1) as f64,
        error: quantiles(errors),
        certain,
        missed,
        phantom,
    }
}

/// Runs `work` where rayon has one thread; in place where there can be no such pool.
pub(super) fn on_one_thread<R: Send>(work: impl FnOnce() -> R + Send) -> R {
    match rayon::ThreadPoolBuilder::new().num_threads(1).build() {
        Ok(pool) => pool.install(work),
        Err(_) => work(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finer_settings_are_all_measured() {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/knob/model.step");
        let model = crate::import::import(&path).expect("a fixture");
        let points = measure_work(&model, 0, 2000);
        let count = 3 * DISTORTIONS.len() + 1 + NEWTON_STOPS.len() + TRIM_METHODS.len();
        assert_eq!(points.len(), count);
        for point in &points {
            assert!(point.certain > 1900 && point.nanoseconds > 0.0 && point.bytes > 0, "{point:?}");
            assert!(point.error.median < 1e-6 || point.setting == "1024", "{point:?}");
            if point.series.starts_with("exact") {
                assert_eq!((point.missed, point.phantom), (0, 0), "{point:?}");
            }
        }
        let median = |series: &str| points.iter().find(|p| p.series == series).map(|p| p.error.median);
        let errors = |series: &str| median(series).expect("it is measured");
        assert!(errors("exact f64") < errors("exact f32"));
        let p99 = |setting: &str| points.iter().find(|p| p.setting == setting).map(|p| p.error.p99);
        let worst = |setting: &str| p99(setting).expect("it is measured");
        assert!(worst("1024") > worst("8"), "{points:?}");
    }
}
