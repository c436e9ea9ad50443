// Bernstein basis functions and the nets that they weigh; the twin of render/cpu/bernstein.rs.
//
// By powers, `B_i = binomial(m, i) tⁱ (1−t)^(m−i)`, of the next lower degree m, and here in fours and without a table: some drivers end a kernel's loops
// after a number of turns, and all are faster with fewer. Terms beyond the degree are 0.

// The functions of both parameters: those of u, then those of v.
struct Basis {
    values: array<vec4<f32>, 2u * CHUNKS>,
    slopes: array<vec4<f32>, 2u * CHUNKS>,
}

fn basis_and_slopes(degrees: vec2<u32>, uv: vec2<f32>) -> Basis {
    var result: Basis;
    for (var k = 0u; k < 2u; k++) {
        let degree = degrees[k];
        let t = uv[k];
        let s = 1.0 - t;
        let first = k * CHUNKS;
        let chunks = degree / 4u + 1u;
        let m = f32(degree) - 1.0;
        // binomial(m, i) tⁱ, each from the one before; 0 from i = m + 1 on.
        var term = 1.0;
        for (var c = 0u; c < chunks; c++) {
            let i = f32(4u * c);
            let x = term;
            let y = x * t * ((m - i) / (i + 1.0));
            let z = y * t * ((m - i - 1.0) / (i + 2.0));
            let w = z * t * ((m - i - 2.0) / (i + 3.0));
            term = w * t * ((m - i - 3.0) / (i + 4.0));
            result.values[first + c] = vec4<f32>(x, y, z, w);
        }
        // Times (1−t)^(m−i), from i = m down.
        var power = 1.0;
        for (var c = chunks; c > 0u; c--) {
            let i = f32(4u * (c - 1u));
            let w = power;
            let z = select(w, w * s, i + 3.0 <= m);
            let y = select(z, z * s, i + 2.0 <= m);
            let x = select(y, y * s, i + 1.0 <= m);
            power = select(x, x * s, i <= m);
            result.values[first + c - 1u] *= vec4<f32>(x, y, z, w);
        }
        var before = 0.0;
        for (var c = 0u; c < chunks; c++) {
            let lower = result.values[first + c];
            let shifted = vec4<f32>(before, lower.xyz);
            result.slopes[first + c] = f32(degree) * (shifted - lower);
            result.values[first + c] = t * shifted + s * lower;
            before = lower.w;
        }
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

// The basis functions, and below the jet, of degrees up to three, which most nets have: without loops, with all points on their way at once.
struct CubicBasis {
    values: vec4<f32>,
    slopes: vec4<f32>,
}

fn cubic_basis(degree: u32, t: f32) -> CubicBasis {
    let s = 1.0 - t;
    let m = f32(degree) - 1.0;
    let y = t * m;
    let z = y * t * ((m - 1.0) * 0.5);
    let q = select(1.0, s, m >= 1.0);
    let r = select(q, q * s, m >= 2.0);
    let lower = select(vec4<f32>(q, y, 0.0, 0.0), vec4<f32>(r, y * s, z, 0.0), m >= 2.0);
    let shifted = vec4<f32>(0.0, lower.xyz);
    return CubicBasis(t * shifted + s * lower, f32(degree) * (shifted - lower));
}

fn cubic_jet(first: u32, degrees: vec2<u32>, about: vec3<f32>, uv: vec2<f32>) -> NetJet {
    let u = cubic_basis(degrees.x, uv.x);
    let v = cubic_basis(degrees.y, uv.y);
    let row = first + min(vec4<u32>(0u, 1u, 2u, 3u), vec4<u32>(degrees.x)) * (degrees.y + 1u);
    let a = four_points(row.x, 0u, degrees.y, about);
    let b = four_points(row.y, 0u, degrees.y, about);
    let c = four_points(row.z, 0u, degrees.y, about);
    let d = four_points(row.w, 0u, degrees.y, about);
    let values = mat4x4<f32>(a * v.values, b * v.values, c * v.values, d * v.values);
    let across = mat4x4<f32>(a * v.slopes, b * v.slopes, c * v.slopes, d * v.slopes);
    return NetJet(values * u.values, values * u.slopes, across * u.values);
}

fn net_jet(first_point: u32, degrees: vec2<u32>, about: vec3<f32>, uv: vec2<f32>) -> NetJet {
    if CHUNKS == 1u || all(degrees <= vec2<u32>(3u)) {
        return cubic_jet(first_point, degrees, about, uv);
    }
    var basis = basis_and_slopes(degrees, uv);
    var jet: NetJet;
    var values: vec4<f32>;
    var slopes: vec4<f32>;
    for (var i = 0u; i <= degrees.x; i++) {
        if i % 4u == 0u {
            values = basis.values[i / 4u];
            slopes = basis.slopes[i / 4u];
        }
        let first = first_point + i * (degrees.y + 1u);
        var row = vec4<f32>(0.0);
        var row_v = vec4<f32>(0.0);
        for (var c = 0u; c <= degrees.y / 4u; c++) {
            let four = four_points(first, c, degrees.y, about);
            row += four * basis.values[CHUNKS + c];
            row_v += four * basis.slopes[CHUNKS + c];
        }
        jet.value += row * values.x;
        jet.by_u += row * slopes.x;
        jet.by_v += row_v * values.x;
        values = values.yzwx;
        slopes = slopes.yzwx;
    }
    return jet;
}

// The points of a row that belong to chunk `c` of the basis functions; those beyond the row meet basis functions that are 0.
fn four_points(first: u32, c: u32, degree: u32, about: vec3<f32>) -> mat4x4<f32> {
    let column = min(vec4<u32>(4u * c) + vec4<u32>(0u, 1u, 2u, 3u), vec4<u32>(degree));
    return mat4x4<f32>(
        moved_point(first + column.x, about),
        moved_point(first + column.y, about),
        moved_point(first + column.z, about),
        moved_point(first + column.w, about),
    );
}

fn moved_point(index: u32, about: vec3<f32>) -> vec4<f32> {
    let p = net_points[index];
    return vec4<f32>(p.xyz - about * p.w, p.w);
}
