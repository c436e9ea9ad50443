// What WGSL's built-ins are not accurate enough for: Vulkan allows atan2 an error of 4096 ulp, and sin and cos an absolute one of 2⁻¹¹.
// Minimax polynomials of the Cephes library (S. L. Moshier, single precision), good to about 2 ulp; the twins are the methods of `Real`.

const HALF_PI: f32 = 1.57079632679489661923;
const EPSILON: f32 = 1.1920929e-7;
const INFINITE: f32 = 0x1.fffffep+127;

fn is_finite(x: f32) -> bool {
    return (bitcast<u32>(x) & 0x7f800000u) != 0x7f800000u;
}

fn signum(x: f32) -> f32 {
    return select(1.0, -1.0, (bitcast<u32>(x) >> 31u) == 1u);
}

fn real_atan2(y: f32, x: f32) -> f32 {
    let ax = abs(x);
    let ay = abs(y);
    let least = min(ax, ay);
    let most = max(ax, ay);
    if most == 0.0 {
        return 0.0;
    }
    // The angle of (most, least) in [0, π/4]: above tan(π/8) it is measured from π/4.
    let far = least > 0.41421356 * most;
    let q = select(least / most, (least - most) / (least + most), far);
    let z = q * q;
    let series = (((8.05374449538e-2 * z - 1.38776856032e-1) * z + 1.99777106478e-1) * z - 3.33329491539e-1) * z * q + q;
    var angle = select(series, HALF_PI * 0.5 + series, far);
    angle = select(angle, HALF_PI - angle, ay > ax);
    angle = select(angle, 2.0 * HALF_PI - angle, x < 0.0);
    return select(angle, -angle, y < 0.0);
}

// Sine, cosine; for |x| up to some thousands.
fn real_sin_cos(x: f32) -> vec2<f32> {
    let quarters = floor(x / HALF_PI + 0.5);
    // π/2 in three parts, the first two with so few bits that the products are exact.
    let r = ((x - quarters * 1.5703125) - quarters * 4.837512969970703125e-4) - quarters * 7.54978995489188216e-8;
    let z = r * r;
    let s = ((-1.9515295891e-4 * z + 8.3321608736e-3) * z - 1.6666654611e-1) * z * r + r;
    let c = ((2.443315711809948e-5 * z - 1.388731625493765e-3) * z + 4.166664568298827e-2) * z * z - 0.5 * z + 1.0;
    let quadrant = i32(quarters) & 3;
    let swapped = (quadrant & 1) == 1;
    let sine = select(s, c, swapped);
    let cosine = select(c, s, swapped);
    return vec2<f32>(select(sine, -sine, quadrant >= 2), select(cosine, -cosine, quadrant == 1 || quadrant == 2));
}

// The coordinate along an axis, 0 or 1: a choice, as an index would send the vector through memory.
fn along_axis(v: vec2<f32>, axis: u32) -> f32 {
    return select(v.x, v.y, axis == 1u);
}

fn count_along(v: vec2<u32>, axis: u32) -> u32 {
    return select(v.x, v.y, axis == 1u);
}

fn with_count_along(v: vec2<u32>, axis: u32, value: u32) -> vec2<u32> {
    return select(vec2<u32>(value, v.y), vec2<u32>(v.x, value), axis == 1u);
}
