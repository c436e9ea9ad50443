//! PNG: 8 bits a channel, marked as sRGB; RGB where the picture is opaque, else RGBA.

use super::files::{self, ImageError};
use super::{Film, Picture};
use std::path::Path;

/// More pixels than any camera has; a decoder must not believe a header.
const MAX_PIXELS: u64 = 1 << 28;

/// Develops and writes a film.
pub fn write_png(path: &Path, film: &Film) -> Result<(), ImageError> {
    files::write(path, &encode_png(&Picture::from(film))?)
}

/// Reads a picture.
pub fn read_png(path: &Path) -> Result<Picture, ImageError> {
    decode_png(&files::read(path)?)
}

/// The bytes of a PNG file.
pub fn encode_png(picture: &Picture) -> Result<Vec<u8>, ImageError> {
    let invalid = |reason: String| ImageError::Invalid { format: "PNG", reason };
    let side = |n: usize| u32::try_from(n).map_err(|_| invalid(format!("{n} pixels are too many")));
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(&mut bytes, side(picture.width)?, side(picture.height)?);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let samples: Vec<u8> = if picture.is_opaque() {
        encoder.set_color(png::ColorType::Rgb);
        picture.pixels.iter().flat_map(|&[r, g, b, _]| [r, g, b]).collect()
    } else {
        encoder.set_color(png::ColorType::Rgba);
        picture.pixels.as_flattened().to_vec()
    };
    let mut writer = encoder.write_header().map_err(|e| invalid(e.to_string()))?;
    writer.write_image_data(&samples).map_err(|e| invalid(e.to_string()))?;
    writer.finish().map_err(|e| invalid(e.to_string()))?;
    Ok(bytes)
}

/// The picture in a PNG file of any colour type; 16 bits are cut to 8.
pub fn decode_png(bytes: &[u8]) -> Result<Picture, ImageError> {
    let invalid = |reason: String| ImageError::Invalid { format: "PNG", reason };
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8() | png::Transformations::ALPHA);
    let mut reader = decoder.read_info().map_err(|e| invalid(e.to_string()))?;
    let (width, height) = reader.info().size();
    if u64::from(width) * u64::from(height) > MAX_PIXELS {
        return Err(invalid(format!("{width} by {height} pixels are too many")));
    }
    let size = reader.output_buffer_size().ok_or_else(|| invalid("too large".into()))?;
    let mut samples = vec![0; size];
    let frame = reader.next_frame(&mut samples).map_err(|e| invalid(e.to_string()))?;
    let samples = &samples[..frame.buffer_size()];
    let pixels: Vec<[u8; 4]> = match frame.color_type {
        png::ColorType::Rgba => samples.chunks_exact(4).map(|c| [c[0], c[1], c[2], c[3]]).collect(),
        png::ColorType::GrayscaleAlpha => samples.chunks_exact(2).map(|c| [c[0], c[0], c[0], c[1]]).collect(),
        other => return Err(invalid(format!("unexpected colour type {other:?}"))),
    };
    Ok(Picture { width: width as usize, height: height as usize, pixels })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ramp(alpha: impl Fn(usize) -> u8) -> Picture {
        let pixels = (0..7 * 5).map(|i| [i as u8, 255 - i as u8, (i * 7) as u8, alpha(i)]).collect();
        Picture { width: 7, height: 5, pixels }
    }

    #[test]
    fn opaque_and_transparent_pictures_come_back() {
        for picture in [ramp(|_| 255), ramp(|i| i as u8 + 1)] {
            assert_eq!(decode_png(&encode_png(&picture).expect("encoded")).expect("decoded"), picture);
        }
    }

    #[test]
    fn a_film_comes_back_through_a_file() {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.png");
        let mut film = Film::new(3, 2);
        film.color = (0..6).map(|i| [i as f32 / 5.0, 0.5, 1.0, 1.0]).collect();
        write_png(&path, &film).expect("written");
        assert_eq!(read_png(&path).expect("read"), Picture::from(&film));
    }

    #[test]
    fn cut_and_foreign_bytes_are_errors() {
        let bytes = encode_png(&ramp(|_| 255)).expect("encoded");
        for end in 0..bytes.len() - 12 {
            assert!(decode_png(&bytes[..end]).is_err(), "cut at {end}");
        }
        assert!(decode_png(b"GIF89a").is_err());
    }
}
