//! Pixels and their files.
//!
//! A [`Film`] is what a renderer measured: linear light and what each pixel shows. A [`Picture`] is what a screen shows:
//! 8 or 16 bits a channel, sRGB. PNG files hold pictures, EXR files hold films. Files are written beside their place and
//! renamed, so that nobody ever reads half of one.

mod animation;
mod compare;
mod cryptomatte;
mod diff;
mod exr;
mod files;
mod film;
mod huge_pages;
mod lettering;
mod light_map;
mod merge;
mod picture;
mod png;
mod ramp;
mod stroke;
mod tone;

pub use animation::Animation;
pub use compare::{Difference, SizesDiffer, compare};
pub use cryptomatte::{RANKS, Share, matte_id, unique_names};
pub use diff::{ChannelDifference, ImageDifference, NotComparable, Numbers, diff};
pub use exr::encode_exr;
pub use files::{ImageError, make_folder_of, write as write_file};
pub use film::{Film, Layers, Window};
pub(crate) use huge_pages::filled;
pub use lettering::label_share;
pub use light_map::LightMap;
pub use merge::{MergeError, merge_exr, merge_png};
pub use picture::{DeepPicture, Picture, decode_srgb, encode_srgb};
pub use png::{BitDepth, decode_png, encode_film, encode_png, read_png, write_png};
pub use ramp::heat_color;
pub use stroke::{box_coverage, distance_to};
pub use tone::ToneMapping;
