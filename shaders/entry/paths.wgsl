// Path-traced pictures: some rays of some pixels' samples a dispatch. The records are those of render/cpu/path.rs.

struct PathParameters {
    camera: Camera,
    section: Section,
    // What the map of light calls x, y and z, world space.
    map_x: vec3<f32>,
    map_width: u32,
    map_y: vec3<f32>,
    map_height: u32,
    map_z: vec3<f32>,
    seed: u32,
    ground_up: vec3<f32>,
    ground_height: f32,
    // 0 where there is no ground.
    ground_irradiance: f32,
    // How far from the middle of the scene rays count.
    reach: f32,
    max_depth: u32,
    shows_surroundings: u32,
    behind: f32,
    pixel_count: u32,
    // Of each pixel, in this dispatch.
    rays: u32,
    // The greatest luminance of a path's light that comes by way of several surfaces.
    brightest: f32,
}

struct PathState {
    grid: vec3<i32>,
    kind: u32,
    fraction: vec3<f32>,
    near_anchor: f32,
    direction: vec3<f32>,
    near_offset: f32,
    direction_low: vec3<f32>,
    passed: u32,
    throughput: vec3<f32>,
    density: f32,
    light: vec3<f32>,
    alpha: f32,
    asked: vec3<f32>,
    asked_alpha: f32,
    next: vec3<f32>,
    bounces: u32,
    pixel: u32,
    sample_index: u32,
    end: u32,
    reserved: u32,
}

struct PathSum {
    color: vec4<f32>,
    brightness: f32,
    square: f32,
    // 1 where the pixel's next ray ran out of loop turns.
    is_cut: u32,
    is_done: u32,
}

@group(1) @binding(0) var<uniform> parameters: PathParameters;
@group(1) @binding(1) var<storage, read> texels: array<vec4<f32>>;
// What light is sampled by, then what light on the ground is.
@group(1) @binding(2) var<storage, read> shares: array<f32>;
@group(1) @binding(3) var<storage, read_write> states: array<PathState>;
@group(1) @binding(4) var<storage, read_write> sums: array<PathSum>;

@compute @workgroup_size(WORKGROUP_SIZE)
fn paths(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= parameters.pixel_count {
        return;
    }
    var state = states[id.x];
    var sum = sums[id.x];
    sum.is_cut = 0u;
    for (var i = 0u; i < parameters.rays; i++) {
        if state.kind == DONE {
            break;
        }
        turn(&state, &sum);
        if was_cut() {
            sums[id.x].is_cut = 1u;
            return;
        }
        sum.is_done = select(0u, 1u, state.kind == DONE);
        states[id.x] = state;
        sums[id.x] = sum;
    }
}
