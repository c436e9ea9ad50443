// Rays through pixels, and where in a pixel samples lie; the twin of render/cpu/camera.rs.
//
// The twin works in f64. Here the host moves the eye's centre ray to the plane through the scene's centre; f32 is then only asked for how
// far the ray of a pixel is from it in that plane.

struct Camera {
    // The point of the centre ray in the plane, and its distance from the eye.
    grid: vec3<i32>,
    eye_distance: f32,
    fraction: vec3<f32>,
    orthographic: u32,
    forward: vec3<f32>,
    // The key of the upper left pixel that is rendered, and how many are rendered of each row.
    corner: u32,
    forward_low: vec3<f32>,
    window_width: u32,
    // From the picture's centre to its right and upper border, a unit before the eye (orthographic: in space).
    right: vec3<f32>,
    width: u32,
    up: vec3<f32>,
    height: u32,
}

struct PixelRay {
    ray: WorldRay,
    near: Distance,
    // Distance of the origin from the plane, along the ray.
    slide: f32,
    // Whether the ray meets the scene at all.
    meets: bool,
}

// `reach` is how far from the middle of the scene rays count.
fn pixel_ray(camera: Camera, x: f32, y: f32, reach: f32) -> PixelRay {
    let spacing = header.grid_step;
    let across = camera.right * (2.0 * x / f32(camera.width) - 1.0) + camera.up * (1.0 - 2.0 * y / f32(camera.height));
    var from_center = across;
    var direction = camera.forward;
    var direction_low = camera.forward_low;
    var to_eye = camera.eye_distance;
    if camera.orthographic == 0u {
        let norm = length(camera.forward + across);
        from_center = across * camera.eye_distance;
        direction = (camera.forward + across) * (1.0 / norm);
        direction_low = vec3<f32>(0.0);
        to_eye = camera.eye_distance * norm;
    }
    let center = grid_position(camera.grid) + camera.fraction;
    let slide = whole_steps(-dot(center + from_center, direction));
    let moved = from_center + direction * slide;
    let closest = center + moved;
    let whole = floor(moved / spacing + 0.5);
    var result: PixelRay;
    result.ray.grid = camera.grid + vec3<i32>(whole);
    result.ray.fraction = camera.fraction + (moved - whole * spacing);
    result.ray.direction = direction;
    result.ray.direction_low = direction_low;
    let near = max(-to_eye - slide, -2.0 * reach);
    let near_anchor = whole_steps(near);
    result.near = Distance(near_anchor, near - near_anchor);
    result.slide = slide;
    result.meets = length(closest) <= reach && near <= 2.0 * reach;
    return result;
}

fn pixel_key(x: u32, y: u32) -> u32 {
    return (x & 0xffffu) | (y << 16u);
}

fn sample_offset(pixel: u32, index: u32, count: u32) -> vec2<f32> {
    if count <= 1u {
        return vec2<f32>(0.5);
    }
    return sample_pair(pixel, index, 0u, 0u);
}
