//! Writing: to a temporary file in the same folder, then one rename, so that a reader never sees half a file.

use super::format::{
    ENDIAN_MARK, FileHeader, MAGIC, PAGE, Section, SectionEntry, VERSION, next_page, table_check,
};
use super::{CacheError, Provenance};
use crate::scene::Scene;
use bytemuck::Pod;
use std::fs::File;
use std::io::{self, Write};
use std::path::Path;

/// Writes `scene` to a temporary file beside `path` and renames it; the file.
///
/// # Errors
///
/// It cannot be written.
pub fn write(path: &Path, scene: &Scene<'_>, provenance: &Provenance) -> Result<File, CacheError> {
    write_file(path, scene, provenance).map_err(|source| CacheError::Io { path: path.to_owned(), source })
}

fn write_file(path: &Path, scene: &Scene<'_>, provenance: &Provenance) -> io::Result<File> {
    let metadata = postcard::to_stdvec(scene.metadata).map_err(io::Error::other)?;
    let mut sections: Vec<(Section, u32, &[u8])> = vec![
        (Section::Header, size_of::<crate::scene::Header>() as u32, bytemuck::bytes_of(scene.header)),
        (Section::Metadata, 1, &metadata),
    ];
    add(&mut sections, Section::BvhNodes, scene.bvh_nodes);
    add(&mut sections, Section::Primitives, scene.primitives);
    add(&mut sections, Section::Instances, scene.instances);
    add(&mut sections, Section::Parts, scene.parts);
    add(&mut sections, Section::Faces, scene.faces);
    add(&mut sections, Section::Nets, scene.nets);
    add(&mut sections, Section::NetLeaves, scene.net_leaves);
    add(&mut sections, Section::NetPoints, scene.net_points);
    add(&mut sections, Section::TrimNodes, scene.trim_nodes);
    add(&mut sections, Section::TrimSegments, scene.trim_segments);
    add(&mut sections, Section::TrimPoints, scene.trim_points);
    add(&mut sections, Section::Materials, scene.materials);
    add(&mut sections, Section::FacesF64, scene.faces_f64);
    add(&mut sections, Section::InstancesF64, scene.instances_f64);
    add(&mut sections, Section::NetPointsF64, scene.net_points_f64);
    add(&mut sections, Section::EdgePieces, scene.edge_pieces);
    add(&mut sections, Section::EdgePoints, scene.edge_points);
    add(&mut sections, Section::FaceInfos, scene.face_infos);
    add(&mut sections, Section::BodyInfos, scene.body_infos);

    let mut table = Vec::with_capacity(sections.len());
    let mut end = PAGE;
    for (id, element_size, bytes) in &sections {
        let offset = next_page(end);
        let count = bytes.len() as u64 / u64::from(*element_size);
        table.push(SectionEntry { id: *id as u32, element_size: *element_size, offset, count });
        end = offset + bytes.len() as u64;
    }
    let header = FileHeader {
        magic: MAGIC,
        version: VERSION,
        endian_mark: ENDIAN_MARK,
        source_hash: provenance.source_hash,
        distortion: provenance.distortion,
        trim_tolerance: provenance.trim_tolerance,
        file_size: end,
        sections: table.len() as u32,
        reserved: 0,
        table_check: table_check(&table),
    };

    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    // Renaming would put a file in the place of a device.
    if std::fs::metadata(path).is_ok_and(|there| !there.is_file()) {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "it exists and is no file"));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".trimray-");
    // Temporary files are private; the result is as readable as the umask lets any new file be.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let temporary = builder.tempfile_in(folder)?;
    let mut out = io::BufWriter::new(&temporary);
    let mut written = 0;
    let mut put = |bytes: &[u8]| -> io::Result<()> {
        written += bytes.len() as u64;
        out.write_all(bytes)
    };
    put(bytemuck::bytes_of(&header))?;
    put(bytemuck::cast_slice(&table))?;
    let mut at = (size_of::<FileHeader>() + table.len() * size_of::<SectionEntry>()) as u64;
    for (entry, (_, _, bytes)) in table.iter().zip(&sections) {
        put(&vec![0; (entry.offset - at) as usize])?;
        put(bytes)?;
        at = entry.offset + bytes.len() as u64;
    }
    debug_assert_eq!(written, end);
    out.flush()?;
    drop(out);
    temporary.persist(path).map_err(|error| error.error)
}

/// Adds an array; an empty one gets no section.
fn add<'a, T: Pod>(sections: &mut Vec<(Section, u32, &'a [u8])>, id: Section, array: &'a [T]) {
    if !array.is_empty() {
        sections.push((id, size_of::<T>() as u32, bytemuck::cast_slice(array)));
    }
}
