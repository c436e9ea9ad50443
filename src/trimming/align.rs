//! Straight images that belong on one line of constant parameter.

use super::outline::Outline;
use super::segment::{end, set_end, set_start, start, with_axis};
use super::target::Target;

/// Gives straight images of constant `axis` that differ by less than the tolerance, whole periods apart, one value: the
/// sides of rectangles become exact, and so do the two sides of a seam and the edges of a B-spline's domain.
pub(super) fn align_constants(outlines: &mut [Outline], target: &Target, axis: usize) {
    let period = target.periods[axis];
    let images = || outlines.iter().enumerate().flat_map(|(i, o)| (0..o.images.len()).map(move |j| (i, j)));
    let mut entries: Vec<Entry> = Vec::new();
    for (i, j) in images() {
        let segments = &outlines[i].images[j].segments;
        if let [segment] = segments.as_slice()
            && start(segment)[axis] == end(segment)[axis]
        {
            let value = start(segment)[axis];
            let middle = 0.5 * (start(segment) + end(segment));
            let width = target.tolerance / target.metric(middle)[axis].max(1e-300);
            entries.push(Entry { value, width, image: Some((i, j)), turns: 0.0 });
        }
    }
    if entries.is_empty() {
        return;
    }
    let anchors = [target.domain.min[axis], target.domain.max[axis]];
    for value in
        anchors.into_iter().filter(|value| value.is_finite()).take(if period.is_some() { 1 } else { 2 })
    {
        entries.push(Entry { value, width: f64::INFINITY, image: None, turns: 0.0 });
    }
    if let Some(period) = period {
        // Half a period below the anchor, so that values around the anchor stay together.
        let base = target.domain.min[axis] - 0.5 * period;
        for entry in &mut entries {
            entry.turns = ((entry.value - base) / period).floor();
            entry.value -= entry.turns * period;
        }
    }
    entries.sort_by(|a, b| a.value.total_cmp(&b.value));
    for cluster in entries.chunk_by(are_together) {
        let leader = leader(cluster);
        for entry in cluster {
            let Some((outline, image)) = entry.image else { continue };
            let value = leader + entry.turns * period.unwrap_or(0.0);
            let image = &mut outlines[outline].images[image];
            let segment = &mut image.segments[0];
            let (a, b) = (start(segment), end(segment));
            if a[axis] != value {
                let steepest = [a, 0.5 * (a + b), b].map(|p| target.metric(p)[axis]);
                let steepest = steepest.into_iter().fold(0.0, f64::max);
                image.deviation += (value - a[axis]).abs() * steepest;
            }
            set_start(segment, with_axis(a, axis, value));
            set_end(segment, with_axis(b, axis, value));
        }
    }
}

/// Whether two neighbours, in order, are one value. Two ends of a domain are not, however thin it is.
fn are_together(low: &Entry, high: &Entry) -> bool {
    let width = low.width.min(high.width);
    width.is_finite() && high.value - low.value <= 2.0 * width
}

/// The value of all of a cluster.
fn leader(cluster: &[Entry]) -> f64 {
    cluster.iter().find(|entry| entry.image.is_none()).unwrap_or(&cluster[0]).value
}

struct Entry {
    value: f64,
    /// How far the value may move; infinite for ends of the domain, to which images move.
    width: f64,
    image: Option<(usize, usize)>,
    turns: f64,
}

#[cfg(test)]
mod tests {
    use super::*;

    fn image(value: f64) -> Entry {
        Entry { value, width: 1e-7, image: Some((0, 0)), turns: 0.0 }
    }

    fn end(value: f64) -> Entry {
        Entry { value, width: f64::INFINITY, image: None, turns: 0.0 }
    }

    /// Beside the end where it lies, however few others there are: that the domain's ends are neighbours in order makes them no one value.
    #[test]
    fn an_image_a_rounding_beyond_the_domain_moves_to_its_own_end() {
        for beyond in [1.0_f64.next_down(), 1.0, 1.0_f64.next_up(), 1.0 + 1e-7] {
            let mut entries = [end(0.0), end(1.0), image(beyond)];
            entries.sort_by(|a, b| a.value.total_cmp(&b.value));
            let leaders: Vec<f64> = entries.chunk_by(are_together).map(leader).collect();
            assert_eq!(leaders, [0.0, 1.0], "{beyond}");
        }
        let entries = [end(0.0), image(0.5), image(0.5 + 1e-7), end(1.0)];
        let leaders: Vec<f64> = entries.chunk_by(are_together).map(leader).collect();
        assert_eq!(leaders, [0.0, 0.5, 1.0]);
    }
}
