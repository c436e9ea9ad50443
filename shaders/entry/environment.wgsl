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
    return texel_density(column, row, place.y);
}

fn texel_density(column: u32, row: u32, v: f32) -> f32 {
    let share = row_share(row) * column_share(column, row);
    let size = f32(parameters.map_width * parameters.map_height);
    return share * size / (2.0 * PI * PI * max(real_sin_cos(v * PI).x, 1e-5));
}

fn row_share(row: u32) -> f32 {
    if row == 0u {
        return rows[0];
    }
    return rows[row] - rows[row - 1u];
}

fn column_share(column: u32, row: u32) -> f32 {
    let at = row * parameters.map_width + column;
    if column == 0u {
        return texels[at].w;
    }
    return texels[at].w - texels[at - 1u].w;
}

fn sample_light(point: vec2<f32>) -> LightSample {
    var low = 0u;
    var high = parameters.map_height - 1u;
    while low < high {
        let middle = (low + high) / 2u;
        if rows[middle] > point.y {
            high = middle;
        } else {
            low = middle + 1u;
        }
    }
    let row = low;
    let first = row * parameters.map_width;
    low = 0u;
    high = parameters.map_width - 1u;
    while low < high {
        let middle = (low + high) / 2u;
        if texels[first + middle].w > point.x {
            high = middle;
        } else {
            low = middle + 1u;
        }
    }
    let column = low;
    let row_start = rows[row] - row_share(row);
    let column_start = texels[first + column].w - column_share(column, row);
    let down = clamp((point.y - row_start) / max(row_share(row), 1e-20), 0.0, 1.0);
    let across = clamp((point.x - column_start) / max(column_share(column, row), 1e-20), 0.0, 1.0);
    let v = (f32(row) + down) / f32(parameters.map_height);
    let turn = real_sin_cos(((f32(column) + across) / f32(parameters.map_width) - 0.5) * 2.0 * PI);
    let fall = real_sin_cos(v * PI);
    let direction = parameters.map_x * (fall.x * turn.x) + parameters.map_y * fall.y
        - parameters.map_z * (fall.x * turn.y);
    return LightSample(direction, texel_density(column, row, v));
}
