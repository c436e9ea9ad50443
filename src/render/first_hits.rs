//! What the samples of a pixel show first, gathered: its albedo and how much of it each part covers.

use super::cpu::shade::hit_material;
use crate::image::{RANKS, Share};
use crate::scene::Scene;
use smallvec::SmallVec;

/// The sums over a pixel's samples.
#[derive(Debug, Clone, Default)]
pub(super) struct FirstHits {
    albedo: [f32; 3],
    /// 1 + instance index, and samples; few pixels show more than two.
    parts: SmallVec<[(u32, u32); 2]>,
}

impl FirstHits {
    /// Counts a sample that shows the face of the instance; indices.
    pub(super) fn add(&mut self, scene: &Scene<'_>, instance: u32, face: u32) {
        let material = hit_material(scene, instance, face);
        for (sum, channel) in self.albedo.iter_mut().zip(material.rgb) {
            *sum += channel;
        }
        match self.parts.iter_mut().find(|(part, _)| *part == instance + 1) {
            Some((_, count)) => *count += 1,
            None => self.parts.push((instance + 1, 1)),
        }
    }

    /// The mean linear-light colour of what the samples show, without light; samples that show nothing are black.
    pub(super) fn albedo(&self, samples: u32) -> [f32; 3] {
        self.albedo.map(|sum| sum / samples as f32)
    }

    /// The parts that cover most of the pixel, the greatest share first.
    pub(super) fn shares(&self, samples: u32) -> [Share; RANKS] {
        let mut parts = self.parts.clone();
        parts.sort_by_key(|&(part, count)| (std::cmp::Reverse(count), part));
        let mut shares = [Share::default(); RANKS];
        for (share, (part, count)) in shares.iter_mut().zip(parts) {
            *share = Share { part, coverage: count as f32 / samples as f32 };
        }
        shares
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_greatest_shares_come_first_and_the_least_go() {
        let counts = [3, 1, 4, 1, 5, 9, 2, 6];
        let parts = (1..).zip(counts).collect();
        let hits = FirstHits { albedo: [8.0, 4.0, 0.0], parts };
        let shares = hits.shares(32);
        assert_eq!(shares.map(|share| share.part), [6, 8, 5, 3, 1, 7]);
        assert_eq!(shares[0].coverage, 9.0 / 32.0);
        assert_eq!(hits.albedo(16), [0.5, 0.25, 0.0]);
    }
}
