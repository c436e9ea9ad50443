//! Surface entities, alone and trimmed.

use super::tests::*;
use crate::geometry::Surface;
use glam::DVec3;

/// The surface of a file that holds one, standing alone.
fn alone(surface: Entity, helpers: Vec<Entity>) -> Surface {
    let mut entities = vec![surface];
    entities.extend(helpers);
    let model = clean(&entities);
    assert_eq!(model.faces.len(), 1);
    model.surfaces[model.faces.iter().next().expect("a face").surface].clone()
}

fn corners(surface: &Surface) -> [DVec3; 4] {
    let d = surface.domain();
    [d.min, glam::DVec2::new(d.max.x, d.min.y), glam::DVec2::new(d.min.x, d.max.y), d.max]
        .map(|uv| surface.point(uv))
}

fn assert_corners(surface: &Surface, expected: [[f64; 3]; 4]) {
    for (found, expected) in corners(surface).into_iter().zip(expected) {
        assert!(found.distance(DVec3::from_array(expected)) < 1e-12, "{found} instead of {expected:?}");
    }
}

#[test]
fn surfaces_that_stand_alone() {
    let ruled = alone(top(118, "3,5,0,0").form(1), vec![part(110, "0,0,0,1,0,0"), part(110, "0,1,1,1,1,1")]);
    assert_corners(&ruled, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 1.0], [1.0; 3]]);
    let turned = alone(top(118, "3,5,1,0").form(1), vec![part(110, "0,0,0,1,0,0"), part(110, "0,1,1,1,1,1")]);
    assert_corners(&turned, [[0.0; 3], [1.0, 0.0, 0.0], [1.0; 3], [0.0, 1.0, 1.0]]);
    let mixed = alone(top(118, "3,5,0,0"), vec![part(100, "0,0,0,1,0,-1,0"), part(110, "1,0,3,-1,0,3")]);
    assert_corners(&mixed, [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [1.0, 0.0, 3.0], [-1.0, 0.0, 3.0]]);
    let tabulated = alone(top(122, "3,0,0,5"), vec![part(110, "0,0,0,1,0,0")]);
    assert_corners(&tabulated, [[0.0; 3], [1.0, 0.0, 0.0], [0.0, 0.0, 5.0], [1.0, 0.0, 5.0]]);
    let quarter = std::f64::consts::FRAC_PI_2;
    let revolved = alone(
        top(120, &format!("3,5,0,{quarter}")),
        vec![part(110, "0,0,0,0,0,1"), part(110, "1,0,0,2,0,0")],
    );
    assert_corners(&revolved, [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 2.0, 0.0]]);
    let spline = alone(
        top(128, "1,1,1,1,0,0,1,0,0,0,0,1,1,0,0,1,1,1,1,1,1,0,0,0,2,0,0,0,2,0,2,2,1,0,1,0,1"),
        Vec::new(),
    );
    assert_corners(&spline, [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 2.0, 0.0], [2.0, 2.0, 1.0]]);
}

#[test]
fn a_closed_surface_may_begin_elsewhere_than_at_its_seam() {
    // A tube around a square, quadratic and periodic in v over [2, 6], of which the file wants [3, 7].
    let square = ["1,0", "0,1", "-1,0", "0,-1", "1,0", "0,1"];
    let points: Vec<String> = square.iter().map(|p| format!("{p},0,{p},1")).collect();
    let weights = ["1"; 12].join(",");
    let points = points.join(",");
    let tube = alone(
        top(128, &format!("1,5,1,2,0,1,1,0,1,0,0,1,1,0,1,2,3,4,5,6,7,8,{weights},{points},0,1,3,7")),
        Vec::new(),
    );
    let domain = tube.domain();
    assert_eq!((domain.min.y, domain.max.y, tube.periods()[1]), (2.0, 6.0, Some(4.0)));
    let beyond = tube.point(glam::DVec2::new(0.0, 6.5));
    assert!(beyond.distance(tube.point(glam::DVec2::new(0.0, 2.5))) < 1e-15);
}

#[test]
fn no_sliver_is_left_beside_a_knot() {
    // Two flat patches that meet at v = 0, of which the file wants the second, from a rounding before it.
    let points = "0,0,0,1,0,0,0,1,0,1,1,0,0,3,0,1,3,0";
    let surface = alone(
        top(128, &format!("1,2,1,1,0,0,1,0,0,0,0,1,1,-1,-1,0,2,2,1,1,1,1,1,1,{points},0,1,-1e-15,2")),
        Vec::new(),
    );
    assert_eq!((surface.domain().min.y, surface.domain().max.y), (0.0, 2.0));
    let Surface::Bspline(spline) = &surface else { panic!("no spline: {}", surface.kind()) };
    assert_eq!(spline.counts(), [2, 2]);
}

#[test]
fn parametric_spline_surface() {
    // One patch x = 2u, y = 3v, z = u v, followed by the strips that mean nothing.
    let mut patch = [0.0; 48];
    (patch[1], patch[16 + 4], patch[32 + 5]) = (2.0, 3.0, 1.0);
    let numbers: Vec<String> = patch.iter().chain([0.0; 3 * 48].iter()).map(f64::to_string).collect();
    let surface = alone(top(114, &format!("3,1,1,1,0,1,0,1,{}", numbers.join(","))), Vec::new());
    assert_corners(&surface, [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 3.0, 0.0], [2.0, 3.0, 1.0]]);
}

#[test]
fn elementary_surfaces_with_poles() {
    let sphere = clean(&[top(196, "3,2.5"), part(116, "1,2,3")]);
    let face = sphere.faces.iter().next().expect("a face");
    assert!(matches!(&sphere.surfaces[face.surface], Surface::Sphere { radius, .. } if *radius == 2.5));
    let torus = clean(&[top(198, "3,5,4,1"), part(116, "0,0,0"), part(123, "0,0,1")]);
    assert_eq!(torus.surfaces.iter().next().map(Surface::kind), Some("torus"));
    let wedge = "3,5,1,30";
    let curves = vec![part(100, "0,0,0,1,0,1,0")];
    let cone = clean(&trimmed(part(194, wedge), vec![part(116, "0,0,0"), part(123, "0,0,-1")], curves));
    assert!(
        matches!(cone.surfaces.iter().next(), Some(Surface::Cone { half_angle, .. }) if (half_angle - 30_f64.to_radians()).abs() < 1e-15)
    );
}

#[test]
fn offset_surfaces() {
    // A sphere, outwards and inwards; the first vector shows the side.
    for (indicator, distance, radius) in [("-1,0,0", 0.5, 2.5), ("1,0,0", 0.5, 1.5), ("1,0,0", -0.5, 2.5)] {
        let entities = [top(140, &format!("{indicator},{distance},3")), part(196, "5,2"), part(116, "1,2,3")];
        let model = clean(&entities);
        assert_eq!(model.faces.len(), 1);
        let found = model.surfaces.iter().next().expect("a surface");
        assert!(
            matches!(found, Surface::Sphere { radius: found, .. } if (found - radius).abs() < 1e-12),
            "{found:?} instead of {radius}"
        );
    }
    // A saddle is fitted, which is reported.
    let model = model(&[top(140, "0,0,1,2.5,3"), part(128, BILINEAR)]);
    assert_eq!((model.faces.len(), model.diagnostics.len()), (1, 1));
    let base = alone(top(128, BILINEAR), Vec::new());
    let offset = &model.surfaces[model.faces.iter().next().expect("a face").surface];
    for uv in [[0.0, 0.0], [0.3, 0.9], [1.0, 1.0], [0.5, 0.5]].map(glam::DVec2::from_array) {
        let d = base.derivatives(uv);
        let expected = d.point + d.du.cross(d.dv).normalize() * 2.5;
        assert!(offset.point(uv).distance(expected) < 1e-5);
    }
    // A trimmed one, and offsets in a circle.
    let plane = trimmed(part(140, "0,0,1,1,3"), vec![part(108, "0,0,1,-1")], square());
    assert!((trims(&clean(&plane)) - 4.0).abs() < 1e-9);
    assert_eq!(super::tests::model(&[top(140, "0,0,1,1,1")]).faces.len(), 0);
}

#[test]
fn the_side_of_an_offset_is_shown_in_the_middle_of_the_given_surface() {
    // Half cylinders of radius 1 as splines, offset outwards: they are recognised, but where their middle is only the spline knows.
    for turn in 0..8 {
        let at = |step: f64, radius: f64| {
            let angle = f64::from(turn) * std::f64::consts::FRAC_PI_4 + step * std::f64::consts::FRAC_PI_4;
            [radius * angle.cos(), radius * angle.sin()]
        };
        let row = |z: f64| {
            let corner = |i: u8| at(f64::from(i), if i % 2 == 1 { 2.0_f64.sqrt() } else { 1.0 });
            (0..5).map(|i| format!("{},{},{z}", corner(i)[0], corner(i)[1])).collect::<Vec<_>>().join(",")
        };
        let weights = ["1,0.70710678118654752,1,0.70710678118654752,1"; 2].join(",");
        let points = format!("{},{}", row(0.0), row(2.0));
        let spline = format!("4,1,2,1,0,0,0,0,0,0,0,0,1,1,2,2,2,0,0,1,1,{weights},{points},0,2,0,1");
        let [middle, start, end] = [at(2.0, 1.0), at(0.0, 1.5), at(4.0, 1.5)];
        let offset = part(140, &format!("{},{},0,0.5,3", middle[0], middle[1]));
        let arc = |z: f64| part(100, &format!("{z},0,0,{},{},{},{}", start[0], start[1], end[0], end[1]));
        let line = |p: [f64; 2]| part(110, &format!("{0},{1},0,{0},{1},2", p[0], p[1]));
        let curves = vec![arc(0.0), line(end), arc(2.0), line(start)];
        let model = model(&trimmed(offset, vec![part(128, &spline)], curves));
        let surface = model.surfaces.iter().next().expect("a surface");
        assert!(
            matches!(surface, Surface::Cylinder { radius, .. } if (radius - 1.5).abs() < 1e-9),
            "turned {turn} times: {surface:?}"
        );
    }
}

#[test]
fn mirrored_and_scaled() {
    let mirror = part(124, "-2,0,0,1,0,2,0,0,0,0,2,0").form(1);
    let entities = [top(196, "3,1.5").transform(5), part(116, "1,0,0"), mirror];
    let model = clean(&entities);
    let face = model.faces.iter().next().expect("a face");
    let Surface::Sphere { frame, radius } = &model.surfaces[face.surface] else { panic!("a sphere") };
    assert!((radius - 3.0).abs() < 1e-12 && frame.origin.distance(DVec3::new(-1.0, 0.0, 0.0)) < 1e-12);
    let skew = part(124, "2,0,0,0,0,1,0,0,0,0,1,0");
    let lost = super::tests::model(&[top(196, "3,1.5").transform(5), part(116, "1,0,0"), skew]);
    assert_eq!(lost.faces.len(), 0);
}

#[test]
fn splines_that_are_cut_short() {
    let end = |count: usize| BILINEAR.split(',').take(count).collect::<Vec<_>>().join(",");
    assert_eq!(clean(&[top(128, &end(33))]).faces.len(), 1);
    for count in [32, 31, 21, 17, 8, 3] {
        let model = model(&[top(128, &end(count))]);
        assert_eq!((model.faces.len(), model.declared_faces), (0, 1), "{count} parameters");
    }
}

#[test]
fn bounded_planes() {
    // A square with a round hole, which a single parent group gives to it.
    let entities = vec![
        top(108, "0,0,1,0,3,0,0,0,0").form(1),
        part(106, "1,5,0,0,0,4,0,4,4,0,4,0,0").form(63),
        part(108, "0,0,1,0,7,0,0,0,0").form(-1),
        part(100, "0,2,2,3,2,3,2"),
        top(402, "1,1,1,5").form(9),
    ];
    let model = clean(&entities);
    assert_eq!(model.faces.iter().map(|f| f.loops.len()).collect::<Vec<_>>(), [2]);
    assert!((trims(&model) - 16.0).abs() < 1e-9);
}

#[test]
fn rails_of_all_kinds() {
    // A cone from a circle to a point, and a strip whose second rail is a composite.
    let cone = alone(top(118, "3,5,0,0"), vec![part(100, "0,0,0,1,0,-1,0"), part(116, "0,0,2")]);
    assert_corners(&cone, [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 2.0], [0.0, 0.0, 2.0]]);
    let strip = alone(
        top(118, "3,5,0,0").form(1),
        vec![
            part(110, "0,0,0,2,0,0"),
            part(102, "2,7,9"),
            part(110, "0,1,0,1,1,0"),
            part(110, "1,1,0,2,1,1"),
        ],
    );
    assert_corners(&strip, [[0.0; 3], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 1.0, 1.0]]);
}
