//! B-splines that are planes, cylinders, cones, spheres or tori: closed forms have no approximation and cost a ray least.
//!
//! A net is a plane where its control points are. Everything else that is elementary is a surface of revolution whose
//! circles are iso-lines: three of them, each through three points, give the axis and three points of the profile, and
//! those tell a line along the axis, a slanted line, or a circle. What comes out is a guess until samples, more to a
//! span than its degree can pass through by chance, all lie on it.

use super::bezier::Homogeneous;
use super::bspline::BsplineSurface;
use super::frame::Frame;
use super::knots::KnotVector;
use super::surface::Surface;
use glam::{DVec2, DVec3};

/// How far a B-spline surface may be from the elementary one that it is taken for, as a share of the size of its net: that of
/// the trim tolerance, and below what files write in ten digits.
pub const RECOGNITION_TOLERANCE: f64 = 1e-7;

/// The most samples along one parameter; beyond that they are thinned out.
const MOST_SAMPLES: usize = 96;

/// Where on the domain the three circles and their three points are taken: away from poles, and apart from each other on a
/// closed circle.
const RINGS: [f64; 3] = [0.17, 0.5, 0.83];
const ON_RING: [f64; 3] = [0.06, 0.39, 0.72];

/// Radii above this multiple of the size are those of straight lines: through three points of a line and its rounding
/// errors there is a circle, too.
const LARGEST_RADIUS: f64 = 1e4;

/// A profile is the arc of a circle where it bends by more than this multiple of the tolerance: less is a line in all but name,
/// whose bend tells circles from other curves by too few digits.
const LEAST_BEND: f64 = 1e4;

/// The elementary surface from which no point of `spline` is farther than `tolerance`, and whether its normal is opposite
/// to the spline's. Parameters are not kept.
pub fn recognise(spline: &BsplineSurface, tolerance: f64) -> Option<(Surface, bool)> {
    if let Some(surface) = plane(spline, tolerance) {
        return Some((surface, false));
    }
    let surface = [0, 1].into_iter().find_map(|axis| {
        let surface = revolution(spline, axis, tolerance)?;
        samples(spline).all(|p| distance(&surface, p) <= tolerance).then_some(surface)
    })?;
    let domain = spline.domain();
    let d = spline.derivatives(domain.min + (domain.max - domain.min) * DVec2::new(0.37, 0.43));
    let flipped = outward(&surface, d.point).dot(d.du.cross(d.dv)) < 0.0;
    Some((surface, flipped))
}

fn plane(spline: &BsplineSurface, tolerance: f64) -> Option<Surface> {
    let points = || spline.points.iter().map(|p| Homogeneous::point(*p));
    let origin = points().next()?;
    let farthest =
        |measure: &dyn Fn(DVec3) -> f64| points().max_by(|a, b| measure(*a).total_cmp(&measure(*b)));
    let along = farthest(&|p| p.distance_squared(origin))? - origin;
    let across = farthest(&|p| (p - origin).cross(along).length_squared())? - origin;
    let normal = along.cross(across).try_normalize()?;
    if !points().all(|p| (p - origin).dot(normal).abs() <= tolerance) {
        return None;
    }
    // A net that is folded over has both sides up.
    let domain = spline.domain();
    let up = |share: DVec2| {
        let d = spline.derivatives(domain.min + (domain.max - domain.min) * share);
        d.du.cross(d.dv).dot(normal)
    };
    let places = [(0.5, 0.5), (0.1, 0.1), (0.9, 0.1), (0.1, 0.9), (0.9, 0.9)];
    let ups = places.map(|(u, v)| up(DVec2::new(u, v)));
    let same = ups.iter().all(|u| *u > 0.0) || ups.iter().all(|u| *u < 0.0);
    let normal = if ups[0] < 0.0 { -normal } else { normal };
    same.then(|| Surface::Plane { frame: Frame::from_axes(origin, Some(normal), Some(along)) })
}

/// The surface of revolution whose circles run along parameter `axis`, as far as three circles tell.
fn revolution(spline: &BsplineSurface, axis: usize, tolerance: f64) -> Option<Surface> {
    let domain = spline.domain();
    let at = |around: f64, along: f64| {
        let share = if axis == 0 { DVec2::new(around, along) } else { DVec2::new(along, around) };
        spline.point(domain.min + (domain.max - domain.min) * share)
    };
    let largest = LARGEST_RADIUS * spline.size();
    let circle = |points| circle_through(points).filter(|circle| circle.radius <= largest);
    let ring = |along: f64| circle(ON_RING.map(|around| at(around, along)));
    let rings = [ring(RINGS[0])?, ring(RINGS[1])?, ring(RINGS[2])?];
    let (origin, direction) = (rings[1].center, rings[1].normal);
    let profile = rings.map(|ring| DVec2::new((ring.center - origin).dot(direction), ring.radius));
    let [a, b, c] = profile;
    let frame = |height: f64| Frame::from_axes(origin + direction * height, Some(direction), None);
    if (c.x - a.x).abs() > tolerance {
        let slope = (c.y - a.y) / (c.x - a.x);
        if (a.y + slope * (b.x - a.x) - b.y).abs() <= tolerance {
            if (c.y - a.y).abs() <= tolerance {
                return Some(Surface::Cylinder { frame: frame(0.0), radius: b.y });
            }
            return Some(Surface::Cone { frame: frame(0.0), radius: b.y, half_angle: slope.atan() });
        }
    }
    let chord = (c - a).try_normalize()?;
    if (b - a).perp_dot(chord).abs() < LEAST_BEND * tolerance {
        return None;
    }
    let profile = circle(profile.map(|p| p.extend(0.0)))?;
    let (height, major) = (profile.center.x, profile.center.y);
    if major.abs() <= tolerance {
        Some(Surface::Sphere { frame: frame(height), radius: profile.radius })
    } else {
        (major > 0.0).then(|| Surface::Torus { frame: frame(height), major, minor: profile.radius })
    }
}

struct Circle {
    center: DVec3,
    normal: DVec3,
    radius: f64,
}

/// The circle through three points; none where they lie on a line.
fn circle_through([a, b, c]: [DVec3; 3]) -> Option<Circle> {
    let (p, q) = (b - a, c - a);
    let area = p.cross(q);
    let normal = area.try_normalize()?;
    let to_center = (q * p.length_squared() - p * q.length_squared()).cross(area);
    let to_center = to_center / (2.0 * area.length_squared());
    to_center.is_finite().then(|| Circle { center: a + to_center, normal, radius: to_center.length() })
}

fn distance(surface: &Surface, point: DVec3) -> f64 {
    let polar = |frame: &Frame| {
        let local = frame.local_point(point);
        (local.truncate().length(), local.z)
    };
    match surface {
        Surface::Plane { frame } => frame.local_point(point).z.abs(),
        Surface::Cylinder { frame, radius } => (polar(frame).0 - radius).abs(),
        Surface::Cone { frame, radius, half_angle } => {
            let (out, height) = polar(frame);
            ((out - radius) * half_angle.cos() - height * half_angle.sin()).abs()
        }
        Surface::Sphere { frame, radius } => (point.distance(frame.origin) - radius).abs(),
        Surface::Torus { frame, major, minor } => {
            let (out, height) = polar(frame);
            ((out - major).hypot(height) - minor).abs()
        }
        Surface::Bspline(_) => f64::INFINITY,
    }
}

/// The direction of `S_u × S_v`.
fn outward(surface: &Surface, point: DVec3) -> DVec3 {
    let radial = |frame: &Frame| frame.vector(frame.local_point(point).with_z(0.0)).normalize_or_zero();
    match surface {
        Surface::Plane { frame } => frame.z,
        Surface::Cylinder { frame, .. } => radial(frame),
        Surface::Cone { frame, half_angle, .. } => {
            radial(frame) * half_angle.cos() - frame.z * half_angle.sin()
        }
        Surface::Sphere { frame, .. } => point - frame.origin,
        Surface::Torus { frame, major, .. } => point - frame.origin - radial(frame) * *major,
        Surface::Bspline(_) => DVec3::ZERO,
    }
}

/// Points all over the surface.
fn samples(spline: &BsplineSurface) -> impl Iterator<Item = DVec3> + '_ {
    let (u, v) = (parameters(&spline.u_knots), parameters(&spline.v_knots));
    u.into_iter().flat_map(move |u| v.clone().into_iter().map(move |v| spline.point(DVec2::new(u, v))))
}

/// Parameters inside every span: two more than the degree.
fn parameters(knots: &KnotVector) -> Vec<f64> {
    let count = knots.degree() + 2;
    let all: Vec<f64> = knots
        .spans()
        .flat_map(|k| {
            let [a, b] = [knots.as_slice()[k], knots.as_slice()[k + 1]];
            (0..count).map(move |i| a + (b - a) * (i as f64 + 0.5) / count as f64)
        })
        .collect();
    let step = all.len().div_ceil(MOST_SAMPLES).max(1);
    all.into_iter().step_by(step).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Curve;
    use crate::geometry::{Homogeneous3, to_bspline};

    fn frame() -> Frame {
        Frame::from_axes(DVec3::new(5.0, -3.0, 2.0), Some(DVec3::new(1.0, 2.0, -1.0)), None)
    }

    /// `frame` turned so that its plane holds the axis.
    fn upright(frame: &Frame, origin: DVec3) -> Frame {
        Frame { origin, x: frame.x, y: frame.z, z: -frame.y }
    }

    fn revolved(profile: &Curve, range: [f64; 2]) -> BsplineSurface {
        to_bspline::revolve(&to_bspline::curve_to_bspline(profile, range), &frame())
    }

    fn line(from: [f64; 2], to: [f64; 2]) -> Curve {
        let at = |[r, z]: [f64; 2]| frame().point(DVec3::new(r, 0.0, z));
        Curve::Line { origin: at(from), direction: at(to) - at(from) }
    }

    #[test]
    fn elementary_surfaces_are_found() {
        let arc = |radius: f64, out: f64| Curve::Circle {
            frame: upright(&frame(), frame().point(DVec3::new(out, 0.0, 1.0))),
            radius,
        };
        let cases = [
            (revolved(&line([2.0, 0.0], [2.0, 7.0]), [0.0, 1.0]), "cylinder"),
            (revolved(&line([2.0, 0.0], [0.0, 7.0]), [0.0, 1.0]), "cone"),
            (revolved(&line([2.0, 1.0], [5.0, 1.0]), [0.0, 1.0]), "plane"),
            (revolved(&arc(3.0, 0.0), [-1.0, 1.5]), "sphere"),
            (revolved(&arc(1.0, 4.0), [0.3, 5.0]), "torus"),
        ];
        for (spline, kind) in cases {
            let (surface, flipped) = recognise(&spline, 1e-9).expect(kind);
            assert_eq!(surface.kind(), kind);
            for share in [DVec2::new(0.1, 0.2), DVec2::new(0.6, 0.9)] {
                let domain = spline.domain();
                let d = spline.derivatives(domain.min + (domain.max - domain.min) * share);
                assert!(distance(&surface, d.point) < 1e-12, "{kind}");
                let agrees = outward(&surface, d.point).dot(d.du.cross(d.dv)) > 0.0;
                assert_eq!(agrees, !flipped, "{kind}");
            }
        }
    }

    #[test]
    fn others_stay_what_they_are() {
        let mut spline = revolved(&line([2.0, 0.0], [2.0, 7.0]), [0.0, 1.0]);
        spline.points[3] += Homogeneous3::new(1e-3, 0.0, 0.0, 0.0);
        assert_eq!(recognise(&spline, 1e-6), None);
        let ellipse = Curve::Ellipse { frame: frame(), radii: [3.0, 2.9] };
        let tube =
            to_bspline::extrude(&to_bspline::curve_to_bspline(&ellipse, [0.0, 6.0]), frame().z, [0.0, 4.0]);
        assert_eq!(recognise(&tube, 1e-6), None);
        let parabola = Curve::Parabola { frame: frame(), focal: 0.5 };
        let sheet =
            to_bspline::extrude(&to_bspline::curve_to_bspline(&parabola, [-1.0, 1.0]), frame().z, [0.0, 4.0]);
        assert_eq!(recognise(&sheet, 1e-6), None);
    }

    #[test]
    fn a_line_beside_its_axis_makes_no_torus() {
        // A line that neither meets the axis nor runs along it sweeps a hyperboloid; a short one bends by less than any tolerance of
        // a circle's radius can tell.
        for tilt in [0.3, 0.03, 0.01] {
            let origin = frame().point(DVec3::new(5.0, 0.0, 0.0));
            let direction = frame().vector(DVec3::new(0.1, tilt, 1.0));
            let surface = revolved(&Curve::Line { origin, direction }, [0.0, 2.0]);
            assert_eq!(recognise(&surface, 1e-6).map(|(surface, _)| surface.kind()), None, "{tilt}");
        }
    }
}
