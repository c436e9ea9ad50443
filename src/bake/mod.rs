//! From the model to the scene: nets, leaves, BVHs, trim trees; f64 until `narrow`.
//!
//! Two passes over the faces, each in parallel and gathered in the model's order, so that the result does not depend on threads: `outline` trims
//! and bounds; then the scene's size, its grid and the parts' centres are known; `faces` makes the records. `assemble` joins them.
//! Faces and placements that cannot be baked are reported, never lost silently.

mod assemble;
mod binary_tree;
mod budget;
mod bvh;
mod edge_kind;
#[cfg(test)]
mod edge_tests;
mod edges;
mod elevate;
mod explode;
mod extent;
mod faces;
mod gaps;
mod judge;
mod keep;
mod leaves;
mod materials;
mod metadata;
mod narrow;
#[cfg(test)]
mod net_tests;
mod nets;
mod outline;
mod rearrange;
mod region;
mod retrim;
mod slab;
mod study;
mod tensor;
#[cfg(test)]
mod tests;
mod times;
mod trim_band;
mod trim_query;
mod trim_segments;
mod trim_statistics;
#[cfg(test)]
mod trim_tests;
mod trim_tree;

use self::assemble::PartDraft;
use self::budget::budget;
use self::bvh::NarrowBox;
pub use self::elevate::Lines;
pub use self::explode::{ExplodedScene, explode};
pub use self::extent::replicate_side_by_side;
use self::faces::{BakedFace, PartSpace, bake_face};
pub use self::judge::TrimJudge;
pub use self::keep::{KeptScene, keep};
use self::materials::MaterialTable;
use self::outline::{Outline, outline};
use self::region::Region;
pub use self::retrim::{TrimRegions, retrim};
pub use self::times::BakeTimes;
use self::times::timed;
use crate::brep::{
    self, BodyKind, Diagnostic, Diagnostics, Face, Id, Model, Occurrence, Severity, occurrences,
};
use crate::numeric::Aabb;
use crate::scene::{self, Header, InstanceInfo, PartInfo, SceneBuffers, TrimMethod};
use crate::trimming::TrimOptions;
use glam::DVec3;
use rayon::prelude::*;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Faces differ in cost by a factor of thousands: few to a task, so that no thread is left with a row of costly ones.
const FACES_PER_TASK: usize = 4;

/// How to bake.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BakeOptions {
    /// The distortion ρ below which a net's sub-domain is a leaf; half of it where the leaf would be large in the scene.
    pub distortion: f64,
    /// How closely trims follow edges.
    pub trim: TrimOptions,
    /// Whether the scene carries f64 geometry beside the f32.
    pub keep_f64: bool,
    /// Whether the scene carries the model's edges, for pictures with lines.
    pub edges: bool,
    /// What trim queries search in.
    pub trim_method: TrimMethod,
}

impl Default for BakeOptions {
    fn default() -> Self {
        Self {
            distortion: 0.125,
            trim: TrimOptions::default(),
            keep_f64: false,
            edges: false,
            trim_method: TrimMethod::default(),
        }
    }
}

/// A model whose faces are trimmed: between the two stages of the bake.
pub struct Trimmed {
    occurrences: Vec<Occurrence>,
    /// Whether the product tree was cut short.
    is_cut: bool,
    /// The parts that stand somewhere, in order of their ids.
    parts: Vec<Id<brep::Part>>,
    drafts: Vec<Draft>,
    /// Control points that the patches of all faces have together.
    patch_points: usize,
}

/// A face on its way through the bake.
struct Draft {
    /// Index into the parts that occur.
    part: usize,
    /// Index into the bodies of those parts.
    body: usize,
    id: Id<Face>,
    /// Whether it is all of a sheet: no face has to meet it.
    is_alone: bool,
    outline: Result<Outline, String>,
}

/// Bakes a model. Faces that cannot be baked are in the metadata's diagnostics, after the model's own.
///
/// The result depends on the model and the options alone, not on threads. `progress` is told (done, total) faces, from any thread.
pub fn bake(model: &Model, options: &BakeOptions, progress: &(dyn Fn(usize, usize) + Sync)) -> SceneBuffers {
    bake_trimmed(model, trim(model, options, progress), options)
}

/// [`bake`], and what [`retrim`] needs to change the scene's trim method.
pub fn bake_with_regions(
    model: &Model,
    options: &BakeOptions,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> (SceneBuffers, TrimRegions) {
    let (scene, regions, _) = bake_parts(model, trim(model, options, progress), options, true);
    (scene, regions)
}

/// The first stage: trims all faces that stand somewhere.
pub fn trim(model: &Model, options: &BakeOptions, progress: &(dyn Fn(usize, usize) + Sync)) -> Trimmed {
    let (occurrences, is_cut) = occurrences(model);
    let parts = parts_that_occur(model, &occurrences);
    let (drafts, patch_points) = outlines(model, &parts, options, progress);
    Trimmed { occurrences, is_cut, parts, drafts, patch_points }
}

/// The second stage: nets, leaves, trim trees, BVHs, instances.
pub fn bake_trimmed(model: &Model, trimmed: Trimmed, options: &BakeOptions) -> SceneBuffers {
    bake_timed(model, trimmed, options).0
}

/// [`bake_trimmed`], and what its steps took.
pub fn bake_timed(model: &Model, trimmed: Trimmed, options: &BakeOptions) -> (SceneBuffers, BakeTimes) {
    let keep_regions = options.trim_method != TrimMethod::PACKED;
    let (scene, _, times) = bake_parts(model, trimmed, options, keep_regions);
    (scene, times)
}

/// The second stage; the regions are empty unless they are asked for.
fn bake_parts(
    model: &Model,
    trimmed: Trimmed,
    options: &BakeOptions,
    keep_regions: bool,
) -> (SceneBuffers, TrimRegions, BakeTimes) {
    let Trimmed { occurrences, is_cut, parts, drafts, patch_points } = trimmed;
    let metadata = metadata::of_model(model, &occurrences);
    let body_infos = metadata::bodies_of(model, &parts);
    let mut scene = SceneBuffers { metadata, body_infos, ..SceneBuffers::default() };
    let mut findings = metadata::findings(model, is_cut);
    scene.metadata.largest_gap = gaps::report(&mut findings, model, &drafts);
    let max_leaves = leaves::most_leaves(patch_points);
    let part_boxes = boxes_of_parts(&drafts, parts.len());
    let (header, spaces) = spaces(&occurrences, &parts, &part_boxes);
    scene.header = header;

    let baked: Vec<Option<Result<BakedFace, String>>> = drafts
        .par_iter()
        .with_max_len(FACES_PER_TASK)
        .map(|draft| {
            let outline = draft.outline.as_ref().ok()?;
            let face = &model.faces[draft.id];
            let surface = &model.surfaces[face.surface];
            let space = &spaces[draft.part];
            Some(bake_face(surface, face, outline, space, draft.is_alone, options.distortion, max_leaves))
        })
        .collect();

    let mut times: BakeTimes = baked.iter().flatten().flatten().map(|face| face.times).sum();
    let mut materials = MaterialTable::default();
    let mut regions = Vec::new();
    let Gathered { slots, part_drafts, faces: added } = gather(
        model,
        &mut scene,
        &mut findings,
        &mut materials,
        &parts,
        &part_boxes,
        &spaces,
        drafts,
        baked,
        options,
        keep_regions.then_some(&mut regions),
    );
    let ((), seconds) = timed(|| add_trees(&mut scene, &mut findings, &part_drafts));
    times.bvhs += seconds;
    let boxes = add_instances(
        model,
        &mut scene,
        &mut findings,
        &mut materials,
        &parts,
        &occurrences,
        &slots,
        &spaces,
        options.keep_f64,
    );
    let ((), seconds) = timed(|| add_top_tree(&mut scene, &mut findings, &boxes));
    times.bvhs += seconds;
    if options.edges {
        edges::add(model, &mut scene, &added, &slots, &spaces);
    }
    metadata::report_unplaced(&mut findings, model, &parts);
    for face in &mut scene.faces {
        if scene.body_infos[face.body as usize].is_closed() {
            face.flags |= scene::Face::CLOSED;
        }
    }
    scene.materials = materials.into_materials();
    let regions = if keep_regions { TrimRegions::new(regions, &scene) } else { TrimRegions::default() };
    if options.trim_method != TrimMethod::PACKED
        && let Err(reason) = retrim(&mut scene, &regions, options.trim_method)
    {
        let reason = format!("{reason}; the default trim method serves instead");
        findings.push(Diagnostic::new(Severity::Warning, 0, "ADVANCED_FACE", reason));
    }
    scene.metadata.findings = metadata::records(&findings);
    (scene, regions, times)
}

/// The parts that stand somewhere, in order of their ids.
fn parts_that_occur(model: &Model, occurrences: &[Occurrence]) -> Vec<Id<brep::Part>> {
    let mut occurs = vec![false; model.parts.len()];
    for occurrence in occurrences {
        occurs[occurrence.part.index()] = true;
    }
    model.parts.ids().filter(|id| occurs[id.index()]).collect()
}

/// Trims all faces of all parts; with the number of control points that their patches have together.
fn outlines(
    model: &Model,
    parts: &[Id<brep::Part>],
    options: &BakeOptions,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> (Vec<Draft>, usize) {
    let bodies = parts.iter().enumerate().flat_map(|(slot, &part)| {
        let bodies = &model.parts[part].bodies;
        bodies.iter().map(move |body| (slot, body))
    });
    let faces: Vec<(usize, usize, bool, Id<Face>)> = bodies
        .enumerate()
        .flat_map(|(index, (slot, body))| {
            let is_alone = body.kind == BodyKind::Sheet && body.faces.len() == 1;
            body.faces.iter().map(move |&face| (slot, index, is_alone, face))
        })
        .collect();
    let budget = budget(model, faces.iter().map(|&(.., id)| id));
    let done = AtomicUsize::new(0);
    let drafts = faces
        .par_iter()
        .with_max_len(FACES_PER_TASK)
        .zip(&budget.refusals)
        .map(|(&(part, body, is_alone, id), refusal)| {
            let outline = match refusal {
                None => outline(model, id, &options.trim),
                Some(reason) => Err((*reason).to_owned()),
            };
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, faces.len());
            Draft { part, body, id, is_alone, outline }
        })
        .collect();
    (drafts, budget.patch_points)
}

fn boxes_of_parts(drafts: &[Draft], parts: usize) -> Vec<Aabb> {
    let mut boxes = vec![Aabb::EMPTY; parts];
    for draft in drafts {
        if let Ok(outline) = &draft.outline {
            boxes[draft.part] = boxes[draft.part].union(outline.bounds);
        }
    }
    boxes
}

/// The size of large leaves, of the scene's diagonal: a picture of a megapixel has some hundred rays for each. From 1/20 to 1/48 pictures of few large nets take
/// 15 to 22 % less time than without, those of many small ones as long.
const LARGE_LEAF: f64 = 1.0 / 32.0;

/// The scene's anchor, grid and size, and the space of each part.
fn spaces(
    occurrences: &[Occurrence],
    parts: &[Id<brep::Part>],
    part_boxes: &[Aabb],
) -> (Header, Vec<PartSpace>) {
    let world = extent::box_of_occurrences(occurrences, parts, part_boxes);
    let grid_step = narrow::grid_step(world.diagonal());
    let center = |bounds: Aabb| {
        if bounds.is_empty() { DVec3::ZERO } else { narrow::snap(bounds.center(), grid_step) }
    };
    let large_leaf = world.diagonal() * LARGE_LEAF;
    let anchor = center(world);
    let half = if world.is_empty() {
        DVec3::ZERO
    } else {
        (world.max - anchor).abs().max((world.min - anchor).abs())
    };
    let header = Header {
        world_anchor: anchor.to_array(),
        grid_step,
        half_size: half.to_array().map(narrow::above),
        ..Header::default()
    };
    let space = |&bounds: &Aabb| PartSpace { center: center(bounds), grid_step, large_leaf };
    (header, part_boxes.iter().map(space).collect())
}

/// For each part that occurs its index in the scene and its box in part space, where any of its faces could be baked.
type Slots = Vec<Option<(u32, Aabb)>>;

/// What [`gather`] made of the baked faces.
struct Gathered {
    slots: Slots,
    /// By index in the scene.
    part_drafts: Vec<PartDraft>,
    /// Those that were added, in order.
    faces: Vec<Id<Face>>,
}

/// Joins faces and parts into the scene, but for the trees over them.
fn gather(
    model: &Model,
    scene: &mut SceneBuffers,
    findings: &mut Diagnostics,
    materials: &mut MaterialTable,
    parts: &[Id<brep::Part>],
    part_boxes: &[Aabb],
    spaces: &[PartSpace],
    drafts: Vec<Draft>,
    baked: Vec<Option<Result<BakedFace, String>>>,
    options: &BakeOptions,
    mut regions: Option<&mut Vec<Region>>,
) -> Gathered {
    let mut slots: Vec<Option<u32>> = vec![None; parts.len()];
    let mut part_drafts: Vec<PartDraft> = Vec::new();
    let mut faces = Vec::with_capacity(drafts.len());
    for (draft, baked) in drafts.into_iter().zip(baked) {
        let face = &model.faces[draft.id];
        let slot = draft.part;
        let dropped = match (draft.outline, baked) {
            (Err(reason), _) | (_, Some(Err(reason))) => Some(reason),
            (Ok(outline), Some(Ok(baked))) => {
                for repair in outline.repairs {
                    findings.push(Diagnostic::new(Severity::Repaired, face.entity, "ADVANCED_FACE", repair));
                }
                for loss in outline.losses {
                    findings.push(Diagnostic::new(Severity::Warning, face.entity, "ADVANCED_FACE", loss));
                }
                let part = *slots[slot].get_or_insert_with(|| {
                    let own = part_boxes[slot];
                    let center = spaces[slot].center;
                    part_drafts.push(PartDraft::new(Aabb { min: own.min - center, max: own.max - center }));
                    let part = &model.parts[parts[slot]];
                    scene.metadata.parts.push(PartInfo { name: part.name.clone(), entity: part.entity });
                    part_drafts.len() as u32 - 1
                });
                let material = materials.index(face.color);
                let target = &mut part_drafts[part as usize];
                let added = assemble::add_face(
                    scene,
                    target,
                    baked,
                    part,
                    draft.body as u32,
                    material,
                    options.keep_f64,
                );
                if added.is_ok() {
                    faces.push(draft.id);
                    if let Some(regions) = &mut regions {
                        regions.push(outline.region);
                    }
                }
                added.err().map(str::to_owned)
            }
            (Ok(_), None) => Some("it has no outline".to_owned()),
        };
        if let Some(reason) = dropped {
            scene.body_infos[draft.body].is_closed = 0;
            let finding = Diagnostic::dropped_face(face.entity, "ADVANCED_FACE", reason);
            findings.push(finding);
        }
    }
    let with_box = |part: u32| (part, part_drafts[part as usize].bounds);
    let slots = slots.into_iter().map(|slot| slot.map(with_box)).collect();
    Gathered { slots, part_drafts, faces }
}

/// Adds the parts and their BVHs. The BVH over instances comes first in the arrays; its nodes are moved there once they are known.
fn add_trees(scene: &mut SceneBuffers, findings: &mut Diagnostics, part_drafts: &[PartDraft]) {
    for (index, result) in assemble::add_parts(scene, part_drafts).into_iter().enumerate() {
        if let Err(reason) = result {
            let mut finding =
                Diagnostic::new(Severity::Dropped, scene.metadata.parts[index].entity, "PRODUCT", reason);
            finding.faces = faces_of(scene, index as u32);
            findings.push(finding);
        }
    }
}

fn faces_of(scene: &SceneBuffers, part: u32) -> u32 {
    scene.faces.iter().filter(|face| face.part == part).count() as u32
}

/// Places the occurrences; returns their boxes.
fn add_instances(
    model: &Model,
    scene: &mut SceneBuffers,
    findings: &mut Diagnostics,
    materials: &mut MaterialTable,
    parts: &[Id<brep::Part>],
    occurrences: &[Occurrence],
    slots: &[Option<(u32, Aabb)>],
    spaces: &[PartSpace],
    keep_f64: bool,
) -> Vec<NarrowBox> {
    let anchor = DVec3::from_array(scene.header.world_anchor);
    let mut boxes = Vec::new();
    let mut lost: Vec<(u32, Diagnostic)> = Vec::new();
    for occurrence in occurrences {
        let Ok(slot) = parts.binary_search(&occurrence.part) else { continue };
        let Some((part, bounds)) = slots[slot] else { continue };
        let material = occurrence.color.map(|color| materials.index(Some(color)));
        match assemble::place(occurrence, part, bounds, &spaces[slot], anchor, material) {
            Ok((instance, exact, corners)) => {
                scene.instances.push(instance);
                scene.metadata.instances.push(InstanceInfo { path: occurrence.path.clone() });
                boxes.push(corners);
                if keep_f64 {
                    scene.instances_f64.push(exact);
                }
            }
            Err(reason) => {
                let entity = model.parts[occurrence.part].entity;
                let reason = format!("{}: {reason}", occurrence.path);
                lost.push((part, Diagnostic::new(Severity::Dropped, entity, "PRODUCT", reason)));
            }
        }
    }
    let mut placed = vec![false; scene.parts.len()];
    scene.instances.iter().for_each(|instance| placed[instance.part as usize] = true);
    for (part, mut finding) in lost {
        // Where no occurrence is left the part's faces are lost with the first one that is named.
        if !std::mem::replace(&mut placed[part as usize], true) {
            finding.faces = faces_of(scene, part);
        }
        findings.push(finding);
    }
    boxes
}

/// Puts the BVH of the instances in front of those of the parts.
fn add_top_tree(scene: &mut SceneBuffers, findings: &mut Diagnostics, boxes: &[NarrowBox]) {
    let top = bvh::build(boxes).unwrap_or_else(|reason| {
        let mut finding = Diagnostic::new(Severity::Dropped, 0, "PRODUCT", reason);
        finding.faces = scene.faces.len() as u32;
        findings.push(finding);
        scene.instances.clear();
        scene.instances_f64.clear();
        scene.metadata.instances.clear();
        bvh::Tree::default()
    });
    scene.header.node_count = top.nodes.len() as u32;
    for part in &mut scene.parts {
        part.first_node += top.nodes.len() as u32;
        part.first_primitive += top.order.len() as u32;
    }
    scene.bvh_nodes.splice(0..0, top.nodes);
    scene.primitives.splice(0..0, top.order);
}
