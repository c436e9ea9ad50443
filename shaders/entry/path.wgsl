// Light paths, one ray at a time; the twin of render/cpu/path.rs. Only path tracing has these functions: they read the parameters of paths.wgsl.

fn turn(state: ptr<function, PathState>, sum: ptr<function, PathSum>) {
    if (*state).kind == START && !start(state) {
        finish(state, sum);
        return;
    }
    let ray = WorldRay((*state).grid, (*state).fraction, (*state).direction, (*state).direction_low);
    let near = Distance((*state).near_anchor, (*state).near_offset);
    var cut = view_cut(parameters.section, ray, near);
    let seen = first_seen(ray, near, Distance(0.0, INFINITE), &cut);
    let hit = seen.first.hit;
    let is_hit = seen.first.count != 0u;
    let ground = ground_distance(ray, near);
    let is_ground = ground < select(INFINITE, beyond(hit.distance, 0.0), is_hit);
    let pixel = path_key((*state).pixel);
    var goes_on = false;
    if is_hit && !is_ground {
        let material = materials[hit_material(hit)];
        if passes(state, pixel, material.opacity) {
            (*state).passed += 1u;
            (*state).near_anchor = hit.distance.anchor;
            (*state).near_offset = hit.distance.offset + surface_offset();
            return;
        }
        if (*state).kind == PATH {
            if (*state).bounces == 0u {
                (*state).alpha = 1.0;
            }
            if (*state).bounces < parameters.max_depth {
                var n: vec3<f32>;
                var share = 1.0;
                if HAS_SECTION && seen.cap != NO_PLANE {
                    let plane = section_plane(parameters.section, seen.cap);
                    n = plane.normal;
                    let origin = grid_position(ray.grid) + ray.fraction;
                    share = hatch(plane, origin + ray.direction * beyond(hit.distance, 0.0), hit.instance);
                } else {
                    n = hit_normal(hit);
                }
                n = select(n, -n, dot(n, ray.direction) > 0.0);
                let place = surface(material, share, n, -ray.direction);
                leave(state, ray, hit, n);
                goes_on = bounce(state, place, n, pixel);
            }
        } else {
            goes_on = answer(state, (*state).kind == CATCHER);
        }
    } else if (*state).kind != PATH {
        goes_on = answer(state, (*state).kind == SHADOW && !is_ground);
    } else if is_ground {
        goes_on = catch_shadow(state, ray, ground, pixel);
    } else {
        meet_surroundings(state, ray.direction);
    }
    if !goes_on {
        finish(state, sum);
    }
}

fn path_key(pixel: u32) -> u32 {
    let width = parameters.camera.window_width;
    return pixel_key(
        (parameters.camera.corner & 0xffffu) + pixel % width,
        (parameters.camera.corner >> 16u) + pixel / width,
    );
}

fn start(state: ptr<function, PathState>) -> bool {
    let pixel = path_key((*state).pixel);
    let offset = sample_pair(pixel, (*state).sample_index, 0u, parameters.seed);
    let ray = pixel_ray(
        parameters.camera,
        f32(pixel & 0xffffu) + offset.x,
        f32(pixel >> 16u) + offset.y,
        parameters.reach,
    );
    var fresh: PathState;
    fresh.kind = PATH;
    fresh.throughput = vec3<f32>(1.0);
    fresh.pixel = (*state).pixel;
    fresh.sample_index = (*state).sample_index;
    fresh.end = (*state).end;
    fresh.grid = ray.ray.grid;
    fresh.fraction = ray.ray.fraction;
    fresh.direction = ray.ray.direction;
    fresh.direction_low = ray.ray.direction_low;
    fresh.near_anchor = ray.near.anchor;
    fresh.near_offset = ray.near.offset;
    *state = fresh;
    if !ray.meets {
        meet_surroundings(state, ray.ray.direction);
    }
    return ray.meets;
}

fn finish(state: ptr<function, PathState>, sum: ptr<function, PathSum>) {
    let brightness = luminance((*state).light) + (1.0 - (*state).alpha) * parameters.behind;
    if is_finite(brightness) {
        (*sum).color += vec4<f32>((*state).light, (*state).alpha);
        (*sum).brightness += brightness;
        (*sum).square += brightness * brightness;
    }
    (*state).sample_index += 1u;
    (*state).kind = select(START, DONE, (*state).sample_index == (*state).end);
}

fn passes(state: ptr<function, PathState>, pixel: u32, opacity: f32) -> bool {
    if opacity >= 1.0 || (*state).passed >= MAX_PASSED {
        return false;
    }
    let pair = 1024u + 64u * (4u * (*state).bounces + (*state).kind) + (*state).passed;
    return sample_pair(pixel, (*state).sample_index, pair, parameters.seed).x >= opacity;
}

fn ground_distance(ray: WorldRay, near: Distance) -> f32 {
    let rate = dot(parameters.ground_up, ray.direction);
    if parameters.ground_irradiance <= 0.0 || rate > -1e-6 {
        return INFINITE;
    }
    let origin = grid_position(ray.grid) + ray.fraction;
    let distance = (parameters.ground_height - dot(parameters.ground_up, origin)) / rate;
    let is_near = length(origin + ray.direction * distance) < parameters.reach;
    return select(INFINITE, distance, is_near && distance > beyond(near, 0.0));
}

fn leave(state: ptr<function, PathState>, ray: WorldRay, hit: RawHit, n: vec3<f32>) {
    let left = leave_surface(ray, hit, n, n, surface_offset());
    (*state).grid = left.grid;
    (*state).fraction = left.fraction;
    (*state).direction_low = vec3<f32>(0.0);
}

fn send(state: ptr<function, PathState>, kind: u32, direction: vec3<f32>) {
    (*state).kind = kind;
    (*state).direction = direction;
    (*state).near_anchor = 0.0;
    (*state).near_offset = 0.0;
    (*state).passed = 0u;
}

fn answer(state: ptr<function, PathState>, counts: bool) -> bool {
    if counts {
        (*state).light += (*state).asked;
        (*state).alpha += (*state).asked_alpha;
    }
    if all((*state).next == vec3<f32>(0.0)) {
        return false;
    }
    send(state, PATH, (*state).next);
    return true;
}

fn meet_surroundings(state: ptr<function, PathState>, direction: vec3<f32>) {
    var weight = 1.0;
    if (*state).bounces == 0u {
        if parameters.shows_surroundings == 0u {
            return;
        }
        (*state).alpha = 1.0;
    } else {
        weight = (*state).density / ((*state).density + light_density(direction));
    }
    let found = (*state).throughput * light_from(direction) * weight;
    if (*state).bounces > 1u {
        (*state).light += held(found);
    } else {
        (*state).light += found;
    }
}

fn held(light: vec3<f32>) -> vec3<f32> {
    return light * (parameters.brightest / max(luminance(light), parameters.brightest));
}

fn path_points(state: ptr<function, PathState>, pixel: u32, number: u32) -> vec2<f32> {
    return sample_pair(pixel, (*state).sample_index, 1u + 3u * (*state).bounces + number, parameters.seed);
}

fn bounce(state: ptr<function, PathState>, place: Surface, n: vec3<f32>, pixel: u32) -> bool {
    let light = sample_light(false, path_points(state, pixel, 0u));
    let chances = path_points(state, pixel, 2u);
    let next = sample_direction(place, path_points(state, pixel, 1u), chances.x);
    var asked = vec3<f32>(0.0);
    if dot(n, light.direction) > 0.0 && !meets_ground(state, light.direction) {
        let scattered = scatter(place, light.direction);
        let weight = 1.0 / (light.density + scattered.density);
        asked = (*state).throughput * scattered.value * light_from(light.direction) * weight;
        if (*state).bounces > 0u {
            asked = held(asked);
        }
    }
    let scattered = scatter(place, next);
    (*state).bounces += 1u;
    (*state).density = scattered.density;
    (*state).next = next;
    if scattered.density > 0.0 {
        (*state).throughput *= scattered.value * (1.0 / scattered.density);
    } else {
        (*state).next = vec3<f32>(0.0);
    }
    if (*state).bounces > SURE_BOUNCES {
        let throughput = (*state).throughput;
        let chance = min(max(max(throughput.x, throughput.y), throughput.z), 0.95);
        if chances.y >= chance {
            (*state).next = vec3<f32>(0.0);
        } else {
            (*state).throughput = throughput / chance;
        }
    }
    (*state).asked = asked;
    (*state).asked_alpha = 0.0;
    if max(max(asked.x, asked.y), asked.z) > 0.0 {
        send(state, SHADOW, light.direction);
        return true;
    }
    return answer(state, false);
}

fn meets_ground(state: ptr<function, PathState>, direction: vec3<f32>) -> bool {
    let ray = WorldRay((*state).grid, (*state).fraction, direction, vec3<f32>(0.0));
    return ground_distance(ray, Distance(0.0, 0.0)) < INFINITE;
}

fn catch_shadow(state: ptr<function, PathState>, ray: WorldRay, distance: f32, pixel: u32) -> bool {
    var shown = vec3<f32>(0.0);
    let is_shown = (*state).bounces > 0u || parameters.shows_surroundings != 0u;
    if is_shown {
        shown = (*state).throughput * light_from(ray.direction);
        (*state).light += shown;
        if (*state).bounces == 0u {
            (*state).alpha = 1.0;
        }
    }
    let light = sample_light(true, path_points(state, pixel, 0u));
    let cosine = dot(parameters.ground_up, light.direction);
    if cosine <= 0.0 {
        return false;
    }
    let received = luminance(light_from(light.direction)) * cosine;
    let share = received / (light.density * parameters.ground_irradiance);
    var hit: RawHit;
    hit.distance = to_pair(distance);
    leave(state, ray, hit, parameters.ground_up);
    (*state).asked = -shown * share;
    (*state).asked_alpha = select(share, 0.0, is_shown);
    (*state).next = vec3<f32>(0.0);
    send(state, CATCHER, light.direction);
    return true;
}
