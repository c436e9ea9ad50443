//! How surfaces scatter light: a coat of microfacets (GGX, Walter et al. 2007, with Smith's height-correlated masking) over a diffuse ground, or bare metal;
//! the metallic-roughness model of glTF 2.0, appendix B.
//!
//! Facets are sampled as they are seen (Heitz 2018, by caps as Dupuy and Benyoub 2023). Light that facets pass from one to the next is left out: rough metal
//! is up to a tenth darker than it should be.

use super::vector::{Vector3, vec3};
use crate::scene::Material;
use std::f32::consts::{PI, TAU};

/// The width of the sharpest highlights: below it f32 and the few samples of a pixel would find none.
pub const LEAST_ALPHA: f32 = 2e-3;

/// Reflectance of what is no metal, seen head on: that of a refractive index of 1.5.
pub const DIELECTRIC: f32 = 0.04;

/// A place of a surface as it is seen from one side.
#[derive(Debug, Clone, Copy)]
pub struct Surface {
    /// Share of the light that the ground scatters.
    diffuse: [f32; 3],
    /// Width of the facets' slopes.
    alpha: f32,
    /// Reflectance of the facets head on.
    specular: [f32; 3],
    /// Share of the samples that are taken of the facets.
    specular_share: f32,
    axis_x: Vector3<f32>,
    axis_y: Vector3<f32>,
    normal: Vector3<f32>,
    /// Towards the viewer, along the axes.
    view: Vector3<f32>,
}

/// What a surface does with light from a direction.
#[derive(Debug, Clone, Copy)]
pub struct Scattered {
    /// Share that goes to the viewer, for light of one steradian, times the cosine.
    pub value: [f32; 3],
    /// How densely [`sample_direction`] finds the direction, per steradian.
    pub density: f32,
}

/// A surface of a material; `share` of its light is kept; `n` is turned to the viewer.
pub fn surface(material: &Material, share: f32, n: Vector3<f32>, view: Vector3<f32>) -> Surface {
    let rgb = material.rgb.map(|channel| channel * share);
    let diffuse = rgb.map(|channel| channel * (1.0 - material.metallic));
    let specular = rgb.map(|channel| DIELECTRIC * share + (channel - DIELECTRIC * share) * material.metallic);
    let [axis_x, axis_y] = axes_across(n);
    let view = vec3(view.dot(axis_x), view.dot(axis_y), view.dot(n).max(1e-4));
    let mirrored = luminance(fresnel(specular, view.z));
    let scattered = luminance(diffuse) * (1.0 - mirrored);
    let wanted = mirrored / (mirrored + scattered).max(1e-6);
    let specular_share = if scattered > 0.0 { wanted.clamp(0.2, 0.8) } else { 1.0 };
    let alpha = (material.roughness * material.roughness).max(LEAST_ALPHA);
    Surface { diffuse, alpha, specular, specular_share, axis_x, axis_y, normal: n, view }
}

/// Two unit vectors across a third (Duff et al. 2017).
fn axes_across(n: Vector3<f32>) -> [Vector3<f32>; 2] {
    let sign = if n.z < 0.0 { -1.0 } else { 1.0 };
    let a = -1.0 / (sign + n.z);
    let b = n.x * n.y * a;
    [vec3(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), vec3(b, sign + n.y * n.y * a, -n.y)]
}

/// Schlick's approximation.
fn fresnel(head_on: [f32; 3], cosine: f32) -> [f32; 3] {
    let x = (1.0 - cosine).clamp(0.0, 1.0);
    let grazing = x * x * x * x * x;
    head_on.map(|channel| channel + (1.0 - channel) * grazing)
}

/// As the eye weighs linear light (ITU-R BT.709).
pub fn luminance([red, green, blue]: [f32; 3]) -> f32 {
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

/// What is done with light from `light`, a unit vector.
pub fn scatter(surface: &Surface, light: Vector3<f32>) -> Scattered {
    let view = surface.view;
    let light = vec3(light.dot(surface.axis_x), light.dot(surface.axis_y), light.dot(surface.normal));
    if light.z <= 0.0 {
        return Scattered { value: [0.0; 3], density: 0.0 };
    }
    let sum = view + light;
    let half = sum * (1.0 / sum.length().max(1e-6));
    let along = view.dot(half).max(0.0);
    let square = surface.alpha * surface.alpha;
    // 1 − cos² as the sum of squares, which keeps its digits.
    let slope = half.x * half.x + half.y * half.y + square * half.z * half.z;
    let facets = square / (PI * slope * slope);
    let view_shade = (square + (1.0 - square) * view.z * view.z).sqrt();
    let light_shade = (square + (1.0 - square) * light.z * light.z).sqrt();
    // With the 4 cos cos of the microfacet formula divided out.
    let visible = 0.5 / (light.z * view_shade + view.z * light_shade).max(1e-7);
    let mirrored = fresnel(surface.specular, along);
    let value = std::array::from_fn(|k| {
        let ground = surface.diffuse[k] * (1.0 - mirrored[k]) / PI;
        (ground + mirrored[k] * facets * visible) * light.z
    });
    let of_facets = facets * 0.5 / (view.z + view_shade);
    let of_ground = light.z / PI;
    Scattered { value, density: of_ground + (of_facets - of_ground) * surface.specular_share }
}

/// A direction to go on in, by a point of the unit square and a number in 0..1.
pub fn sample_direction(surface: &Surface, [a, b]: [f32; 2], choice: f32) -> Vector3<f32> {
    let (sin, cos) = (TAU * a).sin_cos();
    let view = surface.view;
    let local = if choice < surface.specular_share {
        let stretched = vec3(view.x * surface.alpha, view.y * surface.alpha, view.z);
        let stretched = stretched * (1.0 / stretched.length());
        let z = (1.0 - b) * (1.0 + stretched.z) - stretched.z;
        let across = (1.0 - z * z).max(0.0).sqrt();
        let cap = vec3(across * cos, across * sin, z) + stretched;
        let half = vec3(cap.x * surface.alpha, cap.y * surface.alpha, cap.z.max(1e-6));
        let half = half * (1.0 / half.length());
        half * (2.0 * view.dot(half)) - view
    } else {
        let across = b.sqrt();
        vec3(across * cos, across * sin, (1.0 - b).max(0.0).sqrt())
    };
    surface.axis_x * local.x + surface.axis_y * local.y + surface.normal * local.z
}

#[cfg(test)]
mod tests {
    use super::super::sobol::sample_pair;
    use super::*;

    fn materials() -> impl Iterator<Item = Material> {
        [0.0, 0.3, 0.7, 1.0].into_iter().flat_map(|roughness| {
            [0.0, 0.5, 1.0].map(|metallic| Material {
                roughness,
                metallic,
                ..Material::of_color([0.9, 0.9, 0.9])
            })
        })
    }

    /// Under white light from everywhere no more comes back than went in, and by either way of sampling the same comes back.
    #[test]
    fn light_is_kept_and_the_density_is_that_of_the_samples() {
        let n = vec3(0.6, 0.0, -0.8);
        for material in materials() {
            for view in [vec3(0.6, 0.0, -0.8), vec3(0.96, 0.0, -0.28), vec3(0.9, 0.35, -0.26)] {
                let surface = surface(&material, 1.0, n, view * (1.0 / view.length()));
                let (mut by_bsdf, mut by_cosine, mut inside) = (0.0_f64, 0.0_f64, 0.0_f64);
                let count = 1 << 14;
                for sample in 0..count {
                    let [choice, _] = sample_pair(1, sample, 1, 0);
                    let direction = sample_direction(&surface, sample_pair(1, sample, 0, 0), choice);
                    assert!((direction.length() - 1.0).abs() < 1e-4);
                    let scattered = scatter(&surface, direction);
                    if scattered.density > 0.0 {
                        by_bsdf += f64::from(scattered.value[1] / scattered.density);
                    }
                    let mirror = Surface { specular_share: 0.0, ..surface };
                    let direction = sample_direction(&mirror, sample_pair(1, sample, 2, 0), 1.0);
                    let cosine = direction.dot(n).max(1e-6);
                    let scattered = scatter(&surface, direction);
                    by_cosine += f64::from(scattered.value[1] / cosine * PI);
                    inside += f64::from(scattered.density / cosine * PI);
                }
                let [by_bsdf, by_cosine, inside] =
                    [by_bsdf, by_cosine, inside].map(|sum| sum / f64::from(count));
                assert!(by_bsdf <= 1.01, "{material:?} {view:?}: {by_bsdf}");
                if material.roughness > 0.2 {
                    assert!(
                        (by_bsdf - by_cosine).abs() < 0.02,
                        "{material:?} {view:?}: {by_bsdf} {by_cosine}"
                    );
                    assert!(inside < 1.03, "{material:?} {view:?}: {inside}");
                }
            }
        }
    }
}
