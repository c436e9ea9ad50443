// Two planes through a ray; the twin of render/cpu/planes.rs.

struct RayPlanes {
    major: u32,
    minor: vec2<u32>,
    slope: vec2<f32>,
}

fn ray_planes(ray: PrimitiveRay) -> RayPlanes {
    let d = ray.direction;
    var major = 2u;
    if abs(d.x) >= abs(d.y) && abs(d.x) >= abs(d.z) {
        major = 0u;
    } else if abs(d.y) >= abs(d.z) {
        major = 1u;
    }
    let minor = vec2<u32>((major + 1u) % 3u, (major + 2u) % 3u);
    let slope = vec2<f32>(d[minor.x] / d[major], d[minor.y] / d[major]);
    return RayPlanes(major, minor, slope);
}

fn plane_values(planes: RayPlanes, p: vec4<f32>) -> vec2<f32> {
    return vec2<f32>(p[planes.minor.x], p[planes.minor.y]) - planes.slope * p[planes.major];
}

struct PlaneJet {
    f: vec2<f32>,
    f_s: vec2<f32>,
    f_t: vec2<f32>,
}

fn plane_jet(planes: RayPlanes, jet: NetJet, size: vec2<f32>) -> PlaneJet {
    let scale = 1.0 / jet.value.w;
    let f = plane_values(planes, jet.value) * scale;
    return PlaneJet(
        f,
        (plane_values(planes, jet.by_u) - f * jet.by_u.w) * (scale * size.x),
        (plane_values(planes, jet.by_v) - f * jet.by_v.w) * (scale * size.y),
    );
}
