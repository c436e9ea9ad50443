//! Sections on a ray: what of it is kept, and what the cut shows.
//!
//! Planes leave an interval of a ray, or all but one where they cut out a corner. Where the ray comes back to what is kept, on a plane and within a closed
//! body, the body's cap is seen. It is within a body if the nearest of the body's hits beyond leads out of it: bodies are asked in the order of their
//! nearest hits, until one says so or none is left. Hits of a body that is settled no longer count, so that faces which both claim a hit on their
//! common edge do no harm; and what is nearer to the plane than rays keep off surfaces counts as on it, so that a face in the plane is cut, not seen.
//! Instances that are uncut are seen wherever they are and have no caps.

use super::frames::grid_position;
use super::hit::hit_normal;
use super::packet::{LANES, Packet, Segment, first_hits};
use super::ray_space::{Distance, GridStep, WorldRay, scene_radius, whole_steps};
use super::shade::surface_offset;
use super::trace::{Candidate, RawHit, first_hit_before, keep_first, trace};
use super::vector::Vector3;
use crate::render::section::{MAX_PLANES, Section, SectionPlane};
use crate::render::{Camera, Exactness};
use crate::scene::{Face, Header, Instance, Scene};
use glam::DVec3;
use std::f32::consts::FRAC_1_SQRT_2;

/// Bodies that a ray is outside of where its interval begins: behind more of them no cap is looked for.
pub const MAX_SETTLED: usize = 16;

/// The plane where a ray comes to what is kept, if it is none.
pub const NO_PLANE: u32 = u32::MAX;

/// Distance of hatch lines, of the scene's radius, where all of it is in the picture: it goes by halves and doubles of that, so that it stays as it is while a
/// camera turns.
const HATCH_PITCH: f64 = 0.03;
/// The distance that is wanted, of the picture's height …
const HATCH_SHOWN: f64 = 1.0 / 48.0;
/// … and at least, pixels: finer lines are no longer lines.
const HATCH_FINEST: f64 = 9.0;
/// The share of a cap that hatch lines take …
pub const HATCH_SHARE: f32 = 0.16;
/// … and of its light that they leave.
pub const HATCH_LIGHT: f32 = 0.4;
/// Directions across hatch lines, cosine and sine, for one instance after the other: 45°, 135°, 30°, 120°, 60°, 150°.
pub const HATCH_TURNS: [[f32; 2]; 6] = [
    [FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [-FRAC_1_SQRT_2, FRAC_1_SQRT_2],
    [0.866_025_4, 0.5],
    [-0.5, 0.866_025_4],
    [0.5, 0.866_025_4],
    [-0.866_025_4, 0.5],
];

/// A plane in world space.
#[derive(Debug, Clone, Copy, Default)]
pub struct WorldPlane {
    /// Towards what is cut away.
    pub normal: Vector3<f32>,
    /// `normal · p` on it.
    pub offset: f32,
    /// Two directions along it, as long as a distance of hatch lines goes into a millimetre.
    pub hatch_x: Vector3<f32>,
    /// See `hatch_x`.
    pub hatch_y: Vector3<f32>,
}

/// A section in world space.
#[derive(Debug, Clone, Copy)]
pub struct WorldSection {
    /// Those in use come first.
    pub planes: [WorldPlane; MAX_PLANES],
    /// Planes in use.
    pub count: u32,
    /// 1 where a ray is kept on an interval, -1 where it is kept but for one.
    pub sense: f32,
    /// Whether closed bodies have caps.
    pub caps: bool,
}

impl WorldSection {
    /// The section in the world space of a scene, hatched for a picture so many pixels high.
    pub fn new(section: &Section, header: &Header, camera: &Camera, height: u32) -> Self {
        let mut world = Self {
            planes: [WorldPlane::default(); MAX_PLANES],
            count: section.planes().len() as u32,
            sense: section.mode.sense() as f32,
            caps: section.caps,
        };
        for (to, plane) in world.planes.iter_mut().zip(section.planes()) {
            let across = if plane.normal.z.abs() < 0.9 { DVec3::Z } else { DVec3::X };
            let x = plane.normal.cross(across).normalize_or_zero();
            let pitch = hatch_pitch(plane, header, camera, height);
            let vector = |v: DVec3| Vector3::from_f64(v.to_array());
            to.normal = vector(plane.normal);
            to.offset = (plane.offset - plane.normal.dot(DVec3::from_array(header.world_anchor))) as f32;
            to.hatch_x = vector(x / pitch);
            to.hatch_y = vector(plane.normal.cross(x) / pitch);
        }
        world
    }
}

/// The distance of hatch lines on a plane, millimetres, by how large the plane's place in the middle of the picture is seen, as on paper: whatever part of
/// the model is looked at has some.
fn hatch_pitch(plane: &SectionPlane, header: &Header, camera: &Camera, height: u32) -> f64 {
    let radius = scene_radius(header);
    let distance = if camera.orthographic {
        1.0
    } else {
        let towards = plane.normal.dot(camera.forward);
        let to_plane = (plane.offset - plane.normal.dot(camera.position)) / towards;
        let to_center = (DVec3::from_array(header.world_anchor) - camera.position).dot(camera.forward);
        // Planes seen edge on are met anywhere or nowhere.
        let far = to_center + radius;
        let nearest = (to_center - radius).max(1e-3 * radius);
        if to_plane.is_finite() { to_plane.clamp(nearest, far.max(nearest)) } else { to_center.max(nearest) }
    };
    let shown = 2.0 * camera.half_height * distance;
    let wanted = shown * HATCH_SHOWN.max(HATCH_FINEST / f64::from(height));
    let plain = radius * HATCH_PITCH;
    let doublings = (wanted / plain).log2().round();
    plain * if doublings.is_finite() { doublings.clamp(-16.0, 16.0).exp2() } else { 1.0 }
}

/// What is kept of a ray: from `enter` to `leave`, nothing where it leaves before it enters; of sense -1 up to `leave` and from `enter` on, all of it where
/// it enters before it leaves.
#[derive(Debug, Clone, Copy)]
pub struct Kept {
    /// Distance along the world ray.
    pub enter: f32,
    /// See `enter`.
    pub leave: f32,
    /// Index of the plane where it enters, or [`NO_PLANE`].
    pub plane: u32,
    /// Of the section.
    pub sense: f32,
}

/// What is seen: a hit, or a cap of the body that the hit belongs to.
#[derive(Debug, Clone, Copy)]
pub struct Seen {
    /// At the cap where it is one.
    pub hit: RawHit<f32>,
    /// The plane of the cap, or [`NO_PLANE`].
    pub cap: u32,
}

/// A plane of a section.
pub fn section_plane(section: &WorldSection, index: u32) -> &WorldPlane {
    &section.planes[index as usize]
}

/// What of `ray` is in the kept region. The last plane behind which it comes is where it enters, and the first that it crosses where it leaves; of sense -1 it
/// is the other way round.
pub fn kept(section: &WorldSection, ray: &WorldRay<f32>, step: f32) -> Kept {
    let origin = grid_position(ray.grid, step) + ray.fraction;
    let sense = section.sense;
    let mut kept = Kept { enter: -f32::MAX * sense, leave: f32::MAX * sense, plane: NO_PLANE, sense };
    for index in 0..section.count {
        let plane = section_plane(section, index);
        let rate = plane.normal.dot(ray.direction);
        let height = plane.offset - plane.normal.dot(origin);
        if rate.abs() < 1e-12 {
            if height * sense < 0.0 {
                kept.leave = -f32::MAX * sense;
            }
            continue;
        }
        let t = height / rate;
        if rate > 0.0 {
            kept.leave = sense * (sense * kept.leave).min(sense * t);
        } else if sense * t > sense * kept.enter {
            kept.enter = t;
            kept.plane = index;
        }
    }
    kept
}

/// Whether a hit is seen: it is kept, or its instance is uncut.
pub fn is_kept(scene: &Scene<'_>, kept: &Kept, hit: &RawHit<f32>) -> bool {
    let distance = hit.distance.beyond(0.0);
    let (entered, is_left) = (distance >= kept.enter, distance > kept.leave);
    is_uncut(scene, hit) || if kept.sense > 0.0 { entered && !is_left } else { entered || !is_left }
}

/// Whether a hit can tell if its body is cut: its faces enclose a volume, and the planes cut it.
pub fn may_cap(scene: &Scene<'_>, hit: &RawHit<f32>) -> bool {
    scene.faces[hit.face as usize].flags & Face::CLOSED != 0 && !is_uncut(scene, hit)
}

fn is_uncut(scene: &Scene<'_>, hit: &RawHit<f32>) -> bool {
    scene.instances[hit.instance as usize].flags & Instance::UNCUT != 0
}

/// A distance as a pair.
pub fn to_pair(t: f32, step: GridStep<f32>) -> Distance<f32> {
    let anchor = whole_steps(t, step);
    Distance { anchor, offset: t - anchor }
}

/// The first hit between `near` and `far` of those that `wanted` takes.
pub fn first_hit_of(
    scene: &Scene<'_>,
    exactness: Exactness,
    ray: &WorldRay<f32>,
    near: Distance<f32>,
    far: Distance<f32>,
    wanted: impl Fn(&RawHit<f32>) -> bool,
) -> Option<RawHit<f32>> {
    let mut first: Option<Candidate<f32>> = None;
    trace(scene, exactness, ray, near, far, &mut |candidate: Candidate<f32>| {
        if wanted(&candidate.hit) {
            keep_first(&mut first, candidate);
        }
        Some(first.map_or(far, |best| best.from))
    });
    first.map(|first| first.hit)
}

/// The hit by which a ray leaves the body that it is in at `enter`, moved there; `None` where it is in none.
fn cap_hit(scene: &Scene<'_>, exactness: Exactness, ray: &WorldRay<f32>, enter: f32) -> Option<RawHit<f32>> {
    let step = GridStep::of(scene.header);
    let mut near = to_pair(enter + surface_offset(scene), step);
    let body = |hit: &RawHit<f32>| [hit.instance, scene.faces[hit.face as usize].body];
    let mut settled = [[0; 2]; MAX_SETTLED];
    for count in 0..=MAX_SETTLED {
        let is_settled = |hit: &RawHit<f32>| settled[..count].contains(&body(hit));
        let wanted = |hit: &RawHit<f32>| may_cap(scene, hit) && !is_settled(hit);
        let hit = first_hit_of(scene, exactness, ray, near, Distance::INFINITE, wanted)?;
        if hit_normal(scene, &hit).dot(ray.direction) > 0.0 {
            return Some(RawHit { distance: to_pair(enter, step), ..hit });
        }
        if count < MAX_SETTLED {
            settled[count] = body(&hit);
        }
        near = hit.distance;
    }
    None
}

/// A ray's way through a section.
#[derive(Debug, Clone, Copy)]
pub struct Cut {
    kept: Kept,
    /// Whether there may be a cap that has not been looked for.
    is_pending: bool,
}

impl Cut {
    /// Of a ray that starts at `near`.
    pub fn new(section: &WorldSection, ray: &WorldRay<f32>, near: Distance<f32>, step: f32) -> Self {
        let kept = kept(section, ray, step);
        let is_cut = kept.sense * kept.enter < kept.sense * kept.leave;
        let begins = kept.plane != NO_PLANE && kept.enter > near.beyond(0.0) && is_cut;
        Self { kept, is_pending: section.caps && begins }
    }
}

/// The first thing that is seen between `near` and `far`; `cut` is the ray's way so far, `None` where nothing is cut.
pub fn first_seen(
    scene: &Scene<'_>,
    exactness: Exactness,
    ray: &WorldRay<f32>,
    near: Distance<f32>,
    far: Distance<f32>,
    cut: &mut Option<Cut>,
) -> Option<Seen> {
    let seen = |hit| Seen { hit, cap: NO_PLANE };
    let Some(cut) = cut else { return first_hit_before(scene, exactness, ray, near, far).map(seen) };
    let found = first_hit_of(scene, exactness, ray, near, far, |hit| is_kept(scene, &cut.kept, hit));
    let end = found.map_or(far, |hit| hit.distance).beyond(0.0);
    if cut.is_pending && end >= cut.kept.enter {
        cut.is_pending = false;
        if let Some(hit) = cap_hit(scene, exactness, ray, cut.kept.enter) {
            return Some(Seen { hit, cap: cut.kept.plane });
        }
    }
    found.map(seen)
}

/// [`first_seen`] of up to eight rays: together where nothing is cut.
pub fn first_seen_of_each(
    scene: &Scene<'_>,
    exactness: Exactness,
    ways: &mut [Option<(Segment, Option<Cut>)>; LANES],
) -> [Option<Seen>; LANES] {
    if ways.iter().flatten().all(|(_, cut)| cut.is_none()) {
        let mut packet = Packet::default();
        for (lane, way) in ways.iter().enumerate() {
            if let Some((segment, _)) = way {
                packet.put(lane, segment);
            }
        }
        let seen = |first: Candidate<f32>| Seen { hit: first.hit, cap: NO_PLANE };
        return first_hits(scene, exactness, &packet).map(|first| first.map(seen));
    }
    ways.each_mut().map(|way| {
        let (Segment { ray, near, far }, cut) = way.as_mut()?;
        first_seen(scene, exactness, ray, *near, *far, cut)
    })
}

/// How many hatch lines a point of world space is from the first: whole numbers where lines begin. Turned from instance to instance.
pub fn hatch_place(plane: &WorldPlane, point: Vector3<f32>, instance: u32) -> f32 {
    let [cos, sin] = HATCH_TURNS[instance as usize % HATCH_TURNS.len()];
    point.dot(plane.hatch_x) * cos + point.dot(plane.hatch_y) * sin
}

/// The share of its light that a cap keeps at a point of world space, on and between hatch lines.
pub fn hatch(plane: &WorldPlane, point: Vector3<f32>, instance: u32) -> f32 {
    let across = hatch_place(plane, point, instance);
    if across - across.floor() < HATCH_SHARE { HATCH_LIGHT } else { 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hatch_lines_are_as_far_apart_as_the_picture_needs() {
        let header = Header { half_size: [60.0, 80.0, 0.0], ..Header::default() };
        let plane = SectionPlane { normal: DVec3::X, offset: 5.0 };
        let camera = Camera {
            position: DVec3::X * 105.0,
            forward: DVec3::NEG_X,
            right: DVec3::Y,
            up: DVec3::Z,
            half_height: 1.0,
            orthographic: false,
        };
        let pitch = |camera: &Camera, height: u32| hatch_pitch(&plane, &header, camera, height);
        let whole = pitch(&camera, 1000);
        assert!((whole / (scene_radius(&header) * HATCH_PITCH) - 1.0).abs() < 1e-12, "{whole}");
        // A hundredth of the view, and a hundredth of the distance.
        let near = Camera { position: DVec3::X * 6.0, ..camera };
        let narrow = Camera { half_height: 0.01, ..camera };
        for close in [&near, &narrow] {
            assert!((whole / pitch(close, 1000) - 64.0).abs() < 1e-9, "{}", pitch(close, 1000));
        }
        let parallel = Camera { half_height: 1.0, orthographic: true, ..camera };
        assert_eq!(pitch(&parallel, 1000), pitch(&near, 1000));
        for height in [20, 60, 200, 3000] {
            let shown = pitch(&camera, height) / 200.0 * f64::from(height);
            assert!(shown > HATCH_FINEST / 1.5, "{shown} of {height} pixels");
        }
        let edge_on = Camera { forward: DVec3::Y, ..camera };
        assert!(pitch(&edge_on, 1000).is_finite() && pitch(&edge_on, 1000) > 0.0);
    }
}
