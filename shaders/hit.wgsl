// From a kernel's hit to its normal; the twin of render/cpu/hit.rs. `finish_hit` runs on the host.

fn hit_normal(hit: RawHit) -> vec3<f32> {
    var in_part: vec3<f32>;
    if hit.net == NO_NET {
        let face = faces[hit.face];
        let n = carrier_normal(face.kind, face.uv_low + hit.uv / face.uv_scale, vec2<f32>(face.radius_0, face.radius_1));
        in_part = face.x_axis * n.x + face.y_axis * n.y + face.z_axis * n.z;
    } else if HAS_NETS {
        in_part = net_normal(hit.net, hit.uv);
    }
    var n = in_part;
    if instances[hit.instance].is_translation == 0u {
        n = instances[hit.instance].part_from_world_0 * in_part.x
            + instances[hit.instance].part_from_world_1 * in_part.y
            + instances[hit.instance].part_from_world_2 * in_part.z;
    }
    if (faces[hit.face].flags & REVERSED) != 0u {
        n = -n;
    }
    return n * (1.0 / max(length(n), 1e-30));
}
