//! Caps against areas that are known.

use super::cpu::{Precision, probe, render};
use super::section::{Section, SectionMode, SectionPlane};
use super::{CAP, Camera, RenderOptions, first_in_section};
use crate::bake::{BakeOptions, bake};
use crate::image::Film;
use crate::scene::{Instance, Scene, SceneBuffers};
use glam::DVec3;
use std::f64::consts::PI;
use std::path::Path;

fn fixture(name: &str) -> SceneBuffers {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name).join("model.step");
    let model = crate::import::import(&path).expect("a fixture");
    bake(&model, &BakeOptions::default(), &|_, _| {})
}

/// A camera that looks straight down on a square of the given half side.
fn from_above(half: f64) -> Camera {
    let (position, forward) = (DVec3::Z * 100.0, -DVec3::Z);
    Camera { position, forward, right: DVec3::X, up: DVec3::Y, half_height: half, orthographic: true }
}

/// The same from the end of the x axis, askew: sides of a rectangle along rows of pixels would have areas in steps.
fn from_the_side(half: f64) -> Camera {
    let (position, forward) = (DVec3::X * 100.0, -DVec3::X);
    let (right, up) = (DVec3::new(0.0, 0.8, 0.6), DVec3::new(0.0, -0.6, 0.8));
    Camera { position, forward, right, up, half_height: half, orthographic: true }
}

/// Planes through the origin.
fn planes<const N: usize>(normals: [DVec3; N]) -> [SectionPlane; N] {
    normals.map(|normal| SectionPlane { normal, offset: 0.0 })
}

fn options(planes: &[SectionPlane], mode: SectionMode, side: u32) -> RenderOptions {
    RenderOptions {
        resolution: [side; 2],
        samples: 1,
        ambient_occlusion: false,
        section: Section::new(planes, mode, true).expect("few planes"),
        ..RenderOptions::default()
    }
}

/// The area of the caps of the instances whose path is wanted, mm².
fn cap_area(scene: &Scene<'_>, film: &Film, half: f64, wanted: impl Fn(&str) -> bool) -> f64 {
    let is_wanted: Vec<bool> = scene.metadata.instances.iter().map(|info| wanted(&info.path)).collect();
    let is_cap = |(&part, &face): (&u32, &u32)| part != 0 && face == 0 && is_wanted[part as usize - 1];
    let pixels = film.part.iter().zip(&film.face).filter(|&pixel| is_cap(pixel)).count();
    pixels as f64 * (2.0 * half / film.width as f64).powi(2)
}

/// The area of a ring, mm².
fn ring(inner: f64, outer: f64) -> f64 {
    PI * (outer * outer - inner * inner)
}

/// The area of what a line at a distance from the middle of a disc cuts off, mm².
fn disc_segment(radius: f64, distance: f64) -> f64 {
    radius * radius * (distance / radius).acos() - distance * (radius * radius - distance * distance).sqrt()
}

#[test]
fn caps_of_a_bearing_have_the_area_of_its_cross_section() {
    let (buffers, half) = (fixture("bearing"), 36.0);
    let scene = buffers.scene();
    // Its middle plane, in which seams and equators of balls lie.
    let options = options(&planes([DVec3::Z]), SectionMode::Each, 1024);
    let film = render(&scene, &from_above(half), &options, &|_, _| {});
    // The cage is a ring less nine pockets 10.6 mm wide: at radius r each takes the angle 2 asin(5.3 / r).
    let steps = 10_000;
    let width = (25.4 - 22.6) / f64::from(steps);
    let radii = (0..steps).map(|i| 22.6 + (f64::from(i) + 0.5) * width);
    let pockets: f64 = radii.map(|r| 9.0 * 2.0 * (5.3 / r).asin() * r * width).sum();
    for (name, exact, error) in [
        ("Außenring", ring(29.2, 35.0), 1e-3),
        ("Innenring", ring(13.0, 18.8), 1e-3),
        ("Kugel ", 9.0 * PI * 25.0, 1e-3),
        ("Käfig", ring(22.6, 25.4) - pockets, 3e-3),
    ] {
        let area = cap_area(&scene, &film, half, |path| path.contains(name));
        assert!((area / exact - 1.0).abs() < error, "{name}: {area} for {exact}");
    }
    // The cap is where its depth says.
    let deepest = film
        .part
        .iter()
        .zip(&film.face)
        .zip(&film.depth)
        .filter(|((part, face), _)| **part != 0 && **face == 0);
    assert!(deepest.into_iter().all(|(_, &depth)| (depth - 100.0).abs() < 1e-4));
}

#[test]
fn a_corner_cut_out_of_a_bearing_has_caps_on_its_own_sides_alone() {
    let (buffers, half) = (fixture("bearing"), 36.0);
    let scene = buffers.scene();
    let quarter = options(&planes([DVec3::Z, DVec3::X]), SectionMode::Corner, 2048);
    let cameras = [from_above(half), from_the_side(half)];
    let films = cameras.map(|camera| render(&scene, &camera, &quarter, &|_, _| {}));
    let [from_above, from_the_side] = &films;
    // Balls are 40 degrees apart, from the x axis on: those at 80 degrees are cut by both planes.
    let at_80 = 24.0 * 80f64.to_radians().cos();
    let balls = 5.0 * PI * 25.0 - 2.0 * disc_segment(5.0, at_80);
    // Upper halves of two rectangles, less a rounded corner and the groove.
    let rings = 2.0 * (49.0 - (1.0 - PI / 4.0) - disc_segment(5.2, 4.0) / 2.0);
    for (film, name, exact, error) in [
        (from_above, "Außenring", ring(29.2, 35.0) / 2.0, 1e-3),
        (from_above, "Innenring", ring(13.0, 18.8) / 2.0, 1e-3),
        (from_above, "Kugel ", balls, 1e-3),
        (from_the_side, "Außenring", rings, 1e-3),
        (from_the_side, "Innenring", rings, 1e-3),
        // Small, with a long border for its area.
        (from_the_side, "Kugel ", PI * (25.0 - at_80 * at_80), 2e-3),
    ] {
        let area = cap_area(&scene, film, half, |path| path.contains(name));
        assert!((area / exact - 1.0).abs() < error, "{name}: {area} for {exact}");
    }
    for (camera, film) in cameras.iter().zip(&films) {
        for pixel in (0..film.part.len()).filter(|&i| film.part[i] != 0 && film.face[i] == 0) {
            let at = [pixel % film.width, pixel / film.width].map(|i| i as f64 + 0.5);
            let ray = super::cpu::pixel_ray(camera, [2048; 2], at[0], at[1]);
            let point = ray.at(f64::from(film.depth[pixel]));
            assert!(point.x.min(point.z).abs() < 1e-4, "{point}");
        }
    }
}

#[test]
fn three_planes_cut_out_an_eighth() {
    let buffers = fixture("bearing");
    let scene = buffers.scene();
    let eighth = options(&planes([DVec3::Z, DVec3::X, DVec3::Y]), SectionMode::Corner, 512);
    let film = render(&scene, &from_above(36.0), &eighth, &|_, _| {});
    let area = cap_area(&scene, &film, 36.0, |path| path.contains("Außenring"));
    assert!((area / (ring(29.2, 35.0) / 4.0) - 1.0).abs() < 4e-3, "{area}");
}

#[test]
fn what_is_cut_twice_is_cut_to_a_corner_and_uncut_parts_stay() {
    let buffers = fixture("bearing");
    let options = options(&planes([DVec3::Z, DVec3::X]), SectionMode::Each, 200);
    let count = |scene: &Scene<'_>, is: &dyn Fn(usize, u32, u32) -> bool| {
        let film = render(scene, &from_above(36.0), &options, &|_, _| {});
        (0..film.part.len()).filter(|&i| is(i % 200, film.part[i], film.face[i])).count()
    };
    let right = |x: usize, part: u32, _: u32| part != 0 && x > 100;
    assert_eq!(count(&buffers.scene(), &right), 0);
    let instances: Vec<Instance> =
        buffers.instances.iter().map(|instance| Instance { flags: Instance::UNCUT, ..*instance }).collect();
    let whole = Scene { instances: &instances, ..buffers.scene() };
    assert!(count(&whole, &right) > 1000);
    assert_eq!(count(&whole, &|_, part, face| part != 0 && face == 0), 0);
}

/// What lines ask of all hits is what pictures show.
#[test]
fn first_hits_of_all_hits_are_those_of_pictures() {
    let buffers = fixture("bearing");
    let scene = buffers.scene();
    let normals = [DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.0, 0.6, 0.8)];
    let planes = normals.map(|normal| SectionPlane { normal, offset: 2.0 });
    for (planes, mode) in [(&planes[..1], SectionMode::Each), (&planes, SectionMode::Corner)] {
        assert_lines_ask_what_pictures_show(&scene, &options(planes, mode, 150));
    }
}

fn assert_lines_ask_what_pictures_show(scene: &Scene<'_>, options: &RenderOptions) {
    let film = render(scene, &from_above(36.0), options, &|_, _| {});
    let rays: Vec<_> = (0..150 * 150)
        .map(|i| {
            super::cpu::pixel_ray(&from_above(36.0), [150; 2], (i % 150) as f64 + 0.5, (i / 150) as f64 + 0.5)
        })
        .collect();
    let hits = probe(scene, &rays, Precision::F32, false);
    let mut differing = 0;
    let mut caps = 0;
    for (pixel, (ray, hits)) in rays.iter().zip(&hits).enumerate() {
        let seen = first_in_section(scene, &options.section, ray, hits)
            .map_or((0, 0), |hit| (hit.instance + 1, if hit.face == CAP { 0 } else { hit.face + 1 }));
        caps += u32::from(seen.0 != 0 && seen.1 == 0);
        differing += u32::from(seen != (film.part[pixel], film.face[pixel]));
    }
    assert!(caps > 2000 && differing < 5, "{differing} of {caps}");
}
