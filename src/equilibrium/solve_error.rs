//! Why a solve found no equilibrium, or could not begin.

use crate::equilibrium::iterate::{Effort, Iterate};
use crate::equilibrium::sparse::FactorError;
use crate::model::ModelError;

/// Reasons why a solve found no equilibrium.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SolveError {
    /// The iterations ran out.
    #[error("no equilibrium after {} iterations: residual {:.3e} of the forces", last.iteration, last.relative_residual())]
    TooManyIterations {
        /// The last iterate.
        last: Iterate,
        /// Iterations and factorizations spent.
        effort: Effort,
    },
    /// No step along the descent direction lowers the energy.
    #[error("the energy does not fall along the search direction (iteration {}, residual {:.3e} of the forces)", last.iteration, last.relative_residual())]
    LineSearchFailed {
        /// The last iterate.
        last: Iterate,
        /// Iterations and factorizations spent.
        effort: Effort,
    },
    /// Energy or residual is not a number.
    #[error("energy or residual is not a number at iteration {}", last.iteration)]
    NotANumber {
        /// The last iterate.
        last: Iterate,
        /// Iterations and factorizations spent.
        effort: Effort,
    },
    /// The stiffness has no factor.
    #[error("the stiffness cannot be factored: {cause}")]
    Factor {
        /// Error of the sparse solver.
        cause: FactorError,
        /// Iterations and factorizations spent.
        effort: Effort,
    },
    /// Nothing moves as the parameter changes: there is no path to follow.
    #[error(
        "nothing moves as the parameter changes at {parameter}: give the loads or motions a history that continues there"
    )]
    NothingMoves {
        /// Value of the scene's parameter.
        parameter: f64,
        /// Iterations and factorizations spent.
        effort: Effort,
    },
    /// The observer asked to stop.
    #[error("stopped at iteration {} (energy {:.6e} N·mm)", last.iteration, last.energy)]
    Stopped {
        /// The last iterate.
        last: Iterate,
        /// Iterations and factorizations spent.
        effort: Effort,
    },
}

impl SolveError {
    /// Returns an iterate where its energy and residual are numbers, and the error otherwise.
    pub(super) fn unless_finite(last: Iterate, effort: Effort) -> Result<Iterate, Self> {
        if last.is_finite() { Ok(last) } else { Err(Self::NotANumber { last, effort }) }
    }

    /// Iterations and factorizations spent by the failed solve.
    pub fn effort(&self) -> Effort {
        match self {
            Self::TooManyIterations { effort, .. }
            | Self::LineSearchFailed { effort, .. }
            | Self::NotANumber { effort, .. }
            | Self::Factor { effort, .. }
            | Self::NothingMoves { effort, .. }
            | Self::Stopped { effort, .. } => *effort,
        }
    }

    /// Last iterate of the failed solve, where there is one.
    pub fn last(&self) -> Option<&Iterate> {
        match self {
            Self::TooManyIterations { last, .. }
            | Self::LineSearchFailed { last, .. }
            | Self::NotANumber { last, .. }
            | Self::Stopped { last, .. } => Some(last),
            Self::Factor { .. } | Self::NothingMoves { .. } => None,
        }
    }
}

/// Reasons why no workspace could be built for a scene on a mesh.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum WorkspaceError {
    /// Supports or loads do not fit the mesh.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The factor does not fit in memory.
    #[error(transparent)]
    Factor(#[from] FactorError),
}
