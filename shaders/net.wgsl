// Rays against a leaf of a rational Bézier net; the twin of render/cpu/net.rs, where the essay is.

const MAX_ROOTS: u32 = 6u;
const MAX_ISOLATION_LEVEL: u32 = 8u;
const MAX_ISOLATION_CELLS: u32 = 1024u;
const OVERLAP: f32 = 1.0 / 1048576.0;
// √EPSILON, exactly.
const SQRT_EPSILON: f32 = 3.4526698e-4;

struct NetRoot {
    uv: vec2<f32>,
    t: f32,
}

struct NetRoots {
    count: u32,
    root: array<NetRoot, MAX_ROOTS>,
}

struct Domain {
    low: vec2<f32>,
    size: vec2<f32>,
}

struct SlabHit {
    at: vec3<f32>,
    along: vec3<f32>,
    enter: f32,
    leave: f32,
    unique: bool,
    flat_leaf: bool,
    // Whether the ray meets the slab at all: `None` of the twin.
    meets: bool,
}

struct RayPlanes {
    major: u32,
    minor: vec2<u32>,
    slope: vec2<f32>,
}

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

// Newton's iteration, `steps` along.
struct Search {
    uv: vec2<f32>,
    steps: u32,
    unique: bool,
    converged: bool,
    goes_on: bool,
}

struct Tangents {
    u: vec3<f32>,
    v: vec3<f32>,
}

fn leaf_domain(leaf: u32) -> Domain {
    let bits = vec2<u32>(net_leaves[leaf].domain & 0xffffu, net_leaves[leaf].domain >> 16u);
    let size = vec2<f32>(1.0) / vec2<f32>(vec2<u32>(1u) << (bits >> vec2<u32>(12u)));
    return Domain(vec2<f32>(bits & vec2<u32>(0xfffu)) * size, size);
}

// The twin's loops over cells, starts and steps are one loop here, so that `net_jet` stands once: drivers copy a function's whole text to
// each of its calls, and invocations that look at cells and others that take steps evaluate together.
fn leaf_roots(leaf: u32, ray: PrimitiveRay, near: f32, far: f32) -> NetRoots {
    var roots = NetRoots();
    let hit = intersect_slab(leaf, ray, near, far);
    if !hit.meets {
        return roots;
    }
    let domain = leaf_domain(leaf);
    let planes = ray_planes(ray);
    let isolating = EXACTNESS == EXACT && !hit.unique && (net_leaves[leaf].certificate >> 24u) != 255u;
    var cell = Cell(0u, vec2<u32>(0u));
    let starts = fixed_starts(hit);
    var next_start = starts.x;
    var starts_left = select(starts.y - starts.x, MAX_ISOLATION_CELLS, isolating);
    var search = Search(vec2<f32>(0.0), 0u, hit.unique, false, true);
    var is_new = true;
    loop {
        if is_new {
            if starts_left == 0u {
                return roots;
            }
            starts_left -= 1u;
            if isolating {
                search = Search(cell_center(cell, domain), 0u, false, false, true);
            } else {
                search = Search(fixed_start(hit, next_start, domain), 0u, hit.unique, false, true);
                next_start += 1u;
            }
        }
        let jet = net_jet(net_leaves[leaf].net, ray.origin, search.uv);
        if isolating && is_new {
            let verdict = examine(jet, leaf, ray, planes, domain, cell);
            if verdict.splits {
                cell = Cell(cell.level + 1u, cell.place * 2u);
                continue;
            }
            search = Search(verdict.start, 0u, verdict.unique, false, verdict.wanted);
        } else {
            advance(jet, leaf, ray, planes, domain, &search, &roots);
        }
        is_new = !search.goes_on;
        if isolating && is_new && !next_cell(&cell) {
            return roots;
        }
    }
    return roots;
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

// The first start, and the one after the last.
fn fixed_starts(hit: SlabHit) -> vec2<u32> {
    if hit.unique {
        return vec2<u32>(0u, 1u);
    }
    if EXACTNESS == FAST {
        return select(vec2<u32>(0u, 1u), vec2<u32>(4u, 5u), hit.flat_leaf);
    }
    if EXACTNESS == BALANCED {
        return select(vec2<u32>(1u, 3u), vec2<u32>(5u, 7u), hit.flat_leaf);
    }
    return select(vec2<u32>(1u, 9u), vec2<u32>(4u, 9u), hit.flat_leaf);
}

fn fixed_start(hit: SlabHit, k: u32, domain: Domain) -> vec2<f32> {
    if k < 4u {
        var t = min(max(-hit.at.z / hit.along.z, hit.enter), hit.leave);
        if k == 1u {
            t = hit.enter;
        } else if k == 2u {
            t = hit.leave;
        } else if k == 3u {
            t = (hit.enter + hit.leave) * 0.5;
        }
        return slab_start(hit, t, domain);
    }
    var place = vec2<f32>(0.5);
    if k > 4u {
        // 5 is low and low, 6 high and high, 7 high and low, 8 low and high.
        place = vec2<f32>(select(0.1, 0.9, k == 6u || k == 7u), select(0.1, 0.9, (k & 1u) == 0u));
    }
    return domain.low + domain.size * place;
}

fn slab_start(hit: SlabHit, t: f32, domain: Domain) -> vec2<f32> {
    let place = clamp(hit.at.xy + hit.along.xy * t, vec2<f32>(-0.5), vec2<f32>(0.5)) + 0.5;
    return domain.low + domain.size * place;
}

fn greatest(v: vec3<f32>) -> f32 {
    return max(max(abs(v.x), abs(v.y)), abs(v.z));
}

fn intersect_slab(leaf: u32, ray: PrimitiveRay, near: f32, far: f32) -> SlabHit {
    let a = net_leaves[leaf].tangent_u;
    let b = net_leaves[leaf].tangent_v;
    let center = net_leaves[leaf].center;
    let extent_n = net_leaves[leaf].extent_n;
    let n = cross(a, b);
    let aa = dot(a, a);
    let bb = dot(b, b);
    let nn = dot(n, n);
    let r = ray.origin - center;
    if !(nn > 1e-6 * aa * bb && aa > 0.0 && bb > 0.0) {
        return flat_slab(leaf, sqrt(aa), sqrt(bb), extent_n, r, ray.direction, near, far);
    }
    let scale = 1.0 / nn;
    let norm = sqrt(nn);
    let row_u = cross(b, n) * scale;
    let row_v = cross(n, a) * scale;
    let row_n = n * (1.0 / norm);
    var hit: SlabHit;
    hit.at = vec3<f32>(dot(row_u, r), dot(row_v, r), dot(row_n, r));
    hit.along = vec3<f32>(dot(row_u, ray.direction), dot(row_v, ray.direction), dot(row_n, ray.direction));
    let rounding = (greatest(center) + greatest(ray.origin) + greatest(r)) * 8.0 * EPSILON;
    let reach_u = 0.5 + net_leaves[leaf].extent_u + rounding * greatest(row_u);
    let reach_v = 0.5 + net_leaves[leaf].extent_v + rounding * greatest(row_v);
    var bounds = vec2<f32>(near, far);
    cut(hit.at.x, hit.along.x, reach_u, &bounds);
    cut(hit.at.y, hit.along.y, reach_v, &bounds);
    cut(hit.at.z, hit.along.z, extent_n + rounding, &bounds);
    hit.enter = bounds.x;
    hit.leave = bounds.y;
    hit.meets = bounds.x <= bounds.y;
    let e = certificate(leaf);
    let gamma = e.z * sqrt(min(aa, bb));
    let across = abs(hit.along.z) * (1.0 - 1.0 / 1024.0);
    hit.unique = (1.0 - e.x) * across > gamma * abs(hit.along.x) && (1.0 - e.y) * across > gamma * abs(hit.along.y);
    hit.flat_leaf = false;
    return hit;
}

fn flat_slab(
    leaf: u32,
    a: f32,
    b: f32,
    extent_n: f32,
    r: vec3<f32>,
    direction: vec3<f32>,
    near: f32,
    far: f32,
) -> SlabHit {
    var hit: SlabHit;
    let radius = a * (0.5 + net_leaves[leaf].extent_u) + b * (0.5 + net_leaves[leaf].extent_v) + extent_n;
    let dd = dot(direction, direction);
    let middle = -dot(r, direction) / dd;
    let closest = r + direction * middle;
    let reach = radius * 1.001 + greatest(r) * 8.0 * EPSILON;
    let under_root = reach * reach - dot(closest, closest);
    if !(under_root >= 0.0) {
        return hit;
    }
    let chord = sqrt(under_root / dd);
    hit.enter = max(near, middle - chord);
    hit.leave = min(far, middle + chord);
    hit.meets = hit.enter <= hit.leave;
    hit.flat_leaf = true;
    return hit;
}

fn cut(at: f32, along: f32, reach: f32, bounds: ptr<function, vec2<f32>>) {
    if abs(along) < 1e-18 {
        if abs(at) > reach {
            (*bounds).y = -INFINITE;
        }
        return;
    }
    let reciprocal = 1.0 / along;
    let first = (-reach - at) * reciprocal;
    let second = (reach - at) * reciprocal;
    (*bounds).x = max((*bounds).x, min(first, second));
    (*bounds).y = min((*bounds).y, max(first, second));
}

fn certificate(leaf: u32) -> vec3<f32> {
    let bytes = (vec3<u32>(net_leaves[leaf].certificate) >> vec3<u32>(0u, 8u, 16u)) & vec3<u32>(0xffu);
    return select(vec3<f32>(bytes) / 64.0, vec3<f32>(1e30), bytes == vec3<u32>(255u));
}

fn ray_planes(ray: PrimitiveRay) -> RayPlanes {
    let d = ray.direction;
    var major = 2u;
    if abs(d.x) >= abs(d.y) && abs(d.x) >= abs(d.z) {
        major = 0u;
    } else if abs(d.y) >= abs(d.z) {
        major = 1u;
    }
    let minor = vec2<u32>((major + 1u) % 3u, (major + 2u) % 3u);
    let slope = vec2<f32>(d[minor.x] / d[major], d[minor.y] / d[major]);
    return RayPlanes(major, minor, slope);
}

fn plane_values(planes: RayPlanes, p: vec4<f32>) -> vec2<f32> {
    return vec2<f32>(p[planes.minor.x], p[planes.minor.y]) - planes.slope * p[planes.major];
}

// What one cell of the twin's `isolate` asks for.
fn examine(jet: NetJet, leaf: u32, ray: PrimitiveRay, planes: RayPlanes, domain: Domain, cell: Cell) -> Verdict {
    let a = net_leaves[leaf].tangent_u;
    let b = net_leaves[leaf].tangent_v;
    let bend = f32(net_leaves[leaf].certificate >> 24u) * (1.0 / 64.0) * min(length(a), length(b));
    let size = greatest(net_leaves[leaf].center) + greatest(ray.origin) + greatest(a) + greatest(b);
    let rounding = size * 32.0 * EPSILON;
    let scale = 1.0 / jet.value.w;
    let f = plane_values(planes, jet.value) * scale;
    let f_s = (plane_values(planes, jet.by_u) - f * jet.by_u.w) * scale * domain.size.x;
    let f_t = (plane_values(planes, jet.by_v) - f * jet.by_v.w) * scale * domain.size.y;
    let reach = cell_radius(cell) * (1.0 + 1.0 / 64.0);
    let remainder = bend * 0.5 * reach * reach + rounding;
    let determinant = f_s.x * f_t.y - f_s.y * f_t.x;
    let step = vec2<f32>(f.x * f_t.y - f.y * f_t.x, f_s.x * f.y - f_s.y * f.x);
    let slope = planes.slope;
    let plane_norms = sqrt(vec2<f32>(1.0) + slope * slope);
    let along = vec2<f32>(f_t.y * slope.x - f_t.x * slope.y, f_s.x * slope.y - f_s.y * slope.x);
    let rows = sqrt(vec2<f32>(dot(f_t, f_t), dot(f_s, f_s)) + along * along);
    let room = reach * abs(determinant);
    let misses = any(abs(f) > (abs(f_s) + abs(f_t)) * reach + plane_norms * remainder) || any(abs(step) > room + rows * remainder);
    let curving = max(rows.x, rows.y) * bend;
    let is_regular = curving * reach < 0.9 * abs(determinant)
        && curving * (max(abs(step.x), abs(step.y)) / abs(determinant)) < 0.45 * abs(determinant);
    let start = cell_center(cell, domain) - select(vec2<f32>(0.0), step / determinant * domain.size, is_regular);
    let splits = !misses && !is_regular && cell.level < MAX_ISOLATION_LEVEL;
    return Verdict(start, is_regular && cell.level <= 2u, !misses, splits);
}

// One turn of the twin's `search`: a step, or after the last one the root's test.
fn advance(
    jet: NetJet,
    leaf: u32,
    ray: PrimitiveRay,
    planes: RayPlanes,
    domain: Domain,
    search: ptr<function, Search>,
    roots: ptr<function, NetRoots>,
) {
    let unique = (*search).unique;
    if (*search).converged || (*search).steps == select(16u, 10u, unique) {
        (*search).goes_on = false;
        let from_origin = jet.value.xyz * (1.0 / jet.value.w);
        let t = dot(from_origin, ray.direction) / dot(ray.direction, ray.direction);
        let miss = greatest(from_origin - ray.direction * t);
        let size = greatest(net_leaves[leaf].tangent_u) + greatest(net_leaves[leaf].tangent_v);
        let rounding = (size + greatest(from_origin + ray.origin)) * EPSILON;
        if miss <= rounding * select(64.0, 4096.0, (*search).converged) {
            add_root(roots, NetRoot((*search).uv, t), domain);
        }
        return;
    }
    let f = plane_values(planes, jet.value);
    let f_u = plane_values(planes, jet.by_u);
    let f_v = plane_values(planes, jet.by_v);
    let determinant = f_u.x * f_v.y - f_u.y * f_v.x;
    let du = (f.x * f_v.y - f.y * f_v.x) / determinant;
    let dv = (f_u.x * f.y - f_u.y * f.x) / determinant;
    let longest = max(abs(du / domain.size.x), abs(dv / domain.size.y));
    let shorten = select(1.0, 1.0 / longest, longest > 1.0);
    let uv = (*search).uv - vec2<f32>(du, dv) * shorten;
    let small = select(SQRT_EPSILON / 64.0, SQRT_EPSILON, unique);
    (*search).uv = uv;
    (*search).steps += 1u;
    (*search).converged = longest <= small;
    let is_last = longest <= small || (*search).steps == select(16u, 10u, unique);
    let margin = select(1.0, select(0.5, 1.0 / 64.0, unique), is_last);
    let on_net = !is_last || (all(uv >= vec2<f32>(-OVERLAP)) && all(uv <= vec2<f32>(1.0 + OVERLAP)));
    (*search).goes_on = is_finite(du) && is_finite(dv) && on_net && is_within(uv, domain, margin);
}

fn is_within(uv: vec2<f32>, domain: Domain, margin: f32) -> bool {
    return all(uv >= domain.low - margin * domain.size) && all(uv <= domain.low + (1.0 + margin) * domain.size);
}

fn add_root(roots: ptr<function, NetRoots>, root: NetRoot, domain: Domain) {
    let near = SQRT_EPSILON * 0.25;
    for (var i = 0u; i < (*roots).count; i++) {
        if all(abs((*roots).root[i].uv - root.uv) <= near * domain.size) {
            return;
        }
    }
    if (*roots).count < MAX_ROOTS {
        (*roots).root[(*roots).count] = root;
        (*roots).count += 1u;
    }
}

fn net_normal(net: u32, uv: vec2<f32>) -> vec3<f32> {
    var at = uv;
    for (var i = 0; i < 4; i++) {
        let s = net_tangents(net, at);
        let n = cross(s.u, s.v);
        let norm = length(n);
        let least = length(s.u) * length(s.v);
        if norm > 32.0 * EPSILON * least && norm > 1e-30 {
            return n * (1.0 / norm);
        }
        at += (vec2<f32>(0.5) - at) * (16.0 * SQRT_EPSILON);
    }
    return vec3<f32>(0.0, 0.0, 1.0);
}

fn net_tangents(net: u32, uv: vec2<f32>) -> Tangents {
    let jet = net_jet(net, vec3<f32>(0.0), uv);
    let point = jet.value.xyz * (1.0 / jet.value.w);
    return Tangents(jet.by_u.xyz - point * jet.by_u.w, jet.by_v.xyz - point * jet.by_v.w);
}
