// From a world ray to hits; the twin of render/cpu/trace.rs, without its short way for one instance.
//
// Where the twin takes a closure, each entry file defines `accept`: it sees every hit and may narrow `far`.

struct RawHit {
    distance: Distance,
    instance: u32,
    face: u32,
    net: u32,
    uv: vec2<f32>,
    // The twin's Certainty.
    certainty: u32,
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

const NO_NET: u32 = 0xffffffffu;

// Of hits as near as their slacks the twin may take another: it lets a hit count from where its box begins, so that the order of its walks is of no account.
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
    var placements = start_walk(0u, header.node_count, 0u, 0u);
    loop {
        let instance = next_primitive(&placements, top, beyond(near, 0.0), beyond((*collected).far, 0.0));
        if instance == NO_PRIMITIVE {
            return;
        }
        let part_ray = enter_instance(ray, instance);
        if part_ray.meets {
            trace_part(part_ray, instance, near, placements.depth, collected);
        }
    }
}

fn trace_part(ray: PartRay, instance: u32, near: Distance, bottom: u32, collected: ptr<function, Collected>) {
    let part = parts[instances[instance].part];
    let boxes = bvh_ray(ray.near_origin, ray.direction);
    var walk = start_walk(part.first_node, part.node_count, part.first_primitive, bottom);
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
        let t = next_root(&roots);
        let distance = Distance(ray.anchor, t);
        if !is_between(distance, near, (*collected).far) {
            continue;
        }
        let point = origin + direction * t;
        let at = (carrier_parameters(face.kind, point, radii) - face.uv_low) * face.uv_scale;
        let uv = vec2<f32>(to_window(at.x, face.period.x), to_window(at.y, face.period.y));
        if is_far_outside(uv) {
            continue;
        }
        let s = carrier_tangents(face.kind, point, radii);
        let curvature = carrier_curvature(face.kind, point, radii);
        let print = scaled(footprint(direction, s.u, s.v, curvature, face.slack), face.uv_scale);
        let margin = vec2<f32>(
            window_margin(face.uv_low.x, face.uv_scale.x),
            window_margin(face.uv_low.y, face.uv_scale.y),
        );
        let covered = cover(index, uv, margin, print, part_ray.direction);
        if covered != OUTSIDE {
            let certainty = certainty_of(covered, print.is_grazing);
            accept(collected, RawHit(distance, instance, index, NO_NET, uv, certainty));
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
        let covered = leaf_cover(index, domain, root, part_ray.direction);
        if covered != OUTSIDE {
            let certainty = select(certainty_of(covered, root.footprint.is_grazing), NEAR_BORDER, roots.is_cut);
            accept(collected, RawHit(distance, instance, face, net, root.uv, certainty));
        }
    }
}

fn certainty_of(covered: u32, is_grazing: bool) -> u32 {
    return select(select(NEAR_BORDER, OWN, covered >= NEAR), CERTAIN, covered == INSIDE && !is_grazing);
}

fn leaf_cover(leaf: u32, domain: Domain, root: NetRoot, direction: vec3<f32>) -> u32 {
    let half_box = extent(root.footprint);
    let from_low = root.uv - domain.low;
    let is_own = all(from_low >= half_box) && all(domain.size - from_low >= half_box);
    if net_leaves[leaf].trim == TRIM_INSIDE && is_own {
        return INSIDE;
    }
    let net = net_leaves[leaf].net;
    let face = nets[net].face;
    let uv = face_parameters(net, faces[face].period, root.uv);
    let print = scaled(root.footprint, nets[net].uv_size);
    return cover(face, uv, vec2<f32>(0.0), print, direction);
}

fn face_parameters(net: u32, period: vec2<f32>, uv: vec2<f32>) -> vec2<f32> {
    let p = nets[net].uv_low + uv * nets[net].uv_size;
    return vec2<f32>(to_window(p.x, period.x), to_window(p.y, period.y));
}
