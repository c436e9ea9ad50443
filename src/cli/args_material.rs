//! The flags of materials, as clap sees them.

use super::args::parse_color;
use crate::image::decode_srgb;
use crate::render::Override;
use clap::Args;
use std::path::PathBuf;

/// Looks that win over the file's.
#[derive(Debug, Args)]
#[command(next_help_heading = "Material")]
pub(super) struct MaterialArguments {
    /// Colour of all parts instead of the file's, sRGB: r,g,b in 0..=1, or #rrggbb.
    #[arg(long, value_name = "COLOR", value_parser = parse_color, allow_hyphen_values = true)]
    pub(super) color: Option<[f32; 3]>,
    /// How matt all parts are, from 0, a mirror, to 1, chalk; the file's parts have 0.45.
    #[arg(long, value_name = "R", value_parser = parse_share, allow_hyphen_values = true)]
    pub(super) roughness: Option<f32>,
    /// How metallic all parts are, from 0, plastic or paint, to 1, bare metal.
    #[arg(long, value_name = "M", value_parser = parse_share, allow_hyphen_values = true)]
    pub(super) metallic: Option<f32>,
    /// How opaque all parts are, from 0, not to be seen, to 1.
    #[arg(long, value_name = "O", value_parser = parse_share, allow_hyphen_values = true)]
    pub(super) opacity: Option<f32>,
    /// Looks of parts, a table for each: the key is a pattern as of --only; color, roughness, metallic and opacity are as the flags, and win over
    /// them. Of tables that mean the same part the last one wins.
    #[arg(long, value_name = "FILE.toml")]
    pub(super) materials: Option<PathBuf>,
}

impl MaterialArguments {
    /// Whether the flags say anything.
    pub(super) fn is_empty(&self) -> bool {
        self.all() == Override::default() && self.materials.is_none()
    }

    /// What the flags say of all parts.
    pub(super) fn all(&self) -> Override {
        Override {
            rgb: self.color.map(linear),
            roughness: self.roughness,
            metallic: self.metallic,
            opacity: self.opacity,
        }
    }
}

/// Linear light of an sRGB colour.
pub(super) fn linear(srgb: [f32; 3]) -> [f32; 3] {
    srgb.map(|code| decode_srgb(f64::from(code)) as f32)
}

/// A number from 0 to 1.
pub(super) fn parse_share(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(share) if (0.0..=1.0).contains(&share) => Ok(share),
        _ => Err("expected a number from 0 to 1".into()),
    }
}
