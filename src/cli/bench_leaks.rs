//! `trimray bench leaks`: odd rays of closed solids.

use super::args_bench::BenchLeaks;
use super::bench::{precisions, rate_text, ray_numbers};
use crate::bake::{BakeOptions, bake};
use crate::bench::{Leaks, count_aimed_leaks, count_uniform_leaks, edge_points, is_closed};
use crate::import::import;
use serde::Serialize;
use std::io::Write;

/// A line of JSON. Names of fields stay.
#[derive(Serialize)]
struct Line<'a> {
    file: std::borrow::Cow<'a, str>,
    closed: bool,
    /// Millimetres.
    largest_gap: f64,
    precision: &'static str,
    uniform: Count,
    aimed: Count,
}

/// See [`Leaks`].
#[derive(Serialize)]
struct Count {
    rays: u64,
    odd: u64,
    bound: f64,
    odd_before: u64,
    beside: u64,
    left_out: u64,
    repeated: u64,
    /// Origins and directions of some odd rays.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    shown: Vec<[[f64; 3]; 2]>,
}

impl From<&Leaks> for Count {
    fn from(leaks: &Leaks) -> Self {
        let shown = leaks.shown.iter().copied().map(ray_numbers).collect();
        let Leaks { rays, odd, odd_before, beside, left_out, repeated, .. } = *leaks;
        Self { rays, odd, bound: leaks.bound(), odd_before, beside, left_out, repeated, shown }
    }
}

/// The head of [`columns`].
const HEAD: &str = "       kind        rays   odd    rate <    before  left out  repeated  beside";

fn columns(kind: &str, leaks: &Leaks) -> String {
    let Leaks { rays, odd, odd_before, beside, left_out, repeated, .. } = *leaks;
    let bound = rate_text(rays, leaks.bound());
    format!("{kind:>11}{rays:>12}{odd:>6}{bound:>10}{odd_before:>10}{left_out:>10}{repeated:>10}{beside:>8}")
}

pub(super) fn run(command: &BenchLeaks) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    if !command.json {
        writeln!(out, "{:<4}{:>7}{:>10}{HEAD}{HEAD}  file", "", "closed", "gap, mm")?;
    }
    for path in &command.inputs {
        let model = import(path)?;
        let buffers = bake(&model, &BakeOptions { keep_f64: true, ..BakeOptions::default() }, &|_, _| {});
        let scene = buffers.scene();
        let points = edge_points(&model);
        let closed = is_closed(&model, &scene);
        let gap = scene.metadata.largest_gap.map_or(0.0, |gap| gap.distance);
        let half = command.rays / 2;
        for (name, precision) in precisions(command.precision) {
            let uniform =
                count_uniform_leaks(&scene, precision, command.first, command.rays - half, command.show);
            let aimed = if points.is_empty() {
                Leaks::default()
            } else {
                count_aimed_leaks(&scene, precision, &points, command.first, half, command.show)
            };
            if command.json {
                let line = Line {
                    file: path.to_string_lossy(),
                    closed,
                    largest_gap: gap,
                    precision: name,
                    uniform: (&uniform).into(),
                    aimed: (&aimed).into(),
                };
                serde_json::to_writer(&mut out, &line).map_err(std::io::Error::from)?;
                writeln!(out)?;
            } else {
                writeln!(
                    out,
                    "{name:<4}{:>7}{gap:>10.1e}{}{}  {}",
                    if closed { "yes" } else { "no" },
                    columns("uniform", &uniform),
                    columns("aimed", &aimed),
                    path.display()
                )?;
                for ray in uniform.shown.iter().chain(&aimed.shown) {
                    let [ox, oy, oz] = ray.origin.to_array();
                    let [dx, dy, dz] = ray.direction.to_array();
                    writeln!(out, "{ox} {oy} {oz} {dx} {dy} {dz}")?;
                }
            }
            out.flush()?;
        }
    }
    Ok(())
}
