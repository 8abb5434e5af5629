//! The builds of the kernel for different processors, and which of them this machine runs.

#[cfg(target_arch = "x86_64")]
use crate::shell::lanes_x86::{HasAvx512, HasFma};

/// Build of the kernel for a kind of processor. Those for AVX2 and AVX-512 give the same bits; the portable one rounds
/// differently.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Build {
    /// Runs on any processor.
    Portable,
    /// Uses AVX2: four lanes, fused multiply-add.
    #[cfg(target_arch = "x86_64")]
    Fma(HasFma),
    /// Uses AVX-512: rows of the stiffness in eight lanes, the rest as for AVX2.
    #[cfg(target_arch = "x86_64")]
    Avx512(HasAvx512),
}

impl Build {
    /// Finds the fastest build that this machine runs.
    pub(crate) fn detect() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            let fma = || HasFma::detect().map(Self::Fma);
            HasAvx512::detect().map(Self::Avx512).or_else(fma).unwrap_or(Self::Portable)
        }
        #[cfg(not(target_arch = "x86_64"))]
        {
            Self::Portable
        }
    }

    /// Name of the build in manifests.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Portable => "portable",
            #[cfg(target_arch = "x86_64")]
            Self::Fma(_) => "avx2+fma",
            #[cfg(target_arch = "x86_64")]
            Self::Avx512(_) => "avx512",
        }
    }
}
