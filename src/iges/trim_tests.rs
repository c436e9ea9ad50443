//! Boundaries of trimmed and of bounded surfaces.

use super::tests::*;
use crate::brep::TrimLoop;
use crate::geometry::Surface;

#[test]
fn a_trimmed_plane() {
    let model = clean(&trimmed(part(108, "0,0,1,0,0,0,0,0,1"), Vec::new(), square()));
    assert_eq!((model.faces.len(), model.edges.len(), model.vertices.len()), (1, 4, 4));
    assert_eq!(model.faces.iter().next().map(|f| f.entity), Some(15));
    assert!((trims(&model) - 4.0).abs() < 1e-12);
    assert_eq!(model.source.schema, "IGES 5.3");
}

#[test]
fn turned_and_doubled_edges() {
    // Every second edge is given backwards.
    let curves =
        ["0,0,0,2,0,0", "2,2,0,2,0,0", "2,2,0,0,2,0", "0,0,0,0,2,0"].map(|line| part(110, line)).into();
    let model = clean(&trimmed(part(108, "0,0,1,0"), Vec::new(), curves));
    assert_eq!(model.vertices.len(), 4);
    assert!((trims(&model) - 4.0).abs() < 1e-12);
}

#[test]
fn revolved_surfaces_and_seams() {
    // A cylinder of radius 1 and height 2: bottom circle, seam, top circle, seam again.
    let axis = part(110, "0,0,0,0,0,1");
    let profile = part(110, "1,0,0,1,0,2");
    let curves = vec![
        part(100, "0,0,0,1,0,1,0"),
        part(110, "1,0,0,1,0,2"),
        // Arcs run counter-clockwise: the upper one is seen from below.
        part(100, "-2,0,0,1,0,1,0").transform(7),
        part(110, "1,0,2,1,0,0"),
    ];
    let below = part(124, "1,0,0,0,0,-1,0,0,0,0,-1,0");
    let model = clean(&trimmed(part(120, "3,5,0,6.28318"), vec![axis, profile, below], curves));
    assert!(matches!(model.surfaces.iter().next(), Some(Surface::Cylinder { .. })));
    let loops = &model.faces.iter().next().expect("a face").loops;
    let [TrimLoop::Edges(coedges)] = loops.as_slice() else { panic!("one loop") };
    assert_eq!(coedges[1].edge, coedges[3].edge, "the seam is one edge");
    assert!((trims(&model) - 2.0 * std::f64::consts::TAU).abs() < 1e-6);
}

#[test]
fn a_torus_of_closed_seams() {
    // Radii 3 and 1. The seams meet in one corner; each is listed with its way back right after it.
    let axis = part(110, "0,0,0,0,0,1");
    let upright = part(124, "1,0,0,0,0,0,-1,0,0,1,0,0");
    let mirrored = part(124, "1,0,0,0,0,0,1,0,0,-1,0,0");
    let below = part(124, "1,0,0,0,0,-1,0,0,0,0,-1,0");
    let profile = part(100, "0,3,0,4,0,4,0").transform(5);
    let curves = vec![
        part(100, "0,0,0,4,0,4,0"),
        part(100, "0,0,0,4,0,4,0").transform(9),
        part(100, "0,3,0,4,0,4,0").transform(5),
        part(100, "0,3,0,4,0,4,0").transform(7),
    ];
    let others = vec![axis, upright, mirrored, below, profile];
    let model = clean(&trimmed(part(120, "3,11,0,6.283185307179586"), others, curves));
    assert!((trims(&model) - std::f64::consts::TAU.powi(2)).abs() < 1e-6, "{}", trims(&model));
}

#[test]
fn parameter_curves_are_lifted() {
    let line = |text: &str| entity(110, FLAT, text);
    let entities = vec![
        part(128, BILINEAR),
        line("0.2,0.2,0,0.8,0.2,0"),
        line("0.8,0.2,0,0.8,0.8,0"),
        line("0.8,0.8,0,0.2,0.8,0"),
        line("0.2,0.8,0,0.2,0.2,0"),
        entity(102, FLAT, "4,3,5,7,9"),
        part(142, "0,1,11,0,1"),
        top(144, "1,1,0,13"),
    ];
    let model = clean(&entities);
    let area = trims(&model);
    assert!((area - 0.36).abs() < 1e-6, "{area}");
    let edge = model.edges.iter().next().expect("an edge");
    let [pcurve] = edge.pcurves.as_slice() else { panic!("a parameter curve") };
    for i in 0..=10 {
        let t = edge.range[0] + (edge.range[1] - edge.range[0]) * f64::from(i) / 10.0;
        let lifted = model.surfaces[pcurve.surface].point(pcurve.curve.point(t));
        assert!(lifted.distance(edge.curve.point(t)) < 1e-12);
    }
}

#[test]
fn a_dummy_in_space_is_not_believed() {
    let mut entities = vec![part(128, BILINEAR)];
    entities.push(entity(106, FLAT, "1,5,0,0.2,0.2,0.8,0.2,0.8,0.8,0.2,0.8,0.2,0.2").form(63));
    entities.push(part(106, "1,5,500,0,0,1,0,1,1,0,1,0,0").form(63));
    entities.push(part(142, "0,1,3,5,1"));
    entities.push(top(144, "1,1,0,7"));
    let model = model(&entities);
    assert!((trims(&model) - 0.36).abs() < 1e-6);
    assert_eq!(model.diagnostics.len(), 1);
}

#[test]
fn a_hole_in_natural_bounds() {
    let mut entities = vec![part(128, BILINEAR)];
    entities.push(entity(106, FLAT, "1,5,0,0.2,0.2,0.8,0.2,0.8,0.8,0.2,0.8,0.2,0.2").form(63));
    entities.push(part(142, "0,1,3,0,1"));
    entities.push(top(144, "1,0,1,0,5"));
    let model = clean(&entities);
    assert_eq!(model.faces.iter().next().map(|f| f.loops.len()), Some(2));
    assert!((trims(&model) - 1.0).abs() < 1e-6);
}

#[test]
fn bounded_surfaces() {
    let mut entities = vec![part(108, "0,0,1,0")];
    entities.extend(square());
    // The third curve is given against its sense.
    entities[3] = part(110, "0,2,0,2,2,0");
    entities.push(part(141, "0,0,1,4,3,1,0,5,1,0,7,2,0,9,1,0"));
    entities.push(top(143, "0,1,1,11").color(3));
    let model = clean(&entities);
    assert!((trims(&model) - 4.0).abs() < 1e-12);
    assert_eq!(model.faces.iter().next().and_then(|f| f.color).map(|c| c.rgb), Some([0.0, 1.0, 0.0]));
}

#[test]
fn seams_that_cross() {
    // A torus of radii 7 and 2 without an eighth of it: x, y and z positive. Its boundary runs along the seam around the axis and
    // along the one around the tube. The curves follow each other, but where the seams cross the wrong one comes next.
    let helpers = vec![
        part(116, "0,0,0"),
        part(123, "0,0,1"),
        // Below the plane of the axis' seam: arcs run clockwise.
        part(124, "1,0,0,0,0,-1,0,0,0,0,-1,0"),
        // The tube at y = 0, over and under the plane, and at x = 0.
        part(124, "1,0,0,7,0,0,-1,0,0,1,0,0"),
        part(124, "1,0,0,7,0,0,1,0,0,-1,0,0"),
        part(124, "0,0,-1,0,0,1,0,7,1,0,0,0"),
    ];
    let curves = vec![
        part(100, "0,0,0,0,-2,0,2").transform(13),
        part(100, "0,0,0,0,9,9,0"),
        part(100, "0,0,0,9,0,0,-9").transform(7),
        part(100, "0,0,0,0,-9,9,0").transform(7),
        part(100, "0,0,0,2,0,-2,0").transform(11),
        part(100, "0,0,0,-2,0,2,0").transform(9),
        part(100, "0,0,0,2,0,-2,0").transform(9),
        part(100, "0,0,0,5,0,0,5"),
    ];
    let model = clean(&trimmed(part(198, "3,5,7,2"), helpers, curves));
    let face = model.faces.iter().next().expect("a face");
    let [TrimLoop::Edges(coedges)] = face.loops.as_slice() else { panic!("one loop") };
    assert_eq!(coedges.len(), 8);
    // No edge is followed by itself run back.
    for (i, coedge) in coedges.iter().enumerate() {
        assert!(coedge.edge != coedges[(i + 1) % coedges.len()].edge, "{coedges:?}");
    }
    // The face goes all the way around both ways.
    let whole = std::f64::consts::TAU * std::f64::consts::TAU;
    assert!((trims(&model) - whole).abs() < 1e-6);
}
