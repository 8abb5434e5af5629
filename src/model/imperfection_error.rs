//! The errors of imperfections that a structure cannot have.

use crate::units::significant;

/// Reasons why surfaces cannot be imperfect as a scene asks for.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ImperfectionError {
    /// An edge in a plane of symmetry would leave it, or tilt there.
    #[error(
        "imperfection \"{imperfection}\" does not keep the plane of symmetry of support \"{support}\": at {at} it is {} mm off one that \
         does, of {} mm at most; a part stands for the whole only where that is its own mirror image, so model the whole shell, or use \
         kind = \"modes\", which keeps the plane",
        significant(*off_mm, 3),
        significant(*largest_mm, 3)
    )]
    OffPlane {
        /// Name of the imperfection.
        imperfection: String,
        /// Name of the support, or of what stands for it.
        support: String,
        /// Largest difference from an imperfection that keeps the plane, mm.
        off_mm: f64,
        /// Largest offset, mm.
        largest_mm: f64,
        /// Where, as text with its unit.
        at: String,
    },
    /// Edges that are joined would part.
    #[error(
        "imperfection \"{imperfection}\" moves what is joined apart: at {at} it is {} mm off one that keeps edges and seams closed and \
         smooth, of {} mm at most; let the offsets and their slopes go to 0 towards joints, and be alike on both sides of a seam",
        significant(*off_mm, 3),
        significant(*largest_mm, 3)
    )]
    Parts {
        /// Name of the imperfection.
        imperfection: String,
        /// Largest difference from an imperfection that keeps them together, mm.
        off_mm: f64,
        /// Largest offset, mm.
        largest_mm: f64,
        /// Where, as text with its unit.
        at: String,
    },
    /// The offsets are as large as the shell is curved, or wide.
    #[error(
        "the imperfections move the surface by {} mm at {at}, and {what} is {} mm: that is another shell, and no imperfect one; make \
         them smaller, or draw the geometry as it is",
        significant(*offset_mm, 3),
        significant(*limit_mm, 3)
    )]
    TooLarge {
        /// Largest offset, mm.
        offset_mm: f64,
        /// Where, as text with its unit.
        at: String,
        /// What it is compared with.
        what: &'static str,
        /// Its length, mm.
        limit_mm: f64,
    },
    /// The imperfect surface is none that a shell can have.
    #[error(
        "with its imperfections, of up to {} mm at {at}: {fault}; make the imperfections smaller or longer",
        significant(*offset_mm, 3)
    )]
    NoShell {
        /// Largest offset, mm.
        offset_mm: f64,
        /// Where, as text with its unit.
        at: String,
        /// What is wrong with the surface, in words.
        fault: String,
    },
    /// There are fewer modes.
    #[error(
        "imperfection \"{imperfection}\" asks for mode {mode}, and under the loads of the scene at factor 1 there are {found}; list \
         lower ones (`foldline stability LOG --step 0 --buckling {found}` shows them on a run of the perfect scene)"
    )]
    NoSuchMode {
        /// Name of the imperfection.
        imperfection: String,
        /// Number of the mode.
        mode: usize,
        /// Number of modes that there are.
        found: usize,
    },
    /// Too many modes have one load factor.
    #[error(
        "imperfection \"{imperfection}\": mode {mode} is one of {count} or more whose load factors, about {}, agree within \
         {within:e}: which of their sums it is hangs on rounding; use kind = \"random-field\", or a lower mode",
        significant(*factor, 4)
    )]
    Cluster {
        /// Name of the imperfection.
        imperfection: String,
        /// Number of the mode.
        mode: usize,
        /// Modes that were found to share its load factor.
        count: usize,
        /// Their load factor.
        factor: f64,
        /// Relative difference that counts as none.
        within: f64,
    },
    /// There is no linear buckling.
    #[error("imperfection \"{imperfection}\" is a mode of buckling of the perfect structure, which has none: {reason}")]
    NoModes {
        /// Name of the imperfection.
        imperfection: String,
        /// Reason, in words.
        reason: String,
    },
}

impl ImperfectionError {
    /// Name of the imperfection that it is about; `None` where it is about all of them.
    pub fn imperfection(&self) -> Option<&str> {
        match self {
            Self::OffPlane { imperfection, .. }
            | Self::Parts { imperfection, .. }
            | Self::NoSuchMode { imperfection, .. }
            | Self::Cluster { imperfection, .. }
            | Self::NoModes { imperfection, .. } => Some(imperfection),
            Self::TooLarge { .. } | Self::NoShell { .. } => None,
        }
    }
}
