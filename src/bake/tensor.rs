//! Polynomials on [0, 1]², of numbers or of vectors, in scaled Bernstein form: products, differences and ranges, for bounds of rational derivatives.
//!
//! Coefficients carry their binomials, `C(p, i) C(q, j) c_ij`: a product is then a plain convolution (Farouki & Rajan 1988; Sánchez-Reyes 2003), and
//! a derivative takes whole numbers only. Bounds are those of `c_ij`: a polynomial stays between its least and its greatest Bernstein coefficient.
//! Those of a vector's coordinates are found together.

use glam::DVec4;
use std::ops::{AddAssign, Mul, Sub};

/// What a polynomial's values are.
pub(super) trait Value:
    Copy + Default + AddAssign + Sub<Output = Self> + Mul<f64, Output = Self>
{
    /// Of each coordinate the size, or that of `other` unless it is smaller; not a number where either is none, so that no bound forgets it.
    fn greatest(self, other: Self) -> Self;
}

impl Value for f64 {
    fn greatest(self, other: Self) -> Self {
        let [own, other] = [self, other].map(f64::abs);
        if own.is_nan() || other <= own { own } else { other }
    }
}

impl Value for DVec4 {
    fn greatest(self, other: Self) -> Self {
        let [own, other] = [self, other].map(Self::abs);
        Self::select(own.is_nan_mask() | other.cmple(own), own, other)
    }
}

/// Degrees and scaled coefficients, v running fastest.
#[derive(Debug, Clone)]
pub(super) struct Tensor<T = f64> {
    degrees: [usize; 2],
    scaled: Vec<T>,
}

impl<T: Value> Tensor<T> {
    /// From Bernstein coefficients, v running fastest.
    pub(super) fn new(degrees: [usize; 2], mut coefficients: Vec<T>) -> Self {
        debug_assert_eq!(coefficients.len(), (degrees[0] + 1) * (degrees[1] + 1));
        scale_rows(degrees, &mut coefficients, |c, binomial| *c = *c * binomial);
        Self { degrees, scaled: coefficients }
    }

    /// The partial derivative along an axis; the zero constant where it does not depend on it.
    ///
    /// `p C(p−1, i) (c_{i+1} − c_i)` is `(i + 1) s_{i+1} − (p − i) s_i` in the scaled coefficients s.
    pub(super) fn derivative(&self, axis: usize) -> Self {
        let degree = self.degrees[axis];
        if degree == 0 {
            return Self { degrees: self.degrees, scaled: vec![T::default(); self.scaled.len()] };
        }
        let mut degrees = self.degrees;
        degrees[axis] -= 1;
        let width = self.degrees[1] + 1;
        let step = if axis == 0 { width } else { 1 };
        let mut scaled = Vec::with_capacity((degrees[0] + 1) * (degrees[1] + 1));
        for i in 0..=degrees[0] {
            for j in 0..=degrees[1] {
                let (at, k) = (i * width + j, if axis == 0 { i } else { j });
                scaled.push(self.scaled[at + step] * (k + 1) as f64 - self.scaled[at] * (degree - k) as f64);
            }
        }
        Self { degrees, scaled }
    }

    /// The product; degrees add up.
    pub(super) fn times(&self, other: &Tensor) -> Self {
        let [p, q] = self.degrees;
        let [r, s] = other.degrees;
        let width = q + s + 1;
        let mut scaled = vec![T::default(); (p + r + 1) * width];
        for i in 0..=p {
            for k in 0..=r {
                let theirs = &other.scaled[k * (s + 1)..(k + 1) * (s + 1)];
                for j in 0..=q {
                    let mine = self.scaled[i * (q + 1) + j];
                    let start = (i + k) * width + j;
                    for (sum, &theirs) in scaled[start..=start + s].iter_mut().zip(theirs) {
                        *sum += mine * theirs;
                    }
                }
            }
        }
        Self { degrees: [p + r, q + s], scaled }
    }

    /// The difference, after raising both to the greater degrees.
    pub(super) fn minus(self, other: Self) -> Self {
        let degrees = [0, 1].map(|k| self.degrees[k].max(other.degrees[k]));
        let (mut difference, other) = (self.raised(degrees), other.raised(degrees));
        for (mine, theirs) in difference.scaled.iter_mut().zip(other.scaled) {
            *mine = *mine - theirs;
        }
        difference
    }

    fn raised(self, degrees: [usize; 2]) -> Self {
        if degrees == self.degrees {
            return self;
        }
        let by = [0, 1].map(|k| degrees[k] - self.degrees[k]);
        self.times(&Tensor::new(by, vec![1.0; (by[0] + 1) * (by[1] + 1)]))
    }

    /// What the distance of the value from `center` never exceeds on [0, 1]², coordinate by coordinate.
    pub(super) fn farthest_from(self, center: T) -> T {
        self.coefficients().into_iter().fold(T::default(), |most, c| most.greatest(c - center))
    }

    fn coefficients(self) -> Vec<T> {
        let mut coefficients = self.scaled;
        scale_rows(self.degrees, &mut coefficients, |c, binomial| *c = *c * (1.0 / binomial));
        coefficients
    }
}

impl Tensor {
    /// Multiplied by a number, or by a vector.
    pub(super) fn scaled_by<T: Value>(&self, factor: T) -> Tensor<T> {
        Tensor { degrees: self.degrees, scaled: self.scaled.iter().map(|&c| factor * c).collect() }
    }
}

/// Calls `apply` for each coefficient with its binomial `C(p, i) C(q, j)`.
fn scale_rows<T>(degrees: [usize; 2], coefficients: &mut [T], apply: impl Fn(&mut T, f64)) {
    // From each binomial follows the next; all are whole numbers below 2⁵³ up to degree 56.
    let mut across = 1.0;
    for (i, row) in coefficients.chunks_exact_mut(degrees[1] + 1).enumerate() {
        let mut along = 1.0;
        for (j, c) in row.iter_mut().enumerate() {
            apply(c, across * along);
            along = along * (degrees[1] - j) as f64 / (j + 1) as f64;
        }
        across = across * (degrees[0] - i) as f64 / (i + 1) as f64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn eval(t: &Tensor, u: f64, v: f64) -> f64 {
        let [p, q] = t.degrees;
        let power = |n: usize, i: usize, x: f64| x.powi(i as i32) * (1.0 - x).powi((n - i) as i32);
        let term = |i: usize, j: usize| t.scaled[i * (q + 1) + j] * power(p, i, u) * power(q, j, v);
        (0..=p).flat_map(|i| (0..=q).map(move |j| (i, j))).map(|(i, j)| term(i, j)).sum()
    }

    #[test]
    fn arithmetic_agrees_with_values() {
        let mut random = super::super::trim_tests::Random(9);
        let mut tensor =
            |p: usize, q: usize| Tensor::new([p, q], (0..(p + 1) * (q + 1)).map(|_| random.next()).collect());
        let (a, b) = (tensor(3, 2), tensor(1, 4));
        for (u, v) in [(0.0, 0.0), (0.3, 0.8), (1.0, 0.5)] {
            let (x, y) = (eval(&a, u, v), eval(&b, u, v));
            assert!((eval(&a.times(&b), u, v) - x * y).abs() < 1e-12);
            assert!((eval(&a.clone().minus(b.clone()), u, v) - (x - y)).abs() < 1e-12);
            assert!((eval(&a.scaled_by(3.0), u, v) - 3.0 * x).abs() < 1e-12);
            assert!(a.clone().farthest_from(0.2) >= (x - 0.2).abs());
            let h = 1e-6;
            let slopes = [
                (eval(&b, u + h, v) - eval(&b, u - h, v)) / (2.0 * h),
                (eval(&b, u, v + h) - eval(&b, u, v - h)) / (2.0 * h),
            ];
            for (axis, slope) in slopes.into_iter().enumerate() {
                assert!((eval(&b.derivative(axis), u, v) - slope).abs() < 1e-7);
            }
        }
    }

    #[test]
    fn bounds_are_those_of_bernstein_coefficients() {
        let t = Tensor::new([2, 1], vec![0.0, 1.0, -3.0, 2.0, 5.0, 0.5]);
        assert_eq!(t.clone().farthest_from(2.0), 5.0);
        assert_eq!(t.farthest_from(1.0), 4.0);
    }

    #[test]
    fn coordinates_of_vectors_are_bounded_each_by_itself() {
        let mut random = super::super::trim_tests::Random(4);
        let mut numbers = |count: usize| -> Vec<f64> { (0..count).map(|_| random.next()).collect() };
        let (x, y) = (Tensor::new([2, 3], numbers(12)), Tensor::new([2, 3], numbers(12)));
        let weight = Tensor::new([1, 2], numbers(6));
        let pairs = x.scaled.iter().zip(&y.scaled);
        let both = pairs.map(|(&x, &y)| DVec4::new(x, y, 0.0, 0.0)).collect();
        let both = Tensor { degrees: [2, 3], scaled: both };
        let center = DVec4::new(0.5, -0.25, 0.0, 0.0);
        let bound = |x: &Tensor, center: f64| x.derivative(1).times(&weight).farthest_from(center);
        let found = both.derivative(1).times(&weight).farthest_from(center);
        assert_eq!([found.x, found.y], [bound(&x, 0.5), bound(&y, -0.25)]);
        let apart = both.minus(weight.scaled_by(center)).farthest_from(DVec4::ZERO);
        assert_eq!(apart.x, x.minus(weight.scaled_by(0.5)).farthest_from(0.0));
        assert_eq!(apart.y, y.minus(weight.scaled_by(-0.25)).farthest_from(0.0));
    }
}
