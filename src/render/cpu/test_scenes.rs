//! Small scenes made by hand: one part of analytic faces and nets, placed any number of times.

use super::bernstein::{MAX_ORDER, basis_and_slopes};
use crate::numeric::Aabb;
use crate::scene::primitive::{Primitive, pack};
use crate::scene::*;
use glam::{DAffine3, DMat3, DVec3, Vec3A};
use obvhs::cwbvh::builder::build_cwbvh;
use obvhs::{Boundable, BvhBuildParams};

/// A face of a test part.
#[derive(Debug, Clone)]
pub struct TestFace {
    pub kind: FaceKind,
    pub origin: DVec3,
    pub axes: DMat3,
    pub radii: [f64; 2],
    pub low: [f64; 2],
    pub high: [f64; 2],
    pub periodic: [bool; 2],
    pub reversed: bool,
    pub net: Option<TestNet>,
}

/// A net over the whole window, cut into `2^level` leaves along u and v.
#[derive(Debug, Clone)]
pub struct TestNet {
    pub degrees: [usize; 2],
    pub points: Vec<[f64; 4]>,
    pub level: u32,
}

impl TestNet {
    pub fn homogeneous(&self, uv: [f64; 2], order: [bool; 2]) -> [f64; 4] {
        let (b_u, s_u) = basis_and_slopes::<f64, MAX_ORDER>(self.degrees[0], uv[0]);
        let (b_v, s_v) = basis_and_slopes::<f64, MAX_ORDER>(self.degrees[1], uv[1]);
        let (u, v) = (if order[0] { s_u } else { b_u }, if order[1] { s_v } else { b_v });
        let mut sum = [0.0; 4];
        for i in 0..=self.degrees[0] {
            for j in 0..=self.degrees[1] {
                let p = self.points[i * (self.degrees[1] + 1) + j];
                for k in 0..4 {
                    sum[k] += p[k] * u[i] * v[j];
                }
            }
        }
        sum
    }
    pub fn point(&self, uv: [f64; 2]) -> DVec3 {
        let h = self.homogeneous(uv, [false; 2]);
        DVec3::new(h[0], h[1], h[2]) / h[3]
    }
    pub fn tangents(&self, uv: [f64; 2]) -> [DVec3; 2] {
        let h = self.homogeneous(uv, [false; 2]);
        [[true, false], [false, true]].map(|order| {
            let d = self.homogeneous(uv, order);
            (DVec3::new(d[0], d[1], d[2]) - self.point(uv) * d[3]) / h[3]
        })
    }
}

impl TestFace {
    pub fn analytic(kind: FaceKind, radii: [f64; 2], low: [f64; 2], high: [f64; 2]) -> Self {
        let periodic = match kind {
            FaceKind::Plane | FaceKind::Nets => [false, false],
            FaceKind::Torus => [true, true],
            _ => [true, false],
        };
        let (origin, axes) = (DVec3::ZERO, DMat3::IDENTITY);
        Self { kind, origin, axes, radii, low, high, periodic, reversed: false, net: None }
    }
    pub fn nets(net: TestNet) -> Self {
        let mut face = Self::analytic(FaceKind::Nets, [0.0; 2], [0.0; 2], [1.0; 2]);
        face.net = Some(net);
        face
    }
    pub fn placed(mut self, origin: DVec3, axes: DMat3) -> Self {
        (self.origin, self.axes) = (origin, axes);
        self
    }
    /// The point at the surface parameters `uv`, part space.
    pub fn point(&self, uv: [f64; 2]) -> DVec3 {
        let ((sin_u, cos_u), (sin_v, cos_v)) = (uv[0].sin_cos(), uv[1].sin_cos());
        let [r, k] = self.radii;
        let local = match self.kind {
            FaceKind::Plane => DVec3::new(uv[0], uv[1], 0.0),
            FaceKind::Cylinder => DVec3::new(r * cos_u, r * sin_u, uv[1]),
            FaceKind::Cone => DVec3::new((r + k * uv[1]) * cos_u, (r + k * uv[1]) * sin_u, uv[1]),
            FaceKind::Sphere => DVec3::new(r * cos_v * cos_u, r * cos_v * sin_u, r * sin_v),
            FaceKind::Torus => DVec3::new((r + k * cos_v) * cos_u, (r + k * cos_v) * sin_u, k * sin_v),
            FaceKind::Nets => return self.net.as_ref().expect("a net").point(uv),
        };
        self.origin + self.axes * local
    }
    fn bounds(&self, low: [f64; 2], high: [f64; 2]) -> Aabb {
        let lerp = |k: usize, s: usize| low[k] + (high[k] - low[k]) * s as f64 / 64.0;
        let points = (0..65).flat_map(|i| (0..65).map(move |j| (i, j)));
        let bounds = Aabb::around(points.map(|(i, j)| self.point([lerp(0, i), lerp(1, j)])));
        bounds.grown(bounds.diagonal() * 2e-3)
    }
}

struct Item(Aabb);

impl Boundable for Item {
    fn aabb(&self) -> obvhs::aabb::Aabb {
        let narrow = |v: DVec3| Vec3A::new(v.x as f32, v.y as f32, v.z as f32);
        obvhs::aabb::Aabb::new(narrow(self.0.min), narrow(self.0.max))
    }
}

fn tree(boxes: Vec<Aabb>) -> (Vec<BvhNode>, Vec<u32>) {
    let items: Vec<Item> = boxes.into_iter().map(Item).collect();
    let parameters =
        BvhBuildParams { pre_split: false, max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
    let built = build_cwbvh(&items, parameters, &mut Default::default());
    (built.nodes.iter().map(|node| bytemuck::cast(*node)).collect(), built.primitive_indices)
}

fn split(position: DVec3, step: f64) -> ([i32; 3], DVec3) {
    let grid = (position / step).round();
    ([grid.x as i32, grid.y as i32, grid.z as i32], position - grid * step)
}

fn f32s(v: DVec3) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

/// A scene of one part, standing in model space wherever `placements` (model ← part) put it.
pub fn scene_of(faces: &[TestFace], placements: &[DAffine3]) -> SceneBuffers {
    let part_bounds = faces.iter().fold(Aabb::EMPTY, |all, face| all.union(face.bounds(face.low, face.high)));
    let model = placements.iter().fold(Aabb::EMPTY, |all, p| all.union(part_bounds.transformed(*p)));
    let step = (model.diagonal() / 65536.0).log2().ceil().exp2();
    let anchor = (model.center() / step).round() * step;
    let half = (model.max - anchor).max(anchor - model.min) * 1.001;
    let mut scene = SceneBuffers {
        header: Header {
            world_anchor: anchor.to_array(),
            grid_step: step,
            half_size: f32s(half),
            ..Header::default()
        },
        body_infos: vec![BodyInfo::default()],
        materials: vec![Material::of_color([0.5, 0.55, 0.6])],
        ..SceneBuffers::default()
    };
    // Part space is centred.
    let center = (part_bounds.center() / step).round() * step;
    let radius = part_bounds.diagonal() * 0.51;
    let (nodes, order) = tree(
        placements
            .iter()
            .map(|p| {
                let c = p.transform_point3(center) - anchor;
                let reach = radius * p.matrix3.determinant().abs().cbrt();
                Aabb { min: c - reach, max: c + reach }.grown(reach * 1e-3)
            })
            .collect(),
    );
    scene.header.node_count = nodes.len() as u32;
    scene.bvh_nodes = nodes;
    scene.primitives = order;
    for placement in placements {
        add_instance(&mut scene, placement, center, radius, anchor, step);
    }
    add_part(&mut scene, faces, center, step);
    scene
}

fn add_instance(
    scene: &mut SceneBuffers,
    placement: &DAffine3,
    center: DVec3,
    radius: f64,
    anchor: DVec3,
    step: f64,
) {
    let origin = placement.transform_point3(center) - anchor;
    let (grid, fraction) = split(origin, step);
    let inverse = placement.matrix3.inverse();
    let row = |k: usize| inverse.row(k);
    scene.instances.push(Instance {
        part_from_world_0: f32s(row(0)),
        part: 0,
        part_from_world_1: f32s(row(1)),
        material: NO_MATERIAL,
        part_from_world_2: f32s(row(2)),
        is_translation: u32::from(placement.matrix3 == DMat3::IDENTITY),
        grid,
        flags: 0,
        fraction: f32s(fraction),
        radius: radius as f32,
        material_shift: 0,
        reserved_1: 0,
        reserved_2: [0; 2],
    });
    scene.instances_f64.push(InstanceF64 {
        part_from_world: [0, 1, 2].map(|k| row(k).to_array()),
        origin: origin.to_array(),
    });
    scene.metadata.instances.push(InstanceInfo::default());
}

fn add_part(scene: &mut SceneBuffers, faces: &[TestFace], center: DVec3, step: f64) {
    let (mut boxes, mut words) = (Vec::new(), Vec::new());
    for (index, face) in faces.iter().enumerate() {
        if let Some(net) = &face.net {
            add_net(scene, net, index as u32, center);
            let count = 1 << net.level;
            for leaf in 0..count * count {
                let at = |i: usize| i as f64 / count as f64;
                let (i, j) = (leaf / count, leaf % count);
                let bounds = face.bounds([at(i), at(j)], [at(i + 1), at(j + 1)]);
                boxes.push(Aabb { min: bounds.min - center, max: bounds.max - center });
                let first = scene.net_leaves.len() - count * count;
                words.push(pack(Primitive::NetLeaf((first + leaf) as u32)));
            }
        } else {
            let bounds = face.bounds(face.low, face.high);
            boxes.push(Aabb { min: bounds.min - center, max: bounds.max - center });
            words.push(pack(Primitive::Face(index as u32)));
        }
        add_face(scene, face, center, step);
    }
    let (nodes, order) = tree(boxes);
    scene.parts.push(Part {
        first_node: scene.bvh_nodes.len() as u32,
        node_count: nodes.len() as u32,
        first_primitive: scene.primitives.len() as u32,
        primitive_count: order.len() as u32,
    });
    scene.bvh_nodes.extend(nodes);
    scene.primitives.extend(order.iter().map(|&i| words[i as usize]));
}

fn add_face(scene: &mut SceneBuffers, face: &TestFace, center: DVec3, step: f64) {
    let is_net = face.net.is_some();
    let origin = if is_net { DVec3::ZERO } else { face.origin - center };
    let (grid, offset) = split(origin, step);
    let size = [face.high[0] - face.low[0], face.high[1] - face.low[1]];
    let scale = size.map(|s| 1.0 / s);
    let period = [0, 1].map(|k| if face.periodic[k] { std::f64::consts::TAU * scale[k] } else { 0.0 });
    scene.faces.push(Face {
        grid,
        kind: face.kind as u32,
        x_axis: f32s(face.axes.x_axis),
        radius_0: face.radii[0] as f32,
        y_axis: f32s(face.axes.y_axis),
        radius_1: face.radii[1] as f32,
        z_axis: f32s(face.axes.z_axis),
        flags: if face.reversed { Face::REVERSED } else { 0 },
        offset: f32s(offset),
        material: 0,
        uv_low: face.low.map(|x| x as f32),
        uv_scale: scale.map(|x| x as f32),
        period: period.map(|x| x as f32),
        trim_root: TRIM_INSIDE,
        part: 0,
        slack: (face.bounds(face.low, face.high).diagonal() * 2f64.powi(-21)) as f32,
        body: 0,
        reserved: [0; 2],
    });
    scene.faces_f64.push(FaceF64 {
        origin: origin.to_array(),
        x_axis: face.axes.x_axis.to_array(),
        y_axis: face.axes.y_axis.to_array(),
        z_axis: face.axes.z_axis.to_array(),
        radii: face.radii,
        uv_low: face.low,
        uv_scale: scale,
        period,
    });
    scene.face_infos.push(FaceInfo { entity: 0, uv_low: face.low, uv_size: size });
}

fn add_net(scene: &mut SceneBuffers, net: &TestNet, face: u32, center: DVec3) {
    let index = scene.nets.len() as u32;
    scene.nets.push(Net {
        first_point: scene.net_points.len() as u32,
        degrees: net.degrees[0] as u32 | (net.degrees[1] as u32) << 8 | 1 << 16,
        face,
        reserved: 0,
        uv_low: [0.0; 2],
        uv_size: [1.0; 2],
    });
    let moved = |p: &[f64; 4]| {
        let w = p[3];
        [p[0] - center.x * w, p[1] - center.y * w, p[2] - center.z * w, w]
    };
    scene.net_points_f64.extend(net.points.iter().map(moved));
    scene.net_points.extend(net.points.iter().map(|p| moved(p).map(|x| x as f32)));
    let count = 1_u32 << net.level;
    for i in 0..count {
        for j in 0..count {
            let low = [f64::from(i), f64::from(j)].map(|x| x / f64::from(count));
            let mut leaf = leaf_of(net, low, 1.0 / f64::from(count), center);
            leaf.domain = i | net.level << 12 | j << 16 | net.level << 28;
            leaf.net = index;
            scene.net_leaves.push(leaf);
        }
    }
}

/// The skew slab of a sub-domain from samples, with room for what lies between them.
fn leaf_of(net: &TestNet, low: [f64; 2], size: f64, center: DVec3) -> NetLeaf {
    let samples: Vec<[f64; 2]> =
        (0..=16).flat_map(|i| (0..=16).map(move |j| [f64::from(i) / 16.0, f64::from(j) / 16.0])).collect();
    let at = |st: [f64; 2]| [low[0] + st[0] * size, low[1] + st[1] * size];
    let middle = net.point(at([0.5, 0.5]));
    let [a, b] = net.tangents(at([0.5, 0.5])).map(|t| t * size);
    let (a, b) = (DVec3::from_array(f32s(a).map(f64::from)), DVec3::from_array(f32s(b).map(f64::from)));
    let n = a.cross(b).normalize();
    let inverse = DMat3::from_cols(a, b, n).inverse();
    let (mut extent, mut e, mut bend) = (DVec3::ZERO, [[0.0_f64; 2]; 3], [0.0_f64; 3]);
    for st in samples {
        let p = inverse * (net.point(at(st)) - middle);
        extent = extent.max(p.abs());
        let [s, t] = net.tangents(at(st)).map(|d| inverse * d * size);
        let h = 1e-4;
        let [s_s, t_s] = net.tangents(at([st[0] + h, st[1]])).map(|d| inverse * d * size);
        let [_, t_t] = net.tangents(at([st[0], st[1] + h])).map(|d| inverse * d * size);
        let frame = inverse.inverse();
        for (most, change) in bend.iter_mut().zip([s_s - s, t_s - t, t_t - t]) {
            *most = most.max((frame * change).length() / h);
        }
        e[0] = [e[0][0].max((s.x - 1.0).abs()), e[0][1].max(t.x.abs())];
        e[1] = [e[1][0].max(s.y.abs()), e[1][1].max((t.y - 1.0).abs())];
        e[2] = [e[2][0].max(s.z.abs()), e[2][1].max(t.z.abs())];
    }
    let m = a.length().min(b.length());
    let byte = |e: f64| ((e * 1.1 * 64.0).ceil() as u32 + 1).min(255);
    let bytes = [byte(e[0][0] + e[0][1]), byte(e[1][0] + e[1][1]), byte((e[2][0] + e[2][1]) / m)];
    let room = m * 0.01;
    NetLeaf {
        center: f32s(middle - center),
        extent_n: (extent.z * 1.05 + room) as f32,
        tangent_u: f32s(a),
        extent_u: (extent.x - 0.5).max(0.0) as f32 * 1.05 + 0.01,
        tangent_v: f32s(b),
        extent_v: (extent.y - 0.5).max(0.0) as f32 * 1.05 + 0.01,
        certificate: bytes[0]
            | bytes[1] << 8
            | bytes[2] << 16
            | bend_byte((1.1 * (bend[0] + 2.0 * bend[1] + bend[2]) / m) as f32) << 24,
        domain: 0,
        net: 0,
        trim: TRIM_INSIDE,
    }
}

/// Numbers in 0..1 from a seed.
pub struct Random(pub u64);

impl Random {
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let mixed = (self.0 ^ (self.0 >> 33)).wrapping_mul(0xff51_afd7_ed55_8ccd);
        ((mixed ^ (mixed >> 33)) >> 11) as f64 / (1_u64 << 53) as f64
    }
    /// A point in the cube of the given half size.
    pub fn point(&mut self, half: f64) -> DVec3 {
        DVec3::new(self.unit() - 0.5, self.unit() - 0.5, self.unit() - 0.5) * (2.0 * half)
    }
    pub fn direction(&mut self) -> DVec3 {
        loop {
            let p = self.point(1.0);
            if p.length() > 0.1 && p.length() < 1.0 {
                return p.normalize();
            }
        }
    }
}
