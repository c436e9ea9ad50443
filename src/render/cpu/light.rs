//! The constants of the look. Directions are (right, up, towards the viewer) of the camera; colours are linear light.
//!
//! Chosen by eye on mid-grey parts: a face square to the key shows its material's own colour to within a few percent, one turned away keeps
//! a third of it, so that edges between neighbouring planes always show.

/// Towards the key light: upper left, in front.
pub const KEY_FROM: [f64; 3] = [-0.55, 0.75, 0.85];
/// Slightly warm.
pub const KEY_COLOR: [f32; 3] = [0.62, 0.605, 0.58];
/// Towards the fill light: right, low, in front.
pub const FILL_FROM: [f64; 3] = [0.85, 0.1, 0.6];
/// Slightly cool.
pub const FILL_COLOR: [f32; 3] = [0.16, 0.17, 0.185];
/// The sky.
pub const AMBIENT_UP: [f32; 3] = [1.0, 1.0, 1.02];
/// The ground.
pub const AMBIENT_DOWN: [f32; 3] = [0.62, 0.60, 0.58];
/// What sky and ground contribute.
pub const AMBIENT_WEIGHT: f32 = 0.42;
/// Along silhouettes.
pub const RIM_COLOR: [f32; 3] = [0.10, 0.105, 0.115];
/// Blinn's exponent at the default roughness.
pub const GLOSS: f32 = 48.0;
/// Highlights of smoother surfaces would fall between samples.
pub const LEAST_ROUGHNESS: f32 = 0.1;
/// How bright metal mirrors the key and the fill light.
pub const METAL_LIGHT: f32 = 1.5;
/// Blinn's exponent of a lobe as wide as those lights.
pub const METAL_BOX: f32 = 24.0;
/// The sky that metal mirrors: with more contrast than the one that lights, or metal would look like clay.
pub const METAL_UP: [f32; 3] = [0.95, 0.95, 0.97];
/// The ground that metal mirrors.
pub const METAL_DOWN: [f32; 3] = [0.10, 0.098, 0.095];
/// Reflectance of the highlight, as of a dielectric coat.
pub const SPECULAR_REFLECTANCE: f32 = 0.02;
/// Reach of ambient occlusion, of the scene's radius (half its diagonal).
pub const OCCLUSION_RADIUS: f64 = 0.4;
/// Start of secondary rays above the surface, of the scene's radius: 160 f32 roundings of a position.
pub const SURFACE_OFFSET: f64 = 2e-5;
