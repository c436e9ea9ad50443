//! Knot vectors: checked once, so that every algorithm after may rely on them.

use crate::numeric::bernstein::MAX_PRODUCT_DEGREE;

/// A degree and its non-decreasing, clamped knots.
///
/// Invariants: `1 <= degree <= MAX_DEGREE`; knots are finite and non-decreasing; the first and the last `degree + 1`
/// knots are equal; inner knots have multiplicity `<= degree`; the domain is not empty. Unclamped and periodic knots
/// of files are made clamped by knot insertion
/// (`BsplineCurve::new`, `BsplineSurface::new`).
#[derive(Debug, Clone, PartialEq)]
pub struct KnotVector {
    degree: usize,
    knots: Vec<f64>,
}

/// Why a knot vector is no good.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum KnotError {
    /// Degree 0 or above the limit.
    #[error("degree {0} is not between 1 and {max}", max = KnotVector::MAX_DEGREE)]
    Degree(usize),
    /// Not as many knots as control points and degree ask for.
    #[error("{knots} knots do not fit degree {degree} and {points} control points")]
    Count {
        /// Given.
        knots: usize,
        /// Given.
        degree: usize,
        /// Given.
        points: usize,
    },
    /// A knot is below its predecessor or not finite.
    #[error("knot {0} is not finite or below its predecessor")]
    Order(usize),
    /// All knots are equal.
    #[error("the knots span no interval")]
    Empty,
    /// The pieces before and after a knot of multiplicity `degree + 1` or more do not meet.
    #[error("the pieces at knot {0} do not meet")]
    Discontinuous(usize),
    /// A control point or weight is not finite, or a weight is not positive.
    #[error("control point {0} is not finite or its weight is not positive")]
    Point(usize),
}

const _: () = assert!(MAX_PRODUCT_DEGREE == 3 * KnotVector::MAX_DEGREE);

/// Room for the basis functions of every degree.
pub(super) const MANY: usize = KnotVector::MAX_DEGREE + 1;
/// Room for those of all but the oddest degrees: arrays this short make evaluation a fifth faster.
pub(super) const FEW: usize = 8;

/// The basis functions that do not vanish at one parameter, with their derivatives.
#[derive(Debug, Clone, Copy)]
pub(super) struct Basis<const N: usize> {
    /// The index of the first of the `degree + 1` functions.
    pub first: usize,
    /// `values[k][r]`: the k-th derivative of function `first + r`.
    pub values: [[f64; N]; 3],
}

impl KnotVector {
    /// The highest degree; files and kernels go to 25.
    pub const MAX_DEGREE: usize = 25;

    /// Knots that are clamped already, for `points` control points.
    pub fn new(degree: usize, knots: Vec<f64>, points: usize) -> Result<Self, KnotError> {
        Self::check(degree, &knots, points)?;
        let last = knots.len() - 1;
        let clamped = knots[degree] == knots[0] && knots[last - degree] == knots[last];
        let inner = &knots[degree + 1..last - degree];
        if !clamped {
            return Err(KnotError::Order(0));
        }
        match inner.windows(degree + 1).position(|w| w[0] == w[degree]) {
            Some(i) => Err(KnotError::Discontinuous(degree + 1 + i)),
            None if inner.first() == Some(&knots[0]) => Err(KnotError::Discontinuous(degree + 1)),
            None if inner.last() == Some(&knots[last]) => Err(KnotError::Discontinuous(last - degree - 1)),
            None => Ok(Self { degree, knots }),
        }
    }

    /// Whether `knots` make a B-spline with `points` control points, clamped or not.
    pub(super) fn check(degree: usize, knots: &[f64], points: usize) -> Result<(), KnotError> {
        if !(1..=Self::MAX_DEGREE).contains(&degree) {
            return Err(KnotError::Degree(degree));
        }
        if points <= degree || knots.len() != points + degree + 1 {
            return Err(KnotError::Count { knots: knots.len(), degree, points });
        }
        let disorder = |i: &usize| !knots[*i].is_finite() || (*i > 0 && knots[*i] < knots[*i - 1]);
        if let Some(i) = (0..knots.len()).find(disorder) {
            return Err(KnotError::Order(i));
        }
        let length = knots[points] - knots[degree];
        // A sum of two differences occurs in the basis recurrence: it has to be finite as well.
        if !(length > 0.0 && (2.0 * (knots[knots.len() - 1] - knots[0])).is_finite()) {
            return Err(KnotError::Empty);
        }
        Ok(())
    }

    /// The degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// All knots with their multiplicities.
    pub fn as_slice(&self) -> &[f64] {
        &self.knots
    }

    /// How many control points there are.
    pub fn point_count(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// First and last parameter.
    pub fn domain(&self) -> [f64; 2] {
        [self.knots[0], self.knots[self.knots.len() - 1]]
    }

    /// The span `k` with `knots[k] <= t < knots[k + 1]`; the first and the last one for parameters outside (A2.1).
    pub fn find_span(&self, t: f64) -> usize {
        self.knots
            .partition_point(|knot| *knot <= t)
            .saturating_sub(1)
            .clamp(self.degree, self.point_count() - 1)
    }

    /// The non-empty spans, as indices of their lower knots.
    pub fn spans(&self) -> impl Iterator<Item = usize> + '_ {
        (self.degree..self.point_count()).filter(|k| self.knots[*k] < self.knots[k + 1])
    }

    /// The knots strictly inside the domain with their multiplicities.
    pub fn inner_knots(&self) -> impl Iterator<Item = (f64, usize)> + '_ {
        let inner = &self.knots[self.degree + 1..self.point_count()];
        inner.chunk_by(|a, b| a == b).map(|group| (group[0], group.len()))
    }

    /// The basis functions at `t` (inside the domain) and their derivatives up to `order <= 2`; `N > degree`.
    ///
    /// The Cox-de Boor triangle (A2.2) passes through the functions of degrees p − 2 and p − 1 on its way, and the
    /// derivatives are differences of those (equation 2.7): cheaper than the general A2.3.
    #[inline]
    pub(super) fn basis<const N: usize>(&self, t: f64, order: usize) -> Basis<N> {
        let (p, k, knots) = (self.degree, self.find_span(t), &self.knots[..]);
        let mut row = [0.0; N];
        let mut lower = [[0.0; N]; 2];
        row[0] = 1.0;
        for degree in 1..=p {
            if p - degree < order.min(2) {
                lower[p - degree][..degree].copy_from_slice(&row[..degree]);
            }
            let mut saved = 0.0;
            for r in 0..degree {
                let (right, left) = (knots[k + 1 + r], knots[k + 1 + r - degree]);
                let share = row[r] / (right - left);
                row[r] = saved + (right - t) * share;
                saved = (t - left) * share;
            }
            row[degree] = saved;
        }
        let mut values = [row, [0.0; N], [0.0; N]];
        if order >= 1 {
            values[1] = raise(knots, k, p, &lower[0]);
        }
        if order >= 2 && p >= 2 {
            values[2] = raise(knots, k, p, &raise(knots, k, p - 1, &lower[1]));
        }
        Basis { first: k - p, values }
    }
}

/// Equation 2.7: coefficients over the functions of degree `p − 1` at span `k` to the derivatives of those of degree `p`.
fn raise<const N: usize>(knots: &[f64], k: usize, p: usize, lower: &[f64; N]) -> [f64; N] {
    let mut raised = [0.0; N];
    let mut before = 0.0;
    for r in 0..p {
        let after = p as f64 * lower[r] / (knots[k + 1 + r] - knots[k + 1 + r - p]);
        raised[r] = before - after;
        before = after;
    }
    raised[p] = before;
    raised
}
