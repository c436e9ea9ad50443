// Whether a point of a face's parameter rectangle belongs to the face; the twin of render/cpu/trim.rs.

const MAX_BISECTIONS: u32 = 52u;
const MAX_LEVELS: u32 = 64u;

fn split_position(low: f32, size: f32, plane: u32) -> f32 {
    return low + f32(plane) * (1.0 / f32(PLANE_STEPS)) * size;
}

fn trim_inside(root: u32, uv: vec2<f32>) -> bool {
    if root == TRIM_INSIDE {
        return true;
    }
    var node = root;
    var low = vec2<f32>(0.0);
    var size = vec2<f32>(1.0);
    for (var level = 0u; level < MAX_LEVELS; level++) {
        let word = trim_nodes[node];
        if (word & LEAF_BIT) == 0u {
            let axis = (word >> 30u) & 1u;
            let right = word & FAR;
            let is_far = right == FAR;
            let split = split_position(low[axis], size[axis], (word >> 16u) & 0x3fffu);
            if uv[axis] < split {
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
            return leaf_parity((word & 0x40000000u) != 0u, first, count, uv);
        }
    }
    return false;
}

fn leaf_parity(corner: bool, first: u32, count: u32, uv: vec2<f32>) -> bool {
    var inside = corner;
    for (var index = first; index < first + count; index++) {
        let segment = trim_segments[index];
        inside = inside != (crosses(segment, uv) != crosses_left_edge(segment, uv.y));
    }
    return inside;
}

fn crosses_left_edge(segment: TrimSegment, v: f32) -> bool {
    let low = (segment.flags & LOW_ON_LEFT_EDGE) != 0u && v >= segment.low.y;
    let high = (segment.flags & HIGH_ON_LEFT_EDGE) != 0u && v >= segment.high.y;
    return low != high;
}

fn crosses(segment: TrimSegment, uv: vec2<f32>) -> bool {
    if !(uv.y >= segment.low.y && uv.y < segment.high.y) {
        return false;
    }
    if uv.x >= max(segment.low.x, segment.high.x) {
        return true;
    }
    if uv.x < min(segment.low.x, segment.high.x) {
        return false;
    }
    let degree = segment.flags & DEGREE_MASK;
    if degree <= 1u {
        return line_at(segment.low, segment.high, uv.y) <= uv.x;
    }
    return bisect(segment, degree, uv);
}

fn line_at(low: vec2<f32>, high: vec2<f32>, v: f32) -> f32 {
    return low.x + (high.x - low.x) * ((v - low.y) / (high.y - low.y));
}

fn bisect(segment: TrimSegment, degree: u32, uv: vec2<f32>) -> bool {
    var low = segment.low;
    var high = segment.high;
    var t_low = segment.t_low;
    var t_high = segment.t_high;
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

fn trim_point(index: u32) -> vec3<f32> {
    return vec3<f32>(trim_points[3u * index], trim_points[3u * index + 1u], trim_points[3u * index + 2u]);
}

fn curve_point(first: u32, degree: u32, t: f32) -> vec2<f32> {
    let s = 1.0 - t;
    var factor = 1.0;
    var sum = trim_point(first) * s;
    for (var i = 1u; i < degree; i++) {
        factor = factor * t * (f32(degree + 1u - i) / f32(i));
        sum = (sum + trim_point(first + i) * factor) * s;
    }
    let power = factor * t / f32(degree);
    let end = sum + trim_point(first + degree) * power;
    return end.xy / end.z;
}
