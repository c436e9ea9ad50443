//! What eight rays find together is what each finds alone, to the bit.

use super::packet::{LANES, Packet, Segment, first_hits};
use super::ray_space::{Distance, prepare};
use super::test_scenes::Random;
use super::trace::{RawHit, first_hit_before};
use crate::render::{Exactness, Ray};
use crate::scene::{Scene, SceneBuffers};
use glam::DVec3;

/// All bits of a hit.
fn bits(hit: &RawHit<f32>) -> [u32; 9] {
    let RawHit { distance, instance, face, net, uv, certainty, is_shallow } = *hit;
    let [u, v] = uv.map(f32::to_bits);
    let [anchor, offset] = [distance.anchor, distance.offset].map(f32::to_bits);
    [anchor, offset, instance, face, net, u, v, certainty as u32, u32::from(is_shallow)]
}

/// Compares packets of rays that start near each other and go about the same way; `spread` says how nearly. Some are missing, some end early. The number of hits.
fn compare(
    scene: &Scene<'_>,
    exactness: Exactness,
    packets: usize,
    spread: f64,
    random: &mut Random,
) -> usize {
    let half = DVec3::from_array(scene.header.half_size.map(f64::from));
    let center = DVec3::from_array(scene.header.world_anchor);
    let mut hits = 0;
    let hits_something = |from: DVec3, target: DVec3| {
        let ray = Ray { origin: from, direction: (target - from).normalize() };
        prepare::<f32>(&ray, scene.header).is_some_and(|prepared| {
            first_hit_before(scene, exactness, &prepared.ray, prepared.near, Distance::INFINITE).is_some()
        })
    };
    for packet in 0..packets {
        let mut target = center + random.point(1.0) * half;
        let from = center + random.direction() * half.length() * if packet % 4 == 0 { 0.2 } else { 2.0 };
        // Every third packet at a silhouette, if there is one on the way out.
        let mut beside = center + random.direction() * half.length() * 3.0;
        for _ in 0..if packet % 3 == 0 && hits_something(from, target) { 40 } else { 0 } {
            let middle = (target + beside) * 0.5;
            *(if hits_something(from, middle) { &mut target } else { &mut beside }) = middle;
        }
        let mut segment = || {
            let target = target + random.point(spread) * half;
            let direction = (target - from).normalize();
            let prepared = prepare::<f32>(&Ray { origin: from, direction }, scene.header)?;
            let all = Segment::of(&prepared);
            let far = Distance { anchor: all.near.anchor, offset: all.near.offset + half.length() as f32 };
            match random.unit() {
                share if share < 0.1 => None,
                share if share < 0.3 => Some(Segment { far, ..all }),
                _ => Some(all),
            }
        };
        let segments: [Option<Segment>; LANES] = std::array::from_fn(|_| segment());
        let mut packet = Packet::default();
        for (lane, segment) in segments.iter().enumerate() {
            if let Some(segment) = segment {
                packet.put(lane, segment);
            }
        }
        let together = first_hits(scene, exactness, &packet).map(|first| first.map(|first| first.hit));
        for (segment, together) in segments.iter().zip(&together) {
            let alone = segment
                .and_then(|Segment { ray, near, far }| first_hit_before(scene, exactness, &ray, near, far));
            assert_eq!(
                together.as_ref().map(bits),
                alone.as_ref().map(bits),
                "{segment:?} {together:?} {alone:?}"
            );
            hits += usize::from(alone.is_some());
        }
    }
    hits
}

/// A fixture, baked.
fn baked(name: &str) -> SceneBuffers {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures");
    let model = crate::import::import(&folder.join(name).join("model.step")).expect("a fixture");
    crate::bake::bake(&model, &crate::bake::BakeOptions::default(), &|_, _| {})
}

/// All kinds of faces, instances moved and turned; rays that stay together, that part, and that have nothing in common. Places that two leaves share are found
/// twice, and which of them counts must not depend on the walk: `mug` and `spring` have many.
#[test]
fn eight_find_together_what_each_finds_alone() {
    let mut random = Random(5);
    for (name, exactness) in [
        ("mug", Exactness::Exact),
        ("spring", Exactness::Exact),
        ("caster", Exactness::Balanced),
        ("chain", Exactness::Exact),
        ("bearing", Exactness::Fast),
    ] {
        let scene = baked(name);
        for spread in [1e-3, 0.1, 1.0] {
            let hits = compare(&scene.scene(), exactness, 600, spread, &mut random);
            assert!(hits > 1200, "{name} {spread}: {hits}");
        }
    }
}

#[test]
fn packets_without_rays_find_nothing() {
    let scene = baked("knob");
    assert!(first_hits(&scene.scene(), Exactness::Exact, &Packet::default()).iter().all(Option::is_none));
}
