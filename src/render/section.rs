//! Sections: the half-spaces that a picture is cut down to.

use glam::DVec3;

/// Planes of one section at most.
pub const MAX_PLANES: usize = 6;

/// The half-space `normal · p <= offset` of model space.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SectionPlane {
    /// Unit vector towards what is cut away.
    pub normal: DVec3,
    /// Millimetres.
    pub offset: f64,
}

/// The convex region that is kept: all of space where there is no plane.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Section {
    planes: [SectionPlane; MAX_PLANES],
    count: usize,
    /// Whether closed bodies show a filled cut, and not their inside.
    pub caps: bool,
}

impl Section {
    /// The region behind all `planes`; `None` where they are more than [`MAX_PLANES`].
    pub fn new(planes: &[SectionPlane], caps: bool) -> Option<Self> {
        let mut section = Self { count: planes.len(), caps, ..Self::default() };
        section.planes.get_mut(..planes.len())?.copy_from_slice(planes);
        Some(section)
    }

    /// The planes.
    pub fn planes(&self) -> &[SectionPlane] {
        &self.planes[..self.count]
    }

    /// Whether nothing is cut.
    pub fn is_empty(&self) -> bool {
        self.count == 0
    }

    /// Whether a point is kept, or cut away by less than `margin`.
    pub fn keeps(&self, point: DVec3, margin: f64) -> bool {
        self.planes().iter().all(|plane| plane.normal.dot(point) <= plane.offset + margin)
    }
}
