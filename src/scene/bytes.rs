//! What a scene weighs.

use super::Scene;
use std::collections::BTreeMap;

/// Bytes of each section, by its name, and "total".
pub fn section_bytes(scene: &Scene<'_>) -> BTreeMap<&'static str, usize> {
    let mut bytes = BTreeMap::from([
        ("bvh_nodes", size_of_val(scene.bvh_nodes)),
        ("primitives", size_of_val(scene.primitives)),
        ("instances", size_of_val(scene.instances)),
        ("parts", size_of_val(scene.parts)),
        ("faces", size_of_val(scene.faces)),
        ("face_infos", size_of_val(scene.face_infos)),
        ("body_infos", size_of_val(scene.body_infos)),
        ("nets", size_of_val(scene.nets)),
        ("net_leaves", size_of_val(scene.net_leaves)),
        ("net_points", size_of_val(scene.net_points)),
        ("trim_nodes", size_of_val(scene.trim_nodes)),
        ("trim_segments", size_of_val(scene.trim_segments)),
        ("trim_points", size_of_val(scene.trim_points)),
        ("materials", size_of_val(scene.materials)),
        ("edge_pieces", size_of_val(scene.edge_pieces)),
        ("edge_points", size_of_val(scene.edge_points)),
        ("faces_f64", size_of_val(scene.faces_f64)),
        ("instances_f64", size_of_val(scene.instances_f64)),
        ("net_points_f64", size_of_val(scene.net_points_f64)),
    ]);
    bytes.insert("total", bytes.values().sum());
    bytes
}
