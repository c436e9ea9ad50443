//! `trimray bench stress`: scenes that are hard to trace.

use super::args_bench::BenchStress;
use super::bench::{precisions, rate_text, ray_numbers};
use crate::bench::stress::{
    RayKind, SUBJECTS, Sameness, StressScene, cases, measure_restarts, measure_sameness,
};
use crate::bench::{Accuracy, rate_bound};
use crate::render::cpu::Precision;
use crate::render::{Hit, Ray};
use serde::Serialize;
use std::io::Write;

/// A line of JSON: a scene against the reference. Names of fields stay.
#[derive(Serialize)]
struct Line<'a> {
    scene: &'a str,
    rays: &'static str,
    precision: &'static str,
    closed: bool,
    /// Reasons, one a face.
    dropped: &'a [String],
    traced: u64,
    certain: u64,
    hits: u64,
    missed: u64,
    missed_bound: f64,
    phantom: u64,
    phantom_bound: f64,
    /// Of [`Accuracy::distance`].
    median: f64,
    p999: f64,
    max: f64,
    /// Rays; none where the scene is not closed.
    odd: Option<u64>,
    odd_bound: Option<f64>,
    microseconds: f64,
    wrong: Option<Wrong>,
    odd_ray: Option<[[f64; 3]; 2]>,
}

/// A ray and its hits by the tracer and by the reference.
#[derive(Serialize)]
struct Wrong {
    origin: [f64; 3],
    direction: [f64; 3],
    found: Vec<WrongHit>,
    expected: Vec<WrongHit>,
}

#[derive(Serialize)]
struct WrongHit {
    t: f64,
    face: u32,
    uv: [f64; 2],
    /// Of the direction and the outward normal.
    cosine: f64,
}

/// A line of JSON: a shape against itself in another form. Names of fields stay.
#[derive(Serialize)]
struct SameLine<'a> {
    scene: &'a str,
    change: &'static str,
    precision: &'static str,
    traced: u64,
    certain: u64,
    hits: u64,
    /// Rays.
    different: u64,
    different_bound: f64,
    /// Hits.
    apart: u64,
    greatest: f64,
    wrong_ray: Option<[[f64; 3]; 2]>,
}

pub(super) fn run(command: &BenchStress) -> anyhow::Result<()> {
    let is_asked = |name: &str| name.starts_with(&command.only);
    let count = cases().filter(|case| is_asked(case.name)).count();
    let subjects = SUBJECTS.iter().filter(|subject| is_asked(subject.name));
    anyhow::ensure!(count + subjects.clone().count() > 0, "no scene's name begins with `{}`", command.only);
    let mut out = std::io::stdout().lock();
    let precisions = precisions(command.precision);
    if !command.json && count > 0 {
        write_head(&mut out)?;
    }
    for case in cases().filter(|case| is_asked(case.name)) {
        let scene = case.scene();
        for (precision, kind) in precisions.clone() {
            for (rays, ray_kind) in [("made", RayKind::Made), ("chords", RayKind::Chords)] {
                let found = scene.measure(ray_kind, kind, command.first, command.rays);
                let wrong = found.wrong.map(|ray| explained(&scene, ray, kind));
                let line = line(case.name, rays, precision, &scene, &found, wrong);
                if command.json { write_json(&mut out, &line)? } else { write_row(&mut out, &line)? }
            }
        }
    }
    if !command.json && subjects.clone().count() > 0 {
        writeln!(
            out,
            "{:<16}{:<19}{:<4}{:>10}{:>10}{:>10}{:>9}{:>7}{:>10}",
            "scene", "change", "", "certain", "hits", "different", "rate <", "apart", "greatest"
        )?;
    }
    for subject in subjects {
        for change in subject.changes().map(Some).chain([None]) {
            for (precision, kind) in precisions.clone() {
                let (name, found) = match change {
                    Some(change) => {
                        let found = measure_sameness(subject, change, kind, command.first, command.rays);
                        (change.name(), found)
                    }
                    None => ("restart", measure_restarts(subject, kind, command.first, command.rays)),
                };
                let line = same_line(subject.name, name, precision, &found);
                if command.json { write_json(&mut out, &line)? } else { write_same_row(&mut out, &line)? }
            }
        }
    }
    Ok(())
}

fn write_json(out: &mut impl Write, line: &impl Serialize) -> std::io::Result<()> {
    serde_json::to_writer(&mut *out, line)?;
    writeln!(out)?;
    out.flush()
}

fn explained(scene: &StressScene, ray: Ray, precision: Precision) -> Wrong {
    let [found, expected] = scene.hits(&ray, precision).map(|hits| {
        let shown = |hit: &Hit| WrongHit {
            t: hit.t,
            face: hit.face,
            uv: hit.uv,
            cosine: hit.normal.dot(ray.direction),
        };
        hits.iter().map(shown).collect()
    });
    let [origin, direction] = ray_numbers(ray);
    Wrong { origin, direction, found, expected }
}

fn line<'a>(
    name: &'a str,
    rays: &'static str,
    precision: &'static str,
    scene: &'a StressScene,
    found: &Accuracy,
    wrong: Option<Wrong>,
) -> Line<'a> {
    let Accuracy { certain, hits, missed, phantom, distance, odd, odd_ray, seconds, .. } = *found;
    Line {
        scene: name,
        rays,
        precision,
        closed: scene.is_closed,
        dropped: &scene.dropped,
        traced: found.rays,
        certain,
        hits,
        missed,
        missed_bound: rate_bound(hits, missed),
        phantom,
        phantom_bound: rate_bound(certain, phantom.min(certain)),
        median: distance.median,
        p999: distance.p999,
        max: distance.max,
        odd: scene.is_closed.then_some(odd),
        odd_bound: scene.is_closed.then(|| rate_bound(found.rays, odd)),
        microseconds: seconds * 1e6,
        wrong,
        odd_ray: odd_ray.filter(|_| scene.is_closed).map(ray_numbers),
    }
}

fn same_line<'a>(
    name: &'a str,
    change: &'static str,
    precision: &'static str,
    found: &Sameness,
) -> SameLine<'a> {
    let Sameness { rays, certain, hits, different, apart, greatest, wrong } = *found;
    SameLine {
        scene: name,
        change,
        precision,
        traced: rays,
        certain,
        hits,
        different,
        different_bound: rate_bound(certain, different),
        apart,
        greatest,
        wrong_ray: wrong.map(ray_numbers),
    }
}

fn write_head(out: &mut impl Write) -> std::io::Result<()> {
    writeln!(
        out,
        "{:<20}{:<7}{:<4}{:>9}{:>9}{:>9}{:>7}{:>9}{:>8}{:>9}{:>9}{:>9}{:>9}{:>6}{:>9}{:>8}",
        "scene",
        "rays",
        "",
        "certain",
        "unsure",
        "hits",
        "missed",
        "rate <",
        "phantom",
        "rate <",
        "median",
        "p99.9",
        "max",
        "odd",
        "rate <",
        "µs/ray"
    )
}

fn write_row(out: &mut impl Write, line: &Line<'_>) -> std::io::Result<()> {
    let odd = line.odd.map_or("-".to_owned(), |odd| odd.to_string());
    let bound = line.odd_bound.map_or("-".to_owned(), |bound| rate_text(line.traced, bound));
    let missed_bound = rate_text(line.hits, line.missed_bound);
    let phantom_bound = rate_text(line.certain, line.phantom_bound);
    writeln!(
        out,
        "{:<20}{:<7}{:<4}{:>9}{:>9}{:>9}{:>7}{missed_bound:>9}{:>8}{phantom_bound:>9}{:>9.1e}{:>9.1e}{:>9.1e}{odd:>6}{bound:>9}{:>8.2}",
        line.scene,
        line.rays,
        line.precision,
        line.certain,
        line.traced - line.certain,
        line.hits,
        line.missed,
        line.phantom,
        line.median,
        line.p999,
        line.max,
        line.microseconds
    )?;
    for reason in line.dropped {
        writeln!(out, "  a face could not be baked: {reason}")?;
    }
    out.flush()
}

fn write_same_row(out: &mut impl Write, line: &SameLine<'_>) -> std::io::Result<()> {
    writeln!(
        out,
        "{:<16}{:<19}{:<4}{:>10}{:>10}{:>10}{:>9}{:>7}{:>10.1e}",
        line.scene,
        line.change,
        line.precision,
        line.certain,
        line.hits,
        line.different,
        rate_text(line.certain, line.different_bound),
        line.apart,
        line.greatest
    )?;
    out.flush()
}
