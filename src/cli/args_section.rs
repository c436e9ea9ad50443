//! Sections as clap sees them.

use super::pattern::Pattern;
use crate::numeric::Aabb;
use crate::render::section::{SectionMode, SectionPlane};
use clap::{Args, ValueEnum};
use glam::DVec3;
use std::str::FromStr;

/// Sections.
#[derive(Debug, Args)]
#[command(next_help_heading = "Section")]
pub(super) struct SectionArguments {
    /// Cut the model with a plane and keep one side: x=10mm keeps x <= 10 mm, -x=10mm the other side; so y= and z=; nx,ny,nz@d keeps n.p <= d along the
    /// normalised n. mm may be left out; also cm, m, in, and % of the model's extent. Up to six.
    #[arg(long, value_name = "PLANE", allow_hyphen_values = true)]
    pub(super) section: Vec<SectionFlag>,
    /// What several planes cut away: what is beyond any of them, or only the corner that is beyond all of them: two cut a quarter out of the model, three
    /// an eighth.
    #[arg(long, value_name = "MODE", requires = "section", value_enum, default_value_t = SectionModeFlag::Each)]
    pub(super) section_mode: SectionModeFlag,
    /// Leave cut bodies open, instead of filling the cut in the part's colour and hatching it.
    #[arg(long, requires = "section")]
    pub(super) no_caps: bool,
    /// Leave parts whole whose name (or path, with a /) is like this: * for any characters, ? for one, ** for any with /; or the #number of the part in
    /// the file.
    #[arg(long, value_name = "GLOB", requires = "section")]
    pub(super) section_exclude: Vec<Pattern>,
}

/// What several planes cut away together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum SectionModeFlag {
    /// Each plane cuts away all that is beyond it
    Each,
    /// Only what is beyond all planes is cut away
    Corner,
}

impl From<SectionModeFlag> for SectionMode {
    fn from(flag: SectionModeFlag) -> Self {
        match flag {
            SectionModeFlag::Each => Self::Each,
            SectionModeFlag::Corner => Self::Corner,
        }
    }
}

/// A plane across an axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SectionFlag {
    /// Unit vector along which the place is measured.
    axis: DVec3,
    place: Place,
    /// Whether the side farther along the axis is kept.
    keeps_far: bool,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Place {
    Millimetres(f64),
    /// 0 to 1 of the model's extent.
    Share(f64),
}

/// What is allowed, for errors.
const ALLOWED: &str = "expected x=10mm, -x=10mm, y=50% or nx,ny,nz@10mm: an axis or a normal, and a place in mm, cm, m, in or %";

impl FromStr for SectionFlag {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parsed = if let Some((normal, place)) = text.split_once('@') {
            super::args::parse_point(normal)
                .ok()
                .and_then(DVec3::try_normalize)
                .zip(Place::parse(place))
                .map(|(axis, place)| Self { axis, place, keeps_far: false })
        } else {
            text.split_once('=').and_then(|(axis, place)| {
                let (keeps_far, axis) = match axis.trim().strip_prefix('-') {
                    Some(axis) => (true, axis),
                    None => (false, axis.trim()),
                };
                let axis = match axis {
                    "x" | "X" => DVec3::X,
                    "y" | "Y" => DVec3::Y,
                    "z" | "Z" => DVec3::Z,
                    _ => return None,
                };
                Some(Self { axis, place: Place::parse(place)?, keeps_far })
            })
        };
        parsed.ok_or_else(|| ALLOWED.to_owned())
    }
}

impl Place {
    fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        let end =
            text.find(|c: char| c.is_alphabetic() && c != 'e' && c != 'E' || c == '%').unwrap_or(text.len());
        let (number, unit) = text.split_at(end);
        let number: f64 = number.trim().parse().ok().filter(|number: &f64| number.is_finite())?;
        match unit {
            "" | "mm" => Some(Self::Millimetres(number)),
            "cm" => Some(Self::Millimetres(number * 10.0)),
            "m" => Some(Self::Millimetres(number * 1000.0)),
            "in" => Some(Self::Millimetres(number * 25.4)),
            "%" => Some(Self::Share(number / 100.0)),
            _ => None,
        }
    }
}

impl SectionFlag {
    /// The plane for a model within `bounds`.
    pub(super) fn plane(&self, bounds: &Aabb) -> SectionPlane {
        let along = match self.place {
            Place::Millimetres(place) => place,
            Place::Share(share) => {
                let corners = bounds.corners().map(|corner| corner.dot(self.axis));
                let low = corners.into_iter().fold(f64::INFINITY, f64::min);
                let high = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
                low + (high - low) * share
            }
        };
        let sign = if self.keeps_far { -1.0 } else { 1.0 };
        SectionPlane { normal: self.axis * sign, offset: along * sign }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plane(text: &str) -> Option<SectionPlane> {
        let bounds = Aabb { min: DVec3::new(-10.0, 0.0, 0.0), max: DVec3::new(30.0, 2.0, 4.0) };
        text.parse::<SectionFlag>().ok().map(|flag| flag.plane(&bounds))
    }

    #[test]
    fn planes_keep_the_side_that_they_say() {
        for (text, normal, offset) in [
            ("x=10", DVec3::X, 10.0),
            ("x=10mm", DVec3::X, 10.0),
            ("Y=-1.5cm", DVec3::Y, -15.0),
            ("-z=1in", -DVec3::Z, -25.4),
            ("x=50%", DVec3::X, 10.0),
            ("-x=25%", -DVec3::X, 0.0),
            ("0,0,-2@3", -DVec3::Z, 3.0),
            ("0,0,-2@100%", -DVec3::Z, 0.0),
            ("z=1e2", DVec3::Z, 100.0),
        ] {
            let found = plane(text).expect(text);
            assert!(
                found.normal.distance(normal) < 1e-12 && (found.offset - offset).abs() < 1e-12,
                "{text} {found:?}"
            );
        }
        for wrong in ["", "x", "x=", "w=3", "x=3ft", "x=nan", "0,0,0@1", "1,2@3", "x=10 mm mm", "x=%", "=3"] {
            assert_eq!(plane(wrong), None, "{wrong}");
        }
    }
}
