//! Pixels and their files.
//!
//! A [`Film`] is what a renderer measured: linear light and what each pixel shows. A [`Picture`] is what a screen shows:
//! 8 bits a channel, sRGB. PNG files hold pictures, EXR files hold films. Files are written beside their place and
//! renamed, so that nobody ever reads half of one.

mod compare;
mod exr;
mod files;
mod film;
mod picture;
mod png;

pub use compare::{Difference, SizesDiffer, compare};
pub use exr::write_exr;
pub use files::ImageError;
pub use film::Film;
pub use picture::{Picture, decode_srgb};
pub use png::{decode_png, encode_png, read_png, write_png};
