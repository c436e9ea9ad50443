// Walks the 8-wide compressed BVH; the twin of render/cpu/bvh.rs, but for the order of children: that of the octant.

struct BvhRay {
    origin: vec3<f32>,
    inverse: vec3<f32>,
    octant: u32,
}

struct Walk {
    first_node: u32,
    first_primitive: u32,
    group: vec2<u32>,
    primitives: vec2<u32>,
    // Where on the stack its groups begin and end.
    bottom: u32,
    depth: u32,
}

// Of both levels: the walk through a part begins where that over instances has its groups.
var<private> stack: array<vec2<u32>, 2u * STACK_SIZE>;

// What `next_primitive` answers where nothing is left: `None` of the twin. No primitive word has all bits set.
const NO_PRIMITIVE: u32 = 0xffffffffu;

fn bvh_ray(origin: vec3<f32>, direction: vec3<f32>) -> BvhRay {
    let octant = select(4u, 0u, direction.x < 0.0) | select(2u, 0u, direction.y < 0.0) | select(1u, 0u, direction.z < 0.0);
    return BvhRay(origin, vec3<f32>(inverse(direction.x), inverse(direction.y), inverse(direction.z)), octant);
}

fn inverse(x: f32) -> f32 {
    if abs(x) < 1e-18 {
        return select(1e18, -1e18, x < 0.0);
    }
    return 1.0 / x;
}

fn start_walk(first_node: u32, node_count: u32, first_primitive: u32, bottom: u32) -> Walk {
    var walk: Walk;
    walk.first_node = first_node;
    walk.first_primitive = first_primitive;
    walk.group = vec2<u32>(0u, select(0x80000000u, 0u, node_count == 0u));
    walk.primitives = vec2<u32>(0u);
    walk.bottom = bottom;
    walk.depth = bottom;
    return walk;
}

fn next_primitive(walk: ptr<function, Walk>, ray: BvhRay, near: f32, far: f32) -> u32 {
    loop {
        if (*walk).primitives.y != 0u {
            let bit = firstLeadingBit((*walk).primitives.y);
            (*walk).primitives.y &= ~(1u << bit);
            return primitives[(*walk).first_primitive + (*walk).primitives.x + bit];
        }
        if ((*walk).group.y & 0xff000000u) == 0u {
            if (*walk).depth == (*walk).bottom {
                return NO_PRIMITIVE;
            }
            (*walk).depth -= 1u;
            (*walk).group = stack[(*walk).depth];
        }
        let siblings = (*walk).group.y;
        let bit = firstLeadingBit(siblings);
        (*walk).group.y &= ~(1u << bit);
        if ((*walk).group.y & 0xff000000u) != 0u && (*walk).depth < 2u * STACK_SIZE {
            stack[(*walk).depth] = (*walk).group;
            (*walk).depth += 1u;
        }
        let slot = (bit - 24u) ^ ray.octant;
        let rank = countOneBits(siblings & ~(0xffffffffu << slot));
        let node = (*walk).first_node + (*walk).group.x + rank;
        let met = bvh_node(node);
        let hits = intersect_node(met, ray, near, far);
        (*walk).group = vec2<u32>(met.child_base, (hits & 0xff000000u) | (met.e_imask >> 24u));
        (*walk).primitives = vec2<u32>(met.primitive_base, hits & 0x00ffffffu);
    }
    return NO_PRIMITIVE;
}

// A node in the five loads that it takes.
fn bvh_node(index: u32) -> BvhNode {
    let a = bvh_nodes[5u * index];
    let b = bvh_nodes[5u * index + 1u];
    let c = bvh_nodes[5u * index + 2u];
    let d = bvh_nodes[5u * index + 3u];
    let e = bvh_nodes[5u * index + 4u];
    return BvhNode(bitcast<vec3<f32>>(a.xyz), a.w, b.x, b.y, b.zw, c.xy, c.zw, d.xy, d.zw, e.xy, e.zw);
}

fn intersect_node(node: BvhNode, ray: BvhRay, near: f32, far: f32) -> u32 {
    let imask = node.e_imask >> 24u;
    let x = axis_terms(node.p.x, node.e_imask & 0xffu, ray.origin.x, ray.inverse.x);
    let y = axis_terms(node.p.y, (node.e_imask >> 8u) & 0xffu, ray.origin.y, ray.inverse.y);
    let z = axis_terms(node.p.z, (node.e_imask >> 16u) & 0xffu, ray.origin.z, ray.inverse.z);
    let x_forward = (ray.octant & 4u) != 0u;
    let y_forward = (ray.octant & 2u) != 0u;
    let z_forward = (ray.octant & 1u) != 0u;
    let x_low = select(node.child_max_x, node.child_min_x, x_forward);
    let x_high = select(node.child_min_x, node.child_max_x, x_forward);
    let y_low = select(node.child_max_y, node.child_min_y, y_forward);
    let y_high = select(node.child_min_y, node.child_max_y, y_forward);
    let z_low = select(node.child_max_z, node.child_min_z, z_forward);
    let z_high = select(node.child_min_z, node.child_max_z, z_forward);
    var hits = 0u;
    for (var half = 0u; half < 2u; half++) {
        // Four children a time: a component for each.
        let metas = unpack4xU8(node.child_meta[half]);
        let enter = max(
            max(vec4<f32>(near), vec4<f32>(unpack4xU8(x_low[half])) * x.z + x.x),
            max(vec4<f32>(unpack4xU8(y_low[half])) * y.z + y.x, vec4<f32>(unpack4xU8(z_low[half])) * z.z + z.x),
        );
        let leave = min(
            min(vec4<f32>(far), vec4<f32>(unpack4xU8(x_high[half])) * x.z + x.y),
            min(vec4<f32>(unpack4xU8(y_high[half])) * y.z + y.y, vec4<f32>(unpack4xU8(z_high[half])) * z.z + z.y),
        );
        let inner = ((vec4<u32>(imask >> (4u * half)) >> vec4<u32>(0u, 1u, 2u, 3u)) & vec4<u32>(1u)) == vec4<u32>(1u);
        let bits = select(
            (metas >> vec4<u32>(5u)) << (metas & vec4<u32>(31u)),
            vec4<u32>(1u) << (vec4<u32>(24u) + ((metas & vec4<u32>(7u)) ^ vec4<u32>(ray.octant))),
            inner,
        );
        let met = select(vec4<u32>(0u), bits, (metas != vec4<u32>(0u)) & (enter <= leave));
        hits |= met.x | met.y | met.z | met.w;
    }
    return hits;
}

fn axis_terms(p: f32, exponent: u32, origin: f32, inverse: f32) -> vec3<f32> {
    let spacing = bitcast<f32>(exponent << 23u);
    let start = p - origin;
    let slack = (abs(origin) + abs(start) + spacing * 255.0) * abs(inverse) * 8.0 * EPSILON;
    return vec3<f32>(start * inverse - slack, start * inverse + slack, spacing * inverse);
}
