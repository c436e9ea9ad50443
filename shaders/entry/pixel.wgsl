// What a ray through a pixel shows; the twin of render/cpu/shade_rays.rs as far as that walks through layers. Only pictures have these functions: they read the
// parameters and the refined pixels of render.wgsl.

const MAX_LAYERS: u32 = 8u;

struct Shaded {
    color: vec4<f32>,
    // The first hit of the ray, and its normal towards the eye; count 0 where nothing is hit.
    first: Collected,
    normal: vec3<f32>,
    // The light of the first hit without any sky and under the whole.
    dark: vec3<f32>,
    lit: vec3<f32>,
    open: f32,
    is_see_through: bool,
    // The plane of the cap that the first hit is, or NO_PLANE.
    cap: u32,
}

// The twin's `shade_centers` and `shade_samples`. One loop walks the ray and the rays that look for the sky in turn, so that `first_seen` stands once.
fn shade_layers(
    lights: Lights,
    section: Section,
    pixel_ray: PixelRay,
    pixel: u32,
    center_only: bool,
    index: u32,
) -> Shaded {
    var shaded: Shaded;
    shaded.open = 1.0;
    shaded.cap = NO_PLANE;
    var ray = pixel_ray.ray;
    var near = pixel_ray.near;
    var far = Distance(0.0, INFINITE);
    var to_sky = false;
    var layer = 1u;
    var hit: RawHit;
    var n: vec3<f32>;
    var cap = NO_PLANE;
    // The way of the ray that is walked now, and that of the pixel's.
    var cut = view_cut(section, ray, near);
    var own_cut = cut;
    while layer <= MAX_LAYERS {
        let sight = first_seen(ray, near, far, &cut);
        let seen = sight.first;
        var open = 1.0;
        if to_sky {
            open = openness(seen);
        } else {
            cap = sight.cap;
            own_cut = cut;
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
            if lights.ambient_occlusion != 0u {
                var known = -1.0;
                if layer == 1u && !center_only {
                    known = known_openness(index, hit, cap, n);
                }
                if known < 0.0 {
                    to_sky = true;
                    let sample_index = select(parameters.sample_index, 0u, center_only);
                    let place = sky_sample(pixel, sample_index, select(parameters.samples, 1u, center_only));
                    let direction = cosine_direction(n, place.x, place.y);
                    ray = leave_surface(pixel_ray.ray, hit, n, direction, surface_offset());
                    near = Distance(0.0, 0.0);
                    cut = view_cut(section, ray, near);
                    far = Distance(0.0, header.scene_radius * OCCLUSION_RADIUS);
                    continue;
                }
                open = known;
            }
        }
        let material = materials[hit_material(hit)];
        let view = -pixel_ray.ray.direction;
        var share = 1.0;
        if HAS_SECTION && cap != NO_PLANE {
            let origin = grid_position(pixel_ray.ray.grid) + pixel_ray.ray.fraction;
            let point = origin + pixel_ray.ray.direction * beyond(hit.distance, 0.0);
            share = hatch(section_plane(section, cap), point, hit.instance);
        }
        let dark = shade_surface(lights, n, view, material, 0.0) * share;
        let lit = shade_surface(lights, n, view, material, 1.0) * share;
        if layer == 1u {
            shaded.lit = lit;
            if center_only {
                shaded.dark = dark;
                shaded.open = open;
                shaded.is_see_through = material.opacity < 1.0;
                break;
            }
        }
        // What lies behind the last layer is not looked for: the layer stands for it.
        let opacity = select(material.opacity, 1.0, layer == MAX_LAYERS);
        let left = (1.0 - shaded.color.w) * opacity;
        shaded.color += vec4<f32>((dark + (lit - dark) * open) * left, left);
        if shaded.color.w > 0.995 {
            shaded.color = vec4<f32>(shaded.color.xyz * (1.0 / shaded.color.w), 1.0);
            break;
        }
        to_sky = false;
        cut = own_cut;
        ray = pixel_ray.ray;
        near = Distance(hit.distance.anchor, hit.distance.offset + surface_offset());
        far = Distance(0.0, INFINITE);
        layer += 1u;
    }
    return shaded;
}

fn known_openness(index: u32, hit: RawHit, cap: u32, n: vec3<f32>) -> f32 {
    let face = select(0u, hit.face + 1u, cap == NO_PLANE);
    for (var i = 0; i < 5; i++) {
        let is_same = refined[index].around[i].face == face
            && refined[index].around[i].instance == hit.instance + 1u;
        if is_same && dot(n, refined[index].around[i].normal) > SAME_WAY {
            return refined[index].around[i].open;
        }
    }
    return -1.0;
}

fn beside(shaded: Shaded, place: vec2<f32>, index: u32) -> u32 {
    let is_low = place < vec2<f32>(CLOSE);
    let is_high = place > vec2<f32>(1.0 - CLOSE);
    let is_close = vec4<bool>(is_low.x, is_high.x, is_low.y, is_high.y);
    let is_hit = shaded.first.count != 0u;
    let sample = perceived(shaded.lit);
    var flags = 0u;
    var shown = 0u;
    for (var side = 0u; side < 4u; side++) {
        let has_face = refined[index].around[side + 1u].instance != 0u;
        let differs = is_hit != has_face
            || is_hit && contrast(sample, refined[index].around[side + 1u].perceived) > OTHER;
        shown += select(0u, 1u, !differs && refined[index].around[side + 1u].is_alone == 0u);
        flags |= select(0u, BESIDE_LEFT << side, is_close[side] && differs);
    }
    return select(flags, BESIDE_ALL, shown == 0u);
}

fn perceived(light: vec3<f32>) -> vec3<f32> {
    return sqrt(max(light, vec3<f32>(0.0)));
}

fn contrast(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let apart = abs(a - b);
    return max(max(apart.x, apart.y), apart.z);
}
