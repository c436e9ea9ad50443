// Sections on a ray: what of it is kept, and what the cut shows; the twin of render/cpu/section.rs.
//
// The twin's `first_seen` and `cap_hit` are in entry/sight.wgsl; `accept` goes by the variables here.

struct SectionPlane {
    normal: vec3<f32>,
    offset: f32,
    hatch_x: vec3<f32>,
    reserved_0: u32,
    hatch_y: vec3<f32>,
    reserved_1: u32,
}

struct Section {
    planes: array<SectionPlane, MAX_PLANES>,
    count: u32,
    caps: u32,
    sense: f32,
    reserved: u32,
}

struct Kept {
    enter: f32,
    leave: f32,
    plane: u32,
    sense: f32,
}

// What is kept of the ray that is traced now.
var<private> kept_now: Kept;
// Whether a cap is looked for, and the bodies, instance and number, that the ray is known to be outside of.
var<private> walks: bool;
var<private> settled: array<vec2<u32>, MAX_SETTLED>;
var<private> settled_count: u32;

fn section_plane(section: Section, index: u32) -> SectionPlane {
    var planes = section.planes;
    return planes[index];
}

fn kept(section: Section, ray: WorldRay) -> Kept {
    var planes = section.planes;
    let origin = grid_position(ray.grid) + ray.fraction;
    let sense = section.sense;
    var result = Kept(-INFINITE * sense, INFINITE * sense, NO_PLANE, sense);
    for (var i = 0u; i < section.count; i++) {
        let rate = dot(planes[i].normal, ray.direction);
        let height = planes[i].offset - dot(planes[i].normal, origin);
        if abs(rate) < 1e-12 {
            if height * sense < 0.0 {
                result.leave = -INFINITE * sense;
            }
            continue;
        }
        let t = height / rate;
        if rate > 0.0 {
            result.leave = sense * min(sense * result.leave, sense * t);
        } else if sense * t > sense * result.enter {
            result.enter = t;
            result.plane = i;
        }
    }
    return result;
}

fn is_kept(hit: RawHit) -> bool {
    let distance = beyond(hit.distance, 0.0);
    let entered = distance >= kept_now.enter;
    let is_left = distance > kept_now.leave;
    return is_uncut(hit) || select(entered || !is_left, entered && !is_left, kept_now.sense > 0.0);
}

fn may_cap(hit: RawHit) -> bool {
    if (faces[hit.face].flags & CLOSED) == 0u || is_uncut(hit) {
        return false;
    }
    let body = vec2<u32>(hit.instance, faces[hit.face].body);
    for (var i = 0u; i < settled_count; i++) {
        if all(settled[i] == body) {
            return false;
        }
    }
    return true;
}

fn is_uncut(hit: RawHit) -> bool {
    return (instances[hit.instance].flags & UNCUT) != 0u;
}

fn to_pair(t: f32) -> Distance {
    let anchor = whole_steps(t);
    return Distance(anchor, t - anchor);
}

fn hatch_place(plane: SectionPlane, point: vec3<f32>, instance: u32) -> f32 {
    var turns_of_hatch = HATCH_TURNS;
    let turn = turns_of_hatch[instance % HATCH_TURN_COUNT];
    return dot(point, plane.hatch_x) * turn.x + dot(point, plane.hatch_y) * turn.y;
}

fn hatch(plane: SectionPlane, point: vec3<f32>, instance: u32) -> f32 {
    let across = hatch_place(plane, point, instance);
    return select(1.0, HATCH_LIGHT, across - floor(across) < HATCH_SHARE);
}
