//! Eight numbers at a time, in the processor's vectors.
//!
//! The compiler finds vectors in plain loops now and then, and loses them with the next change; `wide` says which there are, and is as many of them as the
//! processor has that the program is built for. Every lane rounds as a number of its own does.

use std::ops::{Add, AddAssign, Mul, Sub};
use wide::{f32x8, f64x8, i16x8, i32x8, u8x16};

/// Eight numbers.
pub trait Octet<T>: Copy + Add<Output = Self> + AddAssign + Sub<Output = Self> + Mul<Output = Self> {
    /// Four, then another four.
    fn of(first: [T; 4], last: [T; 4]) -> Self;
    /// The same eight times.
    fn all(number: T) -> Self;
    /// Of bytes.
    fn of_bytes(bytes: &[u8; 8]) -> Self;
    /// The first four and the last.
    fn halves(self) -> [[T; 4]; 2];
    /// The greater of each pair of numbers.
    fn greater(self, other: Self) -> Self;
    /// The lesser of each pair of numbers.
    fn lesser(self, other: Self) -> Self;
    /// A bit for each pair whose first number is not above the other.
    fn at_most(self, other: Self) -> u32;
}

macro_rules! impl_octet {
    ($octet:ident, $t:ident, $of_bytes:expr) => {
        impl Octet<$t> for $octet {
            #[inline(always)]
            fn of([a, b, c, d]: [$t; 4], [e, f, g, h]: [$t; 4]) -> Self {
                Self::new([a, b, c, d, e, f, g, h])
            }
            #[inline(always)]
            fn all(number: $t) -> Self {
                Self::splat(number)
            }
            #[inline(always)]
            fn of_bytes(bytes: &[u8; 8]) -> Self {
                $of_bytes(bytes)
            }
            #[inline(always)]
            fn halves(self) -> [[$t; 4]; 2] {
                let [a, b, c, d, e, f, g, h] = self.to_array();
                [[a, b, c, d], [e, f, g, h]]
            }
            #[inline(always)]
            fn greater(self, other: Self) -> Self {
                self.fast_max(other)
            }
            #[inline(always)]
            fn lesser(self, other: Self) -> Self {
                self.fast_min(other)
            }
            #[inline(always)]
            fn at_most(self, other: Self) -> u32 {
                self.simd_le(other).to_bitmask()
            }
        }
    };
}

impl_octet!(f32x8, f32, |bytes: &[u8; 8]| {
    let low = u8x16::from(u128::from(u64::from_le_bytes(*bytes)).to_le_bytes());
    Self::from_i32x8(i32x8::from_i16x8(i16x8::from_u8x16_low(low)))
});
impl_octet!(f64x8, f64, |bytes: &[u8; 8]| Self::new(bytes.map(f64::from)));

#[cfg(test)]
mod tests {
    use super::*;

    fn hold_what_they_are_made_of<T: From<u8> + PartialEq + std::fmt::Debug + Copy, O: Octet<T>>() {
        let bytes = [0, 1, 127, 128, 200, 254, 255, 7];
        let [first, last] = O::of_bytes(&bytes).halves();
        for (place, &byte) in bytes.iter().enumerate() {
            assert_eq!([first, last][place / 4][place % 4], T::from(byte));
        }
        let (a, b) = (O::of_bytes(&bytes), O::of_bytes(&[1, 1, 1, 128, 255, 0, 255, 8]));
        assert_eq!(a.at_most(b), 0b1101_1011);
        assert_eq!(a.greater(b).halves(), O::of_bytes(&[1, 1, 127, 128, 255, 254, 255, 8]).halves());
        assert_eq!(a.lesser(b).halves(), O::of_bytes(&[0, 1, 1, 128, 200, 0, 255, 7]).halves());
        let sum = (O::of(first, last) * O::all(T::from(2)) - a + b).halves();
        assert_eq!(sum[0][1..3], [T::from(2), T::from(128)]);
    }

    #[test]
    fn octets_hold_what_they_are_made_of() {
        hold_what_they_are_made_of::<f32, f32x8>();
        hold_what_they_are_made_of::<f64, f64x8>();
    }
}
