// Whether a hit belongs to a face; the twin of render/cpu/cover.rs.

const OUTSIDE: u32 = 0u;
const BORDER: u32 = 1u;
const NEAR: u32 = 2u;
const INSIDE: u32 = 3u;

fn to_window(parameter: f32, period: f32) -> f32 {
    if !(period > 0.0) {
        return parameter;
    }
    let p = parameter - floor(parameter / period) * period;
    return select(p, p - period, p > 1.0 && p - 1.0 > period - p);
}

fn is_far_outside(uv: vec2<f32>) -> bool {
    return !(all(uv > vec2<f32>(-0.5)) && all(uv < vec2<f32>(1.5)));
}

// The twin's centre and its four places are one loop here, so that the walk down the tree stands once.
// All faces of a part are tried at the same sides of `direction`, part space, turned to the face's axes; those of nets are part space's own.
fn cover(face: u32, at: vec2<f32>, margin: vec2<f32>, print: Footprint, direction: vec3<f32>) -> u32 {
    let half_box = extent(print);
    let reach = half_box + margin;
    if any(at < -reach) || any(at > 1.0 + reach) {
        return OUTSIDE;
    }
    let period = faces[face].period;
    let is_near_end = any(at < reach) || any(at > 1.0 - reach);
    var uv = at;
    var is_center_inside = false;
    var o: Sides;
    for (var side = 0u; side < 5u; side++) {
        if side > 0u {
            let beside = place(print, at, o, side - 1u);
            uv = vec2<f32>(to_window(beside.x, period.x), to_window(beside.y, period.y));
        }
        let point = trim_point(faces[face].trim_root, clamp(uv, vec2<f32>(0.0), vec2<f32>(1.0)), select(vec2<f32>(-1.0), half_box, side == 0u));
        let is_inside = point.inside && all(uv >= -margin) && all(uv <= 1.0 + margin);
        if side == 0u {
            if !(point.is_near || is_near_end) {
                return select(OUTSIDE, INSIDE, is_inside);
            }
            if (faces[face].flags & ALONE) != 0u {
                return select(OUTSIDE, BORDER, is_inside);
            }
            is_center_inside = is_inside;
            o = sides(direction);
            o = Sides(apply_axes(face, o.first), apply_axes(face, o.second));
        } else if is_inside != is_center_inside {
            return BORDER;
        }
    }
    return select(OUTSIDE, NEAR, is_center_inside);
}

fn window_margin(low: f32, scale: f32) -> f32 {
    return 4.0 * EPSILON * abs(low * scale);
}
