//! Extrusions and revolutions (ISO 10303-42: surface_of_linear_extrusion, surface_of_revolution).
//!
//! Those that are a plane, a cylinder, a cone, a sphere or a torus become one, exactly: a closed form has no approximation and
//! costs a ray least. All others become rational B-splines, also exactly, over the range that the face needs: an
//! extrusion has no end of its own, so the points of the face's boundary give it one.

use super::map_curve::MappedCurve;
use super::map_meridian::{conic_vertex, is_on_axis, meridian_side, one_side, turned_to};
use super::map_surface::MappedSurface;
use super::reader::{Mapped, Reader, problem, reference};
use super::value::Entity;
use crate::geometry::{Curve, Frame, Homogeneous, Surface, to_bspline};
use glam::{DVec2, DVec3};
use std::f64::consts::TAU;

/// Sines of angles below this count as parallel: directions of files have some 1e-12 of noise and more where
/// systems compute in single precision on the way, yet a recognised form off by this much moves 1 m by 1e-6 mm.
pub const PARALLEL: f64 = 1e-9;

/// What a range from boundary samples is widened by, as a part of its length: sampling misses an extreme between neighbours.
const WIDENING: f64 = 0.05;

/// `SURFACE_OF_LINEAR_EXTRUSION(name, swept curve, extrusion axis)`: `C(u) + v · axis`.
pub fn extrusion(reader: &Reader, entity: &Entity, samples: &[DVec3], depth: usize) -> Mapped<MappedSurface> {
    let record = entity.first();
    let profile = reader.curve_in_chain(reference(entity.id, record, 1)?, depth + 1)?;
    let axis = reader.vector(reference(entity.id, record, 2)?)?;
    let along = axis.normalize();
    if let Some((surface, normal_at)) = recognise_extrusion(&profile.curve, along) {
        let derivatives = profile.curve.derivatives(normal_at);
        let normal = derivatives.first.cross(along);
        return Ok(recognised(surface, derivatives.point, normal).with(profile.repairs));
    }
    let flat = |p: DVec3| project_along(&profile.curve, p, along);
    let flat_samples: Vec<DVec3> = samples.iter().map(|&p| flat(p)).collect();
    let range = profile_range(&profile, &flat_samples)
        .ok_or_else(|| problem(entity, "the face does not bound the extruded curve"))?;
    let spline = to_bspline::curve_to_bspline(&profile.curve, range);
    let heights = bounds(samples.iter().map(|p| p.dot(along)));
    let profile_heights = bounds(spline.points.iter().map(|p| p.point().dot(along)));
    let (Some(heights), Some(profile_heights)) = (heights, profile_heights) else {
        return Err(problem(entity, "the face does not bound the extrusion"));
    };
    let v_range = widened([heights[0] - profile_heights[1], heights[1] - profile_heights[0]]);
    if v_range[1] <= v_range[0] {
        return Err(problem(entity, "the face has no extent along the extrusion"));
    }
    let surface = Surface::Bspline(to_bspline::extrude(&spline, along, v_range));
    Ok(cut_to_fit(surface).with(profile.repairs))
}

/// `SURFACE_OF_REVOLUTION(name, swept curve, axis1 placement)`: `C(v)` turned by u.
pub fn revolution(
    reader: &Reader,
    entity: &Entity,
    samples: &[DVec3],
    depth: usize,
) -> Mapped<MappedSurface> {
    let record = entity.first();
    let profile = reader.curve_in_chain(reference(entity.id, record, 1)?, depth + 1)?;
    let axis = reader.placement(reference(entity.id, record, 2)?)?;
    match &profile.curve {
        Curve::Line { origin, direction } => {
            if let Some(mapped) = revolved_line(&axis, *origin, direction.normalize(), samples) {
                return Ok(mapped);
            }
        }
        Curve::Circle { frame, radius } => {
            let known = revolved_circle(&axis, frame, *radius);
            // A spindle torus has two sheets, and the circle makes both: the half of it that is meant makes one.
            let known = known.filter(|s| !matches!(s, Surface::Torus { major, minor, .. } if minor > major));
            if let Some(surface) = known {
                let side = meridian_side(&axis, &profile, frame, samples);
                let t =
                    profile.trim.map_or(side.dot(frame.y).atan2(side.dot(frame.x)), |[a, b]| 0.5 * (a + b));
                let derivatives = profile.curve.derivatives(t);
                let normal = axis.z.cross(derivatives.point - axis.origin).cross(derivatives.first);
                return Ok(recognised(surface, derivatives.point, normal));
            }
        }
        _ => {}
    }
    let range = match &profile.curve {
        Curve::Line { origin, direction } => {
            let heights = bounds(samples.iter().map(|&p| axis.local_point(p).z));
            let (start, rise) = (axis.local_point(*origin).z, direction.dot(axis.z));
            heights.map(|h| widened(h.map(|z| (z - start) / rise))).map(sorted)
        }
        curve => match conic_frame(curve) {
            Some(frame) => {
                let side = meridian_side(&axis, &profile, frame, samples);
                let vertex = conic_vertex(curve).filter(|&p| is_on_axis(&axis, p, samples));
                let turned = samples.iter().map(|&p| turned_to(&axis, p, side));
                let in_plane: Vec<DVec3> = turned.chain(vertex).collect();
                profile_range(&profile, &in_plane).map(|range| one_side(&axis, curve, range, side))
            }
            None => profile_range(&profile, samples),
        },
    };
    let range = range
        .filter(|r| r[1] > r[0] && r[0].is_finite() && r[1].is_finite())
        .ok_or_else(|| problem(entity, "the face does not bound the revolved curve"))?;
    let spline = to_bspline::curve_to_bspline(&profile.curve, range);
    Ok(cut_to_fit(Surface::Bspline(to_bspline::revolve(&spline, &axis))).with(profile.repairs))
}

fn cut_to_fit(surface: Surface) -> MappedSurface {
    MappedSurface { keeps_parameters: false, fits_one_face: true, ..MappedSurface::plain(surface) }
}

/// A recognised surface; `normal` is that of the file's surface at `point`.
fn recognised(surface: Surface, point: DVec3, normal: DVec3) -> MappedSurface {
    let flipped = outward_normal(&surface, point).dot(normal) < 0.0;
    MappedSurface { flipped, keeps_parameters: false, ..MappedSurface::plain(surface) }
}

/// The direction of `S_u × S_v` at a point of a recognised surface.
fn outward_normal(surface: &Surface, point: DVec3) -> DVec3 {
    match surface {
        Surface::Plane { frame } => frame.z,
        Surface::Cylinder { frame, .. } => radial(frame, point),
        Surface::Cone { frame, half_angle, .. } => {
            radial(frame, point) * half_angle.cos() - frame.z * half_angle.sin()
        }
        Surface::Sphere { frame, .. } => point - frame.origin,
        Surface::Torus { frame, major, .. } => point - (frame.origin + radial(frame, point) * *major),
        Surface::Bspline(_) => DVec3::ZERO,
    }
}

/// The unit vector from the axis of `frame` to `point`.
fn radial(frame: &Frame, point: DVec3) -> DVec3 {
    let local = frame.local_point(point);
    frame.vector(local.with_z(0.0)).normalize_or_zero()
}

/// A plane from a line, a cylinder from a circle along its normal; and a profile parameter to compare normals at.
pub fn recognise_extrusion(profile: &Curve, along: DVec3) -> Option<(Surface, f64)> {
    match profile {
        Curve::Line { origin, direction } => {
            let normal = direction.normalize().cross(along);
            (normal.length() > PARALLEL).then(|| {
                let frame = Frame::from_axes(*origin, Some(normal), Some(*direction));
                (Surface::Plane { frame }, 0.0)
            })
        }
        Curve::Circle { frame, radius } if frame.z.cross(along).length() < PARALLEL => {
            let frame = Frame::from_axes(frame.origin, Some(along), Some(frame.x));
            Some((Surface::Cylinder { frame, radius: *radius }, 0.0))
        }
        _ => None,
    }
}

/// A plane, cylinder or cone from a line in a plane with the axis, or across it at a right angle; `None` for a hyperboloid.
pub fn revolved_line(
    axis: &Frame,
    origin: DVec3,
    direction: DVec3,
    samples: &[DVec3],
) -> Option<MappedSurface> {
    let rise = direction.dot(axis.z);
    if rise.abs() < PARALLEL {
        // Every point of the line stays at its height, whether or not the line meets the axis.
        let centre = axis.origin + axis.z * axis.local_point(origin).z;
        let frame = Frame::from_axes(centre, Some(axis.z), Some(direction));
        // Far out along the line the surface's normal is (z × direction) × direction = −z.
        let far_side = samples.first().map_or(1.0, |&p| {
            let (local, across) = (axis.local_point(p).truncate(), axis.local_vector(direction).truncate());
            reaching_side(axis.local_point(origin).truncate(), across, local.length())
        });
        return Some(recognised(Surface::Plane { frame }, centre, -axis.z * far_side));
    }
    let local_direction = axis.local_vector(direction).truncate();
    let local_origin = axis.local_point(origin).truncate();
    let size = local_origin.length().max(1.0);
    if local_direction.length() < PARALLEL {
        let radius = local_origin.length();
        let normal = axis.z.cross(origin - axis.origin).cross(direction);
        return (radius > PARALLEL)
            .then(|| recognised(Surface::Cylinder { frame: *axis, radius }, origin, normal));
    }
    // In one plane with the axis: the shortest distance between the two lines is 0.
    let distance = local_origin.perp_dot(local_direction.normalize()).abs();
    if distance > PARALLEL * size {
        return None;
    }
    // The point of the line at the height of the face's middle, so that the frame lies on the face's half of the cone.
    let heights = bounds(samples.iter().map(|&p| axis.local_point(p).z)).unwrap_or([0.0; 2]);
    let middle = 0.5 * (heights[0] + heights[1]);
    let point = origin + direction * ((middle - axis.local_point(origin).z) / rise);
    let local = axis.local_point(point);
    let radius = local.truncate().length();
    let outwards = local.truncate().normalize_or(local_direction.normalize());
    let half_angle = (local_direction.dot(outwards) / rise).atan();
    let frame = Frame::from_axes(axis.origin + axis.z * local.z, Some(axis.z), Some(axis.x));
    let reference =
        if radius > 0.0 { point } else { axis.origin + axis.z * local.z + axis.vector(outwards.extend(0.0)) };
    let normal = axis.z.cross(reference - axis.origin).cross(direction);
    Some(recognised(Surface::Cone { frame, radius, half_angle }, reference, normal))
}

/// On which side of its foot point the line `origin + s · across` reaches `radius`: the side that the parameter 0 lies on decides.
fn reaching_side(origin: DVec2, across: DVec2, radius: f64) -> f64 {
    let foot = -origin.dot(across);
    let half_chord = (radius * radius - origin.perp_dot(across).powi(2)).max(0.0).sqrt();
    // Of the two solutions foot ± half_chord the one nearer to the line's own origin is the drawn half.
    if (foot + half_chord).abs() <= (foot - half_chord).abs() { 1.0 } else { -1.0 }
}

/// A sphere or a torus from a circle in a plane with the axis.
pub fn revolved_circle(axis: &Frame, circle: &Frame, radius: f64) -> Option<Surface> {
    let centre = axis.local_point(circle.origin);
    let size = radius.max(centre.length());
    let axis_in_plane = circle.z.dot(axis.z).abs() < PARALLEL
        && (circle.origin - axis.origin).dot(circle.z).abs() < PARALLEL * size;
    let major = centre.truncate().length();
    let frame = Frame { origin: axis.origin + axis.z * centre.z, ..*axis };
    if major < PARALLEL * size && circle.z.dot(axis.z).abs() < PARALLEL {
        return Some(Surface::Sphere { frame, radius });
    }
    axis_in_plane.then_some(Surface::Torus { frame, major, minor: radius })
}

/// `point` moved along `direction` into the plane of a conic; where it is for other curves.
fn project_along(profile: &Curve, point: DVec3, direction: DVec3) -> DVec3 {
    match conic_frame(profile) {
        Some(frame) if direction.dot(frame.z).abs() > PARALLEL => {
            point - direction * ((point - frame.origin).dot(frame.z) / direction.dot(frame.z))
        }
        _ => point,
    }
}

/// The frame of a conic; `None` for other curves.
pub fn conic_frame(curve: &Curve) -> Option<&Frame> {
    match curve {
        Curve::Circle { frame, .. }
        | Curve::Ellipse { frame, .. }
        | Curve::Parabola { frame, .. }
        | Curve::Hyperbola { frame, .. } => Some(frame),
        Curve::Line { .. } | Curve::Bspline(_) => None,
    }
}

/// The piece of the profile that is needed: its trim, its period, its domain, or what `samples` in its plane reach.
fn profile_range(profile: &MappedCurve, samples: &[DVec3]) -> Option<[f64; 2]> {
    match &profile.curve {
        Curve::Line { .. } => None,
        Curve::Circle { .. } | Curve::Ellipse { .. } => Some(sorted(profile.trim.unwrap_or([0.0, TAU]))),
        Curve::Parabola { .. } | Curve::Hyperbola { .. } if samples.is_empty() => profile.trim.map(sorted),
        Curve::Parabola { frame, focal } => {
            let y = bounds(samples.iter().map(|&p| frame.local_point(p).y))?;
            Some(widened(y.map(|y| y / (2.0 * focal))))
        }
        Curve::Hyperbola { frame, radii } => {
            let y = bounds(samples.iter().map(|&p| frame.local_point(p).y))?;
            Some(widened(y.map(|y| (y / radii[1]).asinh())))
        }
        Curve::Bspline(spline) => Some(spline.domain()),
    }
}

fn bounds(values: impl Iterator<Item = f64>) -> Option<[f64; 2]> {
    let mut range: Option<[f64; 2]> = None;
    for value in values.filter(|v| v.is_finite()) {
        let [low, high] = range.unwrap_or([value; 2]);
        range = Some([low.min(value), high.max(value)]);
    }
    range
}

fn sorted([a, b]: [f64; 2]) -> [f64; 2] {
    [a.min(b), a.max(b)]
}

fn widened([low, high]: [f64; 2]) -> [f64; 2] {
    let margin = WIDENING * (high - low);
    [low - margin, high + margin]
}
