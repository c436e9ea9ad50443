// Rays against a leaf of a rational Bézier net; the twin of render/cpu/net.rs, where the essay is.

const MAX_ROOTS: u32 = 6u;
const OVERLAP: f32 = 1.0 / 1048576.0;
// √EPSILON, exactly.
const SQRT_EPSILON: f32 = 3.4526698e-4;

struct NetRoot {
    uv: vec2<f32>,
    t: f32,
    footprint: Footprint,
}

struct NetRoots {
    count: u32,
    root: array<NetRoot, MAX_ROOTS>,
}

struct Domain {
    low: vec2<f32>,
    size: vec2<f32>,
}

struct LeafRay {
    leaf: u32,
    domain: Domain,
    ray: PrimitiveRay,
    planes: RayPlanes,
    slack: f32,
}

// Newton's iteration, `steps` along.
struct Search {
    uv: vec2<f32>,
    steps: u32,
    unique: bool,
    converged: bool,
    goes_on: bool,
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
    let at = LeafRay(leaf, domain, ray, ray_planes(ray), faces[nets[net_leaves[leaf].net].face].slack);
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
            let verdict = examine(jet, at, cell);
            if verdict.splits {
                cell = Cell(cell.level + 1u, cell.place * 2u);
                continue;
            }
            search = Search(verdict.start, 0u, verdict.unique, false, verdict.wanted);
        } else {
            advance(jet, at, &search, &roots);
        }
        is_new = !search.goes_on;
        if isolating && is_new && !next_cell(&cell) {
            return roots;
        }
    }
    return roots;
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

// One turn of the twin's `search`: a step, or after the last one the root's test.
fn advance(jet: NetJet, at: LeafRay, search: ptr<function, Search>, roots: ptr<function, NetRoots>) {
    let unique = (*search).unique;
    if (*search).converged || (*search).steps == select(16u, 10u, unique) {
        (*search).goes_on = false;
        add_search(jet, at, *search, roots);
        return;
    }
    let f = plane_values(at.planes, jet.value);
    let f_u = plane_values(at.planes, jet.by_u);
    let f_v = plane_values(at.planes, jet.by_v);
    let determinant = f_u.x * f_v.y - f_u.y * f_v.x;
    let du = (f.x * f_v.y - f.y * f_v.x) / determinant;
    let dv = (f_u.x * f.y - f_u.y * f.x) / determinant;
    let longest = max(abs(du / at.domain.size.x), abs(dv / at.domain.size.y));
    let shorten = select(1.0, 1.0 / longest, longest > 1.0);
    let uv = (*search).uv - vec2<f32>(du, dv) * shorten;
    let small = select(SQRT_EPSILON / 64.0, SQRT_EPSILON, unique);
    (*search).uv = uv;
    (*search).steps += 1u;
    (*search).converged = longest <= small;
    let is_last = longest <= small || (*search).steps == select(16u, 10u, unique);
    (*search).goes_on = is_finite(du) && is_finite(dv) && is_within(uv, at.domain, select(1.0, 0.5, is_last));
}

// What the twin's `search` does with where it ends.
fn add_search(jet: NetJet, at: LeafRay, search: Search, roots: ptr<function, NetRoots>) {
    let uv = search.uv;
    let scale = 1.0 / jet.value.w;
    let from_origin = jet.value.xyz * scale;
    let s_u = (jet.by_u.xyz - from_origin * jet.by_u.w) * scale;
    let s_v = (jet.by_v.xyz - from_origin * jet.by_v.w) * scale;
    var print = footprint(at.ray.direction, sides(at.ray.direction), s_u, s_v, leaf_curvature(at.leaf), at.slack);
    print.is_grazing |= !search.converged;
    let half_box = extent(print);
    let on_net = max(half_box, vec2<f32>(OVERLAP));
    let on_leaf = max(half_box, select(0.5, 1.0 / 64.0, search.unique) * at.domain.size);
    let beyond = uv - at.domain.low;
    let is_own = all(uv >= -on_net) && all(uv <= 1.0 + on_net) && all(beyond >= -on_leaf) && all(beyond - at.domain.size <= on_leaf);
    let t = dot(from_origin, at.ray.direction) / dot(at.ray.direction, at.ray.direction);
    let miss = greatest(from_origin - at.ray.direction * t);
    let size = greatest(net_leaves[at.leaf].tangent_u) + greatest(net_leaves[at.leaf].tangent_v);
    let rounding = (size + greatest(from_origin + at.ray.origin)) * EPSILON;
    let tolerance = max(rounding * select(16.0, 256.0, search.converged), at.slack * select(0.5, 4.0, search.converged));
    if is_own && miss <= tolerance {
        add_root(roots, NetRoot(uv, t, print), at.domain);
    }
}

fn leaf_curvature(leaf: u32) -> f32 {
    let shorter = min(length(net_leaves[leaf].tangent_u), length(net_leaves[leaf].tangent_v));
    return bend_bound(net_leaves[leaf].certificate >> 24u) / shorter;
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
