//! How the rows of a picture are shared out among threads.

use std::ops::RangeInclusive;

/// Bands that each thread has, so that those with less to do take more of them.
const BANDS_PER_THREAD: usize = 8;

/// Rows in a band of a picture that is `height` high: within `allowed`, as many as leave all threads their bands.
pub fn rows_per_band(height: usize, allowed: RangeInclusive<usize>) -> usize {
    let bands = BANDS_PER_THREAD * rayon::current_num_threads();
    (height / bands).clamp(*allowed.start(), *allowed.end())
}
