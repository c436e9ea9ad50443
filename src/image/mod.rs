//! Pixels and their files.

mod film;

pub use film::Film;
