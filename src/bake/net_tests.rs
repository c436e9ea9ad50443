//! Leaves against direct evaluation: slabs hold the surface, bounds hold the derivatives, leaves cover the net, trims delete the rest.

use super::faces::PartSpace;
use super::nets::{Nets, bake_nets};
use super::outline::Outline;
use super::region::Region;
use super::trim_segments::Evaluation;
use super::trim_tests::{Random, circle};
use super::trim_tree;
use crate::geometry::{Bezier, BsplineSurface, Homogeneous, Homogeneous2, ParameterBox};
use crate::numeric::Aabb;
use crate::scene::{NetLeaf, TRIM_INSIDE, bend_bound};
use crate::trimming::FaceTrim;
use glam::{DVec2, DVec3, DVec4};

/// Clamped, uniform inner knots.
fn surface(
    degrees: [usize; 2],
    counts: [usize; 2],
    point: impl FnMut(usize, usize) -> DVec4,
) -> BsplineSurface {
    let knots = [0, 1].map(|k| {
        let (p, n) = (degrees[k], counts[k]);
        (0..n + p + 1).map(|i| i.clamp(p, n) as f64 - p as f64).collect::<Vec<_>>()
    });
    let mut point = point;
    let points =
        (0..counts[0]).flat_map(|i| (0..counts[1]).map(move |j| (i, j))).map(|(i, j)| point(i, j)).collect();
    BsplineSurface::new(degrees, knots, points).expect("valid knots")
}

fn wavy(degree: usize, count: usize, weight_spread: f64) -> BsplineSurface {
    let mut random = Random(17);
    surface([degree; 2], [count; 2], |i, j| {
        let weight = 1.0 + weight_spread * random.next();
        let height = 2.0 * (random.next() - 0.5);
        Homogeneous::new(DVec3::new(i as f64 + 100.0, j as f64 - 50.0, height), weight)
    })
}

/// An octant of a sphere of radius 5: two quarter arcs, a pole along v = 1.
fn octant() -> BsplineSurface {
    let arc = [(1.0, 0.0, 1.0), (1.0, 1.0, 0.5f64.sqrt()), (0.0, 1.0, 1.0)];
    surface([2, 2], [3, 3], |i, j| {
        let (c, s, w) = arc[i];
        let (r, z, w2) = arc[j];
        Homogeneous::new(DVec3::new(r * c, r * s, z) * 5.0, w * w2)
    })
}

fn baked(surface: &BsplineSurface, curves: Vec<Bezier<Homogeneous2>>) -> (Nets, DVec3, Outline) {
    let window = surface.domain();
    let trim = FaceTrim { curves, ..FaceTrim::whole(window) };
    let region = Region::new(&trim).expect("a valid region");
    let tree = trim_tree::build(&region, Evaluation::Curves).expect("a tree");
    let bounds = Aabb::around(surface.points.iter().map(|p| p.point()));
    let outline = Outline {
        window,
        region,
        bounds,
        edges: vec![],
        size: bounds.diagonal(),
        repairs: vec![],
        losses: vec![],
    };
    let space = PartSpace { center: DVec3::ZERO, grid_step: 2f64.powi(-10), large_leaf: f64::INFINITY };
    let (origin, nets) =
        bake_nets(surface, DVec2::ZERO, &outline, &tree, &space, 0.125, 4096).expect("baked");
    (nets, origin, outline)
}

/// Least corner and size of a leaf in its net.
fn domain(leaf: &NetLeaf) -> [DVec2; 2] {
    let axis = |bits: u32| {
        let size = 0.5f64.powi((bits >> 12 & 15) as i32);
        (f64::from(bits & 0xfff) * size, size)
    };
    let ((u, du), (v, dv)) = (axis(leaf.domain), axis(leaf.domain >> 16));
    [DVec2::new(u, v), DVec2::new(du, dv)]
}

fn vector(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

/// Checks slabs, boxes and certificates of all leaves by samples; returns how many leaves have a certificate.
fn check_leaves(surface: &BsplineSurface, nets: &Nets, origin: DVec3, window: ParameterBox) -> usize {
    let size = window.max - window.min;
    let mut certified = 0;
    for (leaf, bounds) in nets.leaves.iter().zip(&nets.boxes) {
        let net = nets.nets[leaf.net as usize];
        let net_low = DVec2::from_array(net.uv_low.map(f64::from));
        let net_size = DVec2::from_array(net.uv_size.map(f64::from));
        let [low, extent] = domain(leaf);
        let (a, b) = (vector(leaf.tangent_u), vector(leaf.tangent_v));
        let n = a.cross(b).normalize();
        let dual = glam::DMat3::from_cols(a, b, n).inverse();
        assert!(dual.is_finite());
        let shortest = a.length().min(b.length());
        let mut worst = [[0.0f64; 2]; 3];
        let mut second = [0.0f64; 3];
        for s in 0..=6 {
            for t in 0..=6 {
                // Just inside: at a knot the next span's derivatives may differ.
                let share = DVec2::new(f64::from(s), f64::from(t)) * (1.0 / 6.0 - 1e-6) + 3e-6;
                let local = low + extent * share;
                let uv = window.min + (net_low + local * net_size) * size;
                let d = surface.derivatives(uv.clamp(window.min, window.max));
                let p = d.point - origin;
                assert!((d.point.cmpge(bounds.min - 1e-6) & d.point.cmple(bounds.max + 1e-6)).all());
                let local = dual * (p - vector(leaf.center));
                assert!(local.x.abs() <= 0.5 + f64::from(leaf.extent_u), "{local} {leaf:?}");
                assert!(local.y.abs() <= 0.5 + f64::from(leaf.extent_v), "{local} {leaf:?}");
                assert!(local.z.abs() <= f64::from(leaf.extent_n), "{local} {leaf:?}");
                let scale = extent * net_size * size;
                let (ds, dt) = (dual * (d.du * scale.x), dual * (d.dv * scale.y));
                for k in 0..3 {
                    let target = [f64::from(k == 0), f64::from(k == 1)];
                    worst[k][0] = worst[k][0].max((ds[k] - target[0]).abs());
                    worst[k][1] = worst[k][1].max((dt[k] - target[1]).abs());
                }
                second[0] = second[0].max(d.duu.length() * scale.x * scale.x);
                second[1] = second[1].max(d.duv.length() * scale.x * scale.y);
                second[2] = second[2].max(d.dvv.length() * scale.y * scale.y);
            }
        }
        let byte = |k: u32| leaf.certificate >> (8 * k) & 255;
        let bound = |k: u32| if byte(k) == 255 { f64::INFINITY } else { f64::from(byte(k)) / 64.0 };
        assert!(bound(0) >= worst[0][0] + worst[0][1] && bound(1) >= worst[1][0] + worst[1][1]);
        assert!(bound(2) >= (worst[2][0] + worst[2][1]) / shortest);
        let bend = f64::from(bend_bound(byte(3)));
        assert!(byte(3) == 255 || bend >= (second[0] + 2.0 * second[1] + second[2]) / shortest);
        certified += usize::from((0..3).all(|k| byte(k) != 255) && bound(0) < 1.0 && bound(1) < 1.0);
    }
    certified
}

/// A bent tube, closed within one span of degree 6.
fn tube() -> BsplineSurface {
    surface([6, 3], [7, 4], |i, j| {
        let (sine, cosine) = (std::f64::consts::TAU * i as f64 / 6.0).sin_cos();
        let bend = (j * j) as f64;
        DVec3::new(3.0 * cosine + bend, 3.0 * sine, 6.0 * j as f64).extend(1.0)
    })
}

/// The area of all leaves of each net, in the net's own units.
fn covered(nets: &Nets) -> Vec<f64> {
    let mut area = vec![0.0; nets.nets.len()];
    for leaf in &nets.leaves {
        area[leaf.net as usize] += domain(leaf)[1].element_product();
    }
    area
}

#[test]
fn slabs_hold_the_surface_and_leaves_cover_it() {
    let surfaces = [
        ("bicubic", wavy(3, 6, 0.0), 0.9),
        ("rational bicubic", wavy(3, 6, 2.0), 0.5),
        ("bilinear", wavy(1, 4, 0.0), 0.9),
        ("degree 7", wavy(7, 9, 0.0), 0.9),
        ("sphere octant", octant(), 0.5),
        ("tube", tube(), 0.9),
    ];
    for (name, surface, least_certified) in surfaces {
        let (nets, origin, outline) = baked(&surface, vec![]);
        assert!(!nets.is_mixed, "{name}");
        assert!(nets.leaves.iter().all(|leaf| leaf.trim == TRIM_INSIDE), "{name}");
        assert!(covered(&nets).iter().all(|&area| area == 1.0), "{name}: {:?}", covered(&nets));
        let certified = check_leaves(&surface, &nets, origin, outline.window);
        let share = certified as f64 / nets.leaves.len() as f64;
        eprintln!("{name}: {} nets, {} leaves, {share:.2} certified", nets.nets.len(), nets.leaves.len());
        assert!(share >= least_certified, "{name}: {certified} of {}", nets.leaves.len());
        assert!(nets.leaves.len() <= 150 * nets.nets.len(), "{name}: {}", nets.leaves.len());
    }
}

#[test]
fn trims_delete_and_mark_leaves() {
    let surface = wavy(3, 7, 0.0);
    let size = surface.domain().max;
    let (center, radius) = (size * 0.5, size.x * 0.3);
    // The window stays the whole domain: the circle is well inside it.
    let (nets, origin, outline) = baked(&surface, circle(center, radius));
    check_leaves(&surface, &nets, origin, outline.window);
    assert!(nets.is_mixed);
    let mut area = 0.0;
    for leaf in &nets.leaves {
        let net = nets.nets[leaf.net as usize];
        let net_low = DVec2::from_array(net.uv_low.map(f64::from));
        let net_size = DVec2::from_array(net.uv_size.map(f64::from));
        let [low, extent] = domain(leaf);
        for (s, t) in [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0), (1.0, 1.0), (0.5, 0.5)] {
            let uv = (net_low + (low + extent * DVec2::new(s, t)) * net_size) * size;
            if leaf.trim == TRIM_INSIDE {
                assert!(uv.distance(center) <= radius * 1.000_01);
            }
        }
        area += (extent * net_size * size).element_product();
    }
    let disc = std::f64::consts::PI * radius * radius;
    assert!(area > disc && area < 2.5 * disc, "{area} {disc}");
}

#[test]
fn degenerate_surfaces_do_not_fail() {
    let flat = surface([2, 2], [3, 3], |i, _| DVec3::new(i as f64, 0.0, 0.0).extend(1.0));
    let point = surface([1, 1], [2, 2], |_, _| DVec4::ONE);
    let folded = surface([3, 3], [4, 4], |i, j| DVec3::new((i % 2) as f64, (j % 2) as f64, 0.0).extend(1.0));
    let heavy = surface([3, 3], [4, 4], |i, j| {
        Homogeneous::new(DVec3::new(i as f64, j as f64, 0.0), if i == 1 { 1e6 } else { 1e-6 })
    });
    // Tangents that are parallel but for roundings.
    let line = surface([1, 1], [2, 2], |i, j| DVec4::new([[0.0, 0.7], [3.1, 7.3]][i][j], 0.0, 0.0, 1.0));
    for (index, surface) in [flat, point, folded, heavy, line].iter().enumerate() {
        let (nets, origin, outline) = baked(surface, vec![]);
        assert!(nets.leaves.len() <= 4096);
        eprintln!("{index}: {} leaves", nets.leaves.len());
        let finite = |v: &[f32]| v.iter().all(|x| x.is_finite());
        for leaf in &nets.leaves {
            assert!(finite(&leaf.center) && finite(&leaf.tangent_u) && finite(&leaf.tangent_v));
            assert!(finite(&[leaf.extent_n, leaf.extent_u, leaf.extent_v]));
        }
        check_leaves(surface, &nets, origin, outline.window);
    }
}

#[test]
fn a_net_that_closes_in_one_span_is_split_around() {
    // A tube of revolution whose circle is one span of degree 6: the mean tangent around it vanishes.
    let circle: Vec<glam::DVec2> =
        (0..=6).map(|i| glam::DVec2::from_angle(std::f64::consts::TAU * f64::from(i) / 6.0) * 10.0).collect();
    let points =
        [0.0, 3.0].iter().flat_map(|&z| circle.iter().map(move |c| c.extend(z).extend(1.0))).collect();
    let patch = crate::geometry::BezierPatch { degrees: [1, 6], points };
    assert_eq!(super::slab::fit(&patch).split_axis, 1);
}

/// A cone as one net, its apex along v = 1 (or a ring of a thousandth there): nearly flat leaves, and yet only those of the last eighth reach the apex.
#[test]
fn leaves_are_short_where_a_net_tapers() {
    for tip in [0.0, 1e-3] {
        let arc = [(1.0, 0.0, 1.0), (1.0, 0.3, 0.96), (0.83, 0.55, 1.0)];
        let cone = surface([2, 1], [3, 2], |i, j| {
            let (c, s, w) = arc[i];
            let radius = [1.0, tip][j];
            Homogeneous::new(DVec3::new(radius * c, radius * s, 2.0 * j as f64), w)
        });
        let (nets, origin, outline) = baked(&cone, Vec::new());
        check_leaves(&cone, &nets, origin, outline.window);
        let at_tip = nets.leaves.iter().filter(|leaf| {
            let (low, level) = (leaf.domain >> 16 & 0xfff, leaf.domain >> 28);
            low + 1 == 1 << level
        });
        assert!(at_tip.clone().count() > 0 && at_tip.clone().all(|leaf| leaf.domain >> 28 == 3), "{tip}");
    }
}

#[test]
fn an_arc_of_nearly_half_a_turn_is_split_along_itself() {
    // Fillets have such sides: weights are 1 at both ends of the arc and near 0 in its middle, a little different from section to section.
    let surface = surface([3, 2], [4, 3], |i, j| {
        let half_angle = (85.0 - 0.1 * i as f64).to_radians();
        let section = DVec3::X * i as f64;
        match j {
            1 => Homogeneous::new(section + DVec3::Z / half_angle.cos(), half_angle.cos()),
            end => {
                let side = if end == 0 { -1.0 } else { 1.0 };
                Homogeneous::new(section + DVec3::new(0.0, side * half_angle.sin(), half_angle.cos()), 1.0)
            }
        }
    });
    let (nets, origin, outline) = baked(&surface, vec![]);
    assert!(nets.leaves.len() <= 64, "{} leaves", nets.leaves.len());
    check_leaves(&surface, &nets, origin, outline.window);
}
