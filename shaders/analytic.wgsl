// Rays against planes, cylinders, cones, spheres and tori; the twin of render/cpu/analytic.rs.

// Ascending; INFINITE beyond the count. A vector, where an array would lie in memory.
struct Roots {
    count: u32,
    t: vec4<f32>,
}

fn no_roots() -> Roots {
    return Roots(0u, vec4<f32>(INFINITE));
}

// The least that is left.
fn next_root(roots: ptr<function, Roots>) -> f32 {
    let t = (*roots).t.x;
    (*roots).t = vec4<f32>((*roots).t.yzw, INFINITE);
    return t;
}

// A ray in the frame of a face that is no net.
struct CarrierRay {
    kind: u32,
    origin: vec3<f32>,
    direction: vec3<f32>,
    radii: vec2<f32>,
    anchor: f32,
}

// S_u and S_v.
struct Tangents {
    u: vec3<f32>,
    v: vec3<f32>,
}

fn insert(roots: ptr<function, Roots>, t: f32) {
    if !is_finite(t) || (*roots).count == 4u {
        return;
    }
    let known = (*roots).t;
    (*roots).t = min(known, vec4<f32>(t, max(known.xyz, vec3<f32>(t))));
    (*roots).count += 1u;
}

fn carrier_roots(ray: CarrierRay) -> Roots {
    let radii = ray.radii;
    if HAS_PLANE && ray.kind == PLANE {
        return plane_roots(ray.origin, ray.direction);
    }
    // Both in one, so that the function stands once.
    if (HAS_CYLINDER && ray.kind == CYLINDER) || (HAS_SPHERE && ray.kind == SPHERE) {
        let is_kept = vec3<f32>(1.0, 1.0, select(1.0, 0.0, ray.kind == CYLINDER));
        return closest_then_chord(ray.origin * is_kept, ray.direction * is_kept, radii.x);
    }
    if HAS_CONE && ray.kind == CONE {
        return cone_roots(ray.origin, ray.direction, radii.x, radii.y);
    }
    if HAS_TORUS {
        return torus_roots(ray.origin, ray.direction, radii.x, radii.y);
    }
    return no_roots();
}

fn plane_roots(o: vec3<f32>, d: vec3<f32>) -> Roots {
    var roots = no_roots();
    insert(&roots, -o.z / d.z);
    return roots;
}

fn closest_then_chord(o: vec3<f32>, d: vec3<f32>, radius: f32) -> Roots {
    var roots = no_roots();
    let dd = dot(d, d);
    let slide = -dot(o, d) / dd;
    let closest = fused(d, slide, o);
    let distance = length(closest);
    let under_root = (radius - distance) * (radius + distance);
    if under_root >= -2.0 * EPSILON * radius * (radius + length(o)) {
        let half_chord = sqrt(max(under_root, 0.0) / dd);
        insert(&roots, slide - half_chord);
        insert(&roots, slide + half_chord);
    }
    return roots;
}

const FARTHEST_SLIDE: f32 = 64.0;

fn cone_roots(o: vec3<f32>, d: vec3<f32>, radius: f32, slope: f32) -> Roots {
    var roots = no_roots();
    var slide = -(o.x * d.x + o.y * d.y) / (d.x * d.x + d.y * d.y);
    slide = select(0.0, slide, abs(slide) * length(d) <= FARTHEST_SLIDE * (length(o) + abs(radius)));
    let p = fused(d, slide, o);
    let rho = radius + slope * p.z;
    let drho = slope * d.z;
    let a = (d.x * d.x + d.y * d.y) - drho * drho;
    let b = (p.x * d.x + p.y * d.y) - rho * drho;
    let c = (p.x * p.x + p.y * p.y) - rho * rho;
    let discriminant = b * b - a * c;
    let terms = ((d.x * d.x + d.y * d.y) + drho * drho) * ((p.x * p.x + p.y * p.y) + rho * rho);
    if discriminant >= -2.0 * EPSILON * terms {
        let q = -(b + signum(b) * sqrt(max(discriminant, 0.0)));
        insert(&roots, polish_cone(o, d, radius, slope, slide + q / a));
        insert(&roots, polish_cone(o, d, radius, slope, slide + c / q));
    }
    return roots;
}

fn cone_residual_and_change(o: vec3<f32>, d: vec3<f32>, radius: f32, slope: f32, t: f32) -> vec2<f32> {
    let p = o + d * t;
    let across = length(p.xy);
    let rho = radius + slope * p.z;
    return vec2<f32>(across - abs(rho), (p.x * d.x + p.y * d.y) / across - signum(rho) * slope * d.z);
}

fn polish_cone(o: vec3<f32>, d: vec3<f32>, radius: f32, slope: f32, start: f32) -> f32 {
    var t = start;
    var here = cone_residual_and_change(o, d, radius, slope, t);
    for (var i = 0; i < 3; i++) {
        let next = t - here.x / here.y;
        let there = cone_residual_and_change(o, d, radius, slope, next);
        if !is_finite(next) || !(abs(there.x) < abs(here.x)) {
            break;
        }
        t = next;
        here = there;
    }
    return t;
}

// Angles are taken of one point for all kinds, so that the arctangent stands twice, not six times.
fn carrier_parameters(kind: u32, p: vec3<f32>, radii: vec2<f32>) -> vec2<f32> {
    if kind == PLANE {
        return p.xy;
    }
    var around = p.xy;
    var up = vec2<f32>(length(p.xy), p.z);
    if HAS_CONE && kind == CONE {
        around = select(p.xy, -p.xy, radii.x + radii.y * p.z < 0.0);
    } else if HAS_TORUS && kind == TORUS {
        let tube = tube_place(p, up.x, radii);
        around = select(p.xy, -p.xy, tube.x < 0.0);
        up.x = tube.y;
    }
    let u = real_atan2(around.y, around.x);
    if (HAS_SPHERE && kind == SPHERE) || (HAS_TORUS && kind == TORUS) {
        return vec2<f32>(u, real_atan2(up.y, up.x));
    }
    return vec2<f32>(u, p.z);
}

fn carrier_normal(kind: u32, uv: vec2<f32>, radii: vec2<f32>) -> vec3<f32> {
    if kind == PLANE {
        return vec3<f32>(0.0, 0.0, 1.0);
    }
    let u = real_sin_cos(uv.x);
    if kind == CYLINDER {
        return vec3<f32>(u.y, u.x, 0.0);
    }
    if kind == CONE {
        let side = select(1.0, -1.0, radii.x + radii.y * uv.y < 0.0);
        let scale = side / sqrt(1.0 + radii.y * radii.y);
        return vec3<f32>(u.y * scale, u.x * scale, -radii.y * scale);
    }
    let v = real_sin_cos(uv.y);
    let outward = vec3<f32>(v.y * u.y, v.y * u.x, v.x);
    if kind == TORUS && radii.x + radii.y * v.y < 0.0 {
        return -outward;
    }
    return outward;
}

fn carrier_tangents(kind: u32, p: vec3<f32>, radii: vec2<f32>) -> Tangents {
    if kind == PLANE {
        return Tangents(vec3<f32>(1.0, 0.0, 0.0), vec3<f32>(0.0, 1.0, 0.0));
    }
    let around = vec3<f32>(-p.y, p.x, 0.0);
    if kind == CYLINDER {
        return Tangents(around, vec3<f32>(0.0, 0.0, 1.0));
    }
    let across = length(p.xy);
    if kind == CONE {
        let change = radii.y / select(across, -across, radii.x + radii.y * p.z < 0.0);
        return Tangents(around, vec3<f32>(p.xy * change, 1.0));
    }
    if kind == SPHERE {
        return Tangents(around, vec3<f32>(-p.z * p.xy / across, across));
    }
    let tube = tube_place(p, across, radii);
    return Tangents(around, vec3<f32>(-p.z * p.xy / tube.x, tube.y));
}

fn carrier_curvature(kind: u32, p: vec3<f32>, radii: vec2<f32>) -> f32 {
    if kind == PLANE {
        return 0.0;
    }
    let around = 1.0 / length(p.xy);
    if kind == SPHERE {
        return 1.0 / radii.x;
    }
    return select(around, max(around, 1.0 / radii.y), kind == TORUS);
}

fn tube_place(p: vec3<f32>, across: f32, radii: vec2<f32>) -> vec2<f32> {
    let squares = p.z * p.z - radii.y * radii.y;
    let near = (across - radii.x) * (across - radii.x) + squares;
    let far = (across + radii.x) * (across + radii.x) + squares;
    return select(vec2<f32>(across, across - radii.x), vec2<f32>(-across, -across - radii.x), abs(far) < abs(near));
}
