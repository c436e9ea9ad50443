//! What a picture should look like.

use super::section::Section;
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

/// How carefully a leaf of a net is searched where a ray grazes it: where nothing certifies that at most one hit is there. All other
/// pairs of a ray and a leaf are treated alike, and without loss.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Exactness {
    /// Newton's method once, from the ray's crossing of the leaf's plane.
    Fast,
    /// Newton's method twice, from where the ray enters and leaves the leaf's slab.
    Balanced,
    /// A certified search of the whole leaf.
    #[default]
    Exact,
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
    /// How carefully grazing hits are searched for.
    pub exactness: Exactness,
    /// What the model is cut down to.
    pub section: Section,
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            resolution: [1000, 600],
            samples: 16,
            background: Background::Color([1.0, 1.0, 1.0]),
            ambient_occlusion: true,
            exactness: Exactness::default(),
            section: Section::default(),
        }
    }
}
