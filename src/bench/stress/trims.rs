//! Trims that are hard to trace: slivers, needles, long loops, loops that touch themselves or hug a seam.

use super::aim::Aim;
use super::draft::{Draft, frame_at, knots, line, net};
use super::{Case, Stress};
use crate::bench::edge_points;
use crate::brep::{Model, primitive};
use crate::geometry::{Curve, Frame, Surface, to_bspline};
use glam::DVec3;
use std::f64::consts::TAU;

/// Width of slivers, millimetres, on faces of 20 mm: 10⁻⁹ of the window.
const SLIVER: f64 = 2e-8;

/// Edges of the long loop.
const LONG_LOOP: usize = 10_000;

/// Half the angle between a loop and the seam that it hugs, radians.
const FROM_SEAM: f64 = 1e-9;

pub(super) const CASES: &[Case] = &[
    Case { name: "sliver-spike", build: || prism(&spike()) },
    Case { name: "sliver-slit", build: sliver_slit },
    Case { name: "sliver-slit-net", build: sliver_slit_net },
    Case { name: "needles", build: || prism(&needles()) },
    Case { name: "long-loop", build: long_loop },
    Case { name: "touching-loop", build: || prism(&BOW_TIE) },
    Case { name: "seam", build: || tube(Surface::Cylinder { frame: Frame::IDENTITY, radius: RADIUS }) },
    Case { name: "seam-net", build: seam_net },
];

/// Two triangles that meet in (2, 2), as one loop.
const BOW_TIE: [[f64; 2]; 6] = [[0.0, 0.0], [4.0, 0.0], [2.0, 2.0], [4.0, 4.0], [0.0, 4.0], [2.0, 2.0]];

const RADIUS: f64 = 3.0;
const HEIGHT: f64 = 5.0;

/// A solid, with rays past its edges.
fn prism(polygon: &[[f64; 2]]) -> Stress {
    let mut draft = Draft::default();
    let faces = primitive::prism(&mut draft.model, &Frame::IDENTITY, polygon, 2.0, 1);
    draft.solid(faces);
    past_edges(draft)
}

fn past_edges(draft: Draft) -> Stress {
    let model: Model = draft.finished();
    let points = edge_points(&model);
    Stress { model, aim: Aim::Past(points) }
}

/// A square with a spike as long and 10⁻⁹ as wide.
fn spike() -> [[f64; 2]; 8] {
    let [low, high] = [5.0, 5.0 + SLIVER];
    [[0.0, 0.0], [10.0, 0.0], [10.0, low], [20.0, low], [20.0, high], [10.0, high], [10.0, 10.0], [0.0, 10.0]]
}

fn slit_loops(draft: &mut Draft) -> Vec<crate::brep::TrimLoop> {
    let corner = |x: f64, y: f64| DVec3::new(x, y, 0.0);
    let outer = [corner(0.0, 0.0), corner(20.0, 0.0), corner(20.0, 20.0), corner(0.0, 20.0)];
    let (near, far) = (7.0, 7.0 + SLIVER);
    let slit = [corner(2.0, near), corner(2.0, far), corner(18.0, far), corner(18.0, near)];
    vec![draft.polygon(&outer), draft.polygon(&slit)]
}

/// A square with a slit in it.
fn sliver_slit() -> Stress {
    let mut draft = Draft::default();
    let loops = slit_loops(&mut draft);
    draft.sheet(Surface::Plane { frame: Frame::IDENTITY }, loops);
    past_edges(draft)
}

/// The same on a net.
fn sliver_slit_net() -> Stress {
    let mut draft = Draft::default();
    let loops = slit_loops(&mut draft);
    let flat = |s: f64, t: f64| DVec3::new(20.0 * s, 20.0 * t, 0.0);
    let plane = net([1, 1], [knots(1, &[0.5]), knots(1, &[0.5])], flat, |_, _| 1.0);
    draft.sheet(Surface::Bspline(plane), loops);
    past_edges(draft)
}

/// A disc with 24 spikes of ten millimetres, each a ten-thousandth wide at its foot.
fn needles() -> Vec<[f64; 2]> {
    const COUNT: usize = 24;
    let spikes = (0..COUNT).flat_map(|i| {
        let angle = TAU * i as f64 / COUNT as f64;
        [(angle, 2.0), (angle + 2.5e-5, 12.0), (angle + 5e-5, 2.0)]
    });
    spikes.map(|(angle, radius)| [radius * angle.cos(), radius * angle.sin()]).collect()
}

fn long_loop() -> Stress {
    let mut draft = Draft::default();
    let points: Vec<DVec3> = (0..LONG_LOOP)
        .map(|i| {
            let angle = TAU * i as f64 / LONG_LOOP as f64;
            let radius = 10.0 + (31.0 * angle).sin() + if i % 2 == 0 { 0.002 } else { 0.0 };
            DVec3::new(radius * angle.cos(), radius * angle.sin(), 0.0)
        })
        .collect();
    let trim = draft.polygon(&points);
    draft.sheet(Surface::Plane { frame: Frame::IDENTITY }, vec![trim]);
    past_edges(draft)
}

/// A tube around z, open along its seam by twice [`FROM_SEAM`].
fn tube(surface: Surface) -> Stress {
    let mut draft = Draft::default();
    let [start, end] = [FROM_SEAM, TAU - FROM_SEAM];
    let circle = |z: f64| Curve::Circle { frame: frame_at(0.0, 0.0, z), radius: RADIUS };
    let at = |z: f64, angle: f64| circle(z).point(angle);
    let pieces = vec![
        (circle(0.0), [start, end]),
        (line(at(0.0, end), at(HEIGHT, end)), [0.0, 1.0]),
        (circle(HEIGHT), [end, start]),
        (line(at(HEIGHT, start), at(0.0, start)), [0.0, 1.0]),
    ];
    let trim = draft.chain(pieces);
    draft.sheet(surface, vec![trim]);
    past_edges(draft)
}

fn seam_net() -> Stress {
    let circle = Curve::Circle { frame: Frame::IDENTITY, radius: RADIUS };
    let profile = to_bspline::curve_to_bspline(&circle, [0.0, TAU]);
    tube(Surface::Bspline(to_bspline::extrude(&profile, DVec3::Z, [0.0, HEIGHT])))
}
