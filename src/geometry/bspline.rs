//! Rational B-spline curves and surfaces (Piegl & Tiller, The NURBS Book).

use super::bezier::{Homogeneous, Homogeneous3};
use super::blossom::{clamp_end, clamp_start, clamped, reversed};
use super::knots::{Basis, FEW, KnotError, KnotVector, MANY};
use super::surface::SurfaceDerivatives;
use glam::{DVec2, DVec3, DVec4};

/// Ends closer than this share of the size of the control points count as the same.
const CLOSED: f64 = 1e-7;
/// Pieces at a knot of too high multiplicity meet where they are closer than this share of the size.
const MEETING: f64 = 1e-6;

/// A rational B-spline curve in homogeneous control points.
#[derive(Debug, Clone, PartialEq)]
pub struct BsplineCurve<P> {
    /// Degree and knots.
    pub knots: KnotVector,
    /// One per basis function.
    pub points: Vec<P>,
}

/// A rational B-spline surface in homogeneous control points.
#[derive(Debug, Clone, PartialEq)]
pub struct BsplineSurface {
    /// Along u.
    pub u_knots: KnotVector,
    /// Along v.
    pub v_knots: KnotVector,
    /// v running fastest: point (i, j) at `i · count_v + j`.
    pub points: Vec<Homogeneous3>,
    /// Whether the surface closes on itself along u and v: `S(u_min, v) = S(u_max, v)` for all v.
    pub closed: [bool; 2],
}

impl<P: Homogeneous> BsplineCurve<P> {
    /// A curve from a degree, a full knot vector (any, also unclamped or periodic: it is clamped by knot insertion) and
    /// control points.
    pub fn new(degree: usize, knots: Vec<f64>, points: Vec<P>) -> Result<Self, KnotError> {
        KnotVector::check(degree, &knots, points.len())?;
        check_points(&points)?;
        let tolerance = MEETING * size(&points);
        let (knots, points) = clamped(degree, &knots, &points, tolerance)?;
        Ok(Self { knots: KnotVector::new(degree, knots, points.len())?, points })
    }
    /// First and last parameter.
    pub fn domain(&self) -> [f64; 2] {
        self.knots.domain()
    }
    /// The homogeneous point at `t`, clamped to the domain.
    pub fn eval(&self, t: f64) -> P {
        let [value] = if self.knots.degree() < FEW { self.jet::<FEW, 1>(t) } else { self.jet::<MANY, 1>(t) };
        value
    }
    /// The homogeneous point at `t`, clamped to the domain, and its first two derivatives.
    pub fn derivatives(&self, t: f64) -> [P; 3] {
        if self.knots.degree() < FEW { self.jet::<FEW, 3>(t) } else { self.jet::<MANY, 3>(t) }
    }
    /// The first `COUNT` of value, first and second derivative; `N` is above the degree.
    fn jet<const N: usize, const COUNT: usize>(&self, t: f64) -> [P; COUNT] {
        let [first, last] = self.domain();
        let p = self.knots.degree();
        let basis = self.knots.basis::<N>(t.clamp(first, last), COUNT - 1);
        let points = &self.points[basis.first..=basis.first + p];
        std::array::from_fn(|k| combine(&basis.values[k][..=p], points))
    }
    /// Whether the end is where the start is, within 1e-7 of the size of the control polygon.
    pub fn is_closed(&self) -> bool {
        self.points[0].separation(self.points[self.points.len() - 1]) <= CLOSED * size(&self.points)
    }
    /// The same curve over `[a, b]`, clamped to the domain; run backwards, over `[−a, −b]`, where `a > b`. `None` where
    /// nothing of the range lies in the domain.
    pub fn piece(&self, a: f64, b: f64) -> Option<Self> {
        let [first, last] = self.domain();
        let (low, high) = (a.min(b).max(first), a.max(b).min(last));
        if low >= high {
            return None;
        }
        let degree = self.knots.degree();
        let (knots, points) = clamp_start(degree, self.knots.as_slice(), &self.points, low);
        let (knots, points) = clamp_end(degree, &knots, &points, high);
        let (knots, points) = if a > b { reversed(&knots, &points) } else { (knots, points) };
        let knots = KnotVector::new(degree, knots, points.len()).ok()?;
        Some(Self { knots, points })
    }
}

impl BsplineSurface {
    /// A surface from degrees, full knot vectors (any; clamped by knot insertion) and control points, v fastest.
    /// Detects `closed` within 1e-7 of the control net's size.
    pub fn new(
        degrees: [usize; 2],
        knots: [Vec<f64>; 2],
        points: Vec<Homogeneous3>,
    ) -> Result<Self, KnotError> {
        let [u_knots, v_knots] = knots;
        let [u_degree, v_degree] = degrees;
        let count = |knots: &[f64], degree: usize| knots.len().saturating_sub(degree.saturating_add(1));
        let (u_count, v_count) = (count(&u_knots, u_degree), count(&v_knots, v_degree));
        KnotVector::check(u_degree, &u_knots, u_count)?;
        KnotVector::check(v_degree, &v_knots, v_count)?;
        if u_count.checked_mul(v_count) != Some(points.len()) {
            return Err(KnotError::Count {
                knots: u_knots.len(),
                degree: u_degree,
                points: points.len() / v_count,
            });
        }
        check_points(&points)?;
        let tolerance = MEETING * size(&points);
        let (v_knots, points) = clamp_rows(v_degree, &v_knots, &points, tolerance)?;
        let points = transposed(&points, points.len() / u_count);
        let (u_knots, points) = clamp_rows(u_degree, &u_knots, &points, tolerance)?;
        let u_count = u_knots.len() - u_degree - 1;
        let points = transposed(&points, u_count);
        let v_count = points.len() / u_count;
        let u_knots = KnotVector::new(u_degree, u_knots, u_count)?;
        let v_knots = KnotVector::new(v_degree, v_knots, v_count)?;
        Ok(Self::from_parts(u_knots, v_knots, points))
    }

    /// A surface from good knots and as many control points as they ask for.
    pub(super) fn from_parts(u_knots: KnotVector, v_knots: KnotVector, points: Vec<Homogeneous3>) -> Self {
        let mut surface = Self { u_knots, v_knots, points, closed: [false; 2] };
        surface.closed = surface.find_closed();
        surface
    }

    /// The same surface over `u × v`, clamped to the domain; `None` where nothing of it is left.
    pub fn piece(&self, u: [f64; 2], v: [f64; 2]) -> Option<Self> {
        let [u_degree, v_degree] = [self.u_knots.degree(), self.v_knots.degree()];
        let (v_knots, points) = piece_rows(&self.v_knots, &self.points, v)?;
        let points = transposed(&points, v_knots.len() - v_degree - 1);
        let (u_knots, points) = piece_rows(&self.u_knots, &points, u)?;
        let u_count = u_knots.len() - u_degree - 1;
        let points = transposed(&points, u_count);
        let v_count = points.len() / u_count;
        let u_knots = KnotVector::new(u_degree, u_knots, u_count).ok()?;
        let v_knots = KnotVector::new(v_degree, v_knots, v_count).ok()?;
        Some(Self::from_parts(u_knots, v_knots, points))
    }

    /// How many control points there are along u and v.
    pub fn counts(&self) -> [usize; 2] {
        [self.u_knots.point_count(), self.v_knots.point_count()]
    }

    /// The control points of a side of the net: `axis` 0 for the sides u = const, 1 for v = const.
    pub fn side(&self, axis: usize, last: bool) -> impl Iterator<Item = Homogeneous3> + '_ {
        let [u_count, v_count] = self.counts();
        let (start, step, length) = match (axis, last) {
            (0, false) => (0, 1, v_count),
            (0, true) => ((u_count - 1) * v_count, 1, v_count),
            (_, false) => (0, v_count, u_count),
            (_, true) => (v_count - 1, v_count, u_count),
        };
        (0..length).map(move |i| self.points[start + i * step])
    }

    /// The greatest distance between the first and another control point: between half the diameter and all of it.
    pub fn size(&self) -> f64 {
        size(&self.points)
    }

    /// Sides coincide as curves where their points coincide and their weights are proportional.
    fn find_closed(&self) -> [bool; 2] {
        let tolerance = CLOSED * self.size();
        std::array::from_fn(|axis| {
            let mut pairs = self.side(axis, false).zip(self.side(axis, true)).peekable();
            let ratio = pairs.peek().map_or(1.0, |(a, b)| b.w / a.w);
            pairs.all(|(a, b)| a.separation(b) <= tolerance && (b.w - ratio * a.w).abs() <= CLOSED * b.w)
                && self.is_wide(axis, tolerance)
        })
    }

    /// Whether the surface goes anywhere along `axis`: a strip whose sides are as near as its width is not closed.
    fn is_wide(&self, axis: usize, tolerance: f64) -> bool {
        let v_count = self.v_knots.point_count();
        let start = |i: usize| if axis == 0 { i % v_count } else { i - i % v_count };
        (0..self.points.len()).any(|i| self.points[i].separation(self.points[start(i)]) > 16.0 * tolerance)
    }

    /// Lowest and highest u and v.
    pub fn domain(&self) -> super::ParameterBox {
        let ([u0, u1], [v0, v1]) = (self.u_knots.domain(), self.v_knots.domain());
        super::ParameterBox { min: DVec2::new(u0, v0), max: DVec2::new(u1, v1) }
    }

    /// Value and derivatives up to second order, (u, v) clamped to the domain.
    pub fn derivatives(&self, uv: DVec2) -> SurfaceDerivatives {
        if self.u_knots.degree().max(self.v_knots.degree()) < FEW {
            self.derivatives_of::<FEW>(uv)
        } else {
            self.derivatives_of::<MANY>(uv)
        }
    }

    fn derivatives_of<const N: usize>(&self, uv: DVec2) -> SurfaceDerivatives {
        let (u, v) = self.bases::<N>(uv, 2);
        let [p, q] = [self.u_knots.degree(), self.v_knots.degree()];
        let v_count = self.v_knots.point_count();
        let mut sums = [DVec4::ZERO; 6];
        for i in 0..=p {
            let start = (u.first + i) * v_count + v.first;
            let mut row = [DVec4::ZERO; 3];
            for (j, point) in self.points[start..=start + q].iter().enumerate() {
                row[0] += *point * v.values[0][j];
                row[1] += *point * v.values[1][j];
                row[2] += *point * v.values[2][j];
            }
            let [b0, b1, b2] = u.values.map(|values| values[i]);
            sums[0] += row[0] * b0;
            sums[1] += row[0] * b1;
            sums[2] += row[1] * b0;
            sums[3] += row[0] * b2;
            sums[4] += row[1] * b1;
            sums[5] += row[2] * b0;
        }
        project(&sums)
    }

    /// The point at `uv`, clamped to the domain.
    pub fn point(&self, uv: DVec2) -> DVec3 {
        if self.u_knots.degree().max(self.v_knots.degree()) < FEW {
            self.point_of::<FEW>(uv)
        } else {
            self.point_of::<MANY>(uv)
        }
    }

    fn point_of<const N: usize>(&self, uv: DVec2) -> DVec3 {
        let (u, v) = self.bases::<N>(uv, 0);
        let [p, q] = [self.u_knots.degree(), self.v_knots.degree()];
        let v_count = self.v_knots.point_count();
        let row = |i: usize| {
            let start = (u.first + i) * v_count + v.first;
            combine(&v.values[0][..=q], &self.points[start..=start + q]) * u.values[0][i]
        };
        Homogeneous::point((0..=p).map(row).fold(DVec4::ZERO, |sum, term| sum + term))
    }

    fn bases<const N: usize>(&self, uv: DVec2, order: usize) -> (Basis<N>, Basis<N>) {
        let ([u0, u1], [v0, v1]) = (self.u_knots.domain(), self.v_knots.domain());
        (self.u_knots.basis(uv.x.clamp(u0, u1), order), self.v_knots.basis(uv.y.clamp(v0, v1), order))
    }
}

/// The derivatives of the quotient from those of the homogeneous function `[A, A_u, A_v, A_uu, A_uv, A_vv]`, by the
/// product rule on `A = w S` (The NURBS Book, equation 4.20).
pub(super) fn project(sums: &[DVec4; 6]) -> SurfaceDerivatives {
    let [a, au, av, auu, auv, avv] = sums;
    let inverse = 1.0 / a.w;
    let point = a.truncate() * inverse;
    let du = (au.truncate() - point * au.w) * inverse;
    let dv = (av.truncate() - point * av.w) * inverse;
    SurfaceDerivatives {
        point,
        du,
        dv,
        duu: (auu.truncate() - du * (2.0 * au.w) - point * auu.w) * inverse,
        duv: (auv.truncate() - dv * au.w - du * av.w - point * auv.w) * inverse,
        dvv: (avv.truncate() - dv * (2.0 * av.w) - point * avv.w) * inverse,
    }
}

fn combine<P: Homogeneous>(weights: &[f64], points: &[P]) -> P {
    weights.iter().zip(points).fold(P::default(), |sum, (weight, point)| sum + *point * *weight)
}

fn check_points<P: Homogeneous>(points: &[P]) -> Result<(), KnotError> {
    // Differences of coordinates are squared and divided by weights on the way: beyond this they may overflow.
    let good = |p: &P| Homogeneous::is_finite(*p) && p.weight() > 0.0 && p.separation(points[0]).is_finite();
    points.iter().position(|p| !good(p)).map_or(Ok(()), |i| Err(KnotError::Point(i)))
}

/// The greatest distance from the first control point: between half the diameter and all of it.
fn size<P: Homogeneous>(points: &[P]) -> f64 {
    points.iter().map(|p| p.separation(points[0])).fold(0.0, f64::max)
}

fn clamp_rows(
    degree: usize,
    knots: &[f64],
    points: &[Homogeneous3],
    tolerance: f64,
) -> Result<(Vec<f64>, Vec<Homogeneous3>), KnotError> {
    let mut clamped_knots = Vec::new();
    let mut clamped_points = Vec::with_capacity(points.len());
    for row in points.chunks_exact(knots.len() - degree - 1) {
        let (row_knots, row_points) = clamped(degree, knots, row, tolerance)?;
        clamped_knots = row_knots;
        clamped_points.extend(row_points);
    }
    Ok((clamped_knots, clamped_points))
}

fn piece_rows(
    knots: &KnotVector,
    points: &[Homogeneous3],
    [a, b]: [f64; 2],
) -> Option<(Vec<f64>, Vec<Homogeneous3>)> {
    let [first, last] = knots.domain();
    let (low, high) = (a.max(first), b.min(last));
    if low >= high {
        return None;
    }
    let mut cut_knots = Vec::new();
    let mut cut_points = Vec::new();
    for row in points.chunks_exact(knots.point_count()) {
        let (row_knots, row_points) = clamp_start(knots.degree(), knots.as_slice(), row, low);
        let (row_knots, row_points) = clamp_end(knots.degree(), &row_knots, &row_points, high);
        cut_knots = row_knots;
        cut_points.extend(row_points);
    }
    Some((cut_knots, cut_points))
}

/// Columns of rows of length `width`, one after the other.
pub(super) fn transposed<T: Copy>(points: &[T], width: usize) -> Vec<T> {
    (0..width).flat_map(|j| points[j..].iter().step_by(width).copied()).collect()
}
