//! What a picture should look like.

use super::section::Section;
use crate::image::{Film, Layers, Window};

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
    pub fn put_behind(self, film: &mut Film) {
        match self {
            Self::Color(srgb) => film.put_behind(srgb),
            Self::Transparent => {}
        }
    }
}

/// How rays go that are beside each other in a list.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Coherence {
    /// Alike, as those through pixels beside each other.
    Coherent,
    /// Anyhow.
    Incoherent,
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

/// How a net is searched: [`Exactness`], and where a search ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NetSearch {
    /// Which searches there are.
    pub exactness: Exactness,
    /// Newton's method has converged with a step below so many `√ε` of the leaf's sides: such a step leaves about its square, so that 1 leaves
    /// what the numbers round. Other values are for studies.
    pub newton_stop: f32,
}

impl From<Exactness> for NetSearch {
    fn from(exactness: Exactness) -> Self {
        Self { exactness, newton_stop: 1.0 }
    }
}

/// Which pixels get all samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sampling {
    /// Those in which something changes; the others have the light of their centre.
    #[default]
    Adaptive,
    /// All.
    Uniform,
}

/// How to render.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RenderOptions {
    /// Pixels across and down.
    pub resolution: [u32; 2],
    /// Samples per pixel, spread over the pixel.
    pub samples: u32,
    /// Which pixels get them all.
    pub sampling: Sampling,
    /// Behind the model.
    pub background: Background,
    /// Whether to darken where the surroundings block the light.
    pub ambient_occlusion: bool,
    /// How carefully grazing hits are searched for.
    pub exactness: Exactness,
    /// What the film has beside colours.
    pub layers: Layers,
    /// The part of the picture to render; none: all of it. It lies within the picture.
    pub window: Option<Window>,
    /// What the model is cut down to.
    pub section: Section,
}

impl RenderOptions {
    /// The film to fill, empty.
    #[cfg(feature = "gpu")]
    pub(super) fn film(&self) -> Film {
        let whole = self.resolution.map(|n| n as usize);
        Film::of_window(self.window.unwrap_or(Window::whole(whole[0], whole[1])), whole, self.layers)
    }
}

impl Default for RenderOptions {
    fn default() -> Self {
        Self {
            resolution: [1000, 600],
            samples: 16,
            sampling: Sampling::default(),
            background: Background::Color([1.0, 1.0, 1.0]),
            ambient_occlusion: true,
            exactness: Exactness::default(),
            layers: Layers::PLAIN,
            window: None,
            section: Section::default(),
        }
    }
}
