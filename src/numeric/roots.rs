//! Roots of functions of one variable.

use smallvec::SmallVec;

/// More halvings than an interval of f64 has room for.
const MAX_STEPS: usize = 1100;

/// The real roots of `a x² + b x + c`, ascending, a double root once; also where `a` is 0. Both roots come without
/// cancellation: the larger in magnitude from `q = −(b + sign(b) √D) / 2`, the other one as `c / q`.
pub fn quadratic_roots(a: f64, b: f64, c: f64) -> SmallVec<[f64; 2]> {
    let discriminant = b.mul_add(b, -4.0 * a * c);
    let mut roots: SmallVec<[f64; 2]> = SmallVec::new();
    if discriminant < 0.0 {
        return roots;
    }
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    roots.extend([q / a, c / q].into_iter().filter(|root| root.is_finite()));
    if q == 0.0 && a != 0.0 {
        // b = c = 0: the division c / q was lost above, and q / a is the double root 0.
        return SmallVec::from_slice(&[0.0]);
    }
    roots.sort_by(f64::total_cmp);
    roots.dedup();
    roots
}

/// The root of a function in `bracket`, at whose ends it has opposite signs (or is 0), within `tolerance`.
///
/// `function` gives value and derivative. Newton's method; a step that leaves the bracket, or did not halve it within
/// three tries, is replaced by bisection, so that it ends for every function. With equal signs some point of the bracket.
pub fn bracketed_root(mut function: impl FnMut(f64) -> (f64, f64), bracket: [f64; 2], tolerance: f64) -> f64 {
    let [mut low, mut high] = bracket;
    let low_is_negative = match (function(low).0, function(high).0) {
        (0.0, _) => return low,
        (_, 0.0) => return high,
        (at_low, _) => at_low < 0.0,
    };
    let mut x = 0.5 * (low + high);
    let mut width_before = high - low;
    for step in 1..MAX_STEPS {
        let (value, slope) = function(x);
        if value == 0.0 {
            return x;
        }
        if (value < 0.0) == low_is_negative {
            low = x;
        } else {
            high = x;
        }
        let newton = x - value / slope;
        let inside = low < newton && newton < high;
        let stalled = step % 3 == 0 && high - low > 0.5 * width_before;
        if step % 3 == 0 {
            width_before = high - low;
        }
        let next = if inside && !stalled { newton } else { 0.5 * (low + high) };
        if (next - x).abs() <= tolerance || high - low <= tolerance || !(low < next && next < high) {
            return next;
        }
        x = next;
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quadratics() {
        assert_eq!(quadratic_roots(1.0, -3.0, 2.0)[..], [1.0, 2.0]);
        assert_eq!(quadratic_roots(0.0, 2.0, -3.0)[..], [1.5]);
        assert_eq!(quadratic_roots(1.0, 0.0, 0.0)[..], [0.0]);
        assert_eq!(quadratic_roots(1.0, 0.0, -4.0)[..], [-2.0, 2.0]);
        assert_eq!(quadratic_roots(2.0, -4.0, 2.0)[..], [1.0]);
        assert!(quadratic_roots(1.0, 0.0, 1.0).is_empty());
        assert!(quadratic_roots(0.0, 0.0, 1.0).is_empty());
        let roots = quadratic_roots(1.0, -1e8, 1.0);
        assert!((roots[0] - 1e-8).abs() < 1e-23, "no cancellation: {roots:?}");
    }

    #[test]
    fn brackets() {
        let root = bracketed_root(|x| (x.cos() - x, -x.sin() - 1.0), [0.0, 2.0], 1e-15);
        assert!((root - 0.739_085_133_215_160_6).abs() < 1e-15);
        // A triple root, where Newton is slow.
        let root = bracketed_root(|x| ((x - 0.3).powi(3), 3.0 * (x - 0.3).powi(2)), [-1.0, 1.0], 1e-12);
        assert!((root - 0.3).abs() < 1e-4);
        // A useless derivative.
        let root = bracketed_root(|x| (x - 0.7, f64::NAN), [0.0, 1.0], 1e-14);
        assert!((root - 0.7).abs() < 1e-13);
        assert_eq!(bracketed_root(|x| (x, 1.0), [0.0, 1.0], 1e-9), 0.0);
    }
}
