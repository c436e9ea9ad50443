//! What is known of pixels on the way to a picture: records that both tracers fill and read, and that the GPU's buffers hold as they are.

use crate::image::{RANKS, Share};
use bytemuck::{Pod, Zeroable};

/// What the ray through a pixel's centre shows. The light of the surface is `dark` where it sees nothing of the sky, `lit` where it sees all of it, and runs
/// straight from one to the other in between. 80 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Center {
    /// World-space unit normal towards the viewer.
    pub normal: [f32; 3],
    /// Distance along the view direction, millimetres; on the GPU from the plane through the scene's centre.
    pub depth: f32,
    /// Linear light without any sky.
    pub dark: [f32; 3],
    /// The share of the sky that is seen, by one ray.
    pub open: f32,
    /// Linear light under the whole sky.
    pub lit: [f32; 3],
    /// Bits: [`INCOMPLETE`], [`SEE_THROUGH`], [`CAP`].
    pub flags: u32,
    /// 1 + index; 0 where nothing is hit.
    pub instance: u32,
    /// 1 + index; 0 where nothing is hit.
    pub face: u32,
    /// Index of the net that is hit, or none.
    pub net: u32,
    /// 0.
    pub reserved_0: u32,
    /// Parameters of the hit as the tracer has them.
    pub uv: [f32; 2],
    /// 0.
    pub reserved_1: [u32; 2],
}

/// A kernel ran out of loop turns: the pixel is not known.
#[cfg_attr(not(feature = "gpu"), expect(dead_code, reason = "only kernels of a GPU have a limit"))]
pub const INCOMPLETE: u32 = 1;
/// What is hit lets light through.
pub const SEE_THROUGH: u32 = 2;
/// A sample beside the left neighbour shows what the neighbour's centre does not; the next three bits: the right one, the upper one, the lower one.
pub const BESIDE_LEFT: u32 = 4;
/// All four.
pub const BESIDE_ALL: u32 = 15 * BESIDE_LEFT;

/// What is hit is the cap of a cut body, whose face is the one by which the ray leaves the body.
pub const CAP: u32 = 64;

/// What the centre of a pixel beside a refined one shows, as far as samples can use it. 48 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Neighbour {
    /// As in [`Center`].
    pub normal: [f32; 3],
    /// The share of the sky that is seen, without the noise of single rays; negative where samples have to look for themselves.
    pub open: f32,
    /// What the eye makes of [`Center::lit`].
    pub perceived: [f32; 3],
    /// As in [`Center`].
    pub instance: u32,
    /// As in [`Center`]; 0 at a cap too.
    pub face: u32,
    /// 1 where fewer than two of its own four neighbours show the same: a part of a line, perhaps, that is thinner than a pixel.
    pub is_alone: u32,
    /// 0.
    pub reserved: [u32; 2],
}

/// A pixel of which all samples are asked for. 256 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct Refined {
    /// Its index, row by row from the top.
    pub pixel: u32,
    /// 0.
    pub reserved: [u32; 3],
    /// The pixel's own centre, then those to the left, to the right, above and below. Those beyond the picture's border repeat the pixel's own.
    pub around: [Neighbour; 5],
}

/// All samples of a pixel.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sampled {
    /// Their mean: linear light, premultiplied, and coverage.
    pub color: [f32; 4],
    /// Bits: [`INCOMPLETE`] and those from [`BESIDE_LEFT`] on.
    pub flags: u32,
    /// The mean colour of what they show first, without light; black unless asked for.
    pub albedo: [f32; 3],
    /// How much the parts cover that they show first; nothing unless asked for.
    pub matte: [Share; RANKS],
}

const _: () = assert!(size_of::<Center>() == 80 && size_of::<Refined>() == 256);

/// What the eye makes of linear light, about: sRGB codes in 0..=1 are its root within a few percent.
pub fn perceived(light: [f32; 3]) -> [f32; 3] {
    light.map(|c| c.max(0.0).sqrt())
}

/// The greatest difference of two [`perceived`] lights in any channel.
pub fn contrast(a: [f32; 3], b: [f32; 3]) -> f32 {
    (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f32::max)
}
