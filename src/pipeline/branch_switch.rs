//! The stage switch-branch: from an unstable equilibrium to a stable one at the same load.

use crate::energy::Balance;
use crate::equilibrium::{Configuration, Effort, Equilibrium, Iterate, SolveError, Solved, soft_mode};
use crate::pipeline::StageError;
use crate::pipeline::step::{Step, out_of_order, settle};
use crate::pipeline::step_control::{is_jump, known_release};
use crate::record::Report;
use crate::scene::Stage;
use crate::state::{Course, State};

/// Largest motion off an unstable equilibrium along its soft mode, in thicknesses: beyond rounding by far, and far less
/// than what bending makes of it.
const SWITCHING_AMPLITUDE: f64 = 0.1;
/// Largest number of modes that are left one after the other. Each descent ends in a minimum of the energy but where a
/// symmetry holds it on a ridge; the tape spring in equal-sense bending has two such modes at once.
const MOST_MODES: usize = 8;

/// Leaves an unstable equilibrium along its soft modes, one after the other; `course_on` is what its drive remembers on the branch.
pub(super) fn switch_branch(
    step: &mut Step,
    course_on: impl FnOnce(&mut Step, &State) -> Result<Course, SolveError>,
) -> Result<(State, Report), StageError> {
    let state = step.state;
    if state.negative_pivots == 0 {
        return Err(out_of_order(state, Stage::SwitchBranch, "the equilibrium is stable"));
    }
    let reached = step.shown(state.parameter);
    let failed = |cause: SolveError| StageError::NotSwitched {
        step: state.step,
        reached: reached.clone(),
        cause: Box::new(cause),
    };
    let mut next = state.clone();
    let mut effort = Effort::default();
    let mut work_done = 0.0;
    for _ in 0..MOST_MODES {
        let left = leave(step, &next, &mut effort).map_err(failed)?;
        work_done += left.balance.work;
        next = settle(&next, &left);
        next.drive.course = Course::Unknown;
        if next.negative_pivots == 0 {
            next.drive.course = course_on(step, &next).map_err(failed)?;
            let balance = Balance { work: work_done, ..left.balance };
            let released = balance.dissipated(state.strain_energy_n_mm);
            let mut report = step.arrived(&next, &Solved { effort, balance, ..left })?;
            report.jumped = is_jump(released, state.strain_energy_n_mm, next.strain_energy_n_mm);
            report.energy_released_n_mm = known_release(released);
            return Ok((next, report));
        }
    }
    Err(StageError::StillUnstable {
        step: state.step,
        reached,
        modes: MOST_MODES,
        negative_pivots: next.negative_pivots,
    })
}

/// Leaves the equilibrium of a state along its softest mode and descends to another one; adds to the effort so far.
fn leave(step: &mut Step, from: &State, effort: &mut Effort) -> Result<Solved, SolveError> {
    let Step { scene, work, observer, .. } = step;
    let mut watch = |iterate: &Iterate| {
        observer(iterate);
        false
    };
    let from = Configuration::of(from);
    let mode = soft_mode(work, from)?;
    let amplitude = SWITCHING_AMPLITUDE * scene.material.thickness_mm();
    let left = Equilibrium::new(scene, work).leave(from, &mode, amplitude, &mut watch)?;
    effort.iterations += left.effort.iterations;
    effort.factorizations += mode.factorizations + left.effort.factorizations;
    Ok(left)
}
