//! How far two sets of hits and two pictures are apart.

use trimray::image::Film;
use trimray::render::{Hit, Ray};

/// Differences between the CPU's and the GPU's hits.
#[derive(Debug, Default)]
pub struct HitDifference {
    /// Rays compared.
    pub rays: usize,
    /// Hits compared: those of rays whose hits agree.
    pub hits: usize,
    /// Rays with another number of hits, or with hits of other faces or instances.
    pub different: usize,
    /// Hits that agree but stand too far apart, or whose normals do.
    pub far: usize,
    /// Greatest difference of t over the scene's size, and of normals.
    pub worst_t: f64,
    /// See `worst_t`.
    pub worst_normal: f64,
    /// The first few rays that differ.
    pub examples: Vec<String>,
}

impl HitDifference {
    /// Rays of a thousand that agree in everything.
    pub fn agreement(&self) -> f64 {
        1.0 - (self.different + self.far) as f64 / self.rays.max(1) as f64
    }
}

/// Compares hit by hit. `size` is the scene's radius; `first_only`: `gpu` has the first hit of each ray, and `cpu` all.
///
/// Bounds, from f32's ε = 2⁻²³. The kernels place a hit within some tens of roundings of the face's size, which is at most the scene's;
/// along the ray that grows with 1/cos of the angle of incidence, so `|Δt| <= 256 ε size / max(cos, 1/64)`. A normal turns with the
/// place by curvature, for faces down to a thousandth of the scene, and by roundings of its own: `|Δn| <= 2⁻⁹ / max(cos, 1/64)`.
/// Hits nearer to each other than the first bound have no order: faces of parts that touch coincide.
pub fn compare_hits(
    rays: &[Ray],
    cpu: &[Vec<Hit>],
    gpu: &[Vec<Hit>],
    size: f64,
    first_only: bool,
) -> HitDifference {
    let mut result = HitDifference { rays: rays.len(), ..HitDifference::default() };
    for ((ray, cpu), gpu) in rays.iter().zip(cpu).zip(gpu) {
        let expected = if first_only { usize::from(!cpu.is_empty()) } else { cpu.len() };
        let pairs = if gpu.len() == expected { pair(cpu, gpu) } else { None };
        let Some(pairs) = pairs else {
            result.different += 1;
            if result.examples.len() < 4 {
                let show = |hits: &[Hit]| -> Vec<_> {
                    hits.iter().map(|hit| (hit.face, hit.instance, hit.t)).collect()
                };
                result.examples.push(format!("{ray:?}: CPU {:?}, GPU {:?}", show(cpu), show(gpu)));
            }
            continue;
        };
        let mut far = false;
        for (a, b) in pairs {
            // Of a first hit, the face may be another that is as near.
            let t = (a.t - b.t).abs().max(if first_only { b.t - cpu[0].t } else { 0.0 }) / size;
            let cosine = a.normal.dot(ray.direction).abs().max(1.0 / 64.0);
            let (t, normal) = (t * cosine, a.normal.distance(b.normal) * cosine);
            result.worst_t = result.worst_t.max(t);
            result.worst_normal = result.worst_normal.max(normal);
            far |= t.is_nan() || t > 256.0 * f64::from(f32::EPSILON) || normal > 1.0 / 512.0;
            result.hits += 1;
        }
        result.far += usize::from(far);
    }
    result
}

/// For each of the GPU's hits the nearest of the CPU's on the same face that is not taken; `None` where there is none left.
fn pair<'a>(cpu: &'a [Hit], gpu: &'a [Hit]) -> Option<Vec<(&'a Hit, &'a Hit)>> {
    let mut taken = vec![false; cpu.len()];
    let mut pairs = Vec::with_capacity(gpu.len());
    for hit in gpu {
        let same = |i: &usize| !taken[*i] && (cpu[*i].face, cpu[*i].instance) == (hit.face, hit.instance);
        let apart = |i: usize| (cpu[i].t - hit.t).abs();
        let nearest = (0..cpu.len()).filter(same).min_by(|&a, &b| apart(a).total_cmp(&apart(b)))?;
        taken[nearest] = true;
        pairs.push((&cpu[nearest], hit));
    }
    Some(pairs)
}

/// Differences between two pictures.
#[derive(Debug, Default)]
pub struct PictureDifference {
    /// Pixels compared.
    pub pixels: usize,
    /// Pixels that show anything.
    pub covered: usize,
    /// Pixels whose colour differs by more than two of 255 steps in any channel.
    pub color: usize,
    /// Pixels whose face, instance, depth or normal differ.
    pub center: usize,
}

/// Compares pixel by pixel. `size` is the scene's radius.
pub fn compare_pictures(a: &Film, b: &Film, size: f64) -> PictureDifference {
    assert_eq!((a.width, a.height), (b.width, b.height));
    let mut result = PictureDifference { pixels: a.color.len(), ..PictureDifference::default() };
    for i in 0..a.color.len() {
        result.covered += usize::from(a.color[i][3] > 0.0);
        let apart = (0..4).map(|k| (a.color[i][k] - b.color[i][k]).abs()).fold(0.0, f32::max);
        result.color += usize::from(apart.is_nan() || apart > 2.0 / 255.0);
        let depth = a.depth[i] == b.depth[i] || f64::from((a.depth[i] - b.depth[i]).abs()) < 1e-3 * size;
        let normal = (0..3).map(|k| (a.normal[i][k] - b.normal[i][k]).abs()).fold(0.0, f32::max) < 1e-2;
        let same = a.face[i] == b.face[i] && a.part[i] == b.part[i] && depth && normal;
        result.center += usize::from(!same);
    }
    result
}
