//! What the steps of the second stage of a bake take.

use std::iter::Sum;
use std::ops::Add;
use std::time::Instant;

/// Seconds. The first three are sums over threads, of which all work at once.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct BakeTimes {
    /// Grids, kd-trees, segments and bands of the trims.
    pub trim_trees: f64,
    /// B-splines cut into Bézier nets.
    pub nets: f64,
    /// Nets cut into leaves with their bounds.
    pub leaves: f64,
    /// The trees over the primitives of each part and over the instances.
    pub bvhs: f64,
}

impl Add for BakeTimes {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            trim_trees: self.trim_trees + other.trim_trees,
            nets: self.nets + other.nets,
            leaves: self.leaves + other.leaves,
            bvhs: self.bvhs + other.bvhs,
        }
    }
}

impl Sum for BakeTimes {
    fn sum<I: Iterator<Item = Self>>(times: I) -> Self {
        times.fold(Self::default(), Add::add)
    }
}

/// The result of some work, and the seconds that it took.
pub(super) fn timed<T>(work: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let result = work();
    (result, start.elapsed().as_secs_f64())
}
