// Rays on their way from world space to the space of one primitive; the twin of render/cpu/ray_space.rs, where the essay is.
// `prepare` runs on the host.

struct Distance {
    anchor: f32,
    offset: f32,
}

struct WorldRay {
    grid: vec3<i32>,
    fraction: vec3<f32>,
    direction: vec3<f32>,
    direction_low: vec3<f32>,
}

struct PartRay {
    grid: vec3<i32>,
    fraction: vec3<f32>,
    direction: vec3<f32>,
    direction_low: vec3<f32>,
    anchor: f32,
    near_origin: vec3<f32>,
    near_anchor: f32,
    // Whether the ray meets the part at all: `None` of the twin.
    meets: bool,
}

struct PrimitiveRay {
    origin: vec3<f32>,
    direction: vec3<f32>,
    anchor: f32,
}

fn minus(a: Distance, b: Distance) -> f32 {
    return (a.anchor - b.anchor) + (a.offset - b.offset);
}

fn beyond(distance: Distance, anchor: f32) -> f32 {
    return (distance.anchor - anchor) + distance.offset;
}

fn whole_steps(value: f32) -> f32 {
    return floor(value / header.grid_step + 0.5) * header.grid_step;
}

fn fused(v: vec3<f32>, t: f32, base: vec3<f32>) -> vec3<f32> {
    return fma(vec3<f32>(t), v, base);
}

fn enter_instance(ray: WorldRay, index: u32) -> PartRay {
    let instance_grid = instances[index].grid;
    let radius = instances[index].radius;
    let grid = grid_difference(ray.grid, instance_grid);
    let base = grid_position(grid);
    let rest = ray.fraction - instances[index].fraction;
    let anchor = whole_steps(-dot(base + rest, ray.direction));
    let near = fused(ray.direction, anchor, base) + (rest + ray.direction_low * anchor);
    let slack = radius * 0.001 + header.grid_step;
    var result: PartRay;
    if instances[index].is_translation != 0u {
        let reach = radius + slack;
        result.grid = grid;
        result.fraction = rest;
        result.direction = ray.direction;
        result.direction_low = ray.direction_low;
        result.anchor = 0.0;
        result.near_origin = near;
        result.near_anchor = anchor;
        result.meets = dot(near, near) <= reach * reach;
        return result;
    }
    let origin = apply_rows(index, near);
    let direction = apply_rows(index, ray.direction);
    let reach = radius + slack * (1.0 + length(direction));
    result.grid = vec3<i32>(0);
    result.fraction = origin;
    result.direction = direction;
    result.direction_low = vec3<f32>(0.0);
    result.anchor = anchor;
    result.near_origin = origin;
    result.near_anchor = anchor;
    result.meets = dot(origin, origin) <= reach * reach;
    return result;
}

fn approach_frame(ray: PartRay, face: u32) -> PrimitiveRay {
    return approach(ray, faces[face].grid, faces[face].offset, vec3<f32>(0.0));
}

fn approach_point(ray: PartRay, face: u32, center: vec3<f32>) -> PrimitiveRay {
    return approach(ray, faces[face].grid, vec3<f32>(0.0), center);
}

fn approach(ray: PartRay, grid: vec3<i32>, shift: vec3<f32>, center: vec3<f32>) -> PrimitiveRay {
    let base = grid_position(grid_difference(ray.grid, grid));
    let rest = ray.fraction - shift;
    let d = ray.direction;
    let slide = whole_steps(dot(center - (base + rest), d) / dot(d, d));
    let origin = fused(d, slide, base) + (rest + ray.direction_low * slide);
    return PrimitiveRay(origin, d, ray.anchor + slide);
}

fn apply_rows(instance: u32, v: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(
        dot(instances[instance].part_from_world_0, v),
        dot(instances[instance].part_from_world_1, v),
        dot(instances[instance].part_from_world_2, v),
    );
}

fn apply_axes(face: u32, v: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(dot(faces[face].x_axis, v), dot(faces[face].y_axis, v), dot(faces[face].z_axis, v));
}
