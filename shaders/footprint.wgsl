// What a ray as wide as a face's slack covers of the face's parameters; the twin of render/cpu/footprint.rs, where the essay is.

const GRAZING: f32 = 1.0 / 1024.0;
const SHALLOW: f32 = 4.0;
const LONGEST: f32 = 4096.0;

struct Sides {
    first: vec3<f32>,
    second: vec3<f32>,
}

struct Footprint {
    slope_u: vec3<f32>,
    slope_v: vec3<f32>,
    cosine: f32,
    is_grazing: bool,
}

fn scaled(print: Footprint, scale: vec2<f32>) -> Footprint {
    return Footprint(print.slope_u * scale.x, print.slope_v * scale.y, print.cosine, print.is_grazing);
}

fn extent(print: Footprint) -> vec2<f32> {
    let lengths = vec2<f32>(length(print.slope_u), length(print.slope_v));
    return select(vec2<f32>(0.25), lengths, lengths < vec2<f32>(0.25));
}

fn place(print: Footprint, uv: vec2<f32>, o: Sides, side: u32) -> vec2<f32> {
    let moved = select(o.first, o.second, side >= 2u);
    let beside = vec2<f32>(dot(print.slope_u, moved), dot(print.slope_v, moved));
    return uv + select(beside, -beside, (side & 1u) == 1u);
}

fn sides(direction: vec3<f32>) -> Sides {
    let d = direction * (1.0 / length(direction));
    let side = select(1.0, -1.0, d.z < 0.0);
    let a = -1.0 / (side + d.z);
    let b = d.x * d.y * a;
    return Sides(
        vec3<f32>(1.0 + side * d.x * d.x * a, side * b, -side * d.x),
        vec3<f32>(b, side + d.y * d.y * a, -d.y),
    );
}

fn footprint(direction: vec3<f32>, s_u: vec3<f32>, s_v: vec3<f32>, curvature: f32, slack: f32) -> Footprint {
    let normal = cross(s_u, s_v);
    let determinant = dot(direction, normal);
    let steepness = length(direction) * length(normal);
    let facing = determinant / steepness;
    let cosine = abs(facing);
    let is_grazing = !(cosine > GRAZING && cosine * cosine > 2.0 * SHALLOW * curvature * slack);
    let by_u = cross(s_v, direction);
    let by_v = cross(direction, s_u);
    let share = slack / select(steepness * (1.0 / LONGEST), determinant, cosine > 1.0 / LONGEST);
    return Footprint(by_u * share, by_v * share, facing, is_grazing);
}

fn pole_footprint(axis: u32, o: Sides, across: vec3<f32>, slack: f32) -> Footprint {
    let off = (o.first - o.second) * (slack / length(across));
    let around = (o.first + o.second) * 0.25;
    let is_v = axis == 1u;
    return Footprint(select(off, around, is_v), select(around, off, is_v), 0.0, true);
}

fn same_place(apart: f32, first: f32, second: f32, slack: f32) -> bool {
    let steepness = max((abs(first) + abs(second)) * 0.5, 1.0 / LONGEST);
    return first * second >= 0.0 && apart * steepness <= slack * 2.0;
}
