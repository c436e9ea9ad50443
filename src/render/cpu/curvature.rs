//! The curvatures of a surface where a picture shows it: closed forms for analytic faces, first and second derivatives of nets.
//!
//! The host computes them in f64 from the hits of either device, as a layer of pictures; nothing else asks for them.

use super::NO_NET;
use super::analytic::carrier_normal;
use super::bernstein::{MAX_ORDER, basis_and_slopes, net_degrees};
use super::frames::{FaceFrame, InstanceFrame, Kernel};
use super::vector::Vector3;
use crate::scene::{FaceKind, Net, Scene, point_side};
use glam::{DVec3, DVec4};

/// How near to a side that is one point curvatures are still taken: nearer they are those of here, as what f32 rounds of control points grows with the
/// inverse of the distance.
const FROM_POINT: f64 = 1.0 / 256.0;

/// Where tangents are parallel within this, or have no length, curvatures are those of a place farther inside.
const PARALLEL: f64 = 1e-6;

/// A hit as pictures know it.
#[derive(Debug, Clone, Copy)]
pub struct Place {
    /// Index of the instance.
    pub instance: u32,
    /// Index of the face.
    pub face: u32,
    /// Index of the net, or none.
    pub net: u32,
    /// Parameters as the tracer has them.
    pub uv: [f32; 2],
    /// World-space normal, to either side: curvatures are signed by it.
    pub normal: [f32; 3],
}

/// The mean curvature, 1/mm, and the Gaussian one, 1/mm², in the world. The mean is positive where the surface bulges to the side of the normal, so that a
/// ball of radius r seen from outside has 1/r, a hole −1/2r. 0 where they are not defined: at the tip of a cone and where a net has no tangent plane.
pub fn curvature(scene: &Scene<'_>, place: &Place) -> [f64; 2] {
    let face = f32::face(scene, place.face);
    let bent = if place.net == NO_NET {
        Some(of_carrier(&face, place.uv))
    } else {
        of_net(scene, &scene.nets[place.net as usize], place.uv.map(f64::from))
    };
    let Some(Bent { normal, mean, gaussian }) = bent else { return [0.0; 2] };
    let InstanceFrame { rows, .. } = f32::instance(scene, place.instance);
    let rows = rows.map(Vector3::to_f64);
    let in_world = rows[0] * normal.x + rows[1] * normal.y + rows[2] * normal.z;
    let side = in_world.dot(DVec3::from_array(place.normal.map(f64::from))).signum();
    // Lengths in the part, of those in the world: instances scale alike in all directions.
    let scale = rows[0].length();
    let found = [mean * side * scale, gaussian * scale * scale];
    if found.iter().all(|x| x.is_finite()) { found } else { [0.0; 2] }
}

/// Curvatures in part space.
struct Bent {
    /// To the side where a positive mean bulges; of any length.
    normal: DVec3,
    mean: f64,
    gaussian: f64,
}

fn of_carrier(face: &FaceFrame<f32>, uv: [f32; 2]) -> Bent {
    let parameter = |k: usize| f64::from(face.uv_low[k]) + f64::from(uv[k]) / f64::from(face.uv_scale[k]);
    let at = [parameter(0), parameter(1)];
    let radii = face.radii.map(f64::from);
    let n = carrier_normal(face.kind, at, radii);
    let axes = face.axes.map(Vector3::to_f64);
    let normal = axes[0] * n.x + axes[1] * n.y + axes[2] * n.z;
    let [first, second] = principal(face.kind, at[1], radii);
    Bent { normal, mean: 0.5 * (first + second), gaussian: first * second }
}

/// The principal curvatures of a carrier at the height or angle `v`, towards its normal.
fn principal(kind: u32, v: f64, [radius_0, radius_1]: [f64; 2]) -> [f64; 2] {
    if kind == FaceKind::Plane as u32 {
        [0.0, 0.0]
    } else if kind == FaceKind::Cylinder as u32 {
        [1.0 / radius_0, 0.0]
    } else if kind == FaceKind::Cone as u32 {
        [1.0 / ((radius_0 + radius_1 * v).abs() * (1.0 + radius_1 * radius_1).sqrt()), 0.0]
    } else if kind == FaceKind::Sphere as u32 {
        [1.0 / radius_0; 2]
    } else {
        let from_axis = radius_0 + radius_1 * v.cos();
        // Beyond the axis of a spindle the normal points into the tube.
        let side = from_axis.signum();
        [side / radius_1, side * v.cos() / from_axis]
    }
}

/// `None` where there is no tangent plane.
fn of_net(scene: &Scene<'_>, net: &Net, uv: [f64; 2]) -> Option<Bent> {
    let mut at = [0, 1].map(|axis| {
        let [low, high] = [0, 1]
            .map(|end| if net.degrees & point_side(axis, end) != 0 { FROM_POINT } else { f64::NEG_INFINITY });
        uv[axis].max(low).min(1.0 - high)
    });
    for _ in 0..4 {
        let Derivatives { by_u, by_v, by_uu, by_uv, by_vv } = derivatives(scene, net, at);
        let normal = by_u.cross(by_v);
        let area = normal.length();
        if area > PARALLEL * by_u.length() * by_v.length() && area > 0.0 {
            let n = normal / area;
            let (e, f, g) = (by_u.length_squared(), by_u.dot(by_v), by_v.length_squared());
            // What bends away from the normal is counted positive.
            let (l, m, n_vv) = (-by_uu.dot(n), -by_uv.dot(n), -by_vv.dot(n));
            let squared = area * area;
            return Some(Bent {
                normal,
                mean: 0.5 * (e * n_vv - 2.0 * f * m + g * l) / squared,
                gaussian: (l * n_vv - m * m) / squared,
            });
        }
        at = at.map(|parameter| parameter + (0.5 - parameter) * FROM_POINT);
    }
    None
}

/// Derivatives of a surface.
struct Derivatives {
    by_u: DVec3,
    by_v: DVec3,
    by_uu: DVec3,
    by_uv: DVec3,
    by_vv: DVec3,
}

/// The derivatives of a net by the quotient rule, from those of its homogeneous points.
fn derivatives(scene: &Scene<'_>, net: &Net, uv: [f64; 2]) -> Derivatives {
    let (degree_u, degree_v) = net_degrees(net);
    let (weights_u, weights_v) = (orders(degree_u, uv[0]), orders(degree_v, uv[1]));
    let mut sums = [[DVec4::ZERO; 3]; 3];
    let mut points = scene.net_points[net.first_point as usize..].iter();
    for i in 0..=degree_u {
        let mut row = [DVec4::ZERO; 3];
        for (j, point) in points.by_ref().take(degree_v + 1).enumerate() {
            let point = DVec4::from_array(point.map(f64::from));
            (0..3).for_each(|order| row[order] += point * weights_v[order][j]);
        }
        for (order, weights) in weights_u.iter().enumerate() {
            (0..3 - order).for_each(|other| sums[order][other] += row[other] * weights[i]);
        }
    }
    let parts = |order_u: usize, order_v: usize| {
        let sum = sums[order_u][order_v];
        (sum.truncate(), sum.w)
    };
    let (a, w) = parts(0, 0);
    let [(a_u, w_u), (a_v, w_v)] = [parts(1, 0), parts(0, 1)];
    let [(a_uu, w_uu), (a_uv, w_uv), (a_vv, w_vv)] = [parts(2, 0), parts(1, 1), parts(0, 2)];
    let s = a / w;
    let (by_u, by_v) = ((a_u - s * w_u) / w, (a_v - s * w_v) / w);
    Derivatives {
        by_u,
        by_v,
        by_uu: (a_uu - by_u * (2.0 * w_u) - s * w_uu) / w,
        by_uv: (a_uv - by_v * w_u - by_u * w_v - s * w_uv) / w,
        by_vv: (a_vv - by_v * (2.0 * w_v) - s * w_vv) / w,
    }
}

/// The basis functions of `degree` at `t`, their first and their second derivatives.
fn orders(degree: usize, t: f64) -> [[f64; MAX_ORDER]; 3] {
    let (basis, slopes) = basis_and_slopes::<f64, MAX_ORDER>(degree, t);
    let mut bends = [0.0; MAX_ORDER];
    if let Some(lower) = degree.checked_sub(1).filter(|&lower| lower > 0) {
        let (_, lower_slopes) = basis_and_slopes::<f64, MAX_ORDER>(lower, t);
        let mut before = 0.0;
        for (bend, &slope) in bends.iter_mut().zip(&lower_slopes).take(degree + 1) {
            *bend = degree as f64 * (before - slope);
            before = slope;
        }
    }
    [basis, slopes, bends]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::image::{Film, Layers};
    use crate::render::cpu::render;
    use crate::render::cpu::test_scenes::{TestFace, TestNet, scene_of};
    use crate::render::{Camera, RenderOptions};
    use glam::{DAffine3, DMat3};

    /// A picture of faces near the origin from a place.
    fn film(faces: &[TestFace], placement: DAffine3, from: DVec3, half_height: f64) -> Film {
        let buffers = scene_of(faces, &[placement]);
        let forward = -from.normalize();
        let right = forward.cross(DVec3::new(0.3, 1.0, 0.2)).normalize();
        let camera = Camera {
            position: from,
            forward,
            right,
            up: right.cross(forward),
            half_height,
            orthographic: true,
        };
        let layers = Layers { curvature: true, position: true, ids: true, normal: true, ..Layers::NONE };
        let options = RenderOptions { resolution: [64, 64], samples: 1, layers, ..RenderOptions::default() };
        render(&buffers.scene(), &camera, &options, &|_, _| {})
    }

    /// Compares all pixels with what is expected at their points, and tells how many there were.
    fn check(film: &Film, tolerance: f64, expected: impl Fn(DVec3) -> [f64; 2]) -> usize {
        let mut seen = 0;
        for pixel in (0..film.part.len()).filter(|&pixel| film.part[pixel] != 0) {
            let point = DVec3::from_array(film.position[pixel].map(f64::from));
            let (found, [mean, gaussian]) = (film.curvature[pixel].map(f64::from), expected(point));
            assert!((found[0] - mean).abs() <= tolerance * mean.abs().max(0.05), "{point} {found:?} {mean}");
            assert!(
                (found[1] - gaussian).abs() <= tolerance * gaussian.abs().max(0.05),
                "{point} {found:?} {gaussian}"
            );
            seen += 1;
        }
        seen
    }

    const FULL: f64 = std::f64::consts::TAU;
    const QUARTER: f64 = std::f64::consts::FRAC_PI_2;

    #[test]
    fn analytic_faces_have_the_curvatures_of_their_kind() {
        let from = DVec3::new(20.0, 3.0, 0.0);
        let sphere = TestFace::analytic(FaceKind::Sphere, [2.0, 0.0], [0.0, -QUARTER], [FULL, QUARTER]);
        let cylinder = TestFace::analytic(FaceKind::Cylinder, [2.0, 0.0], [0.0, -2.0], [FULL, 2.0]);
        let cone = TestFace::analytic(FaceKind::Cone, [2.0, 0.5], [0.0, -2.0], [FULL, 2.0]);
        let torus = TestFace::analytic(FaceKind::Torus, [2.0, 0.5], [0.0, 0.0], [FULL, FULL]);
        let plane = TestFace::analytic(FaceKind::Plane, [0.0; 2], [-2.0; 2], [2.0; 2]);
        let seen = |face: &TestFace, from: DVec3, expected: &dyn Fn(DVec3) -> [f64; 2]| {
            let seen =
                check(&film(std::slice::from_ref(face), DAffine3::IDENTITY, from, 3.0), 1e-4, expected);
            assert!(seen > 300, "{seen}");
        };
        seen(&sphere, from, &|_| [0.5, 0.25]);
        seen(&plane, DVec3::new(2.0, 3.0, 9.0), &|_| [0.0, 0.0]);
        seen(&cone, from, &|p| [0.5 / ((2.0 + 0.5 * p.z) * 1.25f64.sqrt()), 0.0]);
        seen(&torus, DVec3::new(2.0, 3.0, 9.0), &|p| {
            let around = (p.x.hypot(p.y) - 2.0) / 0.5 / p.x.hypot(p.y);
            [0.5 * (2.0 + around), 2.0 * around]
        });
        // Through its open end the inside of a tube is seen: hollow towards the viewer, whatever its outward normal.
        let from = DVec3::new(5.0, 0.0, 9.0);
        let inside = TestFace { reversed: true, ..cylinder.clone() };
        for tube in [&cylinder, &inside] {
            seen(tube, from, &|p| [0.25 * p.x.signum(), 0.0]);
        }
    }

    #[test]
    fn what_is_turned_and_scaled_is_less_bent() {
        let sphere = TestFace::analytic(FaceKind::Sphere, [2.0, 0.0], [0.0, -QUARTER], [FULL, QUARTER]);
        let turn = DMat3::from_rotation_x(0.7) * DMat3::from_diagonal(DVec3::new(-2.5, 2.5, 2.5));
        let mirrored = DAffine3 { matrix3: turn, translation: DVec3::ZERO };
        let seen = check(&film(&[sphere], mirrored, DVec3::new(20.0, 3.0, 4.0), 6.0), 1e-4, |_| [0.2, 0.04]);
        assert!(seen > 1000, "{seen}");
    }

    /// Against differences of the normal: the change of the unit normal is the shape operator.
    #[test]
    fn nets_have_the_curvatures_that_their_normals_have() {
        let height =
            |i: usize, j: usize| [0.0, 1.3, -0.4, 0.8][i] * [1.0, 0.2, 0.9, -0.7][j] + 0.3 * i as f64;
        let points = (0..16).map(|k| {
            let (i, j) = (k / 4, k % 4);
            let w = 1.0 + 0.25 * ((i * 2 + j) % 3) as f64;
            [(i as f64 - 1.5) * w, (j as f64 - 1.5) * w, height(i, j) * w, w]
        });
        let net = TestNet { degrees: [3, 3], points: points.collect(), level: 2 };
        let normal = |uv: [f64; 2]| {
            let [s_u, s_v] = net.tangents(uv);
            s_u.cross(s_v).normalize()
        };
        let film = film(&[TestFace::nets(net.clone())], DAffine3::IDENTITY, DVec3::new(1.0, 2.0, 9.0), 1.2);
        let parameters = |p: DVec3| {
            let mut uv = [0.5; 2];
            for _ in 0..30 {
                let ([s_u, s_v], off) = (net.tangents(uv), p - net.point(uv));
                let (e, f, g) = (s_u.length_squared(), s_u.dot(s_v), s_v.length_squared());
                let (a, b) = (off.dot(s_u), off.dot(s_v));
                let d = e * g - f * f;
                uv = [uv[0] + (a * g - b * f) / d, uv[1] + (b * e - a * f) / d];
            }
            uv
        };
        let seen = check(&film, 2e-3, |p| {
            let (uv, h) = (parameters(p), 1e-5);
            let [s_u, s_v] = net.tangents(uv);
            let change = |k: usize| {
                let [mut low, mut high] = [uv; 2];
                low[k] -= h;
                high[k] += h;
                (normal(high) - normal(low)) / (2.0 * h)
            };
            let n = normal(uv);
            let twice = (change(0).cross(s_v) + s_u.cross(change(1))).dot(n);
            let area = s_u.cross(s_v).dot(n);
            [0.5 * twice / area, change(0).cross(change(1)).dot(n) / area]
        });
        assert!(seen > 1000, "{seen}");
        let means = film.curvature.iter().map(|c| c[0]);
        assert!(means.clone().any(|mean| mean > 0.1) && means.clone().any(|mean| mean < -0.1), "both ways");
    }

    /// An eighth of a ball as a rational net, one side of which is a point.
    #[test]
    fn the_pole_of_a_net_is_no_hole() {
        let [c, s] = [std::f64::consts::FRAC_1_SQRT_2, 1.0];
        // Rows go from the equator to the pole, columns around it.
        let arc = [(1.0, 0.0, 1.0), (s, s, c), (0.0, 1.0, 1.0)];
        let mut points = Vec::new();
        for (rho, z, w_v) in arc {
            for (x, y, w_u) in arc {
                let w = w_u * w_v;
                points.push([2.0 * rho * x * w, 2.0 * rho * y * w, 2.0 * z * w, w]);
            }
        }
        let net = TestNet { degrees: [2, 2], points, level: 1 };
        let buffers = scene_of(&[TestFace::nets(net)], &[DAffine3::IDENTITY]);
        let mut scene = buffers.scene();
        let mut nets = scene.nets.to_vec();
        nets[0].degrees |= point_side(0, 1);
        scene.nets = &nets;
        for near in [0.0, 1e-30, 1e-7, 1e-3, 0.1] {
            let uv = [1.0 - near as f32, 0.3];
            let place = Place { instance: 0, face: 0, net: 0, uv, normal: [0.2, 0.2, 1.0] };
            let [mean, gaussian] = curvature(&scene, &place);
            assert!((mean - 0.5).abs() < 1e-3 && (gaussian - 0.25).abs() < 1e-3, "{near} {mean} {gaussian}");
        }
    }
}
