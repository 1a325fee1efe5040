//! [`Wide`] by x86's vector registers.
//!
//! Every function here must end up inlined in one with the feature, or it is slow. It is sound in any case: values of
//! these types are made from [`HasAvx2`] or [`HasAvx512`], which only detection makes, or from other such values.

use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

use super::{WIDTH, Wide};

/// This machine has 256-bit integer and float instructions.
#[derive(Clone, Copy, Debug)]
pub struct HasAvx2(());

impl HasAvx2 {
    /// `None` where the instructions are missing.
    #[inline(always)]
    pub fn detect() -> Option<Self> {
        is_x86_feature_detected!("avx2").then_some(Self(()))
    }
}

/// This machine has 512-bit instructions, and mask registers for 256-bit ones.
#[derive(Clone, Copy, Debug)]
pub struct HasAvx512(());

impl HasAvx512 {
    /// `None` where the instructions are missing.
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
    fn as_index(self) -> __m256i {
        unsafe { _mm256_castps_si256(self.0) }
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
    fn as_index(self) -> __m512i {
        unsafe { _mm512_castps_si512(self.0) }
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
