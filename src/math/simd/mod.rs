//! One function compiled for several instruction sets, chosen at run time.
//!
//! Bodies are plain loops over fixed arrays that the compiler turns into SIMD, or are generic over
//! [`Wide`] where it does that badly. No fused operations are used, so every variant gives the same bits.

use std::ops::{Add, Div, Mul, Sub};

/// Lanes of a [`Wide`].
pub const WIDTH: usize = 8;

/// The widest instructions of this machine that the program uses.
pub fn level() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    {
        if HasAvx512::detect().is_some() {
            return "AVX-512";
        }
        if HasAvx2::detect().is_some() {
            return "AVX2";
        }
    }
    "portable"
}

/// `N` floats. `min` and `max` give the second operand when one is NaN, as the instructions do.
pub trait Wide<const N: usize = WIDTH>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// Proof that this machine has the instructions: without one there is no value of this type, and no function of
    /// it can be called.
    type Isa: Copy;
    /// A truth value for each lane.
    type Mask: Copy;
    /// A number 0..4 for each lane.
    type Index: Copy;
    /// What made this value proves it again.
    fn isa(self) -> Self::Isa;
    /// Numbers 0..4 for [`Wide::pick`], from lanes that hold them as bits.
    fn as_index(self) -> Self::Index;
    /// Lane l is `x[index[l]]`.
    fn pick(x: &[f32; 4], index: Self::Index) -> Self;
    /// `x` in every lane.
    fn splat(isa: Self::Isa, x: f32) -> Self;
    /// Lane l is `x[l]`.
    fn load(isa: Self::Isa, x: &[f32; N]) -> Self;
    /// All lanes.
    fn array(self) -> [f32; N];
    /// The smaller of each two lanes.
    fn min(self, other: Self) -> Self;
    /// The larger of each two lanes.
    fn max(self, other: Self) -> Self;
    /// `self < other`, lane by lane.
    fn less(self, other: Self) -> Self::Mask;
    /// `self <= other`, lane by lane.
    fn less_or_equal(self, other: Self) -> Self::Mask;
    /// `self == other`, lane by lane.
    fn equal(self, other: Self) -> Self::Mask;
    /// `a & b`.
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// `a | b`.
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// `!a & b`.
    fn and_not(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Lane l is bit l.
    fn bits(mask: Self::Mask) -> u32;
    /// Lanes of `self` where the mask holds, else of `other`; moves bits, whatever they mean.
    fn select(self, mask: Self::Mask, other: Self) -> Self;
}

/// [`Wide`] for any processor.
#[derive(Clone, Copy, Debug)]
pub struct Portable([f32; WIDTH]);

macro_rules! operator {
    ($type:ident: $($trait:ident $name:ident |$a:ident, $b:ident| $body:expr;)+) => {
        $(impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                let ($a, $b) = (self.0, other.0);
                Self($body)
            }
        })+
    };
}

#[inline(always)]
fn each<A: Copy, B>(a: [A; WIDTH], b: [A; WIDTH], f: impl Fn(A, A) -> B) -> [B; WIDTH] {
    std::array::from_fn(|l| f(a[l], b[l]))
}

operator! { Portable:
    Add add |a, b| each(a, b, |x, y| x + y);
    Sub sub |a, b| each(a, b, |x, y| x - y);
    Mul mul |a, b| each(a, b, |x, y| x * y);
    Div div |a, b| each(a, b, |x, y| x / y);
}

impl Wide for Portable {
    type Isa = ();
    type Mask = [bool; WIDTH];
    type Index = [u32; WIDTH];
    fn isa(self) {}
    fn as_index(self) -> Self::Index {
        self.0.map(f32::to_bits)
    }
    fn pick(x: &[f32; 4], index: Self::Index) -> Self {
        Self(index.map(|i| x[i as usize % 4]))
    }
    fn splat(_: (), x: f32) -> Self {
        Self([x; WIDTH])
    }
    fn load(_: (), x: &[f32; WIDTH]) -> Self {
        Self(*x)
    }
    fn array(self) -> [f32; WIDTH] {
        self.0
    }
    fn min(self, other: Self) -> Self {
        Self(each(self.0, other.0, |a, b| if a < b { a } else { b }))
    }
    fn max(self, other: Self) -> Self {
        Self(each(self.0, other.0, |a, b| if a > b { a } else { b }))
    }
    fn less(self, other: Self) -> Self::Mask {
        each(self.0, other.0, |a, b| a < b)
    }
    fn less_or_equal(self, other: Self) -> Self::Mask {
        each(self.0, other.0, |a, b| a <= b)
    }
    fn equal(self, other: Self) -> Self::Mask {
        each(self.0, other.0, |a, b| a == b)
    }
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        each(a, b, |a, b| a & b)
    }
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        each(a, b, |a, b| a | b)
    }
    fn and_not(a: Self::Mask, b: Self::Mask) -> Self::Mask {
        each(a, b, |a, b| !a & b)
    }
    fn bits(mask: Self::Mask) -> u32 {
        mask.iter().enumerate().fold(0, |m, (l, &b)| m | u32::from(b) << l)
    }
    fn select(self, mask: Self::Mask, other: Self) -> Self {
        Self(std::array::from_fn(|l| if mask[l] { self.0[l] } else { other.0[l] }))
    }
}

#[cfg(target_arch = "x86_64")]
pub(crate) use avx::{Avx2, Avx512, HasAvx2, HasAvx512};

#[cfg(target_arch = "x86_64")]
mod avx;

/// `widest_wide!(body; a: A = x, ... => R)` calls `body::<W>(x, ..., isa)`, which must be `#[inline(always)]`, with
/// the fastest [`Wide`] of this machine and the proof that it has it. It returns from the function it stands in.
macro_rules! widest_wide {
    ($type:ident::$body:ident; $($name:ident: $ty:ty = $value:expr),* $(,)? => $ret:ty) => {{
        #[cfg(target_arch = "x86_64")]
        {
            use crate::math::simd::{Avx2, HasAvx2, HasAvx512};
            #[target_feature(enable = "avx2")]
            fn avx2($($name: $ty,)* isa: HasAvx2) -> $ret {
                $type::$body::<Avx2>($($name,)* isa)
            }
            // The same eight lanes: masks are then registers of their own, and selecting is cheap.
            #[target_feature(enable = "avx512f,avx512vl,avx512dq")]
            fn avx512vl($($name: $ty,)* isa: HasAvx512) -> $ret {
                $type::$body::<Avx2>($($name,)* isa.avx2())
            }
            if let Some(isa) = HasAvx512::detect() {
                // SAFETY: `isa` proves the features.
                return unsafe { avx512vl($($value,)* isa) };
            }
            if let Some(isa) = HasAvx2::detect() {
                // SAFETY: `isa` proves the feature.
                return unsafe { avx2($($value,)* isa) };
            }
        }
        $type::$body::<crate::math::simd::Portable>($($value,)* ())
    }};
}
pub(crate) use widest_wide;

/// Like [`widest_wide!`] for bodies `body::<N, W>` that take as many lanes as there are.
macro_rules! widest_bundle {
    ($type:ident::$body:ident; $($name:ident: $ty:ty = $value:expr),* $(,)? => $ret:ty) => {{
        #[cfg(target_arch = "x86_64")]
        {
            use crate::math::simd::{Avx2, Avx512, HasAvx2, HasAvx512};
            #[target_feature(enable = "avx2")]
            fn avx2($($name: $ty,)* isa: HasAvx2) -> $ret {
                $type::$body::<8, Avx2>($($name,)* isa)
            }
            #[target_feature(enable = "avx512f,avx512vl,avx512dq")]
            fn avx512($($name: $ty,)* isa: HasAvx512) -> $ret {
                $type::$body::<16, Avx512>($($name,)* isa)
            }
            if let Some(isa) = HasAvx512::detect() {
                // SAFETY: `isa` proves the features.
                return unsafe { avx512($($value,)* isa) };
            }
            if let Some(isa) = HasAvx2::detect() {
                // SAFETY: `isa` proves the feature.
                return unsafe { avx2($($value,)* isa) };
            }
        }
        $type::$body::<8, crate::math::simd::Portable>($($value,)* ())
    }};
}
pub(crate) use widest_bundle;

/// `widest!(body(a: A = x, ...) -> R)` calls `body(x, ...)`, which must be `#[inline(always)]`, compiled
/// with AVX2 where this machine has it (wider registers gain nothing in branchy code, and copies through
/// them stall). It returns from the function it stands in.
macro_rules! widest {
    ($body:path; $($name:ident: $ty:ty = $value:expr),* $(,)? => $ret:ty) => {{
        #[cfg(target_arch = "x86_64")]
        {
            #[target_feature(enable = "avx2")]
            fn avx2($($name: $ty),*) -> $ret {
                $body($($name),*)
            }
            if crate::math::simd::HasAvx2::detect().is_some() {
                // SAFETY: the feature was just detected.
                return unsafe { avx2($($value),*) };
            }
        }
        $body($($value),*)
    }};
}
pub(crate) use widest;
