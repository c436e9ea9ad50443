//! The gaps between faces along their common edges.
//!
//! Each face's trim bounds how far an edge is from its image on the face's surface. Two faces of an edge both hold to the
//! edge, so they are apart by the sum of their two bounds at most: a certificate that needs no look at the two faces
//! together. Where more than two faces meet in an edge, the two worst of them count.

use super::Draft;
use crate::brep::{Diagnostic, Diagnostics, Edge, Id, Model, Severity};
use crate::scene::EdgeGap;

/// Gaps above this share of the smaller face are worth a warning: a picture shows them.
const WIDE: f64 = 1e-3;

/// What the faces of one edge add up to.
#[derive(Debug, Clone, Copy, Default)]
struct Meeting {
    faces: u32,
    /// The two greatest bounds, millimetres.
    bounds: [f64; 2],
    /// The size of the smallest face, millimetres.
    size: f64,
}

impl Meeting {
    fn add(&mut self, bound: f64, size: f64) {
        self.size = if self.faces == 0 { size } else { self.size.min(size) };
        self.faces += 1;
        let [first, second] = self.bounds;
        self.bounds = if bound > first { [bound, first] } else { [first, second.max(bound)] };
    }

    /// A bound of the gap, where faces meet.
    fn gap(&self) -> Option<f64> {
        (self.faces >= 2).then_some(self.bounds[0] + self.bounds[1])
    }
}

/// The largest gap of the model; warns of those that show.
pub(super) fn report(findings: &mut Diagnostics, model: &Model, drafts: &[Draft]) -> Option<EdgeGap> {
    let mut widest: Option<EdgeGap> = None;
    let mut meetings = vec![Meeting::default(); model.edges.len()];
    for outline in drafts.iter().filter_map(|draft| draft.outline.as_ref().ok()) {
        for deviation in &outline.edges {
            meetings[deviation.edge.index()].add(deviation.distance, outline.size);
        }
    }
    for (index, meeting) in meetings.iter().enumerate() {
        let Some(distance) = meeting.gap() else { continue };
        let entity = model.edges[Id::<Edge>::new(index)].entity;
        if widest.is_none_or(|widest| distance > widest.distance) {
            widest = Some(EdgeGap { entity, distance });
        }
        if distance > WIDE * meeting.size {
            let reason = format!("its faces are up to {distance:.1e} mm apart");
            findings.push(Diagnostic::new(Severity::Warning, entity, "EDGE_CURVE", reason));
        }
    }
    widest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_two_worst_faces_count() {
        let mut meeting = Meeting::default();
        meeting.add(0.25, 8.0);
        assert_eq!(meeting.gap(), None);
        meeting.add(0.5, 4.0);
        assert_eq!(meeting.gap(), Some(0.75));
        meeting.add(0.375, 6.0);
        assert_eq!(meeting.gap(), Some(0.875));
        assert_eq!(meeting.size, 4.0);
    }
}
