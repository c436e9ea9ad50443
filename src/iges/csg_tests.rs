//! Constructive solids against what they are by definition.

use super::tests::*;
use crate::brep::{Model, TrimLoop, occurrences};
use crate::geometry::Surface;
use glam::{DVec2, DVec3};

/// The kinds of a model's surfaces, sorted.
fn kinds(model: &Model) -> Vec<&'static str> {
    let mut kinds: Vec<&str> = model.faces.iter().map(|face| model.surfaces[face.surface].kind()).collect();
    kinds.sort_unstable();
    kinds
}

/// Points and outward normals all over the faces that are as large as their surfaces' parameters.
fn samples(model: &Model) -> Vec<(DVec3, DVec3)> {
    let mut samples = Vec::new();
    for face in model.faces.iter().filter(|face| face.loops.is_empty()) {
        let surface = &model.surfaces[face.surface];
        let domain = surface.domain();
        for i in 1..8 {
            for j in 1..8 {
                let share = DVec2::new(f64::from(i), f64::from(j)) / 8.0;
                let d = surface.derivatives(domain.min + (domain.max - domain.min) * share);
                let normal = d.du.cross(d.dv).normalize();
                samples.push((d.point, if face.same_sense { normal } else { -normal }));
            }
        }
    }
    assert!(!samples.is_empty());
    samples
}

#[test]
fn primitives() {
    let block = clean(&[top(150, "1,2,3,10,20,30,0,1,0,0,0,1")]);
    assert_eq!(kinds(&block), ["plane"; 6]);
    // Its x axis is y.
    let far = block.vertices.iter().map(|v| v.point).fold(DVec3::NEG_INFINITY, DVec3::max);
    assert!(far.distance(DVec3::new(10.0, 21.0, 33.0)) < 1e-12);
    assert_eq!(block.declared_faces, 6);
    assert_eq!(kinds(&clean(&[top(152, "4,3,2,0")])), ["plane"; 5]);
    assert_eq!(kinds(&clean(&[top(152, "4,3,2,1")])), ["plane"; 6]);
    assert_eq!(kinds(&clean(&[top(154, "5,2,0,0,0,1,0,0")])), ["cylinder", "plane", "plane"]);
    assert_eq!(kinds(&clean(&[top(156, "5,2,1")])), ["cone", "plane", "plane"]);
    assert_eq!(kinds(&clean(&[top(156, "5,2")])), ["cone", "plane"]);
    assert_eq!(kinds(&clean(&[top(158, "5,1,2,3")])), ["sphere"]);
    assert_eq!(kinds(&clean(&[top(160, "5,1,0,0,0,0,1,0").color(2)])), ["torus"]);
    for impossible in
        [top(150, "1,0,1"), top(154, "5,-2"), top(160, "1,5"), top(152, "4,3,2,5"), top(164, "1,1")]
    {
        let model = model(&[impossible]);
        assert_eq!((model.faces.len(), model.diagnostics.len()), (0, 1));
    }
}

#[test]
fn an_ellipsoid() {
    let model = clean(&[top(168, "3,2,1,1,1,1,0,1,0,0,0,1").color(3)]);
    for (point, normal) in samples(&model) {
        let p = point - DVec3::ONE;
        // Its x axis is y, so its y axis is −x.
        let radii = DVec3::new(2.0, 3.0, 1.0);
        assert!(((p / radii).length() - 1.0).abs() < 1e-12);
        assert!((p / radii / radii).normalize().dot(normal) > 1.0 - 1e-9);
    }
    assert!(model.faces.iter().all(|face| face.color.is_some_and(|c| c.rgb == [0.0, 1.0, 0.0])));
}

#[test]
fn solids_of_revolution() {
    // A half disc beside the axis, closed by itself: a ring with half a disc for its section; and closed to the axis: a dome.
    let upright = || part(124, "1,0,0,0,0,0,-1,0,0,1,0,0");
    let arc = |text: &str| part(100, text).transform(5);
    for (form, share, faces) in [(1, "1", 2), (1, "0.25", 4), (0, "", 3)] {
        let solid = top(162, &format!("3,{share},0,0,0,0,0,1")).form(form);
        let model = clean(&[solid, arc("0,3,3,3,2,3,4"), upright()]);
        assert_eq!(model.faces.len(), faces, "form {form}, share {share}");
        for trim in model.faces.iter().flat_map(|face| &face.loops) {
            assert!(matches!(trim, TrimLoop::Edges(_)));
        }
    }
    // A whole circle makes a torus.
    let entities = [top(162, "3"), arc("0,4,0,5,0,5,0"), upright()];
    for (point, normal) in samples(&clean(&entities)) {
        let center = DVec3::new(point.x, point.y, 0.0).normalize() * 4.0;
        assert!((point.distance(center) - 1.0).abs() < 1e-12, "{point}");
        assert!((point - center).normalize().dot(normal) > 1.0 - 1e-9, "{point} {normal}");
    }
}

#[test]
fn solids_of_linear_extrusion() {
    for direction in ["0,0,1", "0,0.6,0.8", "0,0,-1"] {
        let model = clean(&[top(164, &format!("3,5,{direction}")), part(100, "0,0,0,1,0,1,0")]);
        assert_eq!(model.faces.len(), 3);
        let ends: Vec<_> = model.faces.iter().filter(|face| !face.loops.is_empty()).collect();
        for (point, normal) in samples(&model) {
            // Away from the middle line, which goes along the direction.
            let sign = if direction.ends_with("-1") { -1.0 } else { 1.0 };
            let up = if direction == "0,0.6,0.8" { DVec3::new(0.0, 0.75, 1.0) } else { DVec3::Z };
            let center = up * point.z;
            assert!((point.distance(center) - 1.0).abs() < 1e-12 && sign * point.z >= 0.0);
            assert!((point - center).dot(normal) > 0.0, "{direction}");
        }
        for (face, expected) in ends.iter().zip([-1.0, 1.0]) {
            let Surface::Plane { frame } = &model.surfaces[face.surface] else { panic!("a plane") };
            let normal = if face.same_sense { frame.z } else { -frame.z };
            let outwards = if direction.ends_with("-1") { -expected } else { expected };
            assert!(normal.z * outwards > 0.0, "{direction}: {normal}");
        }
    }
    let open = model(&[top(164, "3,5"), part(100, "0,0,0,1,0,-1,0")]);
    assert_eq!((open.faces.len(), open.diagnostics.len()), (0, 1));
}

#[test]
fn trees_assemblies_and_instances() {
    // A tree of one solid is that solid; one of two is refused, and its solids are not shown.
    assert_eq!(clean(&[top(180, "1,-3"), part(158, "1")]).faces.len(), 1);
    let refused = model(&[top(180, "3,-3,-5,1"), part(158, "1"), part(158, "1,1")]);
    assert_eq!((refused.faces.len(), refused.diagnostics.len()), (0, 1));
    // An assembly of the same sphere in two places, one of which is an instance elsewhere.
    let entities = [
        top(184, "2,3,5,7,0"),
        part(158, "1"),
        part(430, "3").transform(9),
        part(124, "1,0,0,10,0,1,0,0,0,0,1,0"),
        part(124, "1,0,0,0,0,1,0,20,0,0,1,0"),
    ];
    let model = clean(&entities);
    assert_eq!(model.faces.len(), 1, "one solid, placed twice");
    let (places, _) = occurrences(&model);
    let at: Vec<DVec3> = places.iter().map(|p| p.world_from_part.translation).collect();
    assert_eq!(at, [DVec3::new(10.0, 0.0, 0.0), DVec3::new(0.0, 20.0, 0.0)]);
}
