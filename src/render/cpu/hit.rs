//! From a kernel's hit to a hit as the outside sees it.

use super::analytic::carrier_normal;
use super::frames::FaceFrame;
use super::net::net_normal;
use super::trace::{RawHit, face_parameters};
use super::vector::{Vector3, number};
use super::{Kernel, NO_NET};
use crate::render::Hit;
use crate::scene::{Face, Scene};

/// The outward unit normal in world (and model) space.
pub fn hit_normal<T: Kernel>(scene: &Scene<'_>, hit: &RawHit<T>) -> Vector3<T> {
    let in_part = if hit.net == NO_NET {
        let face: FaceFrame<T> = T::face(scene, hit.face);
        let parameter = |k: usize| face.uv_low[k] + hit.uv[k] / face.uv_scale[k];
        let n = carrier_normal(face.kind, [parameter(0), parameter(1)], face.radii);
        face.axes[0] * n.x + face.axes[1] * n.y + face.axes[2] * n.z
    } else {
        net_normal(scene, &scene.nets[hit.net as usize], hit.uv)
    };
    let instance = T::instance(scene, hit.instance);
    // Normals go from part to world by the transpose of part ← world; that of a mirror keeps "outward" outward.
    let mut n = if instance.is_translation {
        in_part
    } else {
        instance.rows[0] * in_part.x + instance.rows[1] * in_part.y + instance.rows[2] * in_part.z
    };
    if scene.faces[hit.face as usize].flags & Face::REVERSED != 0 {
        n = -n;
    }
    n * (T::ONE / n.length().max(number(1e-30)))
}

/// Whose face a hit is on: instance and body.
pub fn body_of<T>(scene: &Scene<'_>, hit: &RawHit<T>) -> (u32, u32) {
    (hit.instance, scene.faces[hit.face as usize].body)
}

/// The slack of a hit's face, in lengths of the world: instances may scale.
pub fn world_slack<T: Kernel>(scene: &Scene<'_>, hit: &RawHit<T>) -> T {
    let slack = number::<T>(scene.faces[hit.face as usize].slack.into());
    let instance = T::instance(scene, hit.instance);
    if instance.is_translation { slack } else { slack * (T::ONE / instance.rows[0].length()) }
}

/// The hit with its distance from the ray's own origin, its normal and its surface parameters.
pub fn finish_hit<T: Kernel>(scene: &Scene<'_>, hit: &RawHit<T>, start: f64) -> Hit {
    Hit {
        t: start + hit.distance.to_f64(),
        normal: hit_normal(scene, hit).to_f64(),
        uv: surface_parameters(scene, hit.face, hit.net, hit.uv),
        face: hit.face,
        instance: hit.instance,
    }
}

/// The surface's own parameters of a hit's: those of the face, normalised, or of the net.
pub fn surface_parameters<T: Kernel>(scene: &Scene<'_>, face: u32, net: u32, uv: [T; 2]) -> [f64; 2] {
    let normalised = if net == NO_NET {
        uv
    } else {
        face_parameters(&scene.nets[net as usize], scene.faces[face as usize].period, uv)
    };
    let info = &scene.face_infos[face as usize];
    [0, 1].map(|k| info.uv_low[k] + normalised[k].to_f64() * info.uv_size[k])
}
