//! Which side of a monotone piece of a rational Bézier curve a point lies on: a bracketed search for the curve's point at the same height.

use super::vector::number;
use crate::numeric::Real;
use crate::scene::{Scene, TrimSegment};

/// Steps of the search: bisections enough for f64's 52 bits, and as many secant steps between.
const MAX_STEPS: usize = 104;

/// Whether the curve of `segment`, of degree 2 or more, passes left of `uv`, whose v lies between the segment's ends.
///
/// Each evaluated point narrows the box in which the curve passes the height, and the search ends as soon as the point is outside of it
/// (Schollmeyer and Fröhlich 2009). They bisect; here bisections alternate with secants, as the points that come this far lie near the curve.
/// `evaluations` counts them.
pub fn is_right_of_curve<T: Real>(
    scene: &Scene<'_>,
    segment: &TrimSegment,
    first_point: u32,
    uv: [T; 2],
    evaluations: &mut u64,
) -> bool {
    let degree = segment.degree();
    let first = first_point + (segment.curve & TrimSegment::POINT_MASK);
    let falls = segment.curve & TrimSegment::FALLS != 0;
    let mut low = segment.low.map(T::from_f32);
    let mut high = segment.high.map(T::from_f32);
    // Parameters of points at most and at least as high as uv; the curve may reach beyond the segment.
    let (mut t_low, mut t_high) = if falls { (T::ONE, T::ZERO) } else { (T::ZERO, T::ONE) };
    let end = |t: T| {
        let p = scene.trim_points[(first + if t == T::ZERO { 0 } else { degree }) as usize].map(T::from_f32);
        p[1] / p[2]
    };
    let (mut v_low, mut v_high) = (end(t_low), end(t_high));
    for step in 0..MAX_STEPS {
        let middle = (t_low + t_high) * number(0.5);
        if middle == t_low || middle == t_high {
            break;
        }
        let secant = t_low + (t_high - t_low) * ((uv[1] - v_low) / (v_high - v_low));
        let is_between = (secant > t_low && secant < t_high) || (secant < t_low && secant > t_high);
        let t = if step % 3 != 2 && is_between { secant } else { middle };
        let at = curve_point(scene, first, degree, t);
        *evaluations += 1;
        if at[1] <= uv[1] {
            (t_low, v_low) = (t, at[1]);
            if at[1] >= low[1] {
                low = at;
            }
        } else {
            (t_high, v_high) = (t, at[1]);
            if at[1] <= high[1] {
                high = at;
            }
        }
        if uv[0] >= low[0].max(high[0]) {
            return true;
        }
        if uv[0] < low[0].min(high[0]) {
            return false;
        }
    }
    (uv[0] - low[0]) * (high[1] - low[1]) >= (uv[1] - low[1]) * (high[0] - low[0])
}

/// The point of a rational Bézier curve by Horner's scheme in Bernstein form.
#[inline]
pub fn curve_point<T: Real>(scene: &Scene<'_>, first: u32, degree: u32, t: T) -> [T; 2] {
    let point = |i: u32| scene.trim_points[(first + i) as usize].map(T::from_f32);
    let s = T::ONE - t;
    let mut factor = T::ONE;
    let start = point(0);
    let mut sum = [start[0] * s, start[1] * s, start[2] * s];
    for i in 1..degree {
        // binomial(n, i) tⁱ from the one before.
        factor = factor * t * (T::from_f32((degree + 1 - i) as f32) / T::from_f32(i as f32));
        let p = point(i);
        sum = [(sum[0] + p[0] * factor) * s, (sum[1] + p[1] * factor) * s, (sum[2] + p[2] * factor) * s];
    }
    let power = factor * t / T::from_f32(degree as f32);
    let p = point(degree);
    let weight = sum[2] + p[2] * power;
    [(sum[0] + p[0] * power) / weight, (sum[1] + p[1] * power) / weight]
}
