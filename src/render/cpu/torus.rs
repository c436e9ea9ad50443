//! Rays against tori, ring, horn and spindle.
//!
//! Ferrari's closed form loses half of f32's digits near tangents. Instead the line is cut until each piece has one root or none, which bracketed Newton steps
//! find. Halves do for most lines: Bernstein coefficients that change their sign once, or not at all, have as many roots. Other halves are cut at the zeros
//! of the quartic's derivatives, found from the second derivative upwards; in each piece the quartic is monotone.
//! All real roots are found, in order, or those that may lie in a span. The quartic itself is evaluated as the product of two differences that do not cancel,
//! `((ρ − R)² + z² − r²) · ((ρ + R)² + z² − r²)` with ρ the distance from the axis; the coefficients serve the derivatives only.

use super::analytic::{Roots, Span};
use super::vector::{Vector3, number};
use crate::numeric::Real;

/// Newton steps and bisections per piece; a bisection each gains a bit, a Newton step doubles the digits.
const MAX_STEPS: usize = 48;

/// The quartic of a line, lengths in units of R + r.
#[derive(Debug, Clone, Copy)]
struct Quartic<T> {
    origin: Vector3<T>,
    direction: Vector3<T>,
    major: T,
    minor: T,
    /// F' = 4 t³ + c2 t² + c1 t + c0.
    c2: T,
    c1: T,
    c0: T,
}

/// Where `(√(x² + y²) − R)² + z² = r²`, its mirror through the axis included; those within the span at least, and none where none is.
///
/// What a box leaves of a line is mostly monotone, so that two values say that there is nothing. Where there may be something the halves of the whole chord are
/// searched that reach into the span, for roots that are the same to the last bit whatever box led to them: of equal hits the lowest face's counts.
pub fn torus_roots<T: Real>(o: Vector3<T>, d: Vector3<T>, major: T, minor: T, span: &Span<T>) -> Roots<T> {
    let mut roots = Roots::none();
    let size = major + minor;
    let length = d.length();
    let direction = d * (T::ONE / length);
    let origin = o * (T::ONE / size);
    // The closest approach to the centre; outside the sphere and the slab around the torus there is nothing.
    let slide = -origin.dot(direction);
    let origin = direction.fused(slide, origin);
    // The torus touches the sphere around it: the chord has to hold the roots there, whatever its square was rounded to.
    let square = T::ONE - origin.dot(origin) + number::<T>(32.0) * T::EPSILON;
    if !(square >= T::ZERO) {
        return roots;
    }
    let half = square.sqrt();
    let [begin, end] = span.scaled(length, T::ONE / size);
    let (mut from, mut to) = (-half, half);
    let quartic = quartic(origin, direction, major / size, minor / size);
    clip_to_slab(&mut from, &mut to, origin.z, direction.z, quartic.minor + number::<T>(16.0) * T::EPSILON);
    let (begin, end) = ((begin - slide).max(from), (end - slide).min(to));
    if !(from < to && begin < end && may_have_roots(&quartic, begin, end)) {
        return roots;
    }
    let places = [from, (from + to) * number(0.5), to];
    let values = places.map(|t| value(&quartic, t));
    for half in 0..2 {
        let [low, high] = [places[half], places[half + 1]];
        if high >= begin && low <= end {
            let values = [values[half], values[half + 1]];
            let add = |t| roots.insert((t + slide) * size / length);
            roots_of_half(&quartic, [low, high], values, [begin, end], add);
        }
    }
    roots
}

/// The roots between two places, where the quartic has the values `first` and `last`; those within a span at least.
fn roots_of_half<T: Real>(
    q: &Quartic<T>,
    [from, to]: [T; 2],
    [first, last]: [T; 2],
    [begin, end]: [T; 2],
    mut add: impl FnMut(T),
) {
    let cuts = match sign_changes(q, [from, to], [first, last]) {
        Some(0) => return,
        Some(1) => Roots::none(),
        _ => critical_points(q, from, to),
    };
    let (mut low, mut f_low) = (from, first);
    for i in 0..=cuts.count {
        let (high, f_high) = if i == cuts.count { (to, last) } else { (cuts.t[i], value(q, cuts.t[i])) };
        let piece = [(low, f_low), (high, f_high)];
        (low, f_low) = (high, f_high);
        if high < begin || piece[0].0 > end {
            continue;
        }
        if let Some(t) = root_between(piece, |t| value(q, t), |t| slope(q, t)) {
            add(t);
        }
        // A least value that is positive by rounding alone: the line touches.
        if i < cuts.count && is_touching(q, high, f_high) {
            add(high);
            add(high);
        }
    }
}

/// Whether the quartic has another sign, or nearly, somewhere between two places than at the first.
fn may_have_roots<T: Real>(q: &Quartic<T>, begin: T, end: T) -> bool {
    let values = [value(q, begin), value(q, end)];
    let is_other = |value: T| (value > T::ZERO) != (values[0] > T::ZERO);
    if is_other(values[1]) {
        return true;
    }
    if sign_changes(q, [begin, end], values) == Some(0) {
        return false;
    }
    if is_other(value(q, (begin + end) * number(0.5))) {
        return true;
    }
    let cuts = critical_points(q, begin, end);
    cuts.t[..cuts.count].iter().any(|&t| {
        let value = value(q, t);
        is_other(value) || is_touching(q, t, value)
    })
}

/// How often the quartic's Bernstein coefficients between two places, where it has the values `first` and `last`, change their sign: it has as many zeros there,
/// or fewer by an even number. `None` where one of them is so near to 0 that it is not known.
fn sign_changes<T: Real>(q: &Quartic<T>, [begin, end]: [T; 2], [first, last]: [T; 2]) -> Option<usize> {
    let width = end - begin;
    // F is of degree four, so that its value and two derivatives at the one end and its value and slope at the other determine it.
    let quarter = width * number(0.25);
    let second = first + slope(q, begin) * quarter;
    let fourth = last - slope(q, end) * quarter;
    let third = curvature(q, begin) * width * width * number(1.0 / 12.0) + second * number(2.0) - first;
    // Coordinates are at most 1, the polynomial's coefficients some ten, and the five are sums of a dozen terms: roundings are below 200 ε.
    let margin = number::<T>(512.0) * T::EPSILON;
    let coefficients = [first, second, third, fourth, last];
    if !coefficients.iter().all(|x| x.abs() > margin) {
        return None;
    }
    Some(coefficients.windows(2).filter(|pair| (pair[0] > T::ZERO) != (pair[1] > T::ZERO)).count())
}

/// Whether the zero `t` of the slope, where the quartic is `least`, is a minimum that roundings keep from 0. Coordinates are at most 1, so that the first factor of the value is off by
/// some `ε r`, and the second is at most `(1 + R)²`.
fn is_touching<T: Real>(q: &Quartic<T>, t: T, least: T) -> bool {
    let reach = T::ONE + q.major;
    least > T::ZERO
        && least <= number::<T>(4.0) * T::EPSILON * q.minor * reach * reach
        && curvature(q, t) > T::ZERO
}

fn quartic<T: Real>(o: Vector3<T>, d: Vector3<T>, major: T, minor: T) -> Quartic<T> {
    let (two, four) = (number::<T>(2.0), number::<T>(4.0));
    let b = o.dot(d);
    let k = o.dot(o) + (major - minor) * (major + minor);
    let r2 = major * major;
    let a2 = d.x * d.x + d.y * d.y;
    let b2 = o.x * d.x + o.y * d.y;
    Quartic {
        origin: o,
        direction: d,
        major,
        minor,
        c2: number::<T>(12.0) * b,
        c1: two * (four * b * b + two * k - four * r2 * a2),
        c0: four * b * k - number::<T>(8.0) * r2 * b2,
    }
}

fn clip_to_slab<T: Real>(from: &mut T, to: &mut T, z: T, dz: T, half: T) {
    if dz.abs() < number(1e-12) {
        if z.abs() > half {
            *to = *from;
        }
        return;
    }
    let (a, b) = ((-half - z) / dz, (half - z) / dz);
    *from = a.min(b).max(*from);
    *to = a.max(b).min(*to);
}

fn value<T: Real>(q: &Quartic<T>, t: T) -> T {
    let p = q.origin + q.direction * t;
    let across = (p.x * p.x + p.y * p.y).sqrt();
    let squares = (p.z - q.minor) * (p.z + q.minor);
    let (near, far) = (across - q.major, across + q.major);
    (near * near + squares) * (far * far + squares)
}

fn slope<T: Real>(q: &Quartic<T>, t: T) -> T {
    ((number::<T>(4.0) * t + q.c2) * t + q.c1) * t + q.c0
}

fn curvature<T: Real>(q: &Quartic<T>, t: T) -> T {
    (number::<T>(12.0) * t + number::<T>(2.0) * q.c2) * t + q.c1
}

/// The zeros of the quartic's derivative strictly inside `(from, to)`.
fn critical_points<T: Real>(q: &Quartic<T>, from: T, to: T) -> Roots<T> {
    let mut inflections = Roots::none();
    let discriminant = q.c2 * q.c2 - number::<T>(12.0) * q.c1;
    if discriminant > T::ZERO {
        let root = discriminant.sqrt();
        for t in [(-q.c2 - root) / number(12.0), (-q.c2 + root) / number(12.0)] {
            if t > from && t < to {
                inflections.insert(t);
            }
        }
    }
    let mut critical = Roots::none();
    let mut low = (from, slope(q, from));
    for i in 0..=inflections.count {
        let high = if i == inflections.count { to } else { inflections.t[i] };
        let high = (high, slope(q, high));
        if let Some(t) = root_between([low, high], |t| slope(q, t), |t| curvature(q, t)) {
            critical.insert(t);
        }
        low = high;
    }
    critical
}

/// The zero of `f`, which has one at most between two places, given with what it is there; `None` where the signs at both ends agree. A zero at the first place
/// counts, one at the second does not: it belongs to the next piece.
#[inline]
fn root_between<T: Real>(
    [(mut low, f_low), (mut high, f_high)]: [(T, T); 2],
    f: impl Fn(T) -> T,
    derivative: impl Fn(T) -> T,
) -> Option<T> {
    let rising = f_low < T::ZERO || (f_low == T::ZERO && f_high > T::ZERO);
    if rising && !(f_high > T::ZERO) || !rising && !(f_high < T::ZERO) {
        return None;
    }
    let mut t = low + (high - low) * (f_low / (f_low - f_high));
    for _ in 0..MAX_STEPS {
        let f_t = f(t);
        if (f_t > T::ZERO) == rising {
            high = t;
        } else {
            low = t;
        }
        let newton = t - f_t / derivative(t);
        let next = if newton > low && newton < high { newton } else { low + (high - low) * number::<T>(0.5) };
        let step = (next - t).abs();
        t = next;
        if step <= T::EPSILON * number(2.0) {
            break;
        }
    }
    Some(t)
}

#[cfg(test)]
mod tests {
    use super::super::footprint::LONGEST;
    use super::super::test_scenes::Random;
    use super::*;

    /// The roots in a line's span are found, the same to the last bit as without a span, and none that are far from it where it holds none.
    fn spans_leave_out_lines_without_roots<T: Real>(tolerance: f64) {
        let mut random = Random(11);
        let mut counts = [0; 5];
        for _ in 0..20_000 {
            let scale = 10.0_f64.powf(random.unit() * 4.0 - 2.0);
            let [major, minor] = [scale, scale * (0.05 + random.unit())];
            let size = major + minor;
            let [a, b] = [random.point(size), random.point(size)];
            let line = |t: f64| a + (b - a) * t;
            let (o, d) = (a.to_array(), (b - a).to_array());
            let (o, d) = (Vector3::<T>::from_f64(o), Vector3::<T>::from_f64(d));
            let all = torus_roots(o, d, T::from_f64(major), T::from_f64(minor), &Span::whole());
            let middle = random.unit() * 2.0 - 0.5;
            let half = random.unit() * 0.5;
            let ends = [middle - half, middle + half].map(T::from_f64);
            let span = Span { ends, slack: T::from_f64(size * 1e-6) };
            let some = torus_roots(o, d, T::from_f64(major), T::from_f64(minor), &span);
            let all: Vec<f64> = all.t[..all.count].iter().map(|t| t.to_f64()).collect();
            let some: Vec<f64> = some.t[..some.count].iter().map(|t| t.to_f64()).collect();
            // Lines that nearly touch aside.
            let is_clear = all.windows(2).all(|pair| (line(pair[1]) - line(pair[0])).length() > 1e-2 * size);
            if !is_clear {
                continue;
            }
            let length = (line(1.0) - line(0.0)).length();
            let beyond = |by: f64| half + by * size / length;
            let is_within = |t: f64, reach: f64| (t - middle).abs() <= reach;
            assert!(some.iter().all(|t| all.contains(t)), "{all:?} {some:?} {span:?}");
            assert!(
                all.iter().all(|&t| !is_within(t, half) || some.contains(&t)),
                "{all:?} {some:?} {span:?}"
            );
            if !all.iter().any(|&t| is_within(t, beyond(LONGEST * 1e-6 + tolerance))) {
                assert!(some.is_empty(), "{all:?} {some:?} {span:?}");
            }
            counts[some.len()] += 1;
        }
        assert!(counts[..3].iter().all(|&count| count > 1000) && counts[4] > 10, "{counts:?}");
    }

    #[test]
    fn lines_without_roots_in_their_span_are_left_out_and_no_others() {
        spans_leave_out_lines_without_roots::<f64>(1e-12);
        spans_leave_out_lines_without_roots::<f32>(2e-5);
    }
}
