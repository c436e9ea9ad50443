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

struct Tangents {
    u: vec3<f32>,
    v: vec3<f32>,
}

fn leaf_domain(leaf: u32) -> Domain {
    let bits = vec2<u32>(net_leaves[leaf].domain & 0xffffu, net_leaves[leaf].domain >> 16u);
    let size = vec2<f32>(1.0) / vec2<f32>(vec2<u32>(1u) << (bits >> vec2<u32>(12u)));
    return Domain(vec2<f32>(bits & vec2<u32>(0xfffu)) * size, size);
}

fn leaf_roots(leaf: u32, ray: PrimitiveRay, near: f32, far: f32) -> NetRoots {
    var roots = NetRoots();
    let hit = intersect_slab(leaf, ray, near, far);
    if !hit.meets {
        return roots;
    }
    let domain = leaf_domain(leaf);
    let planes = ray_planes(ray);
    if !hit.unique && (net_leaves[leaf].certificate >> 24u) != 255u {
        isolate(leaf, ray, planes, domain, &roots);
        return roots;
    }
    // Starts in the twin's order: three along the ray, then five across the leaf; a certified leaf needs one, a flat one has no plane.
    let first = select(0u, 3u, hit.flat_leaf);
    let last = select(8u, 1u, hit.unique);
    for (var k = first; k < last; k++) {
        var start: vec2<f32>;
        if k < 3u {
            var t = hit.enter;
            if hit.unique {
                t = min(max(-hit.at.z / hit.along.z, hit.enter), hit.leave);
            } else if k == 1u {
                t = hit.leave;
            } else if k == 2u {
                t = (hit.enter + hit.leave) * 0.5;
            }
            start = slab_start(hit, t, domain);
        } else {
            var place = vec2<f32>(0.5);
            if k > 3u {
                place = vec2<f32>(select(0.9, 0.1, (k & 1u) == 0u), select(0.9, 0.1, k < 6u));
            }
            start = domain.low + domain.size * place;
        }
        search(leaf, ray, planes, domain, start, hit.unique, &roots);
    }
    return roots;
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

fn isolate(leaf: u32, ray: PrimitiveRay, planes: RayPlanes, domain: Domain, roots: ptr<function, NetRoots>) {
    let a = net_leaves[leaf].tangent_u;
    let b = net_leaves[leaf].tangent_v;
    let bend = f32(net_leaves[leaf].certificate >> 24u) * (1.0 / 64.0) * min(length(a), length(b)) * sqrt(2.0);
    let size = greatest(net_leaves[leaf].center) + greatest(ray.origin) + greatest(a) + greatest(b);
    let rounding = size * 16.0 * EPSILON;
    var level = 0u;
    var cell = vec2<u32>(0u);
    for (var i = 0u; i < MAX_ISOLATION_CELLS; i++) {
        let radius = 0.5 / f32(1u << level);
        let uv = domain.low + domain.size * (vec2<f32>(cell * 2u + vec2<u32>(1u)) * radius);
        let jet = net_jet(net_leaves[leaf].net, ray.origin, uv);
        let scale = 1.0 / jet.value.w;
        let f = plane_values(planes, jet.value) * scale;
        let f_s = (plane_values(planes, jet.by_u) - f * jet.by_u.w) * scale * domain.size.x;
        let f_t = (plane_values(planes, jet.by_v) - f * jet.by_v.w) * scale * domain.size.y;
        let reach = radius * (1.0 + 1.0 / 64.0);
        let remainder = bend * 0.5 * reach * reach + rounding;
        let determinant = f_s.x * f_t.y - f_s.y * f_t.x;
        let step = vec2<f32>(f.x * f_t.y - f.y * f_t.x, f_s.x * f.y - f_s.y * f.x);
        let rows = vec2<f32>(abs(f_t.x) + abs(f_t.y), abs(f_s.x) + abs(f_s.y));
        let room = reach * abs(determinant);
        let misses = any(abs(f) > (abs(f_s) + abs(f_t)) * reach + remainder) || any(abs(step) > room + rows * remainder);
        if !misses {
            let is_regular = max(rows.x, rows.y) * bend * reach < 0.4 * abs(determinant);
            if !is_regular && level < MAX_ISOLATION_LEVEL {
                level += 1u;
                cell *= 2u;
                continue;
            }
            var start = uv;
            if is_regular {
                start -= step / determinant * domain.size;
            }
            search(leaf, ray, planes, domain, start, is_regular && level <= 2u, roots);
        }
        while level > 0u && (cell.x & cell.y & 1u) == 1u {
            level -= 1u;
            cell = cell >> vec2<u32>(1u);
        }
        if level == 0u {
            return;
        }
        if (cell.x & 1u) == 0u {
            cell.x += 1u;
        } else {
            cell = vec2<u32>(cell.x - 1u, cell.y + 1u);
        }
    }
}

fn search(
    leaf: u32,
    ray: PrimitiveRay,
    planes: RayPlanes,
    domain: Domain,
    start: vec2<f32>,
    unique: bool,
    roots: ptr<function, NetRoots>,
) {
    let net = net_leaves[leaf].net;
    var uv = start;
    let small = select(SQRT_EPSILON / 64.0, SQRT_EPSILON, unique);
    let limit = select(16u, 10u, unique);
    var converged = false;
    for (var i = 0u; i < limit; i++) {
        let jet = net_jet(net, ray.origin, uv);
        let f = plane_values(planes, jet.value);
        let f_u = plane_values(planes, jet.by_u);
        let f_v = plane_values(planes, jet.by_v);
        let determinant = f_u.x * f_v.y - f_u.y * f_v.x;
        let du = (f.x * f_v.y - f.y * f_v.x) / determinant;
        let dv = (f_u.x * f.y - f_u.y * f.x) / determinant;
        if !(is_finite(du) && is_finite(dv)) {
            return;
        }
        let longest = max(abs(du / domain.size.x), abs(dv / domain.size.y));
        let shorten = select(1.0, 1.0 / longest, longest > 1.0);
        uv -= vec2<f32>(du, dv) * shorten;
        if !is_within(uv, domain, 1.0) {
            return;
        }
        if longest <= small {
            converged = true;
            break;
        }
    }
    let margin = select(0.5, 1.0 / 64.0, unique);
    let on_net = all(uv >= vec2<f32>(-OVERLAP)) && all(uv <= vec2<f32>(1.0 + OVERLAP));
    if !(on_net && is_within(uv, domain, margin)) {
        return;
    }
    let at = net_jet(net, ray.origin, uv).value;
    let from_origin = at.xyz * (1.0 / at.w);
    let t = dot(from_origin, ray.direction) / dot(ray.direction, ray.direction);
    let miss = greatest(from_origin - ray.direction * t);
    let size = greatest(net_leaves[leaf].tangent_u) + greatest(net_leaves[leaf].tangent_v);
    let rounding = (size + greatest(from_origin + ray.origin)) * EPSILON;
    if !(miss <= rounding * select(64.0, 4096.0, converged)) {
        return;
    }
    add_root(roots, NetRoot(uv, t), domain);
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
