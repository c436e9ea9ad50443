// Hits of given rays. Each ray has a range of slots; the hits that fit are kept in the order in which they are met, all are counted.

struct ProbeParameters {
    ray_count: u32,
    first_only: u32,
    reserved: vec2<u32>,
}

struct ProbeRay {
    grid: vec3<i32>,
    near_anchor: f32,
    fraction: vec3<f32>,
    near_offset: f32,
    direction: vec3<f32>,
    first_slot: u32,
    direction_low: vec3<f32>,
    slots: u32,
}

struct ProbeHit {
    distance: vec2<f32>,
    uv: vec2<f32>,
    instance: u32,
    face: u32,
    net: u32,
    certainty: u32,
}

@group(1) @binding(0) var<uniform> parameters: ProbeParameters;
@group(1) @binding(1) var<storage, read> rays: array<ProbeRay>;
@group(1) @binding(2) var<storage, read_write> hits: array<ProbeHit>;
@group(1) @binding(3) var<storage, read_write> counts: array<u32>;

fn accept(collected: ptr<function, Collected>, hit: RawHit) {
    if parameters.first_only != 0u && (*collected).count != 0u {
        if !comes_before(hit, (*collected).hit) {
            return;
        }
        (*collected).count = 0u;
    }
    if parameters.first_only != 0u {
        (*collected).hit = hit;
        (*collected).far = hit.distance;
    }
    if (*collected).count < (*collected).slots {
        let distance = vec2<f32>(hit.distance.anchor, hit.distance.offset);
        hits[(*collected).first_slot + (*collected).count] =
            ProbeHit(distance, hit.uv, hit.instance, hit.face, hit.net, hit.certainty);
    }
    (*collected).count += 1u;
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= parameters.ray_count {
        return;
    }
    let ray = rays[id.x];
    var collected: Collected;
    collected.far = Distance(0.0, INFINITE);
    collected.first_slot = ray.first_slot;
    collected.slots = ray.slots;
    let world_ray = WorldRay(ray.grid, ray.fraction, ray.direction, ray.direction_low);
    let near = Distance(ray.near_anchor, ray.near_offset);
    trace(world_ray, near, &collected);
    counts[id.x] = select(collected.count, INCOMPLETE, was_cut());
}
