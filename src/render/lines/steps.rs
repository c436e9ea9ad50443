//! Edges to steps: short straight pieces of their images.

use super::screen::Screen;
use super::{EdgeChoice, Ends, LineOptions};
use crate::image::{Window, distance_to};
use crate::scene::{EdgeKind, EdgePiece, NO_FACE, Scene};
use glam::{DMat3, DVec2, DVec3, DVec4};
use rayon::prelude::*;
use smallvec::SmallVec;

/// The image of an edge is at most so far from its steps, pixels.
const FLATNESS: f64 = 1.0 / 16.0;
/// The longest step, pixels.
const LONGEST: f64 = 0.5;
/// Halvings of a piece: beyond them it is as good as straight, or the picture's scale has no sense.
const MAX_LEVEL: u32 = 16;

/// A step of an edge's image.
#[derive(Debug, Clone, Copy)]
pub(super) struct Step {
    /// In the picture.
    pub(super) ends: Ends,
    /// Its middle in model space …
    pub(super) middle: DVec3,
    /// … and in the picture.
    pub(super) at: DVec2,
    /// Length of the edge's image before it, pixels.
    pub(super) along: f64,
    /// How far, millimetres, the edge's faces may be from the edge.
    pub(super) slack: f64,
    /// Index of the instance.
    pub(super) instance: u32,
}

/// A piece of an edge in model space: homogeneous control points.
type Piece = SmallVec<[DVec4; 26]>;

/// The steps of all edges that are asked for and in what is drawn, in order.
pub(super) fn steps(scene: &Scene<'_>, screen: &Screen<'_>, options: &LineOptions) -> Vec<Step> {
    let is_wanted = |piece: &&EdgePiece| match options.edges {
        EdgeChoice::None => false,
        EdgeChoice::Feature => EdgeKind::from_number(piece.kind).is_some_and(EdgeKind::is_feature),
        EdgeChoice::All => true,
    };
    let mut by_part: Vec<Vec<&EdgePiece>> = vec![Vec::new(); scene.parts.len()];
    for piece in scene.edge_pieces.iter().filter(is_wanted) {
        by_part[piece.part as usize].push(piece);
    }
    let of_instance = |index: usize| {
        let place = Place::new(scene, index);
        let pieces = by_part[scene.instances[index].part as usize].par_chunk_by(|a, b| a.edge == b.edge);
        let steps = pieces.flat_map_iter(|edge| of_edge(scene, screen, &place, edge));
        steps.map(|step| Step { instance: index as u32, ..step }).collect::<Vec<_>>()
    };
    (0..scene.instances.len()).into_par_iter().flat_map_iter(of_instance).collect()
}

/// Where an instance stands.
struct Place {
    model_from_part: DMat3,
    origin: DVec3,
    /// Lengths in the model, of those in the part.
    scale: f64,
}

impl Place {
    fn new(scene: &Scene<'_>, index: usize) -> Self {
        let instance = &scene.instances[index];
        let row = |row: [f32; 3]| DVec3::from_array(row.map(f64::from));
        let rows =
            [instance.part_from_world_0, instance.part_from_world_1, instance.part_from_world_2].map(row);
        let model_from_part = DMat3::from_cols(rows[0], rows[1], rows[2]).transpose().inverse();
        let grid = DVec3::from_array(instance.grid.map(f64::from)) * scene.header.grid_step;
        let origin = DVec3::from_array(scene.header.world_anchor) + grid + row(instance.fraction);
        Self { model_from_part, origin, scale: model_from_part.determinant().abs().cbrt() }
    }
}

/// The steps of one edge, whose pieces follow each other.
fn of_edge(scene: &Scene<'_>, screen: &Screen<'_>, place: &Place, pieces: &[&EdgePiece]) -> Vec<Step> {
    let mut steps = Vec::new();
    let mut along = 0.0;
    for piece in pieces {
        let first = piece.first_point as usize;
        let anchor = DVec3::from_array(piece.grid.map(f64::from)) * scene.header.grid_step;
        let points = &scene.edge_points[first..=first + piece.degree as usize];
        let moved = |point: &[f32; 4]| {
            let point = DVec4::from_array(point.map(f64::from));
            let in_part = point.truncate() + anchor * point.w;
            (place.model_from_part * in_part + place.origin * point.w).extend(point.w)
        };
        let curve: Piece = points.iter().map(moved).collect();
        let slack_of =
            |&face: &u32| if face == NO_FACE { 0.0 } else { f64::from(scene.faces[face as usize].slack) };
        let slack = piece.faces.iter().map(slack_of).fold(0.0, f64::max) * place.scale;
        flatten(screen, &curve, slack, &mut along, &mut steps);
    }
    steps
}

/// The point of a curve.
fn point(curve: &Piece, t: f64) -> DVec3 {
    let mut row = curve.clone();
    while row.len() > 1 {
        for i in 0..row.len() - 1 {
            row[i] = row[i].lerp(row[i + 1], t);
        }
        row.pop();
    }
    row[0].truncate() / row[0].w
}

/// A place on a curve and in the picture.
type Mark = (f64, DVec2);

/// Cuts a piece into flat stretches, and these into steps.
fn flatten(screen: &Screen<'_>, curve: &Piece, slack: f64, along: &mut f64, steps: &mut Vec<Step>) {
    let mark = |t: f64| screen.project(point(curve, t)).map(|at| (t, at));
    // As many stretches as control points: an image that comes back to its chord is not flat.
    let count = if curve.len() == 2 { 1 } else { 2 * curve.len() };
    let marks: Vec<Option<Mark>> = (0..=count).map(|i| mark(i as f64 / count as f64)).collect();
    // Backwards, so that the stack gives the stretches in order.
    let mut open: Vec<(Mark, Mark, u32)> =
        marks.windows(2).rev().filter_map(|pair| Some((pair[0]?, pair[1]?, 0))).collect();
    while let Some((from, to, level)) = open.pop() {
        if !is_in_picture(screen, from.1, to.1) {
            *along += from.1.distance(to.1);
            continue;
        }
        let middle = mark(0.5 * (from.0 + to.0));
        let is_flat = |middle: Mark| distance_to(middle.1, [from.1, to.1]) <= 0.5 * FLATNESS;
        match middle {
            Some(middle) if level < MAX_LEVEL && !is_flat(middle) => {
                open.push((middle, to, level + 1));
                open.push((from, middle, level + 1));
            }
            _ => stretch(screen, curve, [from, to], slack, along, steps),
        }
    }
}

/// Cuts a flat stretch into steps; those outside of what is drawn are left out.
fn stretch(
    screen: &Screen<'_>,
    curve: &Piece,
    [from, to]: [Mark; 2],
    slack: f64,
    along: &mut f64,
    steps: &mut Vec<Step>,
) {
    let [start, length] = [from.1, to.1 - from.1];
    let count = (length.length() / LONGEST).ceil().max(1.0);
    let (first, last) = shown(screen, start, length, count);
    let at = |i: f64| {
        let s = i / count;
        let middle = point(curve, from.0 * (1.0 - s) + to.0 * s);
        screen.project(middle).map(|at| (middle, at))
    };
    let mut end = at(first).map(|(_, at)| at);
    for i in first as u64..last as u64 {
        let next = at(i as f64 + 1.0).map(|(_, at)| at);
        if let (Some(a), Some(b), Some((middle, at))) = (end, next, at(i as f64 + 0.5)) {
            let along = *along + length.length() * (i as f64 + 0.5) / count;
            steps.push(Step { ends: [a, b], middle, at, along, slack, instance: 0 });
        }
        end = next;
    }
    *along += length.length();
}

/// How far beyond the border of what is drawn lines may still reach into it, pixels.
const MARGIN: f64 = 64.0;

/// The first and last of `count` steps of a stretch that may be in what is drawn; an edge may be a billion pixels long. Steps do not depend on what is drawn.
fn shown(screen: &Screen<'_>, start: DVec2, length: DVec2, count: f64) -> (f64, f64) {
    let Window { left, top, width, height } = screen.window();
    let borders = [[left, left + width], [top, top + height]];
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for axis in 0..2 {
        let [low, high] = [borders[axis][0] as f64 - MARGIN, borders[axis][1] as f64 + MARGIN]
            .map(|border| (border - start[axis]) / length[axis]);
        if length[axis] != 0.0 {
            enter = enter.max(low.min(high));
            leave = leave.min(low.max(high));
        }
    }
    if enter > leave {
        return (0.0, 0.0);
    }
    ((enter * count).floor(), (leave * count).ceil())
}

/// Whether the straight line between two places, and what curves beside it, may be in the picture.
fn is_in_picture(screen: &Screen<'_>, a: DVec2, b: DVec2) -> bool {
    let bulge = a.distance(b) + MARGIN;
    let size = DVec2::from_array(screen.size().map(|pixels| pixels as f64));
    (a.max(b) + bulge).cmpge(DVec2::ZERO).all() && (a.min(b) - bulge).cmple(size).all()
}
