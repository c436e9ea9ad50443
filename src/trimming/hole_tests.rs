//! Closed surfaces with holes: which side of a loop the face is on.

use super::tests::{Builder, assert_area, circle_at, meridian, sphere};
use crate::brep::TrimLoop;
use crate::geometry::{Curve, Frame};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

#[test]
fn sphere_with_a_hole_away_from_its_poles() {
    let frame = Frame::from_axes(DVec3::new(3.0f64.sqrt(), 0.0, 0.0), Some(DVec3::X), None);
    for (reversed, share) in [(false, 1.0 - 0.75f64.sqrt()), (true, 1.0 + 0.75f64.sqrt())] {
        let mut b = Builder::new(sphere());
        let rim = b.edge(Curve::Circle { frame, radius: 1.0 }, [0.0, TAU]);
        b.with_loop(&[(rim, reversed)]);
        assert_area(b, 8.0 * PI * share);
    }
}

#[test]
fn a_vertex_outside_all_loops_makes_them_holes() {
    let patch = 4.0 * 0.5f64.sin();
    let inside = DVec3::new(0.5f64.cos() * 0.2f64.cos(), 0.5f64.sin() * 0.2f64.cos(), 0.2f64.sin()) * 2.0;
    let vertices = [(None, patch), (Some(DVec3::Z * 2.0), 16.0 * PI - patch)];
    let corner = DVec3::X * 2.0;
    let on_edge = DVec3::new(0.3f64.cos(), 0.3f64.sin(), 0.0) * 2.0;
    let elsewhere = [
        (Some(-DVec3::X * 2.0), 16.0 * PI - patch),
        (Some(inside), patch),
        (Some(corner), patch),
        (Some(on_edge), patch),
    ];
    for (vertex, expected) in vertices.into_iter().chain(elsewhere) {
        for reversed in [false, true] {
            let mut b = Builder::new(sphere());
            let low = b.edge(circle_at(0.0, 2.0), [0.0, 1.0]);
            let right = b.edge(meridian(1.0, 2.0), [0.0, 0.5]);
            let high = b.edge(circle_at(2.0 * 0.5f64.sin(), 2.0 * 0.5f64.cos()), [1.0, 0.0]);
            let left = b.edge(meridian(0.0, 2.0), [0.5, 0.0]);
            let mut edges = vec![(low, reversed), (right, reversed), (high, reversed), (left, reversed)];
            if reversed {
                edges.reverse();
            }
            b.with_loop(&edges);
            if let Some(point) = vertex {
                let vertex = b.vertex(point);
                b.face.loops.push(TrimLoop::Vertex(vertex));
            }
            assert_area(b, expected);
        }
    }
}
