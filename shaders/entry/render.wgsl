// Pictures: `render_sample` adds one sample to each pixel of a tile, `render_center` tells what its centre shows.

struct RenderParameters {
    camera: Camera,
    lights: Lights,
    first_pixel: u32,
    pixel_count: u32,
    sample_index: u32,
    samples: u32,
}

struct Center {
    normal: vec3<f32>,
    // Along the view direction, from the plane through the scene's centre.
    depth: f32,
    // 1 + index; 0 where nothing is hit.
    instance: u32,
    face: u32,
    // 1 where any of the pixel's kernels ran out of loop turns.
    incomplete: u32,
    reserved: u32,
}

@group(1) @binding(0) var<uniform> parameters: RenderParameters;
@group(1) @binding(1) var<storage, read_write> colors: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read_write> centers: array<Center>;

fn accept(collected: ptr<function, Collected>, hit: RawHit) {
    if (*collected).count == 0u || comes_before(hit, (*collected).hit) {
        (*collected).hit = hit;
        (*collected).far = hit.distance;
    }
    (*collected).count += 1u;
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn render_sample(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= parameters.pixel_count {
        return;
    }
    let index = parameters.first_pixel + id.x;
    let x = index % parameters.camera.width;
    let y = index / parameters.camera.width;
    let pixel = pixel_key(x, y);
    let corner = vec2<f32>(f32(x), f32(y));
    let place = corner + sample_offset(pixel, parameters.sample_index, parameters.samples);
    let ray = pixel_ray(parameters.camera, place.x, place.y);
    var color = vec4<f32>(0.0);
    if ray.meets {
        color = shade_layers(parameters.lights, ray, pixel, parameters.sample_index);
    }
    colors[id.x] += color;
    if turns > MOST_TURNS {
        centers[id.x].incomplete = 1u;
    }
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn render_center(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= parameters.pixel_count {
        return;
    }
    let pixel = parameters.first_pixel + id.x;
    let corner = vec2<f32>(f32(pixel % parameters.camera.width), f32(pixel / parameters.camera.width));
    let ray = pixel_ray(parameters.camera, corner.x + 0.5, corner.y + 0.5);
    var center = Center();
    if ray.meets {
        let seen = first_hit(ray.ray, ray.near);
        if seen.count != 0u {
            let t = ray.slide + (seen.hit.distance.anchor + seen.hit.distance.offset);
            let outward = hit_normal(seen.hit);
            center.normal = select(outward, -outward, dot(outward, ray.ray.direction) > 0.0);
            center.depth = t * dot(ray.ray.direction, parameters.camera.forward);
            center.instance = seen.hit.instance + 1u;
            center.face = seen.hit.face + 1u;
        }
    }
    center.incomplete = centers[id.x].incomplete | u32(turns > MOST_TURNS);
    centers[id.x] = center;
}
