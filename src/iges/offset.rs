//! Offset curves (130) and offset surfaces (140): exact where lines, circles and elementary surfaces stay what they are, else fitted.

use super::curve::{self, Piece};
use super::directory::{Directory, Mapped, Parameters};
use super::placement::is_similarity;
use super::surface::Sheet;
use crate::geometry::{Curve, Offset, Surface, fit_curve, offset_surface};
use glam::{DAffine3, DVec2, DVec3};

/// Offsets are fitted this closely, as a share of the size of what they are offset from.
const TOLERANCE: f64 = 1e-8;

/// An offset that cannot be fitted within this share of its size is not used.
const LIMIT: f64 = 1e-4;

/// How the distance runs along the curve.
enum Distance {
    Constant(f64),
    /// From the first value to the second one between two parameters of the curve.
    Linear {
        values: [f64; 2],
        range: [f64; 2],
    },
}

impl Distance {
    fn at(&self, own: f64) -> f64 {
        match self {
            Self::Constant(distance) => *distance,
            Self::Linear { values: [a, b], range: [first, last] } => {
                a + (b - a) * (own - first) / (last - first)
            }
        }
    }
}

/// Entity 130: base curve, how the distance varies (1 not at all, 2 linearly, 3 by a function), the function and its coordinate,
/// what it is a function of (1 arc length, 2 parameter), two distances each with where it holds, the normal N of the curve's
/// plane, the range of the parameter. The offset lies along N × T. In the entity's own space.
pub fn pieces(file: &Directory, parameters: &Parameters, depth: usize) -> Mapped<Vec<Piece>> {
    let base = curve::pieces_within(file, parameters.reference(1)?, depth)?;
    let normal = parameters.direction(10, DVec3::Z)?;
    let distance = match parameters.integer(2)? {
        0 | 1 => Distance::Constant(parameters.real(6)?),
        2 => {
            let values = [parameters.real(6)?, parameters.real(8)?];
            let range = [parameters.real(7)?, parameters.real(9)?];
            let by_parameter = parameters.integer(5)? != 1;
            let even = |piece: &Piece| matches!(piece.curve, Curve::Line { .. } | Curve::Circle { .. });
            match base.as_slice() {
                _ if !(range[0] < range[1]) => {
                    return Err(parameters.problem("the distance has no range"));
                }
                _ if by_parameter => Distance::Linear { values, range },
                // Along these the parameter is in proportion to the arc length.
                [piece] if even(piece) => {
                    let length = length(piece);
                    let own = |arc: f64| piece.own[0] + arc / length * (piece.own[1] - piece.own[0]);
                    Distance::Linear { values, range: range.map(own) }
                }
                _ => return Err(parameters.problem("the distance varies with the arc length")),
            }
        }
        _ => return Err(parameters.problem("the distance varies by a function")),
    };
    let wanted = [parameters.real(13)?, parameters.real(14)?];
    let mut pieces = Vec::with_capacity(base.len());
    let mut at = base.first().map_or(0.0, |piece| piece.own[0]);
    for piece in base {
        let own = [at, at + piece.own[1] - piece.own[0]];
        at = own[1];
        let clipped =
            if wanted[0] < wanted[1] { [own[0].max(wanted[0]), own[1].min(wanted[1])] } else { own };
        if clipped[0] < clipped[1] {
            let share = |t: f64| (t - own[0]) / (own[1] - own[0]);
            let range = clipped.map(|t| piece.range[0] + share(t) * (piece.range[1] - piece.range[0]));
            let piece = Piece { range, own: clipped, ..piece };
            let moved = offset(&piece, normal, &distance);
            let moved =
                moved.ok_or_else(|| parameters.problem("there is no smooth curve at this distance"))?;
            pieces.push(Piece { entity: parameters.entity, ..moved });
        }
    }
    Ok(pieces)
}

fn length(piece: &Piece) -> f64 {
    match &piece.curve {
        Curve::Circle { radius, .. } => radius * (piece.range[1] - piece.range[0]).abs(),
        _ => piece.ends()[0].distance(piece.ends()[1]),
    }
}

fn offset(piece: &Piece, normal: DVec3, distance: &Distance) -> Option<Piece> {
    if let Distance::Constant(distance) = distance {
        match &piece.curve {
            Curve::Line { origin, direction } => {
                let forward = *direction * (piece.range[1] - piece.range[0]).signum();
                let side = normal.cross(forward).try_normalize()?;
                let curve = Curve::Line { origin: *origin + side * *distance, direction: *direction };
                return Some(Piece { curve, ..piece.clone() });
            }
            Curve::Circle { frame, radius } if frame.z.cross(normal).length() < 1e-9 => {
                // Seen along the normal a counter-clockwise arc has its centre on the left.
                let turns = frame.z.dot(normal) * (piece.range[1] - piece.range[0]);
                let radius = radius - distance * turns.signum();
                let curve = Curve::Circle { frame: *frame, radius };
                return (radius > 0.0).then(|| Piece { curve, ..piece.clone() });
            }
            _ => {}
        }
    }
    let [first, last] = piece.range;
    let point = |share: f64| {
        let d = piece.curve.derivatives(first + share * (last - first));
        let forward = d.first * (last - first).signum();
        let side = normal.cross(forward).try_normalize()?;
        let own = piece.own[0] + share * (piece.own[1] - piece.own[0]);
        Some(d.point + side * distance.at(own)).filter(|p| p.is_finite())
    };
    let breaks = piece.curve.breaks(piece.range).into_iter().map(|t| (t - first) / (last - first));
    let breaks: Vec<f64> = [0.0].into_iter().chain(breaks).chain([1.0]).collect();
    let size = piece.reach();
    let fit = fit_curve(&breaks, point, TOLERANCE * size).filter(|fit| fit.deviation <= LIMIT * size)?;
    Some(Piece { curve: Curve::Bspline(fit.curve), range: [0.0, 1.0], ..piece.clone() })
}

/// Entity 140: a vector that shows the side, the distance, the surface. `basis` is that surface, in place, and `given` the same in the form in which the
/// file gives it, if that is another: where its middle is, a recognised form does not know.
pub fn sheet(
    parameters: &Parameters,
    basis: Sheet,
    given: Option<&Sheet>,
    place: &DAffine3,
) -> Mapped<Sheet> {
    if !is_similarity(place) {
        return Err(parameters.problem("the matrix of an offset surface skews it"));
    }
    let distance = parameters.real(4)? * place.matrix3.determinant().abs().cbrt();
    let indicator = place.transform_vector3(parameters.point(1)?);
    let given = given.unwrap_or(&basis);
    let turned = if basis.flipped == given.flipped { 1.0 } else { -1.0 };
    let along = match turned * normal(&given.surface).map_or(0.0, |normal| normal.dot(indicator)) {
        side if side < 0.0 => -distance,
        side if side > 0.0 => distance,
        // Nothing shows the side: that of the file's normal.
        _ if basis.flipped => -distance,
        _ => distance,
    };
    let size = match &basis.surface {
        Surface::Bspline(spline) => spline.size(),
        _ => 0.0,
    };
    let offset = offset_surface(&basis.surface, along, TOLERANCE * size);
    let Offset { surface, deviation } = offset
        .filter(|offset| offset.deviation <= LIMIT * size)
        .ok_or_else(|| parameters.problem("there is no smooth surface at this distance"))?;
    Ok(Sheet { surface, deviation: basis.deviation + deviation, ..basis })
}

/// The normal in the middle, or elsewhere where it has none there.
fn normal(surface: &Surface) -> Option<DVec3> {
    let domain = surface.domain();
    let finite = |value: f64, instead: f64| if value.is_finite() { value } else { instead };
    let low = DVec2::new(finite(domain.min.x, 0.0), finite(domain.min.y, 0.0));
    let high = DVec2::new(finite(domain.max.x, 1.0), finite(domain.max.y, 1.0));
    [0.5, 0.4, 0.7].into_iter().find_map(|share| {
        let d = surface.derivatives(low + (high - low) * share);
        d.du.cross(d.dv).try_normalize()
    })
}
