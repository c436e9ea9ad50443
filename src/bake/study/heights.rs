//! Which pieces pass left of a point, found among those at its height alone.

use super::super::region::Region;
use super::elements::is_horizontal;

/// Buckets of v at most.
const MAX_BUCKETS: usize = 256;

/// Pieces by height.
pub(super) struct Heights<'a> {
    region: &'a Region,
    buckets: Vec<Vec<u32>>,
}

impl<'a> Heights<'a> {
    pub(super) fn new(region: &'a Region) -> Self {
        let count = (region.pieces.len() / 4).clamp(1, MAX_BUCKETS);
        let mut buckets = vec![Vec::new(); count];
        for (index, piece) in region.pieces.iter().enumerate().filter(|(_, piece)| !is_horizontal(piece)) {
            for bucket in bucket_of(piece.low[1], count)..=bucket_of(piece.high[1], count) {
                buckets[bucket].push(index as u32);
            }
        }
        Self { region, buckets }
    }

    /// Whether an odd number of the pieces that `counts` passes left of the point.
    pub(super) fn is_odd_left(&self, point: [f32; 2], counts: impl Fn(u32) -> bool) -> bool {
        let [u, v] = point;
        let passes = |&&index: &&u32| {
            let piece = &self.region.pieces[index as usize];
            if !(piece.low[1] <= v && v < piece.high[1] && counts(index)) {
                return false;
            }
            let [least, greatest] = piece.range(0);
            u >= greatest || u >= least && self.region.solve(piece, 1, v).1 <= u
        };
        let bucket = &self.buckets[bucket_of(v, self.buckets.len())];
        bucket.iter().filter(passes).count() % 2 == 1
    }
}

fn bucket_of(v: f32, count: usize) -> usize {
    ((v * count as f32) as usize).min(count - 1)
}
