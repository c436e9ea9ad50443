//! The look of pictures as clap sees it: styles and lines.

use super::args::parse_color;
use crate::render::Style;
use crate::render::lines::{EdgeChoice, HiddenLines};
use clap::{Args, ValueEnum};

/// Styles and lines.
#[derive(Debug, Args)]
#[command(next_help_heading = "Lines and style")]
pub(super) struct StyleArguments {
    /// Which edges of the model are drawn as lines, and with them the silhouettes of what is curved [default: none; feature in the styles technical and
    /// blueprint; feature where nothing is said].
    #[arg(short, long, value_enum, value_name = "WHICH", num_args = 0..=1, default_missing_value = "feature")]
    pub(super) edges: Option<EdgesChoice>,
    /// Width of lines in pixels, 0.1 to 64 [default: 1.5].
    #[arg(long, value_name = "PIXELS", value_parser = parse_width)]
    pub(super) edge_width: Option<f64>,
    /// Colour of lines, sRGB: r,g,b in 0..=1, or #rrggbb [default: black; white in the style blueprint].
    #[arg(long, value_name = "COLOR", value_parser = parse_color)]
    pub(super) edge_color: Option<[f32; 3]>,
    /// Draw edges alone: no lines where a curved face turns away, or one thing ends before another.
    #[arg(long)]
    pub(super) no_silhouettes: bool,
    /// How edges look that something hides.
    #[arg(long, value_enum, value_name = "LOOK")]
    pub(super) hidden_lines: Option<HiddenChoice>,
    /// What the whole picture looks like.
    #[arg(long, value_enum, default_value_t = StyleChoice::Shaded)]
    pub(super) style: StyleChoice,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum EdgesChoice {
    /// No lines at all.
    None,
    /// Edges where faces meet at an angle of 2 degrees or more, and borders of sheets.
    Feature,
    /// Those between tangent faces and seams of closed faces too.
    All,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum HiddenChoice {
    /// They are not drawn.
    Off,
    /// Thin and faint.
    Dim,
    /// Thin and dashed.
    Dashed,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum StyleChoice {
    /// The file's colours in soft light.
    Shaded,
    /// White faces with very little shade, black lines.
    Technical,
    /// White lines on blue paper.
    Blueprint,
}

impl StyleArguments {
    /// Whether lines are drawn.
    pub(super) fn has_lines(&self) -> bool {
        self.edges() != EdgesChoice::None
    }

    /// The edges that are drawn.
    pub(super) fn edges(&self) -> EdgesChoice {
        self.edges.unwrap_or(match self.style {
            StyleChoice::Shaded => EdgesChoice::None,
            StyleChoice::Technical | StyleChoice::Blueprint => EdgesChoice::Feature,
        })
    }
}

impl From<EdgesChoice> for EdgeChoice {
    fn from(choice: EdgesChoice) -> Self {
        match choice {
            EdgesChoice::None => Self::None,
            EdgesChoice::Feature => Self::Feature,
            EdgesChoice::All => Self::All,
        }
    }
}

impl From<HiddenChoice> for HiddenLines {
    fn from(choice: HiddenChoice) -> Self {
        match choice {
            HiddenChoice::Off => Self::Off,
            HiddenChoice::Dim => Self::Dim,
            HiddenChoice::Dashed => Self::Dashed,
        }
    }
}

impl From<StyleChoice> for Style {
    fn from(choice: StyleChoice) -> Self {
        match choice {
            StyleChoice::Shaded => Self::Shaded,
            StyleChoice::Technical => Self::Technical,
            StyleChoice::Blueprint => Self::Blueprint,
        }
    }
}

fn parse_width(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(pixels) if (0.1..=64.0).contains(&pixels) => Ok(pixels),
        _ => Err("expected pixels from 0.1 to 64".into()),
    }
}
