//! The bytes of the file: one page of header and section table, then sections that start on pages.

use bytemuck::{Pod, Zeroable};

/// The first bytes: not text, and broken by anything that rewrites line ends.
pub(super) const MAGIC: [u8; 8] = *b"\x89trmray\n";

/// Changes with every change of a record or of this format.
pub(super) const VERSION: u32 = 11;

/// Reads as another number on a machine of the other byte order.
pub(super) const ENDIAN_MARK: u32 = 0x0a0b_0c0d;

/// Sections start at multiples of this.
pub(super) const PAGE: u64 = 4096;

/// The header. 88 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(super) struct FileHeader {
    pub magic: [u8; 8],
    pub version: u32,
    pub endian_mark: u32,
    pub source_hash: [u8; 32],
    pub distortion: f64,
    pub trim_tolerance: f64,
    /// Bytes of the file.
    pub file_size: u64,
    /// Entries of the section table, which follows the header.
    pub sections: u32,
    pub reserved: u32,
    /// BLAKE3 of the section table, its first 8 bytes.
    pub table_check: u64,
}

/// A section. 24 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub(super) struct SectionEntry {
    /// A [`Section`].
    pub id: u32,
    /// Bytes of an element.
    pub element_size: u32,
    /// In the file.
    pub offset: u64,
    /// Elements.
    pub count: u64,
}

/// What a section holds.
#[repr(u32)]
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Section {
    Header = 0,
    Metadata = 1,
    BvhNodes = 2,
    Primitives = 3,
    Instances = 4,
    Parts = 5,
    Faces = 6,
    Nets = 7,
    NetLeaves = 8,
    NetPoints = 9,
    TrimNodes = 10,
    TrimSegments = 11,
    TrimPoints = 12,
    Materials = 13,
    FacesF64 = 14,
    InstancesF64 = 15,
    NetPointsF64 = 16,
    EdgePieces = 17,
    EdgePoints = 18,
    FaceInfos = 19,
    BodyInfos = 20,
}

/// How many kinds of section there are.
pub(super) const SECTION_KINDS: usize = 21;

/// The check of a section table.
pub(super) fn table_check(table: &[SectionEntry]) -> u64 {
    let hash = blake3::hash(bytemuck::cast_slice(table));
    u64::from_le_bytes(hash.as_bytes()[..8].try_into().expect("a hash has 32 bytes"))
}

/// The first page boundary at or after `offset`.
pub(super) fn next_page(offset: u64) -> u64 {
    offset.div_ceil(PAGE) * PAGE
}
