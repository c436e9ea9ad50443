//! Tiles of a picture to the whole: the bytes are those of the whole rendered at once.

use super::exr::{self, Layered};
use super::files::ImageError;
use super::png::{Samples, Tile};
use super::{DeepPicture, Picture, Window};
use ::exr::prelude::FlatSamples;

/// Why tiles make no picture.
#[derive(Debug, thiserror::Error)]
pub enum MergeError {
    /// A tile cannot be read, or the picture not encoded.
    #[error(transparent)]
    Image(#[from] ImageError),
    /// A tile of another picture.
    #[error("tile {0} is of another picture than the first: size, depth or layers differ")]
    Foreign(usize),
    /// Two tiles have the same pixel.
    #[error("tile {0} overlaps another")]
    Overlap(usize),
    /// Pixels that no tile has.
    #[error("{0} pixels are in no tile")]
    Missing(usize),
    /// There is no tile.
    #[error("there is nothing to merge")]
    Nothing,
}

/// The bytes of the PNG file whose parts are `tiles`, by bytes.
pub fn merge_png(tiles: &[Vec<u8>]) -> Result<Vec<u8>, MergeError> {
    let tiles = tiles.iter().map(|bytes| Tile::decode(bytes)).collect::<Result<Vec<_>, _>>()?;
    let first = tiles.first().ok_or(MergeError::Nothing)?;
    let shape = |tile: &Tile| (tile.whole, tile.depth);
    if let Some(other) = tiles.iter().position(|tile| shape(tile) != shape(first)) {
        return Err(MergeError::Foreign(other));
    }
    let [width, height] = first.whole;
    cover(tiles.iter().map(|tile| tile.window), first.whole)?;
    let mut pixels = vec![[0_u16; 4]; width * height];
    for tile in &tiles {
        paste(&mut pixels, width, &tile.pixels, tile.window);
    }
    Ok(match first.depth {
        super::BitDepth::Eight => {
            let pixels = pixels.into_iter().map(|pixel| pixel.map(|code| code as u8)).collect();
            Samples::of_picture(&Picture { width, height, pixels }, false).encode(None)?
        }
        super::BitDepth::Sixteen => {
            Samples::of_deep_picture(&DeepPicture { width, height, pixels }, false).encode(None)?
        }
    })
}

/// The bytes of the EXR file whose parts are `tiles`, by bytes.
pub fn merge_exr(tiles: &[Vec<u8>]) -> Result<Vec<u8>, MergeError> {
    let tiles = tiles.iter().map(|bytes| exr::decode(bytes)).collect::<Result<Vec<_>, _>>()?;
    let first = tiles.first().ok_or(MergeError::Nothing)?;
    let kinds = |tile: &Layered| -> Vec<(String, std::mem::Discriminant<FlatSamples>)> {
        tile.channels.iter().map(|(name, samples)| (name.clone(), std::mem::discriminant(samples))).collect()
    };
    let is_foreign = |tile: &Layered| {
        tile.whole != first.whole || tile.attributes != first.attributes || kinds(tile) != kinds(first)
    };
    if let Some(other) = tiles.iter().position(is_foreign) {
        return Err(MergeError::Foreign(other));
    }
    let [width, height] = first.whole;
    cover(tiles.iter().map(|tile| tile.window), first.whole)?;
    let channels = first.channels.iter().enumerate().map(|(index, (name, samples))| {
        let parts = tiles.iter().map(|tile| (tile.window, &tile.channels[index].1));
        let whole = match samples {
            FlatSamples::F16(_) => FlatSamples::F16(joined(parts, first.whole, |s| {
                if let FlatSamples::F16(s) = s { s } else { &[] }
            })),
            FlatSamples::F32(_) => FlatSamples::F32(joined(parts, first.whole, |s| {
                if let FlatSamples::F32(s) = s { s } else { &[] }
            })),
            FlatSamples::U32(_) => FlatSamples::U32(joined(parts, first.whole, |s| {
                if let FlatSamples::U32(s) = s { s } else { &[] }
            })),
        };
        (name.clone(), whole)
    });
    let channels = channels.collect();
    let attributes = first.attributes.clone();
    Ok(exr::encode(&Layered {
        window: Window::whole(width, height),
        whole: first.whole,
        channels,
        attributes,
    })?)
}

fn joined<'t, T: Copy + Default + 't>(
    parts: impl Iterator<Item = (Window, &'t FlatSamples)>,
    [width, height]: [usize; 2],
    samples: impl Fn(&'t FlatSamples) -> &'t [T],
) -> Vec<T> {
    let mut whole = vec![T::default(); width * height];
    for (window, part) in parts {
        paste(&mut whole, width, samples(part), window);
    }
    whole
}

/// Puts the samples of a window where they belong.
fn paste<T: Copy>(whole: &mut [T], width: usize, part: &[T], window: Window) {
    for (y, row) in part.chunks_exact(window.width).enumerate() {
        let start = (window.top + y) * width + window.left;
        whole[start..start + window.width].copy_from_slice(row);
    }
}

/// Checks that the windows cover all pixels, each once.
fn cover(windows: impl Iterator<Item = Window>, [width, height]: [usize; 2]) -> Result<(), MergeError> {
    let mut taken = vec![false; width * height];
    for (tile, window) in windows.enumerate() {
        for y in window.top..window.top + window.height {
            for pixel in &mut taken[y * width + window.left..][..window.width] {
                if std::mem::replace(pixel, true) {
                    return Err(MergeError::Overlap(tile));
                }
            }
        }
    }
    match taken.iter().filter(|taken| !**taken).count() {
        0 => Ok(()),
        missing => Err(MergeError::Missing(missing)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::exr::layered;
    use crate::image::{BitDepth, Film, Layers, encode_film};

    /// A picture and four tiles of it, the last one transparent.
    fn films() -> (Film, Vec<Film>) {
        let size = [7, 5];
        let mut whole = Film::of_window(Window::whole(7, 5), size, Layers::ALL);
        for index in 0..35 {
            let alpha = if index % 7 > 3 && index > 20 { 0.25 } else { 1.0 };
            whole.color[index] = [index as f32 / 35.0 * alpha, 0.0, 0.0, alpha];
            whole.face[index] = index as u32;
        }
        let windows = [(0, 0, 4, 3), (4, 0, 3, 3), (0, 3, 4, 2), (4, 3, 3, 2)];
        let tiles = windows.map(|(left, top, width, height)| {
            let mut tile = Film::of_window(Window { left, top, width, height }, size, Layers::ALL);
            for y in 0..height {
                for x in 0..width {
                    let from = (top + y) * 7 + left + x;
                    tile.color[y * width + x] = whole.color[from];
                    tile.face[y * width + x] = whole.face[from];
                }
            }
            tile
        });
        (whole, tiles.to_vec())
    }

    #[test]
    fn merged_tiles_are_the_whole_byte_for_byte() {
        let (whole, tiles) = films();
        for depth in [BitDepth::Eight, BitDepth::Sixteen] {
            let encoded: Vec<Vec<u8>> =
                tiles.iter().map(|tile| encode_film(tile, depth).expect("a tile")).collect();
            assert!(merge_png(&encoded).expect("merged") == encode_film(&whole, depth).expect("a picture"));
        }
        let names = vec!["a".to_owned()];
        let encode = |film: &Film| exr::encode(&layered(film, &names)).expect("encoded");
        let encoded: Vec<Vec<u8>> = tiles.iter().map(encode).collect();
        assert!(merge_exr(&encoded).expect("merged") == encode(&whole));
    }

    #[test]
    fn tiles_that_make_no_picture_are_refused() {
        let (whole, tiles) = films();
        let encode = |film: &Film| encode_film(film, BitDepth::Eight).expect("encoded");
        let all: Vec<Vec<u8>> = tiles.iter().map(encode).collect();
        assert!(matches!(merge_png(&all[1..]), Err(MergeError::Missing(12))));
        let twice = [all.clone(), all[..1].to_vec()].concat();
        assert!(matches!(merge_png(&twice), Err(MergeError::Overlap(4))));
        let deep =
            [all[..3].to_vec(), vec![encode_film(&tiles[3], BitDepth::Sixteen).expect("encoded")]].concat();
        assert!(matches!(merge_png(&deep), Err(MergeError::Foreign(3))));
        assert!(matches!(merge_png(&[]), Err(MergeError::Nothing)));
        assert!(merge_png(&[encode(&whole)]).expect("a whole is a tile too") == encode(&whole));
    }
}
