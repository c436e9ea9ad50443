//! Metamorphic checks: a shape in another form, and rays moved along with it, have the same hits.

use super::aim::{Aim, aimed_ray};
use super::change::Change;
use super::draft::{analytic_solids, egg_solid, sheet_model, wavy};
use super::{baked, scene_radius, truth};
use crate::bench::{chord, edge_points};
use crate::brep::Model;
use crate::geometry::Surface;
use crate::render::cpu::{Precision, probe};
use crate::render::reference::{Reference, widened};
use crate::render::{Hit, Ray};
use crate::scene::Scene;
use glam::DAffine3;
use rayon::prelude::*;

/// A model that is changed.
#[derive(Debug, Clone, Copy)]
pub struct Subject {
    /// For people and for `--only`.
    pub name: &'static str,
    pub(super) build: fn() -> Model,
}

impl Subject {
    /// The changes that make another model of it: some are of B-splines alone.
    pub fn changes(&self) -> impl Iterator<Item = Change> + use<> {
        let model = (self.build)();
        let has_splines = model.surfaces.iter().any(|surface| matches!(surface, Surface::Bspline(_)));
        Change::ALL.into_iter().filter(move |change| has_splines || !change.is_of_splines())
    }
}

/// Models that are changed.
pub const SUBJECTS: &[Subject] = &[
    Subject { name: "same-analytic", build: analytic_solids },
    Subject { name: "same-egg", build: egg_solid },
    Subject { name: "same-sheet", build: || sheet_model(wavy(0.0)) },
];

/// Of the scene's size, across the surface: how far hits of one shape may be apart.
pub(super) fn limit(precision: Precision) -> f64 {
    match precision {
        Precision::F32 => 1e-6,
        Precision::F64 => 1e-12,
    }
}

/// What a change made different.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Sameness {
    /// Rays traced.
    pub rays: u64,
    /// Those of which the reference is certain, which alone are compared.
    pub certain: u64,
    /// Hits of those.
    pub hits: u64,
    /// Rays with another number of hits, or with a normal turned around.
    pub different: u64,
    /// Hits too far apart.
    pub apart: u64,
    /// Of all hits compared, the greatest distance across the surface, in sizes of the scene.
    pub greatest: f64,
    /// The first ray that something is wrong with, in the unchanged scene.
    pub wrong: Option<Ray>,
}

impl Sameness {
    /// One comparison of hits: whether there are others, or else how far apart they are.
    pub(super) fn add(&mut self, ray: &Ray, is_different: bool, distances: &[f64], limit: f64) {
        let apart = distances.iter().filter(|distance| **distance > limit).count() as u64;
        self.different += u64::from(is_different);
        self.apart += apart;
        self.greatest = distances.iter().copied().fold(self.greatest, f64::max);
        if is_different || apart > 0 {
            self.wrong = self.wrong.or(Some(*ray));
        }
    }
}

/// Which rays the reference is certain of.
pub(super) fn certain(reference: &Reference<'_>, rays: &[Ray]) -> Vec<bool> {
    rays.par_iter().map(|ray| reference.trace(ray).is_some()).collect()
}

/// Traces `count` rays, from number `first` on, in a model and in its changed form.
pub fn measure_sameness(
    subject: &Subject,
    change: Change,
    precision: Precision,
    first: u64,
    count: u64,
) -> Sameness {
    let model = (subject.build)();
    let base = baked(&model);
    let scene = base.scene();
    let rays = sameness_rays(&scene, &model, first, count);
    let changed = baked(&change.applied(model));
    compare(&scene, &changed.scene(), &rays, &change.placement(), precision)
}

/// Half of them chords, half past edges; chords alone where the model has no edges.
pub(super) fn sameness_rays(scene: &Scene<'_>, model: &Model, first: u64, count: u64) -> Vec<Ray> {
    let points = edge_points(model);
    let (has_edges, past) = (!points.is_empty(), Aim::Past(points));
    let ray = |index: u64| {
        if index.is_multiple_of(2) || !has_edges {
            chord(scene, index)
        } else {
            aimed_ray(&past, scene_radius(scene), index)
        }
    };
    (first..first + count).map(ray).collect()
}

/// The rays' hits in `scene` and, moved by `placement`, in `changed`.
pub(super) fn compare(
    scene: &Scene<'_>,
    changed: &Scene<'_>,
    rays: &[Ray],
    placement: &DAffine3,
    precision: Precision,
) -> Sameness {
    let narrow = widened(scene);
    let reference = Reference::new(truth(scene, &narrow, precision));
    let scale = placement.matrix3.x_axis.length();
    let moved: Vec<Ray> = rays
        .iter()
        .map(|ray| Ray {
            origin: placement.transform_point3(ray.origin),
            direction: placement.transform_vector3(ray.direction) / scale,
        })
        .collect();
    let found = probe(scene, rays, precision, false);
    let others = probe(changed, &moved, precision, false);
    let is_certain = certain(&reference, rays);
    let size = 2.0 * scene_radius(scene);
    let mut result = Sameness { rays: rays.len() as u64, ..Sameness::default() };
    for (index, ray) in rays.iter().enumerate().filter(|(index, _)| is_certain[*index]) {
        let (hits, others) = (&found[index], &others[index]);
        result.certain += 1;
        result.hits += hits.len() as u64;
        let is_turned = |(a, b): (&Hit, &Hit)| placement.transform_vector3(a.normal).dot(b.normal) < 0.0;
        let is_different = hits.len() != others.len() || hits.iter().zip(others).any(is_turned);
        let across =
            |(a, b): (&Hit, &Hit)| (a.t - b.t / scale).abs() * a.normal.dot(ray.direction).abs() / size;
        let distances: Vec<f64> = match is_different {
            true => Vec::new(),
            false => hits.iter().zip(others).map(across).collect(),
        };
        result.add(ray, is_different, &distances, limit(precision));
    }
    result
}
