// The arrays of a scene, in the order of SCENE_BINDINGS in render/gpu/buffers.rs.

// Turns of all loops so far, counted on software devices alone; render/gpu/kernels.rs says why.
var<private> turns: u32;

// Whether the kernel has used up its turns. Where a driver has ended its loops before that, this one ends after its first turn too.
fn was_cut() -> bool {
    let start = turns;
    var i = start;
    while i < start + 3u {
        i += 1u;
    }
    return turns > MOST_TURNS || i != start + 3u;
}

// Five words of four of a BvhNode after each other.
@group(0) @binding(0) var<storage, read> bvh_nodes: array<vec4<u32>>;
@group(0) @binding(1) var<storage, read> primitives: array<u32>;
@group(0) @binding(2) var<storage, read> instances: array<Instance>;
@group(0) @binding(3) var<storage, read> parts: array<Part>;
@group(0) @binding(4) var<storage, read> faces: array<Face>;
@group(0) @binding(5) var<storage, read> nets: array<Net>;
@group(0) @binding(6) var<storage, read> net_leaves: array<NetLeaf>;
@group(0) @binding(7) var<storage, read> net_points: array<vec4<f32>>;
@group(0) @binding(8) var<storage, read> trim_nodes: array<u32>;
@group(0) @binding(9) var<storage, read> trim_segments: array<TrimSegment>;
// Three numbers each; a vec3 would take the room of four.
@group(0) @binding(10) var<storage, read> trim_points: array<f32>;
@group(0) @binding(11) var<storage, read> materials: array<Material>;
@group(0) @binding(12) var<uniform> header: SceneHeader;
