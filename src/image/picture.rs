//! The picture that a screen shows: sRGB (IEC 61966-2-1) in 8 or 16 bits a channel, alpha not multiplied in.

use super::Film;
use super::huge_pages::filled;
use rayon::prelude::*;
use std::ops::Not;
use std::sync::LazyLock;

/// Rows from the top. A code is a `u8` or a `u16`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture<Code = u8> {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Red, green, blue in sRGB, and coverage. Where coverage is 0, all are 0.
    pub pixels: Vec<[Code; 4]>,
}

/// 16 bits a channel.
pub type DeepPicture = Picture<u16>;

impl<Code: Copy + Default + PartialEq + Not<Output = Code>> Picture<Code> {
    /// Whether every pixel is wholly covered.
    pub fn is_opaque(&self) -> bool {
        let full = !Code::default();
        self.pixels.iter().all(|p| p[3] == full)
    }
}

/// Pixels that a thread develops one after the other.
const PIXELS_AT_A_TIME: usize = 4096;

impl From<&Film> for Picture {
    fn from(film: &Film) -> Self {
        let mut pixels = filled([0; 4], film.color.len());
        pixels.par_chunks_mut(PIXELS_AT_A_TIME).zip(film.color.par_chunks(PIXELS_AT_A_TIME)).for_each(
            |(pixels, colors)| {
                // Of one colour there are often many in a row.
                let mut last = ([0.0; 4], [0; 4]);
                for (pixel, &color) in pixels.iter_mut().zip(colors) {
                    if color != last.0 {
                        last = (color, develop(color, 255.0, encode_srgb).map(|code| code as u8));
                    }
                    *pixel = last.1;
                }
            },
        );
        Self { width: film.width, height: film.height, pixels }
    }
}

impl From<&Film> for DeepPicture {
    fn from(film: &Film) -> Self {
        let pixels = film.color.par_iter().map(|&c| develop(c, 65_535.0, encode_srgb_deep)).collect();
        Self { width: film.width, height: film.height, pixels }
    }
}

/// Linear premultiplied light to codes of 0 to `full`.
fn develop([red, green, blue, alpha]: [f32; 4], full: f64, encode: fn(f64) -> u16) -> [u16; 4] {
    let coverage = (f64::from(alpha).clamp(0.0, 1.0) * full).round() as u16;
    if coverage == 0 {
        return [0; 4];
    }
    let share = 1.0 / f64::from(alpha);
    let [r, g, b] = [red, green, blue].map(|c| encode(f64::from(c) * share));
    [r, g, b, coverage]
}

/// The 8-bit sRGB code, 0 to 255, whose light is nearest in code space: `round(255 · encode(linear))`, clamped; NaN is black.
///
/// The code is the number of half-way points at or below the light, which needs no power function and rounds exactly. Of those at or below the next smaller
/// multiple of 1 / [`SHADES`] the number is known.
pub fn encode_srgb(linear: f64) -> u16 {
    static HALF_WAYS: LazyLock<Vec<f64>> = LazyLock::new(|| half_ways(255));
    static CODES: LazyLock<Vec<u16>> = LazyLock::new(|| {
        let shades = (0..SHADES).map(|shade| shade as f64 / SHADES as f64);
        shades.map(|shade| HALF_WAYS.partition_point(|&half_way| half_way <= shade) as u16).collect()
    });
    // A product with a power of two is exact, and the conversion takes what is no number, or less than 0, for 0.
    let shade = ((linear * SHADES as f64) as usize).min(SHADES - 1);
    let code = CODES[shade];
    let above = HALF_WAYS[usize::from(code)..].iter().take_while(|&&half_way| half_way <= linear);
    code + above.count() as u16
}

/// So many that there is about one half-way point between them where they are densest.
const SHADES: usize = 4096;

/// The same in 16 bits.
fn encode_srgb_deep(linear: f64) -> u16 {
    static HALF_WAYS: LazyLock<Vec<f64>> = LazyLock::new(|| half_ways(65_535));
    HALF_WAYS.partition_point(|&half_way| half_way <= linear) as u16
}

/// The light half-way between each code and the next, for codes of 0 to `full`.
fn half_ways(full: u16) -> Vec<f64> {
    (0..full).map(|code| decode_srgb((f64::from(code) + 0.5) / f64::from(full))).collect()
}

/// Linear light of an sRGB value, both in 0..=1.
pub fn decode_srgb(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_survives_the_way_through_linear_light() {
        for code in 0..=255_u8 {
            assert_eq!(encode_srgb(decode_srgb(f64::from(code) / 255.0)), u16::from(code));
        }
    }

    #[test]
    fn every_deep_code_survives_too() {
        for code in 0..=65_535_u16 {
            assert_eq!(encode_srgb_deep(decode_srgb(f64::from(code) / 65_535.0)), code);
        }
    }

    #[test]
    fn light_beyond_the_range_is_clamped() {
        assert_eq!(encode_srgb(-1.0), 0);
        assert_eq!(encode_srgb(f64::NAN), 0);
        assert_eq!(encode_srgb(7.0), 255);
        assert_eq!(encode_srgb(f64::INFINITY), 255);
    }

    #[test]
    fn codes_are_numbers_of_half_way_points() {
        let half_ways = half_ways(255);
        let shades = (0..=3 * SHADES).map(|i| (i as f64 - 10.0) / (2 * SHADES) as f64);
        for light in half_ways.iter().copied().chain(shades).flat_map(|x| [x.next_down(), x, x.next_up()]) {
            let below = half_ways.iter().filter(|&&half_way| half_way <= light).count();
            assert_eq!(usize::from(encode_srgb(light)), below, "{light}");
        }
    }

    #[test]
    fn half_way_points_round_up() {
        let half = decode_srgb(127.5 / 255.0);
        assert_eq!(encode_srgb(half), 128);
        assert_eq!(encode_srgb(half * (1.0 - 1e-15)), 127);
    }

    #[test]
    fn coverage_is_divided_out() {
        assert_eq!(develop([0.25, 0.25, 0.25, 0.25], 255.0, encode_srgb), [255, 255, 255, 64]);
        assert_eq!(develop([0.1, 0.1, 0.1, 0.0], 255.0, encode_srgb), [0; 4]);
        let half = decode_srgb(0.5) as f32 * 0.5;
        assert_eq!(develop([half, 0.0, 0.0, 0.5], 255.0, encode_srgb), [128, 0, 0, 128]);
    }
}
