//! A slow tracer in f64 that knows what it knows: the hits of a ray, or that they cannot be told within a tolerance.
//!
//! It looks at every face without a tree, and at every net by subdivision of its Bernstein coefficients, so that it shares neither
//! bounds, nor leaves, nor starts with the tracers that it judges. Analytic carriers are the tracers' own closed forms in f64; analytic
//! truth is what checks those. A ray is *certain* unless somewhere on its way, by less than [`TOLERANCE`] of a face's size, or what f32 rounds in
//! sums of its degree, the ray would touch a carrier it misses or miss one it meets, or a hit would pass a trim curve or the end of a surface. Nor is
//! it certain where a closed body has an odd number of hits.

mod isolate;
mod widened;

pub use widened::widened;

use super::cpu::NO_NET;
use super::cpu::analytic::{Span, carrier_normal, carrier_parameters, carrier_roots};
use super::cpu::bernstein::{net_degrees, net_jet};
use super::cpu::cover::to_window;
use super::cpu::frames::{FaceFrame, Kernel};
use super::cpu::hit::{body_of, finish_hit};
use super::cpu::parity::odd_bodies;
use super::cpu::ray_space::{
    Distance, GridStep, PartRay, apply_rows, approach_frame, approach_point, enter_instance, prepare,
};
use super::cpu::trace::{Certainty, RawHit, face_parameters};
use super::cpu::trim::trim_inside;
use super::cpu::vector::Vector3;
use super::{Hit, Ray};
use crate::numeric::Aabb;
use crate::scene::{FaceKind, Net, Scene};
use glam::DVec3;
use isolate::{System, isolate};

/// Of a face's size: what f32 leaves of a position, with its rounding steps (`2⁻²¹`).
pub const TOLERANCE: f64 = 1.0 / 2_097_152.0;

/// Of parameter intervals: twice the overlap of neighbouring nets and windows.
const PARAMETER_TOLERANCE: f64 = 2.0 / 1_048_576.0;

/// A hit on a net that the tolerance leaves open by more of the net's parameters than this is not certain: where the ray meets the net at about a ten-thousandth,
/// it stays so near to it on both sides that a tracer may meet it several times.
const MOST_OPEN: f64 = 1.0 / 256.0;

/// A hit that is certain.
#[derive(Debug, Clone, Copy)]
pub struct ExpectedHit {
    /// The hit.
    pub hit: Hit,
    /// Size of the net or of the carrier's piece that was hit, millimetres.
    pub size: f64,
    /// |cos| of the angle between the ray and the normal.
    pub facing: f64,
    /// Millimetres per unit of each of the hit's surface parameters.
    pub lengths: [f64; 2],
    /// After which the surface parameters say the same again; 0: never.
    pub period: [f64; 2],
}

/// A scene that has its f64 arrays, made ready.
#[derive(Debug)]
pub struct Reference<'a> {
    scene: Scene<'a>,
    parts: Vec<Contents>,
}

/// What a part is made of.
#[derive(Debug, Default)]
struct Contents {
    /// Indices of analytic faces and their sizes.
    faces: Vec<(u32, f64)>,
    /// Its nets.
    nets: Vec<NetContent>,
}

/// A net of a part.
#[derive(Debug)]
struct NetContent {
    index: u32,
    /// The box of its control points, face space.
    bounds: Aabb,
    /// What f32 leaves of its points, of its size.
    tolerance: f64,
}

/// A hit on its way.
struct Candidate {
    raw: RawHit<f64>,
    size: f64,
    facing: f64,
    /// Millimetres per normalised unit of the face's parameters.
    lengths: [f64; 2],
    front: bool,
    /// On the border of a net: a hit only if the net next to it has it too.
    on_border: bool,
}

impl<'a> Reference<'a> {
    /// Makes a scene ready, which has to have its f64 arrays.
    pub fn new(scene: Scene<'a>) -> Self {
        let mut parts: Vec<Contents> = scene.parts.iter().map(|_| Contents::default()).collect();
        for (index, face) in (0..).zip(scene.faces) {
            if face.kind != FaceKind::Nets as u32 {
                let size = carrier_size(&f64::face(&scene, index));
                parts[face.part as usize].faces.push((index, size));
            }
        }
        for (index, net) in (0..).zip(scene.nets) {
            let points = net_points(&scene, net).iter().map(|p| DVec3::new(p[0], p[1], p[2]) / p[3]);
            let part = scene.faces[net.face as usize].part;
            let (bounds, tolerance) = (Aabb::around(points), net_tolerance(&scene, net));
            parts[part as usize].nets.push(NetContent { index, bounds, tolerance });
        }
        Self { scene, parts }
    }

    /// The scene that it traces.
    pub fn scene(&self) -> &Scene<'a> {
        &self.scene
    }

    /// The hits of a ray by distance, or `None` where they are not certain. The ray has to start outside the scene's sphere.
    pub fn trace(&self, ray: &Ray) -> Option<Vec<ExpectedHit>> {
        let header = self.scene.header;
        let Some(prepared) = prepare::<f64>(ray, header) else { return Some(Vec::new()) };
        let mut found = Vec::new();
        for index in 0..self.scene.instances.len() as u32 {
            let instance = f64::instance(&self.scene, index);
            let (may_meet, part_ray) = enter_instance(&prepared.ray, &instance, GridStep::of(header));
            if !may_meet {
                continue;
            }
            let contents = &self.parts[self.scene.instances[index as usize].part as usize];
            for &(face, size) in &contents.faces {
                self.meet_face(&part_ray, index, face, size, &mut found)?;
            }
            for net in &contents.nets {
                self.meet_net(&part_ray, index, net, &mut found)?;
            }
        }
        found.sort_by(|a, b| a.raw.distance.to_f64().total_cmp(&b.raw.distance.to_f64()));
        let kept = merge_borders(found)?;
        if !odd_bodies(&self.scene, kept.iter().map(|c| body_of(&self.scene, &c.raw))).is_empty() {
            return None;
        }
        let expected = |c: &Candidate| {
            let face = c.raw.face as usize;
            let unit = self.scene.face_infos[face].uv_size;
            ExpectedHit {
                hit: finish_hit(&self.scene, &c.raw, prepared.start),
                size: c.size,
                facing: c.facing,
                lengths: [0, 1].map(|k| c.lengths[k] / unit[k]),
                period: [0, 1].map(|k| f64::from(self.scene.faces[face].period[k]) * unit[k]),
            }
        };
        Some(kept.iter().map(expected).collect())
    }

    /// Hits of an analytic face.
    fn meet_face(
        &self,
        part_ray: &PartRay<f64>,
        instance: u32,
        index: u32,
        size: f64,
        found: &mut Vec<Candidate>,
    ) -> Option<()> {
        let step = GridStep::of(self.scene.header);
        let face = f64::face(&self.scene, index);
        let ray = approach_frame(part_ray, &face, step);
        let (origin, direction) = (apply_rows(&face.axes, ray.origin), apply_rows(&face.axes, ray.direction));
        let unit = direction * (1.0 / direction.length());
        let tolerance = TOLERANCE * size + step.size * f64::from(f32::EPSILON);
        let roots = carrier_roots(face.kind, origin, direction, face.radii, &Span::whole());
        let changed = |by: f64| {
            let mut radii = face.radii;
            radii[usize::from(face.kind == FaceKind::Torus as u32)] += by;
            carrier_roots(face.kind, origin, direction, radii, &Span::whole()).count
        };
        if changed(tolerance) != roots.count || changed(-tolerance) != roots.count {
            return None;
        }
        for i in 0..roots.count {
            let point = origin + direction * roots.t[i];
            let parameters = carrier_parameters(face.kind, point, face.radii);
            let normal = carrier_normal(face.kind, parameters, face.radii).dot(unit);
            let slack = tolerance.max(2.0 * face.slack) / normal.abs();
            let lengths = parameter_lengths(&face, parameters);
            let margins = [0, 1].map(|k| slack / lengths[k] + PARAMETER_TOLERANCE / face.uv_scale[k].abs());
            // At an apex or along the surface what is beside the hit is everywhere.
            if !(0..2).all(|k| margins[k] * face.uv_scale[k].abs() < 0.5) {
                return None;
            }
            let inside = |du: f64, dv: f64| {
                let at = [0, 1].map(|k| {
                    let by = [du, dv][k] * margins[k];
                    to_window((parameters[k] + by - face.uv_low[k]) * face.uv_scale[k], face.period[k])
                });
                (self.is_on_face(index, at), at)
            };
            let (is_inside, uv) = inside(0.0, 0.0);
            if !all_alike(is_inside, |du, dv| inside(du, dv).0) {
                return None;
            }
            if is_inside {
                let distance = Distance { anchor: ray.anchor, offset: roots.t[i] };
                let raw = RawHit {
                    distance,
                    instance,
                    face: index,
                    net: NO_NET,
                    uv,
                    certainty: Certainty::Certain,
                    is_shallow: false,
                };
                let (facing, front) = (normal.abs(), normal < 0.0);
                let lengths = [0, 1].map(|k| lengths[k] / face.uv_scale[k].abs());
                found.push(Candidate { raw, size, facing, lengths, front, on_border: false });
            }
        }
        Some(())
    }

    /// Hits of a net.
    fn meet_net(
        &self,
        part_ray: &PartRay<f64>,
        instance: u32,
        content: &NetContent,
        found: &mut Vec<Candidate>,
    ) -> Option<()> {
        let scene = &self.scene;
        let NetContent { index, ref bounds, tolerance } = *content;
        let step = GridStep::of(scene.header);
        let net = &scene.nets[index as usize];
        let face = &scene.faces[net.face as usize];
        let ray = approach_point(part_ray, face.grid, Vector3::from_f64(bounds.center().to_array()), step);
        let size = bounds.diagonal();
        let tolerance = tolerance * size + step.size * f64::from(f32::EPSILON);
        let (origin, direction) = (ray.origin.to_f64(), ray.direction.to_f64().normalize());
        if passes_by(&bounds.grown(2.0 * tolerance.max(face.slack.into())), origin, direction) {
            return Some(());
        }
        let near = tolerance.max(f64::from(face.slack));
        let roots = isolate(&system(scene, net, origin, direction), near, PARAMETER_TOLERANCE)?;
        for root in roots {
            let uv = root.to_array();
            let jet = net_jet(scene, net, ray.origin, uv);
            let vector = |p: [f64; 4]| DVec3::new(p[0], p[1], p[2]);
            let from_origin = vector(jet.value) / jet.value[3];
            let slope = |d: [f64; 4]| (vector(d) - from_origin * d[3]) / jet.value[3];
            let (by_u, by_v) = (slope(jet.by_u), slope(jet.by_v));
            let cross = by_u.cross(by_v);
            let normal = cross.normalize_or_zero().dot(direction);
            let slack = tolerance.max(2.0 * f64::from(face.slack)) / normal.abs() / cross.length();
            let margins = [slack * by_v.length(), slack * by_u.length()].map(|m| m + PARAMETER_TOLERANCE);
            let across = tolerance / normal.abs() / cross.length();
            if !(across * by_u.length().max(by_v.length()) < MOST_OPEN) {
                return None;
            }
            let inside = |du: f64, dv: f64| {
                let at = [uv[0] + du * margins[0], uv[1] + dv * margins[1]];
                self.is_on_face(net.face, face_parameters(net, face.period, at))
            };
            let is_inside = inside(0.0, 0.0);
            if !all_alike(is_inside, inside) {
                return None;
            }
            if is_inside {
                let t = from_origin.dot(direction) / ray.direction.to_f64().length();
                let distance = Distance { anchor: ray.anchor, offset: t };
                let near_end = |k: usize| uv[k] < margins[k] || uv[k] > 1.0 - margins[k];
                let raw = RawHit {
                    distance,
                    instance,
                    face: net.face,
                    net: index,
                    uv,
                    certainty: Certainty::Certain,
                    is_shallow: false,
                };
                let (facing, front, on_border) = (normal.abs(), normal < 0.0, near_end(0) || near_end(1));
                let lengths = [0, 1].map(|k| [by_u, by_v][k].length() / f64::from(net.uv_size[k]));
                found.push(Candidate { raw, size, facing, lengths, front, on_border });
            }
        }
        Some(())
    }
}

impl Reference<'_> {
    /// Whether wrapped normalised parameters belong to a face.
    fn is_on_face(&self, face: u32, uv: [f64; 2]) -> bool {
        let root = self.scene.faces[face as usize].trim_root;
        uv.iter().all(|x| (0.0..=1.0).contains(x)) && trim_inside(&self.scene, root, uv)
    }
}

/// Whether a surrounding says the same as its middle. It is looked at in places, a quarter of its width apart, because a face may be narrower
/// than the surrounding.
fn all_alike(middle: bool, inside: impl Fn(f64, f64) -> bool) -> bool {
    const SIDES: [f64; 5] = [-1.0, -0.5, 0.0, 0.5, 1.0];
    let around = SIDES.iter().flat_map(|&u| SIDES.iter().map(move |&v| (u, v)));
    around.filter(|&(u, v)| u != 0.0 || v != 0.0).all(|(u, v)| inside(u, v) == middle)
}

/// Leaves one of the hits that neighbouring nets share; `None` where one net alone has a hit on its border.
fn merge_borders(found: Vec<Candidate>) -> Option<Vec<Candidate>> {
    let mut kept: Vec<Candidate> = Vec::with_capacity(found.len());
    // By index in `kept`: whether another net has the hit as well.
    let mut shared: Vec<bool> = Vec::with_capacity(found.len());
    for candidate in found {
        let same = |other: &Candidate| {
            let apart = candidate.raw.distance.minus(other.raw.distance).abs();
            other.on_border
                && candidate.on_border
                && other.raw.face == candidate.raw.face
                && other.raw.instance == candidate.raw.instance
                && other.front == candidate.front
                && apart <= 4.0 * TOLERANCE * candidate.size / candidate.facing.max(1e-3)
        };
        match kept.iter().rposition(same) {
            Some(known) => shared[known] = true,
            None => {
                kept.push(candidate);
                shared.push(false);
            }
        }
    }
    kept.iter().zip(shared).all(|(hit, shared)| shared || !hit.on_border).then_some(kept)
}

/// Of a net's size: what f32 leaves of its points. The sums of Bernstein terms over both parameters round by up to `(2 (m + n) + 3) u` (Higham 2002,
/// section 5.1, for each parameter; u = 2⁻²⁴), those of a rational net twice, in its numerators and in its denominator.
fn net_tolerance(scene: &Scene<'_>, net: &Net) -> f64 {
    let (u, v) = net_degrees(net);
    let is_rational = net_points(scene, net).iter().any(|point| point[3] != 1.0);
    let sums = if is_rational { 2 } else { 1 };
    let rounding = (sums * (2 * (u + v) + 3)) as f64 * 0.5 * f64::from(f32::EPSILON);
    rounding.max(TOLERANCE)
}

/// The control points of a net.
fn net_points<'a>(scene: &Scene<'a>, net: &Net) -> &'a [[f64; 4]] {
    let (u, v) = net_degrees(net);
    &scene.net_points_f64[net.first_point as usize..][..(u + 1) * (v + 1)]
}

/// The distances of a net's points from two planes through the ray that are at right angles.
fn system(scene: &Scene<'_>, net: &Net, origin: DVec3, direction: DVec3) -> System {
    let (first, second) = direction.any_orthonormal_pair();
    let points = net_points(scene, net);
    let distances = |n: DVec3| {
        points.iter().map(|p| DVec3::new(p[0], p[1], p[2]).dot(n) - p[3] * origin.dot(n)).collect()
    };
    let (u, v) = net_degrees(net);
    System {
        degrees: [u, v],
        functions: [distances(first), distances(second)],
        weights: points.iter().map(|p| p[3]).collect(),
    }
}

/// Whether a line misses a box.
fn passes_by(bounds: &Aabb, origin: DVec3, direction: DVec3) -> bool {
    let inverse = direction.recip();
    let (a, b) = ((bounds.min - origin) * inverse, (bounds.max - origin) * inverse);
    // Where 0 · ∞ makes no number, minimum and maximum take the other one.
    let (low, high) = (a.min(b), a.max(b));
    !(low.max_element() <= high.min_element()) && low.is_finite() && high.is_finite()
}

/// The farthest that a face's carrier gets from its frame's origin within the trim window: what f32 rounds there.
fn carrier_size(face: &FaceFrame<f64>) -> f64 {
    let ends = |k: usize| face.uv_low[k].abs().max((face.uv_low[k] + 1.0 / face.uv_scale[k]).abs());
    let [first, second] = face.radii.map(f64::abs);
    match face.kind {
        kind if kind == FaceKind::Plane as u32 => ends(0).hypot(ends(1)),
        kind if kind == FaceKind::Cylinder as u32 => first.hypot(ends(1)),
        kind if kind == FaceKind::Cone as u32 => (first + second * ends(1)).hypot(ends(1)),
        _ => first + second,
    }
}

/// Millimetres per unit of the parameters of an analytic carrier.
fn parameter_lengths(face: &FaceFrame<f64>, [_, v]: [f64; 2]) -> [f64; 2] {
    let [first, second] = face.radii;
    match face.kind {
        kind if kind == FaceKind::Plane as u32 => [1.0, 1.0],
        kind if kind == FaceKind::Cylinder as u32 => [first, 1.0],
        kind if kind == FaceKind::Cone as u32 => [(first + second * v).abs(), 1.0],
        kind if kind == FaceKind::Sphere as u32 => [first * v.cos(), first],
        _ => [(first + second * v.cos()).abs(), second],
    }
}
