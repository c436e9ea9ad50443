// Where in a leaf of a net Newton's method is to start; the twin of render/cpu/isolate.rs, where the essay is.

const MAX_ISOLATION_LEVEL: u32 = 8u;
const MAX_ISOLATION_CELLS: u32 = 4096u;

// A square of a leaf's domain, of side 2^-level.
struct Cell {
    level: u32,
    place: vec2<u32>,
}

// What a cell asks for: a search from a start, where `wanted`, or that its quarters are looked at instead.
struct Verdict {
    start: vec2<f32>,
    unique: bool,
    wanted: bool,
    splits: bool,
}

fn cell_center(cell: Cell, domain: Domain) -> vec2<f32> {
    return domain.low + domain.size * (vec2<f32>(cell.place * 2u + vec2<u32>(1u)) * cell_radius(cell));
}

fn cell_radius(cell: Cell) -> f32 {
    return 0.5 / f32(1u << cell.level);
}

// The next of four, or of the parent's four; false where there is none.
fn next_cell(cell: ptr<function, Cell>) -> bool {
    while (*cell).level > 0u && ((*cell).place.x & (*cell).place.y & 1u) == 1u {
        *cell = Cell((*cell).level - 1u, (*cell).place >> vec2<u32>(1u));
    }
    if ((*cell).place.x & 1u) == 0u {
        (*cell).place.x += 1u;
    } else {
        (*cell).place = vec2<u32>((*cell).place.x - 1u, (*cell).place.y + 1u);
    }
    return (*cell).level != 0u;
}

fn is_at_end(cell: Cell, domain: Domain) -> bool {
    let last = vec2<u32>((1u << cell.level) - 1u);
    let high = domain.low + domain.size;
    return any((cell.place == vec2<u32>(0u)) & (domain.low == vec2<f32>(0.0)))
        || any((cell.place == last) & (high == vec2<f32>(1.0)));
}

fn examine(jet: NetJet, at: LeafRay, cell: Cell) -> Verdict {
    let a = net_leaves[at.leaf].tangent_u;
    let b = net_leaves[at.leaf].tangent_v;
    let bend = bend_bound(net_leaves[at.leaf].certificate >> 24u) * min(length(a), length(b));
    let size = greatest(net_leaves[at.leaf].center) + greatest(at.ray.origin) + greatest(a) + greatest(b);
    let rounding = size * 32.0 * EPSILON;
    let scale = 1.0 / jet.value.w;
    let f = plane_values(at.planes, jet.value) * scale;
    let f_s = (plane_values(at.planes, jet.by_u) - f * jet.by_u.w) * scale * at.domain.size.x;
    let f_t = (plane_values(at.planes, jet.by_v) - f * jet.by_v.w) * scale * at.domain.size.y;
    let reach = cell_radius(cell) * (1.0 + 1.0 / 64.0);
    let remainder = bend * 0.5 * reach * reach + rounding + select(0.0, at.slack, is_at_end(cell, at.domain));
    let determinant = f_s.x * f_t.y - f_s.y * f_t.x;
    let step = vec2<f32>(f.x * f_t.y - f.y * f_t.x, f_s.x * f.y - f_s.y * f.x);
    let slope = at.planes.slope;
    let plane_norms = sqrt(vec2<f32>(1.0) + slope * slope);
    let along = vec2<f32>(f_t.y * slope.x - f_t.x * slope.y, f_s.x * slope.y - f_s.y * slope.x);
    let rows = sqrt(vec2<f32>(dot(f_t, f_t), dot(f_s, f_s)) + along * along);
    let room = reach * abs(determinant);
    let misses = any(abs(f) > (abs(f_s) + abs(f_t)) * reach + plane_norms * remainder) || any(abs(step) > room + rows * remainder);
    let curving = max(rows.x, rows.y) * bend;
    let is_regular = curving * reach < 0.9 * abs(determinant)
        && curving * (max(abs(step.x), abs(step.y)) / abs(determinant)) < 0.45 * abs(determinant);
    let start = cell_center(cell, at.domain) - select(vec2<f32>(0.0), step / determinant * at.domain.size, is_regular);
    let splits = !misses && !is_regular && cell.level < MAX_ISOLATION_LEVEL;
    return Verdict(start, is_regular && cell.level <= 2u, !misses, splits);
}
