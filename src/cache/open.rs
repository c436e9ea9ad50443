//! Opening: the file is mapped, its table and then the whole scene are checked, unless that was found sound before, and only then used.

use super::format::{
    ENDIAN_MARK, FileHeader, MAGIC, PAGE, SECTION_KINDS, Section, SectionEntry, VERSION, table_check,
};
use super::sound::SoundFiles;
use super::{CacheError, Provenance};
use crate::scene::{Header, Metadata, Scene, validate};
use bytemuck::Pod;
use memmap2::{Mmap, MmapMut};
use std::ops::Range;
use std::path::Path;

/// A mapped cache file, validated now or before.
///
/// The file must not be changed while it is mapped; [`super::write`] replaces files instead of changing them.
#[derive(Debug)]
pub struct CacheFile {
    map: Mmap,
    header: Header,
    metadata: Metadata,
    provenance: Provenance,
    sections: [Range<usize>; SECTION_KINDS],
}

/// An offset and what is wrong there.
type Flaw = (u64, String);

impl CacheFile {
    /// Maps and validates.
    ///
    /// # Errors
    ///
    /// It cannot be read, or is not a whole and sound file of this version.
    pub fn open(path: &Path) -> Result<Self, CacheError> {
        Self::open_unless_sound(path, None)
    }

    /// Maps, and validates but for what was found sound before.
    pub(super) fn open_unless_sound(path: &Path, sound: Option<&SoundFiles>) -> Result<Self, CacheError> {
        let failed = |source| CacheError::Io { path: path.to_owned(), source };
        let invalid = |(at, reason)| CacheError::Invalid { path: path.to_owned(), at, reason };
        let file = std::fs::File::open(path).map_err(failed)?;
        let before = file.metadata().map_err(failed)?;
        // SAFETY: the map is read-only. Writers of this crate rename a new file into place and never change one that may be mapped; a
        // foreign writer that does can make reads fail or end in a panic, as with any map; no index is used without a check of bounds.
        let map = unsafe { Mmap::map(&file) }.map_err(failed)?;
        let opened = Self::from_map(map).map_err(invalid)?;
        if !sound.is_some_and(|sound| sound.has(&before)) {
            opened.check().map_err(invalid)?;
            if let (Some(sound), Ok(now)) = (sound, file.metadata()) {
                sound.add(&before, &now);
            }
        }
        Ok(opened)
    }

    /// Validates the bytes of a cache file that is no file, on a copy of them.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CacheError> {
        let path = || "memory".into();
        let copy = || {
            let mut map = MmapMut::map_anon(bytes.len().max(1))?;
            map[..bytes.len()].copy_from_slice(bytes);
            map.make_read_only()
        };
        let map = copy().map_err(|source| CacheError::Io { path: path(), source })?;
        let opened = Self::from_map(map).and_then(|opened| opened.check().map(|()| opened));
        opened.map_err(|(at, reason)| CacheError::Invalid { path: path(), at, reason })
    }

    /// Checks the table alone.
    fn from_map(map: Mmap) -> Result<Self, Flaw> {
        let (file_header, sections) = read_table(&map)?;
        let header_bytes = &map[sections[Section::Header as usize].clone()];
        let header: Header = bytemuck::try_pod_read_unaligned(header_bytes)
            .map_err(|_| (0, "it has no scene header; bake the model again".to_owned()))?;
        let metadata_range = sections[Section::Metadata as usize].clone();
        let metadata = postcard::from_bytes(&map[metadata_range.clone()]).map_err(|error| {
            (metadata_range.start as u64, format!("its metadata cannot be read: {error}"))
        })?;
        let provenance = Provenance {
            source_hash: file_header.source_hash,
            distortion: file_header.distortion,
            trim_tolerance: file_header.trim_tolerance,
        };
        Ok(Self { map, header, metadata, provenance, sections })
    }

    fn check(&self) -> Result<(), Flaw> {
        validate(&self.scene()).map_err(|flaw| (0, format!("its scene is unsound: {flaw}")))
    }

    /// The file's size.
    pub fn bytes(&self) -> u64 {
        self.map.len() as u64
    }

    /// The scene in it.
    pub fn scene(&self) -> Scene<'_> {
        Scene {
            metadata: &self.metadata,
            header: &self.header,
            bvh_nodes: self.array(Section::BvhNodes),
            primitives: self.array(Section::Primitives),
            instances: self.array(Section::Instances),
            parts: self.array(Section::Parts),
            faces: self.array(Section::Faces),
            nets: self.array(Section::Nets),
            net_leaves: self.array(Section::NetLeaves),
            net_points: self.array(Section::NetPoints),
            trim_nodes: self.array(Section::TrimNodes),
            trim_segments: self.array(Section::TrimSegments),
            trim_points: self.array(Section::TrimPoints),
            materials: self.array(Section::Materials),
            faces_f64: self.array(Section::FacesF64),
            instances_f64: self.array(Section::InstancesF64),
            net_points_f64: self.array(Section::NetPointsF64),
            edge_pieces: self.array(Section::EdgePieces),
            edge_points: self.array(Section::EdgePoints),
            face_infos: self.array(Section::FaceInfos),
            body_infos: self.array(Section::BodyInfos),
        }
    }

    /// What the scene was baked from, and how.
    pub fn provenance(&self) -> &Provenance {
        &self.provenance
    }

    fn array<T: Pod>(&self, section: Section) -> &[T] {
        // Tables with another element size are refused, and sections start on pages of a map that starts on a page.
        bytemuck::try_cast_slice(&self.map[self.sections[section as usize].clone()])
            .expect("a checked section holds whole, aligned elements")
    }
}

/// Bytes of an element of each kind of section.
fn element_sizes() -> [usize; SECTION_KINDS] {
    use crate::scene::{
        BodyInfo, BvhNode, EdgePiece, Face, FaceF64, FaceInfo, Instance, InstanceF64, Material, Net, NetLeaf,
        Part, TrimSegment,
    };
    [
        size_of::<Header>(),
        1,
        size_of::<BvhNode>(),
        size_of::<u32>(),
        size_of::<Instance>(),
        size_of::<Part>(),
        size_of::<Face>(),
        size_of::<Net>(),
        size_of::<NetLeaf>(),
        size_of::<[f32; 4]>(),
        size_of::<u32>(),
        size_of::<TrimSegment>(),
        size_of::<[f32; 3]>(),
        size_of::<Material>(),
        size_of::<FaceF64>(),
        size_of::<InstanceF64>(),
        size_of::<[f64; 4]>(),
        size_of::<EdgePiece>(),
        size_of::<[f32; 4]>(),
        size_of::<FaceInfo>(),
        size_of::<BodyInfo>(),
    ]
}

/// The header and the byte range of every section, empty where absent.
fn read_table(map: &[u8]) -> Result<(FileHeader, [Range<usize>; SECTION_KINDS]), Flaw> {
    const START: usize = size_of::<FileHeader>();
    let again = |at: usize, what: &str| (at as u64, format!("{what}; bake the model again"));
    let start = map.get(..START).ok_or_else(|| again(map.len(), "the file ends within its header"))?;
    let header: FileHeader = bytemuck::pod_read_unaligned(start);
    if header.magic != MAGIC {
        return Err((0, "it is not a trimray file".to_owned()));
    }
    if header.endian_mark != ENDIAN_MARK {
        return Err(again(12, "it was written on a machine of another byte order"));
    }
    if header.version != VERSION {
        let reason = format!("its format is version {}, this program reads {VERSION}", header.version);
        return Err(again(8, &reason));
    }
    if header.file_size != map.len() as u64 {
        return Err(again(map.len(), "the file is not as long as it says"));
    }
    let count = header.sections as usize;
    if count > SECTION_KINDS {
        return Err(again(0, "it has more sections than there are"));
    }
    let end = START + count * size_of::<SectionEntry>();
    let bytes = map.get(START..end).ok_or_else(|| again(map.len(), "the file ends within its table"))?;
    let table: Vec<SectionEntry> = bytemuck::pod_collect_to_vec(bytes);
    if table_check(&table) != header.table_check {
        return Err(again(START, "its section table is damaged"));
    }
    let sizes = element_sizes();
    let mut sections: [Range<usize>; SECTION_KINDS] = std::array::from_fn(|_| 0..0);
    for (index, entry) in table.iter().enumerate() {
        let at = START + index * size_of::<SectionEntry>();
        let kind = entry.id as usize;
        let size = *sizes.get(kind).ok_or_else(|| again(at, "a section is of no known kind"))? as u64;
        let length = entry.count.checked_mul(size);
        let end = length.and_then(|length| entry.offset.checked_add(length));
        let valid = u64::from(entry.element_size) == size
            && entry.offset % PAGE == 0
            && entry.offset >= PAGE
            && end.is_some_and(|end| end <= map.len() as u64)
            && sections[kind].is_empty();
        let Some(end) = end.filter(|_| valid) else {
            return Err(again(at, "a section does not fit into the file"));
        };
        sections[kind] = entry.offset as usize..end as usize;
    }
    Ok((header, sections))
}
