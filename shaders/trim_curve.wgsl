// Which side of a monotone piece of a rational Bézier curve a point lies on; the twin of render/cpu/trim_curve.rs.

const MAX_CURVE_STEPS: u32 = 104u;

fn is_right_of_curve(root: u32, segment: TrimSegment, uv: vec2<f32>) -> bool {
    let degree = segment.curve >> 27u;
    let is_rational = (segment.curve & RATIONAL) != 0u;
    let first = root + (segment.curve & OFFSET_MASK);
    let falls = (segment.curve & FALLS) != 0u;
    var low = segment.low;
    var high = segment.high;
    var t_low = select(0.0, 1.0, falls);
    var t_high = 1.0 - t_low;
    var v_low = control_point(first, degree, is_rational, select(0u, degree, falls)).y;
    var v_high = control_point(first, degree, is_rational, select(degree, 0u, falls)).y;
    for (var step = 0u; step < MAX_CURVE_STEPS; step++) {
        let middle = (t_low + t_high) * 0.5;
        if middle == t_low || middle == t_high {
            break;
        }
        let secant = t_low + (t_high - t_low) * ((uv.y - v_low) / (v_high - v_low));
        let is_between = (secant > t_low && secant < t_high) || (secant < t_low && secant > t_high);
        let t = select(middle, secant, step % 3u != 2u && is_between);
        let at = curve_at(first, degree, is_rational, t);
        if at.y <= uv.y {
            t_low = t;
            v_low = at.y;
            if at.y >= low.y {
                low = at;
            }
        } else {
            t_high = t;
            v_high = at.y;
            if at.y <= high.y {
                high = at;
            }
        }
        if uv.x >= max(low.x, high.x) {
            return true;
        }
        if uv.x < min(low.x, high.x) {
            return false;
        }
    }
    return (uv.x - low.x) * (high.y - low.y) >= (uv.y - low.y) * (high.x - low.x);
}

fn control_point(first: u32, degree: u32, is_rational: bool, index: u32) -> vec3<f32> {
    let place = first + select(2u * index, max(3u * index, 1u) - 1u, is_rational);
    let uv = vec2<f32>(bitcast<f32>(trim_nodes[place]), bitcast<f32>(trim_nodes[place + 1u]));
    if is_rational && index > 0u && index < degree {
        return vec3<f32>(uv, bitcast<f32>(trim_nodes[place + 2u]));
    }
    return vec3<f32>(uv, 1.0);
}

fn curve_at(first: u32, degree: u32, is_rational: bool, t: f32) -> vec2<f32> {
    let s = 1.0 - t;
    var factor = 1.0;
    var sum = control_point(first, degree, is_rational, 0u) * s;
    for (var i = 1u; i < degree; i++) {
        factor = factor * t * (f32(degree + 1u - i) / f32(i));
        sum = (sum + control_point(first, degree, is_rational, i) * factor) * s;
    }
    let power = factor * t / f32(degree);
    let end = sum + control_point(first, degree, is_rational, degree) * power;
    return end.xy / end.z;
}
