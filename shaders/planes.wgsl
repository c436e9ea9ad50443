// Two planes through a ray; the twin of render/cpu/planes.rs.

struct RayPlanes {
    // Of the planes: 1 along one of the two lesser axes of the direction, -slope along the greatest, 0 along the third.
    first: vec3<f32>,
    second: vec3<f32>,
    slope: vec2<f32>,
}

fn ray_planes(ray: PrimitiveRay) -> RayPlanes {
    let d = ray.direction;
    if abs(d.x) >= abs(d.y) && abs(d.x) >= abs(d.z) {
        let slope = d.yz / d.x;
        return RayPlanes(vec3<f32>(-slope.x, 1.0, 0.0), vec3<f32>(-slope.y, 0.0, 1.0), slope);
    }
    if abs(d.y) >= abs(d.z) {
        let slope = d.zx / d.y;
        return RayPlanes(vec3<f32>(0.0, -slope.x, 1.0), vec3<f32>(1.0, -slope.y, 0.0), slope);
    }
    let slope = d.xy / d.z;
    return RayPlanes(vec3<f32>(1.0, 0.0, -slope.x), vec3<f32>(0.0, 1.0, -slope.y), slope);
}

fn plane_values(planes: RayPlanes, p: vec4<f32>) -> vec2<f32> {
    return vec2<f32>(dot(planes.first, p.xyz), dot(planes.second, p.xyz));
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
