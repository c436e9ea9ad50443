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

// The twin's `trace` and `trace_part` in one loop, so that the walk stands once, and rays on their way to a part walk beside those inside of one.
fn trace(ray: WorldRay, near: Distance, collected: ptr<function, Collected>) {
    var boxes = bvh_ray(grid_position(ray.grid) + ray.fraction, ray.direction);
    var walk = start_walk(0u, header.node_count, 0u, 0u);
    var anchor = 0.0;
    // The walk over instances, while one through a part is under way.
    var placements = walk;
    var is_in_part = false;
    var part_ray: PartRay;
    var instance = 0u;
    loop {
        let word = next_primitive(&walk, boxes, beyond(near, anchor), beyond((*collected).far, anchor));
        if word == NO_PRIMITIVE {
            if !is_in_part {
                return;
            }
            is_in_part = false;
            walk = placements;
            boxes = bvh_ray(grid_position(ray.grid) + ray.fraction, ray.direction);
            anchor = 0.0;
        } else if is_in_part {
            trace_primitive(part_ray, instance, word, near, collected);
        } else {
            instance = word;
            part_ray = enter_instance(ray, instance);
            if part_ray.meets {
                is_in_part = true;
                placements = walk;
                let part = parts[instances[instance].part];
                walk = start_walk(part.first_node, part.node_count, part.first_primitive, placements.depth);
                boxes = bvh_ray(part_ray.near_origin, part_ray.direction);
                anchor = part_ray.near_anchor;
            }
        }
    }
}

fn is_between(distance: Distance, near: Distance, far: Distance) -> bool {
    return minus(distance, near) >= 0.0 && minus(distance, far) <= 0.0;
}

// Where a root is on its face, and what is known of it.
struct Place {
    uv: vec2<f32>,
    margin: vec2<f32>,
    print: Footprint,
    // OUTSIDE or INSIDE, or NEAR where the trims have to tell.
    cover: u32,
}

// The twin's `trace_face` and `trace_leaf` in one, so that what comes after the roots stands once, and rays at a face and at a leaf do it together.
fn trace_primitive(part_ray: PartRay, instance: u32, word: u32, near: Distance, collected: ptr<function, Collected>) {
    let is_leaf = HAS_NETS && (word & NET_LEAF_BIT) != 0u;
    let leaf = word & ~NET_LEAF_BIT;
    var face = word;
    var net = NO_NET;
    var anchor = 0.0;
    var count = 0u;
    var is_cut = false;
    var carrier: CarrierRay;
    var carrier_t: Roots;
    if is_leaf {
        net = net_leaves[leaf].net;
        face = nets[net].face;
        let ray = approach_point(part_ray, face, net_leaves[leaf].center);
        leaf_roots(leaf, ray, beyond(near, ray.anchor), beyond((*collected).far, ray.anchor));
        anchor = ray.anchor;
        count = net_roots.count;
        is_cut = net_roots.is_cut;
    } else if HAS_CARRIERS {
        let ray = approach_frame(part_ray, face);
        let radii = vec2<f32>(faces[face].radius_0, faces[face].radius_1);
        carrier = CarrierRay(faces[face].kind, apply_axes(face, ray.origin), apply_axes(face, ray.direction), radii);
        carrier_t = carrier_roots(carrier);
        anchor = ray.anchor;
        count = carrier_t.count;
    }
    for (var i = 0u; i < count; i++) {
        var distance = Distance(anchor, 0.0);
        if is_leaf {
            distance.offset = net_roots.root[i].t;
        } else {
            distance.offset = next_root(&carrier_t);
        }
        if !is_between(distance, near, (*collected).far) {
            continue;
        }
        var place: Place;
        if is_leaf {
            place = leaf_place(leaf, net_roots.root[i]);
        } else if HAS_CARRIERS {
            place = face_place(face, carrier, distance.offset);
        }
        var covered = place.cover;
        if covered == NEAR {
            covered = cover(face, place.uv, place.margin, place.print, part_ray.direction);
        }
        if covered != OUTSIDE {
            let certainty = select(certainty_of(covered, place.print.is_grazing), NEAR_BORDER, is_cut);
            let uv = select(place.uv, net_roots.root[i].uv, vec2<bool>(is_leaf));
            accept(collected, RawHit(distance, instance, face, net, uv, certainty));
        }
    }
}

fn face_place(index: u32, ray: CarrierRay, t: f32) -> Place {
    let uv_low = faces[index].uv_low;
    let uv_scale = faces[index].uv_scale;
    let period = faces[index].period;
    let point = ray.origin + ray.direction * t;
    let at = (carrier_parameters(ray.kind, point, ray.radii) - uv_low) * uv_scale;
    var place: Place;
    place.uv = vec2<f32>(to_window(at.x, period.x), to_window(at.y, period.y));
    if is_far_outside(place.uv) {
        place.cover = OUTSIDE;
        return place;
    }
    let s = carrier_tangents(ray.kind, point, ray.radii);
    let curvature = carrier_curvature(ray.kind, point, ray.radii);
    place.print = scaled(footprint(ray.direction, s.u, s.v, curvature, faces[index].slack), uv_scale);
    place.margin = vec2<f32>(window_margin(uv_low.x, uv_scale.x), window_margin(uv_low.y, uv_scale.y));
    place.cover = NEAR;
    return place;
}

fn leaf_place(leaf: u32, root: NetRoot) -> Place {
    let domain = leaf_domain(leaf);
    let half_box = extent(root.footprint);
    let from_low = root.uv - domain.low;
    let is_own = all(from_low >= half_box) && all(domain.size - from_low >= half_box);
    if net_leaves[leaf].trim == TRIM_INSIDE && is_own {
        return Place(root.uv, vec2<f32>(0.0), root.footprint, INSIDE);
    }
    let net = net_leaves[leaf].net;
    let uv = face_parameters(net, faces[nets[net].face].period, root.uv);
    return Place(uv, vec2<f32>(0.0), scaled(root.footprint, nets[net].uv_size), NEAR);
}

fn certainty_of(covered: u32, is_grazing: bool) -> u32 {
    return select(select(NEAR_BORDER, OWN, covered >= NEAR), CERTAIN, covered == INSIDE && !is_grazing);
}

fn face_parameters(net: u32, period: vec2<f32>, uv: vec2<f32>) -> vec2<f32> {
    let p = nets[net].uv_low + uv * nets[net].uv_size;
    return vec2<f32>(to_window(p.x, period.x), to_window(p.y, period.y));
}
