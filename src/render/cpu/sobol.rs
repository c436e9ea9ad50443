//! Points of the unit square for the samples of a pixel: the first two dimensions of Sobol's sequence, shuffled and scrambled anew for each pixel and
//! each pair of dimensions (Burley 2020), so that any number of samples is well spread and no two pairs know of each other.
//!
//! In whole numbers up to the last step, so that CPU and GPU agree to the bit.

/// Sample `sample_index` of a pixel in a pair of dimensions, both in 0..1.
pub fn sample_pair(pixel: u32, sample_index: u32, pair: u32, seed: u32) -> [f32; 2] {
    let key = hash(pixel, pair, seed);
    let index = mix_upwards(sample_index.reverse_bits(), key).reverse_bits();
    let x = mix_upwards(index, hash(key, 1, pair)).reverse_bits();
    let y = mix_upwards(second_dimension(index), hash(key, 2, pair)).reverse_bits();
    [unit(x), unit(y)]
}

/// A permutation in which a bit depends on those below it alone, as Owen's scrambling asks of reversed bits (Laine and Karras 2011, constants of
/// Vegdahl).
fn mix_upwards(value: u32, seed: u32) -> u32 {
    let mut x = value;
    x ^= x.wrapping_mul(0x3d20_adea);
    x = x.wrapping_add(seed);
    x = x.wrapping_mul(seed >> 16 | 1);
    x ^= x.wrapping_mul(0x0552_6c56);
    x ^= x.wrapping_mul(0x53a2_2864);
    x
}

/// The second dimension of an index, lowest bit first: Pascal's triangle modulo 2, in which binomial(k, r) is odd where r's bits are among k's (Lucas), so
/// that one step for each bit of the bits' numbers does.
fn second_dimension(index: u32) -> u32 {
    let mut x = index;
    x ^= x >> 16;
    x ^= x >> 8 & 0x00ff_00ff;
    x ^= x >> 4 & 0x0f0f_0f0f;
    x ^= x >> 2 & 0x3333_3333;
    x ^= x >> 1 & 0x5555_5555;
    x
}

/// A hash of three numbers (PCG, Jarzynski and Olano 2020): the same on every machine and in every order of work.
pub fn hash(pixel: u32, sample: u32, dimension: u32) -> u32 {
    let seed = pixel
        .wrapping_mul(747_796_405)
        .wrapping_add(sample.wrapping_mul(2_891_336_453))
        .wrapping_add(dimension.wrapping_mul(1_013_904_223))
        .wrapping_add(12_345);
    permute(permute(seed))
}

fn permute(value: u32) -> u32 {
    let state = value.wrapping_mul(747_796_405).wrapping_add(2_891_336_453);
    let word = ((state >> ((state >> 28) + 4)) ^ state).wrapping_mul(277_803_737);
    (word >> 22) ^ word
}

/// The top 24 bits as a number in 0..1.
pub fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 / 16_777_216.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    /// Of 2^k samples each box of area 2^-k, however long, holds one.
    #[test]
    fn every_box_holds_one_sample() {
        for (pixel, pair, seed) in [(0, 0, 0), (77, 3, 1), (0x0012_0345, 9, 42)] {
            for k in 0..9 {
                let points: Vec<[f32; 2]> =
                    (0..1 << k).map(|sample| sample_pair(pixel, sample, pair, seed)).collect();
                for across in 0..=k {
                    let cell = |[x, y]: [f32; 2]| {
                        ((x * (1 << across) as f32) as u32, (y * (1 << (k - across)) as f32) as u32)
                    };
                    let cells: HashSet<_> = points.iter().map(|&point| cell(point)).collect();
                    assert_eq!(cells.len(), 1 << k, "{pixel} {pair} {seed}: 2^{k}, {across}");
                }
            }
        }
    }

    /// The mean of 64 samples of a soft edge, over many pixels, errs less than a third of what it does by random points.
    #[test]
    fn means_of_few_samples_are_close() {
        let edge = |[x, y]: [f32; 2]| f64::from((4.0 * (x + 0.5 * y) - 2.0).clamp(0.0, 1.0));
        let error = |point: &dyn Fn(u32, u32) -> [f32; 2]| {
            let mean = |pixel| (0..64).map(|sample| edge(point(pixel, sample))).sum::<f64>() / 64.0;
            let means: Vec<f64> = (0..400).map(mean).collect();
            let middle = means.iter().sum::<f64>() / 400.0;
            (means.iter().map(|mean| (mean - middle).powi(2)).sum::<f64>() / 400.0).sqrt()
        };
        let spread = error(&|pixel, sample| sample_pair(pixel, sample, 1, 0));
        let random = error(&|pixel, sample| [hash(pixel, sample, 0), hash(pixel, sample, 1)].map(unit));
        eprintln!("{spread} and {random}");
        assert!(spread < random / 3.0, "{spread} {random}");
    }

    #[test]
    fn pairs_pixels_and_seeds_differ() {
        let all = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)];
        let starts: HashSet<_> =
            all.map(|(pixel, pair, seed)| sample_pair(pixel, 0, pair, seed).map(f32::to_bits)).into();
        assert_eq!(starts.len(), all.len());
    }
}
