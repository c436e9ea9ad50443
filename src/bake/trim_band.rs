//! The band of a trim segment: the cubic that follows it in the frame of its chord, and a certified bound of what is left.
//!
//! With x and y the chord's coordinates and numerators X, Y over W, the distance `g = y − x − 4 x (1 − x) (b + k (2 x − 1))` times W³ is
//! `(Y − X) W² − 4 X (W − X) (b W + k (2 X − W))`, a polynomial whose degree is three times the curve's. Its Bernstein coefficients over those of W³,
//! which are positive, bound g; halving the curve a few times makes the bound tight. The same with x and y exchanged: the narrower band is taken.

use super::narrow;
use crate::geometry::{Bezier, Homogeneous2};
use crate::numeric::bernstein::{Coefficients, eval, product, split};
use crate::scene::Band;
use glam::DVec2;

/// What the kernels' f32 arithmetic may make of g: each of x and y is off by three roundings of 2⁻²⁴ and x (1 − x) by a few more; less than 32 roundings.
pub(super) const ROUNDING: f64 = 32.0 / (1u64 << 24) as f64;

/// Halvings of the curve for the bound.
const HALVINGS: usize = 2;

/// Places between the ends where the cubic is fitted.
const FITTED: usize = 9;

/// The band of the whole of `curve`, which runs from `low` to `high` up to f32 rounding; both coordinates of the two differ.
pub(super) fn band(curve: &Bezier<Homogeneous2>, low: [f32; 2], high: [f32; 2]) -> Band {
    let [low, high] = [low, high].map(|p| DVec2::from_array(p.map(f64::from)));
    let numerators = curve.points.iter().map(|p| (p.truncate() - low * p.z) / (high - low));
    let (u, v): (Coefficients, Coefficients) = numerators.map(|p| (p.x, p.y)).unzip();
    let weights: Coefficients = curve.points.iter().map(|p| p.z).collect();
    let is_rational = weights.iter().any(|&w| w != 1.0);
    let weights = is_rational.then_some(&weights[..]);
    let by_v = ChordFrame { x: &v, y: &u, weights }.fitted(true);
    let by_u = ChordFrame { x: &u, y: &v, weights }.fitted(false);
    let Fit { frame, band, .. } = if by_u.farthest <= by_v.farthest { by_u } else { by_v };
    let bound = frame.bound(f64::from(band.bulge), f64::from(band.skew)) + ROUNDING;
    Band { half_width: narrow::above(bound), ..band }
}

/// The numerators of a segment in its chord's frame.
#[derive(Clone, Copy)]
struct ChordFrame<'a> {
    x: &'a [f64],
    y: &'a [f64],
    /// Unless all are 1.
    weights: Option<&'a [f64]>,
}

/// A band without its width.
struct Fit<'a> {
    frame: ChordFrame<'a>,
    band: Band,
    /// Of the places that it was fitted to, how far off the farthest is.
    farthest: f64,
}

impl<'a> ChordFrame<'a> {
    /// With the least squares at a few places.
    fn fitted(self, by_v: bool) -> Fit<'a> {
        let place = |i: usize| {
            let t = i as f64 / (FITTED + 1) as f64;
            let w = self.weights.map_or(1.0, |weights| eval(weights, t));
            let (x, y) = (eval(self.x, t) / w, eval(self.y, t) / w);
            let a = 4.0 * x * (1.0 - x);
            [a, a * (2.0 * x - 1.0), y - x]
        };
        let places: [[f64; 3]; FITTED] = std::array::from_fn(|i| place(i + 1));
        let (mut aa, mut ab, mut bb, mut ar, mut br) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for [a, b, r] in places {
            (aa, ab, bb) = (aa + a * a, ab + a * b, bb + b * b);
            (ar, br) = (ar + a * r, br + b * r);
        }
        let determinant = aa * bb - ab * ab;
        let fitted = [(ar * bb - br * ab) / determinant, (br * aa - ar * ab) / determinant];
        let [bulge, skew] = if fitted.iter().all(|c| c.is_finite()) { fitted } else { [0.0; 2] };
        // What the word holds is bounded, not what was fitted.
        let fitted = Band { bulge: narrow::number(bulge), skew: narrow::number(skew), by_v, half_width: 0.0 };
        let band = Band::unpack(fitted.pack());
        let (bulge, skew) = (f64::from(band.bulge), f64::from(band.skew));
        let off = places.map(|[a, b, r]| (r - a * bulge - b * skew).abs());
        Fit { frame: self, band, farthest: greatest(off.into_iter()) }
    }

    /// A bound of |g|.
    fn bound(self, bulge: f64, skew: f64) -> f64 {
        let sum = |a: &[f64], by: f64, b: &[f64]| {
            a.iter().zip(b).map(|(a, b)| a + by * b).collect::<Coefficients>()
        };
        let Self { x, y, weights } = self;
        let ones = Coefficients::from_elem(1.0, 2 * x.len() - 1);
        let w = weights.unwrap_or(&ones[..x.len()]);
        let scaled: Coefficients = w.iter().map(|w| w * (bulge - skew)).collect();
        let cubic = product(&product(x, &sum(w, -1.0, x)), &sum(&scaled, 2.0 * skew, x));
        let w2 = weights.map_or(ones.clone(), |w| product(w, w));
        let g = sum(&product(&sum(y, -1.0, x), &w2), -4.0, &cubic);
        match weights {
            Some(w) => bound_of_quotient(&g, &product(&w2, w), HALVINGS),
            None => bound_of_polynomial(&g, HALVINGS),
        }
    }
}

/// A bound of |numerator / denominator| on [0, 1]; infinite where a coefficient of the denominator is not positive.
fn bound_of_quotient(numerator: &[f64], denominator: &[f64], halvings: usize) -> f64 {
    if halvings > 0 {
        let [n, d] = [numerator, denominator].map(|c| split(c, 0.5));
        let halves = [0, 1].map(|half| bound_of_quotient(&n[half], &d[half], halvings - 1));
        return halves[0].max(halves[1]);
    }
    let quotient = |(n, d): (&f64, &f64)| if *d > 0.0 { n.abs() / d } else { f64::INFINITY };
    greatest(numerator.iter().zip(denominator).map(quotient))
}

/// A bound of |polynomial| on [0, 1].
fn bound_of_polynomial(coefficients: &[f64], halvings: usize) -> f64 {
    if halvings > 0 {
        let [first, second] = split(coefficients, 0.5).map(|half| bound_of_polynomial(&half, halvings - 1));
        return first.max(second);
    }
    greatest(coefficients.iter().map(|c| c.abs()))
}

/// The greatest of numbers from 0 on; infinite where one is no number.
fn greatest(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(0.0, |bound, number| if number.is_nan() { f64::INFINITY } else { bound.max(number) })
}

#[cfg(test)]
mod tests {
    use super::super::trim_tests::Random;
    use super::*;
    use crate::geometry::Homogeneous;
    use std::f64::consts::FRAC_1_SQRT_2;

    fn distance(curve: &Bezier<Homogeneous2>, low: [f32; 2], high: [f32; 2], band: &Band, t: f64) -> f64 {
        let [low, high] = [low, high].map(|p| DVec2::from_array(p.map(f64::from)));
        let p = (curve.eval(t).point() - low) / (high - low);
        let (x, y) = if band.by_v { (p.y, p.x) } else { (p.x, p.y) };
        let slope = f64::from(band.bulge) + f64::from(band.skew) * (2.0 * x - 1.0);
        y - x - 4.0 * x * (1.0 - x) * slope
    }

    fn quarter(radius: f64) -> Bezier<Homogeneous2> {
        let at = |x: f64, y: f64, w: f64| Homogeneous2::new(x * radius * w, y * radius * w, w);
        Bezier { points: vec![at(1.0, 0.0, 1.0), at(1.0, 1.0, FRAC_1_SQRT_2), at(0.0, 1.0, 1.0)] }
    }

    #[test]
    fn curves_stay_in_their_bands() {
        let mut random = Random(9);
        for round in 0..400 {
            let degree = if round < 12 { 25 } else { 2 + round % 6 };
            // Monotone: coordinates of control points in order, weights near 1.
            let mut coordinates = [0, 1].map(|_| {
                let mut row: Vec<f64> = (0..=degree).map(|_| random.next()).collect();
                row.sort_by(f64::total_cmp);
                row
            });
            if round % 2 == 0 {
                coordinates[0].reverse();
            }
            let points: Vec<Homogeneous2> = (0..=degree)
                .map(|i| {
                    let weight = if round % 3 == 0 { 1.0 } else { 0.7 + 0.6 * random.next() };
                    Homogeneous2::new(coordinates[0][i], coordinates[1][i], 1.0) * weight
                })
                .collect();
            let end = |p: &Homogeneous2| p.point().to_array().map(|x| x as f32);
            let (low, high) = (end(&points[0]), end(&points[degree]));
            let curve = Bezier { points };
            let band = band(&curve, low, high);
            let width = f64::from(band.half_width);
            let farthest = (0..=500)
                .map(|i| distance(&curve, low, high, &band, f64::from(i) / 500.0).abs())
                .fold(0.0, f64::max);
            assert!(farthest <= width, "{farthest} {width}");
            assert!(width < 8.0 * farthest + 1e-4, "a loose bound: {farthest} {width}");
        }
    }

    #[test]
    fn quarters_of_circles_have_narrow_bands() {
        let curve = quarter(0.4);
        let band = band(&curve, [0.4, 0.0], [0.0, 0.4]);
        assert!(band.half_width < 0.2, "{band:?}");
        let half = curve.piece(0.0, 0.5);
        let middle = half.points[2].point().to_array().map(|x| x as f32);
        let band = super::band(&half, [0.4, 0.0], middle);
        assert!(band.half_width < 0.006, "{band:?}");
    }
}
