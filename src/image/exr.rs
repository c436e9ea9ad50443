//! OpenEXR: the whole film in one part, linear light.
//!
//! Channels, named by layer as compositing tools expect: `R G B A` in half floats (premultiplied, as OpenEXR wants it), `depth.Z` in
//! millimetres, `normal.X normal.Y normal.Z` in world space, `id.part` and `id.face` as u32 (1 + index, 0 where nothing is hit), and
//! `trim.tests` as u32 and `edges.A`, what lines cover, in half floats, where the film has them.
//! ZIP over 16 lines: lossless for every type, the smallest of the lossless ones on rendered CAD, and read everywhere.

use super::Film;
use super::files::{self, ImageError};
use exr::prelude::{
    AnyChannel, AnyChannels, Blocks, Compression, Encoding, FlatSamples, Image, Layer, LayerAttributes,
    LineOrder, WritableImage, f16,
};
use std::path::Path;

/// Writes a film.
pub fn write_exr(path: &Path, film: &Film) -> Result<(), ImageError> {
    files::write(path, &encode(film)?)
}

fn encode(film: &Film) -> Result<Vec<u8>, ImageError> {
    let half =
        |channel: usize| FlatSamples::F16(film.color.iter().map(|c| f16::from_f32(c[channel])).collect());
    let normal = |axis: usize| FlatSamples::F32(film.normal.iter().map(|n| n[axis]).collect());
    let mut channels = vec![
        ("R", half(0)),
        ("G", half(1)),
        ("B", half(2)),
        ("A", half(3)),
        ("depth.Z", FlatSamples::F32(film.depth.clone())),
        ("normal.X", normal(0)),
        ("normal.Y", normal(1)),
        ("normal.Z", normal(2)),
        ("id.part", FlatSamples::U32(film.part.clone())),
        ("id.face", FlatSamples::U32(film.face.clone())),
    ];
    if !film.lines.is_empty() {
        channels.push(("edges.A", FlatSamples::F16(film.lines.iter().map(|&a| f16::from_f32(a)).collect())));
    }
    if !film.trim_tests.is_empty() {
        channels.push(("trim.tests", FlatSamples::U32(film.trim_tests.clone())));
    }
    let channels = channels.into_iter().map(|(name, samples)| AnyChannel::new(name, samples)).collect();
    let attributes = LayerAttributes { software_name: Some("trimray".into()), ..LayerAttributes::default() };
    let encoding = Encoding {
        compression: Compression::ZIP16,
        blocks: Blocks::ScanLines,
        line_order: LineOrder::Increasing,
    };
    let layer = Layer::new((film.width, film.height), attributes, encoding, AnyChannels::sort(channels));
    let mut bytes = std::io::Cursor::new(Vec::new());
    Image::from_layer(layer)
        .write()
        .to_buffered(&mut bytes)
        .map_err(|e| ImageError::Invalid { format: "EXR", reason: e.to_string() })?;
    Ok(bytes.into_inner())
}

#[cfg(test)]
mod tests {
    use super::*;
    use exr::prelude::{ReadChannels, ReadLayers};

    fn film() -> Film {
        let mut film = Film::new(37, 21);
        film.trim_tests = (0..37 * 21).collect();
        film.lines = (0..37 * 21).map(|i| i as f32 / 777.0).collect();
        for i in 0..film.color.len() {
            let x = i as f32 / 777.0;
            film.color[i] = [x, 1.0 - x, 4.0 * x, 1.0];
            film.normal[i] = [x, -x, 1.0];
            film.part[i] = i as u32 * 5_000_000;
            film.face[i] = u32::MAX - i as u32;
            if i % 3 > 0 {
                film.depth[i] = 1000.0 / (x + 0.1);
            }
        }
        film
    }

    #[test]
    fn every_channel_comes_back_in_its_own_type() {
        let film = film();
        let folder = tempfile::tempdir().expect("a temporary folder");
        let path = folder.path().join("a.exr");
        write_exr(&path, &film).expect("written");
        let image = exr::prelude::read()
            .no_deep_data()
            .largest_resolution_level()
            .all_channels()
            .first_valid_layer()
            .all_attributes()
            .from_file(&path)
            .expect("read");
        let layer = image.layer_data;
        assert_eq!((layer.size.width(), layer.size.height()), (film.width, film.height));
        assert_eq!(layer.encoding.compression, Compression::ZIP16);
        let channels = &layer.channel_data.list;
        assert_eq!(channels.len(), 12);
        for channel in channels {
            let expected = match channel.name.to_string().as_str() {
                "R" => half(&film, 0),
                "G" => half(&film, 1),
                "B" => half(&film, 2),
                "A" => half(&film, 3),
                "depth.Z" => FlatSamples::F32(film.depth.clone()),
                "normal.X" => FlatSamples::F32(film.normal.iter().map(|n| n[0]).collect()),
                "normal.Y" => FlatSamples::F32(film.normal.iter().map(|n| n[1]).collect()),
                "normal.Z" => FlatSamples::F32(film.normal.iter().map(|n| n[2]).collect()),
                "id.part" => FlatSamples::U32(film.part.clone()),
                "id.face" => FlatSamples::U32(film.face.clone()),
                "edges.A" => FlatSamples::F16(film.lines.iter().map(|&a| f16::from_f32(a)).collect()),
                "trim.tests" => FlatSamples::U32(film.trim_tests.clone()),
                other => panic!("unexpected channel {other}"),
            };
            assert!(channel.sample_data == expected, "{}", channel.name);
        }
    }

    fn half(film: &Film, channel: usize) -> FlatSamples {
        FlatSamples::F16(film.color.iter().map(|c| f16::from_f32(c[channel])).collect())
    }
}
