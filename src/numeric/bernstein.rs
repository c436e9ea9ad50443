//! Polynomials in Bernstein form on [0, 1], coefficients `c[0..=n]`: `Σ c[i] · C(n,i) · t^i (1−t)^(n−i)`.
//!
//! The form is numerically mild on [0, 1] (Farouki & Rajan 1987), its coefficients bound the polynomial, and they have at
//! least as many sign changes as it has roots inside (0, 1), by an even number more (Descartes' rule in this basis).

use super::roots::bracketed_root;
use smallvec::SmallVec;

/// Coefficients, most of the time without a heap allocation.
pub type Coefficients = SmallVec<[f64; 16]>;

/// Of products at most: those of three curves of the highest degree that files and kernels go to.
pub const MAX_PRODUCT_DEGREE: usize = 3 * 25;

/// The value at `t`.
pub fn eval(coefficients: &[f64], t: f64) -> f64 {
    eval_with_derivative(coefficients, t).0
}

/// The value and the first derivative at `t`. No coefficients: 0.
///
/// The last step of de Casteljau's scheme joins the polynomials of the first and of the last n coefficients, `(1 − t) a + t b`, and
/// `n (b − a)` is the derivative. Those two are summed by nested multiplication (Farin 2002, `hornbez`): no triangle, no copy.
pub fn eval_with_derivative(coefficients: &[f64], t: f64) -> (f64, f64) {
    let [first, second, ..] = *coefficients else {
        return (coefficients.first().copied().unwrap_or(0.0), 0.0);
    };
    let lower = coefficients.len() - 2;
    let s = 1.0 - t;
    // Of degree `lower`: binomial(lower, i) · tⁱ.
    let mut share = 1.0;
    let (mut a, mut b) = (first, second);
    for i in 1..=lower {
        share *= t * ((lower - i + 1) as f64 / i as f64);
        a = a * s + share * coefficients[i];
        b = b * s + share * coefficients[i + 1];
    }
    (a * s + b * t, (lower + 1) as f64 * (b - a))
}

/// The derivative, one degree lower; that of a constant is the constant 0.
pub fn derivative(coefficients: &[f64]) -> Coefficients {
    if coefficients.len() < 2 {
        return Coefficients::from_slice(&[0.0]);
    }
    let degree = (coefficients.len() - 1) as f64;
    coefficients.windows(2).map(|pair| degree * (pair[1] - pair[0])).collect()
}

/// The same polynomial, `by` degrees higher.
pub fn elevate(coefficients: &[f64], by: usize) -> Coefficients {
    let mut raised = Coefficients::from_slice(coefficients);
    for _ in 0..by {
        let n = raised.len() as f64;
        let mut next = raised.clone();
        next.push(raised.last().copied().unwrap_or(0.0));
        for i in 1..raised.len() {
            let share = i as f64 / n;
            next[i] = raised[i - 1] * share + raised[i] * (1.0 - share);
        }
        raised = next;
    }
    raised
}

/// The product: `c[k] = Σ C(m,i) C(n,k−i) / C(m+n,k) · a[i] b[k−i]`.
///
/// # Panics
///
/// Above [`MAX_PRODUCT_DEGREE`].
pub fn product(a: &[f64], b: &[f64]) -> Coefficients {
    if a.is_empty() || b.is_empty() {
        return Coefficients::new();
    }
    let (m, n) = (a.len() - 1, b.len() - 1);
    let (choose_m, choose_n, choose) = (binomials(m), binomials(n), binomials(m + n));
    let at = |k: usize| {
        let terms = k.saturating_sub(n)..=k.min(m);
        terms.map(|i| choose_m[i] * a[i] * (choose_n[k - i] * b[k - i])).sum::<f64>() / choose[k]
    };
    (0..=m + n).map(at).collect()
}

/// Row n of Pascal's triangle, n up to [`MAX_PRODUCT_DEGREE`]; exact up to n = 56.
fn binomials(n: usize) -> &'static [f64] {
    &BINOMIALS[n][..=n]
}

static BINOMIALS: [[f64; MAX_PRODUCT_DEGREE + 1]; MAX_PRODUCT_DEGREE + 1] = {
    let mut rows = [[0.0; MAX_PRODUCT_DEGREE + 1]; MAX_PRODUCT_DEGREE + 1];
    let mut n = 0;
    while n <= MAX_PRODUCT_DEGREE {
        rows[n][0] = 1.0;
        let mut k = 0;
        while k < n {
            rows[n][k + 1] = rows[n - 1][k] + rows[n - 1][k + 1];
            k += 1;
        }
        n += 1;
    }
    rows
};

/// The two parts at `t`, each on [0, 1]; they share the value at `t`.
pub fn split(coefficients: &[f64], t: f64) -> [Coefficients; 2] {
    let mut right = Coefficients::from_slice(coefficients);
    let mut left = Coefficients::new();
    for last in (0..coefficients.len()).rev() {
        left.push(right[0]);
        for i in 0..last {
            right[i] = right[i] * (1.0 - t) + right[i + 1] * t;
        }
    }
    [left, right]
}

/// The real roots strictly inside (0, 1), ascending, each once, within `tolerance`.
///
/// Parts without a sign change among their coefficients have no root, parts with one have exactly one, the others are
/// halved. What cannot be told from zero by rounding (multiple roots, and minima that all but touch zero) counts as one
/// root, in its middle. The zero polynomial has none, and so has one with coefficients that are not finite.
pub fn roots_in_unit_interval(coefficients: &[f64], tolerance: f64) -> SmallVec<[f64; 8]> {
    let largest = coefficients.iter().fold(0.0, |largest: f64, c| largest.max(c.abs()));
    // Each halving adds up to n roundings of half an ulp to a coefficient, in one direction at worst; most cancel.
    let noise = 4.0 * f64::EPSILON * largest * coefficients.len() as f64;
    if !(largest > 0.0 && coefficients.iter().all(|c| c.is_finite())) {
        return SmallVec::new();
    }
    let tolerance = tolerance.max(f64::EPSILON);
    let mut found: SmallVec<[[f64; 2]; 8]> = SmallVec::new();
    let mut parts: SmallVec<[(Coefficients, [f64; 2]); 16]> = SmallVec::new();
    parts.push((Coefficients::from_slice(coefficients), [0.0, 1.0]));
    while let Some((mut part, [a, b])) = parts.pop() {
        for c in part.iter_mut().filter(|c| c.abs() <= noise) {
            *c = 0.0;
        }
        match sign_changes(&part) {
            None => found.push([a, b]),
            Some(0) => {}
            Some(1) => {
                let root = a + (b - a) * only_root(part, tolerance / (b - a));
                found.push([root, root]);
            }
            Some(_) if b - a <= tolerance => found.push([a, b]),
            Some(_) => {
                let middle = 0.5 * (a + b);
                let [left, right] = split(&part, 0.5);
                if right[0].abs() <= noise {
                    found.push([middle, middle]);
                }
                parts.push((right, [middle, b]));
                parts.push((left, [a, middle]));
            }
        }
    }
    merged(found, tolerance)
}

/// `None` where all coefficients are zero.
fn sign_changes(coefficients: &[f64]) -> Option<usize> {
    let mut signs = coefficients.iter().filter(|c| **c != 0.0).map(|c| *c > 0.0);
    let mut sign = signs.next()?;
    let mut changes = 0;
    for next in signs {
        changes += usize::from(next != sign);
        sign = next;
    }
    Some(changes)
}

/// The root inside (0, 1) of a polynomial with one sign change among its coefficients.
fn only_root(mut coefficients: Coefficients, tolerance: f64) -> f64 {
    // Roots at the ends are divided out: by t, `c'[i] = c[i+1] n/(i+1)`, and by 1 − t, `c'[i] = c[i] n/(n−i)`.
    while coefficients[0] == 0.0 {
        coefficients.remove(0);
        let n = coefficients.len() as f64;
        for (i, c) in coefficients.iter_mut().enumerate() {
            *c *= n / (i + 1) as f64;
        }
    }
    while coefficients[coefficients.len() - 1] == 0.0 {
        coefficients.pop();
        let n = coefficients.len() as f64;
        for (i, c) in coefficients.iter_mut().enumerate() {
            *c *= n / (n - i as f64);
        }
    }
    bracketed_root(|t| eval_with_derivative(&coefficients, t), [0.0, 1.0], tolerance)
}

/// The middles of what overlaps or lies within `tolerance` of each other.
fn merged(mut found: SmallVec<[[f64; 2]; 8]>, tolerance: f64) -> SmallVec<[f64; 8]> {
    found.sort_by(|x, y| x[0].total_cmp(&y[0]));
    let mut merged: SmallVec<[[f64; 2]; 8]> = SmallVec::new();
    for next in found {
        match merged.last_mut() {
            Some(last) if next[0] <= last[1] + tolerance => last[1] = last[1].max(next[1]),
            _ => merged.push(next),
        }
    }
    let middles = merged.iter().map(|[a, b]| 0.5 * (a + b));
    // A stretch of zeros over all of it is the zero polynomial up to rounding.
    middles.filter(|t| *t > 0.0 && *t < 1.0).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn from_roots(roots: &[f64]) -> Coefficients {
        roots.iter().fold(Coefficients::from_slice(&[1.0]), |p, r| product(&p, &[-r, 1.0 - r]))
    }

    #[test]
    fn arithmetic_agrees_with_evaluation() {
        let (a, b) = ([1.0, -2.0, 0.5, 3.0], [0.3, 4.0, -1.0]);
        for t in [0.0, 0.2, 0.7, 1.0] {
            let exact = eval(&a, t) * eval(&b, t);
            assert!((eval(&product(&a, &b), t) - exact).abs() < 1e-14);
            assert!((eval(&elevate(&a, 3), t) - eval(&a, t)).abs() < 1e-14);
            let (value, slope) = eval_with_derivative(&a, t);
            assert_eq!(value, eval(&a, t));
            assert!((slope - eval(&derivative(&a), t)).abs() < 1e-14);
            let [left, right] = split(&a, 0.3);
            assert!((eval(&left, t) - eval(&a, 0.3 * t)).abs() < 1e-14);
            assert!((eval(&right, t) - eval(&a, 0.3 + 0.7 * t)).abs() < 1e-14);
        }
        assert_eq!(derivative(&[2.0])[..], [0.0]);
    }

    #[test]
    fn simple_roots() {
        for roots in [&[0.5][..], &[0.25, 0.5, 0.75], &[0.1, 0.11, 0.9], &[1e-6, 0.3, 1.0 - 1e-6]] {
            let found = roots_in_unit_interval(&from_roots(roots), 1e-14);
            assert_eq!(found.len(), roots.len(), "{roots:?} {found:?}");
            assert!(found.iter().zip(roots).all(|(a, b)| (a - b).abs() < 1e-11), "{roots:?} {found:?}");
        }
    }

    #[test]
    fn roots_outside_and_at_the_ends_do_not_count() {
        assert!(roots_in_unit_interval(&from_roots(&[0.0, 1.0]), 1e-14).is_empty());
        assert!(roots_in_unit_interval(&from_roots(&[-0.3, 1.7]), 1e-14).is_empty());
        let found = roots_in_unit_interval(&from_roots(&[0.0, 0.4, 1.0, 1.0]), 1e-14);
        assert!(found.len() == 1 && (found[0] - 0.4).abs() < 1e-14);
    }

    #[test]
    fn multiple_roots_come_once() {
        for (roots, accuracy) in [(&[0.3, 0.3][..], 1e-6), (&[0.5, 0.5], 1e-6), (&[0.6, 0.6, 0.6], 1e-4)] {
            let found = roots_in_unit_interval(&from_roots(roots), 1e-14);
            assert!(found.len() == 1 && (found[0] - roots[0]).abs() < accuracy, "{roots:?} {found:?}");
        }
        let found = roots_in_unit_interval(&from_roots(&[0.2, 0.7, 0.7]), 1e-14);
        assert!(found.len() == 2 && (found[0] - 0.2).abs() < 1e-12 && (found[1] - 0.7).abs() < 1e-6);
    }

    #[test]
    fn odd_polynomials_have_no_roots() {
        for odd in [&[][..], &[0.0, 0.0, 0.0], &[f64::NAN, 1.0], &[f64::INFINITY, -1.0], &[3.0]] {
            assert!(roots_in_unit_interval(odd, 1e-12).is_empty());
        }
    }
}
