//! The judge of trim structures: inside or outside by the crossings of a ray with a region's own f64 curves.
//!
//! Nothing of what a structure relies on is used: neither that curves are monotone, nor cells, nor f32 vertices. A curve whose control points lie all on
//! one side of the ray's line does not cross it; one whose control points lie all before the ray's origin neither; one whose control points lie all
//! beyond the origin crosses it an odd number of times where its ends lie on both sides of the line. All others are halved by de Casteljau's rule.
//! The ends of joined curves agree to single precision, so a ray that passes an end as near as that is given up for one in another direction.

use super::region::Region;
use crate::geometry::{Bezier, Homogeneous, Homogeneous2};
use glam::DVec2;

/// How far the ends of two joined curves may be apart, in windows: the spacing of f32 numbers below 1, twice.
const JOINT: f64 = 1.0 / (1 << 23) as f64;

/// Halvings after which a curve is a point: 2⁻⁴⁸ of the window.
const MAX_HALVINGS: u32 = 48;

/// Distances are found within this share of themselves.
const DISTANCE_TOLERANCE: f64 = 1e-3;

/// A face's trimmed region, ready to be asked.
#[derive(Debug, Clone)]
pub struct TrimJudge {
    curves: Vec<Judged>,
    /// Whether the whole window is inside.
    is_whole: bool,
}

/// A curve and the box around its control points.
#[derive(Debug, Clone)]
struct Judged {
    curve: Bezier<Homogeneous2>,
    bounds: Bounds,
}

/// A box.
#[derive(Debug, Clone, Copy)]
struct Bounds {
    low: DVec2,
    high: DVec2,
}

impl Bounds {
    fn of(curve: &Bezier<Homogeneous2>) -> Self {
        let none = Self { low: DVec2::INFINITY, high: DVec2::NEG_INFINITY };
        curve
            .points
            .iter()
            .map(|p| p.point())
            .fold(none, |all, p| Self { low: all.low.min(p), high: all.high.max(p) })
    }

    fn distance(&self, point: DVec2) -> f64 {
        (point - point.clamp(self.low, self.high)).length()
    }
}

/// A ray along an axis.
#[derive(Debug, Clone, Copy)]
struct AxisRay {
    origin: DVec2,
    /// The axis that it runs along.
    axis: usize,
    /// Which way.
    sign: f64,
}

/// The directions that are tried in turn; the first is that of the structures' own rays.
const DIRECTIONS: [(usize, f64); 4] = [(0, -1.0), (1, -1.0), (0, 1.0), (1, 1.0)];

impl TrimJudge {
    pub(super) fn new(region: &Region) -> Self {
        let curves = region.pieces.iter().map(|piece| {
            let curve = match piece.curve {
                Some(index) => region.curves[index as usize].clone(),
                None => Bezier { points: vec![vertex(piece.low), vertex(piece.high)] },
            };
            Judged { bounds: Bounds::of(&curve), curve }
        });
        Self { curves: curves.collect(), is_whole: !region.is_bounded }
    }

    /// Whether `point`, normalised, is inside; nothing where a curve passes nearer than `band`, or too near to all rays' ends.
    pub fn inside(&self, point: [f64; 2], band: f64) -> Option<bool> {
        if self.is_whole {
            return Some(true);
        }
        let point = DVec2::from_array(point);
        if self.distance_below(point, band) < band {
            return None;
        }
        let rays = DIRECTIONS.map(|(axis, sign)| AxisRay { origin: point, axis, sign });
        rays.iter().find_map(|ray| self.is_odd(ray))
    }

    /// The distance, in windows, from `point` to the nearest curve, within 10⁻³ of itself; infinite without curves.
    pub fn distance(&self, point: [f64; 2]) -> f64 {
        self.distance_below(DVec2::from_array(point), f64::INFINITY)
    }

    /// A point of the curves and a unit vector across them there, for a number of [0, 1) that picks one.
    pub fn place(&self, number: f64) -> Option<([f64; 2], [f64; 2])> {
        let at = number * self.curves.len() as f64;
        let judged = self.curves.get(at as usize)?;
        let [value, slope, _] = judged.curve.derivatives(at.fract());
        let point = value.point();
        let across = (slope.truncate() - point * slope.z).perp().try_normalize()?;
        Some((point.to_array(), across.to_array()))
    }

    /// The lesser of the distance from `point` to the nearest curve and `limit`.
    fn distance_below(&self, point: DVec2, limit: f64) -> f64 {
        let mut least = limit;
        for Judged { curve, bounds } in &self.curves {
            approach(curve, *bounds, point, MAX_HALVINGS, &mut least);
        }
        least
    }

    /// Whether `ray` crosses the curves an odd number of times; nothing where it passes the end of one.
    fn is_odd(&self, ray: &AxisRay) -> Option<bool> {
        let mut odd = false;
        for Judged { curve, bounds } in &self.curves {
            let [first, last] = ends(curve);
            if ray.passes(first) || ray.passes(last) {
                return None;
            }
            odd ^= ray.crosses(curve, *bounds, MAX_HALVINGS)?;
        }
        Some(odd)
    }
}

impl AxisRay {
    /// How far `point` lies along the ray, and beside it.
    fn place(&self, point: DVec2) -> [f64; 2] {
        let from_origin = point - self.origin;
        [from_origin[self.axis] * self.sign, from_origin[1 - self.axis]]
    }

    /// Whether the end of a curve lies so near that its neighbour may end on the other side.
    fn passes(&self, end: DVec2) -> bool {
        let [along, beside] = self.place(end);
        along >= -JOINT && beside.abs() <= JOINT
    }

    /// Whether the ray crosses the curve an odd number of times; nothing where the origin is on it.
    fn crosses(&self, curve: &Bezier<Homogeneous2>, bounds: Bounds, halvings: u32) -> Option<bool> {
        let [[along_0, beside_0], [along_1, beside_1]] = [bounds.low, bounds.high].map(|p| self.place(p));
        if beside_0 > 0.0 || beside_1 <= 0.0 || along_0.max(along_1) < 0.0 {
            return Some(false);
        }
        if along_0.min(along_1) > 0.0 {
            let [first, last] = ends(curve).map(|end| self.place(end)[1] <= 0.0);
            return Some(first != last);
        }
        if halvings == 0 {
            return None;
        }
        let [first, second] = curve.split(0.5);
        let odd = self.crosses(&first, Bounds::of(&first), halvings - 1)?;
        Some(odd != self.crosses(&second, Bounds::of(&second), halvings - 1)?)
    }
}

/// Lowers `least` to the distance from `point` to the curve, if that is less.
fn approach(curve: &Bezier<Homogeneous2>, bounds: Bounds, point: DVec2, halvings: u32, least: &mut f64) {
    if bounds.distance(point) >= *least * (1.0 - DISTANCE_TOLERANCE) {
        return;
    }
    *least = ends(curve).map(|end| end.distance(point)).into_iter().fold(*least, f64::min);
    if halvings == 0 {
        return;
    }
    let halves = curve.split(0.5).map(|half| (Bounds::of(&half), half));
    let near_first = halves[0].0.distance(point) <= halves[1].0.distance(point);
    for index in if near_first { [0, 1] } else { [1, 0] } {
        let (bounds, half) = &halves[index];
        approach(half, *bounds, point, halvings - 1, least);
    }
}

fn ends(curve: &Bezier<Homogeneous2>) -> [DVec2; 2] {
    [curve.points[0], curve.points[curve.degree()]].map(|p| p.point())
}

fn vertex(point: [f32; 2]) -> Homogeneous2 {
    Homogeneous2::new(f64::from(point[0]), f64::from(point[1]), 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::ParameterBox;
    use crate::trimming::FaceTrim;

    /// A ring: radii 0.4 and 0.2 around the middle of the window [0, 1]², in quarters.
    fn ring() -> Region {
        let arc = |radius: f64, quarter: i32| {
            let corner = |k: i32| {
                let (sin, cos) = (f64::from(k) * std::f64::consts::FRAC_PI_2).sin_cos();
                DVec2::new(cos, sin).round()
            };
            let (from, to) = (corner(quarter), corner(quarter + 1));
            let place = |p: DVec2, w: f64| ((DVec2::splat(0.5) + p * radius) * w).extend(w);
            let middle = place(from + to, std::f64::consts::FRAC_1_SQRT_2);
            Bezier { points: vec![place(from, 1.0), middle, place(to, 1.0)] }
        };
        let window = ParameterBox { min: DVec2::ZERO, max: DVec2::ONE };
        let mut trim = FaceTrim::whole(window);
        trim.curves = (0..4).flat_map(|quarter| [arc(0.4, quarter), arc(0.2, quarter)]).collect();
        Region::new(&trim).expect("a region")
    }

    #[test]
    fn a_ring_is_judged_by_its_radii() {
        let judge = TrimJudge::new(&ring());
        let mut decided = 0;
        for i in 0..100 {
            for j in 0..100 {
                // The row and the column through the middle pass the ends of quarters.
                let point = [f64::from(i) / 100.0, f64::from(j) / 100.0];
                let radius = (point[0] - 0.5).hypot(point[1] - 0.5);
                let gap = (radius - 0.4).abs().min((radius - 0.2).abs());
                let distance = judge.distance(point);
                assert!((distance - gap).abs() <= 2e-3 * gap + 1e-12, "{point:?}: {distance} {gap}");
                if let Some(inside) = judge.inside(point, 1e-6) {
                    assert_eq!(inside, radius > 0.2 && radius < 0.4, "{point:?}");
                    decided += 1;
                }
            }
        }
        assert!(decided > 9900, "{decided}");
        assert_eq!(judge.inside([0.9, 0.5], 1e-6), None);
    }

    #[test]
    fn places_lie_on_the_curves() {
        let judge = TrimJudge::new(&ring());
        for i in 0..1000 {
            let (point, across) = judge.place(f64::from(i) / 1000.0).expect("a place");
            assert!(judge.distance(point) < 1e-12);
            let off = [0, 1].map(|k| point[k] + across[k] * 1e-3);
            assert!((judge.distance(off) - 1e-3).abs() < 1e-5);
        }
    }
}
