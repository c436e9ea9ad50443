//! Numbers as colours: those of Figure 10 of Sloup and Havran 2021.

use super::decode_srgb;

/// sRGB, at even steps.
const COLORS: [[f32; 3]; 6] =
    [[0.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 1.0], [0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [1.0, 0.0, 0.0]];

/// Opaque linear light for a number of 0 to 1: black over blue, cyan, green and yellow to red. What is greater is red, what is no number black.
pub fn heat_color(share: f32) -> [f32; 4] {
    let last = COLORS.len() - 1;
    let at = if share > 0.0 { share.min(1.0) * last as f32 } else { 0.0 };
    let below = (at as usize).min(last - 1);
    let rest = at - below as f32;
    let [r, g, b] = [0, 1, 2].map(|k| {
        let code = COLORS[below][k] + (COLORS[below + 1][k] - COLORS[below][k]) * rest;
        decode_srgb(f64::from(code)) as f32
    });
    [r, g, b, 1.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_black_and_all_is_red() {
        assert_eq!(heat_color(0.0), [0.0, 0.0, 0.0, 1.0]);
        assert_eq!(heat_color(0.4), [0.0, 1.0, 1.0, 1.0]);
        assert_eq!(heat_color(1.0), [1.0, 0.0, 0.0, 1.0]);
        assert_eq!([heat_color(7.0), heat_color(f32::NAN)], [heat_color(1.0), heat_color(0.0)]);
    }
}
