// Pictures: what the centres of a tile's pixels show, or one sample more of each of some pixels.
//
// One kernel for both: most of its text, which takes drivers long to compile, is the way to a hit. The records are those of render/cpu/pixels.rs.

struct RenderParameters {
    camera: Camera,
    lights: Lights,
    section: Section,
    // Of a tile; of no account where `centers_only` is 0.
    first_pixel: u32,
    pixel_count: u32,
    sample_index: u32,
    samples: u32,
    centers_only: u32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
}

struct Center {
    normal: vec3<f32>,
    // Along the view direction, from the plane through the scene's centre.
    depth: f32,
    dark: vec3<f32>,
    open: f32,
    lit: vec3<f32>,
    // INCOMPLETE where the kernel ran out of loop turns.
    flags: u32,
    // 1 + index; 0 where nothing is hit.
    instance: u32,
    face: u32,
    // Of the hit, with its parameters as they are.
    net: u32,
    reserved_0: u32,
    uv: vec2<f32>,
    reserved_1: vec2<u32>,
}

struct Neighbour {
    normal: vec3<f32>,
    open: f32,
    perceived: vec3<f32>,
    instance: u32,
    face: u32,
    is_alone: u32,
    reserved_0: u32,
    reserved_1: u32,
}

struct Refined {
    pixel: u32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
    around: array<Neighbour, 5>,
}

// What the host needs of a sample's first hit.
struct Shown {
    // 1 + index; 0 where nothing is hit.
    instance: u32,
    face: u32,
    // Of all samples; INCOMPLETE where any of the pixel's kernels ran out of loop turns.
    flags: u32,
    reserved: u32,
}

@group(1) @binding(0) var<uniform> parameters: RenderParameters;
@group(1) @binding(1) var<storage, read> refined: array<Refined>;
// Of samples: the sum of their colours, and what the last one showed first.
@group(1) @binding(2) var<storage, read_write> colors: array<vec4<f32>>;
@group(1) @binding(3) var<storage, read_write> shown: array<Shown>;
@group(1) @binding(4) var<storage, read_write> centers: array<Center>;

@compute @workgroup_size(WORKGROUP_SIZE)
fn render(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= parameters.pixel_count {
        return;
    }
    let center_only = parameters.centers_only != 0u;
    let index = select(refined[id.x].pixel, parameters.first_pixel + id.x, center_only);
    let x = (parameters.camera.corner & 0xffffu) + index % parameters.camera.window_width;
    let y = (parameters.camera.corner >> 16u) + index / parameters.camera.window_width;
    let pixel = pixel_key(x, y);
    let offset = select(
        sample_offset(pixel, parameters.sample_index, parameters.samples),
        vec2<f32>(0.5),
        center_only,
    );
    let ray = pixel_ray(parameters.camera, f32(x) + offset.x, f32(y) + offset.y, header.scene_radius);
    var shaded: Shaded;
    shaded.open = 1.0;
    if ray.meets {
        shaded = shade_layers(parameters.lights, parameters.section, ray, pixel, center_only, id.x);
    }
    let hit = shaded.first.hit;
    let is_hit = shaded.first.count != 0u;
    let instance = select(0u, hit.instance + 1u, is_hit);
    let face = select(0u, hit.face + 1u, is_hit);
    let incomplete = select(0u, INCOMPLETE_PIXEL, was_cut());
    if center_only {
        var center: Center;
        center.instance = instance;
        center.face = face;
        center.open = shaded.open;
        center.flags = incomplete;
        if is_hit {
            let t = ray.slide + (hit.distance.anchor + hit.distance.offset);
            center.normal = shaded.normal;
            center.depth = t * dot(ray.ray.direction, parameters.camera.forward);
            center.dark = shaded.dark;
            center.lit = shaded.lit;
            center.flags |= select(0u, SEE_THROUGH, shaded.is_see_through);
            center.flags |= select(0u, CAP, shaded.cap != NO_PLANE);
            center.net = hit.net;
            center.uv = hit.uv;
        }
        centers[id.x] = center;
    } else {
        colors[id.x] += shaded.color;
        let flags = shown[id.x].flags | beside(shaded, offset, id.x) | incomplete;
        shown[id.x] = Shown(instance, face, flags, 0u);
    }
}
