// The look of a hit; the twin of render/cpu/shade.rs. The constants of the look come from render/cpu/light.rs.

const MAX_LAYERS: u32 = 8u;

struct Lights {
    key: vec3<f32>,
    reserved_0: u32,
    fill: vec3<f32>,
    reserved_1: u32,
    up: vec3<f32>,
    ambient_occlusion: u32,
}

struct Shaded {
    color: vec4<f32>,
    // The first hit of the ray, and its normal towards the eye; count 0 where nothing is hit.
    first: Collected,
    normal: vec3<f32>,
    // The plane of the cap that the first hit is, or NO_PLANE.
    cap: u32,
}

// The twin's `shade_layers`, `shade_hit` and `openness`. One loop walks the ray, the rays that look for the sky and the ways out of cut bodies in
// turn, so that `trace` stands once: a driver copies a function's whole text to each of its calls.
fn shade_layers(lights: Lights, section: Section, pixel_ray: PixelRay, pixel: u32, sample_index: u32, center_only: bool) -> Shaded {
    var shaded: Shaded;
    var ray = pixel_ray.ray;
    var near = pixel_ray.near;
    var far = Distance(0.0, INFINITE);
    var to_sky = false;
    var layer = 1u;
    var hit: RawHit;
    var n: vec3<f32>;
    var cap = NO_PLANE;
    shaded.cap = NO_PLANE;
    // What the planes leave of the ray, whether a cap may be where that begins, and what is seen if there is none.
    var way: Kept;
    var is_pending = false;
    var found: Collected;
    if HAS_SECTION {
        way = kept(section, ray);
        kept_now = way;
        let begins = way.plane != NO_PLANE && way.enter > beyond(near, 0.0) && way.enter < way.leave;
        is_pending = begins && section.caps != 0u;
        walks = false;
        settled_count = 0u;
    }
    while layer <= MAX_LAYERS {
        var seen: Collected;
        seen.far = far;
        trace(ray, near, &seen);
        var open = 1.0;
        if to_sky {
            open = openness(seen);
        } else {
            cap = NO_PLANE;
            if HAS_SECTION && is_pending {
                if walks {
                    if seen.count != 0u && dot(hit_normal(seen.hit), ray.direction) > 0.0 {
                        cap = way.plane;
                        seen.hit.distance = to_pair(way.enter);
                    } else if seen.count != 0u && settled_count < MAX_SETTLED {
                        settled[settled_count] = vec2<u32>(seen.hit.instance, faces[seen.hit.face].body);
                        settled_count += 1u;
                        near = seen.hit.distance;
                        continue;
                    } else {
                        seen = found;
                    }
                    walks = false;
                    is_pending = false;
                } else if seen.count == 0u || beyond(seen.hit.distance, 0.0) >= way.enter {
                    found = seen;
                    walks = true;
                    near = to_pair(way.enter + surface_offset());
                    continue;
                }
            }
            if seen.count == 0u {
                break;
            }
            hit = seen.hit;
            if HAS_SECTION && cap != NO_PLANE {
                n = section_plane(section, cap).normal;
            } else {
                n = hit_normal(hit);
            }
            n = select(n, -n, dot(n, ray.direction) > 0.0);
            if layer == 1u {
                shaded.first = seen;
                shaded.normal = n;
                shaded.cap = cap;
            }
            if center_only {
                break;
            }
            if lights.ambient_occlusion != 0u {
                to_sky = true;
                let place = sky_sample(pixel, sample_index);
                let direction = cosine_direction(n, place.x, place.y);
                ray = leave_surface(pixel_ray.ray, hit, n, direction, surface_offset());
                if HAS_SECTION {
                    kept_now = kept(section, ray);
                }
                near = Distance(0.0, 0.0);
                far = Distance(0.0, header.scene_radius * OCCLUSION_RADIUS);
                continue;
            }
        }
        let material = materials[hit_material(hit)];
        var lit = shade_surface(lights, n, -pixel_ray.ray.direction, material, open);
        if HAS_SECTION && cap != NO_PLANE {
            let origin = grid_position(pixel_ray.ray.grid) + pixel_ray.ray.fraction;
            let point = origin + pixel_ray.ray.direction * beyond(hit.distance, 0.0);
            lit *= hatch(section_plane(section, cap), point, hit.instance);
        }
        // What lies behind the last layer is not looked for: the layer stands for it.
        let opacity = select(material.opacity, 1.0, layer == MAX_LAYERS);
        let left = (1.0 - shaded.color.w) * opacity;
        shaded.color += vec4<f32>(lit * left, left);
        if shaded.color.w > 0.995 {
            shaded.color = vec4<f32>(shaded.color.xyz * (1.0 / shaded.color.w), 1.0);
            break;
        }
        to_sky = false;
        kept_now = way;
        ray = pixel_ray.ray;
        near = Distance(hit.distance.anchor, hit.distance.offset + surface_offset());
        far = Distance(0.0, INFINITE);
        layer += 1u;
    }
    return shaded;
}

fn hit_material(hit: RawHit) -> u32 {
    let of_instance = instances[hit.instance].material;
    return select(of_instance, faces[hit.face].material, of_instance == NO_MATERIAL);
}

fn surface_offset() -> f32 {
    return header.scene_radius * SURFACE_OFFSET;
}

fn shade_surface(lights: Lights, n: vec3<f32>, view: vec3<f32>, material: Material, open: f32) -> vec3<f32> {
    let soft = 0.35 + 0.65 * open;
    let key = max(dot(n, lights.key), 0.0) * soft;
    let fill = max(dot(n, lights.fill), 0.0) * soft;
    let sky = 0.5 + 0.5 * dot(n, lights.up);
    let facing = clamp(dot(n, view), 0.0, 1.0);
    let grazing = (1.0 - facing) * (1.0 - facing);
    let rim = grazing * grazing * (1.0 - facing) * open;
    let gleam = specular(n, view, lights.key) * soft + 0.25 * specular(n, view, lights.fill) * soft;
    let ambient = (AMBIENT_DOWN + (AMBIENT_UP - AMBIENT_DOWN) * sky) * AMBIENT_WEIGHT * open;
    let diffuse = ambient + key * KEY_COLOR + fill * FILL_COLOR;
    return material.rgb * diffuse + gleam * KEY_COLOR + rim * RIM_COLOR;
}

fn specular(n: vec3<f32>, view: vec3<f32>, light: vec3<f32>) -> f32 {
    let middle = view + light;
    let norm = length(middle);
    if norm < 1e-6 || dot(n, light) <= 0.0 {
        return 0.0;
    }
    let along = max(dot(n, middle) / norm, 0.0);
    return SPECULAR_REFLECTANCE * (GLOSS + 8.0) / 8.0 * pow(along, GLOSS) * dot(n, light);
}

fn openness(seen: Collected) -> f32 {
    if seen.count == 0u {
        return 1.0;
    }
    let blocked = 1.0 - clamp(beyond(seen.hit.distance, 0.0) / (header.scene_radius * OCCLUSION_RADIUS), 0.0, 1.0);
    return 1.0 - blocked * blocked;
}

fn sky_sample(pixel: u32, sample_index: u32) -> vec2<f32> {
    let x = pixel & 0xffffu;
    let y = pixel >> 16u;
    let tile = pixel_key(x >> 2u, y >> 2u);
    let place = ((x & 1u) << 3u) | ((y & 1u) << 2u) | (x & 2u) | ((y & 2u) >> 1u);
    let index = (place << 6u) + sample_index;
    let a = hash(tile, 0u, 2u) + index * 0xc13fa9a9u;
    let b = hash(tile, 0u, 3u) + index * 0x91e10da5u;
    return vec2<f32>(unit(a), unit(b));
}

fn leave_surface(
    ray: WorldRay,
    hit: RawHit,
    n: vec3<f32>,
    direction: vec3<f32>,
    offset: f32,
) -> WorldRay {
    let spacing = header.grid_step;
    let base = grid_position(ray.grid);
    let at_anchor = fused(ray.direction, hit.distance.anchor, base);
    let rest = ray.fraction + ray.direction_low * hit.distance.anchor + ray.direction * hit.distance.offset;
    let position = at_anchor + (rest + n * offset);
    let whole = floor(position / spacing + 0.5);
    return WorldRay(vec3<i32>(whole), position - whole * spacing, direction, vec3<f32>(0.0));
}

fn cosine_direction(n: vec3<f32>, a: f32, b: f32) -> vec3<f32> {
    let z = 1.0 - 2.0 * a;
    let across = sqrt(max(1.0 - z * z, 0.0));
    let turn = real_sin_cos(b * 4.0 * HALF_PI);
    let sum = n + vec3<f32>(across * turn.y, across * turn.x, z);
    let norm = length(sum);
    if norm > 1e-3 {
        return sum * (1.0 / norm);
    }
    return n;
}
