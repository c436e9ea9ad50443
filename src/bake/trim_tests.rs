//! The trim tree against an even-odd count over the original curves.

use super::region::{Rectangle, Region};
use super::trim_query::inside;
use super::trim_segments::Evaluation;
use super::trim_tree::{TrimTree, build};
use crate::geometry::{Bezier, Homogeneous, Homogeneous2, ParameterBox};
use crate::trimming::FaceTrim;
use glam::{DVec2, Vec2Swizzles};
use std::f64::consts::{FRAC_1_SQRT_2, TAU};

/// A linear congruential generator; numbers in 0..1.
pub(super) struct Random(pub u64);

impl Random {
    pub(super) fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }
}

pub(super) type Loop = Vec<Bezier<Homogeneous2>>;

pub(super) fn polygon(corners: &[DVec2]) -> Loop {
    let next = |i: usize| corners[(i + 1) % corners.len()];
    let line = |i: usize| Bezier { points: vec![corners[i].extend(1.0), next(i).extend(1.0)] };
    (0..corners.len()).map(line).collect()
}

pub(super) fn rectangle(low: DVec2, high: DVec2) -> Loop {
    polygon(&[low, DVec2::new(high.x, low.y), high, DVec2::new(low.x, high.y)])
}

pub(super) fn circle(center: DVec2, radius: f64) -> Loop {
    let axes = [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y];
    (0..4)
        .map(|i| {
            let (a, b) = (axes[i], axes[(i + 1) % 4]);
            let at = |p: DVec2, w: f64| -> Homogeneous2 { Homogeneous::new(center + p * radius, w) };
            Bezier { points: vec![at(a, 1.0), at(a + b, FRAC_1_SQRT_2), at(b, 1.0)] }
        })
        .collect()
}

pub(super) fn star(center: DVec2, radius: f64, corners: usize, random: &mut Random) -> Loop {
    let corner = |i: usize, r: f64| center + DVec2::from_angle(TAU * i as f64 / corners as f64) * r;
    polygon(&(0..corners).map(|i| corner(i, radius * (0.3 + 0.7 * random.next()))).collect::<Vec<_>>())
}

/// A polygon whose corners lie on eighths of the window, or off them by a rounding.
pub(super) fn beside_planes(random: &mut Random) -> Loop {
    let p = DVec2::new;
    let mut nearly = || {
        let eighth = ((random.next() * 9.0).floor() / 8.0) as f32;
        let off = ((random.next() * 5.0).floor() - 2.0) as f32 * f32::EPSILON * 0.25;
        f64::from((eighth + off).clamp(0.0, 1.0))
    };
    let mut corners: Vec<DVec2> = (0..12).map(|_| p(nearly(), nearly())).collect();
    corners.extend([p(0.0, 0.0), p(1.0, 1.0)]);
    polygon(&corners)
}

pub(super) fn trim(loops: Vec<Loop>) -> FaceTrim {
    let curves: Vec<_> = loops.into_iter().flatten().collect();
    let points = || curves.iter().flat_map(|c| &c.points).map(|p| p.point());
    let window = ParameterBox {
        min: points().fold(DVec2::INFINITY, DVec2::min),
        max: points().fold(DVec2::NEG_INFINITY, DVec2::max),
    };
    FaceTrim { curves, ..FaceTrim::whole(window) }
}

/// Even-odd count of a ray to −u over finely sampled curves, and the distance from the nearest curve; normalised.
fn reference(trim: &FaceTrim, point: DVec2) -> (bool, f64) {
    let size = trim.window.max - trim.window.min;
    let mut state = false;
    let mut nearest = f64::INFINITY;
    for curve in &trim.curves {
        let steps = if curve.points.len() == 2 { 1 } else { 1024 };
        let at = |i: usize| (curve.eval(i as f64 / steps as f64).point() - trim.window.min) / size;
        for i in 0..steps {
            let (a, b) = (at(i), at(i + 1));
            let along = ((point - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
            nearest = nearest.min(point.distance(a + (b - a) * along));
            if (a.y <= point.y) != (b.y <= point.y) {
                state ^= a.x + (point.y - a.y) / (b.y - a.y) * (b.x - a.x) < point.x;
            }
        }
    }
    (state, nearest)
}

fn tree_of(trim: &FaceTrim) -> (Region, TrimTree) {
    let region = Region::new(trim).expect("a valid region");
    let tree = build(&region, Evaluation::Curves).expect("a tree");
    (region, tree)
}

/// Compares on random points, and on points that share coordinates with vertices and planes.
fn check(name: &str, loops: Vec<Loop>, points: usize) {
    let trim = trim(loops);
    let (_, tree) = tree_of(&trim);
    let mut random = Random(42);
    let mut compared = 0;
    for i in 0..points {
        let mut point = [random.next() as f32, random.next() as f32];
        if i % 3 == 1 {
            point = point.map(|x| (x * 64.0).round() / 64.0);
        }
        if i % 3 == 2 && !tree.segments.is_empty() {
            let segment = tree.segments[i % tree.segments.len()];
            point[i / 3 % 2] = if i % 2 == 0 { segment.low } else { segment.high }[i / 3 % 2];
        }
        // Walks end below the top edge.
        point[1] = point[1].min(1.0 - f32::EPSILON);
        let at = DVec2::new(f64::from(point[0]), f64::from(point[1]));
        let (expected, distance) = reference(&trim, at);
        if distance > 1e-6 {
            compared += 1;
            assert_eq!(inside(&tree, point), expected, "{name}: {point:?}, {distance:e} from a curve");
        }
    }
    assert!(compared * 4 > points, "{name}: {compared} of {points}");
}

/// A side whose ends differ by roundings: clipping moves its vertices onto the window's border.
#[test]
fn almost_flat_sides() {
    let heights = [5.6e-16, 0.0, 2.2e-16, 6.7e-16, 5.6e-16];
    let bottom = heights.iter().enumerate().map(|(i, y)| DVec2::new(0.25 * i as f64, *y));
    // Teeth on the other side, so that the tree has reasons to split.
    let teeth =
        (0..40).rev().map(|i| DVec2::new(f64::from(i) / 39.0, if i / 2 % 2 == 0 { 1.0 } else { 0.6 }));
    let corners: Vec<DVec2> = bottom.chain(teeth).collect();
    check("comb", vec![polygon(&corners)], 3000);
    let turned: Vec<DVec2> = corners.iter().map(|p| p.yx()).collect();
    check("turned comb", vec![polygon(&turned)], 3000);
}

#[test]
fn circles_and_holes() {
    check("circle", vec![circle(DVec2::new(3.0, 4.0), 2.5)], 1500);
    check("ring", vec![circle(DVec2::ZERO, 1.0), circle(DVec2::new(0.1, 0.0), 0.7)], 1500);
    let nested = (0..7).map(|i| circle(DVec2::splat(0.01 * f64::from(i)), 1.0 - 0.13 * f64::from(i)));
    check("nested", nested.collect(), 600);
}

#[test]
fn axis_parallel_edges() {
    let unit = rectangle(DVec2::ZERO, DVec2::ONE);
    let trimmed = trim(vec![unit.clone()]);
    assert_eq!(tree_of(&trimmed).1.uniform(), Some(true), "a rectangle is its window");
    let hole = |a: f64, b: f64| rectangle(DVec2::splat(a), DVec2::splat(b));
    check("holes on planes", vec![unit.clone(), hole(0.25, 0.5), hole(0.5, 0.75)], 3000);
    check("hole at a corner", vec![unit.clone(), hole(0.0, 0.5)], 3000);
    check("holes off planes", vec![unit, hole(0.1, 0.3), hole(0.31, 0.9)], 3000);
    let p = |x: f64, y: f64| DVec2::new(x, y);
    // Sides that are off the axes by the last bit: cells clip pieces of them onto the axes.
    let holes =
        || (0..4).flat_map(|i| (0..4).map(move |j| DVec2::new(f64::from(i), f64::from(j)) * 0.23 + 0.05));
    for turn in 0..4 {
        let bits = f64::EPSILON * DVec2::from([[1.0, 1.0], [2.0, 1.0], [1.0, 3.0], [0.7, 0.4]][turn]);
        let outline = polygon(&[p(bits.x, 0.0), p(1.0, bits.y), p(1.0 - bits.x, 1.0), p(0.0, 1.0 - bits.y)]);
        let holes = holes().map(|low| rectangle(low, low + 0.2));
        check("a rectangle turned by rounding", std::iter::once(outline).chain(holes).collect(), 3000);
    }
    let stairs = polygon(&[
        p(0.0, 0.0),
        p(1.0, 0.0),
        p(1.0, 0.25),
        p(0.75, 0.25),
        p(0.75, 0.5),
        p(0.5, 0.5),
        p(0.5, 0.75),
        p(0.25, 0.75),
        p(0.25, 1.0),
        p(0.0, 1.0),
    ]);
    check("stairs", vec![stairs.clone()], 3000);
    let flipped = stairs.iter().map(|line| Bezier {
        points: line.points.iter().map(|q| p(1.0 - q.x, 1.0 - q.y).extend(1.0)).collect(),
    });
    check("stairs, turned", vec![flipped.collect()], 3000);
    let comb: Vec<DVec2> = (0..40)
        .flat_map(|i| {
            let x = f64::from(i) / 40.0;
            let y = if i % 2 == 0 { 1.0 } else { 0.5 };
            [p(x, y), p(x + 1.0 / 40.0, y)]
        })
        .chain([p(1.0, 0.0), p(0.0, 0.0)])
        .collect();
    check("comb", vec![polygon(&comb)], 3000);
}

#[test]
fn many_vertices() {
    let mut random = Random(7);
    check("hexagon", vec![star(DVec2::ZERO, 1.0, 6, &mut random)], 3000);
    check("star of 200", vec![star(DVec2::ZERO, 1.0, 200, &mut random)], 2000);
    check("star of 2000", vec![star(DVec2::ZERO, 1.0, 2000, &mut random)], 600);
    let mut swarm = vec![rectangle(DVec2::ZERO, DVec2::splat(12.0))];
    for i in 0..100 {
        let center = DVec2::new(f64::from(i % 10) + 1.5, f64::from(i / 10) + 1.5);
        swarm.push(if i % 2 == 0 { circle(center, 0.45) } else { star(center, 0.45, 9, &mut random) });
    }
    check("hundred holes", swarm, 300);
}

#[test]
fn slivers_and_crossings() {
    let p = |x: f64, y: f64| DVec2::new(x, y);
    let diagonal = polygon(&[p(0.0, 0.0), p(1.0, 1.0), p(1.0, 1.0001), p(0.0, 1e-4)]);
    check("sliver", vec![diagonal], 3000);
    let needle = polygon(&[p(0.0, 0.3), p(1.0, 0.300_001), p(1.0, 0.5), p(0.5, 0.300_03), p(0.0, 1.0)]);
    check("needle", vec![needle], 3000);
    check("bow tie", vec![polygon(&[p(0.0, 0.0), p(1.0, 1.0), p(1.0, 0.0), p(0.0, 1.0)])], 3000);
    check("overlapping circles", vec![circle(p(0.0, 0.0), 1.0), circle(p(1.0, 0.0), 1.0)], 1500);
    check("touching circles", vec![circle(p(0.0, 0.0), 1.0), circle(p(2.0, 0.0), 1.0)], 1500);
}

#[test]
fn corners_beside_planes_by_a_rounding() {
    let p = |x: f64, y: f64| DVec2::new(x, y);
    // The bottom edge is so nearly level that clipping it rounds onto the window's border.
    let tilt = f64::EPSILON;
    check("tilted", vec![polygon(&[p(0.0, tilt), p(0.9, 0.0), p(1.0, 0.5), p(0.9, 1.0), p(0.0, 1.0)])], 3000);
    let mut random = Random(11);
    for _ in 0..100 {
        check("near planes", vec![beside_planes(&mut random)], 150);
    }
}

#[test]
fn curves_beyond_single_precision_are_refused() {
    for point in [DVec2::new(0.5, 2.0).extend(1e-60), DVec2::new(1e60, 2.0).extend(1.0)] {
        let mut trimmed = trim(vec![circle(DVec2::ZERO, 1.0)]);
        trimmed.curves[0].points[1] = point;
        Region::new(&trimmed).expect_err("no such numbers in f32");
    }
}

#[test]
fn open_chains_are_closed_by_links() {
    let p = |x: f64, y: f64| DVec2::new(x, y);
    let mut open = polygon(&[p(0.0, 0.0), p(1.0, 0.1), p(0.9, 1.0), p(0.1, 0.8)]);
    let closed = open.clone();
    open.pop();
    let (with_gap, whole) = (tree_of(&trim(vec![open])).1, tree_of(&trim(vec![closed])).1);
    let mut random = Random(3);
    for _ in 0..2000 {
        let point = [random.next() as f32, random.next() as f32];
        assert_eq!(inside(&with_gap, point), inside(&whole, point));
    }
}

#[test]
fn trees_stay_small() {
    let round: Vec<DVec2> = (0..2000)
        .map(|i| DVec2::from_angle(TAU * f64::from(i) / 2000.0) * (1.0 + 0.01 * f64::from(i % 2)))
        .collect();
    let (region, tree) = tree_of(&trim(vec![polygon(&round)]));
    assert!(tree.segments.len() < 8 * region.pieces.len(), "{} segments", tree.segments.len());
    assert!(tree.words.len() < 16 * region.pieces.len(), "{} words", tree.words.len());
    let (_, ring) = tree_of(&trim(vec![circle(DVec2::ZERO, 1.0), circle(DVec2::ZERO, 0.5)]));
    assert!(ring.words.len() < 600, "{} words", ring.words.len());
}

#[test]
fn rectangles_that_touch_no_piece_have_one_state() {
    let mut random = Random(5);
    let trimmed = trim(vec![
        circle(DVec2::ZERO, 1.0),
        star(DVec2::ZERO, 0.6, 30, &mut random),
        rectangle(DVec2::new(-0.1, 0.65), DVec2::new(0.1, 0.8)),
    ]);
    let (region, tree) = tree_of(&trimmed);
    let mut untouched = 0;
    for _ in 0..3000 {
        let low = [random.next() as f32 * 0.95, random.next() as f32 * 0.95];
        let size = [random.next() as f32 * 0.05, random.next() as f32 * 0.05];
        let area = Rectangle { low, high: [low[0] + size[0], low[1] + size[1]] };
        if region.pieces.iter().any(|piece| region.touches(piece, &area)) {
            continue;
        }
        untouched += 1;
        let at = |x: f64, y: f64| [low[0] + size[0] * x as f32, low[1] + size[1] * y as f32];
        let state = inside(&tree, at(0.5, 0.5));
        for _ in 0..40 {
            assert_eq!(inside(&tree, at(random.next(), random.next())), state, "{area:?}");
        }
    }
    assert!(untouched > 1000, "{untouched}");
}
