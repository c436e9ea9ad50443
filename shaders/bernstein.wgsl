// Bernstein basis functions; the twin of render/cpu/bernstein.rs.

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
