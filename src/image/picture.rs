//! The picture that a screen shows: 8 bits a channel, sRGB (IEC 61966-2-1), alpha not multiplied in.

use super::Film;
use std::sync::LazyLock;

/// Rows from the top.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Red, green, blue in sRGB, and coverage. Where coverage is 0, all are 0.
    pub pixels: Vec<[u8; 4]>,
}

impl Picture {
    /// Whether every pixel is wholly covered.
    pub fn is_opaque(&self) -> bool {
        self.pixels.iter().all(|p| p[3] == 255)
    }
}

impl From<&Film> for Picture {
    fn from(film: &Film) -> Self {
        Self {
            width: film.width,
            height: film.height,
            pixels: film.color.iter().map(|&c| develop(c)).collect(),
        }
    }
}

/// Linear premultiplied light to 8 bits.
fn develop([red, green, blue, alpha]: [f32; 4]) -> [u8; 4] {
    let coverage = (f64::from(alpha).clamp(0.0, 1.0) * 255.0).round() as u8;
    if coverage == 0 {
        return [0; 4];
    }
    let share = 1.0 / f64::from(alpha);
    let [r, g, b] = [red, green, blue].map(|c| encode_srgb(f64::from(c) * share));
    [r, g, b, coverage]
}

/// The 8-bit sRGB code whose light is nearest in code space: `round(255 · encode(linear))`, clamped; NaN is black.
///
/// The code is the number of half-way points at or below the light, which needs no power function and rounds exactly.
fn encode_srgb(linear: f64) -> u8 {
    static HALF_WAYS: LazyLock<[f64; 255]> =
        LazyLock::new(|| std::array::from_fn(|code| decode_srgb((code as f64 + 0.5) / 255.0)));
    HALF_WAYS.partition_point(|&half_way| half_way <= linear) as u8
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
            assert_eq!(encode_srgb(decode_srgb(f64::from(code) / 255.0)), code);
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
    fn half_way_points_round_up() {
        let half = decode_srgb(127.5 / 255.0);
        assert_eq!(encode_srgb(half), 128);
        assert_eq!(encode_srgb(half * (1.0 - 1e-15)), 127);
    }

    #[test]
    fn coverage_is_divided_out() {
        assert_eq!(develop([0.25, 0.25, 0.25, 0.25]), [255, 255, 255, 64]);
        assert_eq!(develop([0.1, 0.1, 0.1, 0.0]), [0; 4]);
        let half = decode_srgb(0.5) as f32 * 0.5;
        assert_eq!(develop([half, 0.0, 0.0, 0.5]), [128, 0, 0, 128]);
    }
}
