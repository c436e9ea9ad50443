//! The flags of what is written, as clap sees them.

use crate::image::{BitDepth, Layers};
use clap::{Args, ValueEnum};

/// What is written.
#[derive(Debug, Args)]
#[command(next_help_heading = "Output")]
pub(super) struct OutputArguments {
    /// Bits a channel of PNG files.
    #[arg(long, value_enum, value_name = "BITS", default_value_t = BitDepthChoice::Eight)]
    pub(super) bit_depth: BitDepthChoice,
    /// What EXR files hold beside colours; the less, the faster.
    #[arg(long, value_enum, value_name = "LAYER[,LAYER...]", value_delimiter = ',', default_value = "all")]
    pub(super) layers: Vec<LayerChoice>,
    /// Render only part of the picture: from x0 to x1 of its width and from y0 to y1 of its height, 0 to 1 from the upper left.
    #[arg(long, value_name = "X0,X1,Y0,Y1", value_parser = parse_crop_window)]
    pub(super) cropwindow: Option<[f64; 4]>,
    /// Render only the I-th of N strips of the picture, 1 the uppermost; `trimray merge` joins them.
    #[arg(long, value_name = "I/N", value_parser = parse_tile, conflicts_with = "cropwindow")]
    pub(super) tile: Option<[u32; 2]>,
    /// Write what the numbers in id.part and id.face stand for, as JSON; {model} stands for the input's name.
    #[arg(long, value_name = "FILE.json")]
    pub(super) id_map: Option<String>,
    /// Report on stdout what was read, rendered and written, as one JSON object.
    #[arg(long)]
    pub(super) json: bool,
    /// Count what the rays through the pixels' centres take to their first hits: nodes, faces, leaves, steps of Newton's method, trim tests; on stderr, or
    /// in the object of --json. Whatever computes the picture, they are counted on the CPU, without sections.
    #[arg(long)]
    pub(super) stats: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum BitDepthChoice {
    #[value(name = "8")]
    Eight,
    #[value(name = "16")]
    Sixteen,
}

impl From<BitDepthChoice> for BitDepth {
    fn from(choice: BitDepthChoice) -> Self {
        match choice {
            BitDepthChoice::Eight => Self::Eight,
            BitDepthChoice::Sixteen => Self::Sixteen,
        }
    }
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum LayerChoice {
    /// All of the below.
    All,
    /// None of the below.
    None,
    /// depth.Z: millimetres along the view direction, at the pixel's centre; infinite where nothing is.
    Depth,
    /// normal.X, .Y, .Z: towards the viewer, model space, at the pixel's centre.
    Normal,
    /// position.X, .Y, .Z: millimetres, model space, at the pixel's centre.
    Position,
    /// uv.U, .V: the surface's own parameters, radians and millimetres, at the pixel's centre.
    Uv,
    /// mean_curvature.V, gaussian_curvature.V: of the surface at the pixel's centre, 1/mm and 1/mm^2; a ball of radius r has 1/r and 1/r^2, and what is
    /// hollow towards the viewer has a negative mean.
    Curvature,
    /// id.part, id.face: whole numbers, 0 where nothing is, at the pixel's centre; --id-map says what they stand for.
    Id,
    /// albedo.R, .G, .B: colours without light, linear, the mean of the samples.
    Albedo,
    /// CryptoObject00 to 02: how much of the pixel each part covers, as Cryptomatte 1.2.
    Cryptomatte,
}

/// The layers that are asked for.
pub(super) fn layers(choices: &[LayerChoice]) -> Layers {
    let mut layers = Layers::NONE;
    for choice in choices {
        match choice {
            LayerChoice::All => layers = Layers::ALL,
            LayerChoice::None => {}
            LayerChoice::Depth => layers.depth = true,
            LayerChoice::Normal => layers.normal = true,
            LayerChoice::Position => layers.position = true,
            LayerChoice::Uv => layers.uv = true,
            LayerChoice::Curvature => layers.curvature = true,
            LayerChoice::Id => layers.ids = true,
            LayerChoice::Albedo => layers.albedo = true,
            LayerChoice::Cryptomatte => layers.matte = true,
        }
    }
    layers
}

fn parse_crop_window(text: &str) -> Result<[f64; 4], String> {
    let numbers: Option<Vec<f64>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x0, x1, y0, y1]) if 0.0 <= x0 && x0 < x1 && x1 <= 1.0 && 0.0 <= y0 && y0 < y1 && y1 <= 1.0 => {
            Ok([x0, x1, y0, y1])
        }
        _ => Err("expected x0,x1,y0,y1 from 0 to 1, x0 below x1 and y0 below y1".into()),
    }
}

fn parse_tile(text: &str) -> Result<[u32; 2], String> {
    let numbers =
        text.split_once('/').and_then(|(i, n)| Some((i.trim().parse().ok()?, n.trim().parse().ok()?)));
    match numbers {
        Some((index, count)) if 1 <= index && index <= count && count <= 65_536 => Ok([index, count]),
        _ => Err("expected I/N with I from 1 to N".into()),
    }
}
