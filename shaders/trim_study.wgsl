// Trim queries of the study's methods; the twin of render/cpu/trim_study.rs. One structure and one kind of bounds is all of a kernel.

const MAX_BISECTIONS: u32 = 52u;

fn number_at(index: u32) -> f32 {
    return bitcast<f32>(trim_nodes[index]);
}

fn study_inside(root: u32, at: vec2<f32>) -> bool {
    let uv = min(at, vec2<f32>(BEFORE_ONE));
    if TRIM_STRUCTURE == LIST {
        return list(root, uv);
    }
    if TRIM_STRUCTURE == SLABS {
        return slabs(root, uv);
    }
    return kd_tree(root, uv);
}

fn list(root: u32, uv: vec2<f32>) -> bool {
    let count = trim_nodes[root + 1u];
    var inside = false;
    for (var index = 0u; index < count; index++) {
        inside = inside != element(root, root + 2u + index * RECORD_WORDS, uv);
    }
    return inside;
}

// Which of `count` intervals between `count + 1` ascending numbers holds x; NO_INTERVAL where none does.
fn interval_at(place: u32, count: u32, x: f32) -> u32 {
    if count == 0u || x < number_at(place) || !(x < number_at(place + count)) {
        return NO_INTERVAL;
    }
    var first = 0u;
    var end = count;
    while end - first > 1u {
        let middle = (first + end) / 2u;
        if x < number_at(place + middle) {
            end = middle;
        } else {
            first = middle;
        }
    }
    return first;
}

fn slabs(root: u32, uv: vec2<f32>) -> bool {
    let count = trim_nodes[root + 1u];
    let slab = interval_at(root + 2u, count, uv.y);
    if slab == NO_INTERVAL {
        return false;
    }
    let start = root + trim_nodes[root + 2u + count + 1u + slab];
    let intervals = trim_nodes[start];
    let interval = interval_at(start + 1u, intervals, uv.x);
    if interval == NO_INTERVAL {
        return false;
    }
    let word = trim_nodes[start + 1u + intervals + 1u + interval];
    var inside = (word & ODD_BIT) != 0u;
    var place = word & (PLACES - 1u);
    var number = (word >> 24u) & MANY_CURVES;
    let is_single = number == 1u;
    if number == MANY_CURVES {
        number = trim_nodes[root + place];
        place += 1u;
    }
    for (var k = 0u; k < number; k++) {
        var curve = place;
        if !is_single {
            curve = trim_nodes[root + place + k];
        }
        inside = inside != element(root, root + curve, uv);
    }
    return inside;
}

fn kd_tree(root: u32, uv: vec2<f32>) -> bool {
    let low = vec2<f32>(number_at(root + 1u), number_at(root + 2u));
    let high = vec2<f32>(number_at(root + 3u), number_at(root + 4u));
    if !(all(uv >= low) && all(uv < high)) {
        return false;
    }
    var node = root + KD_HEADER;
    var word = trim_nodes[node + 1u];
    while (word >> 30u) < STUDY_LEAF {
        let is_left = uv[word >> 30u] < number_at(node);
        node += select(word & (HIGH_IS_LEFT - 1u), 2u, is_left);
        word = trim_nodes[node + 1u];
    }
    return leaf(root, node, word, uv);
}

fn leaf(root: u32, node: u32, word: u32, uv: vec2<f32>) -> bool {
    var inside = (word & PARITY_BIT) != 0u;
    let count = word & (PARITY_BIT - 1u);
    var first = node;
    if count != 1u {
        first = root + trim_nodes[node];
    }
    for (var k = 0u; k < count; k++) {
        let reference = trim_nodes[first + k];
        let place = root + (reference & (HIGH_IS_LEFT - 1u));
        let passes = curveset(root, place, uv);
        inside = inside != (passes != passes_ends(reference, place, uv.y));
    }
    return inside;
}

fn passes_ends(reference: u32, place: u32, v: f32) -> bool {
    let low = (reference & LOW_IS_LEFT) != 0u && v >= number_at(place + 1u);
    let high = (reference & HIGH_IS_LEFT) != 0u && v >= number_at(place + 3u);
    return low != high;
}

// The twin has curvesets and elements apart; here the element's own test stands once.
fn curveset(root: u32, place: u32, uv: vec2<f32>) -> bool {
    if TRIM_STRUCTURE != KD_CURVESETS {
        return element(root, place, uv);
    }
    let side = side_of_box(place, uv);
    if side != UNDECIDED {
        return side == LEFT;
    }
    let first = root + trim_nodes[place + 4u];
    var low = 0u;
    var end = trim_nodes[place + 5u];
    while end - low > 1u {
        let middle = (low + end) / 2u;
        if uv.y < number_at(first + middle * RECORD_WORDS + 1u) {
            end = middle;
        } else {
            low = middle;
        }
    }
    return element(root, first + low * RECORD_WORDS, uv);
}

fn element(root: u32, place: u32, uv: vec2<f32>) -> bool {
    let side = side_of_box(place, uv);
    if side != UNDECIDED {
        return side == LEFT;
    }
    return bisect_element(root, place, uv);
}

// Whether the curve passes left of the point, as far as its box and its slab tell.
const RIGHT: u32 = 0u;
const LEFT: u32 = 1u;
const UNDECIDED: u32 = 2u;

fn side_of_box(place: u32, uv: vec2<f32>) -> u32 {
    let low = vec2<f32>(number_at(place), number_at(place + 1u));
    let high = vec2<f32>(number_at(place + 2u), number_at(place + 3u));
    if !(uv.y >= low.y && uv.y < high.y) || uv.x < min(low.x, high.x) {
        return RIGHT;
    }
    if uv.x >= max(low.x, high.x) {
        return LEFT;
    }
    if !TRIM_BOXING {
        return UNDECIDED;
    }
    let diagonal = high - low;
    let longer = max(abs(diagonal.x), diagonal.y);
    let step = longer * longer * (1.0 / SLAB_STEPS);
    let distance = (uv.x - low.x) * diagonal.y - (uv.y - low.y) * diagonal.x;
    let word = trim_nodes[place + 6u];
    if distance > f32(word & SLAB_MASK) * step {
        return LEFT;
    }
    return select(UNDECIDED, RIGHT, distance < -(f32((word >> 15u) & SLAB_MASK) * step));
}

fn bisect_element(root: u32, place: u32, uv: vec2<f32>) -> bool {
    var low = vec2<f32>(number_at(place), number_at(place + 1u));
    var high = vec2<f32>(number_at(place + 2u), number_at(place + 3u));
    let curve = trim_nodes[root] + trim_nodes[place + 4u];
    let degree = trim_nodes[place + 5u];
    var t_low = 0.0;
    var t_high = 1.0;
    for (var i = 0u; i < MAX_BISECTIONS; i++) {
        let t = (t_low + t_high) * 0.5;
        if t == t_low || t == t_high {
            break;
        }
        let at = element_point(curve, degree, t);
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
    return low.x + (high.x - low.x) * ((uv.y - low.y) / (high.y - low.y)) <= uv.x;
}

fn element_point(first: u32, degree: u32, t: f32) -> vec2<f32> {
    let s = 1.0 - t;
    var factor = 1.0;
    var sum = element_control(first) * s;
    for (var i = 1u; i < degree; i++) {
        factor = factor * t * (f32(degree + 1u - i) / f32(i));
        sum = (sum + element_control(first + i) * factor) * s;
    }
    let power = factor * t / f32(degree);
    let end = sum + element_control(first + degree) * power;
    return end.xy / end.z;
}

fn element_control(index: u32) -> vec3<f32> {
    return vec3<f32>(trim_points[3u * index], trim_points[3u * index + 1u], trim_points[3u * index + 2u]);
}
