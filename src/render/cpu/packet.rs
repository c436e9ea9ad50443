//! First hits of eight rays together (Wald et al. 2001, "Interactive Rendering with Coherent Ray Tracing"): a node, a face and a net are read once for all, and
//! computed on in the lanes of vectors.
//!
//! Each ray gets the hit that it gets alone ([`super::trace`]), to the bit: lanes round as single numbers do, a root does not depend on what was found before it,
//! and which of several hits is the first not on the order in which they are found.
//!
//! What few hits need is done ray by ray: tori, leaves that may be met more than once, the trims.

use super::analytic::{Span, quadric_roots};
use super::cover::{Cover, Place, cover, is_far_outside};
use super::footprint::{Footprint, sides};
use super::frames::{FaceFrame, grid_position};
use super::leaf::{LeafRay, leaf_domain, leaf_pole};
use super::net::unique_start;
use super::newton::unique_root;
use super::packet_bvh::{PacketMet, PacketWalk};
use super::planes::{is_along, major_axis, planes_along};
use super::ray_space::{
    Distance, GridStep, PartRay, PreparedRay, WorldRay, apply_rows, approach_frame, approach_point,
    enter_instance,
};
use super::slab::intersect_slab;
use super::torus::torus_roots;
use super::trace::{
    Candidate, Certainty, RawHit, behind, face_footprint, face_parameters, is_between, is_in_leaf,
    is_shallow, keep_first, leaf_hits, nearer, window_margins, window_parameters,
};
use super::vector::{Vector3, vec3};
use super::{Kernel, NO_NET};
use crate::numeric::{Eight, Mask, Mask8};
use crate::render::NetSearch;
use crate::scene::primitive::{Primitive, unpack};
use crate::scene::{Face, FaceKind, Scene, TRIM_INSIDE};

/// Rays of a packet.
pub const LANES: usize = 8;

/// A ray, and the part of it that matters.
#[derive(Debug, Clone, Copy)]
pub struct Segment {
    /// The ray.
    pub ray: WorldRay<f32>,
    /// Hits before this do not matter …
    pub near: Distance<f32>,
    /// … nor those beyond.
    pub far: Distance<f32>,
}

impl Segment {
    /// All of a ray that starts somewhere.
    pub fn of(prepared: &PreparedRay<f32>) -> Self {
        Self { ray: prepared.ray, near: prepared.near, far: Distance::INFINITE }
    }
}

/// Up to eight rays, and the parts of them that matter, lane by lane.
#[derive(Debug, Clone, Copy, Default)]
pub struct Packet {
    grid: [[i32; LANES]; 3],
    fraction: [[f32; LANES]; 3],
    direction: [[f32; LANES]; 3],
    direction_low: [[f32; LANES]; 3],
    near: Ends,
    far: Ends,
    /// A bit for each lane with a ray.
    asked: u32,
}

impl Packet {
    /// Puts a ray into a lane.
    #[inline(always)]
    pub fn put(&mut self, lane: usize, segment: &Segment) {
        let Segment { ray, near, far } = segment;
        for k in 0..3 {
            self.grid[k][lane] = ray.grid[k];
            self.fraction[k][lane] = ray.fraction.to_array()[k];
            self.direction[k][lane] = ray.direction.to_array()[k];
            self.direction_low[k][lane] = ray.direction_low.to_array()[k];
        }
        self.near.put(lane, *near);
        self.far.put(lane, *far);
        self.asked |= 1 << lane;
    }

    fn ray(&self) -> WorldRay<Eight> {
        let vector = |[x, y, z]: [[f32; LANES]; 3]| vec3(Eight::new(x), Eight::new(y), Eight::new(z));
        WorldRay {
            grid: self.grid.map(Into::into),
            fraction: vector(self.fraction),
            direction: vector(self.direction),
            direction_low: vector(self.direction_low),
        }
    }
}

/// The first hits of rays, by lane: of each what [`super::trace::first_hit_before`] finds of it alone.
pub fn first_hits(
    scene: &Scene<'_>,
    search: impl Into<NetSearch>,
    packet: &Packet,
) -> [Option<Candidate<f32>>; LANES] {
    let mut trace = PacketTrace {
        scene,
        search: search.into(),
        step: GridStep::of(scene.header),
        behind: behind(scene.header),
        near: packet.near.all(),
        far: packet.far,
        first: [None; LANES],
    };
    if packet.asked != 0 {
        trace.trace_instances(&packet.ray(), Mask8::of_bits(packet.asked));
    }
    trace.first
}

/// Where rays begin or end, lane by lane.
#[derive(Debug, Clone, Copy, Default)]
struct Ends {
    anchor: [f32; LANES],
    offset: [f32; LANES],
}

impl Ends {
    #[inline(always)]
    fn all(&self) -> Distance<Eight> {
        Distance { anchor: Eight::new(self.anchor), offset: Eight::new(self.offset) }
    }

    #[inline(always)]
    fn put(&mut self, lane: usize, distance: Distance<f32>) {
        (self.anchor[lane], self.offset[lane]) = (distance.anchor, distance.offset);
    }

    #[inline(always)]
    fn lane(&self, lane: usize) -> Distance<f32> {
        Distance { anchor: self.anchor[lane], offset: self.offset[lane] }
    }
}

/// A trace in progress.
struct PacketTrace<'t> {
    scene: &'t Scene<'t>,
    search: NetSearch,
    step: GridStep<Eight>,
    /// See [`nearer`].
    behind: f32,
    near: Distance<Eight>,
    /// Where hits end to matter; once there is one, where it counts.
    far: Ends,
    first: [Option<Candidate<f32>>; LANES],
}

impl PacketTrace<'_> {
    fn trace_instances(&mut self, ray: &WorldRay<Eight>, asked: Mask8) {
        let scene = self.scene;
        if scene.instances.len() == 1 {
            return self.trace_instance(ray, 0, asked, self.near);
        }
        let origin = grid_position::<Eight>(ray.grid, self.step.size) + ray.fraction;
        let tree = [0, scene.header.node_count, 0];
        let mut walk = PacketWalk::new(tree, origin, ray.direction, asked, -Eight::INFINITY);
        while let Some(met) =
            walk.next(scene, self.near.beyond(Eight::ZERO), self.far.all().beyond(Eight::ZERO))
        {
            let begin = Distance { anchor: Eight::ZERO, offset: met.span[0] };
            self.trace_instance(ray, met.word, met.rays, begin);
        }
    }

    fn trace_instance(&mut self, ray: &WorldRay<Eight>, instance: u32, asked: Mask8, begin: Distance<Eight>) {
        let scene = self.scene;
        let frame = f32::instance(scene, instance).in_numbers();
        let (may_meet, ray) = enter_instance(ray, &frame, self.step);
        let asked = asked & may_meet;
        if !asked.any() {
            return;
        }
        let part = &scene.parts[scene.instances[instance as usize].part as usize];
        let tree = [part.first_node, part.node_count, part.first_primitive];
        let begin = begin.beyond(ray.near_anchor);
        let mut walk = PacketWalk::new(tree, ray.near_origin, ray.direction, asked, begin);
        let near = self.near.beyond(ray.near_anchor);
        while let Some(met) = walk.next(scene, near, self.far.all().beyond(ray.near_anchor)) {
            match unpack(met.word) {
                Primitive::Face(face) => self.trace_face(&ray, instance, face, &met),
                Primitive::NetLeaf(leaf) => self.trace_leaf(&ray, instance, leaf, &met),
            }
        }
    }

    fn trace_face(&mut self, part_ray: &PartRay<Eight>, instance: u32, index: u32, met: &PacketMet) {
        let scene = self.scene;
        let narrow = f32::face(scene, index);
        let face: FaceFrame<Eight> = narrow.in_numbers();
        let ray = approach_frame(part_ray, &face, self.step);
        let origin = apply_rows(&face.axes, ray.origin);
        let direction = apply_rows(&face.axes, ray.direction);
        let at_face = FaceRays { instance, index, narrow, face, anchor: ray.anchor, origin, direction };
        if face.kind == FaceKind::Torus as u32 {
            let before = part_ray.near_anchor - ray.anchor;
            let ends = met.span.map(|t| (before + t).to_array());
            let mut roots = [([f32::NAN; LANES], 0_u32); 4];
            for lane in lanes(met.rays) {
                let span = Span { ends: ends.map(|end| end[lane]), slack: narrow.slack };
                let [major, minor] = narrow.radii;
                let found = torus_roots(origin.lane(lane), direction.lane(lane), major, minor, &span);
                for (&t, root) in found.t[..found.count].iter().zip(&mut roots) {
                    root.0[lane] = t;
                    root.1 |= 1 << lane;
                }
            }
            for (t, exists) in roots {
                self.meet_face(part_ray, &at_face, Eight::new(t), Mask8::of_bits(exists), met);
            }
            return;
        }
        let roots = quadric_roots(face.kind, origin, direction, face.radii);
        for (t, exists) in roots.t.into_iter().zip(roots.exists) {
            self.meet_face(part_ray, &at_face, t, met.rays & exists, met);
        }
    }

    #[inline(always)]
    fn meet_face(
        &mut self,
        part_ray: &PartRay<Eight>,
        at: &FaceRays,
        t: Eight,
        exists: Mask8,
        met: &PacketMet,
    ) {
        let scene = self.scene;
        let distance = Distance { anchor: at.anchor, offset: t };
        let mut hit = exists & is_between(distance, self.near, self.far.all());
        if !hit.any() {
            return;
        }
        let point = at.origin + at.direction * t;
        let uv = window_parameters(&at.face, point);
        hit = hit & !is_far_outside(uv);
        if !hit.any() {
            return;
        }
        let footprint = face_footprint(&at.face, point, at.direction);
        let place = Place { at: uv, margin: window_margins(&at.face), extent: footprint.extent() };
        hit = hit & !place.is_outside();
        let record = &scene.faces[at.index as usize];
        let sides =
            |lane: usize| sides(part_ray.direction.lane(lane)).map(|side| apply_rows(&at.narrow.axes, side));
        let margin = window_margins(&at.narrow);
        let begin = Distance { anchor: part_ray.near_anchor, offset: met.span[0] };
        let found = Found { distance, begin, uv, footprint, ids: [at.instance, at.index, NO_NET] };
        self.meet_all(hit, record, at.narrow.period, (&place, margin), &footprint, sides, &found);
    }

    fn trace_leaf(&mut self, part_ray: &PartRay<Eight>, instance: u32, index: u32, met: &PacketMet) {
        let scene = self.scene;
        let leaf = &scene.net_leaves[index as usize];
        let net = &scene.nets[leaf.net as usize];
        let face = &scene.faces[net.face as usize];
        let center = Vector3::<Eight>::from_f32(leaf.center);
        let ray = approach_point(part_ray, face.grid, center, self.step);
        let far = self.far.all();
        let (from, to) = (self.near.beyond(ray.anchor), far.beyond(ray.anchor));
        let (meets, slab) = intersect_slab(leaf, &ray, from, to);
        let asked = met.rays & meets;
        if !asked.any() {
            return;
        }
        let first = lanes(asked).next().unwrap_or(0);
        let major = major_axis(ray.direction.lane(first));
        let unique = asked & slab.unique & is_along(ray.direction, major);
        let box_begin = Distance { anchor: part_ray.near_anchor, offset: met.span[0] };
        for lane in lanes(asked & !unique) {
            let ends = [lane_of(self.near, lane), self.far.lane(lane), lane_of(box_begin, lane)];
            for candidate in leaf_hits(scene, self.search, &part_ray.lane(lane), [instance, index], ends) {
                self.keep(lane, candidate);
            }
        }
        if !unique.any() {
            return;
        }
        let domain = leaf_domain::<Eight>(leaf);
        let at = LeafRay {
            leaf,
            net,
            domain,
            ray,
            planes: planes_along(ray.direction, major),
            slack: Eight::splat(face.slack),
            pole: leaf_pole(net, &leaf_domain::<f32>(leaf)),
            newton_stop: Eight::splat(self.search.newton_stop),
        };
        let (exists, root) = unique_root(scene, &at, unique_start(&slab, &domain), unique, &mut ());
        let distance = Distance { anchor: ray.anchor, offset: root.t };
        let mut hit = exists & is_between(distance, self.near, self.far.all());
        if !hit.any() {
            return;
        }
        let ids = [instance, net.face, leaf.net];
        let begin = box_begin.later(Distance { anchor: ray.anchor, offset: slab.enter });
        let found = Found { distance, begin, uv: root.uv, footprint: root.footprint, ids };
        if leaf.trim == TRIM_INSIDE {
            let is_own = hit & is_in_leaf(&domain, &root);
            for lane in lanes(is_own) {
                self.keep(lane, found.candidate(lane, Cover::Inside));
            }
            hit = hit & !is_own;
            if !hit.any() {
                return;
            }
        }
        let footprint = root.footprint.scaled(net.uv_size.map(Eight::splat));
        let at = face_parameters(net, face.period, root.uv);
        let place = Place { at, margin: [Eight::ZERO; 2], extent: footprint.extent() };
        hit = hit & !place.is_outside();
        let sides = |lane: usize| sides(ray.direction.lane(lane));
        self.meet_all(hit, face, face.period, (&place, [0.0; 2]), &footprint, sides, &found);
    }

    /// Hands on those of the places that are on the face.
    #[inline(always)]
    fn meet_all(
        &mut self,
        hit: Mask8,
        face: &Face,
        period: [f32; 2],
        (place, margin): (&Place<Eight>, [f32; 2]),
        footprint: &Footprint<Eight>,
        sides: impl Fn(usize) -> [Vector3<f32>; 2],
        found: &Found,
    ) {
        let (at, extent) = (place.at.map(Eight::to_array), place.extent.map(Eight::to_array));
        for lane in lanes(hit) {
            let place = Place { at: at.map(|x| x[lane]), margin, extent: extent.map(|x| x[lane]) };
            let footprint = || (footprint.lane(lane), sides(lane));
            let cover = cover(self.scene, face, period, &place, footprint, &mut ());
            if cover != Cover::Outside {
                self.keep(lane, found.candidate(lane, cover));
            }
        }
    }

    /// Keeps the hit if it is before the one that is kept.
    #[inline]
    fn keep(&mut self, lane: usize, candidate: Candidate<f32>) {
        let found = keep_first(&mut self.first[lane], candidate);
        self.far.put(lane, nearer(self.far.lane(lane), found, self.behind));
    }
}

#[inline(always)]
fn lane_of(distance: Distance<Eight>, lane: usize) -> Distance<f32> {
    Distance { anchor: distance.anchor.to_array()[lane], offset: distance.offset.to_array()[lane] }
}

/// Rays at a face.
struct FaceRays {
    instance: u32,
    index: u32,
    narrow: FaceFrame<f32>,
    face: FaceFrame<Eight>,
    /// Where on the world rays those origins lie.
    anchor: Eight,
    /// In the carrier's frame …
    origin: Vector3<Eight>,
    /// … as this.
    direction: Vector3<Eight>,
}

/// What hits have in common, and what each has.
struct Found {
    distance: Distance<Eight>,
    /// Where what they were found in begins.
    begin: Distance<Eight>,
    uv: [Eight; 2],
    footprint: Footprint<Eight>,
    /// The indices of the instance, the face and the net or none.
    ids: [u32; 3],
}

impl Found {
    #[inline(always)]
    fn candidate(&self, lane: usize, cover: Cover) -> Candidate<f32> {
        let number = |eight: Eight| eight.to_array()[lane];
        let [instance, face, net] = self.ids;
        let hit = RawHit {
            distance: lane_of(self.distance, lane),
            instance,
            face,
            net,
            uv: self.uv.map(number),
            certainty: Certainty::of(cover, self.footprint.is_grazing.bits() >> lane & 1 == 1),
            is_shallow: is_shallow(number(self.footprint.cosine)),
        };
        Candidate::new(hit, lane_of(self.begin, lane))
    }
}

/// The lanes in which a mask holds.
#[inline(always)]
fn lanes(mask: Mask8) -> impl Iterator<Item = usize> {
    let mut bits = mask.bits();
    std::iter::from_fn(move || {
        let lane = bits.trailing_zeros() as usize;
        bits &= bits.wrapping_sub(1);
        (lane < LANES).then_some(lane)
    })
}
