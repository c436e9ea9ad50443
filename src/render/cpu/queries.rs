//! The trim queries of rays: where a tracer has to ask whether a point of a face is inside its trims.
//!
//! A ray is traced through the scene without its trims; every hit there that the face's own trims must decide is a query. So the queries do not
//! depend on the trim method, and whole leaves that the bake found to be inside ask too, as in the tracers that the study's papers describe.
//! Leaves wholly outside are not in the scene and ask nothing.

use super::NO_NET;
use super::ray_space::{Distance, prepare};
use super::trace::{Candidate, RawHit, face_parameters, keep_first, trace};
use super::trim::{packed_inside, study_method, trim_counted, trim_inside};
use super::trim_study::{TrimCounts, study_inside};
use crate::render::{Exactness, Ray};
use crate::scene::{BodyInfo, Face, NetLeaf, Scene, TRIM_INSIDE, TrimMethod};
use rayon::prelude::*;

/// Rays whose queries are gathered together.
const RAYS_PER_TASK: usize = 256;

/// Tasks whose queries are gathered before they are counted.
const TASKS_PER_ROUND: usize = 64;

/// A point of a face to be decided.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TrimQuery {
    /// Index of the face, which has trims.
    pub face: u32,
    /// Normalised parameters in [0, 1].
    pub uv: [f32; 2],
}

/// The faces and leaves of a scene as if nothing were trimmed but to windows, and so no body closed.
pub struct Untrimmed {
    faces: Vec<Face>,
    net_leaves: Vec<NetLeaf>,
    body_infos: Vec<BodyInfo>,
}

impl Untrimmed {
    /// Of `scene`.
    pub fn new(scene: &Scene<'_>) -> Self {
        let face = |face: &Face| Face { trim_root: TRIM_INSIDE, ..*face };
        let leaf = |leaf: &NetLeaf| NetLeaf { trim: TRIM_INSIDE, ..*leaf };
        let body = |body: &BodyInfo| BodyInfo { is_closed: 0, ..*body };
        Self {
            faces: scene.faces.iter().map(face).collect(),
            net_leaves: scene.net_leaves.iter().map(leaf).collect(),
            body_infos: scene.body_infos.iter().map(body).collect(),
        }
    }

    /// The rest is that of `scene`, of which this was made.
    pub fn scene<'a>(&'a self, scene: &Scene<'a>) -> Scene<'a> {
        Scene { faces: &self.faces, net_leaves: &self.net_leaves, body_infos: &self.body_infos, ..*scene }
    }
}

/// The trim queries of `rays`, ray by ray, at most `most`; those on the way to the first hit, or all.
pub fn trim_queries(scene: &Scene<'_>, rays: &[Ray], first_only: bool, most: usize) -> Vec<TrimQuery> {
    let untrimmed = Untrimmed::new(scene);
    let mut queries = Vec::new();
    for round in rays.chunks(RAYS_PER_TASK * TASKS_PER_ROUND) {
        let found: Vec<Vec<TrimQuery>> = round
            .par_chunks(RAYS_PER_TASK)
            .map(|rays| {
                let mut queries = Vec::new();
                for ray in rays {
                    ask(scene, &untrimmed, ray, first_only, &mut |query| {
                        queries.push(query);
                        answer(scene, &query)
                    });
                }
                queries
            })
            .collect();
        queries.extend(found.into_iter().flatten());
        if queries.len() >= most {
            queries.truncate(most);
            break;
        }
    }
    queries
}

/// What the trim queries on the way to the first hit of `ray` cost.
pub fn first_hit_counts(scene: &Scene<'_>, untrimmed: &Untrimmed, ray: &Ray) -> TrimCounts {
    let mut counts = TrimCounts::default();
    ask(scene, untrimmed, ray, true, &mut |query| {
        let root = scene.faces[query.face as usize].trim_root;
        trim_counted(scene, root, query.uv, &mut counts)
    });
    counts
}

/// The answer to a query.
#[inline]
pub fn answer(scene: &Scene<'_>, query: &TrimQuery) -> bool {
    trim_inside(scene, scene.faces[query.face as usize].trim_root, query.uv)
}

/// How many queries are inside: a loop for this program's own method and one for those of the study, neither of which needs registers for the other.
pub fn count_inside(scene: &Scene<'_>, queries: &[TrimQuery]) -> usize {
    match study_method(scene) {
        Some(method) => count_by_study(scene, method, queries),
        None => count_by_packed(scene, queries),
    }
}

#[inline(never)]
fn count_by_study(scene: &Scene<'_>, method: TrimMethod, queries: &[TrimQuery]) -> usize {
    count(scene, queries, |root, uv| {
        study_inside::<f32, false>(scene, method, root, uv, &mut TrimCounts::default())
    })
}

#[inline(never)]
fn count_by_packed(scene: &Scene<'_>, queries: &[TrimQuery]) -> usize {
    count(scene, queries, |root, uv| packed_inside(scene, root, uv))
}

#[inline(always)]
fn count(scene: &Scene<'_>, queries: &[TrimQuery], inside: impl Fn(u32, [f32; 2]) -> bool) -> usize {
    let is_inside = |query: &&TrimQuery| {
        let root = scene.faces[query.face as usize].trim_root;
        root == TRIM_INSIDE || inside(root, query.uv)
    };
    queries.iter().filter(is_inside).count()
}

/// The answers to queries, and what they cost.
pub fn answers_counted(scene: &Scene<'_>, queries: &[TrimQuery]) -> (Vec<bool>, TrimCounts) {
    let mut counts = TrimCounts::default();
    let ask = |query: &TrimQuery| {
        let root = scene.faces[query.face as usize].trim_root;
        trim_counted(scene, root, query.uv, &mut counts)
    };
    (queries.iter().map(ask).collect(), counts)
}

/// Traces `ray`, asking `inside` of each hit on a face with trims.
fn ask(
    scene: &Scene<'_>,
    untrimmed: &Untrimmed,
    ray: &Ray,
    first_only: bool,
    inside: &mut impl FnMut(TrimQuery) -> bool,
) {
    let Some(prepared) = prepare::<f32>(ray, scene.header) else { return };
    let open = untrimmed.scene(scene);
    let mut first: Option<Candidate<f32>> = None;
    trace(&open, Exactness::default(), &prepared.ray, prepared.near, Distance::INFINITE, &mut |candidate| {
        let is_inside = match query(scene, &candidate.hit) {
            Some(query) => inside(query),
            None => true,
        };
        if is_inside && first_only {
            keep_first(&mut first, candidate);
        }
        Some(first.map_or(Distance::INFINITE, |first| first.from))
    });
}

/// What a hit makes the tracer ask, if anything.
fn query(scene: &Scene<'_>, hit: &RawHit<f32>) -> Option<TrimQuery> {
    let face = &scene.faces[hit.face as usize];
    if face.trim_root == TRIM_INSIDE {
        return None;
    }
    let uv = match hit.net {
        NO_NET => hit.uv,
        net => face_parameters(&scene.nets[net as usize], face.period, hit.uv),
    };
    Some(TrimQuery { face: hit.face, uv: uv.map(|x| x.clamp(0.0, 1.0)) })
}

#[cfg(test)]
mod tests {
    use super::super::probe::probe;
    use super::*;
    use crate::bench::chord;
    use crate::render::cpu::Precision;

    /// The knob, baked, without the rooms that this one may not name.
    fn knob() -> crate::scene::SceneBuffers {
        let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures/knob/model.step");
        let model = crate::import::import(&path).expect("a fixture");
        crate::bake::bake(&model, &crate::bake::BakeOptions::default(), &|_, _| {})
    }

    #[test]
    fn rays_ask_of_what_they_hit_and_of_what_is_trimmed_away() {
        let scene = knob();
        let scene = scene.scene();
        let rays: Vec<Ray> = (0..3000).map(|index| chord(&scene, index)).collect();
        let all = trim_queries(&scene, &rays, false, usize::MAX);
        let first = trim_queries(&scene, &rays, true, usize::MAX);
        assert!(first.len() < all.len() && all.len() > 1000, "{} {}", first.len(), all.len());
        assert_eq!(trim_queries(&scene, &rays, false, 100), all[..100]);
        let (answers, counts) = answers_counted(&scene, &all);
        assert_eq!(counts.queries, all.len() as u64);
        let inside = answers.iter().filter(|&&inside| inside).count();
        assert!(inside > 0 && inside < all.len());
        // Hits on trimmed faces are queries with the answer yes, but for those at borders and doubles.
        let hits = probe(&scene, &rays, Precision::F32, false);
        let is_trimmed = |face: u32| scene.faces[face as usize].trim_root != TRIM_INSIDE;
        let trimmed = hits.iter().flatten().filter(|hit| is_trimmed(hit.face)).count();
        assert!(trimmed.abs_diff(inside) * 200 < inside, "{trimmed} {inside}");
    }
}
