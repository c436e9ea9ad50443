//! Sections: the half-spaces that a picture is cut down to, or the corner that is cut out of it.

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

/// What several planes cut away together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum SectionMode {
    /// What is beyond any of them: the intersection of their half-spaces is kept.
    #[default]
    Each,
    /// What is beyond all of them: the union of their half-spaces is kept.
    Corner,
}

impl SectionMode {
    /// 1 where what is kept is convex, so that a ray is in it on one interval, and -1 where what is cut away is: then it is kept but for one.
    pub(super) fn sense(self) -> f64 {
        match self {
            Self::Each => 1.0,
            Self::Corner => -1.0,
        }
    }
}

/// The region that is kept: all of space where there is no plane.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Section {
    planes: [SectionPlane; MAX_PLANES],
    count: usize,
    /// What the planes cut away together.
    pub mode: SectionMode,
    /// Whether closed bodies show a filled cut, and not their inside.
    pub caps: bool,
}

impl Section {
    /// The region that `planes` leave; `None` where they are more than [`MAX_PLANES`].
    pub fn new(planes: &[SectionPlane], mode: SectionMode, caps: bool) -> Option<Self> {
        let mut section = Self { count: planes.len(), mode, caps, ..Self::default() };
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

    /// Whether planes keep nothing of the convex hull of points, one by one: of those that cut away all of it only together it is not known.
    pub fn keeps_none_of(&self, points: &[DVec3]) -> bool {
        let is_beyond = |plane: &SectionPlane| points.iter().all(|&p| plane.normal.dot(p) > plane.offset);
        match self.mode {
            SectionMode::Each => self.planes().iter().any(is_beyond),
            SectionMode::Corner => !self.is_empty() && self.planes().iter().all(is_beyond),
        }
    }

    /// Whether a point is kept, or cut away by less than `margin`.
    pub fn keeps(&self, point: DVec3, margin: f64) -> bool {
        let is_behind = |plane: &SectionPlane| plane.normal.dot(point) <= plane.offset + margin;
        match self.mode {
            SectionMode::Each => self.planes().iter().all(is_behind),
            SectionMode::Corner => self.is_empty() || self.planes().iter().any(is_behind),
        }
    }
}
