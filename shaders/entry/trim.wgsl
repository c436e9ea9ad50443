// Whether given points are inside the trims of their faces.

struct TrimParameters {
    query_count: u32,
    reserved_0: u32,
    reserved_1: u32,
    reserved_2: u32,
}

struct TrimQuery {
    uv: vec2<f32>,
    root: u32,
    reserved: u32,
}

@group(1) @binding(0) var<uniform> parameters: TrimParameters;
@group(1) @binding(1) var<storage, read> queries: array<TrimQuery>;
@group(1) @binding(2) var<storage, read_write> answers: array<u32>;

// 0, as the buffer is before, where the query is not answered.
const ANSWER_OUTSIDE: u32 = 1u;
const ANSWER_INSIDE: u32 = 2u;

// The function files call them; no ray is traced here.
fn accept(collected: ptr<function, Collected>, hit: RawHit) {}

fn next_ray(ray: ptr<function, WorldRay>, near: ptr<function, Distance>, collected: ptr<function, Collected>) -> bool {
    return false;
}

@compute @workgroup_size(WORKGROUP_SIZE)
fn trim(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= parameters.query_count {
        return;
    }
    let query = queries[id.x];
    let point = trim_point(query.root, query.uv, vec2<f32>(-1.0));
    if !was_cut() {
        answers[id.x] = select(ANSWER_OUTSIDE, ANSWER_INSIDE, point.inside);
    }
}
