//! The scalar of the tracers: one text of each kernel, compiled for f32 and for f64.

use super::number::Number;
use std::fmt::Display;
use std::ops::{DivAssign, SubAssign};

/// A floating-point number, f32 or f64.
pub trait Real: Number<Mask = bool, Whole = i32> + PartialOrd + Display + SubAssign + DivAssign {
    /// Exact.
    fn to_f64(self) -> f64;
    /// The integer part, held to the range of the type.
    fn to_u32(self) -> u32;
    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self);
    /// The cube root.
    fn cbrt(self) -> Self;
}

macro_rules! impl_real {
    ($t:ident) => {
        impl Number for $t {
            type Mask = bool;
            type Whole = i32;

            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const INFINITY: Self = $t::INFINITY;
            const EPSILON: Self = $t::EPSILON;

            #[inline(always)]
            fn from_f64(value: f64) -> Self {
                value as $t
            }
            #[inline(always)]
            fn from_f32(value: f32) -> Self {
                value as $t
            }
            #[inline(always)]
            fn from_whole(value: i32) -> Self {
                value as $t
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $t::abs(self)
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $t::sqrt(self)
            }
            #[inline(always)]
            fn atan2(self, x: Self) -> Self {
                $t::atan2(self, x)
            }
            #[inline(always)]
            fn min(self, other: Self) -> Self {
                if self < other { self } else { other }
            }
            #[inline(always)]
            fn max(self, other: Self) -> Self {
                if self > other { self } else { other }
            }
            #[inline(always)]
            fn mul_add(self, a: Self, b: Self) -> Self {
                $t::mul_add(self, a, b)
            }
            #[inline(always)]
            fn floor(self) -> Self {
                $t::floor(self)
            }
            #[inline(always)]
            fn signum(self) -> Self {
                $t::signum(self)
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                $t::is_finite(self)
            }
            #[inline(always)]
            fn is_less(self, other: Self) -> bool {
                self < other
            }
            #[inline(always)]
            fn is_at_most(self, other: Self) -> bool {
                self <= other
            }
            #[inline(always)]
            fn choose(mask: bool, yes: Self, no: Self) -> Self {
                if mask { yes } else { no }
            }
        }

        impl Real for $t {
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self as f64
            }
            #[inline(always)]
            fn to_u32(self) -> u32 {
                self as u32
            }
            #[inline(always)]
            fn sin_cos(self) -> (Self, Self) {
                $t::sin_cos(self)
            }
            #[inline(always)]
            fn cbrt(self) -> Self {
                $t::cbrt(self)
            }
        }
    };
}
impl_real!(f32);
impl_real!(f64);

#[cfg(test)]
mod tests {
    use super::Number;

    #[test]
    fn the_other_is_taken_where_one_is_no_number() {
        assert_eq!([Number::min(1.0, 2.0), Number::min(2.0, 1.0), Number::min(f64::NAN, 1.0)], [1.0; 3]);
        assert_eq!([Number::max(1.0, 2.0), Number::max(2.0, 1.0), Number::max(f32::NAN, 2.0)], [2.0; 3]);
        assert!(Number::min(1.0, f32::NAN).is_nan() && Number::max(1.0, f32::NAN).is_nan());
    }
}
