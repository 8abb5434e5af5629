//! Lanes of x86 processors: AVX2 with FMA (four) and AVX-512 (eight).

use std::arch::x86_64::*;
use std::ops::{Add, Div, Mul, Sub};

use super::lanes::{FourLanes, Lanes};

/// A proof that the processor has AVX2 and FMA.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct HasFma(());

/// A proof that the processor has AVX-512F and AVX-512VL, in addition to what [`HasFma`] proves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct HasAvx512(HasFma);

impl HasFma {
    /// Asks the processor; returns `None` where it lacks the instructions.
    pub(crate) fn detect() -> Option<Self> {
        (is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")).then_some(Self(()))
    }
}

impl HasAvx512 {
    /// Asks the processor; returns `None` where it lacks the instructions.
    pub(crate) fn detect() -> Option<Self> {
        let fma = HasFma::detect()?;
        (is_x86_feature_detected!("avx512f") && is_x86_feature_detected!("avx512vl")).then_some(Self(fma))
    }

    /// Returns the proof for the smaller set of instructions.
    pub(crate) fn fma(self) -> HasFma {
        self.0
    }
}

/// Four lanes of AVX2; multiplies and adds in one rounding.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fma(__m256d);

/// Eight lanes of AVX-512; multiplies and adds in one rounding.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Avx512(__m512d);

macro_rules! lanes {
    ($lanes:ident, $proof:ident, $width:literal, $set1:ident, $load:ident, $store:ident, $fmadd:ident, $sqrt:ident,
     $add:ident, $sub:ident, $mul:ident, $div:ident) => {
        impl Lanes for $lanes {
            type Proof = $proof;
            type Array = [f64; $width];
            const WIDTH: usize = $width;

            #[inline(always)]
            fn splat(_: $proof, value: f64) -> Self {
                // SAFETY: the proof says that the processor has the instruction.
                Self(unsafe { $set1(value) })
            }

            #[inline(always)]
            fn load(_: $proof, from: &[f64; $width]) -> Self {
                // SAFETY: the proof says that the processor has the instruction, which needs no alignment and reads as
                // many numbers as the array has.
                Self(unsafe { $load(from.as_ptr()) })
            }

            #[inline(always)]
            fn store(self, to: &mut [f64; $width]) {
                // SAFETY: `self` came from a proof that the processor has the instruction, which needs no alignment and
                // writes as many numbers as the array has.
                unsafe { $store(to.as_mut_ptr(), self.0) }
            }

            #[inline(always)]
            fn mul_add(self, b: Self, c: Self) -> Self {
                // SAFETY: `self` came from a proof that the processor has the instruction.
                Self(unsafe { $fmadd(self.0, b.0, c.0) })
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                // SAFETY: `self` came from a proof that the processor has the instruction.
                Self(unsafe { $sqrt(self.0) })
            }

            #[inline(always)]
            fn chunks(slice: &[f64]) -> &[[f64; $width]] {
                slice.as_chunks().0
            }

            #[inline(always)]
            fn chunks_mut(slice: &mut [f64]) -> &mut [[f64; $width]] {
                slice.as_chunks_mut().0
            }
        }

        operator!($lanes, Add, add, $add);
        operator!($lanes, Sub, sub, $sub);
        operator!($lanes, Mul, mul, $mul);
        operator!($lanes, Div, div, $div);
    };
}

macro_rules! operator {
    ($lanes:ident, $trait:ident, $name:ident, $instruction:ident) => {
        impl $trait for $lanes {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                // SAFETY: `self` came from a proof that the processor has the instruction.
                Self(unsafe { $instruction(self.0, other.0) })
            }
        }
    };
}

lanes!(
    Fma,
    HasFma,
    4,
    _mm256_set1_pd,
    _mm256_loadu_pd,
    _mm256_storeu_pd,
    _mm256_fmadd_pd,
    _mm256_sqrt_pd,
    _mm256_add_pd,
    _mm256_sub_pd,
    _mm256_mul_pd,
    _mm256_div_pd
);
lanes!(
    Avx512,
    HasAvx512,
    8,
    _mm512_set1_pd,
    _mm512_loadu_pd,
    _mm512_storeu_pd,
    _mm512_fmadd_pd,
    _mm512_sqrt_pd,
    _mm512_add_pd,
    _mm512_sub_pd,
    _mm512_mul_pd,
    _mm512_div_pd
);

impl FourLanes for Fma {
    #[inline(always)]
    fn sums(vectors: [Self; 4]) -> Self {
        let [a, b, c, d] = vectors;
        // SAFETY: `vectors` came from a proof that the processor has the instructions.
        unsafe {
            // a₀ + a₁, b₀ + b₁, a₂ + a₃, b₂ + b₃, and likewise for c and d.
            let (ab, cd) = (_mm256_hadd_pd(a.0, b.0), _mm256_hadd_pd(c.0, d.0));
            Self(_mm256_add_pd(_mm256_permute2f128_pd::<0x20>(ab, cd), _mm256_permute2f128_pd::<0x31>(ab, cd)))
        }
    }
}
