//! Vectors of several numbers that a processor works on at once: one per quadrature point, or one per basis function.
//!
//! Kernels are written once, for any [`Lanes`]; a build of them is the choice of two types. Every operation rounds
//! lane by lane as IEEE 754 says, so that builds with the same [`Lanes::mul_add`] give the same bits whatever their
//! width. Plain loops over arrays were left to the compiler before: it kept them in vectors only in part, and the
//! contraction of the element stiffness took twice as long.

use std::ops::{Add, Div, Mul, Sub};

/// A vector of numbers. To have one is to know that the processor has its instructions: it comes from a
/// [`Lanes::Proof`], which only detection gives.
pub(crate) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// A proof that the processor has the instructions.
    type Proof: Copy;
    /// The array that holds the numbers in memory.
    type Array: Copy + AsRef<[f64]>;
    /// Number of lanes.
    const WIDTH: usize;

    /// Creates a vector with the same value in every lane.
    fn splat(proof: Self::Proof, value: f64) -> Self;
    /// Loads a vector from memory.
    fn load(proof: Self::Proof, from: &Self::Array) -> Self;
    /// Stores the vector in memory.
    fn store(self, to: &mut Self::Array);
    /// Computes `self · b + c`, rounded once where the build has such an instruction, twice otherwise.
    fn mul_add(self, b: Self, c: Self) -> Self;
    /// Computes the square root of every lane.
    fn sqrt(self) -> Self;
    /// Splits a slice into whole vectors; a remainder is left out.
    fn chunks(slice: &[f64]) -> &[Self::Array];
    /// Splits a mutable slice into whole vectors; a remainder is left out.
    fn chunks_mut(slice: &mut [f64]) -> &mut [Self::Array];
}

/// Vectors of four lanes.
pub(crate) trait FourLanes: Lanes<Array = [f64; 4]> {
    /// Sums the lanes of each of four vectors, (x₀ + x₁) + (x₂ + x₃), into one vector of the four sums.
    fn sums(vectors: [Self; 4]) -> Self;
}

/// Four lanes that any processor has; multiplies and adds in two roundings.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Portable([f64; 4]);

impl Lanes for Portable {
    type Proof = ();
    type Array = [f64; 4];
    const WIDTH: usize = 4;

    #[inline(always)]
    fn splat((): (), value: f64) -> Self {
        Self([value; 4])
    }

    #[inline(always)]
    fn load((): (), from: &[f64; 4]) -> Self {
        Self(*from)
    }

    #[inline(always)]
    fn store(self, to: &mut [f64; 4]) {
        *to = self.0;
    }

    #[inline(always)]
    fn mul_add(self, b: Self, c: Self) -> Self {
        self * b + c
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        let [a, b, c, d] = self.0;
        Self([a.sqrt(), b.sqrt(), c.sqrt(), d.sqrt()])
    }

    #[inline(always)]
    fn chunks(slice: &[f64]) -> &[[f64; 4]] {
        slice.as_chunks().0
    }

    #[inline(always)]
    fn chunks_mut(slice: &mut [f64]) -> &mut [[f64; 4]] {
        slice.as_chunks_mut().0
    }
}

impl FourLanes for Portable {
    #[inline(always)]
    fn sums(vectors: [Self; 4]) -> Self {
        let mut sums = [0.0; 4];
        for (sum, Self(x)) in sums.iter_mut().zip(vectors) {
            *sum = (x[0] + x[1]) + (x[2] + x[3]);
        }
        Self(sums)
    }
}

macro_rules! portable_operator {
    ($trait:ident, $name:ident, $operator:tt) => {
        impl $trait for Portable {
            type Output = Self;

            #[inline(always)]
            fn $name(self, other: Self) -> Self {
                let (a, b) = (self.0, other.0);
                Self([a[0] $operator b[0], a[1] $operator b[1], a[2] $operator b[2], a[3] $operator b[3]])
            }
        }
    };
}

portable_operator!(Add, add, +);
portable_operator!(Sub, sub, -);
portable_operator!(Mul, mul, *);
portable_operator!(Div, div, /);
