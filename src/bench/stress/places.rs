//! Places, scales and coincidences: far from the origin, large beside small, from afar, exactly through features.

use super::aim::Aim;
use super::change::moved;
use super::draft::{Draft, analytic_solids, egg, egg_solid, frame_at, iso_points};
use super::{Case, Stress};
use crate::bench::edge_points;
use crate::brep::{Child, Model, Part, primitive};
use crate::geometry::{Frame, Surface};
use glam::{DAffine3, DVec3};

/// Millimetres from the origin.
const FAR_OUT: f64 = 1e6;

/// Of solids of 8 mm, to about one: a power of two, so that only places round.
const TO_SMALL: f64 = 0.125;

/// From the greatest to the least size in a scene.
const RATIO: f64 = 1e6;

/// Between two blocks that nearly touch, millimetres.
const NEAR_TIE: f64 = 1e-7;

pub(super) const CASES: &[Case] = &[
    Case { name: "far-out", build: || past_edges(small_far_out(analytic_solids())) },
    Case { name: "far-out-net", build: far_out_net },
    Case { name: "far-apart", build: far_apart },
    Case { name: "large-and-small", build: large_and_small },
    Case { name: "from-afar", build: || seen_from(1e4, 0.5) },
    Case { name: "zoom", build: zoom },
    Case { name: "features", build: || through_features(analytic_solids()) },
    Case { name: "features-net", build: || Stress { model: egg_solid(), aim: Aim::Through(egg_points()) } },
    Case { name: "poles", build: || Stress { model: egg_solid(), aim: Aim::Past(EGG_POLES.to_vec()) } },
    Case {
        name: "through-poles",
        build: || Stress { model: egg_solid(), aim: Aim::Through(EGG_POLES.to_vec()) },
    },
    Case { name: "along-axes", build: || Stress { model: analytic_solids(), aim: Aim::Along(lattice()) } },
    Case { name: "along-axes-net", build: || Stress { model: egg_solid(), aim: Aim::Along(egg_points()) } },
    Case { name: "near-tie", build: near_tie },
];

fn past_edges(model: Model) -> Stress {
    let points = edge_points(&model);
    Stress { model, aim: Aim::Past(points) }
}

fn small_far_out(model: Model) -> Model {
    let place = DAffine3::from_translation(DVec3::new(FAR_OUT, -FAR_OUT, FAR_OUT));
    moved(model, &(place * DAffine3::from_scale(DVec3::splat(TO_SMALL))))
}

fn far_out_net() -> Stress {
    let model = small_far_out(egg_solid());
    let points = model.surfaces.iter().flat_map(|surface| iso_points(surface, 8, 64)).collect();
    Stress { model, aim: Aim::Past(points) }
}

/// One part, placed twice, 10⁶ mm apart.
fn far_apart() -> Stress {
    let mut model = moved(analytic_solids(), &DAffine3::from_scale(DVec3::splat(TO_SMALL)));
    let part = model.roots[0];
    let child = |x: f64| Child {
        part,
        parent_from_child: DAffine3::from_translation(DVec3::X * x),
        name: String::new(),
        color: None,
        entity: 0,
    };
    let children = vec![child(0.0), child(FAR_OUT)];
    let root = Part { name: "pair".into(), bodies: vec![], children, entity: 0 };
    let root = model.parts.push(root);
    model.roots = vec![root];
    let points = edge_points(&model);
    Stress { model, aim: Aim::From { points, distance: 4.0, spread: 1.0 / RATIO } }
}

/// A plate of a kilometre, and a block of a millimetre above it.
fn large_and_small() -> Stress {
    let mut draft = Draft::default();
    let size = DVec3::new(RATIO, RATIO, RATIO / 1024.0);
    let plate = primitive::block(&mut draft.model, &Frame::IDENTITY, size, 1);
    let frame = frame_at(RATIO / 4.0, RATIO / 4.0, size.z + 1.0);
    let small = primitive::block(&mut draft.model, &frame, DVec3::ONE, 2);
    let points = (0..=8).map(|i| frame.origin + DVec3::new(f64::from(i) / 8.0, 0.5, 0.5)).collect();
    draft.solid(plate);
    draft.solid(small);
    Stress { model: draft.finished(), aim: Aim::From { points, distance: 4.0, spread: 2.0 / RATIO } }
}

fn seen_from(distance: f64, spread: f64) -> Stress {
    let model = analytic_solids();
    let points = edge_points(&model);
    Stress { model, aim: Aim::From { points, distance, spread } }
}

/// A view of a millionth of the scene: a corner of the block, and the middles of its faces.
fn zoom() -> Stress {
    let middles = [[3.0, 2.0, 0.0], [3.0, 2.0, 2.0], [0.0, 2.0, 1.0], [6.0, 2.0, 1.0]].map(DVec3::from_array);
    let points = middles.into_iter().chain([DVec3::ZERO]).collect();
    Stress { model: analytic_solids(), aim: Aim::From { points, distance: 4.0, spread: 1.0 / RATIO } }
}

/// The ends of the egg's axis.
const EGG_POLES: [DVec3; 2] = [DVec3::new(0.0, 0.0, -4.0), DVec3::new(0.0, 0.0, 5.0)];

/// Rays through vertices and edges.
fn through_features(model: Model) -> Stress {
    let mut points = edge_points(&model);
    points.extend(model.vertices.iter().map(|vertex| vertex.point));
    Stress { model, aim: Aim::Through(points) }
}

/// Poles, borders of patches, the seam, middle lines.
fn egg_points() -> Vec<DVec3> {
    iso_points(&Surface::Bspline(egg()), 8, 32)
}

/// Every half millimetre through the block and around it: on faces, edges, corners and planes of boxes.
fn lattice() -> Vec<DVec3> {
    let steps = |count: i32| (-1..=count).map(|i| 0.5 * f64::from(i));
    steps(24).flat_map(|x| steps(20).flat_map(move |y| steps(20).map(move |z| DVec3::new(x, y, z)))).collect()
}

fn near_tie() -> Stress {
    let mut draft = Draft::default();
    let size = DVec3::new(4.0, 4.0, 2.0);
    let lower = primitive::block(&mut draft.model, &Frame::IDENTITY, size, 1);
    let upper = primitive::block(&mut draft.model, &frame_at(0.0, 0.0, size.z + NEAR_TIE), size, 2);
    draft.solid(lower);
    draft.solid(upper);
    let places = (0..=16).flat_map(|i| (0..=16).map(move |j| [i, j]));
    let points = places.map(|[i, j]| DVec3::new(f64::from(i) / 4.0, f64::from(j) / 4.0, size.z)).collect();
    Stress { model: draft.finished(), aim: Aim::Through(points) }
}
