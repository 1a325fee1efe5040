//! One function compiled for several instruction sets, chosen at run time.
//!
//! Bodies are plain loops over fixed arrays that the compiler turns into SIMD, or are generic over
//! [`Wide`] where it does that badly. No fused operations are used, so every variant gives the same bits.

use std::ops::{Add, Div, Mul, Sub};

/// Lanes of a [`Wide`].
pub const WIDTH: usize = 8;

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
    /// Numbers 0..4 for [`Wide::pick`].
    fn index(isa: Self::Isa, x: &[u32; N]) -> Self::Index;
    /// Lane l is `x[index[l]]`.
    fn pick(x: &[f32; 4], index: Self::Index) -> Self;
    /// `x` in every lane.
    fn splat(isa: Self::Isa, x: f32) -> Self;
    /// Lane l is `x[l]`.
    fn load(isa: Self::Isa, x: &[f32; N]) -> Self;
    fn array(self) -> [f32; N];
    fn min(self, other: Self) -> Self;
    fn max(self, other: Self) -> Self;
    fn less(self, other: Self) -> Self::Mask;
    fn less_or_equal(self, other: Self) -> Self::Mask;
    fn equal(self, other: Self) -> Self::Mask;
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
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
    fn index(_: (), x: &[u32; WIDTH]) -> Self::Index {
        *x
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

/// Every function here must end up inlined in one with the feature, or it is slow. It is sound in any case: values of
/// these types are made from [`HasAvx2`] or [`HasAvx512`], which only detection makes, or from other such values.
#[cfg(target_arch = "x86_64")]
mod avx {
    use std::arch::x86_64::*;
    use std::ops::{Add, Div, Mul, Sub};

    use super::{WIDTH, Wide};

    /// This machine has 256-bit integer and float instructions.
    #[derive(Clone, Copy, Debug)]
    pub struct HasAvx2(());

    impl HasAvx2 {
        #[inline(always)]
        pub fn detect() -> Option<Self> {
            is_x86_feature_detected!("avx2").then_some(Self(()))
        }
    }

    /// This machine has 512-bit instructions, and mask registers for 256-bit ones.
    #[derive(Clone, Copy, Debug)]
    pub struct HasAvx512(());

    impl HasAvx512 {
        #[inline(always)]
        pub fn detect() -> Option<Self> {
            let all = is_x86_feature_detected!("avx512f")
                && is_x86_feature_detected!("avx512vl")
                && is_x86_feature_detected!("avx512dq");
            all.then_some(Self(()))
        }

        /// AVX-512 includes AVX2.
        #[inline(always)]
        pub fn avx2(self) -> HasAvx2 {
            HasAvx2(())
        }
    }

    /// [`Wide`] as one register.
    #[derive(Clone, Copy, Debug)]
    pub struct Avx2(__m256);

    // SAFETY of this block and the next: see the module.
    operator! { Avx2:
        Add add |a, b| unsafe { _mm256_add_ps(a, b) };
        Sub sub |a, b| unsafe { _mm256_sub_ps(a, b) };
        Mul mul |a, b| unsafe { _mm256_mul_ps(a, b) };
        Div div |a, b| unsafe { _mm256_div_ps(a, b) };
    }

    macro_rules! methods {
        ($(fn $name:ident($($arg:ident: $ty:ty),*) -> $ret:ty = $body:expr;)+) => {
            $(#[inline(always)]
            fn $name($($arg: $ty),*) -> $ret {
                unsafe { $body }
            })+
        };
    }

    impl Wide for Avx2 {
        type Isa = HasAvx2;
        type Mask = __m256;
        type Index = __m256i;
        #[inline(always)]
        fn isa(self) -> HasAvx2 {
            HasAvx2(())
        }
        #[inline(always)]
        fn index(_: HasAvx2, x: &[u32; WIDTH]) -> __m256i {
            // SAFETY: see the module; the load reads the eight integers of `x`.
            unsafe { _mm256_loadu_si256(x.as_ptr().cast()) }
        }
        #[inline(always)]
        fn pick(x: &[f32; 4], index: __m256i) -> Self {
            // SAFETY: see the module; the broadcast reads the four floats of `x`.
            Self(unsafe { _mm256_permutevar_ps(_mm256_broadcast_ps(&*x.as_ptr().cast()), index) })
        }
        methods! {
            fn splat(_isa: HasAvx2, x: f32) -> Self = Self(_mm256_set1_ps(x));
            fn load(_isa: HasAvx2, x: &[f32; WIDTH]) -> Self = Self(_mm256_loadu_ps(x.as_ptr()));
            fn and(a: __m256, b: __m256) -> __m256 = _mm256_and_ps(a, b);
            fn or(a: __m256, b: __m256) -> __m256 = _mm256_or_ps(a, b);
            fn and_not(a: __m256, b: __m256) -> __m256 = _mm256_andnot_ps(a, b);
            fn bits(mask: __m256) -> u32 = _mm256_movemask_ps(mask) as u32;
        }
        #[inline(always)]
        fn array(self) -> [f32; WIDTH] {
            let mut out = [0.0; WIDTH];
            // SAFETY: see the module; the store writes the eight floats of `out`.
            unsafe { _mm256_storeu_ps(out.as_mut_ptr(), self.0) };
            out
        }
        #[inline(always)]
        fn min(self, other: Self) -> Self {
            Self(unsafe { _mm256_min_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            Self(unsafe { _mm256_max_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn less(self, other: Self) -> __m256 {
            unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn less_or_equal(self, other: Self) -> __m256 {
            unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn equal(self, other: Self) -> __m256 {
            unsafe { _mm256_cmp_ps::<_CMP_EQ_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn select(self, mask: __m256, other: Self) -> Self {
            Self(unsafe { _mm256_blendv_ps(other.0, self.0, mask) })
        }
    }

    /// [`Wide`] of sixteen as one register.
    #[derive(Clone, Copy, Debug)]
    pub struct Avx512(__m512);

    operator! { Avx512:
        Add add |a, b| unsafe { _mm512_add_ps(a, b) };
        Sub sub |a, b| unsafe { _mm512_sub_ps(a, b) };
        Mul mul |a, b| unsafe { _mm512_mul_ps(a, b) };
        Div div |a, b| unsafe { _mm512_div_ps(a, b) };
    }

    impl Wide<16> for Avx512 {
        type Isa = HasAvx512;
        type Mask = __mmask16;
        type Index = __m512i;
        #[inline(always)]
        fn isa(self) -> HasAvx512 {
            HasAvx512(())
        }
        #[inline(always)]
        fn index(_: HasAvx512, x: &[u32; 16]) -> __m512i {
            // SAFETY: see the module; the load reads the sixteen integers of `x`.
            unsafe { _mm512_loadu_si512(x.as_ptr().cast()) }
        }
        #[inline(always)]
        fn pick(x: &[f32; 4], index: __m512i) -> Self {
            // SAFETY: see the module; the load reads the four floats of `x`.
            Self(unsafe { _mm512_permutevar_ps(_mm512_broadcast_f32x4(_mm_loadu_ps(x.as_ptr())), index) })
        }
        methods! {
            fn splat(_isa: HasAvx512, x: f32) -> Self = Self(_mm512_set1_ps(x));
            fn load(_isa: HasAvx512, x: &[f32; 16]) -> Self = Self(_mm512_loadu_ps(x.as_ptr()));
        }
        #[inline(always)]
        fn array(self) -> [f32; 16] {
            let mut out = [0.0; 16];
            // SAFETY: see the module; the store writes the sixteen floats of `out`.
            unsafe { _mm512_storeu_ps(out.as_mut_ptr(), self.0) };
            out
        }
        #[inline(always)]
        fn min(self, other: Self) -> Self {
            Self(unsafe { _mm512_min_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            Self(unsafe { _mm512_max_ps(self.0, other.0) })
        }
        #[inline(always)]
        fn less(self, other: Self) -> __mmask16 {
            unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn less_or_equal(self, other: Self) -> __mmask16 {
            unsafe { _mm512_cmp_ps_mask::<_CMP_LE_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn equal(self, other: Self) -> __mmask16 {
            unsafe { _mm512_cmp_ps_mask::<_CMP_EQ_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn and(a: __mmask16, b: __mmask16) -> __mmask16 {
            a & b
        }
        #[inline(always)]
        fn or(a: __mmask16, b: __mmask16) -> __mmask16 {
            a | b
        }
        #[inline(always)]
        fn and_not(a: __mmask16, b: __mmask16) -> __mmask16 {
            !a & b
        }
        #[inline(always)]
        fn bits(mask: __mmask16) -> u32 {
            u32::from(mask)
        }
        #[inline(always)]
        fn select(self, mask: __mmask16, other: Self) -> Self {
            Self(unsafe { _mm512_mask_blend_ps(mask, other.0, self.0) })
        }
    }
}

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
