//! Eight f32 side by side, in the processor's vectors.

use super::number::{Mask, Number, Whole};
use std::ops::{BitAnd, BitOr, Not};
use wide::{f32x8, i32x8};

/// Eight numbers.
pub type Eight = f32x8;

/// What holds in which of eight lanes: all bits of a lane, or none.
#[derive(Debug, Clone, Copy, Default)]
pub struct Mask8(f32x8);

impl Mask8 {
    /// A bit by lane, the first the lowest.
    #[inline(always)]
    pub fn bits(self) -> u32 {
        self.0.to_bitmask()
    }

    /// Where a bit is set, of the lowest eight.
    #[inline(always)]
    pub fn of_bits(bits: u32) -> Self {
        let of_lane = i32x8::new([1, 2, 4, 8, 16, 32, 64, 128]);
        let mask = (i32x8::splat(bits as i32) & of_lane).simd_eq(of_lane);
        Self(bytemuck::cast(mask))
    }
}

impl PartialEq for Mask8 {
    fn eq(&self, other: &Self) -> bool {
        self.bits() == other.bits()
    }
}

impl BitAnd for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn bitand(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl BitOr for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Not for Mask8 {
    type Output = Self;
    #[inline(always)]
    fn not(self) -> Self {
        Self(!self.0)
    }
}

impl Mask for Mask8 {
    #[inline(always)]
    fn everywhere(holds: bool) -> Self {
        Self(f32x8::splat(f32::from_bits(if holds { u32::MAX } else { 0 })))
    }
    #[inline(always)]
    fn any(self) -> bool {
        self.0.any()
    }
}

impl Whole for i32x8 {
    const ZERO: Self = i32x8::new([0; 8]);

    #[inline(always)]
    fn minus(self, other: i32) -> Self {
        self - Self::splat(other)
    }
}

/// Lane by lane, where the processor has no vector of it that rounds as its single numbers do.
#[inline(always)]
fn each(a: f32x8, b: f32x8, f: impl Fn(f32, f32) -> f32) -> f32x8 {
    let (a, b) = (a.to_array(), b.to_array());
    f32x8::new(std::array::from_fn(|lane| f(a[lane], b[lane])))
}

impl Number for f32x8 {
    type Mask = Mask8;
    type Whole = i32x8;

    const ZERO: Self = f32x8::new([0.0; 8]);
    const ONE: Self = f32x8::new([1.0; 8]);
    const INFINITY: Self = f32x8::new([f32::INFINITY; 8]);
    const EPSILON: Self = f32x8::new([f32::EPSILON; 8]);

    #[inline(always)]
    fn from_f64(value: f64) -> Self {
        f32x8::splat(value as f32)
    }
    #[inline(always)]
    fn from_f32(value: f32) -> Self {
        f32x8::splat(value)
    }
    #[inline(always)]
    fn from_whole(value: i32x8) -> Self {
        f32x8::from_i32x8(value)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        f32x8::abs(self)
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f32x8::sqrt(self)
    }
    #[inline(always)]
    fn atan2(self, x: Self) -> Self {
        each(self, x, f32::atan2)
    }
    // The processors' own minimum has this rule only on x86.
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if cfg!(target_arch = "x86_64") {
            self.fast_min(other)
        } else {
            Self::choose(self.is_less(other), self, other)
        }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if cfg!(target_arch = "x86_64") {
            self.fast_max(other)
        } else {
            Self::choose(other.is_less(self), self, other)
        }
    }
    #[inline(always)]
    fn mul_add(self, a: Self, b: Self) -> Self {
        if cfg!(target_feature = "fma") {
            return f32x8::mul_add(self, a, b);
        }
        let (a, b) = (a.to_array(), b.to_array());
        let x = self.to_array();
        f32x8::new(std::array::from_fn(|lane| x[lane].mul_add(a[lane], b[lane])))
    }
    #[inline(always)]
    fn floor(self) -> Self {
        f32x8::floor(self)
    }
    #[inline(always)]
    fn signum(self) -> Self {
        let sign = Self::ONE | (self & f32x8::splat(-0.0));
        Self::choose(self.is_at_most(self), sign, self)
    }
    #[inline(always)]
    fn is_finite(self) -> Mask8 {
        f32x8::abs(self).is_less(Self::INFINITY)
    }
    #[inline(always)]
    fn is_less(self, other: Self) -> Mask8 {
        Mask8(self.simd_lt(other))
    }
    #[inline(always)]
    fn is_at_most(self, other: Self) -> Mask8 {
        Mask8(self.simd_le(other))
    }
    #[inline(always)]
    fn choose(mask: Mask8, yes: Self, no: Self) -> Self {
        mask.0.bitselect(yes, no)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ODD: [f32; 8] = [0.0, -0.0, 1.5, -2.25, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 1e-40];

    /// Every operation, lane by lane, on all pairs of numbers that are unlike others.
    #[test]
    fn lanes_are_single_numbers_to_the_bit() {
        for turn in 0..8 {
            let other: [f32; 8] = std::array::from_fn(|lane| ODD[(lane + turn) % 8]);
            let (a, b) = (Eight::new(ODD), Eight::new(other));
            let same = |eight: Eight, single: &dyn Fn(f32, f32) -> f32| {
                for (lane, found) in eight.to_array().into_iter().enumerate() {
                    let expected = single(ODD[lane], other[lane]);
                    let is_nan = found.is_nan() && expected.is_nan();
                    assert!(
                        is_nan || found.to_bits() == expected.to_bits(),
                        "{lane} {turn} {found} {expected}"
                    );
                }
            };
            same(a + b, &|a, b| a + b);
            same(a * b, &|a, b| a * b);
            same(a / b, &|a, b| a / b);
            same(-a, &|a, _| -a);
            same(Number::min(a, b), &|a, b| Number::min(a, b));
            same(Number::max(a, b), &|a, b| Number::max(a, b));
            same(Number::sqrt(a), &|a, _| a.sqrt());
            same(Number::abs(a), &|a, _| a.abs());
            same(Number::floor(a), &|a, _| a.floor());
            same(Number::signum(a), &|a, _| a.signum());
            same(Number::atan2(a, b), &f32::atan2);
            same(Number::mul_add(a, b, a), &|a, b| a.mul_add(b, a));
            let holds = |mask: Mask8, single: &dyn Fn(f32, f32) -> bool| {
                let bits = (0..8).filter(|&k| single(ODD[k], other[k])).fold(0, |bits, k| bits | 1 << k);
                assert_eq!(mask.bits(), bits, "{turn}");
                assert_eq!((Mask8::of_bits(bits), mask.any()), (mask, bits != 0));
            };
            holds(a.is_less(b), &|a, b| a < b);
            holds(a.is_at_most(b), &|a, b| a <= b);
            holds(!a.is_less(b), &|a, b| !(a < b));
            holds(Number::is_finite(a), &|a, _| a.is_finite());
            same(Eight::choose(a.is_less(b), a, b), &|a, b| if a < b { a } else { b });
        }
    }
}
