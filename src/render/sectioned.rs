//! First hits in a section, from all hits: what lines ask a device that knows of no sections.

use super::section::Section;
use super::{Hit, Ray};
use crate::scene::{Face, Instance, Scene};

/// The face of a hit that is a cap.
pub const CAP: u32 = u32::MAX;

/// Lengths, of the scene's size, within which a face is on a plane.
const ON_PLANE: f64 = 2e-5;

/// The first thing that a ray meets in a section, of all its hits, sorted; a cap has the face [`CAP`].
pub fn first_in_section(scene: &Scene<'_>, section: &Section, ray: &Ray, hits: &[Hit]) -> Option<Hit> {
    let size = scene.header.half_size.iter().map(|&x| f64::from(x)).fold(0.0, f64::max);
    let sense = section.mode.sense();
    let (mut enter, mut leave, mut normal) = (f64::NEG_INFINITY * sense, f64::INFINITY * sense, None);
    for plane in section.planes() {
        let rate = plane.normal.dot(ray.direction);
        let t = (plane.offset - plane.normal.dot(ray.origin)) / rate;
        if rate > 0.0 {
            leave = sense * (sense * leave).min(sense * t);
        } else if sense * t > sense * enter {
            enter = t;
            normal = Some(plane.normal);
        }
    }
    let is_uncut = |hit: &Hit| scene.instances[hit.instance as usize].flags & Instance::UNCUT != 0;
    let is_kept = |t: f64| if sense > 0.0 { t >= enter && t <= leave } else { t >= enter || t <= leave };
    let is_seen = |hit: &&Hit| is_uncut(hit) || is_kept(hit.t);
    let first = hits.iter().find(is_seen).copied();
    let normal = normal.filter(|_| section.caps && enter > 0.0 && sense * enter < sense * leave);
    let (Some(normal), false) = (normal, first.is_some_and(|hit| hit.t < enter)) else { return first };
    // A point is in a body that the ray leaves once more than it enters it.
    let mut bodies: Vec<(u32, u32, i32)> = Vec::new();
    for hit in hits.iter().filter(|hit| hit.t > enter + ON_PLANE * size && !is_uncut(hit)) {
        let face = &scene.faces[hit.face as usize];
        if face.flags & Face::CLOSED == 0 {
            continue;
        }
        let leaves = if hit.normal.dot(ray.direction) > 0.0 { 1 } else { -1 };
        match bodies.iter_mut().find(|body| (body.0, body.1) == (hit.instance, face.body)) {
            Some(body) => body.2 += leaves,
            None => bodies.push((hit.instance, face.body, leaves)),
        }
    }
    let inside = bodies.into_iter().find(|body| body.2 > 0);
    match inside {
        Some((instance, ..)) => Some(Hit { t: enter, normal, uv: [0.0; 2], face: CAP, instance }),
        None => first,
    }
}
