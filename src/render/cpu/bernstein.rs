//! Bernstein basis functions in arrays of fixed size, as a shader needs them, and the nets that they weigh.

use super::Kernel;
use super::lanes::Octet;
use super::vector::Vector3;
use crate::numeric::{Eight, Number};
use crate::scene::{Net, Scene};

/// One more than the highest degree of a net.
pub const MAX_ORDER: usize = 26;

/// binomial(n, i), of at most 23 bits.
static BINOMIALS: [[f32; MAX_ORDER]; MAX_ORDER] = binomials();

const fn binomials() -> [[f32; MAX_ORDER]; MAX_ORDER] {
    let mut rows = [[0.0; MAX_ORDER]; MAX_ORDER];
    let mut n = 0;
    while n < MAX_ORDER {
        rows[n][0] = 1.0;
        let mut i = 1;
        while i <= n {
            rows[n][i] = rows[n - 1][i - 1] + rows[n - 1][i];
            i += 1;
        }
        n += 1;
    }
    rows
}

/// The basis functions of `degree`, at least 1, at `t` and their derivatives, from those of the degree below, `binomial(m, i) tⁱ (1 − t)ᵐ⁻ⁱ`, each a product of
/// m + 1 roundings. `ORDER`, above the degree, is the room: small arrays stay in registers.
#[inline(always)]
pub fn basis_and_slopes<T: Number, const ORDER: usize>(degree: usize, t: T) -> ([T; ORDER], [T; ORDER]) {
    let mut basis = [T::ZERO; ORDER];
    let mut slopes = [T::ZERO; ORDER];
    let s = T::ONE - t;
    let mut power = T::ONE;
    for (value, &binomial) in basis[..degree].iter_mut().zip(&BINOMIALS[degree - 1]) {
        *value = T::from_f32(binomial) * power;
        power *= t;
    }
    let mut power = T::ONE;
    for value in basis[..degree].iter_mut().rev() {
        *value *= power;
        power *= s;
    }
    // A step of the recurrence, (1 − t) Bᵢⁿ⁻¹ + t Bᵢ₋₁ⁿ⁻¹, and the derivatives, n (Bᵢ₋₁ⁿ⁻¹ − Bᵢⁿ⁻¹).
    let factor = T::from_f32(degree as f32);
    let mut before = T::ZERO;
    for (value, slope) in basis[..=degree].iter_mut().zip(&mut slopes) {
        *slope = factor * (before - *value);
        (*value, before) = (t * before + s * *value, *value);
    }
    (basis, slopes)
}

/// Homogeneous value of a net at a point, and its derivatives by u and v.
#[derive(Debug, Clone, Copy, Default)]
pub struct NetJet<T> {
    /// (x − about.x · w, …, w).
    pub value: [T; 4],
    /// By local u.
    pub by_u: [T; 4],
    /// By local v.
    pub by_v: [T; 4],
}

/// Degrees along u and v.
#[inline(always)]
pub fn net_degrees(net: &Net) -> (usize, usize) {
    ((net.degrees & 0xff) as usize, (net.degrees >> 8 & 0xff) as usize)
}

/// Numbers in which nets are evaluated.
pub trait NetNumber: Number {
    /// The net at (u, v), relative to `about`: a point nearby, so that sums do not carry the roundings of a far origin.
    fn net_jet(scene: &Scene<'_>, net: &Net, about: Vector3<Self>, uv: [Self; 2]) -> NetJet<Self>;
}

impl NetNumber for f32 {
    fn net_jet(scene: &Scene<'_>, net: &Net, about: Vector3<Self>, uv: [Self; 2]) -> NetJet<Self> {
        net_jet(scene, net, about, uv)
    }
}

impl NetNumber for f64 {
    fn net_jet(scene: &Scene<'_>, net: &Net, about: Vector3<Self>, uv: [Self; 2]) -> NetJet<Self> {
        net_jet(scene, net, about, uv)
    }
}

impl NetNumber for Eight {
    fn net_jet(scene: &Scene<'_>, net: &Net, about: Vector3<Self>, uv: [Self; 2]) -> NetJet<Self> {
        let (points, degrees) = (scene.net_points, net_degrees(net));
        match degrees {
            (0..=3, 0..=3) => eight_jets_within::<4>(points, net, degrees, about, uv),
            (0..=11, 0..=11) => eight_jets_within::<12>(points, net, degrees, about, uv),
            _ => eight_jets_within::<MAX_ORDER>(points, net, degrees, about, uv),
        }
    }
}

/// [`NetNumber::net_jet`] of one place.
pub fn net_jet<T: Kernel>(scene: &Scene<'_>, net: &Net, about: Vector3<T>, uv: [T; 2]) -> NetJet<T> {
    let (points, degrees) = (T::net_points(scene), net_degrees(net));
    // Degrees that are known when this is compiled leave no loops. Nearly all nets have the first eight pairs; of the others the degrees along v here are those that
    // the most leaves of real models have.
    match degrees {
        (3, 3) => net_jet_within::<T, T, 4>(points, net, (3, 3), about, uv),
        (2, 2) => net_jet_within::<T, T, 4>(points, net, (2, 2), about, uv),
        (1, 2) => net_jet_within::<T, T, 4>(points, net, (1, 2), about, uv),
        (2, 1) => net_jet_within::<T, T, 4>(points, net, (2, 1), about, uv),
        (1, 3) => net_jet_within::<T, T, 4>(points, net, (1, 3), about, uv),
        (3, 1) => net_jet_within::<T, T, 4>(points, net, (3, 1), about, uv),
        (2, 3) => net_jet_within::<T, T, 4>(points, net, (2, 3), about, uv),
        (3, 2) => net_jet_within::<T, T, 4>(points, net, (3, 2), about, uv),
        (u @ 0..=11, 3) => net_jet_within::<T, T, 12>(points, net, (u, 3), about, uv),
        (u @ 0..=11, 5) => net_jet_within::<T, T, 12>(points, net, (u, 5), about, uv),
        (u @ 0..=11, 8) => net_jet_within::<T, T, 12>(points, net, (u, 8), about, uv),
        (u @ 0..=11, 9) => net_jet_within::<T, T, 12>(points, net, (u, 9), about, uv),
        (u @ 0..=11, 10) => net_jet_within::<T, T, 12>(points, net, (u, 10), about, uv),
        (u @ 0..=11, 11) => net_jet_within::<T, T, 12>(points, net, (u, 11), about, uv),
        (0..=11, 0..=11) => net_jet_within::<T, T, 12>(points, net, degrees, about, uv),
        _ => net_jet_within::<T, T, MAX_ORDER>(points, net, degrees, about, uv),
    }
}

/// [`net_jet`] in f64 of a scene's f32 points.
pub fn widened_net_jet(scene: &Scene<'_>, net: &Net, about: Vector3<f64>, uv: [f64; 2]) -> NetJet<f64> {
    net_jet_within::<f64, f32, MAX_ORDER>(scene.net_points, net, net_degrees(net), about, uv)
}

/// [`net_jet`] of a net with these degrees, below `ORDER`, and its points among `points`.
#[inline(always)]
fn net_jet_within<T: Kernel, P: Copy + Into<T>, const ORDER: usize>(
    points: &[[P; 4]],
    net: &Net,
    (degree_u, degree_v): (usize, usize),
    about: Vector3<T>,
    uv: [T; 2],
) -> NetJet<T> {
    let (basis_u, slope_u) = basis_and_slopes::<T, ORDER>(degree_u, uv[0]);
    let (basis_v, slope_v) = basis_and_slopes::<T, ORDER>(degree_v, uv[1]);
    let shift = [about.x, about.y, about.z, T::ZERO];
    let shift = T::Octet::of(shift, shift);
    let mut weights = [T::Octet::all(T::ZERO); ORDER];
    for (both, (&weight, &slope)) in weights[..=degree_v].iter_mut().zip(basis_v.iter().zip(&slope_v)) {
        *both = T::Octet::of([weight; 4], [slope; 4]);
    }
    // The rows' values, and beside them their derivatives by v; times the basis functions of u, and times their slopes.
    let (mut values, mut slopes) = (T::Octet::all(T::ZERO), T::Octet::all(T::ZERO));
    let mut rest = &points[net.first_point as usize..];
    for (&weight, &slope) in basis_u[..=degree_u].iter().zip(&slope_u) {
        let (points, below) = rest.split_at(degree_v + 1);
        rest = below;
        let mut row = T::Octet::all(T::ZERO);
        for (p, &both) in points.iter().zip(&weights) {
            let p = p.map(Into::into);
            row += (T::Octet::of(p, p) - shift * T::Octet::all(p[3])) * both;
        }
        values += row * T::Octet::all(weight);
        slopes += row * T::Octet::all(slope);
    }
    let ([value, by_v], [by_u, _]) = (values.halves(), slopes.halves());
    NetJet { value, by_u, by_v }
}

/// Of eight places what [`net_jet_within`] has of one, by the same sums: there the eight numbers are those of one place, here each is that of eight.
#[inline(always)]
fn eight_jets_within<const ORDER: usize>(
    points: &[[f32; 4]],
    net: &Net,
    (degree_u, degree_v): (usize, usize),
    about: Vector3<Eight>,
    uv: [Eight; 2],
) -> NetJet<Eight> {
    let (basis_u, slope_u) = basis_and_slopes::<Eight, ORDER>(degree_u, uv[0]);
    let (basis_v, slope_v) = basis_and_slopes::<Eight, ORDER>(degree_v, uv[1]);
    let mut jet = NetJet::default();
    let mut rest = &points[net.first_point as usize..];
    for (&weight, &slope) in basis_u[..=degree_u].iter().zip(&slope_u) {
        let (points, below) = rest.split_at(degree_v + 1);
        rest = below;
        let (mut row, mut row_by_v) = ([Eight::ZERO; 4], [Eight::ZERO; 4]);
        for (p, (&weight, &slope)) in points.iter().zip(basis_v.iter().zip(&slope_v)) {
            let [x, y, z, w] = p.map(Eight::from_f32);
            let p = [x - about.x * w, y - about.y * w, z - about.z * w, w];
            for k in 0..4 {
                row[k] += p[k] * weight;
                row_by_v[k] += p[k] * slope;
            }
        }
        for k in 0..4 {
            jet.value[k] += row[k] * weight;
            jet.by_v[k] += row_by_v[k] * weight;
            jet.by_u[k] += row[k] * slope;
        }
    }
    jet
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::SceneBuffers;
    use bytemuck::Zeroable;

    /// Against de Casteljau's scheme on the coefficients that are 1 for one function and 0 for the others.
    #[test]
    fn basis_functions_are_those_of_the_triangle() {
        for degree in 1..MAX_ORDER {
            for t in [0.0, 1e-3, 0.3, 0.5, 0.8, 1.0, -0.25, 1.25] {
                let (basis, slopes) = basis_and_slopes::<f64, MAX_ORDER>(degree, t);
                for i in 0..=degree {
                    let mut row: Vec<f64> = (0..=degree).map(|k| f64::from(u8::from(k == i))).collect();
                    while row.len() > 2 {
                        row = row.windows(2).map(|pair| pair[0] * (1.0 - t) + pair[1] * t).collect();
                    }
                    let value = row[0] * (1.0 - t) + row[1] * t;
                    let slope = degree as f64 * (row[1] - row[0]);
                    // Outside of [0, 1] both cancel what they sum.
                    let tolerance = if (0.0..=1.0).contains(&t) { 1e-13 } else { 1e-9 };
                    assert!((basis[i] - value).abs() < tolerance * value.abs().max(1.0), "{degree} {i} {t}");
                    assert!(
                        (slopes[i] - slope).abs() < tolerance * slope.abs().max(30.0),
                        "{degree} {i} {t}"
                    );
                }
                assert!(basis[degree + 1..].iter().chain(&slopes[degree + 1..]).all(|&x| x == 0.0));
            }
        }
    }

    /// Each pair of degrees, and so each of the loops for them, against the double sum, in units of ε times the points' size.
    fn errors_of_jets<T: Kernel>() -> [f64; 3] {
        let mut state = 1_u32;
        let mut next = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 24)
        };
        let mut worst = [0.0_f64; 3];
        for (degree_u, degree_v) in (1..MAX_ORDER).flat_map(|u| (1..MAX_ORDER).map(move |v| (u, v))) {
            let count = (degree_u + 1) * (degree_v + 1);
            let narrow: Vec<[f32; 4]> =
                (0..3 + count).map(|_| std::array::from_fn(|k| next() as f32 + k as f32)).collect();
            let wide: Vec<[f64; 4]> = narrow.iter().map(|p| p.map(f64::from)).collect();
            let buffers =
                SceneBuffers { net_points: narrow, net_points_f64: wide.clone(), ..SceneBuffers::default() };
            let degrees = (degree_u | degree_v << 8) as u32;
            let net = Net { first_point: 3, degrees, ..Net::zeroed() };
            // Numbers of both types.
            let [u, v, about] = [next(), next(), next()].map(|x| f64::from(x as f32));
            let jet = net_jet(
                &buffers.scene(),
                &net,
                Vector3::from_f64([about; 3]),
                [T::from_f64(u), T::from_f64(v)],
            );
            let (basis_u, slope_u) = basis_and_slopes::<f64, MAX_ORDER>(degree_u, u);
            let (basis_v, slope_v) = basis_and_slopes::<f64, MAX_ORDER>(degree_v, v);
            let orders = [(&basis_u, &basis_v), (&slope_u, &basis_v), (&basis_u, &slope_v)];
            for (order, (found, (by_u, by_v))) in
                [jet.value, jet.by_u, jet.by_v].into_iter().zip(orders).enumerate()
            {
                for k in 0..4 {
                    let term = |i: usize| {
                        let p = wide[3 + i];
                        let moved = p[k] - if k < 3 { about * p[3] } else { 0.0 };
                        moved * by_u[i / (degree_v + 1)] * by_v[i % (degree_v + 1)]
                    };
                    let expected: f64 = (0..count).map(term).sum();
                    let size: f64 = (0..count).map(|i| term(i).abs()).sum::<f64>().max(4.0);
                    let error = (found[k].to_f64() - expected).abs() / size / T::EPSILON.to_f64();
                    worst[order] = worst[order].max(error);
                }
            }
        }
        worst
    }

    #[test]
    fn jets_of_all_degrees_are_sums_over_the_points() {
        let [single, double] = [errors_of_jets::<f32>(), errors_of_jets::<f64>()];
        eprintln!("{} pairs of degrees: {single:?} and {double:?} roundings", (MAX_ORDER - 1).pow(2));
        // As many roundings as there are products and sums.
        assert!(single.iter().chain(&double).all(|&roundings| roundings < 60.0), "{single:?} {double:?}");
    }
}
