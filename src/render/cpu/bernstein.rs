//! Bernstein basis functions in arrays of fixed size, as a shader needs them, and the nets that they weigh.

use super::Kernel;
use super::vector::Vector3;
use crate::numeric::Real;
use crate::scene::{Net, Scene};

/// One more than the highest degree of a net.
pub const MAX_ORDER: usize = 26;

/// The basis functions of `degree` at `t` and their derivatives, by the triangular recurrence `Bᵢⁿ = (1 − t) Bᵢⁿ⁻¹ + t Bᵢ₋₁ⁿ⁻¹`, stable also for high
/// degrees. `ORDER`, above the degree, is the room: small arrays stay in registers.
#[inline(always)]
pub fn basis_and_slopes<T: Real, const ORDER: usize>(degree: usize, t: T) -> ([T; ORDER], [T; ORDER]) {
    let mut basis = [T::ZERO; ORDER];
    let mut slopes = [T::ZERO; ORDER];
    let s = T::ONE - t;
    basis[0] = T::ONE;
    for n in 1..degree {
        let mut left = T::ZERO;
        for i in 0..n {
            let value = basis[i];
            basis[i] = left + s * value;
            left = t * value;
        }
        basis[n] = left;
    }
    // The last step also gives the derivatives: n (Bᵢ₋₁ⁿ⁻¹ − Bᵢⁿ⁻¹).
    let factor = T::from_f32(degree as f32);
    let mut before = T::ZERO;
    for i in 0..=degree {
        let value = if i < degree { basis[i] } else { T::ZERO };
        slopes[i] = factor * (before - value);
        basis[i] = t * before + s * value;
        before = value;
    }
    (basis, slopes)
}

/// Homogeneous value of a net at a point, and its derivatives by u and v.
#[derive(Debug, Clone, Copy)]
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

/// The net at (u, v), relative to `about`: a point nearby, so that sums do not carry the roundings of a far origin.
pub fn net_jet<T: Kernel>(scene: &Scene<'_>, net: &Net, about: Vector3<T>, uv: [T; 2]) -> NetJet<T> {
    let degrees = net_degrees(net);
    // Degrees that are known when this is compiled leave no loop: nearly all nets have these.
    match degrees {
        (3, 3) => net_jet_within::<T, 4>(scene, net, (3, 3), about, uv),
        (2, 2) => net_jet_within::<T, 4>(scene, net, (2, 2), about, uv),
        (1, 2) => net_jet_within::<T, 4>(scene, net, (1, 2), about, uv),
        (2, 1) => net_jet_within::<T, 4>(scene, net, (2, 1), about, uv),
        (1, 3) => net_jet_within::<T, 4>(scene, net, (1, 3), about, uv),
        (3, 1) => net_jet_within::<T, 4>(scene, net, (3, 1), about, uv),
        (2, 3) => net_jet_within::<T, 4>(scene, net, (2, 3), about, uv),
        (3, 2) => net_jet_within::<T, 4>(scene, net, (3, 2), about, uv),
        (0..=3, 0..=3) => net_jet_within::<T, 4>(scene, net, degrees, about, uv),
        (0..=11, 0..=11) => net_jet_within::<T, 12>(scene, net, degrees, about, uv),
        _ => net_jet_within::<T, MAX_ORDER>(scene, net, degrees, about, uv),
    }
}

/// [`net_jet`] of a net with these degrees, below `ORDER`.
#[inline(always)]
fn net_jet_within<T: Kernel, const ORDER: usize>(
    scene: &Scene<'_>,
    net: &Net,
    (degree_u, degree_v): (usize, usize),
    about: Vector3<T>,
    uv: [T; 2],
) -> NetJet<T> {
    let (basis_u, slope_u) = basis_and_slopes::<T, ORDER>(degree_u, uv[0]);
    let (basis_v, slope_v) = basis_and_slopes::<T, ORDER>(degree_v, uv[1]);
    let shift = [about.x, about.y, about.z, T::ZERO];
    let zero = [T::ZERO; 4];
    let mut jet = NetJet { value: zero, by_u: zero, by_v: zero };
    let mut index = net.first_point as usize;
    for i in 0..=degree_u {
        let (mut row, mut row_v) = (zero, zero);
        for j in 0..=degree_v {
            let p = T::net_point(scene, index);
            index += 1;
            for k in 0..4 {
                let moved = p[k] - shift[k] * p[3];
                row[k] += moved * basis_v[j];
                row_v[k] += moved * slope_v[j];
            }
        }
        for k in 0..4 {
            jet.value[k] += row[k] * basis_u[i];
            jet.by_u[k] += row[k] * slope_u[i];
            jet.by_v[k] += row_v[k] * basis_u[i];
        }
    }
    jet
}
