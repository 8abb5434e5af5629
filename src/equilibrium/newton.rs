//! Equilibrium under a prescribed end rotation: a minimum of the strain energy over the free unknowns.
//!
//! Predictor: the tangent one, K Δq = −∂g/∂θ Δθ, after which three Newton iterations a step reach 1e-7 of the
//! reactions; moving the ends alone needs 8 to 11. Corrector: [`Descent`].

use std::sync::Arc;

use crate::equilibrium::assembly::{Assembled, Want, strain_energy};
use crate::equilibrium::descent::Descent;
use crate::equilibrium::pattern::Pattern;
use crate::equilibrium::sparse::{FactorError, SparseSolver};
use crate::model::Discretization;
use crate::scene::Scene;
use crate::spline::Mesh;

/// What is known after an iteration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Iterate {
    /// Newton steps taken.
    pub iteration: usize,
    /// Strain energy of the model, N·mm.
    pub energy: f64,
    /// |Tᵀ g|, N.
    pub residual: f64,
    /// |g| on all control points: at equilibrium, the reactions, N.
    pub reactions: f64,
    /// Negative pivots of the last factored stiffness.
    pub negative_pivots: usize,
    /// Step length along the last direction; 1 is a full Newton step.
    pub step_length: f64,
    /// Twice the largest magnitude of a negative pivot: what turning it positive adds, N/mm; 0 where there is none.
    pub shift: f64,
    /// Control point with the largest residual.
    pub worst_point: usize,
}

/// A point of equilibrium.
#[derive(Clone, Debug)]
pub struct Solved {
    /// Displacement of the control points, mm.
    pub displacement: Vec<[f64; 3]>,
    /// Strain energy of the whole shell, N·mm.
    pub energy: f64,
    /// Moment at each end of the whole shell, dΠ/dθ / 2, N·mm.
    pub moment: f64,
    /// Negative pivots of the stiffness there; 0 where the equilibrium is stable.
    pub negative_pivots: usize,
    /// |residual| / |reactions|.
    pub residual: f64,
    /// What it took.
    pub effort: Effort,
}

/// What a solve cost.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Effort {
    /// Newton iterations.
    pub iterations: usize,
    /// Numeric factorizations.
    pub factorizations: usize,
}

/// Why no equilibrium was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SolveError {
    /// The iterations ran out.
    #[error("no equilibrium after {} iterations: residual {:.3e} of the reactions", last.iteration, last.residual / last.reactions)]
    TooManyIterations {
        /// The last iterate.
        last: Iterate,
        /// What it took.
        effort: Effort,
    },
    /// No step along the descent direction lowers the energy.
    #[error("the energy does not fall along the search direction (iteration {}, residual {:.3e} of the reactions)", last.iteration, last.residual / last.reactions)]
    LineSearchFailed {
        /// The last iterate.
        last: Iterate,
        /// What it took.
        effort: Effort,
    },
    /// Energy or residual is not a number.
    #[error("energy or residual is not a number at iteration {}", last.iteration)]
    NotANumber {
        /// The last iterate.
        last: Iterate,
        /// What it took.
        effort: Effort,
    },
    /// The stiffness has no factor.
    #[error("the stiffness cannot be factored: {cause}")]
    Factor {
        /// What the solver found.
        cause: FactorError,
        /// What it took.
        effort: Effort,
    },
    /// The observer asked to stop.
    #[error("stopped at iteration {} (energy {:.6e} N·mm)", last.iteration, last.energy)]
    Stopped {
        /// The last iterate.
        last: Iterate,
        /// What it took.
        effort: Effort,
    },
}

impl SolveError {
    /// What the failed solve cost.
    pub fn effort(&self) -> Effort {
        match self {
            Self::TooManyIterations { effort, .. }
            | Self::LineSearchFailed { effort, .. }
            | Self::NotANumber { effort, .. }
            | Self::Factor { effort, .. }
            | Self::Stopped { effort, .. } => *effort,
        }
    }

    /// The last iterate, where there is one.
    pub fn last(&self) -> Option<&Iterate> {
        match self {
            Self::TooManyIterations { last, .. }
            | Self::LineSearchFailed { last, .. }
            | Self::NotANumber { last, .. }
            | Self::Stopped { last, .. } => Some(last),
            Self::Factor { .. } => None,
        }
    }
}

/// Buffers for one mesh. Holds nothing that decides a result: a new one gives the same bits.
#[derive(Debug)]
pub struct Workspace {
    pub(super) discretization: Discretization,
    pub(super) pattern: Pattern,
    pub(super) solver: SparseSolver,
    pub(super) assembled: Assembled,
    pub(super) values: Vec<f64>,
    /// Where the stiffness in `assembled` and its factor were formed, and its negative pivots.
    factored_at: Option<(f64, Vec<[f64; 3]>, usize)>,
}

impl Workspace {
    /// Tables, structure and symbolic factor for a mesh.
    ///
    /// # Errors
    /// Where the factor does not fit in memory.
    pub fn new(scene: &Scene, mesh: &Arc<Mesh>) -> Result<Self, FactorError> {
        let discretization = Discretization::new(scene, mesh);
        let pattern = Pattern::new(&discretization);
        let solver = SparseSolver::new(pattern.column_starts.clone(), pattern.rows.clone())?;
        let assembled = Assembled::new(&discretization);
        let values = vec![0.0; pattern.entry_count()];
        Ok(Self { discretization, pattern, solver, assembled, values, factored_at: None })
    }

    /// The mesh's tables and unknowns.
    pub fn discretization(&self) -> &Discretization {
        &self.discretization
    }

    /// Energy of the model at a displacement, N·mm.
    pub fn energy(&self, displacement: &[[f64; 3]]) -> f64 {
        strain_energy(&self.discretization.mesh, &self.discretization.tables, displacement)
    }

    /// Stiffness and factor at a displacement, unless the last solve left them there; returns the negative pivots. Not
    /// counted in the effort of a solve, which would then depend on what ran before in the same process.
    pub(super) fn factorize_at(&mut self, theta: f64, displacement: &[[f64; 3]]) -> Result<usize, SolveError> {
        if let Some((at, known, negative)) = &self.factored_at
            && *at == theta
            && known == displacement
        {
            return Ok(*negative);
        }
        self.assembled.assemble(&self.discretization, displacement, Want::Stiffness);
        let placement = self.discretization.unknowns.at(theta);
        self.pattern.fill(&self.discretization, &placement, &self.assembled, &mut self.values);
        let effort = Effort::default();
        let negative = self.solver.factorize(&self.values).map_err(|cause| SolveError::Factor { cause, effort })?.count;
        self.factored_at = Some((theta, displacement.to_vec(), negative));
        Ok(negative)
    }
}

/// Equilibrium of a scene on the mesh of a workspace.
#[derive(Debug)]
pub struct Equilibrium<'a> {
    scene: &'a Scene,
    work: &'a mut Workspace,
}

/// Watches iterates; `true` stops the solve.
pub type Observer<'o> = &'o mut dyn FnMut(&Iterate) -> bool;

impl<'a> Equilibrium<'a> {
    /// Works in these buffers.
    pub fn new(scene: &'a Scene, work: &'a mut Workspace) -> Self {
        Self { scene, work }
    }

    /// From an equilibrium at `from_deg` to one at `to_deg`.
    ///
    /// # Errors
    /// Where none is found within the limits, or the observer stops the solve.
    pub fn advance(
        &mut self,
        displacement: &[[f64; 3]],
        from_deg: f64,
        to_deg: f64,
        observer: Observer,
    ) -> Result<Solved, SolveError> {
        let start = self.predict(displacement, from_deg.to_radians(), to_deg.to_radians());
        self.minimize(start, to_deg.to_radians(), observer)
    }

    /// Equilibrium at a fixed rotation from a displacement that may be out of balance.
    ///
    /// # Errors
    /// As for [`Self::advance`].
    pub fn relax(
        &mut self,
        displacement: &[[f64; 3]],
        rotation_deg: f64,
        observer: Observer,
    ) -> Result<Solved, SolveError> {
        let theta = rotation_deg.to_radians();
        let Workspace { discretization, .. } = &*self.work;
        let start = discretization.unknowns.at(theta).unknowns_of(displacement);
        self.minimize(start, theta, observer)
    }

    /// Unknowns at `to`: along the tangent of the path where it is stable, or the old ones, whichever has less energy.
    fn predict(&mut self, displacement: &[[f64; 3]], from: f64, to: f64) -> Vec<f64> {
        let (rate, old) = {
            // Where the stiffness has no factor (exactly at a limit point), the old unknowns are as good a start.
            let negative = self.work.factorize_at(from, displacement).unwrap_or(usize::MAX);
            let Workspace { discretization, solver, assembled, .. } = &mut *self.work;
            let placement = discretization.unknowns.at(from);
            let old = placement.unknowns_of(displacement);
            if negative > 0 {
                return old;
            }
            let moved = placement.rate(&old);
            let forces = assembled.multiply(discretization, &moved);
            let mut rate = placement.restrict(&forces);
            for (sum, turned) in rate.iter_mut().zip(placement.restrict_rate(&assembled.residual)) {
                *sum = -(*sum + turned);
            }
            solver.solve(&mut rate);
            (rate, old)
        };
        let along: Vec<f64> = old.iter().zip(&rate).map(|(q, slope)| q + slope * (to - from)).collect();
        let (moved, kept) = (self.energy_at(to, &along), self.energy_at(to, &old));
        if moved <= kept { along } else { old }
    }

    fn energy_at(&self, theta: f64, unknowns: &[f64]) -> f64 {
        let displacement = self.work.discretization.unknowns.at(theta).displacement(unknowns);
        self.work.energy(&displacement)
    }

    fn minimize(&mut self, unknowns: Vec<f64>, theta: f64, observer: Observer) -> Result<Solved, SolveError> {
        let (tolerance, max_iterations) = (self.scene.solver.tolerance, self.scene.solver.max_iterations);
        self.work.factored_at = None;
        let mut descent = Descent::new(self.work, theta, unknowns);
        let last = loop {
            let last = descent.iterate()?;
            if observer(&last) {
                return Err(SolveError::Stopped { last, effort: descent.effort });
            }
            if last.residual <= tolerance * last.reactions {
                break last;
            }
            if last.iteration >= max_iterations {
                return Err(SolveError::TooManyIterations { last, effort: descent.effort });
            }
            descent.step(&last)?;
        };
        let (displacement, power, effort) = descent.finish();
        self.work.factored_at = Some((theta, displacement.clone(), last.negative_pivots));
        let parts = self.scene.symmetry.copies() as f64;
        Ok(Solved {
            displacement,
            energy: parts * last.energy,
            moment: 0.5 * parts * power,
            negative_pivots: last.negative_pivots,
            residual: if last.reactions > 0.0 { last.residual / last.reactions } else { 0.0 },
            effort,
        })
    }
}
