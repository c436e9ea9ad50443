//! What `--stats` tells of rays.

use crate::render::cpu::{RayCounts, Step};
use serde::Serialize;
use std::io::Write;

/// Sums over rays. Names of fields are those of the JSON object: they stay.
#[derive(Debug, Serialize)]
pub(super) struct RayReport {
    rays: u64,
    /// Of these, those with a hit.
    hit: u64,
    /// Instances that rays enter.
    instances: u64,
    nodes: u64,
    faces: u64,
    leaves: u64,
    /// Of these, those searched cell by cell.
    divided_leaves: u64,
    cells: u64,
    searches: u64,
    newton_steps: u64,
    trim_queries: u64,
    /// Queries that come to a curve, and its points that they evaluate.
    exact_trim_tests: u64,
    curve_evaluations: u64,
}

impl RayReport {
    pub(super) fn of(counts: &RayCounts) -> Self {
        Self {
            rays: counts.rays,
            hit: counts.hit,
            instances: counts.of(Step::Instance),
            nodes: counts.of(Step::Node),
            faces: counts.of(Step::Face),
            leaves: counts.of(Step::Leaf),
            divided_leaves: counts.of(Step::DividedLeaf),
            cells: counts.of(Step::Cell),
            searches: counts.of(Step::Search),
            newton_steps: counts.of(Step::NewtonStep),
            trim_queries: counts.trims.queries,
            exact_trim_tests: counts.trims.exact_tests,
            curve_evaluations: counts.trims.evaluations,
        }
    }

    /// A table of means.
    pub(super) fn write(&self, out: &mut impl Write) -> std::io::Result<()> {
        let rays = self.rays.max(1) as f64;
        writeln!(
            out,
            "{} rays, {:.1} % of them with a hit; a ray takes",
            self.rays,
            100.0 * self.hit as f64 / rays
        )?;
        for (name, count) in [
            ("instances entered", self.instances),
            ("nodes", self.nodes),
            ("analytic faces", self.faces),
            ("leaves of nets", self.leaves),
            ("leaves searched cell by cell", self.divided_leaves),
            ("cells", self.cells),
            ("searches by Newton's method", self.searches),
            ("steps of these", self.newton_steps),
            ("trim queries", self.trim_queries),
            ("exact trim tests", self.exact_trim_tests),
            ("trim curve evaluations", self.curve_evaluations),
        ] {
            writeln!(out, "{:10.4} {name}", count as f64 / rays)?;
        }
        Ok(())
    }
}
