//! Words in pictures: the names of views on sheets.
//!
//! Letters are strokes of one width, straight or elliptic, and so crisp at any size without a font. There are those that names of views have.

use super::Film;
use super::picture::decode_srgb;
use super::stroke::{box_coverage, distance_to};
use glam::DVec2;

/// A stroke of a letter. Units: small letters are 4 high, tall ones 6, and what hangs down reaches −2.
#[derive(Debug, Clone, Copy)]
enum Stroke {
    /// From a place to a place.
    Line([f64; 2], [f64; 2]),
    /// About a middle with two radii, from an angle to an angle, degrees from the right upwards.
    Arc([f64; 2], [f64; 2], [f64; 2]),
}

use Stroke::{Arc, Line};

/// The bowl of a, b, g, o and p.
const BOWL: Stroke = Arc([2.0, 2.0], [2.0, 2.0], [0.0, 360.0]);
/// The shoulder of h, n and r.
const SHOULDER: [f64; 2] = [1.8, 2.2];

/// How wide a letter is, and its strokes.
fn letter(name: char) -> Option<(f64, &'static [Stroke])> {
    Some(match name {
        'a' => (4.0, &[BOWL, Line([4.0, 4.0], [4.0, 0.0])]),
        'b' => (4.0, &[BOWL, Line([0.0, 6.0], [0.0, 0.0])]),
        'c' => (3.4, &[Arc([2.0, 2.0], [2.0, 2.0], [48.0, 312.0])]),
        'e' => (4.0, &[Arc([2.0, 2.0], [2.0, 2.0], [0.0, 318.0]), Line([0.0, 2.0], [4.0, 2.0])]),
        'f' => (
            2.7,
            &[
                Line([0.9, 0.0], [0.9, 4.6]),
                Arc([2.2, 4.6], [1.3, 1.4], [70.0, 180.0]),
                Line([0.0, 4.0], [2.3, 4.0]),
            ],
        ),
        'g' => (4.0, &[BOWL, Line([4.0, 4.0], [4.0, -0.4]), Arc([2.0, -0.4], [2.0, 1.6], [215.0, 360.0])]),
        'h' => (
            3.6,
            &[
                Line([0.0, 6.0], [0.0, 0.0]),
                Arc(SHOULDER, [1.8, 1.8], [0.0, 180.0]),
                Line([3.6, 2.2], [3.6, 0.0]),
            ],
        ),
        'i' => (0.0, &[Line([0.0, 4.0], [0.0, 0.0]), Line([0.0, 5.7], [0.0, 5.7])]),
        'k' => {
            (3.2, &[Line([0.0, 6.0], [0.0, 0.0]), Line([0.0, 1.5], [3.0, 4.0]), Line([1.2, 2.5], [3.2, 0.0])])
        }
        'l' => (0.0, &[Line([0.0, 6.0], [0.0, 0.0])]),
        'm' => (
            5.6,
            &[
                Line([0.0, 4.0], [0.0, 0.0]),
                Arc([1.4, 2.6], [1.4, 1.4], [0.0, 180.0]),
                Line([2.8, 2.6], [2.8, 0.0]),
                Arc([4.2, 2.6], [1.4, 1.4], [0.0, 180.0]),
                Line([5.6, 2.6], [5.6, 0.0]),
            ],
        ),
        'n' => (
            3.6,
            &[
                Line([0.0, 4.0], [0.0, 0.0]),
                Arc(SHOULDER, [1.8, 1.8], [0.0, 180.0]),
                Line([3.6, 2.2], [3.6, 0.0]),
            ],
        ),
        'o' => (4.0, &[BOWL]),
        'p' => (4.0, &[BOWL, Line([0.0, 4.0], [0.0, -2.0])]),
        'r' => (2.7, &[Line([0.0, 4.0], [0.0, 0.0]), Arc(SHOULDER, [1.8, 1.8], [60.0, 180.0])]),
        's' => {
            (3.0, &[Arc([1.5, 3.0], [1.4, 1.0], [25.0, 270.0]), Arc([1.5, 1.0], [1.5, 1.0], [-155.0, 90.0])])
        }
        't' => (
            2.6,
            &[
                Line([0.9, 5.4], [0.9, 1.3]),
                Arc([2.2, 1.3], [1.3, 1.3], [180.0, 285.0]),
                Line([0.0, 4.0], [2.3, 4.0]),
            ],
        ),
        '-' => (2.4, &[Line([0.0, 2.0], [2.4, 2.0])]),
        _ => return None,
    })
}

/// Between letters.
const GAP: f64 = 1.7;
/// Width of strokes.
const WEIGHT: f64 = 0.8;
/// Height of tall letters.
const TALL: f64 = 6.0;
/// Height of tall letters as a share of a picture's, and at least, pixels.
const SIZE: (f64, f64) = (1.0 / 32.0, 9.0);
/// Heights of tall letters from the picture's border to what is below a word: a margin, the word, what of it hangs down, and as much to keep clear.
const STRIP: f64 = 1.0 + 1.0 + 2.0 * (2.0 / TALL);
/// Straight pieces of an arc.
const PIECES: usize = 16;

/// The straight pieces of a word, in units from its lower left, and its length.
fn pieces(word: &str) -> (Vec<[DVec2; 2]>, f64) {
    let (mut pieces, mut left) = (Vec::new(), 0.0);
    for (width, strokes) in word.chars().filter_map(letter) {
        let at = |[x, y]: [f64; 2]| DVec2::new(left + x, y);
        for &stroke in strokes {
            match stroke {
                Line(from, to) => pieces.push([at(from), at(to)]),
                Arc(middle, radii, [first, last]) => {
                    let place = |i: usize| {
                        let turn = first + (last - first) * i as f64 / PIECES as f64;
                        at(middle) + DVec2::from_angle(turn.to_radians()) * DVec2::from_array(radii)
                    };
                    pieces.extend((0..PIECES).map(|i| [place(i), place(i + 1)]));
                }
            }
        }
        left += width + GAP;
    }
    (pieces, left - GAP)
}

/// The height of tall letters in a picture so many pixels high, pixels.
fn tall(height: f64) -> f64 {
    (height * SIZE.0).max(SIZE.1)
}

/// The share of its height that a word takes at the upper border of a picture so many pixels high.
pub fn label_share(height: u32) -> f64 {
    STRIP * tall(f64::from(height)) / f64::from(height)
}

impl Film {
    /// Writes a word over the upper left of the picture, in one colour (sRGB); of characters that are no small letter of a view's name or a hyphen nothing is seen.
    pub fn write_label(&mut self, word: &str, srgb: [f32; 3]) {
        let (pieces, length) = pieces(word);
        let whole = self.whole.map(|n| n as f64);
        let tall = tall(whole[1]);
        let unit = (tall / TALL).min((whole[0] - 2.0 * tall) / length);
        if !(unit > 0.0) {
            return;
        }
        let corner = DVec2::new(self.corner[0] as f64, self.corner[1] as f64);
        let start = DVec2::splat(tall) + DVec2::new(0.0, TALL * unit) - corner;
        let half = 0.5 * WEIGHT * unit;
        let light = srgb.map(|code| decode_srgb(f64::from(code)) as f32);
        let mut covered = vec![0.0_f32; self.color.len()];
        for [a, b] in pieces.into_iter().map(|ends| ends.map(|p| start + p * DVec2::new(unit, -unit))) {
            let (low, high) = (a.min(b) - half - 1.0, a.max(b) + half + 1.0);
            // Casts of floats hold to the range of the integers.
            for y in low.y.max(0.0) as usize..(high.y.max(0.0).ceil() as usize).min(self.height) {
                for x in low.x.max(0.0) as usize..(high.x.max(0.0).ceil() as usize).min(self.width) {
                    let distance = distance_to(DVec2::new(x as f64 + 0.5, y as f64 + 0.5), [a, b]);
                    let own = box_coverage(distance, 2.0 * half);
                    let covered = &mut covered[y * self.width + x];
                    *covered = covered.max(own as f32);
                }
            }
        }
        self.lay_over(light, &covered);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Layers, Window};

    fn film(window: Window) -> Film {
        Film::of_window(window, [300, 200], Layers::NONE)
    }

    fn ink(film: &Film) -> f64 {
        film.color.iter().map(|color| f64::from(color[3])).sum()
    }

    #[test]
    fn letters_are_within_their_width_and_height() {
        for name in "abcefghiklmnoprst-".chars() {
            let (width, _) = letter(name).expect("a letter");
            let (pieces, length) = pieces(&name.to_string());
            assert!((length - width).abs() < 1e-12 && !pieces.is_empty(), "{name}");
            for place in pieces.into_iter().flatten() {
                assert!((-0.01..=width + 0.01).contains(&place.x), "{name} {place}");
                assert!((-2.01..=6.01).contains(&place.y), "{name} {place}");
            }
        }
        assert!(letter('#').is_none());
    }

    #[test]
    fn a_word_is_at_the_upper_left_and_in_its_colour() {
        let mut whole = film(Window::whole(300, 200));
        whole.write_label("iso", [1.0, 0.0, 0.0]);
        let written = (0..60_000).filter(|&pixel| whole.color[pixel][3] > 0.0);
        for pixel in written.clone() {
            assert!(pixel % 300 < 60 && pixel / 300 < 24, "{pixel}");
            assert_eq!(whole.color[pixel][..3], [whole.color[pixel][3], 0.0, 0.0]);
        }
        assert!(written.count() > 40);
        let mut long = film(Window::whole(300, 200));
        long.write_label("iso-front-right-bottom-iso-front-right-bottom-iso-front-right-bottom", [0.0; 3]);
        assert!(
            ink(&long) > 40.0 && (0..60_000).all(|i| long.color[i][3] == 0.0 || i % 300 < 296),
            "it fits"
        );
    }

    #[test]
    fn parts_of_a_picture_have_the_same_word() {
        let mut whole = film(Window::whole(300, 200));
        whole.write_label("top", [0.0; 3]);
        let mut pasted = film(Window::whole(300, 200));
        for [left, width] in [[0, 13], [13, 287]] {
            let mut part = film(Window { left, top: 0, width, height: 200 });
            part.write_label("top", [0.0; 3]);
            pasted.paste(&part, left, 0);
        }
        assert!(ink(&whole) > 20.0 && pasted == whole);
    }
}
