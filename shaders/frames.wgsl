// Positions on the grid; the twin of render/cpu/frames.rs. Instances, faces and nets are read from their arrays directly.

fn grid_position(grid: vec3<i32>) -> vec3<f32> {
    return vec3<f32>(grid) * header.grid_step;
}

fn grid_difference(a: vec3<i32>, b: vec3<i32>) -> vec3<i32> {
    return a - b;
}
