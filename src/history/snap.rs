//! Where exactly a run jumped: from the last stable state before the jump, the load is halved until it is known.

use crate::equilibrium::{Equilibrium, FactorError, Iterate, Observer, SoftMode, SolveError, Workspace, soft_mode};
use crate::history::bisection::LoadBisection;
use crate::journal::{Log, StateError};
use crate::pipeline::is_jump;
use crate::scene::Scene;
use crate::state::State;

/// A jump, located.
#[derive(Clone, Debug)]
pub struct SnapReport {
    /// Last rotation at which the shell is stable where it was, and the first at which it is not, degrees.
    pub bracket_deg: [f64; 2],
    /// Moment on both sides, N·mm.
    pub moment_n_mm: [f64; 2],
    /// Strain energy released at the end of the bracket, N·mm.
    pub energy_released_n_mm: f64,
    /// Negative pivots: in the last stable state, the most on the way through the jump, and after it.
    pub negative_pivots: [usize; 3],
    /// The mode that is softest in the last stable state.
    pub mode: SoftMode,
    /// Undeformed place of the control point that moves most in it, mm.
    pub mode_at: [f64; 3],
    /// The last stable state.
    pub stable: State,
    /// Solves that it took.
    pub solves: usize,
}

/// Why a jump could not be located.
#[derive(Debug, thiserror::Error)]
pub enum SnapError {
    /// The log holds no jump.
    #[error("no stage of this log jumped; the largest rotation in it is {largest_deg}°")]
    NoJump {
        /// Largest rotation in the log, degrees.
        largest_deg: f64,
    },
    /// A state of the log cannot be had.
    #[error(transparent)]
    State(#[from] StateError),
    /// The jump is in the first step: there is no stable state before it.
    #[error(
        "the run jumps in its first step: there is no stable state in the log to go back to; run it with a smaller increment"
    )]
    NothingBefore,
    /// The jump does not happen on the mesh before it.
    #[error(
        "the shell goes from {from_deg}° to {to_deg}° without a jump on the mesh that it had: the jump came from refining that mesh; \
         run the scene from a finer mesh to bisect it"
    )]
    OnRefinedMesh {
        /// Last stable rotation, degrees.
        from_deg: f64,
        /// Rotation of the jump, degrees.
        to_deg: f64,
    },
    /// A solve failed.
    #[error("a solve from {from_deg}° to {to_deg}° failed")]
    Solve {
        /// Where it started, degrees.
        from_deg: f64,
        /// Where it was to end, degrees.
        to_deg: f64,
        /// Why.
        source: SolveError,
    },
    /// The equations do not fit in memory.
    #[error(transparent)]
    Factor(#[from] FactorError),
}

/// Locates the first jump of a log to `tolerance_deg`, on the mesh of the last stable state before it.
///
/// # Errors
/// Where the log holds no jump or a solve fails.
pub fn find_snap(log: &Log, scene: &Scene, tolerance_deg: f64) -> Result<SnapReport, SnapError> {
    let entries = log.entries();
    let Some(jump) = entries.iter().position(|entry| entry.record.report.jumped) else {
        let largest_deg = entries.iter().fold(0.0, |most: f64, entry| most.max(entry.record.report.rotation_deg));
        return Err(SnapError::NoJump { largest_deg });
    };
    let beyond = entries[jump].record.report.rotation_deg;
    let before = (0..jump).rev().find(|index| entries[*index].record.report.rotation_deg < beyond);
    let start = log.state(before.ok_or(SnapError::NothingBefore)?)?;
    let mut work = Workspace::new(scene, &start.mesh)?;
    let mut tries = Tries { scene, work: &mut work, count: 0 };

    let mut stable = start;
    if tries.gently(&stable, beyond)?.is_some() {
        return Err(SnapError::OnRefinedMesh { from_deg: stable.rotation_deg, to_deg: beyond });
    }
    let mut search = LoadBisection::new(stable.rotation_deg, beyond, tolerance_deg);
    while let Some(rotation_deg) = search.next() {
        let next = tries.gently(&stable, rotation_deg)?;
        search = search.told(rotation_deg, next.is_none());
        if let Some(next) = next {
            stable = next;
        }
    }
    let bracket_deg = search.bracket();
    let (after, most_negative) = tries.through(&stable, bracket_deg[1])?;
    let solves = tries.count;
    let mode = soft_mode(&mut work, &stable.displacement, stable.rotation_deg).map_err(|source| SnapError::Solve {
        from_deg: stable.rotation_deg,
        to_deg: stable.rotation_deg,
        source,
    })?;
    let [x, y, z, w] = stable.mesh.control_points[mode.largest_at];
    let work_done = (stable.moment_n_mm + after.moment_n_mm) * (bracket_deg[1] - bracket_deg[0]).to_radians();
    Ok(SnapReport {
        bracket_deg,
        moment_n_mm: [stable.moment_n_mm, after.moment_n_mm],
        energy_released_n_mm: stable.strain_energy_n_mm + work_done - after.strain_energy_n_mm,
        negative_pivots: [stable.negative_pivots as usize, most_negative, after.negative_pivots as usize],
        mode,
        mode_at: [x / w, y / w, z / w],
        stable,
        solves,
    })
}

struct Tries<'a> {
    scene: &'a Scene,
    work: &'a mut Workspace,
    count: usize,
}

impl Tries<'_> {
    /// The equilibrium at a rotation, if the shell reaches it without passing an unstable shape or releasing energy.
    fn gently(&mut self, from: &State, rotation_deg: f64) -> Result<Option<State>, SnapError> {
        let stable = from.negative_pivots as usize;
        let reached = match self.solve(from, rotation_deg, &mut |iterate| iterate.negative_pivots > stable) {
            Ok(reached) => reached,
            // Beyond a limit point there is nothing to converge to near by.
            Err(
                SolveError::Stopped { .. } | SolveError::TooManyIterations { .. } | SolveError::LineSearchFailed { .. },
            ) => {
                return Ok(None);
            }
            Err(source) => return Err(SnapError::Solve { from_deg: from.rotation_deg, to_deg: rotation_deg, source }),
        };
        let work = (from.moment_n_mm + reached.moment_n_mm) * (rotation_deg - from.rotation_deg).to_radians();
        let released = from.strain_energy_n_mm + work - reached.strain_energy_n_mm;
        let jumped = is_jump(released, from.strain_energy_n_mm, reached.strain_energy_n_mm);
        Ok((!jumped).then_some(reached))
    }

    /// The equilibrium at a rotation however it is reached, and the most negative pivots on the way.
    fn through(&mut self, from: &State, rotation_deg: f64) -> Result<(State, usize), SnapError> {
        let mut most = 0;
        let mut watch = |iterate: &Iterate| {
            most = most.max(iterate.negative_pivots);
            false
        };
        let reached = self.solve(from, rotation_deg, &mut watch);
        let failed = |source| SnapError::Solve { from_deg: from.rotation_deg, to_deg: rotation_deg, source };
        Ok((reached.map_err(failed)?, most))
    }

    fn solve(&mut self, from: &State, rotation_deg: f64, watch: Observer) -> Result<State, SolveError> {
        self.count += 1;
        let solved = Equilibrium::new(self.scene, self.work).advance(
            &from.displacement,
            from.rotation_deg,
            rotation_deg,
            watch,
        )?;
        Ok(State {
            displacement: solved.displacement,
            rotation_deg,
            moment_n_mm: solved.moment,
            strain_energy_n_mm: solved.energy,
            negative_pivots: solved.negative_pivots as u64,
            ..from.clone()
        })
    }
}
