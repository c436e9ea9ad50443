// From a world ray to hits; the twin of render/cpu/trace.rs.
//
// Where the twin takes a closure, each entry file defines `accept`: it sees every hit and may narrow `far`.

struct RawHit {
    distance: Distance,
    instance: u32,
    face: u32,
    net: u32,
    uv: vec2<f32>,
}

struct Collected {
    far: Distance,
    // Hits seen.
    count: u32,
    // The first one.
    hit: RawHit,
    // Where hits go that are kept in memory, and how many fit.
    first_slot: u32,
    slots: u32,
}

struct FaceParameters {
    uv: vec2<f32>,
    inside: bool,
}

const NO_NET: u32 = 0xffffffffu;

fn comes_before(a: RawHit, b: RawHit) -> bool {
    let ahead = minus(a.distance, b.distance);
    if ahead != 0.0 {
        return ahead < 0.0;
    }
    if a.face != b.face {
        return a.face < b.face;
    }
    if a.net != b.net {
        return a.net < b.net;
    }
    return a.instance < b.instance;
}

fn trace(ray: WorldRay, near: Distance, collected: ptr<function, Collected>) {
    let top = bvh_ray(grid_position(ray.grid) + ray.fraction, ray.direction);
    var placements = start_walk(header.first_node, header.node_count, 0u);
    loop {
        let instance = next_primitive(&placements, top, beyond(near, 0.0), beyond((*collected).far, 0.0));
        if instance == NO_PRIMITIVE {
            return;
        }
        let part_ray = enter_instance(ray, instance);
        if part_ray.meets {
            trace_part(part_ray, instance, near, collected);
        }
    }
}

fn trace_part(ray: PartRay, instance: u32, near: Distance, collected: ptr<function, Collected>) {
    let part = parts[instances[instance].part];
    let boxes = bvh_ray(ray.near_origin, ray.direction);
    var walk = start_walk(part.first_node, part.node_count, part.first_primitive);
    loop {
        let nearest = beyond(near, ray.near_anchor);
        let word = next_primitive(&walk, boxes, nearest, beyond((*collected).far, ray.near_anchor));
        if word == NO_PRIMITIVE {
            return;
        }
        if (word & NET_LEAF_BIT) == 0u {
            trace_face(ray, instance, word, near, collected);
        } else if HAS_NETS {
            trace_leaf(ray, instance, word & ~NET_LEAF_BIT, near, collected);
        }
    }
}

// The twin's test in `trace_face` and `trace_leaf`.
fn is_between(distance: Distance, near: Distance, far: Distance) -> bool {
    return minus(distance, near) >= 0.0 && minus(distance, far) <= 0.0;
}

fn trace_face(part_ray: PartRay, instance: u32, index: u32, near: Distance, collected: ptr<function, Collected>) {
    let face = faces[index];
    let ray = approach_frame(part_ray, index);
    let origin = apply_axes(index, ray.origin);
    let direction = apply_axes(index, ray.direction);
    let radii = vec2<f32>(face.radius_0, face.radius_1);
    var roots = carrier_roots(face.kind, origin, direction, radii);
    for (var i = 0u; i < roots.count; i++) {
        let t = roots.t[i];
        let distance = Distance(ray.anchor, t);
        if !is_between(distance, near, (*collected).far) {
            continue;
        }
        let parameters = carrier_parameters(face.kind, origin + direction * t, radii);
        let u = to_window(parameters.x, face.uv_low.x, face.uv_scale.x, face.period.x);
        let v = to_window(parameters.y, face.uv_low.y, face.uv_scale.y, face.period.y);
        let uv = vec2<f32>(u.value, v.value);
        if u.inside && v.inside && trim_inside(face.trim_root, uv) {
            accept(collected, RawHit(distance, instance, index, NO_NET, uv));
        }
    }
}

fn trace_leaf(part_ray: PartRay, instance: u32, index: u32, near: Distance, collected: ptr<function, Collected>) {
    let net = net_leaves[index].net;
    let face = nets[net].face;
    let ray = approach_point(part_ray, face, net_leaves[index].center);
    let domain = leaf_domain(index);
    var roots = leaf_roots(index, ray, beyond(near, ray.anchor), beyond((*collected).far, ray.anchor));
    for (var i = 0u; i < roots.count; i++) {
        let root = roots.root[i];
        let distance = Distance(ray.anchor, root.t);
        if !is_between(distance, near, (*collected).far) {
            continue;
        }
        let high = domain.low + domain.size;
        let own = ((root.uv >= domain.low) & (root.uv <= high))
            | ((domain.low == vec2<f32>(0.0)) & (root.uv < vec2<f32>(0.0)))
            | ((high == vec2<f32>(1.0)) & (root.uv > vec2<f32>(1.0)));
        var trim = faces[face].trim_root;
        if all(own) {
            trim = net_leaves[index].trim;
        }
        let p = face_parameters(net, faces[face].period, root.uv);
        if (all(own) && trim == TRIM_INSIDE) || (p.inside && trim_inside(trim, p.uv)) {
            accept(collected, RawHit(distance, instance, face, net, root.uv));
        }
    }
}

fn face_parameters(net: u32, period: vec2<f32>, uv: vec2<f32>) -> FaceParameters {
    let p = nets[net].uv_low + uv * nets[net].uv_size;
    let u = to_window(p.x, 0.0, 1.0, period.x);
    let v = to_window(p.y, 0.0, 1.0, period.y);
    return FaceParameters(vec2<f32>(u.value, v.value), u.inside && v.inside);
}
