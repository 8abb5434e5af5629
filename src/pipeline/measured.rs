//! What a tolerance is about: the quantity of a scene whose error counts.

use crate::adapt::DirectionalError;
use crate::equilibrium::{Configuration, Workspace};
use crate::model::ModelError;
use crate::pipeline::probes::read_first_probe;
use crate::scene::{ProbeKind, Scene};
use crate::shell::norm;
use crate::state::{Course, Previous, State};

/// Share of the mean moment so far, or of the largest displacement, that a smaller moment or displacement is compared with: where
/// one passes through zero, no relative error of it can be asked for.
const SMALL: f64 = 0.1;

/// Relative change of a quantity by finer spans, up to which it is rounding.
const FIXED: f64 = 1e-10;

/// Relative change of the quantity, for one of the parameter, from which on an equilibrium is next to a limit point: the baseline
/// has 4 at 9.8° and 23 at 9.9°, where it snaps at 9.906°; before 9.6° less than 1. Springs that stiffen with the cube of the
/// motion have 3.
const STEEP: f64 = 4.0;

/// The quantity whose error counts: the moment of turning ends, or else the first probe, or else the strain energy.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Measured {
    Moment,
    Probe,
    Energy,
}

impl Measured {
    /// The quantity of a scene.
    pub fn of(scene: &Scene) -> Self {
        match (scene.end_rotation(), scene.probes.is_empty()) {
            (Some(_), _) => Self::Moment,
            (None, false) => Self::Probe,
            (None, true) => Self::Energy,
        }
    }

    /// Reads it at a configuration on the mesh of a workspace.
    ///
    /// # Errors
    /// Where the probe asks for what there is not.
    pub fn read(self, scene: &Scene, work: &mut Workspace, at: Configuration) -> Result<f64, ModelError> {
        let energy = |work: &Workspace| scene.symmetry.copies() as f64 * work.energy(at.displacement, at.parameter);
        match self {
            Self::Moment => Ok(work.end_moment(scene, at)),
            Self::Probe => {
                let stored = energy(work);
                Ok(read_first_probe(scene, work, at, stored)?.map_or(0.0, |reading| reading.value))
            }
            Self::Energy => Ok(energy(work)),
        }
    }

    /// The relative error of a state where the quantity is `here`, from what halving the spans of one direction would change.
    /// `slope` is the rate of the quantity with the parameter, and `stored` the energy, N·mm, that the energy of the model is
    /// compared with.
    ///
    /// Next to a limit point what changes at one value of the parameter grows without bound, where the curve hardly moves: what
    /// counts there is the shift of the curve along the parameter.
    pub fn relative_error(
        self,
        scene: &Scene,
        state: &State,
        here: f64,
        slope: Option<f64>,
        error: &DirectionalError,
        stored: f64,
    ) -> f64 {
        let of_energy = error.energy.abs() / stored;
        let scale = self.scale(scene, state, here);
        let is_fixed = error.measured.abs() <= FIXED * scale;
        // The first-order change of the energy is twice what equilibrium releases. A probe that supports or symmetry fix has
        // nothing to refine by.
        if self == Self::Energy || is_fixed {
            return of_energy;
        }
        let of_quantity = error.measured.abs() / scale;
        let steepness = slope.map_or(0.0, |slope| (slope * state.parameter / here).abs());
        let shift = if steepness > STEEP { of_quantity / steepness } else { of_quantity };
        match self {
            _ if !shift.is_finite() => of_energy,
            // The moment is the rate of the energy with the turn. Where its own change passes through zero, as on coarse meshes in
            // the middle of a snap, that of the energy does not.
            Self::Moment => shift.max(of_energy),
            Self::Probe | Self::Energy => shift,
        }
    }

    /// Rate of the quantity with the parameter, from where the equilibrium came from; `None` where that is not known.
    ///
    /// # Errors
    /// As for [`Self::read`].
    pub fn slope(
        self,
        scene: &Scene,
        work: &mut Workspace,
        state: &State,
        here: f64,
    ) -> Result<Option<f64>, ModelError> {
        let at = Configuration::of(state);
        let (displacement, parameter) = match &state.drive.course {
            Course::Unknown | Course::Path(_) => return Ok(None),
            Course::Load(Previous { displacement, parameter }) => (displacement, *parameter),
        };
        // What was carried over to a finer mesh is read as its supports allow it there.
        let (displacement, turns) = work.allowed(Configuration { displacement, parameter, ..at });
        let before =
            self.read(scene, work, Configuration { displacement: &displacement, turns: &turns, parameter, ..at })?;
        let slope = (here - before) / (state.parameter - parameter);
        Ok(Some(slope).filter(|slope| slope.is_finite()))
    }

    /// What its error is compared with.
    fn scale(self, scene: &Scene, state: &State, here: f64) -> f64 {
        let least = match self {
            // Both ends turn: Π = 2 ∫ M dθ.
            Self::Moment => 0.5 * state.strain_energy_n_mm / state.parameter.to_radians(),
            Self::Probe if matches!(scene.probes[0].kind, ProbeKind::Displacement { .. }) => {
                state.displacement.iter().map(|moved| norm(*moved)).fold(0.0, f64::max)
            }
            Self::Probe | Self::Energy => 0.0,
        };
        here.abs().max(SMALL * least.abs())
    }
}
