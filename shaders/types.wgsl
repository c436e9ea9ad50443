// The records of src/scene/layout.rs, field by field; tests/layout.rs compares names, offsets and sizes.
// What WGSL cannot spell: three bytes and a byte are one u32 named `e_imask` (e in the low 24 bits), eight bytes are a vec2<u32>.

struct BvhNode {
    p: vec3<f32>,
    e_imask: u32,
    child_base: u32,
    primitive_base: u32,
    child_meta: vec2<u32>,
    child_min_x: vec2<u32>,
    child_max_x: vec2<u32>,
    child_min_y: vec2<u32>,
    child_max_y: vec2<u32>,
    child_min_z: vec2<u32>,
    child_max_z: vec2<u32>,
}

struct Instance {
    part_from_world_0: vec3<f32>,
    part: u32,
    part_from_world_1: vec3<f32>,
    material: u32,
    part_from_world_2: vec3<f32>,
    is_translation: u32,
    grid: vec3<i32>,
    flags: u32,
    fraction: vec3<f32>,
    radius: f32,
    material_shift: u32,
    reserved_1: u32,
    reserved_2: vec2<u32>,
}

struct Part {
    first_node: u32,
    node_count: u32,
    first_primitive: u32,
    primitive_count: u32,
}

struct Face {
    grid: vec3<i32>,
    kind: u32,
    x_axis: vec3<f32>,
    radius_0: f32,
    y_axis: vec3<f32>,
    radius_1: f32,
    z_axis: vec3<f32>,
    flags: u32,
    offset: vec3<f32>,
    material: u32,
    uv_low: vec2<f32>,
    uv_scale: vec2<f32>,
    period: vec2<f32>,
    trim_root: u32,
    part: u32,
    slack: f32,
    body: u32,
    reserved: vec2<u32>,
}

struct Net {
    first_point: u32,
    degrees: u32,
    face: u32,
    reserved: u32,
    uv_low: vec2<f32>,
    uv_size: vec2<f32>,
}

struct NetLeaf {
    center: vec3<f32>,
    extent_n: f32,
    tangent_u: vec3<f32>,
    extent_u: f32,
    tangent_v: vec3<f32>,
    extent_v: f32,
    certificate: u32,
    domain: u32,
    net: u32,
    trim: u32,
}

struct TrimSegment {
    low: vec2<f32>,
    high: vec2<f32>,
    band: u32,
    curve: u32,
}

struct Material {
    rgb: vec3<f32>,
    opacity: f32,
    roughness: f32,
    metallic: f32,
    reserved: vec2<u32>,
}

// What kernels need of the host's Header.
struct SceneHeader {
    grid_step: f32,
    scene_radius: f32,
    node_count: u32,
    reserved: u32,
}
