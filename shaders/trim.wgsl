// Whether a point of a face's parameter rectangle belongs to the face; the twin of render/cpu/trim.rs.

const MAX_BISECTIONS: u32 = 52u;
const MAX_LEVELS: u32 = 64u;

fn split_position(low: f32, size: f32, plane: u32) -> f32 {
    return low + f32(plane) * (1.0 / f32(PLANE_STEPS)) * size;
}

struct TrimPoint {
    inside: bool,
    is_near: bool,
}

fn trim_point(root: u32, at: vec2<f32>, extent: vec2<f32>) -> TrimPoint {
    if root == TRIM_INSIDE {
        return TrimPoint(true, false);
    }
    if TRIM_STRUCTURE != PACKED {
        return TrimPoint(study_inside(root, at), false);
    }
    let uv = min(at, vec2<f32>(BEFORE_ONE));
    var node = root;
    var low = vec2<f32>(0.0);
    var size = vec2<f32>(1.0);
    var is_near = false;
    for (var level = 0u; level < MAX_LEVELS; level++) {
        let word = trim_nodes[node];
        if (word & LEAF_BIT) == 0u {
            let axis = (word >> 30u) & 1u;
            let right = word & FAR;
            let is_far = right == FAR;
            let split = split_position(low[axis], size[axis], (word >> 16u) & 0x3fffu);
            let beyond = uv[axis] - split;
            is_near |= abs(beyond) <= extent[axis];
            if beyond < 0.0 {
                size[axis] = split - low[axis];
                node += select(1u, 2u, is_far);
            } else {
                size[axis] = size[axis] - (split - low[axis]);
                low[axis] = split;
                if is_far {
                    node += trim_nodes[node + 1u];
                } else {
                    node += right;
                }
            }
        } else {
            let first = trim_nodes[root - 1u] + (word & 0xffffffu);
            var count = (word >> 24u) & 63u;
            if count == MANY {
                count = trim_nodes[node + 1u];
            }
            let inside = leaf_parity((word & 0x40000000u) != 0u, first, count, uv, extent, &is_near);
            return TrimPoint(inside, is_near);
        }
    }
    return TrimPoint(false, true);
}

fn leaf_parity(
    corner: bool,
    first: u32,
    count: u32,
    uv: vec2<f32>,
    extent: vec2<f32>,
    is_near: ptr<function, bool>,
) -> bool {
    var inside = corner;
    for (var index = first; index < first + count; index++) {
        let segment = trim_segments[index];
        inside = inside != (crosses(segment, uv, extent, is_near) != crosses_left_edge(segment, uv.y));
    }
    return inside;
}

fn crosses_left_edge(segment: TrimSegment, v: f32) -> bool {
    let low = (segment.flags & LOW_ON_LEFT_EDGE) != 0u && v >= segment.low.y;
    let high = (segment.flags & HIGH_ON_LEFT_EDGE) != 0u && v >= segment.high.y;
    return low != high;
}

// The twin asks for two corners of the box and for the point in turn; here that is one loop.
fn crosses(segment: TrimSegment, uv: vec2<f32>, extent: vec2<f32>, is_near: ptr<function, bool>) -> bool {
    let at_height = uv.y >= segment.low.y && uv.y < segment.high.y;
    let reach = max(extent, vec2<f32>(0.0));
    if uv.y + reach.y < segment.low.y || uv.y - reach.y > segment.high.y {
        return false;
    }
    if uv.x - reach.x >= max(segment.low.x, segment.high.x) {
        return at_height;
    }
    if uv.x + reach.x < min(segment.low.x, segment.high.x) {
        return false;
    }
    let is_wide = extent.x >= 0.0;
    let up = select(-reach.y, reach.y, segment.high.x >= segment.low.x);
    let is_flat = segment.low.y == segment.high.y;
    var right = false;
    for (var k = select(2u, 0u, is_wide && !is_flat); k < 3u; k++) {
        var corner = vec2<f32>(0.0);
        if k == 0u {
            corner = vec2<f32>(-reach.x, up);
        } else if k == 1u {
            corner = vec2<f32>(reach.x, -up);
        }
        right = !is_flat && is_right(segment, uv + corner);
        if k == 0u && right {
            return at_height;
        }
        if k == 1u && !right {
            return false;
        }
    }
    *is_near |= is_wide;
    return at_height && right;
}

fn is_right(segment: TrimSegment, uv: vec2<f32>) -> bool {
    let v = min(max(uv.y, segment.low.y), segment.high.y);
    let degree = segment.flags & DEGREE_MASK;
    if degree <= 1u {
        return line_at(segment.low, segment.high, v) <= uv.x;
    }
    return bisect(segment, degree, vec2<f32>(uv.x, v));
}

fn line_at(low: vec2<f32>, high: vec2<f32>, v: f32) -> f32 {
    return low.x + (high.x - low.x) * ((v - low.y) / (high.y - low.y));
}

fn bisect(segment: TrimSegment, degree: u32, uv: vec2<f32>) -> bool {
    var low = segment.low;
    var high = segment.high;
    var t_low = segment.t_low;
    var t_high = segment.t_high;
    if uv.x >= max(low.x, high.x) || uv.x < min(low.x, high.x) {
        return uv.x >= max(low.x, high.x);
    }
    for (var i = 0u; i < MAX_BISECTIONS; i++) {
        let t = (t_low + t_high) * 0.5;
        if t == t_low || t == t_high {
            break;
        }
        let at = curve_point(segment.curve, degree, t);
        if at.y <= uv.y {
            low = at;
            t_low = t;
        } else {
            high = at;
            t_high = t;
        }
        if uv.x >= max(low.x, high.x) {
            return true;
        }
        if uv.x < min(low.x, high.x) {
            return false;
        }
    }
    return line_at(low, high, uv.y) <= uv.x;
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
