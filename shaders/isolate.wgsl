// Where in a leaf of a net Newton's method is to start; the twin of render/cpu/isolate.rs, where the essay is.

const MAX_ISOLATION_LEVEL: u32 = 8u;
const MAX_ISOLATION_CELLS: u32 = 4096u;
const MAX_POLE_LEVEL: u32 = 21u;
const QUARTER: f32 = 0.5 + 1.0 / 64.0;
const WITHIN_SLACK: f32 = 0.25;
const SIDES_U = vec4<f32>(-1.0, 1.0, -1.0, 1.0);
const SIDES_V = vec4<f32>(-1.0, -1.0, 1.0, 1.0);

// How sure a search is to end at a root.
const UNIQUE: u32 = 0u;
const REGULAR: u32 = 1u;
const OPEN: u32 = 2u;

// A rectangle of a leaf's domain, of sides 2^-level.
struct Cell {
    level: vec2<u32>,
    place: vec2<u32>,
    // Of each quartering that led here, four bits: the quarters that may hold a root.
    quarters: u32,
}

// The side of a leaf that is one point.
struct Pole {
    axis: u32,
    exists: bool,
    is_high: bool,
}

// What a cell asks for: a search of some kind from a start, where `wanted`, or that its parts are looked at instead.
struct Verdict {
    start: vec2<f32>,
    kind: u32,
    across: f32,
    wanted: bool,
    splits: bool,
    // Which may hold a root, of the parts of a cell that is quartered.
    quarters: u32,
}

fn leaf_pole(net: u32, domain: Domain) -> Pole {
    let low = domain.low == vec2<f32>(0.0);
    let high = domain.low + domain.size == vec2<f32>(1.0);
    let bits = nets[net].degrees;
    if low.x && (bits & point_side(0u, 0u)) != 0u {
        return Pole(0u, true, false);
    }
    if high.x && (bits & point_side(0u, 1u)) != 0u {
        return Pole(0u, true, true);
    }
    if low.y && (bits & point_side(1u, 0u)) != 0u {
        return Pole(1u, true, false);
    }
    return Pole(select(0u, 1u, high.y && (bits & point_side(1u, 1u)) != 0u), high.y && (bits & point_side(1u, 1u)) != 0u, true);
}

fn point_side(axis: u32, end: u32) -> u32 {
    return 1u << (17u + 2u * axis + end);
}

fn is_at_pole(cell: Cell, pole: Pole) -> bool {
    let last = select(0u, (1u << count_along(cell.level, pole.axis)) - 1u, pole.is_high);
    return pole.exists && count_along(cell.level, 1u - pole.axis) == 0u && count_along(cell.place, pole.axis) == last;
}

fn first_part(cell: Cell, pole: Pole, quarters: u32) -> Cell {
    if is_at_pole(cell, pole) {
        let is_cut = select(vec2<u32>(1u, 0u), vec2<u32>(0u, 1u), pole.axis == 1u);
        return Cell(cell.level + is_cut, cell.place << is_cut, cell.quarters);
    }
    let shift = 4u * count_along(cell.level, 1u - pole.axis);
    let first = firstTrailingBit(quarters);
    let place = (cell.place << vec2<u32>(1u)) | vec2<u32>(first & 1u, first >> 1u);
    return Cell(cell.level + vec2<u32>(1u), place, (cell.quarters & ~(15u << shift)) | (quarters << shift));
}

// The next of four that may hold a root, or of the parent's four, and so on; false where there is none.
fn next_cell(cell: ptr<function, Cell>, pole: Pole) -> bool {
    var level = (*cell).level;
    var place = (*cell).place;
    let quarters = (*cell).quarters;
    while count_along(level, 1u - pole.axis) > 0u {
        let this_one = (place.x & 1u) | ((place.y & 1u) << 1u);
        let next = (quarters >> (4u * (count_along(level, 1u - pole.axis) - 1u))) & 15u & ~((2u << this_one) - 1u);
        if next != 0u {
            let first = firstTrailingBit(next);
            place = (place & vec2<u32>(0xfffffffeu)) | vec2<u32>(first & 1u, first >> 1u);
            *cell = Cell(level, place, quarters);
            return true;
        }
        level -= vec2<u32>(1u);
        place = place >> vec2<u32>(1u);
    }
    var halves = count_along(level, pole.axis);
    var half = count_along(place, pole.axis);
    while halves > 0u && (half & 1u) == 1u {
        halves -= 1u;
        half >>= 1u;
    }
    level = with_count_along(level, pole.axis, halves);
    place = with_count_along(place, pole.axis, half + 1u);
    *cell = Cell(level, place, quarters);
    return halves > 0u;
}

fn is_at_end(cell: Cell, domain: Domain) -> bool {
    let last = (vec2<u32>(1u) << cell.level) - vec2<u32>(1u);
    let high = domain.low + domain.size;
    return any((cell.place == vec2<u32>(0u)) & (domain.low == vec2<f32>(0.0)))
        || any((cell.place == last) & (high == vec2<f32>(1.0)));
}

fn cell_radius(cell: Cell) -> vec2<f32> {
    return vec2<f32>(0.5) / vec2<f32>(vec2<u32>(1u) << cell.level);
}

fn cell_center(cell: Cell, domain: Domain) -> vec2<f32> {
    return domain.low + domain.size * (vec2<f32>(cell.place * 2u + vec2<u32>(1u)) * cell_radius(cell));
}

fn bend_area(cell: Cell, at: LeafRay, reach: vec2<f32>) -> f32 {
    let axis = at.pole.axis;
    let across = along_axis(reach, axis);
    let along = along_axis(reach, 1u - axis);
    var share = 1.0;
    if at.pole.exists {
        let count = 1u << count_along(cell.level, axis);
        let steps = select(count_along(cell.place, axis) + 1u, count - count_along(cell.place, axis), at.pole.is_high);
        share = bend_at_pole(at, f32(steps + 1u) / f32(count));
    }
    return max(max(share * along * along, across * along), across * across);
}

fn bend_at_pole(at: LeafRay, across: f32) -> f32 {
    return min(1.0, f32(count_along(at.degrees, at.pole.axis)) * across);
}

fn examine(jet: NetJet, at: LeafRay, cell: Cell) -> Verdict {
    let size = at.center_size + greatest(at.ray.origin) + at.tangent_size;
    let rounding = size * 32.0 * EPSILON;
    let reach = cell_radius(cell) * (1.0 + 1.0 / 64.0);
    let p = plane_jet(at.planes, jet, at.domain.size * reach);
    let curving = at.bend * bend_area(cell, at, reach);
    let beyond = select(0.0, at.slack, is_at_end(cell, at.domain));
    let remainder = curving * 0.5 + rounding + beyond;
    let determinant = p.f_s.x * p.f_t.y - p.f_s.y * p.f_t.x;
    let step = vec2<f32>(p.f.x * p.f_t.y - p.f.y * p.f_t.x, p.f_s.x * p.f.y - p.f_s.y * p.f.x);
    let slope = at.planes.slope;
    let plane_norms = sqrt(vec2<f32>(1.0) + slope * slope);
    let along = vec2<f32>(p.f_t.y * slope.x - p.f_t.x * slope.y, p.f_s.x * slope.y - p.f_s.y * slope.x);
    let rows = sqrt(vec2<f32>(dot(p.f_t, p.f_t), dot(p.f_s, p.f_s)) + along * along);
    let misses = any(abs(p.f) > abs(p.f_s) + abs(p.f_t) + plane_norms * remainder)
        || any(abs(step) > abs(determinant) + rows * remainder);
    let middle = cell_center(cell, at.domain);
    if is_at_pole(cell, at.pole) {
        let across = 2.0 * along_axis(reach, at.pole.axis);
        let image = along_axis(at.lengths, at.pole.axis) * across;
        let is_small = image <= (at.slack + rounding) * 8.0 || count_along(cell.level, at.pole.axis) == MAX_POLE_LEVEL;
        return Verdict(middle, OPEN, across, !misses && is_small, !misses && !is_small, 0u);
    }
    let turning = max(rows.x, rows.y) * curving;
    let is_regular = turning < 0.9 * abs(determinant)
        && turning * (max(abs(step.x), abs(step.y)) / abs(determinant)) < 0.45 * abs(determinant);
    let start = middle - select(vec2<f32>(0.0), step / determinant * (at.domain.size * reach), is_regular);
    let tangents = at.lengths + at.bend * 0.5;
    let is_within_slack = 2.0 * max(tangents.x * reach.x, tangents.y * reach.y) < beyond * WITHIN_SLACK;
    let may_split = !misses && !is_regular && !is_within_slack
        && count_along(cell.level, 1u - at.pole.axis) < MAX_ISOLATION_LEVEL;
    // By quarter: low and low, high and low, low and high, high and high.
    let first = (p.f_s.x * SIDES_U + p.f_t.x * SIDES_V) * 0.5 + p.f.x;
    let second = (p.f_s.y * SIDES_U + p.f_t.y * SIDES_V) * 0.5 + p.f.y;
    let off_u = step.x + determinant * SIDES_U * 0.5;
    let off_v = step.y + determinant * SIDES_V * 0.5;
    let most = (abs(p.f_s) + abs(p.f_t)) * QUARTER + plane_norms * remainder;
    let most_off = abs(determinant) * QUARTER + rows * remainder;
    let is_empty = (abs(first) > vec4<f32>(most.x)) | (abs(second) > vec4<f32>(most.y))
        | (abs(off_u) > vec4<f32>(most_off.x)) | (abs(off_v) > vec4<f32>(most_off.y));
    let kept = select(vec4<u32>(1u, 2u, 4u, 8u), vec4<u32>(0u), is_empty);
    let quarters = kept.x | kept.y | kept.z | kept.w;
    let splits = may_split && quarters != 0u;
    let kind = select(OPEN, select(REGULAR, UNIQUE, max(cell.level.x, cell.level.y) <= 2u), is_regular);
    return Verdict(start, kind, 1.0, !misses && !may_split, splits, quarters);
}
