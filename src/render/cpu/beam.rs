//! Whether anything may be seen in a block of pixels: where its beam meets no primitive's box its rays need not be traced, one by one.
//!
//! The rays of a block begin in a box of origins and run in a box of directions; interval arithmetic tells whether some of them may meet the children of a node
//! (Boulos, Wald and Shirley 2006). All is f64, and the origins' box is wider by what rays in f32 are off within the scene. The BVHs' boxes hold the slack
//! already.

use super::Kernel;
use super::camera::in_picture;
use super::frames::{InstanceFrame, grid_position};
use super::lanes::Octet;
use super::ray_space::scene_radius;
use crate::render::Camera;
use crate::scene::{BvhNode, MAX_TREE_DEPTH, Scene};
use arrayvec::ArrayVec;
use glam::{DMat3, DVec3};

/// By how much the box of origins is wider, in radii of the scene: forty roundings of f32, of which a ray makes a few at the scene's scale on its way.
const WIDER: f64 = 40.0 / 16_777_216.0;

/// Of a direction's component that may be smaller, while that along the view is 1, no plane is sure to be met.
const LEAST_COMPONENT: f64 = 1e-6;

/// Nodes that wait at most, as in `bvh`.
const STACK_SIZE: usize = 7 * MAX_TREE_DEPTH + 1;

/// Rays side by side. Their directions are as long as makes their component along the view 1: so all of them lie between those at the corners.
#[derive(Debug, Clone, Copy)]
pub struct Beam {
    origin: Interval,
    direction: Interval,
    /// How far along the directions the scene ends.
    reach: f64,
}

/// All vectors within `half` of `middle`, component by component.
#[derive(Debug, Clone, Copy)]
struct Interval {
    middle: DVec3,
    half: DVec3,
}

impl Interval {
    /// The least that holds some vectors.
    fn around(corners: [DVec3; 4]) -> Self {
        let [low, high] =
            [DVec3::min, DVec3::max].map(|of| corners.into_iter().reduce(of).unwrap_or_default());
        Self { middle: (low + high) * 0.5, half: (high - low) * 0.5 }
    }

    /// What a linear map may make of it.
    fn mapped(self, map: DMat3) -> Self {
        let absolute = DMat3::from_cols(map.x_axis.abs(), map.y_axis.abs(), map.z_axis.abs());
        Self { middle: map * self.middle, half: absolute * self.half }
    }

    fn ends(self, axis: usize) -> [f64; 2] {
        [self.middle[axis] - self.half[axis], self.middle[axis] + self.half[axis]]
    }
}

impl Beam {
    /// The rays through the pixels from `low` to `high`, these not included, of a picture.
    pub fn through(
        scene: &Scene<'_>,
        camera: &Camera,
        resolution: [u32; 2],
        low: [usize; 2],
        high: [usize; 2],
    ) -> Self {
        let across = |x: usize, y: usize| {
            let [x, y, aspect] = in_picture(resolution, x as f64, y as f64);
            camera.across(x, y, aspect)
        };
        let corners = [
            across(low[0], low[1]),
            across(high[0], low[1]),
            across(low[0], high[1]),
            across(high[0], high[1]),
        ];
        let eye = camera.position - DVec3::from_array(scene.header.world_anchor);
        let radius = scene_radius(scene.header);
        let [origins, directions] = if camera.orthographic {
            [corners.map(|across| eye + across), [camera.forward; 4]]
        } else {
            [[eye; 4], corners.map(|across| camera.forward + across)]
        };
        let mut origin = Interval::around(origins);
        origin.half += WIDER * radius;
        Self { origin, direction: Interval::around(directions), reach: eye.length() + radius }
    }

    /// In the part of an instance.
    fn in_part(&self, scene: &Scene<'_>, instance: u32) -> Self {
        let InstanceFrame { rows, grid, fraction, .. } = f32::instance(scene, instance);
        let [x, y, z] = rows.map(|row| row.to_f64());
        let map = DMat3::from_cols(x, y, z).transpose();
        let place = grid_position(grid, scene.header.grid_step).to_f64() + fraction.to_f64();
        let origin = Interval { middle: self.origin.middle - place, ..self.origin };
        Self { origin: origin.mapped(map), direction: self.direction.mapped(map), ..*self }
    }

    fn shaft(&self) -> Shaft {
        let axis = |axis| ShaftAxis::new(self.origin.ends(axis), self.direction.ends(axis), self.reach);
        Shaft { axes: [axis(0), axis(1), axis(2)], reach: self.reach }
    }
}

/// Whether some ray of the beam may meet something.
pub fn may_meet(scene: &Scene<'_>, beam: &Beam) -> bool {
    let meets_part = |instance: u32| {
        let part = &scene.parts[scene.instances[instance as usize].part as usize];
        let shaft = beam.in_part(scene, instance).shaft();
        meets_tree(scene, [part.first_node, part.node_count], &shaft, |_| true)
    };
    if scene.instances.len() == 1 {
        return meets_part(0);
    }
    let meets_some =
        |words: [usize; 2]| scene.primitives[words[0]..words[1]].iter().any(|&word| meets_part(word));
    meets_tree(scene, [0, scene.header.node_count], &beam.shaft(), meets_some)
}

/// Whether the beam meets a box of primitives, given by the first and the one after the last of the tree, that `accept` takes.
fn meets_tree(
    scene: &Scene<'_>,
    [first_node, node_count]: [u32; 2],
    shaft: &Shaft,
    accept: impl Fn([usize; 2]) -> bool,
) -> bool {
    let mut waiting: ArrayVec<u32, STACK_SIZE> = ArrayVec::new();
    if node_count > 0 {
        waiting.push(0);
    }
    while let Some(index) = waiting.pop() {
        let node = &scene.bvh_nodes[(first_node + index) as usize];
        let met = shaft.children_met(node);
        let mut rank = 0;
        for slot in 0..8 {
            let (is_met, is_node, meta) =
                (met >> slot & 1 == 1, node.imask >> slot & 1 == 1, node.child_meta[slot]);
            if is_node {
                if is_met {
                    waiting.push(node.child_base + rank);
                }
                rank += 1;
            } else if is_met && meta != 0 {
                let first = (node.primitive_base + u32::from(meta & 31)) as usize;
                if accept([first, first + (meta >> 5).count_ones() as usize]) {
                    return true;
                }
            }
        }
    }
    false
}

/// A beam as the node test wants it.
#[derive(Debug, Clone, Copy)]
struct Shaft {
    axes: [ShaftAxis; 3],
    reach: f64,
}

/// A beam along one axis.
#[derive(Debug, Clone, Copy)]
enum ShaftAxis {
    /// All rays run the same way: least and greatest of the origin, and of 1 over the direction.
    Along { origin: [f64; 2], inverse: [f64; 2] },
    /// Where the rays stay.
    Across([f64; 2]),
}

impl ShaftAxis {
    fn new(origin: [f64; 2], direction: [f64; 2], reach: f64) -> Self {
        if direction[0] > LEAST_COMPONENT || direction[1] < -LEAST_COMPONENT {
            return Self::Along { origin, inverse: [1.0 / direction[1], 1.0 / direction[0]] };
        }
        let drift = reach * direction[0].abs().max(direction[1].abs());
        Self::Across([origin[0] - drift, origin[1] + drift])
    }
}

impl Shaft {
    /// A bit for each of the slots whose box some ray may meet.
    ///
    /// A ray meets plane p at `(p − o) / d`, which is least and greatest where o and 1 / d are.
    fn children_met(&self, node: &BvhNode) -> u32 {
        type Eight = <f64 as Kernel>::Octet;
        let all = |number: f64| <Eight as Octet<f64>>::all(number);
        let low = [&node.child_min_x, &node.child_min_y, &node.child_min_z];
        let high = [&node.child_max_x, &node.child_max_y, &node.child_max_z];
        let (mut enter, mut leave, mut met) = (all(-self.reach), all(self.reach), 0xff);
        for (axis, shaft) in self.axes.iter().enumerate() {
            let spacing = f64::from(f32::from_bits(u32::from(node.e[axis]) << 23));
            let planes =
                |bytes: &[u8; 8]| Eight::of_bytes(bytes) * all(spacing) + all(f64::from(node.p[axis]));
            let (low, high) = (planes(low[axis]), planes(high[axis]));
            match *shaft {
                ShaftAxis::Across([from, to]) => met &= low.at_most(all(to)) & all(from).at_most(high),
                ShaftAxis::Along { origin, inverse: [least, greatest] } => {
                    let (above, below) = (low - all(origin[1]), high - all(origin[0]));
                    let (first, last) = if least > 0.0 { (above, below) } else { (below, above) };
                    enter = (first * all(least)).lesser(first * all(greatest)).greater(enter);
                    leave = (last * all(least)).greater(last * all(greatest)).lesser(leave);
                }
            }
        }
        met & enter.at_most(leave)
    }
}

#[cfg(test)]
mod tests {
    use super::super::camera::pixel_ray;
    use super::super::probe::first_distances;
    use super::super::test_scenes::{Random, TestFace, scene_of};
    use super::*;
    use crate::render::{Ray, Viewpoint};
    use crate::scene::FaceKind;
    use glam::{DAffine3, DQuat};
    use std::f64::consts::{FRAC_PI_2, TAU};

    const RESOLUTION: [u32; 2] = [96, 64];
    const BLOCK: usize = 8;

    /// How many blocks are left out; fails where a ray of one of those hits.
    fn blocks_left_out(scene: &Scene<'_>, camera: &Camera, random: &mut Random) -> usize {
        let [width, height] = RESOLUTION.map(|n| n as usize);
        let corners = (0..height).step_by(BLOCK).flat_map(|y| (0..width).step_by(BLOCK).map(move |x| [x, y]));
        let is_left_out = |&low: &[usize; 2]| {
            let beam = Beam::through(scene, camera, RESOLUTION, low, low.map(|x| x + BLOCK));
            !may_meet(scene, &beam)
        };
        let left_out: Vec<[usize; 2]> = corners.filter(is_left_out).collect();
        // At the block's corners and within.
        let mut places = |low: [usize; 2]| -> Vec<Ray> {
            let mut place = |index: usize| {
                let share = if index < 4 {
                    [index & 1, index >> 1].map(|x| x as f64)
                } else {
                    [0, 1].map(|_| random.unit())
                };
                [0, 1].map(|k| low[k] as f64 + share[k] * BLOCK as f64)
            };
            (0..40).map(&mut place).map(|[x, y]| pixel_ray(camera, RESOLUTION, x, y)).collect()
        };
        for &low in &left_out {
            let rays = places(low);
            assert!(first_distances(scene, &rays).iter().all(|t| t.is_infinite()), "{low:?} {camera:?}");
        }
        left_out.len()
    }

    #[test]
    fn no_ray_of_a_block_that_is_left_out_hits_anything() {
        let ball = TestFace::analytic(FaceKind::Sphere, [0.4, 0.0], [0.0, -FRAC_PI_2], [TAU, FRAC_PI_2]);
        let plate = TestFace::analytic(FaceKind::Plane, [0.0; 2], [-1.5, -0.02], [1.5, 0.02]);
        let rod = TestFace::analytic(FaceKind::Cylinder, [0.01, 0.0], [0.0, -2.0], [TAU, 2.0]);
        let faces = [ball.placed(DVec3::new(0.3, 0.1, 0.2), DMat3::IDENTITY), plate, rod];
        let mut random = Random(11);
        let turned = |random: &mut Random| {
            let turn = DQuat::from_euler(glam::EulerRot::XYZ, random.unit() * TAU, random.unit() * TAU, 0.3);
            DAffine3::from_scale_rotation_translation(
                // Every other one a mirror image.
                DVec3::new(1.0, 1.0, if random.unit() < 0.5 { -1.0 } else { 1.0 }) * (0.5 + random.unit()),
                turn,
                random.point(4.0),
            )
        };
        let several: Vec<DAffine3> = (0..9).map(|_| turned(&mut random)).collect();
        let (mut left_out, mut blocks) = (0, 0);
        for placements in
            [vec![DAffine3::IDENTITY], vec![DAffine3::from_translation(DVec3::splat(7e4))], several]
        {
            let scene = scene_of(&faces, &placements);
            let scene = scene.scene();
            for turn in 0..24 {
                // Some along axes, some from afar, some from within.
                let direction = match turn % 4 {
                    0 => [DVec3::X, -DVec3::Y, DVec3::Z][turn / 4 % 3],
                    _ => random.direction(),
                };
                let orthographic = turn % 3 == 0;
                let view =
                    Viewpoint { direction: Some(direction), orthographic, fill: 0.6, ..Viewpoint::default() };
                let framed = Camera::framing(&view, &scene, 1.5);
                let far = Camera {
                    position: framed.position - framed.forward * 1e4,
                    half_height: framed.half_height * 1e-3,
                    ..framed
                };
                let within = Camera { position: DVec3::from_array(scene.header.world_anchor), ..framed };
                let camera = [framed, framed, if orthographic { framed } else { far }, within][turn / 4 % 4];
                left_out += blocks_left_out(&scene, &camera, &mut random);
                blocks += RESOLUTION.iter().map(|&n| n as usize / BLOCK).product::<usize>();
            }
        }
        assert!(left_out * 4 > blocks, "{left_out} of {blocks}");
    }
}
