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
    let mut begin = 0;
    for i in 1..=entries.len() {
        let together = i < entries.len()
            && entries[i].value - entries[i - 1].value <= 2.0 * entries[i].width.min(entries[i - 1].width);
        if together {
            continue;
        }
        let cluster = &entries[begin..i];
        begin = i;
        let leader = cluster.iter().find(|e| e.image.is_none()).unwrap_or(&cluster[0]).value;
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

struct Entry {
    value: f64,
    /// How far the value may move.
    width: f64,
    image: Option<(usize, usize)>,
    turns: f64,
}
