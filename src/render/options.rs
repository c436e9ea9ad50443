//! What a picture should look like.

use crate::image::Film;

/// What stands behind the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Background {
    /// sRGB.
    Color([f32; 3]),
    /// Nothing: the picture has coverage in its alpha channel.
    Transparent,
}

impl Background {
    /// Puts it behind what a film shows.
    pub(super) fn put_behind(self, film: &mut Film) {
        match self {
            Self::Color(srgb) => film.put_behind(srgb),
            Self::Transparent => {}
        }
    }
}

/// How to render.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderOptions {
    /// Pixels across and down.
    pub resolution: [u32; 2],
    /// Samples per pixel, stratified over the pixel.
    pub samples: u32,
    /// Behind the model.
    pub background: Background,
    /// Whether to darken where the surroundings block the light.
    pub ambient_occlusion: bool,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            resolution: [1000, 600],
            samples: 16,
            background: Background::Color([1.0, 1.0, 1.0]),
            ambient_occlusion: true,
        }
    }
}
