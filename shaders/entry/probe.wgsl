// Hits of given rays. Each ray has a range of slots; the hits that fit are kept in the order in which they are met, all are counted.

struct ProbeParameters {
    ray_count: u32,
    first_only: u32,
    // Rays of a workgroup, at least as many as it has invocations.
    rays_per_group: u32,
    reserved: u32,
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
// Of each ray 1 + the number of its hits; 0, as the buffer is before, where it is not answered.
@group(1) @binding(3) var<storage, read_write> answers: array<u32>;

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

// Those of a workgroup are one after the other, and its invocations take them in turn.
var<workgroup> rays_taken: atomic<u32>;
var<private> first_of_group: u32;
var<private> ray_index: u32;

fn take_ray(index: u32, ray: ptr<function, WorldRay>, near: ptr<function, Distance>, collected: ptr<function, Collected>) -> bool {
    if index >= parameters.ray_count {
        return false;
    }
    ray_index = index;
    let next = rays[index];
    *ray = WorldRay(next.grid, next.fraction, next.direction, next.direction_low);
    *near = Distance(next.near_anchor, next.near_offset);
    (*collected).far = Distance(0.0, INFINITE);
    (*collected).count = 0u;
    (*collected).first_slot = next.first_slot;
    (*collected).slots = next.slots;
    return true;
}

fn next_ray(ray: ptr<function, WorldRay>, near: ptr<function, Distance>, collected: ptr<function, Collected>) -> bool {
    if !was_cut() {
        answers[ray_index] = 1u + (*collected).count;
    }
    if !SHARES_RAYS {
        return false;
    }
    let taken = atomicAdd(&rays_taken, 1u);
    return taken < parameters.rays_per_group && take_ray(first_of_group + taken, ray, near, collected);
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn probe(@builtin(workgroup_id) group: vec3<u32>, @builtin(local_invocation_index) lane: u32) {
    first_of_group = group.x * parameters.rays_per_group;
    if SHARES_RAYS {
        if lane == 0u {
            atomicStore(&rays_taken, WORKGROUP_SIZE);
        }
        workgroupBarrier();
    }
    var ray: WorldRay;
    var near: Distance;
    var collected: Collected;
    if take_ray(first_of_group + lane, &ray, &near, &collected) {
        trace(ray, near, &collected);
    }
}
