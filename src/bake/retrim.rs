//! A scene whose trims are searched by another method: the same nets, leaves and BVHs, other trim arrays.

use super::assemble::add_trim;
use super::region::Region;
use super::study::{self, Structure};
use super::trim_segments::Evaluation;
use super::trim_tree;
use crate::scene::{SceneBuffers, TRIM_INSIDE, TrimMethod, TrimStructure};
use rayon::prelude::*;

/// What [`retrim`] needs to know of a bake: the trimmed regions of the scene's faces, in their order, and who asks the default trees.
#[derive(Debug, Clone, Default)]
pub struct TrimRegions {
    pub(super) regions: Vec<Region>,
    /// For each face whether its default tree is needed.
    asks: Vec<bool>,
    /// For each net leaf whether it lies wholly inside.
    is_inside: Vec<bool>,
}

impl TrimRegions {
    /// Of a scene of the default method, just baked.
    pub(super) fn new(regions: Vec<Region>, scene: &SceneBuffers) -> Self {
        Self {
            regions,
            asks: scene.faces.iter().map(|face| face.trim_root != TRIM_INSIDE).collect(),
            is_inside: scene.net_leaves.iter().map(|leaf| leaf.trim == TRIM_INSIDE).collect(),
        }
    }
}

/// Replaces the trim arrays and all that points into them by those of `method`.
///
/// With the default method a leaf that lies wholly inside asks nothing, as baked. With those of the study every leaf of a trimmed face asks, as in
/// the papers; so do those of an untrimmed one that reaches beyond its window. `regions` are those of the same bake.
///
/// # Errors
///
/// The reason why the method cannot hold these regions; the scene is as it was then.
pub fn retrim(scene: &mut SceneBuffers, regions: &TrimRegions, method: TrimMethod) -> Result<(), String> {
    if scene.faces.len() != regions.regions.len() || scene.net_leaves.len() != regions.is_inside.len() {
        return Err("these are not the regions of this scene".into());
    }
    if method.structure() != TrimStructure::Packed {
        return retrim_for_study(scene, regions, method);
    }
    let trees: Vec<_> = regions
        .regions
        .par_iter()
        .zip(&regions.asks)
        .map(|(region, &asks)| asks.then(|| trim_tree::build(region, Evaluation::of(method))).transpose())
        .collect::<Result<_, _>>()?;
    clear(scene, method);
    for (face, tree) in trees.into_iter().enumerate() {
        scene.faces[face].trim_root = tree.map_or(TRIM_INSIDE, |tree| add_trim(scene, &tree));
    }
    for (leaf, &is_inside) in scene.net_leaves.iter_mut().zip(&regions.is_inside) {
        let face = scene.nets[leaf.net as usize].face as usize;
        leaf.trim = if is_inside { TRIM_INSIDE } else { scene.faces[face].trim_root };
    }
    Ok(())
}

fn retrim_for_study(
    scene: &mut SceneBuffers,
    regions: &TrimRegions,
    method: TrimMethod,
) -> Result<(), String> {
    let structures: Vec<Option<Structure>> = regions
        .regions
        .par_iter()
        .zip(&regions.asks)
        .map(|(region, &asks)| (asks || region.is_bounded).then(|| study::build(region, method)).transpose())
        .collect::<Result<_, _>>()?;
    let words: usize = structures.iter().flatten().map(|structure| structure.words.len()).sum();
    if words >= TRIM_INSIDE as usize / 4 {
        return Err(format!("{} needs more words than indices", method.label()));
    }
    clear(scene, method);
    for (face, structure) in structures.into_iter().enumerate() {
        let root = structure.map_or(TRIM_INSIDE, |mut structure| {
            let root = scene.trim_nodes.len() as u32;
            structure.words[0] = scene.trim_points.len() as u32;
            scene.trim_nodes.append(&mut structure.words);
            scene.trim_points.append(&mut structure.points);
            scene.header.max_trim_degree = scene.header.max_trim_degree.max(structure.max_degree);
            root
        });
        scene.faces[face].trim_root = root;
    }
    for leaf in &mut scene.net_leaves {
        leaf.trim = scene.faces[scene.nets[leaf.net as usize].face as usize].trim_root;
    }
    Ok(())
}

fn clear(scene: &mut SceneBuffers, method: TrimMethod) {
    scene.header.trim_method = method.number();
    scene.header.max_trim_degree = 0;
    scene.trim_nodes.clear();
    scene.trim_segments.clear();
    scene.trim_points.clear();
}
