// Points of the unit square for the samples of a pixel; the twin of render/cpu/sobol.rs.

fn sample_pair(pixel: u32, sample_index: u32, pair: u32, seed: u32) -> vec2<f32> {
    let key = hash(pixel, pair, seed);
    let index = reverseBits(mix_upwards(reverseBits(sample_index), key));
    let x = reverseBits(mix_upwards(index, hash(key, 1u, pair)));
    let y = reverseBits(mix_upwards(second_dimension(index), hash(key, 2u, pair)));
    return vec2<f32>(unit(x), unit(y));
}

fn mix_upwards(value: u32, seed: u32) -> u32 {
    var x = value;
    x ^= x * 0x3d20adeau;
    x += seed;
    x *= (seed >> 16u) | 1u;
    x ^= x * 0x05526c56u;
    x ^= x * 0x53a22864u;
    return x;
}

fn second_dimension(index: u32) -> u32 {
    var x = index;
    x ^= x >> 16u;
    x ^= (x >> 8u) & 0x00ff00ffu;
    x ^= (x >> 4u) & 0x0f0f0f0fu;
    x ^= (x >> 2u) & 0x33333333u;
    x ^= (x >> 1u) & 0x55555555u;
    return x;
}

fn hash(pixel: u32, sample_index: u32, dimension: u32) -> u32 {
    let seed = pixel * 747796405u + sample_index * 2891336453u + dimension * 1013904223u + 12345u;
    return permute(permute(seed));
}

fn permute(value: u32) -> u32 {
    let state = value * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

fn unit(bits: u32) -> f32 {
    return f32(bits >> 8u) / 16777216.0;
}
