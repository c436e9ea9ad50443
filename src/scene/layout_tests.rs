//! The records have the sizes that their docs and the shaders rely on, and BVH nodes are obvhs's.

use super::*;
use std::mem::{offset_of, size_of};

#[test]
fn records_have_their_documented_sizes() {
    assert_eq!(size_of::<Header>(), 64);
    assert_eq!(size_of::<BvhNode>(), 80);
    assert_eq!(size_of::<Instance>(), 96);
    assert_eq!(size_of::<Part>(), 16);
    assert_eq!(size_of::<Face>(), 128);
    assert_eq!(size_of::<Net>(), 32);
    assert_eq!(size_of::<NetLeaf>(), 64);
    assert_eq!(size_of::<TrimSegment>(), 24);
    assert_eq!(size_of::<Material>(), 32);
    assert_eq!(size_of::<EdgePiece>(), 48);
    assert_eq!(size_of::<FaceF64>(), 160);
    assert_eq!(size_of::<InstanceF64>(), 96);
}

#[test]
fn bytes_of_bends_round_up() {
    for bound in [0.0, 1e-9, 0.0156, 0.5, 0.51, 1.0, 3.99, 77.0, 1e6, 3.1e7] {
        let byte = bend_byte(bound);
        assert!(byte < 255 && bend_bound(byte) >= bound && (byte == 0 || bend_bound(byte - 1) < bound));
        assert!(bend_bound(byte) <= (bound * 1.125).max(1.0 / 64.0), "{bound}");
    }
    assert!([1e9, f32::INFINITY, f32::NAN, -1.0].iter().all(|&bound| bend_byte(bound) == 255));
}

#[test]
fn bvh_nodes_are_those_of_obvhs() {
    use obvhs::cwbvh::node::CwBvhNode;
    assert_eq!(size_of::<BvhNode>(), size_of::<CwBvhNode>());
    macro_rules! same_offset {
        ($($ours:ident = $theirs:ident),*) => { $(assert_eq!(offset_of!(BvhNode, $ours), offset_of!(CwBvhNode, $theirs));)* };
    }
    same_offset!(
        p = p,
        e = e,
        imask = imask,
        child_base = child_base_idx,
        primitive_base = primitive_base_idx,
        child_meta = child_meta,
        child_min_x = child_min_x,
        child_max_x = child_max_x,
        child_min_y = child_min_y,
        child_max_y = child_max_y,
        child_min_z = child_min_z,
        child_max_z = child_max_z
    );
}

#[test]
fn words_survive_packing() {
    use super::primitive::Primitive;
    for value in [Primitive::Face(7), Primitive::NetLeaf((1 << 31) - 1)] {
        assert_eq!(primitive::unpack(primitive::pack(value)), value);
    }
}
