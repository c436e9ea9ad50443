// How surfaces scatter light; the twin of render/cpu/bsdf.rs.

const PI: f32 = 3.14159265358979323846;

struct Surface {
    diffuse: vec3<f32>,
    alpha: f32,
    specular: vec3<f32>,
    specular_share: f32,
    axis_x: vec3<f32>,
    axis_y: vec3<f32>,
    normal: vec3<f32>,
    view: vec3<f32>,
}

struct Scattered {
    value: vec3<f32>,
    density: f32,
}

fn surface(material: Material, share: f32, n: vec3<f32>, view: vec3<f32>) -> Surface {
    var result: Surface;
    let rgb = material.rgb * share;
    result.diffuse = rgb * (1.0 - material.metallic);
    result.specular = DIELECTRIC * share + (rgb - DIELECTRIC * share) * material.metallic;
    let axes = axes_across(n);
    result.axis_x = axes.x;
    result.axis_y = axes.y;
    result.normal = n;
    result.view = vec3<f32>(dot(view, axes.x), dot(view, axes.y), max(dot(view, n), 1e-4));
    let mirrored = luminance(fresnel(result.specular, result.view.z));
    let scattered = luminance(result.diffuse) * (1.0 - mirrored);
    let wanted = mirrored / max(mirrored + scattered, 1e-6);
    result.specular_share = select(1.0, clamp(wanted, 0.2, 0.8), scattered > 0.0);
    result.alpha = max(material.roughness * material.roughness, LEAST_ALPHA);
    return result;
}

struct Axes {
    x: vec3<f32>,
    y: vec3<f32>,
}

fn axes_across(n: vec3<f32>) -> Axes {
    let side = select(1.0, -1.0, n.z < 0.0);
    let a = -1.0 / (side + n.z);
    let b = n.x * n.y * a;
    return Axes(
        vec3<f32>(1.0 + side * n.x * n.x * a, side * b, -side * n.x),
        vec3<f32>(b, side + n.y * n.y * a, -n.y),
    );
}

fn fresnel(head_on: vec3<f32>, cosine: f32) -> vec3<f32> {
    let x = clamp(1.0 - cosine, 0.0, 1.0);
    return head_on + (vec3<f32>(1.0) - head_on) * (x * x * x * x * x);
}

fn luminance(light: vec3<f32>) -> f32 {
    return dot(light, vec3<f32>(0.2126, 0.7152, 0.0722));
}

fn scatter(place: Surface, towards: vec3<f32>) -> Scattered {
    let view = place.view;
    let light = vec3<f32>(dot(towards, place.axis_x), dot(towards, place.axis_y), dot(towards, place.normal));
    if light.z <= 0.0 {
        return Scattered(vec3<f32>(0.0), 0.0);
    }
    let sum = view + light;
    let middle = sum * (1.0 / max(length(sum), 1e-6));
    let along = max(dot(view, middle), 0.0);
    let square = place.alpha * place.alpha;
    let slope = middle.x * middle.x + middle.y * middle.y + square * middle.z * middle.z;
    let facets = square / (PI * slope * slope);
    let view_shade = sqrt(square + (1.0 - square) * view.z * view.z);
    let light_shade = sqrt(square + (1.0 - square) * light.z * light.z);
    let visible = 0.5 / max(light.z * view_shade + view.z * light_shade, 1e-7);
    let mirrored = fresnel(place.specular, along);
    let ground = place.diffuse * (vec3<f32>(1.0) - mirrored) * (1.0 / PI);
    let of_facets = facets * 0.5 / (view.z + view_shade);
    let of_ground = light.z / PI;
    return Scattered(
        (ground + mirrored * (facets * visible)) * light.z,
        of_ground + (of_facets - of_ground) * place.specular_share,
    );
}

fn sample_direction(place: Surface, point: vec2<f32>, choice: f32) -> vec3<f32> {
    let turn = real_sin_cos(point.x * 4.0 * HALF_PI);
    let view = place.view;
    var local: vec3<f32>;
    if choice < place.specular_share {
        let stretched = normalize(vec3<f32>(view.xy * place.alpha, view.z));
        let z = (1.0 - point.y) * (1.0 + stretched.z) - stretched.z;
        let across = sqrt(max(1.0 - z * z, 0.0));
        let cap = vec3<f32>(across * turn.y, across * turn.x, z) + stretched;
        let middle = normalize(vec3<f32>(cap.xy * place.alpha, max(cap.z, 1e-6)));
        local = middle * (2.0 * dot(view, middle)) - view;
    } else {
        let across = sqrt(point.y);
        local = vec3<f32>(across * turn.y, across * turn.x, sqrt(max(1.0 - point.y, 0.0)));
    }
    return place.axis_x * local.x + place.axis_y * local.y + place.normal * local.z;
}
