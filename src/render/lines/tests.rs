//! Lines against what they are known to be: areas, counts, lengths.

use super::steps::{Step, steps};
use super::stroke::{Mask, Near};
use super::visibility::visible;
use super::*;
use crate::bake::{BakeOptions, bake};
use crate::brep::{Body, BodyKind, Model, Part, primitive};
use crate::geometry::Frame;
use crate::image::Window;
use crate::render::cpu::{self, Precision};
use crate::render::{RenderOptions, Viewpoint};
use crate::scene::{EdgeKind, SceneBuffers};
use glam::DVec3;
use std::convert::Infallible;

const SIZE: [u32; 2] = [300, 200];

fn solid(make: impl Fn(&mut Model) -> Vec<crate::brep::Id<crate::brep::Face>>) -> SceneBuffers {
    let mut model = Model::default();
    let faces = make(&mut model);
    let body = Body { kind: BodyKind::Solid, faces, name: String::new(), entity: 1 };
    let part = Part { name: "part".into(), bodies: vec![body], children: vec![], entity: 2 };
    let part = model.parts.push(part);
    model.roots.push(part);
    bake(&model, &BakeOptions { edges: true, ..BakeOptions::default() }, &|_, _| {})
}

fn block() -> SceneBuffers {
    solid(|model| primitive::block(model, &Frame::IDENTITY, DVec3::new(3.0, 2.0, 1.0), 1).expect("a block"))
}

fn cylinder() -> SceneBuffers {
    solid(|model| primitive::frustum(model, &Frame::IDENTITY, [1.0; 2], 3.0, 1).expect("a cylinder"))
}

fn options(edges: EdgeChoice) -> LineOptions {
    LineOptions { edges, contours: true, hidden: HiddenLines::Off, width: 1.5 }
}

fn first_hits(scene: &Scene<'_>, rays: &[Ray]) -> Result<Vec<Vec<Hit>>, Infallible> {
    Ok(cpu::probe(scene, rays, Precision::F32, true))
}

/// The image's length of the steps that are visible, and of all.
fn lengths(scene: &Scene<'_>, camera: &Camera, edges: EdgeChoice) -> [f64; 2] {
    let screen = Screen::of_film(camera, &Film::new(SIZE[0] as usize, SIZE[1] as usize));
    let steps = steps(scene, &screen, &options(edges));
    let visible =
        visible(scene, &screen, &steps, &mut |rays| first_hits(scene, rays)).expect("no device fails");
    let length = |step: &Step| step.ends[0].distance(step.ends[1]);
    let seen = steps.iter().zip(visible).filter(|(_, seen)| *seen).map(|(step, _)| length(step)).sum();
    [seen, steps.iter().map(length).sum()]
}

fn camera(scene: &Scene<'_>, orthographic: bool) -> Camera {
    let view = Viewpoint { orthographic, ..Viewpoint::default() };
    Camera::framing(&view, scene, f64::from(SIZE[0]) / f64::from(SIZE[1]))
}

#[test]
fn nine_of_the_twelve_edges_of_a_block_are_seen() {
    let buffers = block();
    for orthographic in [false, true] {
        let camera = camera(&buffers.scene(), orthographic);
        let mut seen = 0;
        for piece in &buffers.edge_pieces {
            let alone = [*piece];
            let scene = Scene { edge_pieces: &alone, ..buffers.scene() };
            let [visible, all] = lengths(&scene, &camera, EdgeChoice::Feature);
            assert!(all > 10.0 && (visible < 0.02 * all || visible > 0.98 * all), "{visible} of {all}");
            seen += u32::from(visible > 0.5 * all);
        }
        assert_eq!((buffers.edge_pieces.len(), seen), (12, 9));
    }
}

#[test]
fn a_cylinder_shows_two_circles_and_two_silhouettes_and_no_seam() {
    let buffers = cylinder();
    let scene = buffers.scene();
    let count = |kind: EdgeKind| buffers.edge_pieces.iter().filter(|piece| piece.kind == kind as u32).count();
    assert_eq!((count(EdgeKind::Sharp), count(EdgeKind::Seam)), (8, 0), "two circles of four arcs");

    // From the side and a little above: the whole of one circle, half of the other.
    let view =
        Viewpoint { direction: Some(DVec3::new(1.0, 0.0, -0.5)), orthographic: true, ..Viewpoint::default() };
    let camera = Camera::framing(&view, &scene, f64::from(SIZE[0]) / f64::from(SIZE[1]));
    let [seen, all] = lengths(&scene, &camera, EdgeChoice::Feature);
    assert!((seen / all - 0.75).abs() < 0.02, "{seen} of {all}");

    let render = RenderOptions { resolution: SIZE, samples: 1, ..RenderOptions::default() };
    let film = cpu::render(&scene, &camera, &render, &|_, _| {});
    let screen = Screen::of_film(&camera, &film);
    let near = |edges| {
        let mut near = Near::new(film.window());
        let steps = steps(&scene, &screen, &options(edges));
        let seen =
            visible(&scene, &screen, &steps, &mut |rays| first_hits(&scene, rays)).expect("no device fails");
        steps.iter().zip(seen).filter(|(_, seen)| *seen).for_each(|(step, _)| near.add(step.ends));
        near
    };
    let contours = |edges| -> f64 {
        let lines = contour::contours(&screen, &film, &near(edges), &mut |rays| first_hits(&scene, rays));
        lines.expect("no device fails").iter().map(|[a, b]| a.distance(*b)).sum()
    };
    let height = [0.0, 3.0].map(|z| screen.project(DVec3::new(0.0, 1.0, z)).expect("before the eye"));
    let silhouettes = 2.0 * height[0].distance(height[1]);
    let drawn = contours(EdgeChoice::Feature);
    assert!((drawn / silhouettes - 1.0).abs() < 0.04, "{drawn} for {silhouettes}");
    // Without edges the outline is contours alone: one and a half circles' worth of silhouette less the front half of the upper one.
    assert!(contours(EdgeChoice::None) > 1.5 * drawn);
}

/// Where the plane of a flank seen edge on meets what is behind the tooth, neither looks far from the other.
#[test]
fn the_contour_of_a_tooth_has_no_gaps() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/gear/model.step");
    let model = crate::import::import(&path).expect("a fixture");
    let buffers = bake(&model, &BakeOptions::default(), &|_, _| {});
    let scene = buffers.scene();
    let camera = Camera::framing(&Viewpoint::default(), &scene, 1000.0 / 600.0);
    let [left, top, width, height] = [590, 220, 20, 200];
    let window = Some(Window { left, top, width, height });
    let render = RenderOptions { resolution: [1000, 600], samples: 1, window, ..RenderOptions::default() };
    let film = cpu::render(&scene, &camera, &render, &|_, _| {});
    let options = options(EdgeChoice::None);
    let lines = line_coverage(&scene, &camera, &options, &Section::default(), &film, &mut |rays| {
        first_hits(&scene, rays)
    });
    let lines = lines.expect("no device fails");
    for (row, lines) in lines.chunks_exact(width).enumerate().skip(2).take(height - 4) {
        assert!(lines.iter().sum::<f32>() > 1.2, "row {}: {lines:?}", top + row);
    }
}

#[test]
fn a_straight_line_covers_its_area() {
    let [width, height] = [200, 120];
    for line_width in [0.3, 0.7, 1.0, 1.5, 4.0] {
        for ends in [[10.3, 20.7, 180.1, 20.7], [10.0, 5.0, 150.0, 110.0], [33.3, 4.0, 41.0, 101.0]] {
            let [a, b] = [DVec2::new(ends[0], ends[1]), DVec2::new(ends[2], ends[3])];
            let mut mask = Mask::new(Window::whole(width, height));
            // As edges are: in steps of half a pixel, which share their ends.
            let count = (a.distance(b) / 0.5).ceil() as usize;
            let at = |i: usize| a.lerp(b, i as f64 / count as f64);
            (0..count).for_each(|i| mask.add([at(i), at(i + 1)], line_width));
            let area: f64 = mask.into_coverage().iter().map(|&c| f64::from(c)).sum();
            let length = a.distance(b);
            // Round ends reach up to half the width and half a pixel farther.
            let ends = line_width * (line_width + 1.0);
            let exact = line_width * length;
            assert!(
                (area - exact) > -0.01 * exact && area - exact < ends + 0.01 * exact,
                "{area} for {exact}"
            );
        }
    }
}

#[test]
fn lines_do_not_depend_on_threads_and_hidden_ones_are_fainter() {
    let buffers = block();
    let scene = buffers.scene();
    let camera = camera(&scene, false);
    let render = RenderOptions { resolution: SIZE, samples: 1, ..RenderOptions::default() };
    let film = cpu::render(&scene, &camera, &render, &|_, _| {});
    let draw = |hidden, threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads");
        let options = LineOptions { hidden, ..options(EdgeChoice::Feature) };
        pool.install(|| {
            line_coverage(&scene, &camera, &options, &Section::default(), &film, &mut |rays| {
                first_hits(&scene, rays)
            })
        })
        .expect("no device fails")
    };
    let sum = |lines: &[f32]| -> f64 { lines.iter().map(|&c| f64::from(c)).sum() };
    let [off, dim, dashed] =
        [HiddenLines::Off, HiddenLines::Dim, HiddenLines::Dashed].map(|look| draw(look, 1));
    assert_eq!(dim, draw(HiddenLines::Dim, 3));
    let hidden = [sum(&dim) - sum(&off), sum(&dashed) - sum(&off)];
    assert!(hidden.iter().all(|&more| more > 0.02 * sum(&off) && more < 0.3 * sum(&off)), "{hidden:?}");
}
