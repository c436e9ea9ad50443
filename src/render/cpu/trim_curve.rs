//! Which side of a monotone piece of a rational Bézier curve a point lies on: a bracketed search for the curve's point at the same height.

use super::vector::number;
use crate::numeric::Real;
use crate::scene::TrimSegment;

/// Steps of the search: bisections enough for f64's 52 bits, and as many secant steps between.
const MAX_CURVE_STEPS: usize = 104;

/// What a segment says of a point when its band does not.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ExactTest {
    /// Whether it passes left of the point.
    pub is_right: bool,
    /// Curve points evaluated; `None` where no curve was asked.
    pub evaluations: Option<u32>,
}

impl ExactTest {
    /// Without a curve.
    pub fn by_ends(is_right: bool) -> Self {
        Self { is_right, evaluations: None }
    }
}

/// Whether the curve of `segment`, of degree 2 or more, passes left of `uv`, whose v lies between the segment's ends.
///
/// Each evaluated point narrows the box in which the curve passes the height, and the search ends as soon as the point is outside of it
/// (Schollmeyer and Fröhlich 2009). They bisect; here bisections alternate with secants, as the points that come this far lie near the curve.
/// `words` are those of the face from its root.
pub fn is_right_of_curve<T: Real>(words: &[u32], segment: &TrimSegment, uv: [T; 2]) -> ExactTest {
    let curve = Curve {
        words: &words[(segment.curve & TrimSegment::OFFSET_MASK) as usize..],
        degree: segment.degree(),
        is_rational: segment.curve & TrimSegment::RATIONAL != 0,
    };
    let falls = segment.curve & TrimSegment::FALLS != 0;
    let mut low = segment.low.map(T::from_f32);
    let mut high = segment.high.map(T::from_f32);
    // Parameters of points at most and at least as high as uv; the curve may reach beyond the segment.
    let (mut t_low, mut t_high) = if falls { (T::ONE, T::ZERO) } else { (T::ZERO, T::ONE) };
    let end = |is_last: bool| curve.control_point::<T>(if is_last { curve.degree } else { 0 })[1];
    let (mut v_low, mut v_high) = (end(falls), end(!falls));
    let answer =
        |is_right: bool, evaluations: usize| ExactTest { is_right, evaluations: Some(evaluations as u32) };
    for step in 0..MAX_CURVE_STEPS {
        let middle = (t_low + t_high) * number(0.5);
        if middle == t_low || middle == t_high {
            return answer(is_right_of_chord(low, high, uv), step);
        }
        let secant = t_low + (t_high - t_low) * ((uv[1] - v_low) / (v_high - v_low));
        let is_between = (secant > t_low && secant < t_high) || (secant < t_low && secant > t_high);
        let t = if step % 3 != 2 && is_between { secant } else { middle };
        let at = curve.curve_at(t);
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
            return answer(true, step + 1);
        }
        if uv[0] < low[0].min(high[0]) {
            return answer(false, step + 1);
        }
    }
    answer(is_right_of_chord(low, high, uv), MAX_CURVE_STEPS)
}

/// Whether the chord from `low` to `high`, which is not level, passes left of `uv`.
pub fn is_right_of_chord<T: Real>(low: [T; 2], high: [T; 2], uv: [T; 2]) -> bool {
    (uv[0] - low[0]) * (high[1] - low[1]) >= (uv[1] - low[1]) * (high[0] - low[0])
}

/// A Bézier curve among the words of a face; see [`crate::scene::trim_word`].
struct Curve<'a> {
    words: &'a [u32],
    degree: u32,
    is_rational: bool,
}

impl Curve<'_> {
    /// Control point `index`, homogeneous.
    fn control_point<T: Real>(&self, index: u32) -> [T; 3] {
        let place = if self.is_rational { (3 * index).saturating_sub(1) } else { 2 * index } as usize;
        let number = |place: usize| T::from_f32(f32::from_bits(self.words[place]));
        let has_weight = self.is_rational && index > 0 && index < self.degree;
        [number(place), number(place + 1), if has_weight { number(place + 2) } else { T::ONE }]
    }

    /// The point at `t`.
    fn curve_at<T: Real>(&self, t: T) -> [T; 2] {
        rational_point(self.degree, t, |index| self.control_point(index))
    }
}

/// The point at `t` of a rational Bézier curve, given its homogeneous control points, by Horner's scheme in Bernstein form.
#[inline(always)]
pub fn rational_point<T: Real>(degree: u32, t: T, control: impl Fn(u32) -> [T; 3]) -> [T; 2] {
    let s = T::ONE - t;
    let mut factor = T::ONE;
    let start = control(0);
    let mut sum = [start[0] * s, start[1] * s, start[2] * s];
    for i in 1..degree {
        // binomial(n, i) tⁱ from the one before.
        factor = factor * t * (T::from_f32((degree + 1 - i) as f32) / T::from_f32(i as f32));
        let p = control(i);
        sum = [(sum[0] + p[0] * factor) * s, (sum[1] + p[1] * factor) * s, (sum[2] + p[2] * factor) * s];
    }
    let power = factor * t / T::from_f32(degree as f32);
    let end = control(degree);
    let weight = sum[2] + end[2] * power;
    [(sum[0] + end[0] * power) / weight, (sum[1] + end[1] * power) / weight]
}
