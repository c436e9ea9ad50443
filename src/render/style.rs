//! Styles of pictures: what faces look like that are not to look real.

use crate::image::{Film, decode_srgb};
use crate::scene::Material;

/// What a whole picture looks like.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Style {
    /// Faces in their own colours, in soft light.
    Shaded,
    /// White faces with very little shade: for lines in black.
    Technical,
    /// Faces in the colour of blue paper: for lines in white.
    Blueprint,
}

/// How much of the light on white faces a technical picture shows.
const TECHNICAL_SHADE: f32 = 0.2;
/// Blue paper, sRGB.
const BLUE: [f32; 3] = [0.07, 0.22, 0.44];
/// Light of faces on blue paper: that of the paper times this in the dark, and this more in full light.
const BLUE_SHADE: [f32; 2] = [0.8, 0.6];

impl Style {
    /// The background where none is asked for, sRGB.
    pub fn paper(self) -> [f32; 3] {
        match self {
            Self::Shaded | Self::Technical => [1.0; 3],
            Self::Blueprint => BLUE,
        }
    }

    /// The colour of lines where none is asked for, sRGB.
    pub fn line_color(self) -> [f32; 3] {
        match self {
            Self::Shaded | Self::Technical => [0.0; 3],
            Self::Blueprint => [1.0; 3],
        }
    }

    /// Makes materials white where the style has its own colours.
    pub fn recolor_materials(self, materials: &mut [Material]) {
        if self != Self::Shaded {
            materials.iter_mut().for_each(|material| material.rgb = [1.0; 3]);
        }
    }

    /// Gives a picture of white faces, rendered without a background, the style's colours.
    pub fn recolor(self, film: &mut Film) {
        match self {
            Self::Shaded => {}
            Self::Technical => {
                for [red, green, blue, alpha] in &mut film.color {
                    for channel in [red, green, blue] {
                        *channel = *alpha * (1.0 - TECHNICAL_SHADE) + channel.min(*alpha) * TECHNICAL_SHADE;
                    }
                }
            }
            Self::Blueprint => {
                let paper = BLUE.map(|code| decode_srgb(f64::from(code)) as f32);
                for color in &mut film.color {
                    let light = (color[0] + color[1] + color[2]) / 3.0;
                    for channel in 0..3 {
                        color[channel] = paper[channel] * (BLUE_SHADE[0] * color[3] + BLUE_SHADE[1] * light);
                    }
                }
            }
        }
    }
}
