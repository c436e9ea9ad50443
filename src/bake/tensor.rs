//! Scalar polynomials on [0, 1]² in Bernstein form: products, differences and ranges, for bounds of rational derivatives.

/// Degrees and coefficients, v running fastest.
#[derive(Debug, Clone)]
pub(super) struct Tensor {
    degrees: [usize; 2],
    coefficients: Vec<f64>,
}

impl Tensor {
    /// From coefficients, v running fastest.
    pub(super) fn new(degrees: [usize; 2], coefficients: Vec<f64>) -> Self {
        debug_assert_eq!(coefficients.len(), (degrees[0] + 1) * (degrees[1] + 1));
        Self { degrees, coefficients }
    }

    /// The constant 1, with the given degrees.
    fn one(degrees: [usize; 2]) -> Self {
        Self::new(degrees, vec![1.0; (degrees[0] + 1) * (degrees[1] + 1)])
    }

    fn at(&self, i: usize, j: usize) -> f64 {
        self.coefficients[i * (self.degrees[1] + 1) + j]
    }

    /// The partial derivative along an axis; the zero constant where it does not depend on it.
    pub(super) fn derivative(&self, axis: usize) -> Self {
        let degree = self.degrees[axis];
        if degree == 0 {
            return Self::new(self.degrees, vec![0.0; self.coefficients.len()]);
        }
        let mut degrees = self.degrees;
        degrees[axis] -= 1;
        let step = [1 - axis, axis];
        let difference = |i: usize, j: usize| self.at(i + step[0], j + step[1]) - self.at(i, j);
        let coefficients = (0..=degrees[0])
            .flat_map(|i| (0..=degrees[1]).map(move |j| (i, j)))
            .map(|(i, j)| degree as f64 * difference(i, j))
            .collect();
        Self::new(degrees, coefficients)
    }

    /// The product; degrees add up.
    pub(super) fn times(&self, other: &Self) -> Self {
        let [p, q] = self.degrees;
        let [r, s] = other.degrees;
        let [across, down] = [product_weights(p, r), product_weights(q, s)];
        let mut out = vec![0.0; (p + r + 1) * (q + s + 1)];
        for i in 0..=p {
            for k in 0..=r {
                for j in 0..=q {
                    let scaled = self.at(i, j) * across[i * (r + 1) + k];
                    for l in 0..=s {
                        out[(i + k) * (q + s + 1) + j + l] += scaled * other.at(k, l) * down[j * (s + 1) + l];
                    }
                }
            }
        }
        Self::new([p + r, q + s], out)
    }

    /// The difference, after raising both to the greater degrees.
    pub(super) fn minus(&self, other: &Self) -> Self {
        let degrees = [0, 1].map(|k| self.degrees[k].max(other.degrees[k]));
        let (a, b) = (self.raised(degrees), other.raised(degrees));
        let coefficients = a.coefficients.iter().zip(&b.coefficients).map(|(x, y)| x - y).collect();
        Self::new(degrees, coefficients)
    }

    fn raised(&self, degrees: [usize; 2]) -> Self {
        self.times(&Self::one([0, 1].map(|k| degrees[k] - self.degrees[k])))
    }

    /// A number that the absolute value never exceeds on [0, 1]².
    pub(super) fn greatest(&self) -> f64 {
        self.coefficients.iter().fold(0.0, |most, c| most.max(c.abs()))
    }

    /// A number that the value never falls below on [0, 1]².
    pub(super) fn least(&self) -> f64 {
        self.coefficients.iter().fold(f64::INFINITY, |least, &c| least.min(c))
    }
}

/// `C(m, i) C(n, k) / C(m + n, i + k)` at `i · (n + 1) + k`: the weights of a product in Bernstein form.
fn product_weights(m: usize, n: usize) -> Vec<f64> {
    let row = |degree: usize| {
        let mut row = vec![1.0; degree + 1];
        for i in 1..=degree {
            row[i] = row[i - 1] * (degree - i + 1) as f64 / i as f64;
        }
        row
    };
    let (a, b, sum) = (row(m), row(n), row(m + n));
    (0..=m).flat_map(|i| (0..=n).map(move |k| (i, k))).map(|(i, k)| a[i] * b[k] / sum[i + k]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn eval(t: &Tensor, u: f64, v: f64) -> f64 {
        let basis = |n: usize, x: f64| -> Vec<f64> {
            let weights = product_weights(0, n);
            let binomial = |i: usize| (0..i).fold(1.0, |c, k| c * (n - k) as f64 / (k + 1) as f64);
            (0..=n)
                .map(|i| weights[i] * binomial(i) * x.powi(i as i32) * (1.0 - x).powi((n - i) as i32))
                .collect()
        };
        let (a, b) = (basis(t.degrees[0], u), basis(t.degrees[1], v));
        (0..a.len()).map(|i| (0..b.len()).map(|j| a[i] * b[j] * t.at(i, j)).sum::<f64>()).sum()
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
            assert!((eval(&a.minus(&b), u, v) - (x - y)).abs() < 1e-12);
            assert!(a.greatest() >= x.abs() && a.least() <= x);
            let h = 1e-6;
            let slope = (eval(&b, u, v + h) - eval(&b, u, v - h)) / (2.0 * h);
            assert!((eval(&b.derivative(1), u, v) - slope).abs() < 1e-7);
        }
    }
}
