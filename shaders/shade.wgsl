// The look of a hit; the twin of render/cpu/shade.rs. The constants of the look come from render/cpu/light.rs.

struct Lights {
    key: vec3<f32>,
    reserved_0: u32,
    fill: vec3<f32>,
    reserved_1: u32,
    up: vec3<f32>,
    ambient_occlusion: u32,
}

fn hit_material(hit: RawHit) -> u32 {
    let of_instance = instances[hit.instance].material;
    let own = select(of_instance, faces[hit.face].material, of_instance == NO_MATERIAL);
    return own + instances[hit.instance].material_shift;
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
    let gloss = gloss_of(material.roughness);
    let gleam = specular(n, view, lights.key, gloss) * soft + 0.25 * specular(n, view, lights.fill, gloss) * soft;
    let ambient = (AMBIENT_DOWN + (AMBIENT_UP - AMBIENT_DOWN) * sky) * AMBIENT_WEIGHT * open;
    let diffuse = ambient + key * KEY_COLOR + fill * FILL_COLOR;
    let skin = material.rgb * diffuse * (1.0 - material.metallic) + gleam * KEY_COLOR + rim * RIM_COLOR;
    return skin + material.rgb * mirrored(lights, n, view, gloss, open) * material.metallic;
}

fn mirrored(lights: Lights, n: vec3<f32>, view: vec3<f32>, gloss: f32, open: f32) -> vec3<f32> {
    let soft = 0.35 + 0.65 * open;
    let height = 0.5 + 0.5 * dot(n * (2.0 * dot(n, view)) - view, lights.up);
    let sky = height * height * (3.0 - 2.0 * height);
    let width = gloss / (1.0 + gloss / METAL_BOX);
    let ambient = (METAL_DOWN + (METAL_UP - METAL_DOWN) * sky) * open;
    let key = METAL_LIGHT * lobe(n, view, lights.key, width) * soft;
    let fill = METAL_LIGHT * lobe(n, view, lights.fill, width) * soft;
    return ambient + key * KEY_COLOR + fill * FILL_COLOR;
}

fn gloss_of(roughness: f32) -> f32 {
    let finer = DEFAULT_ROUGHNESS / max(roughness, LEAST_ROUGHNESS);
    return (GLOSS + 2.0) * (finer * finer) * (finer * finer) - 2.0;
}

fn specular(n: vec3<f32>, view: vec3<f32>, light: vec3<f32>, gloss: f32) -> f32 {
    if dot(n, light) <= 0.0 {
        return 0.0;
    }
    return SPECULAR_REFLECTANCE * (gloss + 8.0) / 8.0 * lobe(n, view, light, gloss) * dot(n, light);
}

fn lobe(n: vec3<f32>, view: vec3<f32>, light: vec3<f32>, gloss: f32) -> f32 {
    let middle = view + light;
    let norm = length(middle);
    if norm < 1e-6 {
        return 0.0;
    }
    return pow(max(dot(n, middle) / norm, 0.0), gloss);
}

fn openness(seen: Collected) -> f32 {
    if seen.count == 0u {
        return 1.0;
    }
    let blocked = 1.0 - clamp(beyond(seen.hit.distance, 0.0) / (header.scene_radius * OCCLUSION_RADIUS), 0.0, 1.0);
    return 1.0 - blocked * blocked;
}

fn sky_sample(pixel: u32, sample_index: u32, samples: u32) -> vec2<f32> {
    let x = pixel & 0xffffu;
    let y = pixel >> 16u;
    let tile = pixel_key(x >> 2u, y >> 2u);
    let place = ((x & 1u) << 3u) | ((y & 1u) << 2u) | (x & 2u) | ((y & 2u) >> 1u);
    let index = place * samples + sample_index;
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
