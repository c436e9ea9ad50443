//! PNG: 8 or 16 bits a channel, marked as sRGB; RGB where the picture is opaque, else RGBA.
//!
//! A part of a larger picture says so in a text chunk, `trimray:window`: "left,top,width,height of width,height".

use super::files::{self, ImageError};
use super::{DeepPicture, Film, Picture, Window};
use rayon::prelude::*;
use std::path::Path;

/// More pixels than any camera has; a decoder must not believe a header.
const MAX_PIXELS: u64 = 1 << 28;

/// The keyword of the text chunk that places a part in the whole.
pub(super) const WINDOW_KEYWORD: &str = "trimray:window";

/// Bits a channel.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum BitDepth {
    /// 256 codes.
    #[default]
    Eight,
    /// 65,536 codes.
    Sixteen,
}

impl BitDepth {
    /// The code of full light and full coverage.
    pub(super) fn greatest_code(self) -> u16 {
        match self {
            Self::Eight => 255,
            Self::Sixteen => 65_535,
        }
    }
}

/// A developed picture's samples as PNG wants them.
pub(super) struct Samples {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) depth: BitDepth,
    pub(super) is_opaque: bool,
    pub(super) bytes: Vec<u8>,
}

impl Samples {
    /// Of a film; with `keep_alpha`, not opaque even where it could be.
    pub(super) fn of_film(film: &Film, depth: BitDepth, keep_alpha: bool) -> Self {
        match depth {
            BitDepth::Eight => Self::of_picture(&Picture::from(film), keep_alpha),
            BitDepth::Sixteen => Self::of_deep_picture(&DeepPicture::from(film), keep_alpha),
        }
    }

    /// Of a picture of 8 bits.
    pub(super) fn of_picture(picture: &Picture, keep_alpha: bool) -> Self {
        let is_opaque = !keep_alpha && picture.is_opaque();
        let bytes = if is_opaque {
            let colors: Vec<[u8; 3]> = picture.pixels.par_iter().map(|&[r, g, b, _]| [r, g, b]).collect();
            colors.into_flattened()
        } else {
            picture.pixels.as_flattened().to_vec()
        };
        Self { width: picture.width, height: picture.height, depth: BitDepth::Eight, is_opaque, bytes }
    }

    /// Of a picture of 16 bits.
    pub(super) fn of_deep_picture(picture: &DeepPicture, keep_alpha: bool) -> Self {
        let is_opaque = !keep_alpha && picture.is_opaque();
        let channels = if is_opaque { 3 } else { 4 };
        let codes = picture.pixels.iter().flat_map(|pixel| &pixel[..channels]);
        let bytes = codes.flat_map(|code| code.to_be_bytes()).collect();
        Self { width: picture.width, height: picture.height, depth: BitDepth::Sixteen, is_opaque, bytes }
    }

    /// An encoder of such samples.
    pub(super) fn encoder<W: std::io::Write>(&self, to: W) -> Result<png::Encoder<'static, W>, ImageError> {
        let side = |n: usize| u32::try_from(n).map_err(|_| invalid(format!("{n} pixels are too many")));
        let mut encoder = png::Encoder::new(to, side(self.width)?, side(self.height)?);
        encoder.set_depth(match self.depth {
            BitDepth::Eight => png::BitDepth::Eight,
            BitDepth::Sixteen => png::BitDepth::Sixteen,
        });
        encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
        // A twentieth of the usual time, for files that are a quarter larger: packing would be a tenth of a picture's time.
        encoder.set_compression(png::Compression::Fast);
        encoder.set_color(if self.is_opaque { png::ColorType::Rgb } else { png::ColorType::Rgba });
        Ok(encoder)
    }

    /// The bytes of a file; `part`: where they belong in a whole of a size.
    pub(super) fn encode(&self, part: Option<(Window, [usize; 2])>) -> Result<Vec<u8>, ImageError> {
        let mut bytes = Vec::new();
        let mut encoder = self.encoder(&mut bytes)?;
        if let Some((Window { left, top, width, height }, [across, down])) = part {
            let text = format!("{left},{top},{width},{height} of {across},{down}");
            encoder.add_text_chunk(WINDOW_KEYWORD.to_owned(), text).map_err(|e| invalid(e.to_string()))?;
        }
        let mut writer = encoder.write_header().map_err(|e| invalid(e.to_string()))?;
        writer.write_image_data(&self.bytes).map_err(|e| invalid(e.to_string()))?;
        writer.finish().map_err(|e| invalid(e.to_string()))?;
        Ok(bytes)
    }
}

pub(super) fn invalid(reason: String) -> ImageError {
    ImageError::Invalid { format: "PNG", reason }
}

/// Develops and writes a film in 8 bits.
pub fn write_png(path: &Path, film: &Film) -> Result<(), ImageError> {
    files::write(path, &encode_film(film, BitDepth::Eight)?)
}

/// Reads a picture.
pub fn read_png(path: &Path) -> Result<Picture, ImageError> {
    decode_png(&files::read(path)?)
}

/// The bytes of a PNG file of a film, developed.
pub fn encode_film(film: &Film, depth: BitDepth) -> Result<Vec<u8>, ImageError> {
    let window = film.window();
    let [width, height] = film.whole;
    let part = (window != Window::whole(width, height)).then_some((window, film.whole));
    Samples::of_film(film, depth, false).encode(part)
}

/// The bytes of a PNG file.
pub fn encode_png(picture: &Picture) -> Result<Vec<u8>, ImageError> {
    Samples::of_picture(picture, false).encode(None)
}

/// The picture in a PNG file of any colour type; 16 bits are cut to 8.
pub fn decode_png(bytes: &[u8]) -> Result<Picture, ImageError> {
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

/// A picture or a part of one, in its own depth.
pub(super) struct Tile {
    pub(super) window: Window,
    pub(super) whole: [usize; 2],
    pub(super) depth: BitDepth,
    /// Codes of the depth.
    pub(super) pixels: Vec<[u16; 4]>,
}

impl Tile {
    /// Of a file's bytes. Without a word about its place it is the whole.
    pub(super) fn decode(bytes: &[u8]) -> Result<Self, ImageError> {
        let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
        decoder.set_transformations(png::Transformations::EXPAND | png::Transformations::ALPHA);
        let mut reader = decoder.read_info().map_err(|e| invalid(e.to_string()))?;
        let (width, height) = reader.info().size();
        let own = [width as usize, height as usize];
        let mut texts = reader.info().uncompressed_latin1_text.iter();
        let (window, whole) = match texts.find(|chunk| chunk.keyword == WINDOW_KEYWORD) {
            Some(chunk) => {
                parse_window(&chunk.text).ok_or_else(|| invalid("its place makes no sense".to_owned()))?
            }
            None => (Window::whole(own[0], own[1]), own),
        };
        let pixels = (whole[0] as u64).saturating_mul(whole[1] as u64);
        if !window.is_within(whole) || [window.width, window.height] != own || pixels > MAX_PIXELS {
            return Err(invalid("its place makes no sense, or it is too large".to_owned()));
        }
        let size = reader.output_buffer_size().ok_or_else(|| invalid("too large".into()))?;
        let mut samples = vec![0; size];
        let frame = reader.next_frame(&mut samples).map_err(|e| invalid(e.to_string()))?;
        let samples = &samples[..frame.buffer_size()];
        let (depth, codes): (BitDepth, Vec<u16>) = if frame.bit_depth == png::BitDepth::Sixteen {
            let pairs = samples.as_chunks::<2>().0;
            (BitDepth::Sixteen, pairs.iter().map(|pair| u16::from_be_bytes(*pair)).collect())
        } else {
            (BitDepth::Eight, samples.iter().copied().map(u16::from).collect())
        };
        let pixels = match frame.color_type {
            png::ColorType::Rgba => codes.as_chunks::<4>().0.to_vec(),
            png::ColorType::GrayscaleAlpha => {
                codes.as_chunks::<2>().0.iter().map(|&[y, a]| [y, y, y, a]).collect()
            }
            other => return Err(invalid(format!("unexpected colour type {other:?}"))),
        };
        Ok(Self { window, whole, depth, pixels })
    }
}

/// The text of [`WINDOW_KEYWORD`].
fn parse_window(text: &str) -> Option<(Window, [usize; 2])> {
    let (window, whole) = text.split_once(" of ")?;
    let numbers = |text: &str| text.split(',').map(|n| n.parse().ok()).collect::<Option<Vec<usize>>>();
    match (&numbers(window)?[..], &numbers(whole)?[..]) {
        (&[left, top, width, height], &[across, down]) => {
            Some((Window { left, top, width, height }, [across, down]))
        }
        _ => None,
    }
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
