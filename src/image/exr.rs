//! OpenEXR: the whole film in one part, linear light.
//!
//! Channels, named by layer as compositing tools expect: `R G B A` in half floats (premultiplied, as OpenEXR wants it), and of the layers that the film
//! has `depth.Z` and `position.X Y Z` in millimetres, `normal.X Y Z` in world space, `uv.U V`, `mean_curvature.V` in 1/mm and
//! `gaussian_curvature.V` in 1/mm² (single values, that is how Blender takes numbers that are neither colour nor vector), `albedo.R G B` in half
//! floats, `id.part` and `id.face` as u32 (1 + index, 0 where nothing is hit), those of Cryptomatte, `edges.A`, what lines cover, in half floats, and
//! `trim.tests` as u32. A part of a larger picture has its place as its data window and the whole as its display window. Nuke takes what is before
//! the dot for the layer, and `depth.Z` is its own; Blender takes a last word of one letter for the component and the word before it for the pass,
//! and makes of `id` one pass of two numbers. ZIP over 16 lines: lossless for every type, the smallest of the lossless ones on rendered CAD, and read
//! everywhere.

use super::files::ImageError;
use super::{Film, Window, cryptomatte};
use exr::meta::attribute::{AttributeValue, IntegerBounds};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, ImageAttributes, Layer,
    LayerAttributes, LineOrder, ReadChannels, ReadLayers, Text, Vec2, WritableImage, f16,
};

/// Samples of more pixels than any camera has are not read.
const MAX_PIXELS: usize = 1 << 28;

/// The channels of a file and where they belong.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Layered {
    /// The place of the samples in the whole.
    pub(super) window: Window,
    /// Pixels across and down of the whole.
    pub(super) whole: [usize; 2],
    /// Names, sorted, and samples.
    pub(super) channels: Vec<(String, FlatSamples)>,
    /// Text attributes, sorted.
    pub(super) attributes: Vec<(String, String)>,
}

/// The bytes of a film's file; `names` are those of its parts, for Cryptomatte.
pub fn encode_exr(film: &Film, names: &[String]) -> Result<Vec<u8>, ImageError> {
    encode(&layered(film, names))
}

/// The channels of a film.
pub(super) fn layered(film: &Film, names: &[String]) -> Layered {
    let mut channels = Channels(Vec::new());
    channels.add("", ["R", "G", "B", "A"], &film.color, |samples| FlatSamples::F16(half(samples)));
    channels.add("albedo.", ["R", "G", "B"], &film.albedo, |samples| FlatSamples::F16(half(samples)));
    channels.add("normal.", ["X", "Y", "Z"], &film.normal, FlatSamples::F32);
    channels.add("position.", ["X", "Y", "Z"], &film.position, FlatSamples::F32);
    channels.add("uv.", ["U", "V"], &film.uv, FlatSamples::F32);
    channels.add("", ["mean_curvature.V", "gaussian_curvature.V"], &film.curvature, FlatSamples::F32);
    channels.add_one("depth.Z", FlatSamples::F32(film.depth.clone()));
    channels.add_one("id.part", FlatSamples::U32(film.part.clone()));
    channels.add_one("id.face", FlatSamples::U32(film.face.clone()));
    channels.add_one("edges.A", FlatSamples::F16(half(film.lines.clone())));
    channels.add_one("trim.tests", FlatSamples::U32(film.trim_tests.clone()));
    let mut attributes = Vec::new();
    if !film.matte.is_empty() {
        for (name, samples) in cryptomatte::channels(&film.matte, names) {
            channels.add_one(&name, FlatSamples::F32(samples));
        }
        attributes = cryptomatte::attributes(names);
    }
    let Channels(mut channels) = channels;
    channels.sort_by(|a, b| a.0.cmp(&b.0));
    attributes.sort();
    Layered { window: film.window(), whole: film.whole, channels, attributes }
}

fn half(samples: Vec<f32>) -> Vec<f16> {
    samples.into_iter().map(f16::from_f32).collect()
}

struct Channels(Vec<(String, FlatSamples)>);

impl Channels {
    fn add<const N: usize>(
        &mut self,
        layer: &str,
        names: [&str; N],
        pixels: &[[f32; N]],
        samples: impl Fn(Vec<f32>) -> FlatSamples,
    ) {
        for (k, name) in names.into_iter().enumerate() {
            self.add_one(&format!("{layer}{name}"), samples(pixels.iter().map(|pixel| pixel[k]).collect()));
        }
    }

    /// Adds a channel, unless it is of a layer that the film has not.
    fn add_one(&mut self, name: &str, samples: FlatSamples) {
        if samples.len() > 0 {
            self.0.push((name.to_owned(), samples));
        }
    }
}

/// The bytes of a file.
pub(super) fn encode(layered: &Layered) -> Result<Vec<u8>, ImageError> {
    let Window { left, top, width, height } = layered.window;
    let channels = layered.channels.iter();
    let channels = channels.map(|(name, samples)| AnyChannel::new(name.as_str(), samples.clone())).collect();
    let mut attributes =
        LayerAttributes { software_name: Some("trimray".into()), ..LayerAttributes::default() };
    attributes.layer_position = Vec2(left as i32, top as i32);
    for (name, text) in &layered.attributes {
        let name = Text::new_or_none(name).ok_or_else(|| invalid(format!("`{name}` names no attribute")))?;
        let text = Text::new_or_none(text).ok_or_else(|| invalid(format!("{name} is no Latin-1 text")))?;
        attributes.other.insert(name, AttributeValue::Text(text));
    }
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let layer = Layer::new((width, height), attributes, encoding, AnyChannels::sort(channels));
    let [across, down] = layered.whole;
    let image = Image::new(ImageAttributes::new(IntegerBounds::from_dimensions((across, down))), layer);
    let mut bytes = std::io::Cursor::new(Vec::new());
    image.write().to_buffered(&mut bytes).map_err(|e| invalid(e.to_string()))?;
    let mut bytes = bytes.into_inner();
    sort_attributes(&mut bytes);
    Ok(bytes)
}

/// The channels in a file of one part.
pub(super) fn decode(bytes: &[u8]) -> Result<Layered, ImageError> {
    let image = exr::prelude::read()
        .no_deep_data()
        .largest_resolution_level()
        .all_channels()
        .first_valid_layer()
        .all_attributes()
        .from_buffered(std::io::Cursor::new(bytes))
        .map_err(|e| invalid(e.to_string()))?;
    let bounds = image.attributes.display_window;
    let layer = image.layer_data;
    let Vec2(left, top) = layer.attributes.layer_position - bounds.position;
    let whole = [bounds.size.width(), bounds.size.height()];
    let place =
        |at: i32| usize::try_from(at).map_err(|_| invalid("its data lie outside of its window".into()));
    let window = Window {
        left: place(left)?,
        top: place(top)?,
        width: layer.size.width(),
        height: layer.size.height(),
    };
    if !window.is_within(whole) || whole[0].saturating_mul(whole[1]) > MAX_PIXELS {
        return Err(invalid("its data lie outside of its window, or it is too large".into()));
    }
    let texts = layer.attributes.other.iter().chain(&image.attributes.other);
    let mut attributes: Vec<(String, String)> = texts
        .filter_map(|(name, value)| match value {
            AttributeValue::Text(text) => Some((name.to_string(), text.to_string())),
            _ => None,
        })
        .collect();
    attributes.sort();
    let channels = layer.channel_data.list.into_iter();
    let channels = channels.map(|channel| (channel.name.to_string(), channel.sample_data)).collect();
    Ok(Layered { window, whole, channels, attributes })
}

fn invalid(reason: String) -> ImageError {
    ImageError::Invalid { format: "EXR", reason }
}

/// Sorts the attributes of a file of one part by name: the crate writes some of them in an order that changes from run to run. Nothing else in the file
/// depends on their order.
fn sort_attributes(bytes: &mut [u8]) {
    const FIRST: usize = 8;
    let text_end = |from: usize| bytes[from..].iter().position(|&b| b == 0).map(|length| from + length);
    let mut attributes: Vec<Vec<u8>> = Vec::new();
    let mut at = FIRST;
    while bytes.get(at).is_some_and(|&b| b != 0) {
        let Some(size_at) = text_end(at).and_then(|end| text_end(end + 1)).map(|end| end + 1) else { return };
        let Some(size) = bytes[size_at..].first_chunk::<4>() else { return };
        let end = size_at + 4 + u32::from_le_bytes(*size) as usize;
        attributes.push(bytes[at..end].to_vec());
        at = end;
    }
    attributes.sort();
    bytes[FIRST..at].copy_from_slice(&attributes.concat());
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Layers, Share};

    fn film() -> Film {
        let whole = [40, 30];
        let window = Window { left: 2, top: 5, width: 37, height: 21 };
        let mut film = Film::of_window(window, whole, Layers::ALL);
        film.trim_tests = (0..37 * 21).collect();
        film.lines = (0..37 * 21).map(|i| i as f32 / 777.0).collect();
        for i in 0..film.color.len() {
            let x = i as f32 / 777.0;
            film.color[i] = [x, 1.0 - x, 4.0 * x, 1.0];
            film.albedo[i] = [x, 0.5, 0.25];
            film.normal[i] = [x, -x, 1.0];
            film.position[i] = [x, -1000.0 * x, 1e6];
            film.uv[i] = [x, -x];
            film.curvature[i] = [1.0 / (x - 0.5), 1e-9 * x];
            film.part[i] = i as u32 * 5_000_000;
            film.face[i] = u32::MAX - i as u32;
            film.matte[i][0] = Share { part: 1 + i as u32 % 2, coverage: x };
            if i % 3 > 0 {
                film.depth[i] = 1000.0 / (x + 0.1);
            }
        }
        film
    }

    fn names() -> Vec<String> {
        vec!["Achse Ø10".to_owned(), "колесо".to_owned()]
    }

    #[test]
    fn every_channel_comes_back_in_its_own_type() {
        let film = film();
        let expected = layered(&film, &names());
        let found = decode(&encode(&expected).expect("encoded")).expect("decoded");
        assert_eq!(found.channels.len(), 4 + 3 + 3 + 3 + 2 + 2 + 1 + 2 + 1 + 1 + 12);
        assert_eq!(found.attributes.len(), 4);
        assert!(found == expected);
        let channel = |name: &str| &found.channels.iter().find(|(n, _)| n == name).expect("a channel").1;
        assert!(*channel("depth.Z") == FlatSamples::F32(film.depth.clone()));
        assert!(*channel("id.face") == FlatSamples::U32(film.face.clone()));
        assert!(*channel("G") == FlatSamples::F16(film.color.iter().map(|c| f16::from_f32(c[1])).collect()));
        assert!(
            *channel("mean_curvature.V") == FlatSamples::F32(film.curvature.iter().map(|c| c[0]).collect())
        );
        assert!(*channel("uv.V") == FlatSamples::F32(film.uv.iter().map(|uv| uv[1]).collect()));
    }

    #[test]
    fn layers_that_a_film_has_not_are_not_written() {
        let film = Film::of_window(Window::whole(4, 3), [4, 3], Layers::NONE);
        let found = decode(&encode(&layered(&film, &[])).expect("encoded")).expect("decoded");
        let names: Vec<&str> = found.channels.iter().map(|(name, _)| name.as_str()).collect();
        assert_eq!(names, ["A", "B", "G", "R"]);
    }

    /// The crate keeps attributes in maps whose order is drawn anew for each.
    #[test]
    fn the_bytes_are_the_same_each_time() {
        let layered = layered(&film(), &names());
        let first = encode(&layered).expect("encoded");
        for _ in 0..20 {
            assert!(encode(&layered).expect("encoded") == first);
        }
    }

    #[test]
    fn cut_files_are_errors() {
        let bytes = encode(&layered(&film(), &names())).expect("encoded");
        for end in (0..bytes.len()).step_by(97) {
            assert!(decode(&bytes[..end]).is_err(), "cut at {end}");
        }
    }
}
