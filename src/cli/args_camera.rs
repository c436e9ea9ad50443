//! The flags of the camera, as clap sees them.

use super::args::{parse_direction, parse_point, parse_view_angle};
use super::pattern::Pattern;
use crate::render::NAMED_VIEWS;
use clap::Args;
use clap::builder::PossibleValuesParser;
use glam::DVec3;

/// The name that stands for a set of views.
pub(super) const REVIEW_NAME: &str = "review";

/// A turn in more pictures than this is a mistake.
const MOST_FRAMES: i64 = 100_000;

/// Where the picture is taken from.
#[derive(Debug, Args)]
#[command(next_help_heading = "Camera")]
pub(super) struct CameraArguments {
    /// What is up in the picture: ±X, ±Y, ±Z, or x,y,z.
    #[arg(long, value_name = "DIRECTION", default_value = "+Z", value_parser = parse_direction, allow_hyphen_values = true)]
    pub(super) up: DVec3,
    /// Views by name: with +Z up, front looks along +Y, and right looks at the side of +X.
    ///
    /// Several views are several files where the output has {view} in its name, else one sheet with a --resolution for each. review is a sheet of
    /// six: top, iso and the corner opposite to it, front, right, back.
    #[arg(long, value_name = "NAME[,NAME...]", value_delimiter = ',', value_parser = view_names(),
          conflicts_with_all = ["camera_direction", "camera_position"])]
    pub(super) view: Vec<String>,
    /// Write the name of each view in its corner, above the model.
    #[arg(long, requires = "view")]
    pub(super) labels: bool,
    /// Where the camera looks: ±X, ±Y, ±Z, or x,y,z [default: -1,1,-0.5 with +Z up].
    #[arg(long, value_name = "DIRECTION", value_parser = parse_direction, allow_hyphen_values = true)]
    pub(super) camera_direction: Option<DVec3>,
    /// Where the camera stands [default: where the whole model is in the picture].
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true,
          conflicts_with = "camera_direction")]
    pub(super) camera_position: Option<DVec3>,
    /// What stands in the middle of the picture [default: the middle of the model].
    #[arg(long, value_name = "X,Y,Z", value_parser = parse_point, allow_hyphen_values = true)]
    pub(super) camera_focal_point: Option<DVec3>,
    /// Angle between the picture's lower and upper edge, degrees.
    #[arg(long, value_name = "DEGREES", default_value_t = 30.0, value_parser = parse_view_angle)]
    pub(super) camera_view_angle: f64,
    /// The view angle as that of a lens for film of 36 by 24 mm: 2 atan(12 / MM); 45 mm is 30 degrees.
    #[arg(long, value_name = "MM", value_parser = parse_focal_length, conflicts_with = "camera_view_angle")]
    pub(super) camera_focal_length: Option<f64>,
    /// Parallel projection.
    #[arg(long)]
    pub(super) camera_orthographic: bool,
    /// Turn the camera, wherever the flags above put it, so far to the right about what is up.
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, value_parser = parse_turn, allow_hyphen_values = true)]
    pub(super) camera_azimuth_angle: f64,
    /// Then raise it so far over the focal point.
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, value_parser = parse_turn, allow_hyphen_values = true)]
    pub(super) camera_elevation_angle: f64,
    /// Share of the picture, across or upwards, that the model fills.
    #[arg(long, value_name = "SHARE", default_value_t = 0.95, value_parser = parse_fill, conflicts_with = "camera_position")]
    pub(super) fit: f64,
    /// Frame only what matches, a pattern as of --only; the rest is drawn all the same. May be given several times.
    #[arg(long, value_name = "PATTERN", conflicts_with = "camera_position")]
    pub(super) focus: Vec<Pattern>,
    /// Pictures of one whole turn about what is up, with {frame} in the output's name; without it, an animated PNG.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=MOST_FRAMES))]
    pub(super) frames: u32,
    /// Pictures a second of an animated PNG.
    #[arg(long, value_name = "N", default_value_t = 24, value_parser = clap::value_parser!(u16).range(1..=240))]
    pub(super) frame_rate: u16,
}

fn view_names() -> PossibleValuesParser {
    PossibleValuesParser::new(NAMED_VIEWS.iter().map(|view| view.name).chain([REVIEW_NAME]))
}

fn parse_focal_length(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(millimetres) if (1.05..=100_000.0).contains(&millimetres) => Ok(millimetres),
        _ => Err("expected millimetres from 1.05 to 100000".into()),
    }
}

pub(super) fn parse_turn(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(degrees) if degrees.abs() <= 360.0 => Ok(degrees),
        _ => Err("expected degrees from -360 to 360".into()),
    }
}

fn parse_fill(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(share) if (0.01..=1.0).contains(&share) => Ok(share),
        _ => Err("expected a share from 0.01 to 1".into()),
    }
}
