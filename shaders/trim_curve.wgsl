// Which side of a monotone piece of a rational Bézier curve a point lies on; the twin of render/cpu/trim_curve.rs.

const MAX_STEPS: u32 = 104u;

fn is_right_of_curve(segment: TrimSegment, first_point: u32, uv: vec2<f32>) -> bool {
    let degree = segment.curve >> 27u;
    let first = first_point + (segment.curve & POINT_MASK);
    let falls = (segment.curve & FALLS) != 0u;
    var low = segment.low;
    var high = segment.high;
    var t_low = select(0.0, 1.0, falls);
    var t_high = 1.0 - t_low;
    var v_low = curve_end(first, degree, falls);
    var v_high = curve_end(first, degree, !falls);
    for (var step = 0u; step < MAX_STEPS; step++) {
        let middle = (t_low + t_high) * 0.5;
        if middle == t_low || middle == t_high {
            break;
        }
        let secant = t_low + (t_high - t_low) * ((uv.y - v_low) / (v_high - v_low));
        let is_between = (secant > t_low && secant < t_high) || (secant < t_low && secant > t_high);
        let t = select(middle, secant, step % 3u != 2u && is_between);
        let at = curve_point(first, degree, t);
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

fn curve_end(first: u32, degree: u32, is_last: bool) -> f32 {
    let end = control_point(first + select(0u, degree, is_last));
    return end.y / end.z;
}

fn control_point(index: u32) -> vec3<f32> {
    return vec3<f32>(trim_points[3u * index], trim_points[3u * index + 1u], trim_points[3u * index + 2u]);
}

fn curve_point(first: u32, degree: u32, t: f32) -> vec2<f32> {
    let s = 1.0 - t;
    var factor = 1.0;
    var sum = control_point(first) * s;
    for (var i = 1u; i < degree; i++) {
        factor = factor * t * (f32(degree + 1u - i) / f32(i));
        sum = (sum + control_point(first + i) * factor) * s;
    }
    let power = factor * t / f32(degree);
    let end = sum + control_point(first + degree) * power;
    return end.xy / end.z;
}
