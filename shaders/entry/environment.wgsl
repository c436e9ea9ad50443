// Light from a direction, and directions where light comes from; the twin of render/cpu/environment.rs. Only path tracing has these functions: they read
// the parameters and arrays of paths.wgsl.

struct LightSample {
    direction: vec3<f32>,
    density: f32,
}

fn map_place(direction: vec3<f32>) -> vec2<f32> {
    let x = dot(parameters.map_x, direction);
    let y = dot(parameters.map_y, direction);
    let z = dot(parameters.map_z, direction);
    return vec2<f32>(real_atan2(x, -z) / (2.0 * PI) + 0.5, real_atan2(sqrt(x * x + z * z), y) / PI);
}

fn light_from(direction: vec3<f32>) -> vec3<f32> {
    let width = parameters.map_width;
    let height = parameters.map_height;
    let place = map_place(direction) * vec2<f32>(f32(width), f32(height)) - vec2<f32>(0.5);
    let corner = floor(place);
    let share = place - corner;
    let left = u32(corner.x + f32(width)) % width;
    let right = u32(corner.x + 1.0 + f32(width)) % width;
    let top = min(u32(max(corner.y, 0.0)), height - 1u) * width;
    let low = min(u32(max(corner.y + 1.0, 0.0)), height - 1u) * width;
    let above = mix(texels[top + left].xyz, texels[top + right].xyz, share.x);
    let below = mix(texels[low + left].xyz, texels[low + right].xyz, share.x);
    return mix(above, below, share.y);
}

fn light_density(direction: vec3<f32>) -> f32 {
    let place = map_place(direction);
    let column = min(u32(place.x * f32(parameters.map_width)), parameters.map_width - 1u);
    let row = min(u32(place.y * f32(parameters.map_height)), parameters.map_height - 1u);
    let share = share_at(0u, row) * share_at(parameters.map_height + row * parameters.map_width, column);
    return texel_density(share, place.y);
}

fn texel_density(share: f32, v: f32) -> f32 {
    let size = f32(parameters.map_width * parameters.map_height);
    return share * size / (2.0 * PI * PI * max(real_sin_cos(v * PI).x, 1e-5));
}

fn share_at(first: u32, index: u32) -> f32 {
    if index == 0u {
        return shares[first];
    }
    return shares[first + index] - shares[first + index - 1u];
}

fn find_share(first: u32, count: u32, wanted: f32) -> u32 {
    var low = 0u;
    var high = count - 1u;
    while low < high {
        let middle = (low + high) / 2u;
        if shares[first + middle] > wanted {
            high = middle;
        } else {
            low = middle + 1u;
        }
    }
    return low;
}

fn sample_light(on_ground: bool, point: vec2<f32>) -> LightSample {
    let width = parameters.map_width;
    let height = parameters.map_height;
    let table = select(0u, height + width * height, on_ground);
    let row = find_share(table, height, point.y);
    let first = table + height + row * width;
    let column = find_share(first, width, point.x);
    let of_row = share_at(table, row);
    let of_column = share_at(first, column);
    let up = clamp((shares[table + row] - point.y) / max(of_row, 1e-20), 0.0, 1.0);
    let back = clamp((shares[first + column] - point.x) / max(of_column, 1e-20), 0.0, 1.0);
    let v = (f32(row + 1u) - up) / f32(height);
    let turn = real_sin_cos(((f32(column + 1u) - back) / f32(width) - 0.5) * 2.0 * PI);
    let fall = real_sin_cos(v * PI);
    let direction = parameters.map_x * (fall.x * turn.x) + parameters.map_y * fall.y
        - parameters.map_z * (fall.x * turn.y);
    return LightSample(direction, texel_density(of_row * of_column, v));
}
