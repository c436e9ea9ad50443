//! Splitting at the extrema of u and v.
//!
//! The derivative of a rational coordinate `x = X / W` has the sign of `X' W − X W'`, a polynomial whose Bernstein
//! coefficients follow from those of X and W (Farouki & Rajan 1988, product formula). Its sign changes are isolated by
//! subdivision (variation diminishing: no sign change in the coefficients, no root) and refined by bisection.

use super::segment::{Segment, control, end, is_constant, start, with_unit_ends};
use crate::geometry::{Bezier, Homogeneous, Homogeneous2};
use crate::numeric::bernstein::{Coefficients, product};

/// A coordinate that varies by less than this share of its magnitude is constant up to rounding: 2⁻⁴⁶, 64 roundings.
const FLAT: f64 = 1.5e-14;

/// Subdivision ends here: 2⁻⁴⁰ of the curve is below the accuracy of a double root.
const MAX_DEPTH: u32 = 40;

/// `curve` cut at its u- and v-extrema; the pieces are monotone in both and share end points bit for bit.
///
/// Pieces of curves with positive weights have end weights of 1. A curve that is not finite comes back as it is.
///
/// # Panics
///
/// For rational curves above degree 38; those of files and fits go to 25.
pub fn split_monotone(curve: &Bezier<Homogeneous2>) -> Vec<Bezier<Homogeneous2>> {
    let Some(mut curve) = (curve.points.len() >= 2).then(|| with_unit_ends(curve.clone())).flatten() else {
        return vec![curve.clone()];
    };
    (0..2).for_each(|axis| flatten(&mut curve, axis));
    if curve.points.len() == 2 {
        return vec![curve];
    }
    // Cut where either coordinate turns.
    let mut cuts: Vec<(f64, usize)> = (0..2)
        .flat_map(|axis| {
            sign_changes(&derivative_numerator(&curve, axis)).into_iter().map(move |t| (t, axis))
        })
        .collect();
    cuts.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut pieces: Vec<Segment> = Vec::with_capacity(cuts.len() + 1);
    let (mut rest, mut begin, mut turned) = (curve, 0.0, None);
    for (t, axis) in cuts {
        let local = (t - begin) / (1.0 - begin);
        if !(local > 1e-12 && local < 1.0 - 1e-12) {
            // Two turns at one place: a cusp, whose first cut serves both.
            continue;
        }
        let [mut left, right] = rest.split(local);
        settle(&mut left, turned, Some(axis));
        pieces.push(left);
        (rest, begin, turned) = (right, t, Some(axis));
    }
    settle(&mut rest, turned, None);
    pieces.push(rest);
    pieces.into_iter().map(|piece| with_unit_ends(piece.clone()).unwrap_or(piece)).collect()
}

/// Makes a coordinate that is constant up to rounding run straight between its ends.
fn flatten(curve: &mut Segment, axis: usize) {
    let last = curve.points.len() - 1;
    let (a, b) = (start(curve)[axis], end(curve)[axis]);
    let (low, high) = curve.points.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| {
        let x = p.point()[axis];
        (low.min(x), high.max(x))
    });
    if high - low > FLAT * low.abs().max(high.abs()) {
        return;
    }
    for (i, point) in curve.points.iter_mut().enumerate().take(last).skip(1) {
        let mut position = point.point();
        position[axis] = a + (b - a) * i as f64 / last as f64;
        *point = control(position, point.weight());
    }
}

/// Makes the derivative exactly zero where the coordinate turns, at the start and at the end.
fn settle(piece: &mut Segment, turned_at_start: Option<usize>, turned_at_end: Option<usize>) {
    let last = piece.points.len() - 1;
    for (axis, corner, neighbour) in [(turned_at_start, 0, 1), (turned_at_end, last, last - 1)] {
        let Some(axis) = axis else { continue };
        let mut position = piece.points[neighbour].point();
        position[axis] = piece.points[corner].point()[axis];
        piece.points[neighbour] = control(position, piece.points[neighbour].weight());
    }
}

/// Bernstein coefficients, degree 2n − 1, of `X' W − X W'`, with X measured from the start for accuracy; those of `X'` where W is 1.
fn derivative_numerator(curve: &Segment, axis: usize) -> Coefficients {
    if is_constant(curve, axis) {
        return Coefficients::from_slice(&[0.0]);
    }
    let origin = start(curve)[axis];
    let weights: Coefficients = curve.points.iter().map(|p| p.weight()).collect();
    let values: Coefficients = curve.points.iter().map(|p| (p.point()[axis] - origin) * p.weight()).collect();
    let slopes = |c: &[f64]| c.windows(2).map(|w| w[1] - w[0]).collect::<Coefficients>();
    if weights.iter().all(|w| *w == 1.0) {
        return slopes(&values);
    }
    let left = product(&slopes(&values), &weights);
    let right = product(&slopes(&weights), &values);
    left.iter().zip(&right).map(|(a, b)| a - b).collect()
}

/// Parameters in (0, 1) where the polynomial changes sign, in order.
fn sign_changes(coefficients: &[f64]) -> Vec<f64> {
    let scale = coefficients.iter().fold(0.0f64, |m, c| m.max(c.abs()));
    // Coefficients below the rounding of the largest carry no sign.
    let cleaned: Vec<f64> =
        coefficients.iter().map(|&c| if c.abs() <= FLAT * scale { 0.0 } else { c }).collect();
    let mut found = Vec::new();
    isolate(&cleaned, 0.0, 1.0, MAX_DEPTH, &mut found);
    found
}

fn variations(coefficients: &[f64]) -> usize {
    let mut last = 0.0;
    let mut count = 0;
    for &c in coefficients.iter().filter(|&&c| c != 0.0) {
        if last * c < 0.0 {
            count += 1;
        }
        last = c;
    }
    count
}

/// Appends the sign changes inside (a, b), where `coefficients` belong to [a, b].
fn isolate(coefficients: &[f64], a: f64, b: f64, depth: u32, found: &mut Vec<f64>) {
    match variations(coefficients) {
        0 => {}
        1 => found.push(a + (b - a) * bisect(coefficients)),
        _ if depth == 0 => found.push(0.5 * (a + b)),
        _ => {
            let (left, right) = halves(coefficients);
            let middle = 0.5 * (a + b);
            isolate(&left, a, middle, depth - 1, found);
            // A root at the middle itself shows in neither half.
            let sign_before = left.iter().rev().find(|c| **c != 0.0);
            let sign_after = right.iter().find(|c| **c != 0.0);
            if left.last() == Some(&0.0)
                && let (Some(before), Some(after)) = (sign_before, sign_after)
                && before * after < 0.0
            {
                found.push(middle);
            }
            isolate(&right, middle, b, depth - 1, found);
        }
    }
}

/// De Casteljau at 1/2.
fn halves(coefficients: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut row = coefficients.to_vec();
    let mut left = Vec::with_capacity(row.len());
    let mut right = vec![0.0; row.len()];
    for level in 0..coefficients.len() {
        left.push(row[0]);
        let last = row.len() - 1 - level;
        right[last] = row[last];
        for i in 0..last {
            row[i] = 0.5 * (row[i] + row[i + 1]);
        }
    }
    (left, right)
}

/// The one sign change of a polynomial whose coefficients change sign once.
fn bisect(coefficients: &[f64]) -> f64 {
    let falling = coefficients.iter().find(|c| **c != 0.0).is_some_and(|c| *c > 0.0);
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..54 {
        let middle = 0.5 * (low + high);
        if (evaluate(coefficients, middle) > 0.0) == falling { low = middle } else { high = middle }
    }
    0.5 * (low + high)
}

fn evaluate(coefficients: &[f64], t: f64) -> f64 {
    let mut row = coefficients.to_vec();
    for level in 1..row.len() {
        for i in 0..row.len() - level {
            row[i] += t * (row[i + 1] - row[i]);
        }
    }
    row[0]
}

#[cfg(test)]
mod tests {
    use super::super::segment::{cubic, point_at};
    use super::*;
    use glam::DVec2;

    fn assert_monotone(pieces: &[Segment]) {
        for pair in pieces.windows(2) {
            assert_eq!(end(&pair[0]), start(&pair[1]), "pieces share end points bit for bit");
        }
        for piece in pieces {
            for axis in 0..2 {
                let up = end(piece)[axis] >= start(piece)[axis];
                let mut last = start(piece)[axis];
                for i in 1..=256 {
                    let x = point_at(piece, f64::from(i) / 256.0)[axis];
                    let step = if up { x - last } else { last - x };
                    assert!(step >= -1e-14 * x.abs().max(1.0), "step {step} at {i}");
                    last = x;
                }
            }
        }
    }

    #[test]
    fn cubic_with_turns_in_both_coordinates() {
        let curve =
            cubic([DVec2::new(0.0, 0.0), DVec2::new(3.0, 2.0), DVec2::new(-2.0, 2.0), DVec2::new(1.0, -0.5)]);
        let pieces = split_monotone(&curve);
        assert_eq!(pieces.len(), 4, "two turns of u, one of v");
        assert_monotone(&pieces);
    }

    #[test]
    fn half_circle_is_cut_at_its_top() {
        // Weights 1, 0, 1 describe a half circle; 1, 1/3, 1/3, 1 is the same with positive weights.
        let third = 1.0 / 3.0;
        let half = Bezier {
            points: vec![
                control(DVec2::new(1.0, 0.0), 1.0),
                control(DVec2::new(1.0, 2.0), third),
                control(DVec2::new(-1.0, 2.0), third),
                control(DVec2::new(-1.0, 0.0), 1.0),
            ],
        };
        let pieces = split_monotone(&half);
        assert_monotone(&pieces);
        assert_eq!(pieces.len(), 2);
        assert!((end(&pieces[0]) - DVec2::new(0.0, 1.0)).length() < 1e-12);
    }

    #[test]
    fn rounding_makes_no_cuts() {
        let wobble = cubic([
            DVec2::new(1.0, 0.0),
            DVec2::new(1.0 + 4e-16, 1.0),
            DVec2::new(1.0 - 4e-16, 2.0),
            DVec2::new(1.0, 3.0),
        ]);
        assert_eq!(split_monotone(&wobble).len(), 1);
    }

    #[test]
    fn random_rational_curves_come_out_monotone() {
        let mut state = 7u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        for _ in 0..300 {
            let degree = 2 + (random() * 6.0) as usize;
            let points = (0..=degree)
                .map(|_| control(DVec2::new(random() * 4.0, random() * 4.0), 0.2 + 3.0 * random()))
                .collect();
            assert_monotone(&split_monotone(&Bezier { points }));
        }
    }
}
