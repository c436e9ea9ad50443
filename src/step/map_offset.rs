//! Offset surfaces (ISO 10303-42: offset_surface).

use super::map_surface::MappedSurface;
use super::reader::{Mapped, Reader, problem, real, reference};
use super::value::Entity;
use crate::geometry::{BsplineSurface, Offset, Surface, invert_surface, offset_surface};
use crate::numeric::Aabb;
use glam::DVec3;

/// Offsets of B-splines are fitted this closely, as a share of the size of the basis.
const TOLERANCE: f64 = 1e-7;

/// An offset that cannot be fitted within this share of its size is not used.
const LIMIT: f64 = 1e-4;

/// What the window of a face on its basis is widened by, as a share of its length: sampling misses an extreme between neighbours.
const WIDENING: f64 = 0.05;

impl Reader<'_> {
    /// `OFFSET_SURFACE(name, basis, distance, self intersect)`: along the normal of the basis.
    pub fn offset(&self, entity: &Entity, samples: &[DVec3], depth: usize) -> Mapped<MappedSurface> {
        let record = entity.first();
        let distance = real(entity.id, record, 2)? * self.units.millimetres;
        // What the face needs of the basis lies no farther than the distance from what it needs of the offset.
        let steps = DVec3::AXES.map(|axis| axis * distance);
        // Offsets of offsets would multiply the points with each level: from the second on, their box stands for them.
        let corners = Aabb::around(samples.iter().copied()).corners();
        let samples = if depth > 0 && !samples.is_empty() { &corners[..] } else { samples };
        let around = samples.iter().flat_map(|&p| steps.map(|step| [p + step, p - step]));
        let around: Vec<DVec3> = around.flatten().collect();
        let basis = self.map_surface(reference(entity.id, record, 1)?, &around, depth + 1)?;
        let along = if basis.flipped { -distance } else { distance };
        let size = match &basis.surface {
            Surface::Bspline(spline) => spline.size(),
            _ => 0.0,
        };
        let fit = |surface: &Surface| {
            let offset = offset_surface(surface, along, TOLERANCE * size);
            offset.filter(|offset| offset.deviation <= LIMIT * size)
        };
        let whole = fit(&basis.surface);
        let is_whole = whole.is_some();
        // A basis may have a pole or a crease where the face does not reach.
        let needed = || match &basis.surface {
            Surface::Bspline(spline) => fit(&Surface::Bspline(window(spline, &basis.surface, samples)?)),
            _ => None,
        };
        let Offset { surface, deviation } = whole
            .or_else(needed)
            .ok_or_else(|| problem(entity, "there is no smooth surface at this distance"))?;
        let fits_one_face = basis.fits_one_face || !is_whole;
        Ok(MappedSurface { surface, deviation: basis.deviation + deviation, fits_one_face, ..basis })
    }
}

/// The piece of a B-spline between the feet of `samples`; all of it along closed parameters.
fn window(spline: &BsplineSurface, surface: &Surface, samples: &[DVec3]) -> Option<BsplineSurface> {
    let domain = spline.domain();
    let feet: Vec<_> = samples.iter().map(|&p| invert_surface(surface, p, None).uv).collect();
    let range = |axis: usize| {
        if spline.closed[axis] {
            return [domain.min[axis], domain.max[axis]];
        }
        let low = feet.iter().map(|uv| uv[axis]).fold(f64::INFINITY, f64::min);
        let high = feet.iter().map(|uv| uv[axis]).fold(f64::NEG_INFINITY, f64::max);
        let margin = WIDENING * (high - low);
        [low - margin, high + margin]
    };
    spline.piece(range(0), range(1))
}
