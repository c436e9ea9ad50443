// Rays against a leaf of a rational Bézier net; the twin of render/cpu/net.rs, newton.rs and leaf.rs, where the essay is.

const MAX_ROOTS: u32 = 6u;
const OVERLAP: f32 = 1.0 / 1048576.0;
// √EPSILON, exactly.
const SQRT_EPSILON: f32 = 3.4526698e-4;
// ∛EPSILON.
const CBRT_EPSILON: f32 = 4.9215666e-3;
const MAX_UNIQUE_STEPS: u32 = 10u;
// Turns after which a search makes way for the walks of other invocations, where they share rays. 4 and 16 are as fast within a few percent.
const SEARCH_TURNS: u32 = 8u;
const TANGENT_STEPS: u32 = 16u;
const DAMPING_FACTOR: f32 = 8.0;
const CONVERGED_MISS = vec2<f32>(256.0, 4.0);
const OPEN_MISS = vec2<f32>(16.0, 0.5);

struct NetRoot {
    uv: vec2<f32>,
    t: f32,
    footprint: Footprint,
}

struct NetRoots {
    count: u32,
    root: array<NetRoot, MAX_ROOTS>,
    is_cut: bool,
}

// What the search in a leaf has found so far. Here, as functions that return it would clear and copy it each time.
var<private> net_roots: NetRoots;

struct Domain {
    low: vec2<f32>,
    size: vec2<f32>,
}

struct LeafRay {
    domain: Domain,
    ray: PrimitiveRay,
    planes: RayPlanes,
    slack: f32,
    pole: Pole,
    first_point: u32,
    degrees: vec2<u32>,
    // Of the tangents.
    lengths: vec2<f32>,
    // leaf_bend, and whether it is known.
    bend: f32,
    has_bend: bool,
    // The greatest coordinates of centre and tangents.
    center_size: f32,
    tangent_size: f32,
}

// Newton's iteration, `steps` along.
struct Search {
    uv: vec2<f32>,
    steps: u32,
    kind: u32,
    across: f32,
    converged: bool,
    goes_on: bool,
    // The lowest point so far, what the planes have there, and the share of the damping.
    base: vec2<f32>,
    low: PlaneJet,
    share: f32,
}

fn search_from(start: vec2<f32>, kind: u32, across: f32, wanted: bool) -> Search {
    let zero = vec2<f32>(0.0);
    return Search(start, 0u, kind, across, false, wanted, start, PlaneJet(zero, zero, zero), 1.0);
}

fn leaf_domain(leaf: u32) -> Domain {
    let bits = vec2<u32>(net_leaves[leaf].domain & 0xffffu, net_leaves[leaf].domain >> 16u);
    let size = vec2<f32>(1.0) / vec2<f32>(vec2<u32>(1u) << (bits >> vec2<u32>(12u)));
    return Domain(vec2<f32>(bits & vec2<u32>(0xfffu)) * size, size);
}

// The twin's `leaf_roots` on its way.
struct LeafSearch {
    at: LeafRay,
    hit: SlabHit,
    isolating: bool,
    kind: u32,
    cell: Cell,
    next_start: u32,
    starts_left: u32,
    search: Search,
    // Whether a cell or a start is next.
    is_new: bool,
    goes_on: bool,
}

fn start_leaf(leaf: u32, ray: PrimitiveRay, near: f32, far: f32, leaf_search: ptr<function, LeafSearch>) {
    net_roots.count = 0u;
    net_roots.is_cut = false;
    let hit = intersect_slab(leaf, ray, near, far);
    if !hit.meets {
        return;
    }
    let domain = leaf_domain(leaf);
    let net = net_leaves[leaf].net;
    let pole = leaf_pole(net, domain);
    let a = net_leaves[leaf].tangent_u;
    let b = net_leaves[leaf].tangent_v;
    (*leaf_search).at = LeafRay(
        domain,
        ray,
        ray_planes(ray),
        faces[nets[net].face].slack,
        pole,
        nets[net].first_point,
        net_degrees(net),
        vec2<f32>(length(a), length(b)),
        leaf_bend(leaf),
        has_bend_bound(leaf),
        greatest(net_leaves[leaf].center),
        greatest(a) + greatest(b),
    );
    (*leaf_search).hit = hit;
    (*leaf_search).isolating = EXACTNESS == EXACT && !hit.unique && (*leaf_search).at.has_bend;
    (*leaf_search).kind = select(OPEN, UNIQUE, hit.unique);
    (*leaf_search).cell = Cell(vec2<u32>(0u), vec2<u32>(0u), 0u);
    let starts = fixed_starts(hit);
    (*leaf_search).next_start = starts.x;
    (*leaf_search).starts_left = select(starts.y - starts.x, MAX_ISOLATION_CELLS, (*leaf_search).isolating);
    (*leaf_search).is_new = true;
    (*leaf_search).goes_on = true;
    if !SHARES_RAYS {
        // Here, so that no register is kept for what is left of a search.
        search_leaf(leaf_search);
    }
}

// The twin's loops over cells, starts and steps are one loop here, so that `net_jet` stands once: drivers copy a function's whole text to
// each of its calls, and invocations that look at cells and others that take steps evaluate together.
fn search_leaf(leaf_search: ptr<function, LeafSearch>) {
    let at = (*leaf_search).at;
    var search = (*leaf_search).search;
    var cell = (*leaf_search).cell;
    var is_new = (*leaf_search).is_new;
    var starts_left = (*leaf_search).starts_left;
    var goes_on = true;
    var turns_left = SEARCH_TURNS;
    while goes_on && (!SHARES_RAYS || turns_left > 0u) {
        turns_left -= 1u;
        if is_new {
            if starts_left == 0u {
                net_roots.is_cut = (*leaf_search).isolating;
                goes_on = false;
                break;
            }
            starts_left -= 1u;
            if (*leaf_search).isolating {
                search = search_from(cell_center(cell, at.domain), OPEN, 1.0, true);
            } else {
                search = search_from(fixed_start((*leaf_search).hit, (*leaf_search).next_start, at.domain), (*leaf_search).kind, 1.0, true);
                (*leaf_search).next_start += 1u;
            }
        }
        let jet = net_jet(at.first_point, at.degrees, at.ray.origin, search.uv);
        if (*leaf_search).isolating && is_new {
            let verdict = examine(jet, at, cell);
            if verdict.splits {
                cell = first_part(cell, at.pole, verdict.quarters);
                continue;
            }
            search = search_from(verdict.start, verdict.kind, verdict.across, verdict.wanted);
        } else {
            advance(jet, at, &search);
        }
        is_new = !search.goes_on;
        if (*leaf_search).isolating && is_new {
            goes_on = next_cell(&cell, at.pole);
        }
    }
    (*leaf_search).search = search;
    (*leaf_search).cell = cell;
    (*leaf_search).is_new = is_new;
    (*leaf_search).starts_left = starts_left;
    (*leaf_search).goes_on = goes_on;
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

// One turn of the twin's `search`: a step, and after the last one the root's test, of open searches in a turn of its own.
fn advance(jet: NetJet, at: LeafRay, search: ptr<function, Search>) {
    let unique = (*search).kind == UNIQUE;
    let is_open = (*search).kind == OPEN;
    let limit = select(TANGENT_STEPS, MAX_UNIQUE_STEPS, unique);
    var moved = vec2<f32>(0.0);
    var ends = (*search).converged || (*search).steps == limit;
    if ends {
        (*search).goes_on = false;
    } else {
        let across = (*search).across;
        let unit = at.domain.size * select(vec2<f32>(across, 1.0), vec2<f32>(1.0, across), at.pole.axis == 1u);
        let here = plane_jet(at.planes, jet, unit);
        if (*search).steps == 0u || !is_open || dot(here.f, here.f) <= dot((*search).low.f, (*search).low.f) {
            (*search).base = (*search).uv;
            (*search).low = here;
            (*search).share *= 1.0 / DAMPING_FACTOR;
        } else {
            (*search).share *= DAMPING_FACTOR;
        }
        let bend_here = at.bend * select(1.0, bend_at_pole(at, across), across < 1.0);
        let damping = select(0.0, bend_here, is_open && at.has_bend);
        let step = damped_step((*search).low, damping * (*search).share);
        let is_singular = !(is_finite(step.x) && is_finite(step.y));
        (*search).steps = select((*search).steps + 1u, limit, is_singular);
        if !is_singular {
            let longest = max(abs(step.x), abs(step.y));
            let shorten = select(1.0, 1.0 / longest, longest > 1.0);
            (*search).uv = (*search).base - step * (shorten * unit);
            (*search).converged = longest <= select(SQRT_EPSILON / 64.0, SQRT_EPSILON, unique);
            (*search).goes_on = is_within((*search).uv, at.domain, 1.0);
        }
        if is_open && (*search).goes_on && !(*search).converged && (*search).steps == limit {
            (*search).uv = (*search).base;
        }
        if !is_open && (*search).goes_on && (*search).converged {
            (*search).goes_on = false;
            moved = (*search).uv - (*search).base;
            ends = true;
        }
    }
    if ends && is_within((*search).uv, at.domain, 0.5) {
        add_search(jet, at, *search, moved);
    }
}

// What the twin's `search` does with where it ends.
fn add_search(jet: NetJet, at: LeafRay, search: Search, moved: vec2<f32>) {
    let uv = search.uv;
    let scale = 1.0 / jet.value.w;
    let point = jet.value.xyz * scale;
    let s_u = (jet.by_u.xyz - point * jet.by_u.w) * scale;
    let s_v = (jet.by_v.xyz - point * jet.by_v.w) * scale;
    let from_origin = point + s_u * moved.x + s_v * moved.y;
    let curvature = root_curvature(s_u * at.domain.size.x, s_v * at.domain.size.y, at.bend);
    var print = footprint(at.ray.direction, s_u, s_v, curvature, at.slack);
    let is_v = at.pole.axis == 1u;
    if at.pole.exists && select(length(s_v), length(s_u), is_v) <= at.slack * 4.0 {
        print = pole_footprint(at.pole.axis, sides(at.ray.direction), select(s_u, s_v, is_v), at.slack);
    }
    print.is_grazing |= !search.converged;
    let half_box = extent(print);
    let on_net = max(half_box, vec2<f32>(OVERLAP));
    let on_leaf = max(half_box, select(0.5, 1.0 / 64.0, search.kind == UNIQUE) * at.domain.size);
    let beyond = uv - at.domain.low;
    let is_own = all(uv >= -on_net) && all(uv <= 1.0 + on_net) && all(beyond >= -on_leaf) && all(beyond - at.domain.size <= on_leaf);
    let t = dot(from_origin, at.ray.direction) / dot(at.ray.direction, at.ray.direction);
    let miss = greatest(from_origin - at.ray.direction * t);
    let rounding = (at.tangent_size + greatest(from_origin + at.ray.origin)) * EPSILON;
    let is_sure = search.converged && search.kind != OPEN;
    let most = select(OPEN_MISS, CONVERGED_MISS, is_sure);
    let tolerance = max(rounding * most.x, at.slack * most.y);
    if is_own && miss <= tolerance {
        add_root(NetRoot(uv, t, print), at);
    }
}

fn damped_step(p: PlaneJet, damping: f32) -> vec2<f32> {
    let determinant = p.f_s.x * p.f_t.y - p.f_s.y * p.f_t.x;
    let newton = vec2<f32>(p.f.x * p.f_t.y - p.f.y * p.f_t.x, p.f_s.x * p.f.y - p.f_s.y * p.f.x);
    if !(damping > 0.0) {
        return newton / determinant;
    }
    let inv = 1.0 / (dot(p.f_s, p.f_s) + dot(p.f_t, p.f_t));
    let lambda = damping * (abs(p.f.x) + abs(p.f.y)) * inv;
    let unit_determinant = determinant * inv;
    let downhill = vec2<f32>(dot(p.f_s, p.f), dot(p.f_t, p.f));
    return (newton * unit_determinant + downhill * lambda)
        * (inv / (unit_determinant * unit_determinant + lambda * (1.0 + lambda)));
}

fn leaf_bend(leaf: u32) -> f32 {
    let shorter = min(length(net_leaves[leaf].tangent_u), length(net_leaves[leaf].tangent_v));
    return bend_bound(net_leaves[leaf].certificate >> 24u) * shorter;
}

fn has_bend_bound(leaf: u32) -> bool {
    return (net_leaves[leaf].certificate >> 24u) != 255u;
}

fn root_curvature(s: vec3<f32>, t: vec3<f32>, bend: f32) -> f32 {
    let normal = cross(s, t);
    return bend * max(dot(s, s), dot(t, t)) / dot(normal, normal);
}

fn is_within(uv: vec2<f32>, domain: Domain, margin: f32) -> bool {
    return all(uv >= domain.low - margin * domain.size) && all(uv <= domain.low + (1.0 + margin) * domain.size);
}

fn add_root(root: NetRoot, at: LeafRay) {
    let near = SQRT_EPSILON * 0.25;
    for (var i = 0u; i < net_roots.count; i++) {
        let known = net_roots.root[i];
        let is_near = all(abs(known.uv - root.uv) <= near * at.domain.size);
        let is_any_grazing = known.footprint.is_grazing || root.footprint.is_grazing;
        let apart = abs(known.t - root.t) * length(at.ray.direction);
        if is_near || (is_any_grazing && same_place(apart, known.footprint.cosine, root.footprint.cosine, at.slack)) {
            if known.footprint.is_grazing && !root.footprint.is_grazing {
                net_roots.root[i] = root;
            }
            return;
        }
    }
    if net_roots.count < MAX_ROOTS {
        net_roots.root[net_roots.count] = root;
        net_roots.count += 1u;
    } else {
        net_roots.is_cut = true;
    }
}

fn net_normal(net: u32, uv: vec2<f32>) -> vec3<f32> {
    let h = CBRT_EPSILON;
    var axis = 0u;
    var is_high = false;
    var off = h;
    for (var side = 0u; side < 4u && !(off < h); side++) {
        axis = side >> 1u;
        is_high = (side & 1u) == 1u;
        let is_point = (nets[net].degrees & point_side(axis, side & 1u)) != 0u;
        off = select(h, select(uv[axis], 1.0 - uv[axis], is_high), is_point);
    }
    var at = uv;
    var normals: array<vec3<f32>, 2>;
    for (var k = 0u; k < 2u; k++) {
        if off < h {
            let by = h * f32(k + 1u);
            at[axis] = select(by, 1.0 - by, is_high);
        }
        normals[k] = regular_normal(net, at);
        if !(off < h) {
            return normals[k];
        }
    }
    let n = normals[0] + (normals[0] - normals[1]) * ((h - off) / h);
    return n * (1.0 / max(length(n), 1e-30));
}

fn regular_normal(net: u32, uv: vec2<f32>) -> vec3<f32> {
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
    let jet = net_jet(nets[net].first_point, net_degrees(net), vec3<f32>(0.0), uv);
    let point = jet.value.xyz * (1.0 / jet.value.w);
    return Tangents(jet.by_u.xyz - point * jet.by_u.w, jet.by_v.xyz - point * jet.by_v.w);
}
