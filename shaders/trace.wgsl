// From a world ray to hits; the twin of render/cpu/trace.rs, without its short way for one instance.
//
// Where the twin takes a closure, each entry file defines `accept`: it sees every hit and may narrow `far`; and `next_ray`, for the end of a ray.

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

// Where a root is on its face, and what is known of it.
struct Place {
    uv: vec2<f32>,
    margin: vec2<f32>,
    print: Footprint,
    // OUTSIDE or INSIDE, or NEAR where the trims have to tell.
    cover: u32,
}

// The twin's `trace`, `trace_part`, `trace_face` and `trace_leaf` in one loop. What they have in common so stands once, and invocations do it together: a
// walk of either level, the roots of a face or a search in a leaf, what the trims say of roots.
//
// Where invocations share rays, one that is through with its ray takes the next (`next_ray`, of each entry file), and one whose search takes longer than
// SEARCH_TURNS goes on with it while others walk. Rays that go different ways, of which some take fifty times as long as others, are traced up to twice as
// fast so; rays that go the same way lose each other, and with that a third of their speed or half.
fn trace(first_ray: WorldRay, first_near: Distance, collected: ptr<function, Collected>) {
    var ray = first_ray;
    var near = first_near;
    var boxes = world_boxes(ray);
    var walk = start_walk(0u, header.node_count, 0u, 0u);
    var boxes_anchor = 0.0;
    // The walk over instances, while one through a part is under way.
    var placements = walk;
    var is_in_part = false;
    var part_ray: PartRay;
    var instance = 0u;
    // Whose roots are next.
    var face = 0u;
    var net = NO_NET;
    var leaf = 0u;
    var anchor = 0.0;
    var leaf_search: LeafSearch;
    loop {
        var carrier: CarrierRay;
        var carrier_t = no_roots();
        if !HAS_NETS || !SHARES_RAYS || !leaf_search.goes_on {
            var word = NO_PRIMITIVE;
            loop {
                let nearest = beyond(near, boxes_anchor);
                word = next_primitive(&walk, boxes, nearest, beyond((*collected).far, boxes_anchor));
                if word != NO_PRIMITIVE && is_in_part {
                    break;
                }
                if word != NO_PRIMITIVE {
                    instance = word;
                    part_ray = enter_instance(ray, instance);
                    if part_ray.meets {
                        is_in_part = true;
                        placements = walk;
                        let part = parts[instances[instance].part];
                        walk = start_walk(part.first_node, part.node_count, part.first_primitive, placements.depth);
                        boxes = bvh_ray(part_ray.near_origin, part_ray.direction);
                        boxes_anchor = part_ray.near_anchor;
                    }
                    continue;
                }
                if is_in_part {
                    is_in_part = false;
                    walk = placements;
                } else if next_ray(&ray, &near, collected) {
                    walk = start_walk(0u, header.node_count, 0u, 0u);
                } else {
                    break;
                }
                boxes = world_boxes(ray);
                boxes_anchor = 0.0;
            }
            if word == NO_PRIMITIVE {
                return;
            }
            let is_face = (word & NET_LEAF_BIT) == 0u;
            if HAS_NETS && !is_face {
                leaf = word & ~NET_LEAF_BIT;
                net = net_leaves[leaf].net;
                face = nets[net].face;
                let near_leaf = approach_point(part_ray, face, net_leaves[leaf].center);
                anchor = near_leaf.anchor;
                start_leaf(leaf, near_leaf, beyond(near, anchor), beyond((*collected).far, anchor), &leaf_search);
            } else {
                net = NO_NET;
                if HAS_CARRIERS && is_face {
                    face = word;
                    carrier = carrier_ray(part_ray, face);
                    anchor = carrier.anchor;
                    carrier_t = carrier_roots(carrier);
                }
            }
        }
        let is_leaf = HAS_NETS && net != NO_NET;
        var count = carrier_t.count;
        if is_leaf {
            count = net_roots.count;
        }
        if SHARES_RAYS && leaf_search.goes_on {
            search_leaf(&leaf_search);
            count = select(net_roots.count, 0u, leaf_search.goes_on);
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
                let is_cut = is_leaf && net_roots.is_cut;
                let certainty = select(certainty_of(covered, place.print.is_grazing), NEAR_BORDER, is_cut);
                let uv = select(place.uv, net_roots.root[i].uv, vec2<bool>(is_leaf));
                accept(collected, RawHit(distance, instance, face, net, uv, certainty));
            }
        }
    }
}

fn world_boxes(ray: WorldRay) -> BvhRay {
    return bvh_ray(grid_position(ray.grid) + ray.fraction, ray.direction);
}

fn carrier_ray(part_ray: PartRay, face: u32) -> CarrierRay {
    let ray = approach_frame(part_ray, face);
    let radii = vec2<f32>(faces[face].radius_0, faces[face].radius_1);
    return CarrierRay(faces[face].kind, apply_axes(face, ray.origin), apply_axes(face, ray.direction), radii, ray.anchor);
}

fn is_between(distance: Distance, near: Distance, far: Distance) -> bool {
    return minus(distance, near) >= 0.0 && minus(distance, far) <= 0.0;
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
