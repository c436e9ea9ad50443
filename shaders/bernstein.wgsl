// Bernstein basis functions and the nets that they weigh; the twin of render/cpu/bernstein.rs.

const MAX_ORDER: u32 = MAX_NET_DEGREE + 1u;

struct Basis {
    values: array<f32, MAX_ORDER>,
    slopes: array<f32, MAX_ORDER>,
}

fn basis_and_slopes(degree: u32, t: f32) -> Basis {
    var result: Basis;
    let s = 1.0 - t;
    result.values[0] = 1.0;
    for (var n = 1u; n < degree; n++) {
        var left = 0.0;
        for (var i = 0u; i < n; i++) {
            let value = result.values[i];
            result.values[i] = left + s * value;
            left = t * value;
        }
        result.values[n] = left;
    }
    let factor = f32(degree);
    var before = 0.0;
    for (var i = 0u; i <= degree; i++) {
        var value = 0.0;
        if i < degree {
            value = result.values[i];
        }
        result.slopes[i] = factor * (before - value);
        result.values[i] = t * before + s * value;
        before = value;
    }
    return result;
}

struct NetJet {
    value: vec4<f32>,
    by_u: vec4<f32>,
    by_v: vec4<f32>,
}

fn net_degrees(net: u32) -> vec2<u32> {
    return (vec2<u32>(nets[net].degrees) >> vec2<u32>(0u, 8u)) & vec2<u32>(0xffu);
}

fn net_jet(net: u32, about: vec3<f32>, uv: vec2<f32>) -> NetJet {
    let degrees = net_degrees(net);
    var u = basis_and_slopes(degrees.x, uv.x);
    var v = basis_and_slopes(degrees.y, uv.y);
    let shift = vec4<f32>(about, 0.0);
    var jet: NetJet;
    var index = nets[net].first_point;
    for (var i = 0u; i <= degrees.x; i++) {
        var row = vec4<f32>(0.0);
        var row_v = vec4<f32>(0.0);
        for (var j = 0u; j <= degrees.y; j++) {
            let p = net_points[index];
            index += 1u;
            let moved = p - shift * p.w;
            row += moved * v.values[j];
            row_v += moved * v.slopes[j];
        }
        jet.value += row * u.values[i];
        jet.by_u += row * u.slopes[i];
        jet.by_v += row_v * u.values[i];
    }
    return jet;
}
