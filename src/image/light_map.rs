//! Maps of light from all around: Radiance (.hdr) and OpenEXR files of linear light, longitude across and latitude down.

use super::exr;
use super::files::{ImageError, read};
use ::exr::prelude::FlatSamples;
use ::image::ImageDecoder;
use ::image::codecs::hdr::HdrDecoder;
use std::io::Cursor;
use std::path::Path;

/// Pixels of a file at most.
const MOST_PIXELS: u64 = 1 << 26;

/// Columns of a map at most: wider ones are halved, for no picture shows more of them.
const MOST_COLUMNS: usize = 4096;

/// The brightest light: it keeps sums finite.
const BRIGHTEST: f32 = 1e9;

/// Linear red, green and blue light, rows from the top; finite and not negative.
#[derive(Debug, Clone, PartialEq)]
pub struct LightMap {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// As many as pixels.
    pub light: Vec<[f32; 3]>,
}

impl LightMap {
    /// Reads a file by its extension, .hdr or .exr.
    ///
    /// # Errors
    ///
    /// It cannot be read, is neither, is too large, or has no red, green and blue.
    pub fn read(path: &Path) -> Result<Self, ImageError> {
        let extension = path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase());
        let mut map = match extension.as_deref() {
            Some("hdr") => Self::of_radiance(&read(path)?)?,
            Some("exr") => Self::of_exr(&read(path)?)?,
            _ => return Err(invalid("light map", format!("{} is neither .hdr nor .exr", path.display()))),
        };
        for channel in map.light.iter_mut().flatten() {
            // Not a number becomes dark.
            *channel = if *channel > 0.0 { channel.min(BRIGHTEST) } else { 0.0 };
        }
        while map.width > MOST_COLUMNS {
            map = map.halved();
        }
        Ok(map)
    }

    fn of_radiance(bytes: &[u8]) -> Result<Self, ImageError> {
        let failed = |error: ::image::ImageError| invalid("HDR", error.to_string());
        let decoder = HdrDecoder::new(Cursor::new(bytes)).map_err(failed)?;
        let (width, height) = decoder.dimensions();
        check_size("HDR", width as usize, height as usize)?;
        let (width, height) = (width as usize, height as usize);
        let mut light = vec![[0.0_f32; 3]; width * height];
        decoder.read_image(bytemuck::cast_slice_mut(&mut light)).map_err(failed)?;
        Ok(Self { width, height, light })
    }

    fn of_exr(bytes: &[u8]) -> Result<Self, ImageError> {
        let layered = exr::decode(bytes)?;
        let (width, height) = (layered.window.width, layered.window.height);
        check_size("EXR", width, height)?;
        let mut light = vec![[0.0; 3]; width * height];
        for (k, name) in ["R", "G", "B"].into_iter().enumerate() {
            let channel = layered.channels.iter().find(|(own, _)| own == name);
            let (_, samples) =
                channel.ok_or_else(|| invalid("EXR", format!("the light map has no channel {name}")))?;
            let set = |(light, value): (&mut [f32; 3], f32)| light[k] = value;
            match samples {
                FlatSamples::F16(own) => light.iter_mut().zip(own.iter().map(|x| x.to_f32())).for_each(set),
                FlatSamples::F32(own) => light.iter_mut().zip(own.iter().copied()).for_each(set),
                FlatSamples::U32(own) => light.iter_mut().zip(own.iter().map(|&x| x as f32)).for_each(set),
            }
        }
        Ok(Self { width, height, light })
    }

    /// Half as many pixels across and down, each the mean of four.
    fn halved(&self) -> Self {
        let (width, height) = (self.width / 2, (self.height / 2).max(1));
        let mean = |pixel: usize| {
            let (x, y) = (pixel % width * 2, pixel / width * 2);
            let at = |dx: usize, dy: usize| self.light[(y + dy).min(self.height - 1) * self.width + x + dx];
            let corners = [at(0, 0), at(1, 0), at(0, 1), at(1, 1)];
            std::array::from_fn(|k| corners.iter().map(|corner| corner[k]).sum::<f32>() / 4.0)
        };
        Self { width, height, light: (0..width * height).map(mean).collect() }
    }
}

fn check_size(format: &'static str, width: usize, height: usize) -> Result<(), ImageError> {
    match width as u64 * height as u64 {
        0 => Err(invalid(format, "the light map has no pixels".to_owned())),
        1..=MOST_PIXELS => Ok(()),
        _ => Err(invalid(format, format!("the light map has more than {MOST_PIXELS} pixels"))),
    }
}

fn invalid(format: &'static str, reason: String) -> ImageError {
    ImageError::Invalid { format, reason }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Film, encode_exr, write_file};

    /// A map of 2 by 1 pixels: light of 1, ½, 0 and of 8, 0, 0.
    const RADIANCE: &[u8] =
        b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 1 +X 2\n\x80\x40\x00\x81\x80\x00\x00\x84";

    fn written(name: &str, bytes: &[u8]) -> Result<LightMap, ImageError> {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join(name);
        std::fs::write(&path, bytes).expect("written");
        LightMap::read(&path)
    }

    #[test]
    fn radiance_files_are_read() {
        let map = written("a.hdr", RADIANCE).expect("a map");
        assert_eq!((map.width, map.height), (2, 1));
        assert_eq!(map.light, [[1.0, 0.5, 0.0], [8.0, 0.0, 0.0]]);
    }

    #[test]
    fn exr_files_are_read_and_what_is_no_light_is_dark() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.exr");
        let mut film = Film::new(2, 1);
        film.color = vec![[1.0, 2.0, f32::NAN, 1.0], [-1.0, f32::INFINITY, 0.25, 1.0]];
        write_file(&path, &encode_exr(&film, &[]).expect("encoded")).expect("written");
        let map = LightMap::read(&path).expect("a map");
        assert_eq!(map.light, [[1.0, 2.0, 0.0], [0.0, BRIGHTEST, 0.25]]);
    }

    #[test]
    fn wide_maps_are_halved() {
        let map = LightMap { width: 4, height: 3, light: vec![[1.0; 3]; 12] };
        assert_eq!(map.halved(), LightMap { width: 2, height: 1, light: vec![[1.0; 3]; 2] });
    }

    #[test]
    fn damaged_files_are_errors() {
        for length in [0, 5, 30, RADIANCE.len() - 1] {
            assert!(written("a.hdr", &RADIANCE[..length]).is_err(), "{length}");
        }
        let huge = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 100000 +X 100000\n";
        assert!(written("a.hdr", huge).is_err_and(|error| error.to_string().contains("more than")));
        for name in ["a.png", "a.exr"] {
            assert!(written(name, RADIANCE).is_err(), "{name}");
        }
    }
}
