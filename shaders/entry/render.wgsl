// Pictures: adds one sample to each pixel of a tile, or, where `sample_index` is `samples`, tells what the pixels' centres show.
//
// One kernel for both: most of its text, which takes drivers long to compile, is the way to a hit.

struct RenderParameters {
    camera: Camera,
    lights: Lights,
    section: Section,
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
    // 0 at a cap too.
    face: u32,
    // 1 where any of the pixel's kernels ran out of loop turns.
    incomplete: u32,
    reserved: u32,
}

@group(1) @binding(0) var<uniform> parameters: RenderParameters;
@group(1) @binding(1) var<storage, read_write> colors: array<vec4<f32>>;
@group(1) @binding(2) var<storage, read_write> centers: array<Center>;

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

@compute @workgroup_size(WORKGROUP_SIZE)
fn render(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= parameters.pixel_count {
        return;
    }
    let index = parameters.first_pixel + id.x;
    let x = index % parameters.camera.width;
    let y = index / parameters.camera.width;
    let pixel = pixel_key(x, y);
    let center_only = parameters.sample_index == parameters.samples;
    let offset = sample_offset(pixel, parameters.sample_index, parameters.samples);
    let place = vec2<f32>(f32(x), f32(y)) + select(offset, vec2<f32>(0.5), center_only);
    let ray = pixel_ray(parameters.camera, place.x, place.y);
    var shaded: Shaded;
    if ray.meets {
        shaded = shade_layers(parameters.lights, parameters.section, ray, pixel, parameters.sample_index, center_only);
    }
    colors[id.x] += shaded.color;
    var center = centers[id.x];
    if center_only && shaded.first.count != 0u {
        let hit = shaded.first.hit;
        let t = ray.slide + (hit.distance.anchor + hit.distance.offset);
        center.normal = shaded.normal;
        center.depth = t * dot(ray.ray.direction, parameters.camera.forward);
        center.instance = hit.instance + 1u;
        center.face = select(hit.face + 1u, 0u, shaded.cap != NO_PLANE);
    }
    center.incomplete |= u32(was_cut());
    centers[id.x] = center;
}
