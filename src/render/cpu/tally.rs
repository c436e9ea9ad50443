//! What tracing rays takes, in steps that do not depend on the machine: where a scene is slow, these tell why.
//!
//! Whoever traces says by type whether steps are counted: `()` counts nothing, and leaves nothing of the counting in the program.

use super::camera::center_ray;
use super::ray_space::{Distance, prepare};
use super::trace::{keep_first, trace_tallied};
use super::trim_study::TrimCounts;
use crate::image::Window;
use crate::render::{Camera, NetSearch, Ray, RenderOptions};
use crate::scene::Scene;
use rayon::prelude::*;
use std::ops::AddAssign;

/// A step of a ray on its way to its hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(usize)]
pub enum Step {
    /// An instance that the ray enters.
    Instance,
    /// A node of a BVH, whose eight boxes are tested.
    Node,
    /// An analytic face, whose closed form is solved.
    Face,
    /// A leaf of a net, whose skew slab is tested.
    Leaf,
    /// A leaf that the ray may meet more than once, which is searched cell by cell.
    DividedLeaf,
    /// A cell of a divided leaf.
    Cell,
    /// A search by Newton's method.
    Search,
    /// A step of one.
    NewtonStep,
}

const STEPS: usize = Step::NewtonStep as usize + 1;

/// Takes note of steps.
pub trait Tally {
    /// One step more.
    #[inline(always)]
    fn count(&mut self, step: Step) {
        _ = step;
    }
    /// Where trim queries are counted, if they are.
    #[inline(always)]
    fn trims(&mut self) -> Option<&mut TrimCounts> {
        None
    }
}

impl Tally for () {}

/// Sums over rays.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct RayCounts {
    /// Rays.
    pub rays: u64,
    /// Of these, those with a hit.
    pub hit: u64,
    /// What trims were asked.
    pub trims: TrimCounts,
    steps: [u64; STEPS],
}

impl RayCounts {
    /// How often a step was taken.
    pub fn of(&self, step: Step) -> u64 {
        self.steps[step as usize]
    }
}

impl Tally for RayCounts {
    #[inline(always)]
    fn count(&mut self, step: Step) {
        self.steps[step as usize] += 1;
    }
    #[inline(always)]
    fn trims(&mut self) -> Option<&mut TrimCounts> {
        Some(&mut self.trims)
    }
}

impl AddAssign for RayCounts {
    fn add_assign(&mut self, other: Self) {
        self.rays += other.rays;
        self.hit += other.hit;
        self.trims += other.trims;
        for (sum, more) in self.steps.iter_mut().zip(other.steps) {
            *sum += more;
        }
    }
}

/// What the first hits of rays take, or all hits, in f32.
pub fn count_steps(
    scene: &Scene<'_>,
    rays: impl IndexedParallelIterator<Item = Ray>,
    search: impl Into<NetSearch>,
    first_only: bool,
) -> RayCounts {
    let search = search.into();
    let of_ray = |mut sum: RayCounts, ray: Ray| {
        count_ray(scene, search, &ray, first_only, &mut sum);
        sum
    };
    let add = |mut a: RayCounts, b: RayCounts| {
        a += b;
        a
    };
    rays.fold(RayCounts::default, of_ray).reduce(RayCounts::default, add)
}

/// What the first hits of the rays through the pixels' centres take, of the part of a picture that is asked for; sections are left out.
pub fn count_steps_of_picture(scene: &Scene<'_>, camera: &Camera, options: &RenderOptions) -> RayCounts {
    let whole = options.resolution.map(|n| n as usize);
    let window = options.window.unwrap_or(Window::whole(whole[0], whole[1]));
    let ray = |pixel: usize| center_ray(camera, options.resolution, window, pixel);
    let rays = (0..window.width * window.height).into_par_iter().map(ray);
    count_steps(scene, rays, options.exactness, true)
}

fn count_ray(scene: &Scene<'_>, search: NetSearch, ray: &Ray, first_only: bool, sum: &mut RayCounts) {
    sum.rays += 1;
    let Some(prepared) = prepare::<f32>(ray, scene.header) else { return };
    let mut first = None;
    let mut accept = |hit| {
        let nearest = keep_first(&mut first, hit);
        Some(if first_only { nearest } else { Distance::INFINITE })
    };
    trace_tallied(scene, search, &prepared.ray, prepared.near, Distance::INFINITE, &mut accept, sum);
    sum.hit += u64::from(first.is_some());
}

#[cfg(test)]
mod tests {
    use super::super::Precision;
    use super::super::probe::probe;
    use super::super::test_scenes::{Random, TestFace, scene_of};
    use super::*;
    use crate::render::Exactness;
    use crate::scene::FaceKind;
    use glam::{DAffine3, DVec3};

    #[test]
    fn steps_of_a_sphere_are_those_that_it_takes() {
        use std::f64::consts::{FRAC_PI_2, TAU};
        let face = TestFace::analytic(FaceKind::Sphere, [1.0, 0.0], [0.0, -FRAC_PI_2], [TAU, FRAC_PI_2]);
        let scene = scene_of(&[face], &[DAffine3::IDENTITY]);
        let scene = scene.scene();
        let mut random = Random(5);
        let rays: Vec<Ray> = (0..1000)
            .map(|_| Ray { origin: random.point(1.2) - DVec3::X * 3.0, direction: DVec3::X })
            .collect();
        let hits = probe(&scene, &rays, Precision::F32, true);
        for first_only in [true, false] {
            let counts = count_steps(&scene, rays.par_iter().copied(), Exactness::Exact, first_only);
            assert_eq!(counts.rays, 1000);
            assert_eq!(counts.hit, hits.iter().filter(|hits| !hits.is_empty()).count() as u64);
            let faces = counts.of(Step::Face);
            assert!(
                faces >= counts.hit && faces <= counts.of(Step::Node) && faces <= counts.of(Step::Instance)
            );
            assert_eq!(counts.of(Step::Leaf) + counts.of(Step::Search) + counts.trims.queries, 0);
        }
    }
}
