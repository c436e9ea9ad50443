// Rays against tori; the twin of render/cpu/torus.rs, without its spans.

const MAX_STEPS: u32 = 48u;

struct Quartic {
    origin: vec3<f32>,
    direction: vec3<f32>,
    major: f32,
    minor: f32,
    c2: f32,
    c1: f32,
    c0: f32,
}

// An end of a piece, and what the function is there.
struct End {
    t: f32,
    f: f32,
}

struct Bracket {
    t: f32,
    found: bool,
}

fn torus_roots(o: vec3<f32>, d: vec3<f32>, major: f32, minor: f32) -> Roots {
    var roots = no_roots();
    let size = major + minor;
    let norm = length(d);
    let direction = d * (1.0 / norm);
    var origin = o * (1.0 / size);
    let slide = -dot(origin, direction);
    origin = fused(direction, slide, origin);
    let square = 1.0 - dot(origin, origin) + 32.0 * EPSILON;
    if !(square >= 0.0) {
        return roots;
    }
    let half_chord = sqrt(square);
    var bounds = vec2<f32>(-half_chord, half_chord);
    let q = quartic(origin, direction, major / size, minor / size);
    clip_to_slab(&bounds, origin.z, direction.z, q.minor + 16.0 * EPSILON);
    if !(bounds.x < bounds.y) {
        return roots;
    }
    let middle = (bounds.x + bounds.y) * 0.5;
    var low = End(bounds.x, value(q, bounds.x));
    for (var half = 0u; half < 2u; half++) {
        let t_last = select(middle, bounds.y, half == 1u);
        let last = End(t_last, value(q, t_last));
        let changes = sign_changes(q, low, last);
        if changes == 0u {
            low = last;
            continue;
        }
        var cuts = no_roots();
        if changes != 1u {
            cuts = critical_points(q, low.t, last.t);
        }
        for (var i = 0u; i <= cuts.count; i++) {
            let is_cut = i < cuts.count;
            var high = last;
            if is_cut {
                let t = next_root(&cuts);
                high = End(t, value(q, t));
            }
            let root = root_between(low, high, q, false);
            if root.found {
                insert(&roots, (root.t + slide) * size / norm);
            }
            if is_cut && is_touching(q, high) {
                insert(&roots, (high.t + slide) * size / norm);
                insert(&roots, (high.t + slide) * size / norm);
            }
            low = high;
        }
    }
    return roots;
}

// What `sign_changes` answers where the twin says `None`.
const UNKNOWN_CHANGES: u32 = 5u;

fn sign_changes(q: Quartic, begin: End, end: End) -> u32 {
    let width = end.t - begin.t;
    let second = begin.f + slope(q, begin.t) * width * 0.25;
    let fourth = end.f - slope(q, end.t) * width * 0.25;
    let third = curvature(q, begin.t) * width * width * (1.0 / 12.0) + second * 2.0 - begin.f;
    let margin = 512.0 * EPSILON;
    let four = vec4<f32>(begin.f, second, third, fourth);
    if !(all(abs(four) > vec4<f32>(margin)) && abs(end.f) > margin) {
        return UNKNOWN_CHANGES;
    }
    let differ = (four > vec4<f32>(0.0)) != (vec4<f32>(second, third, fourth, end.f) > vec4<f32>(0.0));
    let counts = select(vec4<u32>(0u), vec4<u32>(1u), differ);
    return counts.x + counts.y + counts.z + counts.w;
}

fn is_touching(q: Quartic, end: End) -> bool {
    let least = end.f;
    let reach = 1.0 + q.major;
    return least > 0.0 && least <= 4.0 * EPSILON * q.minor * reach * reach && curvature(q, end.t) > 0.0;
}

fn quartic(o: vec3<f32>, d: vec3<f32>, major: f32, minor: f32) -> Quartic {
    let b = dot(o, d);
    let k = dot(o, o) + (major - minor) * (major + minor);
    let r2 = major * major;
    let a2 = d.x * d.x + d.y * d.y;
    let b2 = o.x * d.x + o.y * d.y;
    return Quartic(
        o, d, major, minor,
        12.0 * b,
        2.0 * (4.0 * b * b + 2.0 * k - 4.0 * r2 * a2),
        4.0 * b * k - 8.0 * r2 * b2,
    );
}

fn clip_to_slab(bounds: ptr<function, vec2<f32>>, z: f32, dz: f32, half_height: f32) {
    if abs(dz) < 1e-12 {
        if abs(z) > half_height {
            (*bounds).y = (*bounds).x;
        }
        return;
    }
    let a = (-half_height - z) / dz;
    let b = (half_height - z) / dz;
    (*bounds).x = max((*bounds).x, min(a, b));
    (*bounds).y = min((*bounds).y, max(a, b));
}

fn value(q: Quartic, t: f32) -> f32 {
    let p = q.origin + q.direction * t;
    let across = length(p.xy);
    let squares = (p.z - q.minor) * (p.z + q.minor);
    let near = across - q.major;
    let far = across + q.major;
    return (near * near + squares) * (far * far + squares);
}

fn slope(q: Quartic, t: f32) -> f32 {
    return ((4.0 * t + q.c2) * t + q.c1) * t + q.c0;
}

fn curvature(q: Quartic, t: f32) -> f32 {
    return (12.0 * t + 2.0 * q.c2) * t + q.c1;
}

fn critical_points(q: Quartic, bounds_from: f32, bounds_to: f32) -> Roots {
    var inflections = no_roots();
    let discriminant = q.c2 * q.c2 - 12.0 * q.c1;
    if discriminant > 0.0 {
        let root = sqrt(discriminant);
        let first = (-q.c2 - root) / 12.0;
        let second = (-q.c2 + root) / 12.0;
        if first > bounds_from && first < bounds_to {
            insert(&inflections, first);
        }
        if second > bounds_from && second < bounds_to {
            insert(&inflections, second);
        }
    }
    var critical = no_roots();
    var low = End(bounds_from, slope(q, bounds_from));
    for (var i = 0u; i <= inflections.count; i++) {
        var t = bounds_to;
        if i < inflections.count {
            t = next_root(&inflections);
        }
        let high = End(t, slope(q, t));
        let root = root_between(low, high, q, true);
        if root.found {
            insert(&critical, root.t);
        }
        low = high;
    }
    return critical;
}

// The twin takes the function and its derivative: here the quartic's slope and curvature, or its value and slope.
fn root_between(begin: End, end: End, q: Quartic, of_slope: bool) -> Bracket {
    var low = begin.t;
    var high = end.t;
    let f_low = begin.f;
    let f_high = end.f;
    let rising = f_low < 0.0 || (f_low == 0.0 && f_high > 0.0);
    if (rising && !(f_high > 0.0)) || (!rising && !(f_high < 0.0)) {
        return Bracket(0.0, false);
    }
    var t = low + (high - low) * (f_low / (f_low - f_high));
    for (var i = 0u; i < MAX_STEPS; i++) {
        var f_t: f32;
        var derivative: f32;
        if of_slope {
            f_t = slope(q, t);
            derivative = curvature(q, t);
        } else {
            f_t = value(q, t);
            derivative = slope(q, t);
        }
        if (f_t > 0.0) == rising {
            high = t;
        } else {
            low = t;
        }
        let newton = t - f_t / derivative;
        let next = select(low + (high - low) * 0.5, newton, newton > low && newton < high);
        let change = abs(next - t);
        t = next;
        if change <= EPSILON * 2.0 {
            break;
        }
    }
    return Bracket(t, true);
}
