//! Knot vectors: checked once, so that every algorithm after may rely on them.

/// A degree and its non-decreasing, clamped knots.
///
/// Invariants: `1 <= degree <= MAX_DEGREE`; knots are finite and non-decreasing; the first and the last `degree + 1`
/// knots are equal; inner knots have multiplicity `<= degree`; the domain is not empty. Unclamped and periodic knots of files are made clamped
/// by knot insertion (`BsplineCurve::new`, `BsplineSurface::new`).
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
    /// A control point or weight is not finite, or a weight is not positive.
    #[error("control point {0} is not finite or its weight is not positive")]
    Point(usize),
}

impl KnotVector {
    /// The highest degree; files and kernels go to 25.
    pub const MAX_DEGREE: usize = 25;
    /// The degree.
    pub fn degree(&self) -> usize {
        self.degree
    }
    /// All knots with their multiplicities.
    pub fn as_slice(&self) -> &[f64] {
        &self.knots
    }
}
