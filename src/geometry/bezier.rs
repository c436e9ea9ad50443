//! Bézier curves and tensor-product patches over homogeneous points.

use super::knots::FEW;
use glam::{DVec2, DVec3, DVec4};
use smallvec::SmallVec;
use std::ops::{Add, Mul, Sub};

/// A point with premultiplied weight, `(w·x, w·y[, w·z], w)`: curves and patches are polynomial in it.
pub trait Homogeneous:
    Copy
    + Default
    + PartialEq
    + std::fmt::Debug
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<f64, Output = Self>
{
    /// The Cartesian type.
    type Point: Copy;
    /// Premultiplies.
    fn new(point: Self::Point, weight: f64) -> Self;
    /// Divides by the weight.
    fn point(self) -> Self::Point;
    /// The weight.
    fn weight(self) -> f64;
    /// Whether all components are finite numbers.
    fn is_finite(self) -> bool;
    /// The distance between the Cartesian points (`distance` of glam would take the weights for a coordinate).
    fn separation(self, other: Self) -> f64;
}

/// `(w·x, w·y, w·z, w)`.
pub type Homogeneous3 = DVec4;
/// `(w·u, w·v, w)`.
pub type Homogeneous2 = DVec3;

impl Homogeneous for DVec4 {
    type Point = DVec3;
    fn new(point: DVec3, weight: f64) -> Self {
        (point * weight).extend(weight)
    }
    fn point(self) -> DVec3 {
        self.truncate() / self.w
    }
    fn weight(self) -> f64 {
        self.w
    }
    fn is_finite(self) -> bool {
        DVec4::is_finite(self)
    }
    fn separation(self, other: Self) -> f64 {
        Homogeneous::point(self).distance(Homogeneous::point(other))
    }
}

impl Homogeneous for DVec3 {
    type Point = DVec2;
    fn new(point: DVec2, weight: f64) -> Self {
        (point * weight).extend(weight)
    }
    fn point(self) -> DVec2 {
        self.truncate() / self.z
    }
    fn weight(self) -> f64 {
        self.z
    }
    fn is_finite(self) -> bool {
        DVec3::is_finite(self)
    }
    fn separation(self, other: Self) -> f64 {
        Homogeneous::point(self).distance(Homogeneous::point(other))
    }
}

/// A rational Bézier curve on [0, 1]; degree = points − 1.
#[derive(Debug, Clone, PartialEq)]
pub struct Bezier<P> {
    /// Control points, at least two.
    pub points: Vec<P>,
}

/// A rational Bézier patch on [0, 1]².
#[derive(Debug, Clone, PartialEq)]
pub struct BezierPatch {
    /// Degrees along u and v.
    pub degrees: [usize; 2],
    /// `(degrees[0] + 1) · (degrees[1] + 1)` control points, v running fastest: point (i, j) at `i · (degrees[1] + 1) + j`.
    pub points: Vec<Homogeneous3>,
}

/// Enough for the highest B-spline degree, and for most products, without a heap allocation.
type Row<P> = SmallVec<[P; 26]>;

fn mix<P: Homogeneous>(a: P, b: P, t: f64) -> P {
    a * (1.0 - t) + b * t
}

/// De Casteljau's triangle down to `left` points, which are the first of the row.
fn casteljau<P: Homogeneous>(row: &mut [P], t: f64, left: usize) -> &mut [P] {
    for count in (left..row.len()).rev() {
        for i in 0..count {
            row[i] = mix(row[i], row[i + 1], t);
        }
    }
    let left = left.min(row.len());
    &mut row[..left]
}

/// Value and two derivatives from the last three rows of the triangle.
fn derivatives_of_row<P: Homogeneous>(row: &mut [P], t: f64) -> [P; 3] {
    let n = row.len().saturating_sub(1) as f64;
    let row = casteljau(row, t, 3);
    let second = match row[..] {
        [a, b, c] => (c - b - (b - a)) * (n * (n - 1.0)),
        _ => P::default(),
    };
    let row = casteljau(row, t, 2);
    let first = match row[..] {
        [a, b] => (b - a) * n,
        _ => P::default(),
    };
    [casteljau(row, t, 1)[0], first, second]
}

/// The control points of the two pieces at `t`; they share the middle point.
fn split_row<P: Homogeneous>(points: &[P], t: f64) -> [Vec<P>; 2] {
    let mut right = points.to_vec();
    let mut left = Vec::with_capacity(points.len());
    for last in (0..points.len()).rev() {
        left.push(right[0]);
        for i in 0..last {
            right[i] = mix(right[i], right[i + 1], t);
        }
    }
    // Each row leaves its last point in place, so what remains is the right edge of the triangle.
    [left, right]
}

/// The control points over `[a, b]`.
fn piece_row<P: Homogeneous>(points: &[P], a: f64, b: f64) -> Vec<P> {
    if a > b {
        let mut piece = piece_row(points, b, a);
        piece.reverse();
        return piece;
    }
    // The cut further from its end comes first: it leaves the other cut well conditioned in what remains.
    match (a == 0.0, b == 1.0) {
        (true, true) => points.to_vec(),
        (true, false) => split_row(points, b)[0].clone(),
        (false, true) => split_row(points, a)[1].clone(),
        (false, false) if b > 1.0 - a => split_row(&split_row(points, b)[0], a / b)[1].clone(),
        (false, false) => split_row(&split_row(points, a)[1], (b - a) / (1.0 - a))[0].clone(),
    }
}

impl<P: Homogeneous> Bezier<P> {
    /// The number of control points less one.
    pub fn degree(&self) -> usize {
        self.points.len() - 1
    }
    /// The homogeneous point at `t`.
    pub fn eval(&self, t: f64) -> P {
        let count = self.points.len();
        if count <= FEW {
            let mut row = [P::default(); FEW];
            row[..count].copy_from_slice(&self.points);
            return casteljau(&mut row[..count], t, 1)[0];
        }
        casteljau(&mut Row::from_slice(&self.points), t, 1)[0]
    }
    /// The homogeneous point at `t` and its first two derivatives.
    pub fn derivatives(&self, t: f64) -> [P; 3] {
        derivatives_of_row(&mut Row::from_slice(&self.points), t)
    }
    /// The two halves at `t`; they share the middle point bit for bit.
    pub fn split(&self, t: f64) -> [Self; 2] {
        split_row(&self.points, t).map(|points| Self { points })
    }
    /// The piece over `[a, b]`, reversed where `a > b`; end points at exactly 0 and 1 are kept bit for bit, and the
    /// other end points are those that [`Self::eval`] gives, so that neighbouring pieces meet bit for bit.
    pub fn piece(&self, a: f64, b: f64) -> Self {
        let mut points = piece_row(&self.points, a, b);
        let last = points.len() - 1;
        for (i, t) in [(0, a), (last, b)] {
            points[i] = match t {
                0.0 => self.points[0],
                1.0 => self.points[last],
                _ => self.eval(t),
            };
        }
        Self { points }
    }
}

impl BezierPatch {
    /// The control point (i, j).
    pub fn point(&self, i: usize, j: usize) -> Homogeneous3 {
        self.points[i * (self.degrees[1] + 1) + j]
    }
    /// Homogeneous value and first partial derivatives at (u, v): `[S, S_u, S_v]`.
    pub fn derivatives(&self, u: f64, v: f64) -> [Homogeneous3; 3] {
        let [s, du, dv, ..] = self.second_derivatives(u, v);
        [s, du, dv]
    }
    /// Homogeneous value, first and second partial derivatives at (u, v): `[S, S_u, S_v, S_uu, S_uv, S_vv]`.
    pub fn second_derivatives(&self, u: f64, v: f64) -> [Homogeneous3; 6] {
        let mut columns: [Row<Homogeneous3>; 3] = Default::default();
        for row in self.points.chunks_exact(self.degrees[1] + 1) {
            let derivatives = derivatives_of_row(&mut Row::from_slice(row), v);
            for k in 0..3 {
                columns[k].push(derivatives[k]);
            }
        }
        let [values, firsts, seconds] = &mut columns;
        let [s, du, duu] = derivatives_of_row(values, u);
        let [dv, duv, _] = derivatives_of_row(firsts, u);
        let [dvv, ..] = derivatives_of_row(seconds, u);
        [s, du, dv, duu, duv, dvv]
    }
    /// The sub-patch over `[u0, u1] × [v0, v1]`, reparameterised to [0, 1]²; neighbouring pieces share their boundary
    /// rows bit for bit.
    pub fn piece(&self, u: [f64; 2], v: [f64; 2]) -> Self {
        let width = self.degrees[1] + 1;
        let cut = |points: Vec<Homogeneous3>, [a, b]: [f64; 2]| Bezier { points }.piece(a, b).points;
        let rows: Vec<_> = self.points.chunks_exact(width).map(|row| cut(row.to_vec(), v)).collect();
        let columns: Vec<_> = (0..width).map(|j| cut(rows.iter().map(|row| row[j]).collect(), u)).collect();
        let points = (0..rows.len()).flat_map(|i| columns.iter().map(move |column| column[i])).collect();
        Self { degrees: self.degrees, points }
    }
}
