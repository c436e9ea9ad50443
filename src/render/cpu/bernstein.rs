//! Bernstein basis functions in arrays of fixed size, as a shader needs them.

use crate::numeric::Real;

/// One more than the highest degree of a net.
pub const MAX_ORDER: usize = 26;

/// The basis functions of `degree` at `t` and their derivatives, by the triangular recurrence `Bᵢⁿ = (1 − t) Bᵢⁿ⁻¹ + t Bᵢ₋₁ⁿ⁻¹`, stable also for high degrees. `ORDER`, above the degree, is the room: small arrays stay in registers.
#[inline]
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
