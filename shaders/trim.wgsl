// Whether a point of a face's parameter rectangle belongs to the face; the twin of render/cpu/trim.rs.

const MAX_LEVELS: u32 = 32u;

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
    var is_near = false;
    let word = trim_cell(root, uv, extent, &is_near);
    let kind = word >> 29u;
    if kind < 4u || kind == 7u {
        return TrimPoint(false, true);
    }
    var inside = (word & 0x10000000u) != 0u;
    // A cell of one segment is a list of one, so that `flips` stands once.
    var entry = ((word & 0x0c000000u) << 4u) | (word & MAX_SEGMENT);
    var index = 0u;
    var left = select(0u, 1u, kind == 5u);
    if kind == 6u {
        index = beyond_cells(root) + (word & MAX_OFFSET);
        let head = trim_nodes[index];
        inside = (head >> 31u) == 1u;
        left = head & 0x7fffffffu;
    }
    for (; left > 0u; left--) {
        if kind == 6u {
            index += 1u;
            entry = trim_nodes[index];
        }
        inside = inside != flips(root, entry >> 30u, entry & MAX_SEGMENT, uv, extent, &is_near);
    }
    return TrimPoint(inside, is_near);
}

// The word after the cells, from which offsets count.
fn beyond_cells(root: u32) -> u32 {
    let grid = trim_nodes[root];
    let cells = 1u << ((grid & 15u) + ((grid >> 4u) & 15u));
    return root + HEADER_WORDS + select(cells, (cells + 1u) / 2u, (grid & SHORT) != 0u);
}

fn cell_word(root: u32, grid: u32, index: u32) -> u32 {
    let cells = root + HEADER_WORDS;
    if (grid & SHORT) == 0u {
        return trim_nodes[cells + index];
    }
    return lengthen((trim_nodes[cells + index / 2u] >> (16u * (index & 1u))) & 0xffffu);
}

fn lengthen(short: u32) -> u32 {
    let kind = 0x80000000u | ((short >> 14u) << 29u);
    return kind | select(short & MAX_SHORT_OFFSET, ((short & 0x3800u) << 15u) | (short & MAX_SHORT_SEGMENT), short < 0x8000u);
}

fn trim_cell(root: u32, uv: vec2<f32>, extent: vec2<f32>, is_near: ptr<function, bool>) -> u32 {
    let grid = trim_nodes[root];
    let levels = vec2<u32>(grid & 15u, (grid >> 4u) & 15u);
    let cells = vec2<u32>(1u) << levels;
    let scale = vec2<f32>(cells);
    let scaled = uv * scale;
    let index = min(vec2<u32>(max(scaled, vec2<f32>(0.0))), cells - 1u);
    let within = scaled - vec2<f32>(index);
    let reach = extent * scale;
    *is_near |= any(within <= reach) || any(1.0 - within <= reach);
    var word = cell_word(root, grid, (index.y << levels.x) | index.x);
    if (word >> 29u) != 7u {
        return word;
    }
    var at = beyond_cells(root) + (word & MAX_OFFSET);
    word = trim_nodes[at];
    for (var level = 0u; level < MAX_LEVELS && (word >> 31u) == 0u; level++) {
        let axis = (word >> 30u) & 1u;
        let right = word & FAR;
        let beyond = along_axis(uv, axis) - f32((word >> 16u) & 0x3fffu) * (1.0 / f32(PLANE_STEPS));
        *is_near |= abs(beyond) <= along_axis(extent, axis);
        if beyond < 0.0 {
            at += select(1u, 2u, right == FAR);
        } else if right == FAR {
            at += trim_nodes[at + 1u];
        } else {
            at += right;
        }
        word = trim_nodes[at];
    }
    return word;
}

fn flips(
    root: u32,
    toggles: u32,
    segment_of_face: u32,
    uv: vec2<f32>,
    extent: vec2<f32>,
    is_near: ptr<function, bool>,
) -> bool {
    let segment = trim_segments[trim_nodes[root + 1u] + segment_of_face];
    let low = (toggles & 1u) != 0u && uv.y >= segment.low.y;
    let high = (toggles & 2u) != 0u && uv.y >= segment.high.y;
    return crosses(root, segment, uv, extent, is_near) != (low != high);
}

// The twin asks for two corners of the box and for the point in turn; here that is one loop. A negative extent asks for the point alone.
fn crosses(
    root: u32,
    segment: TrimSegment,
    uv: vec2<f32>,
    extent: vec2<f32>,
    is_near: ptr<function, bool>,
) -> bool {
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
        right = !is_flat && is_right(root, segment, uv + corner);
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

fn is_right(root: u32, segment: TrimSegment, uv: vec2<f32>) -> bool {
    let size = segment.high - segment.low;
    let at = vec2<f32>(uv.x, clamp(uv.y, segment.low.y, segment.high.y)) - segment.low;
    let by_v = (segment.band & BY_V) != 0u;
    let x = select(at.x / size.x, at.y / size.y, by_v);
    let size_y = select(size.y, size.x, by_v);
    let beyond = select(at.y, at.x, by_v) - size_y * band_middle(segment.band, min(max(x, 0.0), 1.0));
    let width = segment.band & 0xffu;
    let half_width = select(bitcast<f32>((width + WIDTH_BIAS) << 20u), 3.0e38, width == 255u);
    let by_band = (beyond > 0.0) == (by_v || size.x < 0.0);
    if abs(beyond) > abs(size_y) * half_width {
        return by_band;
    }
    return is_right_of_segment(root, segment, uv, by_band);
}

fn is_right_of_segment(root: u32, segment: TrimSegment, uv: vec2<f32>, by_band: bool) -> bool {
    if uv.x >= max(segment.low.x, segment.high.x) {
        return true;
    }
    if uv.x < min(segment.low.x, segment.high.x) {
        return false;
    }
    // At its own ends the segment is known to the last bit, while a curve that is level there finds no u.
    if uv.y <= segment.low.y {
        return uv.x >= segment.low.x;
    }
    if uv.y >= segment.high.y {
        return uv.x >= segment.high.x;
    }
    let degree = segment.curve >> 27u;
    if degree == 0u {
        return by_band;
    }
    if degree == 1u {
        let size = segment.high - segment.low;
        return (uv.x - segment.low.x) * size.y >= (uv.y - segment.low.y) * size.x;
    }
    return is_right_of_curve(root, segment, uv);
}

fn band_middle(band: u32, x: f32) -> f32 {
    let bulge = f32(i32(band) >> 19u) * (1.0 / BULGE_STEPS);
    let skew = f32(i32(band << 13u) >> 22u) * (1.0 / SKEW_STEPS);
    return x + 4.0 * x * (1.0 - x) * (bulge + skew * (x + x - 1.0));
}
