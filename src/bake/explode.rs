//! An assembly taken apart along its product tree: what a product contains moves away from its middle, and what that contains in turn away from its own, each
//! time half as far, so that what belongs together is seen to.
//!
//! A product is what all instances below one path have in common; of instances with one path each moves on its own. All moves are whole grid steps, so
//! that shape, and the precision of rays in it, stay what they were.

use super::narrow;
use super::rearrange::{Rearranged, Standing, rearrange, slot_box, world_box};
use crate::numeric::Aabb;
use crate::scene::{Part, Scene};
use glam::DVec3;
use std::collections::HashMap;

/// A scene taken apart.
#[derive(Debug)]
pub struct ExplodedScene(Rearranged);

impl ExplodedScene {
    /// The scene, with the arrays that have not changed from the one that it was.
    pub fn of<'a>(&'a self, whole: &Scene<'a>) -> Scene<'a> {
        self.0.of(whole)
    }
}

/// Takes a validated scene apart: what is right below the root goes away from the root's middle by `factor` times the distance of its own middle from there,
/// what is below that from its product's middle by half of that share of the distance, and so on.
///
/// # Errors
///
/// The reason why the instances cannot stand so far apart.
pub fn explode(scene: &Scene<'_>, factor: f64) -> Result<ExplodedScene, &'static str> {
    let step = scene.header.grid_step;
    let part_boxes: Vec<Aabb> = scene.parts.iter().map(|part| part_box(scene, part)).collect();
    let boxes: Vec<Aabb> = scene
        .instances
        .iter()
        .map(|instance| world_box(instance, part_boxes[instance.part as usize], step))
        .collect();
    let paths = scene.metadata.instances.iter().map(|info| info.path.as_str());
    let shifts = shifts(paths, &boxes, factor);
    let standing: Vec<Standing> = boxes
        .iter()
        .zip(shifts)
        .enumerate()
        .map(|(index, (&bounds, shift))| Standing { index, bounds, shift: narrow::snap(shift, step) })
        .collect();
    rearrange(scene, scene.bvh_nodes.to_vec(), &standing).map(ExplodedScene)
}

/// The box of a part, part space: that of its root's children; of one without any, its origin.
fn part_box(scene: &Scene<'_>, part: &Part) -> Aabb {
    if part.node_count == 0 {
        return Aabb::around([DVec3::ZERO]);
    }
    let root = &scene.bvh_nodes[part.first_node as usize];
    (0..8)
        .filter(|&slot| root.child_meta[slot] != 0)
        .map(|slot| slot_box(root, slot))
        .fold(Aabb::EMPTY, Aabb::union)
}

/// By how much each instance moves, from its path and its box.
fn shifts<'p>(paths: impl Iterator<Item = &'p str> + Clone, boxes: &[Aabb], factor: f64) -> Vec<DVec3> {
    let mut products: HashMap<&str, Aabb> = HashMap::new();
    for (path, &bounds) in paths.clone().zip(boxes) {
        for product in products_of(path) {
            let whole = products.entry(product).or_insert(Aabb::EMPTY);
            *whole = whole.union(bounds);
        }
    }
    let shift = |(path, &own): (&'p str, &Aabb)| {
        let wholes = products_of(path).map(|product| products[product].center());
        let inner = wholes.clone().skip(1).chain([own.center()]);
        let mut share = factor;
        let away = |(whole, inner): (DVec3, DVec3)| {
            let away = (inner - whole) * share;
            share *= 0.5;
            away
        };
        wholes.zip(inner).map(away).sum()
    };
    paths.zip(boxes).map(shift).collect()
}

/// The paths of the products that an instance is in, from the root.
fn products_of(path: &str) -> impl Iterator<Item = &str> + Clone {
    path.match_indices('/').map(|(at, _)| &path[..at])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inner_products_go_along_and_spread_half_as_far() {
        let at = |x: f64, y: f64| Aabb { min: DVec3::new(x, y, 0.0), max: DVec3::new(x, y, 2.0) };
        let paths = ["Car/Frame", "Car/Axle/Wheel", "Car/Axle/Wheel"];
        let boxes = [at(-10.0, 0.0), at(10.0, -4.0), at(10.0, 4.0)];
        let found = shifts(paths.into_iter(), &boxes, 1.0);
        assert_eq!(
            found,
            [DVec3::new(-10.0, 0.0, 0.0), DVec3::new(10.0, -2.0, 0.0), DVec3::new(10.0, 2.0, 0.0)]
        );
        assert_eq!(shifts(["Alone"].into_iter(), &boxes[..1], 1.0), [DVec3::ZERO]);
    }
}
