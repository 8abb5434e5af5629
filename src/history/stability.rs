//! How stable the states of a log are.

use crate::equilibrium::{
    BucklingError, BucklingModes, Configuration, SoftMode, SolveError, Workspace, WorkspaceError, linear_buckling,
    soft_mode,
};
use crate::history::logged_scene::{LoggedSceneError, check_terms};
use crate::history::states::{RemakeError, States};
use crate::model::ModelError;
use crate::pipeline::Stages;
use crate::scene::Scene;
use crate::state::State;

/// The softest mode of a state in a log.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct StabilityReport {
    /// The state.
    pub state: State,
    /// The lowest eigenvalue of its tangent stiffness, and the mode.
    pub mode: SoftMode,
    /// Undeformed place of the control point that moves most in it, mm.
    pub mode_at: [f64; 3],
}

/// Why the softest mode of a state cannot be computed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StabilityError {
    /// The state is not available.
    #[error(transparent)]
    State(#[from] RemakeError),
    /// It was made with other terms of the caller's own.
    #[error(transparent)]
    Terms(#[from] LoggedSceneError),
    /// The equations do not fit in memory, or the scene not the mesh.
    #[error(transparent)]
    Workspace(#[from] WorkspaceError),
    /// The stiffness has no factor.
    #[error(transparent)]
    Solve(#[from] SolveError),
    /// The shells cannot be made discrete.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// There is no linear buckling of the state.
    #[error(transparent)]
    Buckling(#[from] BucklingError),
}

/// The lowest modes of linear buckling about a state in a log.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct BucklingReport {
    /// The state.
    pub state: State,
    /// The modes.
    pub modes: BucklingModes,
}

/// Computes `count` modes of linear buckling about the state that stage `index` made, or about the undeformed shells where there is no
/// index.
///
/// # Errors
/// Where the state is not available or not stable, was made with other terms, or nothing depends on the load factor.
pub fn buckling_at(
    states: &mut States,
    index: Option<usize>,
    scene: &Scene,
    count: usize,
) -> Result<BucklingReport, StabilityError> {
    check_terms(states.log(), index.unwrap_or(0), states.own_terms())?;
    let state = match index {
        Some(index) => states.at(index)?,
        None => Stages::with_terms(scene.clone(), states.own_terms().to_vec()).start()?,
    };
    let mut work = Workspace::with_terms(scene, &state.mesh, states.own_terms())?;
    let modes = linear_buckling(&mut work, Configuration::of(&state), count)?;
    Ok(BucklingReport { state, modes })
}

/// Computes the softest mode of the state that stage `index` made.
///
/// # Errors
/// Where the state is not available, was made with other terms, or its stiffness has no factor.
pub fn stability_at(states: &mut States, index: usize, scene: &Scene) -> Result<StabilityReport, StabilityError> {
    check_terms(states.log(), index, states.own_terms())?;
    let state = states.at(index)?;
    let mut work = Workspace::with_terms(scene, &state.mesh, states.own_terms())?;
    let (mode, mode_at) = mode_of(scene, &mut work, &state)?;
    Ok(StabilityReport { mode_at, mode, state })
}

/// The softest mode of a state, with the eigenvalue of the whole shell, as energies are; and the undeformed place of the
/// control point that moves most in it, mm.
pub(super) fn mode_of(scene: &Scene, work: &mut Workspace, state: &State) -> Result<(SoftMode, [f64; 3]), SolveError> {
    let mut mode = soft_mode(work, Configuration::of(state))?;
    mode.eigenvalue *= scene.symmetry.copies() as f64;
    let place = state.mesh.point(mode.largest_at);
    Ok((mode, place))
}
