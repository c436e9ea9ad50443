//! Every index, count and bound of a scene, checked once before any kernel relies on them.

use super::validate_edges::edges;
use super::validate_trees::bvh;
use super::validate_trims::trims;
use super::{FaceKind, MAX_DEGREE, Material, NO_MATERIAL, Scene, primitive};

/// Grid coordinates stay within this, so that their differences are exact.
const MAX_STEPS: u32 = 1 << 30;

/// Levels of a leaf's sub-domain: indices have 12 bits.
const MAX_LEVEL: u32 = 12;

/// What is wrong with a scene.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{array}[{index}]: {reason}")]
pub struct InvalidScene {
    /// The array.
    pub array: &'static str,
    /// The element.
    pub index: usize,
    /// What is wrong with it.
    pub reason: &'static str,
}

/// Nothing, or the first failed condition.
pub(super) type Check = Result<(), InvalidScene>;

/// Fails for element `index` of `array` unless `condition` holds.
pub(super) fn require(condition: bool, array: &'static str, index: usize, reason: &'static str) -> Check {
    if condition { Ok(()) } else { Err(InvalidScene { array, index, reason }) }
}

/// Checks all that the kernels rely on: after it, no index is out of range, no tree has a cycle or is deeper than the kernels' stacks.
pub fn validate(scene: &Scene<'_>) -> Result<(), InvalidScene> {
    header(scene)?;
    instances(scene)?;
    faces(scene)?;
    nets(scene)?;
    leaves(scene)?;
    for (index, material) in scene.materials.iter().enumerate() {
        let Material { rgb: [red, green, blue], opacity, roughness, metallic, .. } = *material;
        let channels = [red, green, blue, opacity, roughness, metallic];
        let valid = channels.iter().all(|x| (0.0..=1.0).contains(x));
        require(valid, "materials", index, "a channel is outside of 0..=1")?;
    }
    doubles(scene)?;
    edges(scene)?;
    bvh(scene)?;
    trims(scene)
}

fn header(scene: &Scene<'_>) -> Check {
    let header = scene.header;
    let step = header.grid_step;
    let is_power = step.is_normal() && step > 0.0 && step.to_bits() << 12 == 0;
    require(is_power && (1e-30..1e30).contains(&step), "header", 0, "the grid step is not a power of two")?;
    require(header.world_anchor.iter().all(|x| x.is_finite()), "header", 0, "the anchor is not finite")?;
    require(
        header.half_size.iter().all(|x| x.is_finite() && *x >= 0.0),
        "header",
        0,
        "the size is not finite",
    )?;
    require(header.max_net_degree <= MAX_DEGREE, "header", 0, "nets have too high a degree")?;
    require(header.max_trim_degree <= MAX_DEGREE, "header", 0, "trim curves have too high a degree")?;
    let metadata = scene.metadata;
    require(metadata.parts.len() == scene.parts.len(), "metadata", 0, "not one entry per part")?;
    require(scene.face_infos.len() == scene.faces.len(), "face_infos", 0, "not one entry per face")?;
    require(metadata.instances.len() == scene.instances.len(), "metadata", 0, "not one entry per instance")
}

pub(super) fn on_grid(grid: [i32; 3]) -> bool {
    grid.iter().all(|steps| steps.unsigned_abs() <= MAX_STEPS)
}

fn finite<const N: usize>(groups: [&[f32]; N]) -> bool {
    groups.iter().all(|group| group.iter().all(|x| x.is_finite()))
}

fn instances(scene: &Scene<'_>) -> Check {
    for (index, instance) in scene.instances.iter().enumerate() {
        let check = |condition, reason| require(condition, "instances", index, reason);
        check((instance.part as usize) < scene.parts.len(), "no such part")?;
        check(
            instance.material == NO_MATERIAL || (instance.material as usize) < scene.materials.len(),
            "no such material",
        )?;
        check(instance.material_shift == 0, "its materials are shifted")?;
        check(on_grid(instance.grid), "it lies outside of the grid")?;
        let numbers: [&[f32]; 5] = [
            &instance.part_from_world_0,
            &instance.part_from_world_1,
            &instance.part_from_world_2,
            &instance.fraction,
            &[instance.radius],
        ];
        check(finite(numbers) && instance.radius >= 0.0, "a number is not finite")?;
    }
    Ok(())
}

fn faces(scene: &Scene<'_>) -> Check {
    for (index, face) in scene.faces.iter().enumerate() {
        let check = |condition, reason| require(condition, "faces", index, reason);
        check(face.kind <= FaceKind::Nets as u32, "no such kind")?;
        check(scene.header.feature_mask >> face.kind & 1 == 1, "its kind is not in the feature mask")?;
        check((face.material as usize) < scene.materials.len(), "no such material")?;
        check((face.part as usize) < scene.parts.len(), "no such part")?;
        check((face.body as usize) < scene.body_infos.len(), "no such body")?;
        check(face.slack >= 0.0, "its slack is negative")?;
        check(on_grid(face.grid), "it lies outside of the grid")?;
        let numbers: [&[f32]; 9] = [
            &face.x_axis,
            &face.y_axis,
            &face.z_axis,
            &face.offset,
            &[face.radius_0, face.radius_1],
            &face.uv_low,
            &face.uv_scale,
            &face.period,
            &[face.slack],
        ];
        check(finite(numbers), "a number is not finite")?;
        check(face.uv_scale.iter().all(|&x| x > 0.0), "its window has no size")?;
        check(face.period.iter().all(|&x| x == 0.0 || x > 0.99), "its window is wider than its period")?;
    }
    Ok(())
}

fn nets(scene: &Scene<'_>) -> Check {
    for (index, net) in scene.nets.iter().enumerate() {
        let check = |condition, reason| require(condition, "nets", index, reason);
        let [p, q] = [net.degrees & 0xff, net.degrees >> 8 & 0xff];
        check(p >= 1 && q >= 1 && p.max(q) <= scene.header.max_net_degree, "its degrees are out of range")?;
        let points = (p as usize + 1) * (q as usize + 1);
        check(net.first_point as usize + points <= scene.net_points.len(), "no such points")?;
        let face = scene.faces.get(net.face as usize);
        check(face.is_some_and(|face| face.kind == FaceKind::Nets as u32), "no such face of nets")?;
        check(finite([&net.uv_low, &net.uv_size]), "a number is not finite")?;
    }
    for (index, point) in scene.net_points.iter().enumerate() {
        let valid = point.iter().all(|x| x.is_finite()) && point[3] > 0.0;
        require(valid, "net_points", index, "it is not finite or its weight is not positive")?;
    }
    Ok(())
}

fn leaves(scene: &Scene<'_>) -> Check {
    for (index, leaf) in scene.net_leaves.iter().enumerate() {
        let check = |condition, reason| require(condition, "net_leaves", index, reason);
        check((leaf.net as usize) < scene.nets.len(), "no such net")?;
        for axis in [leaf.domain & 0xffff, leaf.domain >> 16] {
            let level = axis >> 12;
            check(level <= MAX_LEVEL && (axis & 0xfff) >> level == 0, "its domain is outside of the net")?;
        }
        let numbers: [&[f32]; 4] =
            [&leaf.center, &leaf.tangent_u, &leaf.tangent_v, &[leaf.extent_n, leaf.extent_u, leaf.extent_v]];
        check(finite(numbers), "a number is not finite")?;
    }
    for (index, &word) in scene.primitives.iter().enumerate().skip(scene.instances.len()) {
        let valid = match primitive::unpack(word) {
            primitive::Primitive::Face(face) => {
                scene.faces.get(face as usize).is_some_and(|face| face.kind != FaceKind::Nets as u32)
            }
            primitive::Primitive::NetLeaf(leaf) => (leaf as usize) < scene.net_leaves.len(),
        };
        require(valid, "primitives", index, "no such face or leaf")?;
    }
    Ok(())
}

fn doubles(scene: &Scene<'_>) -> Check {
    let whole = |exact: usize, single: usize| exact == 0 || exact == single;
    require(whole(scene.faces_f64.len(), scene.faces.len()), "faces_f64", 0, "not one per face")?;
    require(
        whole(scene.instances_f64.len(), scene.instances.len()),
        "instances_f64",
        0,
        "not one per instance",
    )?;
    require(
        whole(scene.net_points_f64.len(), scene.net_points.len()),
        "net_points_f64",
        0,
        "not one per point",
    )?;
    let all = |numbers: &[f64]| numbers.iter().all(|x| x.is_finite());
    for (index, face) in scene.faces_f64.iter().enumerate() {
        require(all(bytemuck::cast_slice(&[*face])), "faces_f64", index, "a number is not finite")?;
    }
    for (index, instance) in scene.instances_f64.iter().enumerate() {
        require(all(bytemuck::cast_slice(&[*instance])), "instances_f64", index, "a number is not finite")?;
    }
    for (index, point) in scene.net_points_f64.iter().enumerate() {
        require(all(point) && point[3] > 0.0, "net_points_f64", index, "it is not a homogeneous point")?;
    }
    Ok(())
}
