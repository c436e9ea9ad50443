//! `--id-map`: what the numbers in an EXR file's `id.part` and `id.face` stand for. Names of fields are those of the JSON object: they stay.

use crate::image::{encode_srgb, matte_id};
use crate::scene::{Material, NO_MATERIAL, Scene};
use serde::Serialize;

/// The file.
#[derive(Debug, Serialize)]
pub(super) struct IdMap<'a> {
    file: &'a str,
    /// In the order of their numbers, which begin with 1.
    parts: Vec<PartEntry<'a>>,
    /// In the order of their numbers, which begin with 1.
    faces: Vec<FaceEntry<'a>>,
}

/// A placed part.
#[derive(Debug, Serialize)]
struct PartEntry<'a> {
    id: usize,
    /// Names from the root of the product tree.
    path: &'a str,
    /// Of the part.
    name: &'a str,
    /// Of the part in the CAD file.
    entity: String,
    /// Of this placement, #rrggbb in sRGB; absent where the faces have their own.
    color: Option<String>,
    /// What Cryptomatte calls it.
    cryptomatte: &'a str,
    /// Its hash there.
    hash: String,
}

/// A face of a part, wherever that stands.
#[derive(Debug, Serialize)]
struct FaceEntry<'a> {
    id: usize,
    /// In the CAD file.
    entity: String,
    /// The part's name.
    part: &'a str,
    /// #rrggbb in sRGB.
    color: String,
}

impl<'a> IdMap<'a> {
    /// Of a scene; `names` are those of its instances in Cryptomatte.
    pub(super) fn of(scene: &Scene<'a>, names: &'a [String]) -> Self {
        let metadata = scene.metadata;
        let part = |index: u32| &metadata.parts[index as usize];
        let instances = scene.instances.iter().zip(&metadata.instances).zip(names).enumerate();
        let parts = instances.map(|(index, ((instance, info), cryptomatte))| PartEntry {
            id: index + 1,
            path: &info.path,
            name: &part(instance.part).name,
            entity: format!("#{}", part(instance.part).entity),
            color: (instance.material != NO_MATERIAL)
                .then(|| hex(&scene.materials[instance.material as usize])),
            cryptomatte,
            hash: format!("{:08x}", matte_id(cryptomatte)),
        });
        let faces = scene.faces.iter().zip(scene.face_infos).enumerate();
        let faces = faces.map(|(index, (face, info))| FaceEntry {
            id: index + 1,
            entity: format!("#{}", info.entity),
            part: &part(face.part).name,
            color: hex(&scene.materials[face.material as usize]),
        });
        Self { file: &metadata.file_name, parts: parts.collect(), faces: faces.collect() }
    }

    /// The bytes of the file.
    pub(super) fn encode(&self) -> anyhow::Result<Vec<u8>> {
        let mut bytes = serde_json::to_vec_pretty(self)?;
        bytes.push(b'\n');
        Ok(bytes)
    }
}

fn hex(material: &Material) -> String {
    let [r, g, b] = material.rgb.map(|channel| encode_srgb(f64::from(channel)));
    format!("#{r:02x}{g:02x}{b:02x}")
}
