//! Looks that win over the file's.
//!
//! A scene's materials are indices of faces and of instances, and parts are shared between instances. What an override says of one instance, of one property
//! alone perhaps, is said by a block of materials of its own: the whole list once more, changed, to which [`Instance::material_shift`]
//! leads. Geometry is shared with the scene as it was baked; faces are copied only where faces themselves are overridden.

use crate::scene::{Face, Instance, Material, NO_MATERIAL, Scene};
use std::collections::HashMap;

/// What is said of a look; what is not said stays as it is.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Override {
    /// Linear light, in 0..=1.
    pub rgb: Option<[f32; 3]>,
    /// As in [`Material`].
    pub roughness: Option<f32>,
    /// As in [`Material`].
    pub metallic: Option<f32>,
    /// As in [`Material`].
    pub opacity: Option<f32>,
}

impl Override {
    fn of(&self, material: Material) -> Material {
        Material {
            rgb: self.rgb.unwrap_or(material.rgb),
            opacity: self.opacity.unwrap_or(material.opacity),
            roughness: self.roughness.unwrap_or(material.roughness),
            metallic: self.metallic.unwrap_or(material.metallic),
            ..material
        }
    }
}

/// An override of some instances and some faces, a truth for each.
#[derive(Debug, Clone, PartialEq)]
pub struct PartOverride {
    /// What is said.
    pub look: Override,
    /// Of which instances.
    pub instances: Vec<bool>,
    /// Of which faces, wherever they are placed.
    pub faces: Vec<bool>,
}

/// The arrays of a scene that overrides change.
#[derive(Debug, Clone, PartialEq)]
pub struct Overridden {
    /// All looks.
    pub materials: Vec<Material>,
    /// All placements.
    pub instances: Vec<Instance>,
    /// All faces; `None` where they stay as they are.
    faces: Option<Vec<Face>>,
}

impl Overridden {
    /// The scene with these looks.
    pub fn of<'a>(&'a self, scene: &Scene<'a>) -> Scene<'a> {
        let faces = self.faces.as_deref().unwrap_or(scene.faces);
        Scene { materials: &self.materials, instances: &self.instances, faces, ..*scene }
    }
}

/// Which of the overrides mean something, by index and in order.
type Means = Vec<usize>;

/// Overrides the looks of everything, then those of parts, one after the other: the last one wins.
///
/// `None` where the materials would be more than 2³¹.
pub fn override_looks(scene: &Scene<'_>, all: &Override, parts: &[PartOverride]) -> Option<Overridden> {
    let base: Vec<Material> = scene.materials.iter().map(|&material| all.of(material)).collect();
    let (classes, faces) = face_classes(scene, parts);
    let mut has_own_faces = vec![false; scene.parts.len()];
    for face in faces.iter().flatten().filter(|face| !classes[face.material as usize].1.is_empty()) {
        has_own_faces[face.part as usize] = true;
    }
    let look = |material: u32, of_face: &Means, of_instance: &Means| {
        let mut means: Means = of_face.iter().chain(of_instance).copied().collect();
        means.sort_unstable();
        means.iter().fold(base[material as usize], |look, &index| parts[index].look.of(look))
    };
    // The first block is that of instances of which nothing is said.
    let nothing = Means::new();
    let mut materials: Vec<Material> =
        classes.iter().map(|(material, means)| look(*material, means, &nothing)).collect();
    let mut instances = scene.instances.to_vec();
    // By the occurrence's material, what is said, and whether faces differ.
    let mut known: HashMap<(u32, Means, bool), (u32, u32)> = HashMap::new();
    for (index, instance) in instances.iter_mut().enumerate() {
        let means: Means = (0..parts.len()).filter(|&part| parts[part].instances[index]).collect();
        let own = instance.material;
        let has_own_faces = has_own_faces[instance.part as usize];
        if means.is_empty() && (own == NO_MATERIAL || !has_own_faces) {
            continue;
        }
        let differs = own == NO_MATERIAL || has_own_faces;
        let key = (own, means, differs);
        let (material, shift) = match known.get(&key) {
            Some(&found) => found,
            None => {
                let first = u32::try_from(materials.len()).ok().filter(|&first| first < 1 << 31)?;
                let means = &key.1;
                let found = if differs {
                    let whose = |of_class: u32| if own == NO_MATERIAL { of_class } else { own };
                    materials.extend(
                        classes.iter().map(|(material, of_face)| look(whose(*material), of_face, means)),
                    );
                    (NO_MATERIAL, first)
                } else {
                    materials.push(look(own, &nothing, means));
                    (first, 0)
                };
                known.insert(key, found);
                found
            }
        };
        (instance.material, instance.material_shift) = (material, shift);
    }
    Some(Overridden { materials, instances, faces })
}

/// The looks that faces have before it matters where they are placed: the materials of the scene in their order, then those of overridden faces;
/// and the faces, which lead to them, where any is overridden.
fn face_classes(scene: &Scene<'_>, parts: &[PartOverride]) -> (Vec<(u32, Means)>, Option<Vec<Face>>) {
    let mut classes: Vec<(u32, Means)> =
        (0..scene.materials.len() as u32).map(|material| (material, Means::new())).collect();
    if !parts.iter().any(|part| part.faces.contains(&true)) {
        return (classes, None);
    }
    let mut known: HashMap<(u32, Means), u32> = HashMap::new();
    let mut faces = scene.faces.to_vec();
    for (index, face) in faces.iter_mut().enumerate() {
        let means: Means = (0..parts.len()).filter(|&part| parts[part].faces[index]).collect();
        if !means.is_empty() {
            face.material = *known.entry((face.material, means)).or_insert_with_key(|class| {
                classes.push(class.clone());
                (classes.len() - 1) as u32
            });
        }
    }
    (classes, Some(faces))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::cpu::shade::hit_material;
    use crate::render::cpu::test_scenes::{TestFace, scene_of};
    use crate::scene::FaceKind;
    use glam::{DAffine3, DVec3};

    fn plane() -> TestFace {
        TestFace::analytic(FaceKind::Plane, [0.0; 2], [-1.0; 2], [1.0; 2])
    }

    fn metal(metallic: f32) -> Override {
        Override { metallic: Some(metallic), ..Override::default() }
    }

    fn painted(red: f32) -> Override {
        Override { rgb: Some([red, 0.0, 0.0]), ..Override::default() }
    }

    #[test]
    fn the_last_override_of_a_property_wins_and_the_others_stay() {
        let places = [0.0, 10.0, 20.0].map(|x| DAffine3::from_translation(DVec3::X * x));
        let mut buffers = scene_of(&[plane(), plane()], &places);
        let other = Material { opacity: 0.25, ..Material::of_color([0.0, 0.0, 1.0]) };
        buffers.materials.push(other);
        buffers.instances[2].material = 1;
        let scene = buffers.scene();
        let said = |look, instances: [bool; 3], faces: [bool; 2]| PartOverride {
            look,
            instances: instances.to_vec(),
            faces: faces.to_vec(),
        };
        let parts = [
            said(painted(0.5), [true, false, false], [false, true]),
            said(metal(1.0), [false, true, true], [false; 2]),
            said(painted(0.9), [false, false, true], [false; 2]),
        ];
        let all = Override { roughness: Some(0.1), ..Override::default() };
        let overridden = override_looks(&scene, &all, &parts).expect("few materials");
        let changed = overridden.of(&scene);
        let look = |instance, face| {
            let Material { rgb, opacity, roughness, metallic, .. } = hit_material(&changed, instance, face);
            assert_eq!(roughness, 0.1);
            (rgb[0], opacity, metallic)
        };
        let file = scene.materials[0].rgb[0];
        assert_eq!([look(0, 0), look(0, 1)], [(0.5, 1.0, 0.0), (0.5, 1.0, 0.0)]);
        assert_eq!([look(1, 0), look(1, 1)], [(file, 1.0, 1.0), (0.5, 1.0, 1.0)]);
        assert_eq!([look(2, 0), look(2, 1)], [(0.9, 0.25, 1.0), (0.9, 0.25, 1.0)]);
    }

    #[test]
    fn what_is_not_overridden_is_as_it_was() {
        let buffers = scene_of(&[plane()], &[DAffine3::IDENTITY]);
        let scene = buffers.scene();
        let overridden = override_looks(&scene, &Override::default(), &[]).expect("few materials");
        assert_eq!((overridden.materials, overridden.faces), (scene.materials.to_vec(), None));
        assert_eq!(overridden.instances, scene.instances);
    }
}
