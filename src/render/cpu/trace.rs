//! From a world ray to hits: the top BVH, the instances' BVHs, the primitives.

use super::analytic::{Span, carrier_curvature, carrier_parameters, carrier_roots, carrier_tangents};
use super::bvh::{BvhRay, Met, Walk, bvh_ray, next_primitive, start_walk};
use super::cover::{Cover, Place, cover, is_far_outside, to_window, window_margin};
use super::footprint::{Footprint, footprint, sides};
use super::frames::{FaceFrame, grid_position};
use super::leaf::{Domain, NetRoot, leaf_domain};
use super::net::{MAX_ROOTS, leaf_roots};
use super::ray_space::{
    Distance, GridStep, PartRay, WorldRay, apply_rows, approach_frame, approach_point, enter_instance,
};
use super::tally::{Step, Tally};
use super::vector::{Vector3, number};
use super::{Kernel, NO_NET};
use crate::numeric::Number;
use crate::render::NetSearch;
use crate::scene::primitive::{Primitive, unpack};
use crate::scene::{Face, Header, Net, NetLeaf, Scene, TRIM_INSIDE};
use arrayvec::ArrayVec;
use std::ops::ControlFlow;

/// |cos| of the angle between ray and normal below which hits are shallow.
const SHALLOW: f64 = 0.5;

/// A hit as the kernels find it.
#[derive(Debug, Clone, Copy)]
pub struct RawHit<T> {
    /// Along the world ray.
    pub distance: Distance<T>,
    /// Index of the instance.
    pub instance: u32,
    /// Index of the face.
    pub face: u32,
    /// Index of the net, or [`NO_NET`].
    pub net: u32,
    /// Normalised face parameters; for nets local parameters of the net.
    pub uv: [T; 2],
    /// How sure it is.
    pub certainty: Certainty,
    /// Whether the angle between ray and surface is so small that an error of the surface's position counts several times along the ray.
    pub is_shallow: bool,
}

/// How sure it is that a hit is one, the surest first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u32)]
pub enum Certainty {
    /// Whatever the errors: neither near a tangent nor near the face's border.
    Certain,
    /// The ray is near a tangent, or not far from the face's border, but passes the face inside, as do the places beside it: it may be none, but where faces
    /// meet within half their slacks no neighbour's hit is the same.
    Own,
    /// The face's border is as near as its slack, or the search was cut short.
    Border,
}

impl Certainty {
    /// That of a kernel's word, which is one of these `as u32`.
    #[cfg(feature = "gpu")]
    pub fn from_word(word: u32) -> Self {
        [Self::Certain, Self::Own].into_iter().find(|&own| own as u32 == word).unwrap_or(Self::Border)
    }

    /// Of a hit that lies so to its face's border, of a ray that grazes the face or does not.
    pub fn of(cover: Cover, is_grazing: bool) -> Self {
        match (cover, is_grazing) {
            (Cover::Inside, false) => Self::Certain,
            (Cover::Inside | Cover::Near, _) => Self::Own,
            (Cover::Border | Cover::Outside, _) => Self::Border,
        }
    }
}

impl<T> RawHit<T> {
    /// Whether it is a hit whatever the errors.
    pub fn is_certain(&self) -> bool {
        self.certainty == Certainty::Certain
    }
}

/// The first hit after `near` of faces as wide as their slack, whatever their bodies can have: past an edge it may be one that is left out of all hits.
/// Pictures take it as it is, for it is off by the slack at most; whom that matters asks for its certainty. Which it is does not depend on the order of the walk:
/// see [`Candidate`]; of equally near hits it is that of the lowest face, net and instance.
pub fn first_hit<T: Kernel>(
    scene: &Scene<'_>,
    search: impl Into<NetSearch>,
    ray: &WorldRay<T>,
    near: Distance<T>,
) -> Option<RawHit<T>> {
    first_hit_before(scene, search, ray, near, Distance::INFINITE)
}

/// The first hit between `near` and `far`.
pub fn first_hit_before<T: Kernel>(
    scene: &Scene<'_>,
    search: impl Into<NetSearch>,
    ray: &WorldRay<T>,
    near: Distance<T>,
    far: Distance<T>,
) -> Option<RawHit<T>> {
    let mut first: Option<Candidate<T>> = None;
    trace(scene, search, ray, near, far, &mut |candidate| Some(keep_first(&mut first, candidate)));
    first.map(|first| first.hit)
}

/// A hit that may be the first.
///
/// As wide as its footprint a face is found just outside of the boxes and slabs that hold it; one that begins behind a hit is not entered. Whether such a hit is
/// the first must not depend on whether its own were entered before: it counts from where the last of them begins.
#[derive(Debug, Clone, Copy)]
pub struct Candidate<T> {
    /// The hit.
    pub hit: RawHit<T>,
    /// Where on the world ray it counts from.
    pub from: Distance<T>,
}

impl<T: Kernel> Candidate<T> {
    /// A hit found in a box that begins there.
    #[inline(always)]
    pub fn new(hit: RawHit<T>, begin: Distance<T>) -> Self {
        Self { hit, from: hit.distance.later(begin) }
    }
}

/// Keeps the hit if it is before the one that is kept; from where on that counts which stays.
#[inline]
pub fn keep_first<T: Kernel>(first: &mut Option<Candidate<T>>, candidate: Candidate<T>) -> Distance<T> {
    let best = match *first {
        Some(best) if !comes_before(&candidate, &best) => best,
        _ => candidate,
    };
    *first = Some(best);
    best.from
}

/// A total order: by sums in f64, for differences of pairs are none, then by face, net and instance, and of one place found in two leaves by how it is found.
fn comes_before<T: Kernel>(a: &Candidate<T>, b: &Candidate<T>) -> bool {
    let ids = |hit: &RawHit<T>| [hit.face, hit.net, hit.instance];
    let found = |hit: &RawHit<T>| {
        let place = [hit.uv[0], hit.uv[1], hit.distance.anchor].map(T::to_f64);
        (place, hit.certainty, hit.is_shallow)
    };
    let ahead = [[a.from, b.from], [a.hit.distance, b.hit.distance]].map(|[a, b]| a.to_f64() - b.to_f64());
    match ahead.into_iter().find(|&ahead| ahead != 0.0) {
        Some(ahead) => ahead < 0.0,
        None => (ids(&a.hit), found(&a.hit)) < (ids(&b.hit), found(&b.hit)),
    }
}

/// How far behind the first hit others are still looked for, in half sides of the scene: some times what differences of distances are rounded by in f32, which
/// reach across all of it. Which is the first then does not depend on those roundings, nor on which was found first.
const BEHIND: f64 = 1.0 / 524_288.0;

/// That distance, millimetres.
#[inline(always)]
pub fn behind<T: Number>(header: &Header) -> T {
    let [x, y, z] = header.half_size;
    T::from_f32(x + y + z) * number(BEHIND)
}

/// Where hits end to matter: at `found`, but for roundings, if that is before `far`.
#[inline(always)]
pub fn nearer<T: Number>(far: Distance<T>, found: Distance<T>, behind: T) -> Distance<T> {
    let found = Distance { offset: found.offset + behind, ..found };
    let is_nearer = found.minus(far).is_less(T::ZERO);
    let choose = |yes, no| T::choose(is_nearer, yes, no);
    Distance { anchor: choose(found.anchor, far.anchor), offset: choose(found.offset, far.offset) }
}

/// Visits hits between `near` and `far`, in no order. `accept` answers with the distance beyond which hits no longer matter, or `None` to
/// stop.
pub fn trace<T: Kernel>(
    scene: &Scene<'_>,
    search: impl Into<NetSearch>,
    ray: &WorldRay<T>,
    near: Distance<T>,
    far: Distance<T>,
    accept: &mut impl FnMut(Candidate<T>) -> Option<Distance<T>>,
) {
    trace_tallied(scene, search, ray, near, far, accept, &mut ());
}

/// [`trace`], taking note of its steps.
pub fn trace_tallied<T: Kernel>(
    scene: &Scene<'_>,
    search: impl Into<NetSearch>,
    ray: &WorldRay<T>,
    near: Distance<T>,
    far: Distance<T>,
    accept: &mut impl FnMut(Candidate<T>) -> Option<Distance<T>>,
    tally: &mut impl Tally,
) {
    let step = GridStep::of(scene.header);
    let mut trace = Trace { scene, search: search.into(), step, near, far, accept, tally };
    _ = trace.trace_instances(ray);
}

/// The hits of one ray in a leaf between `near` and `far`, in no order; the leaf's box begins at `begin`.
pub fn leaf_hits(
    scene: &Scene<'_>,
    search: NetSearch,
    ray: &PartRay<f32>,
    [instance, leaf]: [u32; 2],
    [near, far, begin]: [Distance<f32>; 3],
) -> ArrayVec<Candidate<f32>, MAX_ROOTS> {
    let mut hits = ArrayVec::new();
    let mut accept = |candidate: Candidate<f32>| {
        hits.push(candidate);
        Some(far)
    };
    let step = GridStep::of(scene.header);
    let mut trace = Trace { scene, search, step, near, far, accept: &mut accept, tally: &mut () };
    _ = trace.trace_leaf(ray, instance, leaf, begin);
    hits
}

/// A trace in progress.
struct Trace<'t, T, A, C> {
    scene: &'t Scene<'t>,
    search: NetSearch,
    step: GridStep<T>,
    /// Hits before this do not matter …
    near: Distance<T>,
    /// … nor those beyond.
    far: Distance<T>,
    accept: &'t mut A,
    tally: &'t mut C,
}

impl<T: Kernel, A: FnMut(Candidate<T>) -> Option<Distance<T>>, C: Tally> Trace<'_, T, A, C> {
    /// The hits of all instances.
    fn trace_instances(&mut self, ray: &WorldRay<T>) -> ControlFlow<()> {
        let scene = self.scene;
        if scene.instances.len() == 1 {
            return self.trace_instance(ray, 0, self.near);
        }
        let boxes = bvh_ray(grid_position(ray.grid, self.step.size) + ray.fraction, ray.direction);
        let mut instances = start_walk(0, scene.header.node_count, 0, -T::INFINITY);
        while let Some(met) = self.next_met(&mut instances, &boxes, T::ZERO) {
            self.trace_instance(ray, met.word, Distance { anchor: T::ZERO, offset: met.span[0] })?;
        }
        ControlFlow::Continue(())
    }

    /// The next primitive of a walk that may matter; `anchor` is where on the world ray the origin of `boxes` lies.
    fn next_met(&mut self, walk: &mut Walk<T>, boxes: &BvhRay<T>, anchor: T) -> Option<Met<T>> {
        let (from, to) = (self.near.beyond(anchor), self.far.beyond(anchor));
        next_primitive(walk, self.scene, boxes, from, to, self.tally)
    }

    /// The hits of an instance, whose box begins at `begin`.
    fn trace_instance(&mut self, ray: &WorldRay<T>, instance: u32, begin: Distance<T>) -> ControlFlow<()> {
        let (may_meet, part_ray) = enter_instance(ray, &T::instance(self.scene, instance), self.step);
        if !may_meet {
            return ControlFlow::Continue(());
        }
        self.tally.count(Step::Instance);
        self.trace_part(&part_ray, instance, begin)
    }

    /// The hits of an instance's part.
    fn trace_part(&mut self, ray: &PartRay<T>, instance: u32, begin: Distance<T>) -> ControlFlow<()> {
        let scene = self.scene;
        let part = &scene.parts[scene.instances[instance as usize].part as usize];
        let boxes = bvh_ray(ray.near_origin, ray.direction);
        let mut primitives =
            start_walk(part.first_node, part.node_count, part.first_primitive, begin.beyond(ray.near_anchor));
        while let Some(met) = self.next_met(&mut primitives, &boxes, ray.near_anchor) {
            match unpack(met.word) {
                Primitive::Face(face) => self.trace_face(ray, instance, face, met.span)?,
                Primitive::NetLeaf(leaf) => {
                    let begin = Distance { anchor: ray.near_anchor, offset: met.span[0] };
                    self.trace_leaf(ray, instance, leaf, begin)?;
                }
            }
        }
        ControlFlow::Continue(())
    }

    /// The hits of an analytic face, whose box holds `span` of the ray.
    fn trace_face(
        &mut self,
        part_ray: &PartRay<T>,
        instance: u32,
        index: u32,
        span: [T; 2],
    ) -> ControlFlow<()> {
        self.tally.count(Step::Face);
        let scene = self.scene;
        let face: FaceFrame<T> = T::face(scene, index);
        let ray = approach_frame(part_ray, &face, self.step);
        let origin = apply_rows(&face.axes, ray.origin);
        let direction = apply_rows(&face.axes, ray.direction);
        let begin = Distance { anchor: part_ray.near_anchor, offset: span[0] };
        let span = Span { ends: span.map(|t| (part_ray.near_anchor - ray.anchor) + t), slack: face.slack };
        let roots = carrier_roots(face.kind, origin, direction, face.radii, &span);
        for &t in &roots.t[..roots.count] {
            let distance = Distance { anchor: ray.anchor, offset: t };
            if !is_between(distance, self.near, self.far) {
                continue;
            }
            let point = origin + direction * t;
            let uv = window_parameters(&face, point);
            if is_far_outside(uv) {
                continue;
            }
            let footprint = face_footprint(&face, point, direction);
            let place = Place { at: uv, margin: window_margins(&face), extent: footprint.extent() };
            if place.is_outside() {
                continue;
            }
            // All faces of a part are tried at the same sides.
            let sides = || sides(part_ray.direction).map(|side| apply_rows(&face.axes, side));
            let record = &scene.faces[index as usize];
            let cover = cover(scene, record, face.period, &place, || (footprint, sides()), self.tally);
            if cover != Cover::Outside {
                let certainty = Certainty::of(cover, footprint.is_grazing);
                let (face, net, is_shallow) = (index, NO_NET, is_shallow(footprint.cosine));
                self.meet(RawHit { distance, instance, face, net, uv, certainty, is_shallow }, begin)?;
            }
        }
        ControlFlow::Continue(())
    }

    /// The hits of a net leaf, whose box begins at `box_begin`.
    fn trace_leaf(
        &mut self,
        part_ray: &PartRay<T>,
        instance: u32,
        index: u32,
        box_begin: Distance<T>,
    ) -> ControlFlow<()> {
        self.tally.count(Step::Leaf);
        let scene = self.scene;
        let leaf = &scene.net_leaves[index as usize];
        let net = &scene.nets[leaf.net as usize];
        let face = &scene.faces[net.face as usize];
        let center = Vector3::from_f32(leaf.center);
        let ray = approach_point(part_ray, face.grid, center, self.step);
        let (from, to) = (self.near.beyond(ray.anchor), self.far.beyond(ray.anchor));
        let slack = number(face.slack.into());
        let roots = leaf_roots(scene, leaf, net, &ray, from, to, self.search, slack, self.tally);
        let begin = box_begin.later(Distance { anchor: ray.anchor, offset: roots.begin });
        for root in &roots.root[..roots.count] {
            let distance = Distance { anchor: ray.anchor, offset: root.t };
            if !is_between(distance, self.near, self.far) {
                continue;
            }
            let cover = leaf_cover(scene, leaf, net, face, root, ray.direction, self.tally);
            if cover != Cover::Outside {
                let found = Certainty::of(cover, root.footprint.is_grazing);
                let certainty = if roots.is_cut { Certainty::Border } else { found };
                let (face, net, uv, is_shallow) =
                    (net.face, leaf.net, root.uv, is_shallow(root.footprint.cosine));
                self.meet(RawHit { distance, instance, face, net, uv, certainty, is_shallow }, begin)?;
            }
        }
        ControlFlow::Continue(())
    }

    /// Hands on a hit; stops where no other matters.
    fn meet(&mut self, hit: RawHit<T>, begin: Distance<T>) -> ControlFlow<()> {
        match (self.accept)(Candidate::new(hit, begin)) {
            Some(far) => {
                self.far = nearer(self.far, far, behind(self.scene.header));
                ControlFlow::Continue(())
            }
            None => ControlFlow::Break(()),
        }
    }
}

/// Whether that is so at this cosine of the angle between ray and normal.
pub fn is_shallow<T: Number>(cosine: T) -> T::Mask {
    cosine.abs().is_less(number(SHALLOW))
}

/// Whether that is so.
#[inline(always)]
pub fn is_between<T: Number>(distance: Distance<T>, near: Distance<T>, far: Distance<T>) -> T::Mask {
    T::ZERO.is_at_most(distance.minus(near)) & distance.minus(far).is_at_most(T::ZERO)
}

/// Normalised face parameters of a point of the carrier, in the carrier's frame, wrapped.
#[inline(always)]
pub fn window_parameters<T: Number>(face: &FaceFrame<T>, point: Vector3<T>) -> [T; 2] {
    let parameters = carrier_parameters(face.kind, point, face.radii);
    [0, 1].map(|k| to_window((parameters[k] - face.uv_low[k]) * face.uv_scale[k], face.period[k]))
}

/// The footprint of a ray on a face, at a point of the carrier in the carrier's frame; in normalised parameters.
#[inline(always)]
pub fn face_footprint<T: Number>(
    face: &FaceFrame<T>,
    point: Vector3<T>,
    direction: Vector3<T>,
) -> Footprint<T> {
    let [s_u, s_v] = carrier_tangents(face.kind, point, face.radii);
    let curvature = carrier_curvature(face.kind, point, face.radii);
    footprint(direction, s_u, s_v, curvature, face.slack).scaled(face.uv_scale)
}

/// What normalised parameters of a face are rounded by.
#[inline(always)]
pub fn window_margins<T: Number>(face: &FaceFrame<T>) -> [T; 2] {
    [0, 1].map(|k| window_margin(face.uv_low[k], face.uv_scale[k]))
}

/// Whether the footprint of a root lies within the leaf's own domain, on which its trim state holds.
#[inline(always)]
pub fn is_in_leaf<T: Number>(domain: &Domain<T>, root: &NetRoot<T>) -> T::Mask {
    let extent = root.footprint.extent();
    let [u, v] = [0, 1].map(|k| {
        let from_low = root.uv[k] - domain.low[k];
        extent[k].is_at_most(from_low) & extent[k].is_at_most(domain.size[k] - from_low)
    });
    u & v
}

/// How a root lies to the border of its face.
fn leaf_cover<T: Kernel>(
    scene: &Scene<'_>,
    leaf: &NetLeaf,
    net: &Net,
    face: &Face,
    root: &NetRoot<T>,
    direction: Vector3<T>,
    tally: &mut impl Tally,
) -> Cover {
    if leaf.trim == TRIM_INSIDE && is_in_leaf(&leaf_domain(leaf), root) {
        return Cover::Inside;
    }
    let at = face_parameters(net, face.period, root.uv);
    let footprint: Footprint<T> = root.footprint.scaled(net.uv_size.map(T::from_f32));
    let place = Place { at, margin: [T::ZERO; 2], extent: footprint.extent() };
    if place.is_outside() {
        return Cover::Outside;
    }
    let period = face.period.map(T::from_f32);
    cover(scene, face, period, &place, || (footprint, sides(direction)), tally)
}

/// Normalised face parameters of a net's local ones, wrapped.
#[inline(always)]
pub fn face_parameters<T: Number>(net: &Net, period: [f32; 2], uv: [T; 2]) -> [T; 2] {
    [0, 1].map(|k| {
        let p = T::from_f32(net.uv_low[k]) + uv[k] * T::from_f32(net.uv_size[k]);
        to_window(p, T::from_f32(period[k]))
    })
}

#[cfg(all(test, feature = "gpu"))]
mod tests {
    use super::*;

    #[test]
    fn certainties_come_back_from_their_words() {
        for certainty in [Certainty::Certain, Certainty::Own, Certainty::Border] {
            assert_eq!(Certainty::from_word(certainty as u32), certainty);
        }
    }
}
