//! All points at which two functions over a square vanish, or the admission that they cannot be told.
//!
//! The functions are the distances of a net's points from two planes through a ray, as numerators in Bernstein form. Cells are dropped
//! where the coefficients say that one function stays beyond the tolerance; elsewhere the system is multiplied by the inverse of its mean
//! Jacobian, and where that is close enough to the identity over the whole cell the cell has at most one root and the value at its middle says
//! whether it has one. Everything else is halved. A cell in which both functions stay within the tolerance ends the search: a ray that
//! runs along the net is not for anybody to judge.

use crate::numeric::bernstein::{eval, eval_with_derivative};
use glam::{DMat2, DVec2};
use smallvec::SmallVec;

/// Cells looked at before a search is given up.
const MOST_CELLS: usize = 20_000;

/// The preconditioned system may differ from the identity by this much where roots are decided. Any number below 1 leaves one root at most;
/// with a quarter Newton's method converges from everywhere in the cell.
const CONTRACTION: f64 = 0.25;

/// Roots closer than this, in parameters, are one root found from two cells.
const SAME: f64 = 1e-9;

/// Steps along a side of a net towards the ray.
const MOST_SLIDES: usize = 8;

/// Coefficients of a bivariate polynomial, the second parameter fastest.
type Net = SmallVec<[f64; 36]>;

/// The numerators of two functions and their common denominator.
#[derive(Debug, Clone)]
pub(super) struct System {
    /// In both directions.
    pub(super) degrees: [usize; 2],
    /// The numerators.
    pub(super) functions: [Net; 2],
    /// The denominator; positive.
    pub(super) weights: Net,
}

/// A rectangle of the parameter plane with the system restricted to it.
struct Cell {
    low: DVec2,
    size: DVec2,
    system: System,
}

impl System {
    /// The system over `[low, high]` of one of the two parameters.
    fn restricted(&self, axis: usize, low: f64, high: f64) -> System {
        let cut = |net: &Net| restricted(net, self.degrees, axis, low, high);
        System {
            degrees: self.degrees,
            functions: [cut(&self.functions[0]), cut(&self.functions[1])],
            weights: cut(&self.weights),
        }
    }

    /// Values and both derivatives of the numerators.
    fn jet(&self, uv: DVec2) -> (DVec2, DMat2) {
        let [first, second] = [0, 1].map(|k| {
            let rows: SmallVec<[(f64, f64); 8]> = self.functions[k]
                .chunks(self.degrees[1] + 1)
                .map(|row| eval_with_derivative(row, uv.y))
                .collect();
            let (values, slopes): (SmallVec<[f64; 8]>, SmallVec<[f64; 8]>) = rows.into_iter().unzip();
            let (value, by_u) = eval_with_derivative(&values, uv.x);
            (value, by_u, eval(&slopes, uv.x))
        });
        let by_u = DVec2::new(first.1, second.1);
        let by_v = DVec2::new(first.2, second.2);
        (DVec2::new(first.0, second.0), DMat2::from_cols(by_u, by_v))
    }

    /// The greater of the two functions' absolute values, denominator included.
    fn distance(&self, uv: DVec2) -> f64 {
        let rows: SmallVec<[f64; 8]> =
            self.weights.chunks(self.degrees[1] + 1).map(|row| eval(row, uv.y)).collect();
        self.jet(uv).0.abs().max_element() / eval(&rows, uv.x)
    }
}

/// The points of `[−margin, 1 + margin]²` where both functions vanish; `None` where some point comes within `tolerance` and cannot be
/// decided.
pub(super) fn isolate(system: &System, tolerance: f64, margin: f64) -> Option<SmallVec<[DVec2; 4]>> {
    let whole = system.restricted(0, -margin, 1.0 + margin).restricted(1, -margin, 1.0 + margin);
    let low = DVec2::splat(-margin);
    let mut open = vec![Cell { low, size: DVec2::ONE - 2.0 * low, system: whole }];
    let mut roots: SmallVec<[DVec2; 4]> = SmallVec::new();
    let mut cells = 0;
    while let Some(cell) = open.pop() {
        cells += 1;
        if cells > MOST_CELLS {
            return None;
        }
        let [first, second] =
            [0, 1].map(|k| reach(&cell.system.functions[k], &cell.system.weights, tolerance));
        if first == Reach::Beyond || second == Reach::Beyond {
            continue;
        }
        if first == Reach::Within && second == Reach::Within {
            return None;
        }
        match decide(&cell.system, tolerance) {
            Decision::Empty => {}
            Decision::Near(step) => {
                if is_beside(system, cell.low + cell.size * (DVec2::splat(0.5) - step), tolerance, margin) {
                    return None;
                }
            }
            Decision::Root => {
                let root = polish(system, cell.low + 0.5 * cell.size)?;
                let outside = (root - cell.low - 0.5 * cell.size).abs() - 0.5 * cell.size;
                if is_beside(system, root, tolerance, margin) {
                    return None;
                }
                // One that lies just outside is its neighbour's as well.
                let known = |other: &DVec2| (*other - root).abs().max_element() < SAME;
                if outside.max_element() <= SAME && !roots.iter().any(known) {
                    roots.push(root);
                }
            }
            Decision::Unknown => {
                let axis = longer(&cell.system);
                let half = 0.5 * cell.size[axis];
                for side in [0.0, 0.5] {
                    let mut part = Cell {
                        low: cell.low,
                        size: cell.size,
                        system: cell.system.restricted(axis, side, side + 0.5),
                    };
                    part.low[axis] += 2.0 * side * half;
                    part.size[axis] = half;
                    open.push(part);
                }
            }
        }
    }
    Some(roots)
}

/// Whether a root is beyond a side of the net, but the ray passes that side by less than the tolerance: on a narrow net, or on one that the ray grazes,
/// that may be far in parameters.
fn is_beside(system: &System, root: DVec2, tolerance: f64, margin: f64) -> bool {
    let (low, high) = (DVec2::splat(-margin), DVec2::splat(1.0 + margin));
    let nearest = root.clamp(low, high);
    (0..2).filter(|&axis| nearest[axis] != root[axis]).any(|axis| {
        // The place of this side that is nearest to the ray, by the Gauss-Newton method.
        let along = DVec2::AXES[1 - axis];
        let mut place = nearest;
        let mut passes = system.distance(place);
        for _ in 0..MOST_SLIDES {
            let (value, jacobian) = system.jet(place);
            let slope = jacobian * along;
            let next = (place - along * (value.dot(slope) / slope.length_squared())).clamp(low, high);
            let closer = system.distance(next);
            if !(closer < passes) {
                break;
            }
            (place, passes) = (next, closer);
        }
        passes <= tolerance
    })
}

/// How far from 0 a quotient stays over a cell.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Reach {
    /// Everywhere beyond the tolerance, on one side.
    Beyond,
    /// Everywhere within the tolerance.
    Within,
    /// Neither is known.
    Across,
}

fn reach(function: &Net, weights: &Net, tolerance: f64) -> Reach {
    let sides = function.iter().zip(weights).fold((true, true, true), |(above, below, within), (f, w)| {
        let limit = tolerance * w;
        (above && *f > limit, below && *f < -limit, within && f.abs() <= limit)
    });
    match sides {
        (true, ..) | (_, true, _) => Reach::Beyond,
        (.., true) => Reach::Within,
        _ => Reach::Across,
    }
}

enum Decision {
    Empty,
    /// No root is in the cell, but about this far from its middle, in cells and backwards, is one that the tolerance would bring into it.
    Near(DVec2),
    /// At most one root, and it is in the cell or a hair outside.
    Root,
    Unknown,
}

/// With G = J⁻¹ F, J the mean Jacobian and |G′ − 1| <= q over the cell: G(c) = G(c) − G(x) for a root x, so that
/// |G(c)| <= (1 + q) |c − x|; and from |G(c)| <= (1 − q) r the simplified Newton method stays in the cell.
fn decide(system: &System, tolerance: f64) -> Decision {
    let slopes = [0, 1].map(|k| [0, 1].map(|axis| differences(&system.functions[k], system.degrees, axis)));
    let mean = |net: &Net| net.iter().sum::<f64>() / net.len() as f64;
    let jacobian = DMat2::from_cols(
        DVec2::new(mean(&slopes[0][0]), mean(&slopes[1][0])),
        DVec2::new(mean(&slopes[0][1]), mean(&slopes[1][1])),
    );
    let inverse = jacobian.inverse();
    if !inverse.is_finite() {
        return Decision::Unknown;
    }
    let mut farthest = [0.0_f64; 2];
    for axis in [0, 1] {
        let unit = DVec2::AXES[axis];
        let mut worst = DVec2::ZERO;
        for (first, second) in slopes[0][axis].iter().zip(&slopes[1][axis]) {
            worst = worst.max((inverse * DVec2::new(*first, *second) - unit).abs());
        }
        farthest[0] += worst.x;
        farthest[1] += worst.y;
    }
    let q = farthest[0].max(farthest[1]);
    if !(q <= CONTRACTION) {
        return Decision::Unknown;
    }
    let (value, _) = system.jet(DVec2::splat(0.5));
    let step = inverse * value;
    let heaviest = system.weights.iter().fold(0.0, |most, weight| weight.max(most));
    let moved = (inverse.row(0).length().max(inverse.row(1).length())) * tolerance * heaviest;
    match step.abs().max_element() - 0.5 * (1.0 + q) {
        beyond if beyond > moved => Decision::Empty,
        beyond if beyond > 0.0 => Decision::Near(step),
        _ => Decision::Root,
    }
}

/// Newton's method on the whole system, where it is most precise.
fn polish(system: &System, start: DVec2) -> Option<DVec2> {
    let mut uv = start;
    for _ in 0..40 {
        let (value, jacobian) = system.jet(uv);
        let step = jacobian.inverse() * value;
        if !step.is_finite() {
            return None;
        }
        uv -= step;
        if step.abs().max_element() < 1e-14 {
            return Some(uv);
        }
    }
    // Rounding keeps the last steps from shrinking further.
    Some(uv)
}

/// The parameter along which the functions change more.
fn longer(system: &System) -> usize {
    let change = |axis: usize| {
        let largest = |k: usize| {
            differences(&system.functions[k], system.degrees, axis)
                .iter()
                .fold(0.0_f64, |m, d| m.max(d.abs()))
        };
        largest(0).max(largest(1))
    };
    usize::from(change(1) > change(0))
}

/// Coefficients of the derivative along an axis.
fn differences(net: &Net, degrees: [usize; 2], axis: usize) -> Net {
    let degree = degrees[axis];
    let stride = if axis == 0 { degrees[1] + 1 } else { 1 };
    let is_last = |i: usize| if axis == 0 { i / stride == degree } else { i % (degree + 1) == degree };
    (0..net.len())
        .filter(|i| degree > 0 && !is_last(*i))
        .map(|i| degree as f64 * (net[i + stride] - net[i]))
        .collect()
}

/// The net over `[low, high]` of one parameter, which may reach out of [0, 1]: de Casteljau's scheme twice.
fn restricted(net: &Net, degrees: [usize; 2], axis: usize, low: f64, high: f64) -> Net {
    let mut result = net.clone();
    let (degree, stride) = (degrees[axis], if axis == 0 { degrees[1] + 1 } else { 1 });
    let starts: SmallVec<[usize; 26]> =
        (0..net.len()).filter(|i| if axis == 0 { i / stride == 0 } else { i % (degree + 1) == 0 }).collect();
    // What is left of [0, high] is cut at low / high; so that high may not be 0, which it never is.
    let rest = low / high;
    for start in starts {
        let at = |i: usize| start + i * stride;
        for step in 1..=degree {
            for i in (step..=degree).rev() {
                result[at(i)] = (1.0 - high) * result[at(i - 1)] + high * result[at(i)];
            }
        }
        if rest == 0.0 {
            continue;
        }
        for step in 1..=degree {
            for i in 0..=degree - step {
                result[at(i)] = (1.0 - rest) * result[at(i)] + rest * result[at(i + 1)];
            }
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `(2u − 1)² + (2v − 1)² − r²` and `v − a − (u − ½) / 8` in degrees (2, 2).
    fn circle_and_line(radius: f64, height: f64) -> System {
        let square = |t: [f64; 3]| t;
        let s = square([1.0, -1.0, 1.0]);
        let mut circle = Net::new();
        let mut line = Net::new();
        for i in 0..3 {
            for j in 0..3 {
                circle.push(s[i] + s[j] - radius * radius);
                line.push(j as f64 / 2.0 - height - (i as f64 / 2.0 - 0.5) / 8.0);
            }
        }
        System { degrees: [2, 2], functions: [circle, line], weights: SmallVec::from_elem(1.0, 9) }
    }

    #[test]
    fn a_line_meets_a_circle() {
        for height in [0.5, 0.3, 0.7, 0.123] {
            let system = circle_and_line(0.9, height);
            let roots = isolate(&system, 1e-9, 1e-6).expect("nothing is close to touching");
            assert_eq!(roots.len(), 2, "{height}");
            for root in roots {
                let (value, _) = system.jet(root);
                assert!(value.abs().max_element() < 1e-14, "{value}");
            }
        }
        assert!(isolate(&circle_and_line(0.9, 2.0), 1e-9, 1e-6).is_some_and(|roots| roots.is_empty()));
    }

    #[test]
    fn what_nearly_touches_is_not_decided() {
        // The line at distance 0.9 from the middle, in the circle's units; its slope is 1/8.
        let touching = 0.5 + 0.45 * (1.0_f64 + 1.0 / 64.0).sqrt();
        assert!(isolate(&circle_and_line(0.9, touching), 1e-9, 1e-6).is_none());
        assert!(isolate(&circle_and_line(0.9, touching + 1e-12), 1e-9, 1e-6).is_none());
        assert_eq!(isolate(&circle_and_line(0.9, touching - 1e-6), 1e-9, 1e-6).map(|r| r.len()), Some(2));
        assert_eq!(isolate(&circle_and_line(0.9, touching + 1e-6), 1e-9, 1e-6).map(|r| r.len()), Some(0));
    }

    #[test]
    fn restriction_is_reparametrisation() {
        let system = circle_and_line(0.7, 0.4);
        let part = system.restricted(0, 0.25, 0.75).restricted(1, -0.5, 0.5);
        for uv in [DVec2::new(0.1, 0.9), DVec2::new(0.5, 0.3), DVec2::ZERO, DVec2::ONE] {
            let whole = DVec2::new(0.25 + 0.5 * uv.x, -0.5 + uv.y);
            assert!((part.jet(uv).0 - system.jet(whole).0).abs().max_element() < 1e-14);
        }
    }

    #[test]
    fn what_passes_a_narrow_net_is_not_decided() {
        // One parameter is 1e-7 long in the second function; the line passes at `beside` lengths from its end.
        let strip = |beside: f64| System {
            degrees: [1, 1],
            functions: [
                SmallVec::from_slice(&[-0.5, -0.5, 0.5, 0.5]),
                SmallVec::from_slice(&[0.0, 1e-7, 0.0, 1e-7].map(|v| v - 1e-7 * (1.0 + beside))),
            ],
            weights: SmallVec::from_elem(1.0, 4),
        };
        assert_eq!(isolate(&strip(-0.5), 1e-9, 1e-6).map(|roots| roots.len()), Some(1));
        assert!(isolate(&strip(0.05), 1e-8, 1e-6).is_none());
        assert!(isolate(&strip(5.0), 1e-6, 1e-6).is_none());
        assert_eq!(isolate(&strip(0.05), 1e-9, 1e-6).map(|roots| roots.len()), Some(0));
        assert_eq!(isolate(&strip(5.0), 1e-8, 1e-6).map(|roots| roots.len()), Some(0));
    }

    /// The plane of (u, v), and a line that comes down to it at a thousandth beyond v = 1 along v at a slope of 2e-3: it passes over the side at 2e-6, but not
    /// over the place of the side that is nearest to where it meets the plane.
    #[test]
    fn what_grazes_a_side_is_not_decided() {
        let slanted = System {
            degrees: [1, 1],
            functions: [
                SmallVec::from_slice(&[0.501, -0.499, 1.501, 0.501]),
                SmallVec::from_slice(&[-1.001, -0.001, -1.001, -0.001].map(|v| 2e-3 * v)),
            ],
            weights: SmallVec::from_elem(1.0, 4),
        };
        assert_eq!(isolate(&slanted, 1e-6, 1e-6).map(|roots| roots.len()), Some(0));
        assert!(isolate(&slanted, 1e-5, 1e-6).is_none());
    }
}
