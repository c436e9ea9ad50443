//! Curve entities, as boundaries of planes.

use super::tests::*;
use crate::brep::Model;
use crate::geometry::Curve;

#[test]
fn circles_and_placements() {
    // A disc in the plane x = 5, made in x-y and turned about y.
    let turn = part(124, "0,0,1,5,0,1,0,0,-1,0,0,0");
    let plane = part(108, "0,0,1,0").transform(3);
    let model = clean(&trimmed(plane, vec![turn], vec![part(100, "0,1,1,2,1,2,1").transform(3)]));
    let edge = model.edges.iter().next().expect("an edge");
    assert!(matches!(&edge.curve, Curve::Circle { radius, .. } if (radius - 1.0).abs() < 1e-15));
    assert!(edge.vertices[0] == edge.vertices[1] && (edge.curve.point(0.0).x - 5.0).abs() < 1e-15);
    assert!((trims(&model) - 4.0).abs() < 1e-9);
}

#[test]
fn a_skewed_circle_is_an_ellipse() {
    let skew = part(124, "2,0,0,0,0,1,0,0,0,0,1,0");
    let model =
        clean(&trimmed(part(108, "0,0,1,0"), vec![skew], vec![part(100, "0,0,0,1,0,1,0").transform(3)]));
    assert!((trims(&model) - 8.0).abs() < 1e-9);
}

/// Half a region above the x axis: closed by a line from (−1, 0) to (1, 0).
fn half_disc(arc: Entity) -> Model {
    clean(&trimmed(part(108, "0,0,1,0"), Vec::new(), vec![part(110, "-1,0,0,1,0,0"), arc]))
}

#[test]
fn curves_of_every_kind() {
    // Half circles as arc, conic, polyline and splines; parabola and hyperbola through the same ends.
    let cases = [
        (part(100, "0,0,0,1,0,-1,0"), 2.0),
        (part(104, "1,0,4,0,0,-1,0,1,0,-1,0").form(1), 1.0),
        (part(104, "1,0,0,0,1,-1,0,1,0,-1,0").form(3), 2.0),
        (part(106, "2,3,1,0,0,0,1,0,-1,0,0").form(12), 2.0),
        (part(106, "1,3,0,1,0,0,1,-1,0").form(11), 2.0),
        (part(112, "3,1,2,1,0,1,1,-2,0,0,0,4,-4,0,0,0,0,0"), 2.0),
        (part(126, "2,2,1,0,1,0,0,0,0,1,1,1,1,1,1,1,0,0,0,2,0,-1,0,0,0,1,0,0,1"), 2.0),
    ];
    for (arc, area) in cases {
        let kind = (arc.kind, arc.form);
        let found = trims(&half_disc(arc));
        assert!((found - area).abs() < 1e-9, "{kind:?}: {found}");
    }
}

#[test]
fn a_hyperbola() {
    // x² − y² = 1 between y = −1 and y = 1.
    let ends = format!("{0},-1,{0},1", 2.0_f64.sqrt());
    let arc = part(104, &format!("1,0,-1,0,0,-1,0,{ends}")).form(2);
    let line = part(110, &format!("{0},1,0,{0},-1,0", 2.0_f64.sqrt()));
    let model = clean(&trimmed(part(108, "0,0,1,0"), Vec::new(), vec![arc, line]));
    assert!((trims(&model) - 2.0 * (2.0_f64.sqrt() - 1.0)).abs() < 1e-9);
}

/// The conic `λ₀ x² + λ₁ y² + μ x = ν` turned by `angle` and moved by `(p, q)`, with ends at local `(x, y)`.
fn turned_conic(
    lambda: [f64; 2],
    mu: f64,
    nu: f64,
    angle: f64,
    ends: [[f64; 2]; 2],
) -> (String, [[f64; 2]; 2], [f64; 6]) {
    let (p, q) = (0.7, -1.3);
    let (sin, cos) = angle.sin_cos();
    // x = c (X − p) + s (Y − q), y = −s (X − p) + c (Y − q).
    let [l0, l1] = lambda;
    let a = l0 * cos * cos + l1 * sin * sin;
    let b = 2.0 * (l0 - l1) * sin * cos;
    let c = l0 * sin * sin + l1 * cos * cos;
    let (d0, e0) = (mu * cos, mu * sin);
    let d = d0 - 2.0 * a * p - b * q;
    let e = e0 - 2.0 * c * q - b * p;
    let f = a * p * p + b * p * q + c * q * q - d0 * p - e0 * q - nu;
    let outer = ends.map(|[x, y]| [p + cos * x - sin * y, q + sin * x + cos * y]);
    let all = [a, b, c, d, e, f];
    let numbers: Vec<String> =
        all.iter().chain([2.0].iter()).chain(outer.iter().flatten()).map(|n| format!("{n:.17e}")).collect();
    (numbers.join(","), outer, all)
}

#[test]
fn conics_with_turned_axes() {
    let cosh = |y: f64| (1.0 + y * y / 4.0).sqrt() * 3.0;
    for i in 0..16 {
        let angle = 0.4 * f64::from(i);
        let ellipse = turned_conic([1.0 / 9.0, 0.25], 0.0, 1.0, angle, [[3.0, 0.0], [0.0, -2.0]]);
        let hyperbola =
            turned_conic([1.0 / 9.0, -0.25], 0.0, 1.0, angle, [[cosh(-1.0), -1.0], [cosh(2.5), 2.5]]);
        let other_branch =
            turned_conic([-1.0 / 9.0, 0.25], 0.0, -1.0, angle, [[-cosh(1.0), 1.0], [-cosh(2.0), -2.0]]);
        let parabola = turned_conic([0.0, 1.0], -2.0, 0.0, angle, [[0.5, 1.0], [2.0, -2.0]]);
        for (form, (text, ends, [a, b, c, d, e, f])) in
            [(1, ellipse), (2, hyperbola), (2, other_branch), (3, parabola)]
        {
            // The form may be left open.
            for form in [form, 0] {
                let [[x1, y1], [x2, y2]] = ends;
                let chord = part(110, &format!("{x2:.17e},{y2:.17e},2,{x1:.17e},{y1:.17e},2"));
                let model = clean(&trimmed(
                    part(108, "0,0,1,2"),
                    Vec::new(),
                    vec![part(104, &text).form(form), chord],
                ));
                assert_eq!(model.vertices.len(), 2, "form {form} at {angle}");
                let edge = model.edges.iter().next().expect("an edge");
                for i in 0..=20 {
                    let t = edge.range[0] + (edge.range[1] - edge.range[0]) * f64::from(i) / 20.0;
                    let p = edge.curve.point(t);
                    let value = a * p.x * p.x + b * p.x * p.y + c * p.y * p.y + d * p.x + e * p.y + f;
                    assert!(value.abs() < 1e-9 && (p.z - 2.0).abs() < 1e-12, "form {form}: {value}");
                }
                let start = edge.curve.point(edge.range[0]);
                assert!((start.x - x1).hypot(start.y - y1) < 1e-9);
            }
        }
    }
}

#[test]
fn a_quarter_of_an_ellipse_runs_counter_clockwise() {
    let (text, [[x1, y1], [x2, y2]], _) =
        turned_conic([1.0 / 9.0, 0.25], 0.0, 1.0, 0.3, [[3.0, 0.0], [0.0, -2.0]]);
    let chord = part(110, &format!("{x2:.17e},{y2:.17e},2,{x1:.17e},{y1:.17e},2"));
    let model = clean(&trimmed(part(108, "0,0,1,2"), Vec::new(), vec![part(104, &text).form(1), chord]));
    let edge = model.edges.iter().next().expect("an edge");
    assert!(((edge.range[1] - edge.range[0]) - 1.5 * std::f64::consts::PI).abs() < 1e-9);
}

/// The first edge of a plane that is bounded by `curve` (entity 3, after its `base`, entity 5) and a line between its ends.
fn first_edge(curve: Entity, base: Entity, ends: [[f64; 2]; 2]) -> crate::brep::Edge {
    let [[x1, y1], [x2, y2]] = ends;
    let line = part(110, &format!("{x2},{y2},0,{x1},{y1},0"));
    let entities = vec![
        part(108, "0,0,1,0"),
        curve,
        base,
        line,
        part(102, "2,3,7"),
        part(142, "0,1,0,9,2"),
        top(144, "1,1,0,11"),
    ];
    let model = clean(&entities);
    assert_eq!(model.vertices.len(), 2, "the offset meets the line");
    model.edges.iter().next().expect("an edge").clone()
}

#[test]
fn offset_curves() {
    // To the left of a line along x, seen from above: N × T.
    let line = first_edge(
        part(130, "5,1,0,0,0,0.5,0,0,0,0,0,1,0,1"),
        part(110, "0,0,0,2,0,0"),
        [[0.0, 0.5], [2.0, 0.5]],
    );
    assert!(matches!(line.curve, Curve::Line { .. }));
    // The left of a counter-clockwise arc is its inside.
    for (normal, radius) in [("0,0,1", 1.5), ("0,0,-1", 2.5)] {
        let arc = first_edge(
            part(130, &format!("5,1,0,0,0,0.5,0,0,0,{normal},0,3.2")),
            part(100, "0,0,0,2,0,-2,0"),
            [[radius, 0.0], [-radius, 0.0]],
        );
        assert!(matches!(arc.curve, Curve::Circle { radius: found, .. } if (found - radius).abs() < 1e-12));
    }
    // A parabola y = x² as a spline, from −1 to 1.
    let parabola = "2,2,1,0,1,0,0,0,0,1,1,1,1,1,1,-1,1,0,0,-1,0,1,1,0,0,1,0,0,1";
    let root = 5.0_f64.sqrt();
    let end = [0.5 * -2.0 / root, 1.0 + 0.5 / root];
    let ends = [[-1.0 - end[0], end[1]], [1.0 + end[0], end[1]]];
    let edge = first_edge(part(130, "5,1,0,0,0,0.5,0,0,0,0,0,1,0,1"), part(126, parabola), ends);
    for i in 0..=20 {
        let x = f64::from(i) / 10.0 - 1.0;
        let slope = (1.0 + 4.0 * x * x).sqrt();
        let p = edge.curve.point(0.5 * (x + 1.0));
        assert!((p.x - (x - x / slope)).hypot(p.y - (x * x + 0.5 / slope)) < 1e-7, "{p} at {x}");
    }
    // A distance from 0 to 1 along a line.
    let wedge = first_edge(
        part(130, "5,2,0,0,2,0,0,1,1,0,0,1,0,1"),
        part(110, "0,0,0,2,0,0"),
        [[0.0, 0.0], [2.0, 1.0]],
    );
    assert!(
        wedge.curve.point(0.5 * (wedge.range[0] + wedge.range[1])).distance(glam::DVec3::new(1.0, 0.5, 0.0))
            < 1e-9
    );
    // An offset past the centre leaves nothing, and one that refers to itself is none.
    for (text, base) in
        [("5,1,0,0,0,3,0,0,0,0,0,1,0,4", "0,0,0,2,0,-2,0"), ("3,1,0,0,0,3,0,0,0,0,0,1,0,4", "0,0,0,2,0,-2,0")]
    {
        let mut entities = trimmed(part(108, "0,0,1,0"), vec![], vec![part(130, text), part(100, base)]);
        entities[3] = part(102, "1,3");
        assert_eq!(model(&entities).faces.len(), 0);
    }
}

#[test]
fn splines_that_are_cut_short() {
    let whole = "2,2,1,0,1,0,0,0,0,1,1,1,1,1,1,1,0,0,0,2,0,-1,0,0,0,1,0,0,1";
    // Without its range and its normal a spline is as good; without a coordinate it is not.
    let end = |count: usize| whole.split(',').take(count).collect::<Vec<_>>().join(",");
    assert_eq!(half_disc(part(126, &end(24))).faces.len(), 1);
    for count in [23, 20, 12, 5, 2] {
        let entities =
            trimmed(part(108, "0,0,1,0"), vec![], vec![part(110, "-1,0,0,1,0,0"), part(126, &end(count))]);
        assert_eq!(model(&entities).faces.len(), 0, "{count} parameters");
    }
}

#[test]
fn a_closed_spline_may_run_over_its_seam() {
    // Quadratic and periodic around a square, over [2, 6]; wanted from 3 on: all of it, and half of it across the seam.
    let spline = |first: f64, last: f64| {
        let points = "1,0,0,0,1,0,-1,0,0,0,-1,0,1,0,0,0,1,0";
        let numbers = format!("5,2,1,1,1,1,0,1,2,3,4,5,6,7,8,1,1,1,1,1,1,{points},{first},{last},0,0,1");
        part(126, &numbers)
    };
    let whole = |range: [f64; 2]| {
        let model = clean(&trimmed(part(108, "0,0,1,0"), vec![], vec![spline(range[0], range[1])]));
        trims(&model)
    };
    assert!((whole([3.0, 7.0]) - whole([2.0, 6.0])).abs() < 1e-9);
    // Halves from (½, −½) around to (−½, ½), closed by the line between them.
    let line = |ends: [f64; 4]| part(110, &format!("{},{},0,{},{},0", ends[0], ends[1], ends[2], ends[3]));
    let half = |curve: Entity, ends: [f64; 4]| {
        trims(&clean(&trimmed(part(108, "0,0,1,0"), vec![], vec![curve, line(ends)])))
    };
    let (a, b) = ([0.5, 0.5], [-0.5, -0.5]);
    let plain = half(spline(2.0, 4.0), [b[0], b[1], a[0], a[1]]);
    let across = half(spline(4.0, 6.0), [a[0], a[1], b[0], b[1]]);
    let over = half(spline(5.0, 7.0), [-0.5, 0.5, 0.5, -0.5]);
    assert!((plain - across).abs() < 1e-9 && (plain - over).abs() < 1e-9, "{plain} {across} {over}");
}

#[test]
fn copious_data_and_lines_of_all_forms() {
    let closing = part(110, "-1,0,0,1,0,0");
    for (kind, text) in [(1, "1,3,0,1,0,0,1,-1,0"), (2, "2,3,1,0,0,0,1,0,-1,0,0")] {
        for form in [kind, kind + 10] {
            let model = clean(&trimmed(
                part(108, "0,0,1,0"),
                vec![],
                vec![closing_copy(&closing), part(106, text).form(form)],
            ));
            assert!((trims(&model) - 2.0).abs() < 1e-9);
        }
    }
    let with_vectors = part(106, "3,3,1,0,0,0,0,1,0,1,0,0,0,1,-1,0,0,0,0,1").form(13);
    assert!((trims(&half_disc(with_vectors)) - 2.0).abs() < 1e-9);
    let closed = part(106, "1,4,0,0,0,2,0,2,2,0,2").form(63);
    assert!((trims(&clean(&trimmed(part(108, "0,0,1,0"), vec![], vec![closed]))) - 4.0).abs() < 1e-9);
    for form in [1, 2] {
        let mut lines = square();
        lines[2] = part(110, "2,2,0,0,2,0").form(form);
        assert!((trims(&clean(&trimmed(part(108, "0,0,1,0"), vec![], lines))) - 4.0).abs() < 1e-9);
    }
}

fn closing_copy(line: &Entity) -> Entity {
    Entity { parameters: line.parameters.clone(), ..part(110, "") }
}
