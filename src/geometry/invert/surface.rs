//! Closest points of B-spline surfaces by search.

use super::super::bezier::Homogeneous;
use super::super::bspline::BsplineSurface;
use super::super::knots::{KnotVector, MANY};
use super::super::surface::{ParameterBox, SurfaceDerivatives};
use super::{Inversion, finished, unwrapped};
use glam::{DVec2, DVec3};

/// Newton's method converges in 3 to 6 steps; kinks, poles and far points take some more.
const MAX_STEPS: usize = 60;
/// A step that still makes the distance grow after this many halvings is below rounding.
const MAX_HALVINGS: usize = 12;
/// Growth of a squared distance that may be rounding: far from the surface the last Newton steps do not show in it.
const ROUNDING: f64 = 1.0 + 4.0 * f64::EPSILON;
/// Polished candidates of a global search.
const MAX_CANDIDATES: usize = 8;
/// Samples of a global search along one parameter; beyond it, spans are sampled more coarsely.
const MAX_SAMPLES: usize = 256;

pub(super) fn invert(surface: &BsplineSurface, point: DVec3, seed: Option<DVec2>) -> Inversion {
    let domain = surface.domain();
    let found = match seed.filter(|seed| seed.is_finite()) {
        Some(seed) => polish(surface, &Cell { range: domain, open: surface.closed.map(|c| !c) }, point, seed),
        None => global(surface, point),
    };
    let unwrap = |axis: usize| {
        let range = [domain.min[axis], domain.max[axis]];
        let value = found.uv[axis];
        if surface.closed[axis] { unwrapped(value, range, seed.map(|seed| seed[axis])) } else { value }
    };
    Inversion { uv: DVec2::new(unwrap(0), unwrap(1)), distance: found.distance }
}

/// The best of the polished lowest places of a grid.
fn global(surface: &BsplineSurface, point: DVec3) -> Inversion {
    let grid = Grid::new(surface, point);
    let mut best = Inversion { uv: surface.domain().min, distance: f64::INFINITY };
    let close = 1e-13 * surface.size();
    for uv in grid.lowest(surface.closed) {
        for (cell, start) in cells_at(surface, uv) {
            let found = polish(surface, &cell, point, start);
            if found.distance < best.distance {
                best = found;
            }
        }
        if best.distance <= close {
            break;
        }
    }
    best
}

/// A rectangle to search in; open sides hold the search back, the others run on around the surface.
struct Cell {
    range: ParameterBox,
    open: [bool; 2],
}

/// The smooth cells that a sample belongs to, each with a start inside it: a kink between two minima is no obstacle
/// where each side is searched by itself.
fn cells_at(surface: &BsplineSurface, uv: DVec2) -> Vec<(Cell, DVec2)> {
    let along = |axis: usize| {
        let knots = if axis == 0 { &surface.u_knots } else { &surface.v_knots };
        let [first, last] = knots.domain();
        let t = uv[axis];
        let kinks =
            || knots.inner_knots().filter(|(_, count)| *count >= knots.degree()).map(|(knot, _)| knot);
        let below = kinks().filter(|knot| *knot < t).last().unwrap_or(first);
        let above = kinks().find(|knot| *knot > t).unwrap_or(last);
        if kinks().any(|knot| knot == t) {
            // At a knot itself the derivatives are those of the next piece, so the one before starts a little back.
            vec![([below, t], t - 1e-6 * (t - below), true), ([t, above], t, true)]
        } else {
            let kinked = kinks().next().is_some();
            vec![([below, above], t, kinked || !surface.closed[axis])]
        }
    };
    let along_v = along(1);
    let cells = along(0).into_iter().flat_map(|(u, start_u, open_u)| {
        along_v.iter().map(move |(v, start_v, open_v)| {
            let range = ParameterBox { min: DVec2::new(u[0], v[0]), max: DVec2::new(u[1], v[1]) };
            (Cell { range, open: [open_u, *open_v] }, DVec2::new(start_u, *start_v))
        })
    });
    cells.collect()
}

/// Squared distances from a point over parameters of all knot spans.
struct Grid {
    u: Vec<f64>,
    v: Vec<f64>,
    /// v fastest.
    squared: Vec<f64>,
}

impl Grid {
    fn new(surface: &BsplineSurface, point: DVec3) -> Self {
        let (u, v) = (samples(&surface.u_knots), samples(&surface.v_knots));
        let (p, v_count) = (surface.u_knots.degree(), surface.v_knots.point_count());
        let v_bases: Vec<_> = v.iter().map(|v| surface.v_knots.basis::<MANY>(*v, 0)).collect();
        let mut squared = Vec::with_capacity(u.len() * v.len());
        let mut row = vec![Default::default(); v_count];
        for u in &u {
            // The control points of the iso-curve serve all samples on it.
            let basis = surface.u_knots.basis::<MANY>(*u, 0);
            for (j, sum) in row.iter_mut().enumerate() {
                let term = |i: usize| surface.points[(basis.first + i) * v_count + j] * basis.values[0][i];
                *sum = (1..=p).map(term).fold(term(0), |sum, term| sum + term);
            }
            for basis in &v_bases {
                let pairs = row[basis.first..].iter().zip(&basis.values[0][..=surface.v_knots.degree()]);
                let sum = pairs
                    .fold(Default::default(), |sum: super::super::Homogeneous3, (point, value)| {
                        sum + *point * *value
                    });
                squared.push(Homogeneous::point(sum).distance_squared(point));
            }
        }
        Self { u, v, squared }
    }

    /// The parameters of the local minima, lowest first.
    fn lowest(&self, closed: [bool; 2]) -> impl Iterator<Item = DVec2> + '_ {
        let counts = [self.u.len(), self.v.len()];
        let at = |i: usize, j: usize| self.squared[i * counts[1] + j];
        let neighbours = |axis: usize, i: usize| {
            let count = counts[axis];
            let (before, after) = ((i + count - 1) % count, (i + 1) % count);
            // At the ends of an open parameter the place itself stands in for the missing neighbour.
            match (closed[axis], i) {
                (false, 0) => [i, i, after],
                (false, _) if i + 1 == count => [before, i, i],
                _ => [before, i, after],
            }
        };
        let mut lowest: Vec<(f64, DVec2)> = Vec::new();
        for i in 0..counts[0] {
            for j in 0..counts[1] {
                let here = at(i, j);
                let beside = neighbours(1, j);
                if neighbours(0, i).iter().all(|i| beside.iter().all(|j| here <= at(*i, *j))) {
                    lowest.push((here, DVec2::new(self.u[i], self.v[j])));
                }
            }
        }
        lowest.sort_by(|a, b| a.0.total_cmp(&b.0));
        lowest.into_iter().take(MAX_CANDIDATES).map(|(_, uv)| uv)
    }
}

/// `degree + 1` parameters a span, at least 3, and the end.
fn samples(knots: &KnotVector) -> Vec<f64> {
    let spans: Vec<_> = knots.spans().map(|k| [knots.as_slice()[k], knots.as_slice()[k + 1]]).collect();
    let each = (knots.degree() + 1).max(3).min(MAX_SAMPLES / spans.len()).max(1);
    // Over more spans than samples only every so many are visited.
    let stride = spans.len().div_ceil(MAX_SAMPLES);
    let inner = spans
        .iter()
        .step_by(stride)
        .flat_map(|[a, b]| (0..each).map(move |i| a + (b - a) * (i as f64 / each as f64)));
    inner.chain([knots.domain()[1]]).collect()
}

/// A local minimum of the distance, reached downhill from `start`.
fn polish(surface: &BsplineSurface, cell: &Cell, point: DVec3, start: DVec2) -> Inversion {
    let domain = surface.domain();
    let lengths = domain.max - domain.min;
    let ParameterBox { min, max } = cell.range;
    let limit = |uv: DVec2| {
        let clamped = uv.clamp(min, max);
        DVec2::new(if cell.open[0] { clamped.x } else { uv.x }, if cell.open[1] { clamped.y } else { uv.y })
    };
    let evaluate = |uv: DVec2| {
        let wrap = |axis: usize| super::super::curve::wrap(uv[axis], [domain.min[axis], domain.max[axis]]);
        // Open parameters are inside already, so that wrapping leaves them as they are.
        surface.derivatives(DVec2::new(wrap(0), wrap(1)))
    };
    let mut uv = limit(start);
    let mut here = evaluate(uv);
    let mut squared = here.point.distance_squared(point);
    let mut moved_before = f64::INFINITY;
    for _ in 0..MAX_STEPS {
        // A parameter that stands at an open end, with the descent pointing outward, stays there.
        let off = here.point - point;
        let slopes = DVec2::new(off.dot(here.du), off.dot(here.dv));
        let held: [bool; 2] = std::array::from_fn(|axis| {
            cell.open[axis]
                && ((uv[axis] <= min[axis] && slopes[axis] > 0.0)
                    || (uv[axis] >= max[axis] && slopes[axis] < 0.0))
        });
        let mut step = newton_step(&here, off, lengths, held);
        let mut halvings = 0;
        let advanced = loop {
            let next_uv = limit(uv + step);
            let next = evaluate(next_uv);
            let next_squared = next.point.distance_squared(point);
            if next_squared <= squared * ROUNDING {
                break Some((next_uv, next, next_squared));
            }
            halvings += 1;
            if halvings > MAX_HALVINGS {
                break None;
            }
            step *= 0.5;
        };
        let Some((next_uv, next, next_squared)) = advanced else { break };
        let moved = here.du * (next_uv.x - uv.x) + here.dv * (next_uv.y - uv.y);
        let size = here.point.length() + here.du.length() * lengths.x + here.dv.length() * lengths.y;
        (uv, here, squared) = (next_uv, next, next_squared);
        if finished(moved.length(), moved_before, size) {
            break;
        }
        moved_before = moved.length();
    }
    Inversion { uv, distance: squared.sqrt() }
}

/// The step to the stationary point of `|S − P|²`, `off = S − P`: full Newton where its Hessian is positive definite, else
/// Gauss-Newton with a little of the gradient; not longer than a quarter of the domain. Works in parameters scaled to
/// the unit square, so that u and v weigh the same.
fn newton_step(here: &SurfaceDerivatives, off: DVec3, lengths: DVec2, held: [bool; 2]) -> DVec2 {
    let (du, dv) = (here.du * lengths.x, here.dv * lengths.y);
    let slopes = DVec2::new(off.dot(du), off.dot(dv));
    let gauss = [du.length_squared(), du.dot(dv), dv.length_squared()];
    let bends = [
        off.dot(here.duu) * lengths.x * lengths.x,
        off.dot(here.duv) * lengths.x * lengths.y,
        off.dot(here.dvv) * lengths.y * lengths.y,
    ];
    // At a pole one parameter moves nothing: its step would be rounding noise, so it keeps its value.
    let held = [held[0] || gauss[0] <= 1e-24 * gauss[2], held[1] || gauss[2] <= 1e-24 * gauss[0]];
    let full: [f64; 3] = std::array::from_fn(|i| gauss[i] + bends[i]);
    let scaled = match held {
        [true, true] => DVec2::ZERO,
        [false, true] => DVec2::new(single(slopes.x, full[0], gauss[0]), 0.0),
        [true, false] => DVec2::new(0.0, single(slopes.y, full[2], gauss[2])),
        [false, false] => {
            let [a, b, c] = full;
            let definite = a > 1e-3 * gauss[0] && c > 1e-3 * gauss[2] && a * c - b * b > 1e-6 * a * c;
            let [a, b, c] = if definite {
                full
            } else {
                // Keeps the matrix regular where the tangents are parallel or one of them vanishes.
                let little = 1e-10 * (gauss[0] + gauss[2]);
                [gauss[0] + little, gauss[1], gauss[2] + little]
            };
            DVec2::new(b * slopes.y - c * slopes.x, b * slopes.x - a * slopes.y) / (a * c - b * b)
        }
    };
    let longest = scaled.abs().max_element();
    let scaled = if longest > 0.25 { scaled * (0.25 / longest) } else { scaled };
    if scaled.is_finite() { scaled * lengths } else { DVec2::ZERO }
}

fn single(slope: f64, full: f64, gauss: f64) -> f64 {
    -slope / if full > 1e-3 * gauss { full } else { gauss }
}
