//! One number or several at once: what the kernels compute with where no lane goes a way of its own.
//!
//! A text over [`Number`] is one of a single ray ([`Real`](super::Real)) and of eight side by side ([`Eight`](super::Eight)). It branches on what is the same
//! for all lanes, and [chooses](Number::choose) where lanes differ. Every lane rounds as a single number does, so that the same text finds the same bits.

use std::fmt::Debug;
use std::ops::{Add, AddAssign, BitAnd, BitOr, Div, Mul, MulAssign, Neg, Not, Sub};

/// What holds in which lanes.
pub trait Mask:
    Copy + Debug + Default + PartialEq + BitAnd<Output = Self> + BitOr<Output = Self> + Not<Output = Self>
{
    /// Holds in every lane, or in none.
    fn everywhere(holds: bool) -> Self;
    /// Whether it holds in some lane.
    fn any(self) -> bool;
}

impl Mask for bool {
    #[inline(always)]
    fn everywhere(holds: bool) -> Self {
        holds
    }
    #[inline(always)]
    fn any(self) -> bool {
        self
    }
}

/// Whole numbers.
pub trait Whole: Copy + Debug {
    /// 0.
    const ZERO: Self;
    /// `self − other`, wrapping.
    fn minus(self, other: i32) -> Self;
}

impl Whole for i32 {
    const ZERO: Self = 0;

    #[inline(always)]
    fn minus(self, other: i32) -> Self {
        self.wrapping_sub(other)
    }
}

/// A floating-point number, or several.
pub trait Number:
    Copy
    + PartialEq
    + Default
    + Debug
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
    + AddAssign
    + MulAssign
{
    /// Truth by lane.
    type Mask: Mask;
    /// A whole number by lane.
    type Whole: Whole;

    /// 0.
    const ZERO: Self;
    /// 1.
    const ONE: Self;
    /// Positive infinity.
    const INFINITY: Self;
    /// The distance from 1 to the next number.
    const EPSILON: Self;

    /// The nearest number, in all lanes.
    fn from_f64(value: f64) -> Self;
    /// Exact, in all lanes.
    fn from_f32(value: f32) -> Self;
    /// The nearest number.
    fn from_whole(value: Self::Whole) -> Self;
    /// `|self|`.
    fn abs(self) -> Self;
    /// The square root.
    fn sqrt(self) -> Self;
    /// The angle of the point `(x, self)`, in (−π, π].
    fn atan2(self, x: Self) -> Self;
    /// The lesser; `other` where one is not a number.
    fn min(self, other: Self) -> Self;
    /// The greater; `other` where one is not a number.
    fn max(self, other: Self) -> Self;
    /// `self · a + b`, rounded once.
    fn mul_add(self, a: Self, b: Self) -> Self;
    /// The greatest integer not above.
    fn floor(self) -> Self;
    /// ±1 with the sign of `self`, signed zeros included.
    fn signum(self) -> Self;
    /// Neither infinite nor "not a number".
    fn is_finite(self) -> Self::Mask;
    /// `self < other`.
    fn is_less(self, other: Self) -> Self::Mask;
    /// `self <= other`.
    fn is_at_most(self, other: Self) -> Self::Mask;
    /// `yes` where the mask holds, `no` elsewhere.
    fn choose(mask: Self::Mask, yes: Self, no: Self) -> Self;
}
