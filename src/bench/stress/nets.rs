//! Surfaces that are hard to trace: near tangents, odd weights, high degrees, crowded knots, poles, cusps, folds, slivers.

use super::aim::Aim;
use super::draft::{Draft, iso_points, knots, net, sheet_model, wavy};
use super::{Case, Stress};
use crate::brep::{Model, primitive};
use crate::geometry::{BsplineSurface, Frame, ParameterBox, Surface};
use glam::{DVec2, DVec3};
use std::f64::consts::{PI, TAU};

/// Half the side of the plane sheets, millimetres.
const HALF: f64 = 10.0;

/// Between two sheets that are nearly one, millimetres.
const BETWEEN_SHEETS: f64 = 1e-6;

pub(super) const CASES: &[Case] = &[
    Case { name: "torus-rim", build: torus_rim },
    Case { name: "twin-planes", build: twin_planes },
    Case { name: "twin-nets", build: || grazed(&[wavy(0.0), wavy(BETWEEN_SHEETS)]) },
    Case { name: "wavy-edge-on", build: || grazed(&[wavy(0.0)]) },
    Case { name: "weights-alternating", build: || single(weighted(alternating)) },
    Case { name: "weights-growing", build: || single(weighted(growing)) },
    Case { name: "degree-15", build: || single(of_degree(15)) },
    Case { name: "degree-15-rational", build: || grazed(&[rational_of_degree(15)]) },
    Case { name: "degree-20", build: || single(of_degree(20)) },
    Case { name: "degree-25", build: || single(of_degree(25)) },
    Case { name: "degree-25-rational", build: || grazed(&[rational_of_degree(25)]) },
    Case { name: "zero-area", build: zero_area },
    Case { name: "chebyshev", build: || single(chebyshev()) },
    Case { name: "crowded-knots", build: || single(crowded_knots()) },
    Case { name: "pole", build: || single(pole()) },
    Case { name: "cusp", build: || single(cusp()) },
    Case { name: "fold", build: || single(fold()) },
    Case { name: "strip", build: || single(strip()) },
];

/// The inner rim, where a ray along it meets the torus four times or not at all.
fn torus_rim() -> Stress {
    let mut draft = Draft::default();
    let torus = primitive::torus(&mut draft.model, &Frame::IDENTITY, [10.0, 3.0], 1);
    draft.solid(torus);
    let surface = Surface::Torus { frame: Frame::IDENTITY, major: 10.0, minor: 3.0 };
    let window = ParameterBox { min: DVec2::new(0.0, PI - 0.2), max: DVec2::new(TAU, PI + 0.2) };
    Stress { model: draft.finished(), aim: Aim::Grazing(vec![(surface, window)]) }
}

fn twin_planes() -> Stress {
    let mut draft = Draft::default();
    let mut windows = Vec::new();
    for z in [0.0, BETWEEN_SHEETS] {
        let surface = Surface::Plane { frame: Frame { origin: DVec3::Z * z, ..Frame::IDENTITY } };
        let corners = [[-HALF, -HALF], [HALF, -HALF], [HALF, HALF], [-HALF, HALF]];
        let trim = draft.polygon(&corners.map(|[x, y]| DVec3::new(x, y, z)));
        draft.sheet(surface.clone(), vec![trim]);
        windows.push((surface, ParameterBox { min: DVec2::splat(-HALF), max: DVec2::splat(HALF) }));
    }
    Stress { model: draft.finished(), aim: Aim::Grazing(windows) }
}

/// Sheets with rays that graze them.
fn grazed(sheets: &[BsplineSurface]) -> Stress {
    let mut draft = Draft::default();
    let mut windows = Vec::new();
    for sheet in sheets {
        let surface = Surface::Bspline(sheet.clone());
        windows.push((surface.clone(), surface.domain()));
        draft.sheet(surface, vec![]);
    }
    Stress { model: draft.finished(), aim: Aim::Grazing(windows) }
}

/// A face without area, all of whose points lie on a line, above a sheet.
fn zero_area() -> Stress {
    let line = |s: f64, t: f64| DVec3::new(2.0 + 6.0 * (0.25 * s + 0.75 * t), 5.0, 4.0);
    let line = net([3, 2], [knots(3, &[]), knots(2, &[])], line, |_, _| 1.0);
    let mut draft = Draft::default();
    let mut points = Vec::new();
    for sheet in [wavy(0.0), line].map(Surface::Bspline) {
        points.extend(iso_points(&sheet, 8, 64));
        draft.sheet(sheet, vec![]);
    }
    Stress { model: draft.finished(), aim: Aim::Past(points) }
}

/// A sheet with rays past points of its sides, its middle lines and others between.
fn single(surface: BsplineSurface) -> Stress {
    let points = iso_points(&Surface::Bspline(surface.clone()), 8, 64);
    let model: Model = sheet_model(surface);
    Stress { model, aim: Aim::Past(points) }
}

/// 10 × 10 mm and hills of 2 mm, from alternating control points.
fn hills(s: f64, t: f64) -> DVec3 {
    DVec3::new(10.0 * s, 10.0 * t, 2.0 * (12.0 * s).sin() * (11.0 * t + 0.5).cos())
}

fn weighted(weight: fn(usize, usize) -> f64) -> BsplineSurface {
    net([3, 3], [knots(3, &[0.3, 0.6]), knots(3, &[0.5])], hills, weight)
}

fn alternating(i: usize, j: usize) -> f64 {
    if (i + j).is_multiple_of(2) { 1e-6 } else { 1e6 }
}

/// From 1e-6 to 1e6 over the six rows of [`weighted`].
fn growing(i: usize, _: usize) -> f64 {
    10.0_f64.powf(-6.0 + 12.0 * i as f64 / 5.0)
}

fn of_degree(degree: usize) -> BsplineSurface {
    waves_of_degree(degree, |_, _| 1.0)
}

/// With more control points than products of derivatives are made of at 15, and ten times those at 25.
fn rational_of_degree(degree: usize) -> BsplineSurface {
    waves_of_degree(degree, |i, j| 1.0 + 0.25 * ((i + 2 * j) % 3) as f64)
}

fn waves_of_degree(degree: usize, weight: fn(usize, usize) -> f64) -> BsplineSurface {
    let point = |s: f64, t: f64| {
        let wave = |x: f64| (x * degree as f64 * 2.1).sin();
        DVec3::new(10.0 * s, 10.0 * t, 4.0 * wave(s) * wave(t + 0.1))
    };
    net([degree; 2], [knots(degree, &[]), knots(degree, &[])], point, weight)
}

/// z = T₁₅(2u − 1) / 4 over 10 × 10 mm: control points of up to 10⁴ mm cancel to waves of a quarter.
fn chebyshev() -> BsplineSurface {
    const DEGREE: usize = 15;
    let choose = |n: usize, k: usize| (0..k).map(|i| (n - i) as f64 / (i + 1) as f64).product::<f64>();
    let point = |s: f64, t: f64| {
        let i = (s * DEGREE as f64).round() as usize;
        let sign = if (DEGREE - i).is_multiple_of(2) { 1.0 } else { -1.0 };
        DVec3::new(10.0 * s, 10.0 * t, 0.25 * sign * choose(2 * DEGREE, 2 * i) / choose(DEGREE, i))
    };
    net([DEGREE, 1], [knots(DEGREE, &[]), knots(1, &[])], point, |_, _| 1.0)
}

fn crowded_knots() -> BsplineSurface {
    let inner = [0.5, 0.5 + 1e-12, 0.5 + 2e-12, 0.75];
    net([3, 3], [knots(3, &inner), knots(3, &inner)], hills, |_, _| 1.0)
}

/// The side v = 0 is a point.
fn pole() -> BsplineSurface {
    let point = |s: f64, t: f64| {
        let angle = (s - 0.5) * 2.0;
        DVec3::new(10.0 * t * angle.cos(), 10.0 * t * angle.sin(), 3.0 * t * t)
    };
    net([3, 3], [knots(3, &[0.5]), knots(3, &[0.4])], point, |_, _| 1.0)
}

/// `(x³, y, x²)`, which has no tangent across its ridge x = 0, over [−1, 1] × [0, 2].
fn cusp() -> BsplineSurface {
    let cubes = [-1.0, 1.0, -1.0, 1.0];
    let squares = [1.0, -1.0 / 3.0, -1.0 / 3.0, 1.0];
    let point = |s: f64, t: f64| {
        let i = (s * 3.0).round() as usize;
        DVec3::new(cubes[i], 2.0 * t, squares[i])
    };
    net([3, 1], [knots(3, &[]), knots(1, &[])], point, |_, _| 1.0)
}

/// `(x², y, 0)` over [−1, 0.8] × [0, 2]: two layers in one place. Not to 1, where its sides would meet and pass for a seam.
fn fold() -> BsplineSurface {
    let squares = [1.0, -0.8, 0.64];
    let point = |s: f64, t: f64| DVec3::new(squares[(s * 2.0).round() as usize], 2.0 * t, 0.0);
    net([2, 1], [knots(2, &[]), knots(1, &[])], point, |_, _| 1.0)
}

/// 10 mm long and a thousandth wide: some hundred times what is left open of its border.
fn strip() -> BsplineSurface {
    let point = |s: f64, t: f64| DVec3::new(10.0 * s, 1e-3 * t, (9.0 * s).sin());
    net([3, 1], [knots(3, &[0.25, 0.5, 0.75]), knots(1, &[])], point, |_, _| 1.0)
}
