//! How much two pictures differ: a share of outliers and a mean, as a renderer's test wants it.
//!
//! Two correct renderers disagree on single pixels at silhouettes, by any amount; a wrong one disagrees on many. So the verdict is the
//! share of pixels beyond a threshold, not the greatest difference.

use super::Picture;

/// How two pictures of one size differ. Channels are compared as 8-bit codes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Share of pixels of which some channel differs by more than the threshold, 0..=1.
    pub outliers: f64,
    /// Mean absolute difference over all channels of all pixels, in codes.
    pub mean: f64,
    /// The greatest difference of any channel, in codes.
    pub greatest: u8,
}

/// The pictures are not of one size.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("pictures of {}x{} and {}x{} pixels cannot be compared", .0[0], .0[1], .1[0], .1[1])]
pub struct SizesDiffer(pub [usize; 2], pub [usize; 2]);

/// Compares pixel by pixel; differences up to `threshold` codes are no outliers.
pub fn compare(a: &Picture, b: &Picture, threshold: u8) -> Result<Difference, SizesDiffer> {
    if (a.width, a.height) != (b.width, b.height) {
        return Err(SizesDiffer([a.width, a.height], [b.width, b.height]));
    }
    let (mut outliers, mut sum, mut greatest) = (0_usize, 0_u64, 0);
    for (p, q) in a.pixels.iter().zip(&b.pixels) {
        let differences: [u8; 4] = std::array::from_fn(|channel| p[channel].abs_diff(q[channel]));
        let worst = differences.into_iter().max().unwrap_or(0);
        outliers += usize::from(worst > threshold);
        sum += differences.into_iter().map(u64::from).sum::<u64>();
        greatest = greatest.max(worst);
    }
    let pixels = a.pixels.len().max(1) as f64;
    Ok(Difference { outliers: outliers as f64 / pixels, mean: sum as f64 / (4.0 * pixels), greatest })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(width: usize, height: usize) -> Picture {
        Picture { width, height, pixels: vec![[100, 100, 100, 255]; width * height] }
    }

    #[test]
    fn a_picture_equals_itself() {
        let picture = grey(8, 5);
        let expected = Difference { outliers: 0.0, mean: 0.0, greatest: 0 };
        assert_eq!(compare(&picture, &picture, 0), Ok(expected));
    }

    #[test]
    fn one_wrong_block_is_found() {
        let a = grey(10, 10);
        let mut b = a.clone();
        for i in [0, 1, 10, 11] {
            b.pixels[i][1] += 40;
        }
        b.pixels[50][0] += 2;
        let difference = compare(&a, &b, 2).expect("same size");
        assert_eq!(difference.outliers, 0.04);
        assert_eq!(difference.greatest, 40);
        assert_eq!(difference.mean, 162.0 / 400.0);
    }

    #[test]
    fn sizes_must_agree() {
        assert_eq!(compare(&grey(2, 3), &grey(3, 2), 0), Err(SizesDiffer([2, 3], [3, 2])));
    }
}
