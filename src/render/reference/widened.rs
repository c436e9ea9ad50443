//! A scene whose f64 arrays say exactly what its f32 arrays say: what separates an error of the kernels from one of the bake.

use crate::scene::{FaceF64, Instance, InstanceF64, Scene, SceneBuffers};

/// A copy of `scene` with its f32 records as f64 ones.
pub fn widened(scene: &Scene<'_>) -> SceneBuffers {
    let step = scene.header.grid_step;
    let place = |grid: [i32; 3], rest: [f32; 3]| {
        std::array::from_fn(|k| f64::from(grid[k]) * step + f64::from(rest[k]))
    };
    let faces_f64 = scene
        .faces
        .iter()
        .map(|face| FaceF64 {
            origin: place(face.grid, face.offset),
            x_axis: face.x_axis.map(f64::from),
            y_axis: face.y_axis.map(f64::from),
            z_axis: face.z_axis.map(f64::from),
            radii: [face.radius_0, face.radius_1].map(f64::from),
            uv_low: face.uv_low.map(f64::from),
            uv_scale: face.uv_scale.map(f64::from),
            period: face.period.map(f64::from),
        })
        .collect();
    let rows = |i: &Instance| [i.part_from_world_0, i.part_from_world_1, i.part_from_world_2];
    let instances_f64 = scene
        .instances
        .iter()
        .map(|instance| InstanceF64 {
            part_from_world: rows(instance).map(|row| row.map(f64::from)),
            origin: place(instance.grid, instance.fraction),
        })
        .collect();
    SceneBuffers {
        metadata: scene.metadata.clone(),
        header: *scene.header,
        bvh_nodes: scene.bvh_nodes.to_vec(),
        primitives: scene.primitives.to_vec(),
        instances: scene.instances.to_vec(),
        parts: scene.parts.to_vec(),
        face_infos: scene.face_infos.to_vec(),
        body_infos: scene.body_infos.to_vec(),
        faces: scene.faces.to_vec(),
        nets: scene.nets.to_vec(),
        net_leaves: scene.net_leaves.to_vec(),
        net_points: scene.net_points.to_vec(),
        trim_nodes: scene.trim_nodes.to_vec(),
        trim_segments: scene.trim_segments.to_vec(),
        trim_points: scene.trim_points.to_vec(),
        materials: scene.materials.to_vec(),
        edge_pieces: scene.edge_pieces.to_vec(),
        edge_points: scene.edge_points.to_vec(),
        faces_f64,
        instances_f64,
        net_points_f64: scene.net_points.iter().map(|point| point.map(f64::from)).collect(),
    }
}
