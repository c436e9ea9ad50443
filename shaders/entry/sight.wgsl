// What is seen along a ray through a section; the twin of `first_seen` and `cap_hit` of render/cpu/section.rs. One loop walks the ray and the ways out of cut
// bodies in turn, so that `trace` stands once: a driver copies a function's whole text to each of its calls.

// The twin's Cut.
struct Cut {
    way: Kept,
    // Whether a cap may be where the way begins that has not been looked for.
    is_pending: bool,
}

// Count 0 where nothing is seen.
struct Seen {
    first: Collected,
    // The plane of the cap that is seen, or NO_PLANE.
    cap: u32,
}

fn accept(collected: ptr<function, Collected>, hit: RawHit) {
    if HAS_SECTION {
        if walks {
            if !may_cap(hit) {
                return;
            }
        } else if !is_kept(hit) {
            return;
        }
    }
    if (*collected).count == 0u || comes_before(hit, (*collected).hit) {
        (*collected).hit = hit;
        (*collected).far = hit.distance;
    }
    (*collected).count += 1u;
}

// Here an invocation has one ray.
fn next_ray(ray: ptr<function, WorldRay>, near: ptr<function, Distance>, collected: ptr<function, Collected>) -> bool {
    return false;
}

fn view_cut(section: Section, ray: WorldRay, near: Distance) -> Cut {
    var cut: Cut;
    if HAS_SECTION {
        cut.way = kept(section, ray);
        let is_cut = cut.way.sense * cut.way.enter < cut.way.sense * cut.way.leave;
        let begins = cut.way.plane != NO_PLANE && cut.way.enter > beyond(near, 0.0) && is_cut;
        cut.is_pending = begins && section.caps != 0u;
    }
    return cut;
}

fn first_seen(ray: WorldRay, start: Distance, far: Distance, cut: ptr<function, Cut>) -> Seen {
    var near = start;
    var seen: Seen;
    seen.cap = NO_PLANE;
    // What is seen if there is no cap.
    var found: Collected;
    if HAS_SECTION {
        kept_now = (*cut).way;
        walks = false;
        settled_count = 0u;
    }
    loop {
        var collected: Collected;
        collected.far = far;
        if HAS_SECTION && walks {
            collected.far = Distance(0.0, INFINITE);
        }
        trace(ray, near, &collected);
        seen.first = collected;
        if !HAS_SECTION || !(*cut).is_pending {
            break;
        }
        if !walks {
            // Where nothing is found this is where the ray ends.
            if beyond(collected.far, 0.0) < (*cut).way.enter {
                break;
            }
            found = collected;
            walks = true;
            near = to_pair((*cut).way.enter + surface_offset());
            continue;
        }
        if collected.count != 0u && dot(hit_normal(collected.hit), ray.direction) > 0.0 {
            seen.cap = (*cut).way.plane;
            seen.first.hit.distance = to_pair((*cut).way.enter);
        } else if collected.count != 0u && settled_count < MAX_SETTLED {
            settled[settled_count] = vec2<u32>(collected.hit.instance, faces[collected.hit.face].body);
            settled_count += 1u;
            near = collected.hit.distance;
            continue;
        } else {
            seen.first = found;
        }
        (*cut).is_pending = false;
        break;
    }
    return seen;
}
