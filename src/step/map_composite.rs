//! Composite curves (ISO 10303-42: composite_curve, composite_curve_on_surface, boundary_curve) as pieces in order.

use super::map_curve::MappedCurve;
use super::reader::{MAX_CHAIN, Mapped, Problem, Reader, problem, reference};
use super::value::{Entity, Record};
use crate::geometry::{Curve, join_curves, to_bspline::curve_to_bspline};
use glam::DVec3;

/// Ends of segments meet where they are closer than this share of the curve's size: files keep some five to seven digits.
pub const MEETING: f64 = 1e-4;

/// The keywords of curves that are made of segments.
const COMPOSITES: [&str; 4] =
    ["COMPOSITE_CURVE", "COMPOSITE_CURVE_ON_SURFACE", "BOUNDARY_CURVE", "OUTER_BOUNDARY_CURVE"];

/// A bounded piece of a curve.
#[derive(Debug, Clone)]
pub struct Piece {
    /// The carrier.
    pub curve: Curve,
    /// Parameters at start and end; descending where the piece runs against its curve.
    pub range: [f64; 2],
    /// The file's entity number.
    pub entity: u64,
}

impl Piece {
    /// The point at the share `s` of the way.
    pub fn at(&self, s: f64) -> DVec3 {
        self.curve.point(self.range[0] + s * (self.range[1] - self.range[0]))
    }

    /// The greatest distance of some points from the start.
    pub fn reach(&self) -> f64 {
        let start = self.at(0.0);
        (1..=8).map(|i| self.at(f64::from(i) / 8.0).distance(start)).fold(0.0, f64::max)
    }
}

/// The record with the segments of a composite curve and their position; `None` for other curves.
pub fn segments<'e, 'a>(entity: &'e Entity<'a>) -> Option<(&'e Record<'a>, usize)> {
    if entity.records.len() > 1 {
        return entity.record("COMPOSITE_CURVE").map(|record| (record, 0));
    }
    COMPOSITES.contains(&&*entity.first().keyword).then(|| (entity.first(), 1))
}

impl Reader<'_> {
    /// Adds the pieces of curve `id` in order, each run as its segment says; a single one where it is not composite, and none
    /// where it is a point. Returns what was mended.
    pub fn pieces(&self, id: u64, depth: usize, pieces: &mut Vec<Piece>) -> Mapped<Vec<Problem>> {
        let entity = self.entity(id)?;
        if depth > MAX_CHAIN {
            return Err(problem(&entity, "curves refer to each other in a circle"));
        }
        if ["DEGENERATE_PCURVE", "EVALUATED_DEGENERATE_PCURVE"].iter().any(|k| entity.is(k)) {
            return Ok(Vec::new());
        }
        if entity.first().keyword == "POLYLINE" {
            let corners = self.polyline_points(&entity)?;
            pieces.extend(corners.windows(2).filter(|w| w[0] != w[1]).map(|w| {
                let curve = Curve::Line { origin: w[0], direction: w[1] - w[0] };
                Piece { curve, range: [0.0, 1.0], entity: id }
            }));
            return Ok(Vec::new());
        }
        let Some((record, at)) = segments(&entity) else {
            let mapped = self.curve_in_chain(id, depth + 1)?;
            let range = mapped.range();
            if !range.iter().all(|t| t.is_finite()) {
                return Err(problem(&entity, "a segment has no ends"));
            }
            pieces.push(Piece { curve: mapped.curve, range, entity: id });
            return Ok(mapped.repairs);
        };
        self.charge(&entity, record.list(at).len())?;
        let mut repairs = Vec::new();
        for id in record.references(at) {
            let segment = self.entity(id)?;
            let record = segment.record("COMPOSITE_CURVE_SEGMENT").unwrap_or(segment.first());
            let start = pieces.len();
            repairs.extend(self.pieces(reference(id, record, 2)?, depth + 1, pieces)?);
            if record.logical(1) == Some(false) {
                pieces[start..].reverse();
                pieces[start..].iter_mut().for_each(|piece| piece.range.reverse());
            }
        }
        Ok(repairs)
    }

    /// A composite curve as one B-spline, exactly.
    pub fn composite_curve(&self, entity: &Entity, depth: usize) -> Mapped<MappedCurve> {
        let mut pieces = Vec::new();
        let repairs = self.pieces(entity.id, depth, &mut pieces)?;
        let size = pieces.iter().map(Piece::reach).fold(0.0, f64::max);
        pieces.retain(|piece| piece.reach() > 0.0);
        turn(&mut pieces, size);
        if pieces.windows(2).any(|pair| pair[0].at(1.0).distance(pair[1].at(0.0)) > MEETING * size) {
            return Err(problem(entity, "the segments do not meet"));
        }
        let splines: Vec<_> = pieces.iter().map(|p| curve_to_bspline(&p.curve, p.range)).collect();
        let joined = join_curves(&splines).map_err(|error| problem(entity, error.to_string()))?;
        Ok(MappedCurve { repairs, ..Curve::Bspline(joined).into() })
    }
}

/// Ends that are as near to a point as each other, but for this share of the curve's size, are told apart by nothing but the file: those of a ring, and of two
/// pieces with both ends in common.
const UNDECIDED: f64 = 1e-7;

/// Turns pieces of a curve of some size round that start where they should end; senses in files are often wrong.
pub fn turn(pieces: &mut [Piece], size: f64) {
    let undecided = UNDECIDED * size;
    if let [first, second, ..] = pieces {
        let near = |s: f64| {
            [0.0, 1.0]
                .map(|end| first.at(s).distance(second.at(end)))
                .into_iter()
                .fold(f64::INFINITY, f64::min)
        };
        if near(0.0) + undecided < near(1.0) && pieces.len() > 2 {
            pieces[0].range.reverse();
        }
    }
    for i in 1..pieces.len() {
        let tail = pieces[i - 1].at(1.0);
        if pieces[i].at(1.0).distance(tail) + undecided < pieces[i].at(0.0).distance(tail) {
            pieces[i].range.reverse();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(from: DVec3, to: DVec3) -> Piece {
        Piece { curve: Curve::Line { origin: from, direction: to - from }, range: [0.0, 1.0], entity: 1 }
    }

    /// There, back, and on in a ring: whatever a file's last digits are, all run as it says.
    #[test]
    fn pieces_that_meet_either_way_are_not_turned() {
        let (a, b) = (DVec3::ZERO, DVec3::X * 10.0);
        for off in [-1e-9, 0.0, 1e-9] {
            let ring = [a, DVec3::Y, DVec3::new(-1.0, 1.0, 0.0), DVec3::X * off];
            let ring = ring.windows(2).map(|w| curve_to_bspline(&line(w[0], w[1]).curve, [0.0, 1.0]));
            let ring = join_curves(&ring.collect::<Vec<_>>()).expect("lines that meet");
            let range = ring.domain();
            let ring = Piece { curve: Curve::Bspline(ring), range, entity: 2 };
            let mut pieces = vec![line(a, b + DVec3::X * off), line(b, a + DVec3::X * off), ring];
            turn(&mut pieces, 10.0);
            assert_eq!(pieces.iter().map(|p| p.range).collect::<Vec<_>>(), [[0.0, 1.0], [0.0, 1.0], range]);
        }
    }

    #[test]
    fn pieces_that_meet_one_way_are_turned_to_it() {
        // The second piece is much shorter than pieces may be apart.
        let [a, b, c] = [DVec3::ZERO, DVec3::X, DVec3::new(1.0, 0.5 * MEETING, 0.0)];
        for flips in 0..8 {
            let sides = [[a, b], [b, c], [c, a]];
            let mut pieces: Vec<Piece> = (0..3)
                .map(|i| {
                    if flips >> i & 1 == 1 {
                        line(sides[i][1], sides[i][0])
                    } else {
                        line(sides[i][0], sides[i][1])
                    }
                })
                .collect();
            turn(&mut pieces, 1.0);
            let gap = |i: usize| pieces[i].at(1.0).distance(pieces[(i + 1) % 3].at(0.0));
            assert!((0..3).all(|i| gap(i) < 1e-12), "{flips}");
        }
    }
}
