//! How much two image files differ, channel by channel: PNG files in shares of the greatest code, EXR files in their own numbers.

use super::exr;
use super::files::ImageError;
use super::png::Tile;
use super::{Film, Window, heat_color};
use ::exr::prelude::FlatSamples;

/// The numbers of an image file.
#[derive(Debug, Clone, PartialEq)]
pub struct Numbers {
    /// Pixels across.
    pub width: usize,
    /// Pixels down.
    pub height: usize,
    /// Names, sorted, and as many numbers as pixels.
    pub channels: Vec<(String, Vec<f64>)>,
}

impl Numbers {
    /// Of the bytes of a PNG file: R, G, B and A of 0 to 1.
    pub fn of_png(bytes: &[u8]) -> Result<Self, ImageError> {
        let tile = Tile::decode(bytes)?;
        let full = tile.depth.greatest_code();
        let channel = |(k, name): (usize, &str)| {
            let numbers = tile.pixels.iter().map(|pixel| f64::from(pixel[k]) / f64::from(full)).collect();
            (name.to_owned(), numbers)
        };
        // In the order of their names, as EXR files have them.
        let channels = [(3, "A"), (2, "B"), (1, "G"), (0, "R")].map(channel);
        let Window { width, height, .. } = tile.window;
        Ok(Self { width, height, channels: channels.to_vec() })
    }

    /// Of the bytes of an EXR file of one part.
    pub fn of_exr(bytes: &[u8]) -> Result<Self, ImageError> {
        let layered = exr::decode(bytes)?;
        let numbers = |samples: FlatSamples| match samples {
            FlatSamples::F16(samples) => samples.into_iter().map(|x| x.to_f64()).collect(),
            FlatSamples::F32(samples) => samples.into_iter().map(f64::from).collect(),
            FlatSamples::U32(samples) => samples.into_iter().map(f64::from).collect(),
        };
        let channels = layered.channels.into_iter().map(|(name, samples)| (name, numbers(samples)));
        let Window { width, height, .. } = layered.window;
        Ok(Self { width, height, channels: channels.collect() })
    }
}

/// How two images differ.
#[derive(Debug, Clone, PartialEq)]
pub struct ImageDifference {
    /// Pixels compared.
    pub pixels: usize,
    /// Pixels of which some channel differs by more than the tolerance.
    pub outliers: usize,
    /// By channel.
    pub channels: Vec<ChannelDifference>,
    /// Of each pixel the greatest difference of any channel.
    pub worst: Vec<f64>,
}

/// How one channel differs.
#[derive(Debug, Clone, PartialEq)]
pub struct ChannelDifference {
    /// The channel's name.
    pub name: String,
    /// The greatest absolute difference; infinite where one number is infinite or none at all and the other is not the same.
    pub greatest: f64,
    /// Mean absolute difference of the pixels where it is finite.
    pub mean: f64,
    /// Pixels where it is more than the tolerance.
    pub outliers: usize,
}

/// The images have not the same pixels or channels.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum NotComparable {
    /// Sizes differ.
    #[error("one has {} by {} pixels, the other {} by {}", .0[0], .0[1], .1[0], .1[1])]
    Sizes([usize; 2], [usize; 2]),
    /// A channel of only one of them.
    #[error("only one has the channel {0}")]
    Channel(String),
}

/// Compares two images number by number.
pub fn diff(a: &Numbers, b: &Numbers, tolerance: f64) -> Result<ImageDifference, NotComparable> {
    let size = |image: &Numbers| [image.width, image.height];
    if size(a) != size(b) {
        return Err(NotComparable::Sizes(size(a), size(b)));
    }
    let has = |image: &Numbers, name: &str| image.channels.iter().any(|(other, _)| other == name);
    let alone = |of: &Numbers, other: &Numbers| {
        of.channels.iter().find(|(name, _)| !has(other, name)).map(|(name, _)| name.clone())
    };
    if let Some(name) = alone(a, b).or_else(|| alone(b, a)) {
        return Err(NotComparable::Channel(name));
    }
    let pixels = a.width * a.height;
    let mut worst = vec![0.0_f64; pixels];
    let mut channels = Vec::with_capacity(a.channels.len());
    for ((name, a), (_, b)) in a.channels.iter().zip(&b.channels) {
        let (mut greatest, mut sum, mut finite, mut outliers) = (0.0_f64, 0.0, 0_usize, 0);
        for ((&a, &b), worst) in a.iter().zip(b).zip(&mut worst) {
            let apart = distance(a, b);
            greatest = greatest.max(apart);
            *worst = worst.max(apart);
            outliers += usize::from(apart > tolerance);
            if apart.is_finite() {
                sum += apart;
                finite += 1;
            }
        }
        let mean = sum / finite.max(1) as f64;
        channels.push(ChannelDifference { name: name.clone(), greatest, mean, outliers });
    }
    let outliers = worst.iter().filter(|&&apart| apart > tolerance).count();
    Ok(ImageDifference { pixels, outliers, channels, worst })
}

/// 0 for what is the same, infinities and what is no number included.
fn distance(a: f64, b: f64) -> f64 {
    if a == b || a.is_nan() && b.is_nan() {
        return 0.0;
    }
    let apart = (a - b).abs();
    if apart.is_nan() { f64::INFINITY } else { apart }
}

impl ImageDifference {
    /// The greatest difference of any channel.
    pub fn greatest(&self) -> f64 {
        self.channels.iter().map(|channel| channel.greatest).fold(0.0, f64::max)
    }

    /// A picture `width` pixels wide of where the images differ, from black to red where they differ most.
    pub fn heat(&self, width: usize) -> Film {
        let mut film = Film::new(width, self.pixels / width.max(1));
        let finite = self.worst.iter().copied().filter(|apart| apart.is_finite());
        let full = finite.fold(0.0, f64::max);
        for (color, &apart) in film.color.iter_mut().zip(&self.worst) {
            let share = if apart.is_finite() { apart / full.max(f64::MIN_POSITIVE) } else { 1.0 };
            *color = heat_color(share as f32);
        }
        film
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(channels: &[(&str, &[f64])]) -> Numbers {
        let channels =
            channels.iter().map(|(name, numbers)| ((*name).to_owned(), numbers.to_vec())).collect();
        Numbers { width: 2, height: 2, channels }
    }

    #[test]
    fn differences_are_counted_by_channel_and_by_pixel() {
        let inf = f64::INFINITY;
        let a = numbers(&[("R", &[0.0, 0.5, 1.0, 1.0]), ("Z", &[inf, inf, 3.0, f64::NAN])]);
        let b = numbers(&[("R", &[0.0, 0.75, 1.0, 0.9]), ("Z", &[inf, 2.0, 3.0, f64::NAN])]);
        assert_eq!(diff(&a, &a, 0.0).expect("comparable").outliers, 0);
        let found = diff(&a, &b, 0.2).expect("comparable");
        assert_eq!((found.pixels, found.outliers, found.greatest()), (4, 1, inf));
        let [r, z] = &found.channels[..] else { panic!("two channels") };
        assert_eq!((r.greatest, r.outliers), (0.25, 1));
        assert!((r.mean - 0.35 / 4.0).abs() < 1e-12);
        assert_eq!((z.greatest, z.mean, z.outliers), (inf, 0.0, 1));
        let heat = found.heat(2);
        assert_eq!([heat.color[0], heat.color[1]], [heat_color(0.0), heat_color(1.0)]);
        assert_eq!(heat.color[3], heat_color(1.0), "the greatest that is finite");
    }

    #[test]
    fn other_sizes_and_channels_are_told() {
        let a = numbers(&[("R", &[0.0; 4])]);
        let b = numbers(&[("G", &[0.0; 4])]);
        assert_eq!(diff(&a, &b, 0.0), Err(NotComparable::Channel("R".into())));
        let c = Numbers { width: 4, height: 1, ..a.clone() };
        assert_eq!(diff(&a, &c, 0.0), Err(NotComparable::Sizes([2, 2], [4, 1])));
    }
}
