//! A small scene built by hand, with every kind of face: what the kernels see, without the importer and the bake.

use glam::{DMat3, DVec3, Vec3};
use obvhs::{BvhBuildParams, aabb::Aabb, cwbvh::builder::build_cwbvh};
use std::f32::consts::{PI, TAU};
use std::time::Duration;
use trimray::bake::{BakeOptions, bake};
use trimray::brep::{self, Body, BodyKind, Model};
use trimray::geometry::{BsplineCurve, Frame, Homogeneous, Surface, to_bspline};
use trimray::scene::primitive::{Primitive, pack};
use trimray::scene::{
    Band, BodyInfo, BvhNode, Face, FaceInfo, FaceKind, Instance, InstanceInfo, Material, NO_MATERIAL, Net,
    NetLeaf, Part, SceneBuffers, TRIM_INSIDE, TrimSegment, trim_word,
};

const GRID_STEP: f64 = 1.0 / 1024.0;
/// Leaves of the net along u and along v, as a power of two.
const NET_LEVEL: u32 = 2;

/// Low and high corner.
type Box3 = (Vec3, Vec3);

/// What the part's BVH holds: words and their boxes.
#[derive(Default)]
struct Primitives {
    words: Vec<u32>,
    boxes: Vec<Box3>,
}

/// The kinds in a row along x, in three instances: two moved, one turned.
pub fn every_kind() -> SceneBuffers {
    let mut scene = SceneBuffers::default();
    let mut primitives = Primitives::default();
    scene.body_infos.push(BodyInfo::default());
    let hole = push_hole(&mut scene);
    let kinds = [FaceKind::Plane, FaceKind::Cylinder, FaceKind::Cone, FaceKind::Sphere, FaceKind::Torus];
    for (index, kind) in kinds.into_iter().enumerate() {
        let center = Vec3::new(-12.0 + 5.0 * index as f32, 0.3, -0.1);
        let trimmed = matches!(kind, FaceKind::Plane | FaceKind::Cylinder | FaceKind::Torus);
        push_analytic(&mut scene, &mut primitives, kind, center, if trimmed { hole } else { TRIM_INSIDE });
    }
    push_net(&mut scene, &mut primitives, Vec3::new(13.0, 0.0, 0.0), hole);
    let radius =
        primitives.boxes.iter().map(|(low, high)| low.abs().max(high.abs()).length()).fold(0.0, f32::max);
    let turned = DMat3::from_axis_angle(DVec3::new(1.0, 2.0, 3.0).normalize(), 0.7);
    let placements = [
        (DMat3::IDENTITY, DVec3::new(0.125, -8.0, 0.0)),
        (DMat3::IDENTITY, DVec3::new(0.3, 8.1, 1.7)),
        (turned, DVec3::new(-1.1, 0.4, 14.0)),
    ];
    let mut boxes = Vec::new();
    for (turn, origin) in placements {
        scene.instances.push(instance(turn, origin, radius * 1.001));
        boxes.push(placed_box(&primitives.boxes, turn, origin));
        scene.metadata.instances.push(InstanceInfo::default());
    }
    let half = boxes.iter().fold(Vec3::ZERO, |half, (low, high)| half.max(low.abs()).max(high.abs()));
    scene.header.half_size = half.to_array();
    scene.header.grid_step = GRID_STEP;
    scene.header.world_anchor = [2.0, 0.0, -4.0];
    scene.header.max_net_degree = 3;
    scene.header.max_trim_degree = 2;
    scene.header.feature_mask = 0b11_1111;
    (scene.bvh_nodes, scene.primitives) = build(&boxes);
    scene.header.node_count = scene.bvh_nodes.len() as u32;
    let (nodes, order) = build(&primitives.boxes);
    scene.parts = vec![Part {
        first_node: scene.bvh_nodes.len() as u32,
        node_count: nodes.len() as u32,
        first_primitive: scene.primitives.len() as u32,
        primitive_count: order.len() as u32,
    }];
    scene.bvh_nodes.extend(nodes);
    scene.primitives.extend(order.iter().map(|&index| primitives.words[index as usize]));
    scene.materials = vec![
        Material::of_color([0.8, 0.5, 0.3]),
        Material { opacity: 0.4, roughness: 0.2, metallic: 0.6, ..Material::of_color([0.2, 0.5, 0.9]) },
    ];
    scene
}

/// An ellipsoid of half axes 3, 3 and 2 as one rational B-spline with two poles, baked.
pub fn ellipsoid() -> SceneBuffers {
    const QUARTER: f64 = std::f64::consts::FRAC_1_SQRT_2;
    let profile =
        [[0.0, -2.0, 1.0], [3.0, -2.0, QUARTER], [3.0, 0.0, 1.0], [3.0, 2.0, QUARTER], [0.0, 2.0, 1.0]];
    let points = profile.map(|[x, z, w]| Homogeneous::new(DVec3::new(x, 0.0, z), w)).to_vec();
    let knots = [0, 0, 0, 1, 1, 2, 2, 2].map(f64::from).to_vec();
    let profile = BsplineCurve::new(2, knots, points).expect("proper knots");
    let surface = Surface::Bspline(to_bspline::revolve(&profile, &Frame::IDENTITY));
    let mut model = Model::default();
    let surface = model.surfaces.push(surface);
    let face =
        brep::Face { surface, same_sense: true, loops: vec![], color: None, name: String::new(), entity: 1 };
    let faces = vec![model.faces.push(face)];
    let body = Body { kind: BodyKind::Solid, faces, name: String::new(), entity: 2 };
    let part = brep::Part { name: "ellipsoid".into(), bodies: vec![body], children: vec![], entity: 3 };
    let part = model.parts.push(part);
    model.roots.push(part);
    model.declared_faces = 1;
    bake(&model, &BakeOptions::default(), &|_, _| {})
}

/// The box of a part's boxes after a turn and a move.
fn placed_box(boxes: &[Box3], turn: DMat3, origin: DVec3) -> Box3 {
    let (mut low, mut high) = (Vec3::MAX, Vec3::MIN);
    for (box_low, box_high) in boxes {
        for corner in 0..8 {
            let pick = |axis: usize| if corner >> axis & 1 == 0 { box_low[axis] } else { box_high[axis] };
            let p = (turn * DVec3::new(pick(0).into(), pick(1).into(), pick(2).into()) + origin).as_vec3();
            (low, high) = (low.min(p), high.max(p));
        }
    }
    (low - Vec3::splat(0.01), high + Vec3::splat(0.01))
}

fn build(boxes: &[Box3]) -> (Vec<BvhNode>, Vec<u32>) {
    let boxes: Vec<Aabb> = boxes.iter().map(|(low, high)| Aabb::new((*low).into(), (*high).into())).collect();
    let params = BvhBuildParams { max_prims_per_leaf: 1, ..BvhBuildParams::medium_build() };
    let tree = build_cwbvh(&boxes, params, &mut Duration::default());
    (bytemuck::cast_slice(&tree.nodes).to_vec(), tree.primitive_indices)
}

fn instance(turn: DMat3, origin: DVec3, radius: f32) -> Instance {
    let rows = turn.inverse();
    let grid = (origin / GRID_STEP).round();
    Instance {
        part_from_world_0: rows.row(0).as_vec3().to_array(),
        part: 0,
        part_from_world_1: rows.row(1).as_vec3().to_array(),
        material: NO_MATERIAL,
        part_from_world_2: rows.row(2).as_vec3().to_array(),
        is_translation: (turn == DMat3::IDENTITY).into(),
        grid: grid.as_ivec3().to_array(),
        flags: 0,
        fraction: (origin - grid * GRID_STEP).as_vec3().to_array(),
        radius,
        material_shift: 0,
        reserved_1: 0,
        reserved_2: [0; 2],
    }
}

/// Trims of one cell: inside but for an ellipse around the middle, four rational quadratic quarters.
fn push_hole(scene: &mut SceneBuffers) -> u32 {
    let (center, radii) = ([0.45_f32, 0.55_f32], [0.22_f32, 0.3_f32]);
    let at = |x: f32, y: f32| [center[0] + radii[0] * x, center[1] + radii[1] * y];
    let corner = std::f32::consts::FRAC_1_SQRT_2;
    let list = trim_word::pack(trim_word::TrimWord::List { offset: 0 });
    scene.trim_nodes = vec![trim_word::grid([0, 0]), 0, list, trim_word::list_head(true, 4)];
    scene.trim_nodes.extend((0..4).map(|index| trim_word::list_entry(0, index)));
    for (x, y) in [(1.0, -1.0), (1.0, 1.0), (-1.0, 1.0), (-1.0, -1.0)] {
        let offset = scene.trim_nodes.len() as u32;
        let (low, high) = if y < 0.0 { (at(0.0, y), at(x, 0.0)) } else { (at(x, 0.0), at(0.0, y)) };
        let side = at(x, y).map(|x| x * corner);
        let numbers = [low[0], low[1], side[0], side[1], corner, high[0], high[1]];
        scene.trim_nodes.extend(numbers.map(f32::to_bits));
        // In its chord's frame a quarter of a circle is 1 − √(1 − x²), or the same turned: the cubic is nowhere off by 0.1.
        let bulge = if y < 0.0 { -0.33 } else { 0.33 };
        let band = Band { bulge, skew: -0.2, by_v: false, half_width: 0.1 }.pack();
        let curve = TrimSegment::curve_word(2, false, true, offset).expect("small numbers");
        scene.trim_segments.push(TrimSegment { low, high, band, curve });
    }
    0
}

fn push_analytic(
    scene: &mut SceneBuffers,
    out: &mut Primitives,
    kind: FaceKind,
    center: Vec3,
    trim_root: u32,
) {
    let turn = glam::Mat3::from_axis_angle(Vec3::new(1.0, 1.0, 0.3).normalize(), 0.4);
    let (radii, low, size, periods) = match kind {
        FaceKind::Plane => ([0.0, 0.0], [-2.0, -2.0], [4.0, 4.0], [0.0, 0.0]),
        FaceKind::Cylinder => ([1.5, 0.0], [0.0, -2.0], [TAU, 4.0], [1.0, 0.0]),
        FaceKind::Cone => ([1.2, 0.5], [0.5, -2.0], [4.0, 3.5], [TAU / 4.0, 0.0]),
        FaceKind::Sphere => ([1.8, 0.0], [0.0, -0.5 * PI], [TAU, PI], [1.0, 0.0]),
        FaceKind::Torus => ([1.5, 0.6], [0.0, 0.0], [TAU, TAU], [1.0, 1.0]),
        FaceKind::Nets => unreachable!("nets are not analytic"),
    };
    let face = scene.faces.len() as u32;
    let grid = (center.as_dvec3() / GRID_STEP).round();
    scene.faces.push(Face {
        grid: grid.as_ivec3().to_array(),
        kind: kind as u32,
        x_axis: turn.x_axis.to_array(),
        radius_0: radii[0],
        y_axis: turn.y_axis.to_array(),
        radius_1: radii[1],
        z_axis: turn.z_axis.to_array(),
        flags: if kind == FaceKind::Cone { Face::REVERSED } else { 0 },
        offset: (center.as_dvec3() - grid * GRID_STEP).as_vec3().to_array(),
        material: u32::from(kind == FaceKind::Sphere),
        uv_low: low,
        uv_scale: [1.0 / size[0], 1.0 / size[1]],
        period: periods,
        trim_root,
        part: 0,
        slack: 1e-6,
        body: 0,
        reserved: [0; 2],
    });
    scene.face_infos.push(FaceInfo { entity: 0, uv_low: low.map(f64::from), uv_size: size.map(f64::from) });
    out.words.push(pack(Primitive::Face(face)));
    out.boxes.push((center - Vec3::splat(3.6), center + Vec3::splat(3.6)));
}

/// A wavy rational bicubic net around `center`, cut into leaves whose certificates say "no bound".
fn push_net(scene: &mut SceneBuffers, out: &mut Primitives, center: Vec3, trim_root: u32) {
    let face = scene.faces.len() as u32;
    let grid = (center.as_dvec3() / GRID_STEP).round();
    scene.faces.push(Face {
        grid: grid.as_ivec3().to_array(),
        kind: FaceKind::Nets as u32,
        x_axis: [1.0, 0.0, 0.0],
        radius_0: 0.0,
        y_axis: [0.0, 1.0, 0.0],
        radius_1: 0.0,
        z_axis: [0.0, 0.0, 1.0],
        flags: 0,
        offset: [0.0; 3],
        material: 0,
        uv_low: [0.0; 2],
        uv_scale: [1.0; 2],
        period: [0.0; 2],
        trim_root,
        part: 0,
        slack: 1e-6,
        body: 0,
        reserved: [0; 2],
    });
    scene.face_infos.push(FaceInfo { entity: 0, uv_low: [0.0; 2], uv_size: [1.0; 2] });
    let net = Net {
        first_point: 0,
        degrees: 3 | 3 << 8 | 1 << 16,
        face,
        reserved: 0,
        uv_low: [0.0; 2],
        uv_size: [1.0; 2],
    };
    scene.nets.push(net);
    for i in 0..16 {
        let (u, v) = ((i / 4) as f32, (i % 4) as f32);
        let height = 0.8 * (1.3 * u + 0.4 * v).sin() - 0.5 * (1.7 * v).cos();
        let weight = 1.0 + 0.25 * (u - 1.5) * (v - 1.5) / 2.25;
        let point = Vec3::new(-2.5 + 5.0 * u / 3.0, -2.5 + 5.0 * v / 3.0, height) * weight;
        scene.net_points.push([point.x, point.y, point.z, weight]);
    }
    let cells = 1 << NET_LEVEL;
    for cell in 0..cells * cells {
        let (u, v) = (cell / cells, cell % cells);
        let index = scene.net_leaves.len() as u32;
        let (leaf, low, high) = net_leaf(scene, u, v, trim_root);
        scene.net_leaves.push(leaf);
        out.words.push(pack(Primitive::NetLeaf(index)));
        out.boxes.push((center + low, center + high));
    }
}

/// The slab of a cell, measured on a grid of points and widened by a tenth.
fn net_leaf(scene: &SceneBuffers, u: u32, v: u32, trim: u32) -> (NetLeaf, Vec3, Vec3) {
    let size = 1.0 / (1_u32 << NET_LEVEL) as f32;
    let at = |s: f32, t: f32| net_point(&scene.net_points, (u as f32 + s) * size, (v as f32 + t) * size);
    let tangent_u = 0.5 * ((at(1.0, 0.0) - at(0.0, 0.0)) + (at(1.0, 1.0) - at(0.0, 1.0)));
    let tangent_v = 0.5 * ((at(0.0, 1.0) - at(0.0, 0.0)) + (at(1.0, 1.0) - at(1.0, 0.0)));
    let center = 0.25 * (at(0.0, 0.0) + at(0.0, 1.0) + at(1.0, 0.0) + at(1.0, 1.0));
    let n = tangent_u.cross(tangent_v).normalize();
    let dual = glam::Mat3::from_cols(tangent_u, tangent_v, n).inverse();
    let (mut reach, mut low, mut high) = (Vec3::ZERO, Vec3::MAX, Vec3::MIN);
    for k in 0..=16 * 17 {
        let p = at((k % 17) as f32 / 16.0, (k / 17) as f32 / 16.0);
        reach = reach.max((dual * (p - center)).abs());
        (low, high) = (low.min(p), high.max(p));
    }
    let leaf = NetLeaf {
        center: center.to_array(),
        extent_n: 1.1 * reach.z + 0.01,
        tangent_u: tangent_u.to_array(),
        extent_u: (1.1 * reach.x - 0.5).max(0.02),
        tangent_v: tangent_v.to_array(),
        extent_v: (1.1 * reach.y - 0.5).max(0.02),
        certificate: u32::MAX,
        domain: u | NET_LEVEL << 12 | (v | NET_LEVEL << 12) << 16,
        net: 0,
        trim,
    };
    (leaf, low - Vec3::splat(0.05), high + Vec3::splat(0.05))
}

fn net_point(points: &[[f32; 4]], u: f32, v: f32) -> Vec3 {
    let basis = |t: f32| {
        let s = 1.0 - t;
        [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
    };
    let (bu, bv) = (basis(u), basis(v));
    let mut sum = glam::Vec4::ZERO;
    for i in 0..16 {
        sum += glam::Vec4::from_array(points[i]) * bu[i / 4] * bv[i % 4];
    }
    sum.truncate() / sum.w
}
