//! The flags of path tracing and of light, as clap sees them.

use super::args_camera::parse_turn;
use crate::image::ToneMapping;
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// Path tracing, light and tones.
#[derive(Debug, Args)]
#[command(next_help_heading = "Path tracing and light")]
pub(super) struct PathArguments {
    /// Trace light paths: soft shadows, reflections, light from surface to surface. Takes longer, and longer for less noise.
    #[arg(long, visible_alias = "raytracing",
          conflicts_with_all = ["aov", "samples", "sampling", "no_ambient_occlusion"])]
    pub(super) path_trace: bool,
    /// Paths through each pixel; twice as many leave 0.7 times the noise or less; powers of two are best [default: 64].
    #[arg(long, visible_alias = "raytracing-samples", value_name = "N", requires = "path_trace",
          value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub(super) spp: Option<u32>,
    /// Surfaces that light may meet on its way, 1 to 64; 1 is light straight from the surroundings [default: 6].
    #[arg(long, value_name = "N", requires = "path_trace", value_parser = clap::value_parser!(u32).range(1..=64))]
    pub(super) max_depth: Option<u32>,
    /// Another number gives other noise; the same one the same picture [default: 0].
    #[arg(long, value_name = "N", requires = "path_trace")]
    pub(super) seed: Option<u32>,
    /// Stop where the noise is below this before all --spp are taken: the standard error of what is seen, of the range of a picture; 0.01 is fine, 0.003 very
    /// fine. Judged in blocks of 8 by 8 pixels.
    #[arg(long, value_name = "SHARE", requires = "path_trace", value_parser = parse_noise, allow_hyphen_values = true)]
    pub(super) noise: Option<f32>,
    /// Put the model on a ground that catches its shadow: shadows alone, so that the background shows, or the shadow's alpha where there is none.
    #[arg(long, requires = "path_trace")]
    pub(super) ground: bool,
    /// Light from a map of the surroundings, longitude across and latitude down: .hdr or .exr [default: a studio that moves with the camera].
    #[arg(long, visible_alias = "hdri-file", value_name = "FILE", requires = "path_trace")]
    pub(super) hdri: Option<PathBuf>,
    /// Turn the map so far about what is up.
    #[arg(long, value_name = "DEGREES", requires = "hdri", value_parser = parse_turn, allow_hyphen_values = true)]
    pub(super) hdri_rotation: Option<f64>,
    /// How many times as bright as in the file the map is; of the studio too [default: 1].
    #[arg(long, visible_alias = "light-intensity", value_name = "FACTOR", requires = "path_trace",
          value_parser = parse_factor, allow_hyphen_values = true)]
    pub(super) hdri_intensity: Option<f32>,
    /// Show the map behind the model.
    #[arg(long, visible_alias = "hdri-skybox", requires = "hdri", conflicts_with_all = ["no_background", "background_color"])]
    pub(super) hdri_background: bool,
    /// How light that is brighter than a screen is shown in PNG files; EXR files keep it [default: none; neutral with --hdri].
    #[arg(long, value_enum, value_name = "CURVE")]
    pub(super) tone_mapping: Option<ToneChoice>,
    /// Brighten PNG files by so many powers of two, -20 to 20.
    #[arg(long, value_name = "EV", default_value_t = 0.0, value_parser = parse_exposure, allow_hyphen_values = true)]
    pub(super) exposure: f32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum ToneChoice {
    /// It is cut off.
    None,
    /// Khronos PBR Neutral: colours stay, highlights are pressed.
    Neutral,
    /// AgX: like film, softer, colours fade in bright light.
    Agx,
}

impl PathArguments {
    /// Whether light is shown other than as it is.
    pub(super) fn changes_tones(&self) -> bool {
        self.tone_mapping() != ToneMapping::None || self.exposure != 0.0
    }

    /// How bright light is shown.
    pub(super) fn tone_mapping(&self) -> ToneMapping {
        // The studio's light shows colours as they are; how bright a map is nobody knows.
        match (self.tone_mapping, self.hdri.is_some()) {
            (Some(ToneChoice::None), _) | (None, false) => ToneMapping::None,
            (Some(ToneChoice::Neutral), _) | (None, true) => ToneMapping::Neutral,
            (Some(ToneChoice::Agx), _) => ToneMapping::Agx,
        }
    }
}

fn parse_noise(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(share) if (1e-5..=1.0).contains(&share) => Ok(share),
        _ => Err("expected a share from 0.00001 to 1".into()),
    }
}

fn parse_factor(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(factor) if (0.0..=1e6).contains(&factor) => Ok(factor),
        _ => Err("expected a factor from 0 to 1000000".into()),
    }
}

fn parse_exposure(text: &str) -> Result<f32, String> {
    match text.parse::<f32>() {
        Ok(powers) if (-20.0..=20.0).contains(&powers) => Ok(powers),
        _ => Err("expected powers of two from -20 to 20".into()),
    }
}
