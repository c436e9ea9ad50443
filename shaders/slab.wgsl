// Rays against the skew slab around a leaf of a net; the twin of render/cpu/slab.rs, where the essay is.

const FLAT: f32 = 1e-6;
const CERTIFICATE_ROUNDING: f32 = 1.0 / 1024.0;
const PARALLEL: f32 = 1e-18;
const SPHERE_ROUNDING: f32 = 1.001;

struct SlabHit {
    at: vec3<f32>,
    along: vec3<f32>,
    enter: f32,
    leave: f32,
    unique: bool,
    flat_leaf: bool,
    // Whether the ray is inside somewhere between `near` and `far`.
    meets: bool,
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
    if !(nn > FLAT * aa * bb && aa > 0.0 && bb > 0.0) {
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
    var bounds = vec2<f32>(-INFINITE, INFINITE);
    cut(hit.at.x, hit.along.x, reach_u, &bounds);
    cut(hit.at.y, hit.along.y, reach_v, &bounds);
    cut(hit.at.z, hit.along.z, extent_n + rounding, &bounds);
    hit.enter = bounds.x;
    hit.leave = bounds.y;
    hit.meets = max(bounds.x, near) <= min(bounds.y, far);
    let e = certificate(leaf);
    let gamma = e.z * sqrt(min(aa, bb));
    let across = abs(hit.along.z) * (1.0 - CERTIFICATE_ROUNDING);
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
    let reach = radius * SPHERE_ROUNDING + greatest(r) * 8.0 * EPSILON;
    let under_root = reach * reach - dot(closest, closest);
    if !(under_root >= 0.0) {
        return hit;
    }
    let chord = sqrt(under_root / dd);
    hit.enter = middle - chord;
    hit.leave = middle + chord;
    hit.meets = max(hit.enter, near) <= min(hit.leave, far);
    hit.flat_leaf = true;
    return hit;
}

fn cut(at: f32, along: f32, reach: f32, bounds: ptr<function, vec2<f32>>) {
    if abs(along) < PARALLEL {
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

fn bend_bound(byte: u32) -> f32 {
    return bitcast<f32>((byte + (121u << 3u)) << 20u);
}
