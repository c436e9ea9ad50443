//! The records. Fields are ordered so that WGSL needs no padding: a three-vector is always followed by a scalar.
//! `tests/layout.rs` compares names, offsets and sizes with the WGSL mirror in `shaders/types.wgsl`.

use super::TrimMethod;
use bytemuck::{Pod, Zeroable};

/// Scene-wide numbers. 64 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Header {
    /// World space = model space − this, millimetres; a multiple of `grid_step`.
    pub world_anchor: [f64; 3],
    /// A power of two, about 2⁻¹⁶ of the scene's size, millimetres.
    pub grid_step: f64,
    /// Half the extents of the scene's box in world space (centred within one grid step of 0), rounded up.
    pub half_size: [f32; 3],
    /// The number of the [`TrimMethod`](super::TrimMethod) that the trim arrays are made for.
    pub trim_method: u32,
    /// Nodes of the BVH over instances, which comes first in `bvh_nodes`; 0 in an empty scene.
    pub node_count: u32,
    /// The highest degree of any net along u or v; 0 without nets.
    pub max_net_degree: u32,
    /// The highest degree of any trim curve; 0 without.
    pub max_trim_degree: u32,
    /// A bit for each [`FaceKind`] that occurs: bit `1 << kind`.
    pub feature_mask: u32,
}

impl Default for Header {
    fn default() -> Self {
        Self { trim_method: TrimMethod::PACKED.number(), ..Self::zeroed() }
    }
}

/// One node of an 8-wide compressed BVH (Ylitie, Karras and Laine 2017), bit for bit `obvhs::cwbvh::node::CwBvhNode`. 80 bytes.
///
/// `primitive_base` and `child_base` count from the start of the tree's own range of `primitives` and `bvh_nodes`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct BvhNode {
    /// Origin of the quantisation frame.
    pub p: [f32; 3],
    /// Exponents of the frame along x, y, z, biased as in f32: a plane q lies at `p + q · f32::from_bits(e << 23)`.
    pub e: [u8; 3],
    /// Which of the eight children are inner nodes.
    pub imask: u8,
    /// Index of the first inner child.
    pub child_base: u32,
    /// Index of the first primitive of the node's leaves.
    pub primitive_base: u32,
    /// Per child slot: 0 empty; an inner node in slot s: `0b001_00000 | (24 + s)`, and it is node
    /// `child_base + (inner children in lower slots)`; a leaf: its number of primitives in unary in the high 3 bits (`001`: 1, `011`: 2,
    /// `111`: 3; the bake makes 1 only), the first one's offset from `primitive_base` in the low 5 bits, below 24.
    pub child_meta: [u8; 8],
    /// Quantised lower and upper planes of the eight children.
    pub child_min_x: [u8; 8],
    /// See `child_min_x`.
    pub child_max_x: [u8; 8],
    /// See `child_min_x`.
    pub child_min_y: [u8; 8],
    /// See `child_min_x`.
    pub child_max_y: [u8; 8],
    /// See `child_min_x`.
    pub child_min_z: [u8; 8],
    /// See `child_min_x`.
    pub child_max_z: [u8; 8],
}

/// A placement of a part. 96 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Instance {
    /// Row 0 of the linear map part ← world.
    pub part_from_world_0: [f32; 3],
    /// The part.
    pub part: u32,
    /// Row 1.
    pub part_from_world_1: [f32; 3],
    /// Material of the occurrence, overriding those of the faces; [`NO_MATERIAL`] where none.
    pub material: u32,
    /// Row 2.
    pub part_from_world_2: [f32; 3],
    /// 1 where the linear map is exactly the identity: positions then pass without any rounding.
    pub is_translation: u32,
    /// World position of the part's origin, in grid steps …
    pub grid: [i32; 3],
    /// [`Instance::UNCUT`].
    pub flags: u32,
    /// … plus this, millimetres.
    pub fraction: [f32; 3],
    /// Radius around the part's origin that holds the whole part, part space.
    pub radius: f32,
    /// Added to the index of the material, the occurrence's or the face's: where looks are overridden, those of the instance stand together. 0 in a file.
    pub material_shift: u32,
    /// Unused, 0.
    pub reserved_1: u32,
    /// Unused, 0.
    pub reserved_2: [u32; 2],
}

impl Instance {
    /// Bit of `flags`: sections leave it whole. Never set in a file.
    pub const UNCUT: u32 = 1;
}

/// A part: a range of the BVH nodes and primitives. 16 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Part {
    /// In `bvh_nodes`.
    pub first_node: u32,
    /// Nodes.
    pub node_count: u32,
    /// In `primitives`.
    pub first_primitive: u32,
    /// Primitives.
    pub primitive_count: u32,
}

/// What carries a face.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FaceKind {
    /// `u x + v y`.
    Plane = 0,
    /// Radius `radius_0`.
    Cylinder = 1,
    /// Radius `radius_0` at v = 0, slope `tan α` in `radius_1`.
    Cone = 2,
    /// Radius `radius_0`.
    Sphere = 3,
    /// Major `radius_0`, minor `radius_1`.
    Torus = 4,
    /// Bézier nets.
    Nets = 5,
}

/// A face: its carrier, its trim window, its trim tree. 128 bytes.
///
/// For analytic kinds the carrier's frame has its origin at `grid · grid_step + offset` in part space and the given axes. Parameters are
/// those of the geometry module but for planes, cylinders and cones, whose frame is slid along the surface to the middle of the trim
/// window (planes along u and v, the others along their axis), for precision: their `uv_low` and a cone's radius belong to the slid frame.
/// The surface's own parameters of a normalised (u, v) are `FaceInfo::uv_low + (u, v) · FaceInfo::uv_size`, whatever the kind.
/// For nets `offset` is 0 and the axes are those of part space; `uv_low` and `uv_scale` are not used by kernels, as [`Net::uv_low`] is normalised.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Face {
    /// Origin of face space in part space, grid steps.
    pub grid: [i32; 3],
    /// A [`FaceKind`].
    pub kind: u32,
    /// Unit vector.
    pub x_axis: [f32; 3],
    /// See [`FaceKind`].
    pub radius_0: f32,
    /// Unit vector.
    pub y_axis: [f32; 3],
    /// See [`FaceKind`].
    pub radius_1: f32,
    /// Unit vector.
    pub z_axis: [f32; 3],
    /// [`Face::REVERSED`], [`Face::ALONE`], [`Face::CLOSED`].
    pub flags: u32,
    /// Frame origin in face space, each component within a grid step.
    pub offset: [f32; 3],
    /// Index into `materials`.
    pub material: u32,
    /// Least u and v of the trim window, in the parameters of the (slid) frame.
    pub uv_low: [f32; 2],
    /// 1 / window size: normalised = (parameter − low) · scale.
    pub uv_scale: [f32; 2],
    /// Periods in normalised units, at least 1 (up to rounding); 0 where not periodic.
    pub period: [f32; 2],
    /// [`super::TRIM_INSIDE`] where the whole window is inside, or index of the root in `trim_nodes`. Either way what lies outside the window,
    /// after wrapping and up to rounding, is outside.
    pub trim_root: u32,
    /// Index of the part.
    pub part: u32,
    /// How far beside the ray, part space, the face's border may be off: its distance from the edge in the model, and what f32 rounds of
    /// a hit and of the trim curves.
    pub slack: f32,
    /// Index into `body_infos`.
    pub body: u32,
    /// Unused, 0.
    pub reserved: [u32; 2],
}

impl Face {
    /// Bit of `flags`: the outward normal is `−(S_u × S_v)`.
    pub const REVERSED: u32 = 1;
    /// Bit of `flags`: no other face has to meet it, so that nothing beyond its border belongs to it.
    pub const ALONE: u32 = 2;
    /// Bit of `flags`: the faces of its body enclose a volume.
    pub const CLOSED: u32 = 4;
}

/// A rational Bézier patch. 32 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Net {
    /// In `net_points`; `(degree_u + 1) · (degree_v + 1)` points, v fastest.
    pub first_point: u32,
    /// `degree_u | degree_v << 8 | rational << 16`, and [`point_side`]s; not rational: all weights are 1.
    pub degrees: u32,
    /// The face.
    pub face: u32,
    /// Unused, 0.
    pub reserved: u32,
    /// Normalised face parameters of local (0, 0), before wrapping.
    pub uv_low: [f32; 2],
    /// Normalised face parameters per local unit.
    pub uv_size: [f32; 2],
}

/// Bit of [`Net::degrees`]: the side where the parameter `axis` is `end`, 0 or 1, is one point.
#[inline(always)]
pub const fn point_side(axis: usize, end: usize) -> u32 {
    1 << (17 + 2 * axis + end)
}

/// A sub-domain of a net and its skew-slab bound, in face space. 64 bytes.
///
/// With `n = tangent_u × tangent_v / |·|`, every point of the surface over the sub-domain is
/// `center + α tangent_u + β tangent_v + γ n` with `|α| <= ½ + extent_u`, `|β| <= ½ + extent_v`, `|γ| <= extent_n`.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct NetLeaf {
    /// Centre of the slab.
    pub center: [f32; 3],
    /// Half thickness along n, millimetres.
    pub extent_n: f32,
    /// Mean S_u times the sub-domain's length along u.
    pub tangent_u: [f32; 3],
    /// Excess over ½.
    pub extent_u: f32,
    /// Mean S_v times the sub-domain's length along v.
    pub tangent_v: [f32; 3],
    /// Excess over ½.
    pub extent_v: f32,
    /// Bounds over the leaf, a byte each, from low to high E_α, E_β, E_γ in units of 1/64, and M as in [`bend_byte`], rounded up; 255: no
    /// bound.
    ///
    /// With S over s, t in [0, 1] across the leaf, and α, β, γ the coordinates above (γ along the unit normal):
    /// `E_α >= max|α_s − 1| + max|α_t|`, `E_β >= max|β_s| + max|β_t − 1|`, `E_γ >= (max|γ_s| + max|γ_t|) / m`,
    /// `M >= (max|S_ss| + 2 max|S_st| + max|S_tt|) / m` with `m = min(|tangent_u|, |tangent_v|)`.
    pub certificate: u32,
    /// u index 12 bit, u level 4 bit, v index 12 bit, v level 4 bit from low to high: the sub-domain is
    /// `[index, index + 1] / 2^level` in local parameters.
    pub domain: u32,
    /// The net.
    pub net: u32,
    /// [`super::TRIM_INSIDE`] where no trim test is needed, else a root in `trim_nodes` (that of the face).
    pub trim: u32,
}

/// The byte of a bound M: the highest 8 of the 12 bits that are left of an f32's exponent and fraction, counted from 2⁻⁶. The least that
/// is not below the bound, at most an eighth above it; 255 where there is none.
pub fn bend_byte(bound: f32) -> u32 {
    let steps = (bound.to_bits() + ((1 << 20) - 1)) >> 20;
    let byte = steps.saturating_sub(BEND_BIAS);
    if bound >= 0.0 && byte < 255 { byte } else { 255 }
}

/// The bound of a byte.
#[inline(always)]
pub fn bend_bound(byte: u32) -> f32 {
    f32::from_bits((byte + BEND_BIAS) << 20)
}

/// The upper 12 bits of 2⁻⁶.
const BEND_BIAS: u32 = 121 << 3;

/// What a face looks like. 32 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Material {
    /// Linear-light red, green, blue, in 0..=1.
    pub rgb: [f32; 3],
    /// 1 is opaque.
    pub opacity: f32,
    /// 0 is a mirror, 1 is chalk; the width of highlights is its square, as in glTF.
    pub roughness: f32,
    /// 0 is plastic or paint, 1 is bare metal.
    pub metallic: f32,
    /// Unused, 0.
    pub reserved: [u32; 2],
}

impl Material {
    /// The roughness where a file tells none, as all CAD files do.
    pub const DEFAULT_ROUGHNESS: f32 = 0.45;

    /// An opaque one that is like paint, of a linear-light colour.
    pub const fn of_color(rgb: [f32; 3]) -> Self {
        Self { rgb, opacity: 1.0, roughness: Self::DEFAULT_ROUGHNESS, metallic: 0.0, reserved: [0; 2] }
    }
}

/// A face in f64, same meaning as in [`Face`]. 160 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct FaceF64 {
    /// Frame origin in part space, millimetres, grid included (nets: `grid · grid_step`).
    pub origin: [f64; 3],
    /// Unit vector.
    pub x_axis: [f64; 3],
    /// Unit vector.
    pub y_axis: [f64; 3],
    /// Unit vector.
    pub z_axis: [f64; 3],
    /// See [`FaceKind`].
    pub radii: [f64; 2],
    /// Least u and v of the trim window, in the parameters of the (slid) frame.
    pub uv_low: [f64; 2],
    /// 1 / window size.
    pub uv_scale: [f64; 2],
    /// Periods in normalised units; 0 where not periodic.
    pub period: [f64; 2],
}

/// An instance in f64. 96 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct InstanceF64 {
    /// Rows of the linear map part ← world.
    pub part_from_world: [[f64; 3]; 3],
    /// World position of the part's origin, millimetres.
    pub origin: [f64; 3],
}

/// Levels of a BVH at most; those of the BVH over instances and of a part's together stay within a stack of 32 entries on a GPU.
pub const MAX_TREE_DEPTH: usize = 16;

/// The highest degree of nets and trim curves that the kernels evaluate.
pub const MAX_DEGREE: u32 = 25;

/// The material index that means "as the face says".
pub const NO_MATERIAL: u32 = u32::MAX;

/// Words of `primitives` below the top BVH.
pub mod primitive {
    /// What a word stands for.
    #[derive(Debug, Clone, Copy, PartialEq, Eq)]
    pub enum Primitive {
        /// A whole analytic face, by index.
        Face(u32),
        /// A net leaf, by index.
        NetLeaf(u32),
    }

    /// The bit that marks a net leaf.
    pub const NET_LEAF_BIT: u32 = 1 << 31;

    /// The word of a primitive; indices have 31 bits.
    pub const fn pack(primitive: Primitive) -> u32 {
        match primitive {
            Primitive::Face(index) => index,
            Primitive::NetLeaf(index) => index | NET_LEAF_BIT,
        }
    }

    /// The primitive of a word.
    pub const fn unpack(word: u32) -> Primitive {
        if word & NET_LEAF_BIT == 0 {
            Primitive::Face(word)
        } else {
            Primitive::NetLeaf(word & !NET_LEAF_BIT)
        }
    }
}
