//! What a file says about looks.

/// A colour as CAD files give it: sRGB red, green, blue, and opacity, each in 0..=1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Color {
    /// sRGB red, green, blue.
    pub rgb: [f32; 3],
    /// 1 is opaque.
    pub opacity: f32,
}

impl Color {
    /// An opaque colour.
    pub const fn opaque(red: f32, green: f32, blue: f32) -> Self {
        Self { rgb: [red, green, blue], opacity: 1.0 }
    }
}
