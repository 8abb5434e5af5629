//! The numbers that name a state in a file.

use crate::record::{Parameter, Record};
use crate::state::Hash;

/// What a state is of.
#[derive(Clone, Debug, PartialEq)]
pub struct Instant {
    /// Load step.
    pub step: u64,
    /// What the parameter is.
    pub driven_by: Parameter,
    /// Rotation of each end, degrees, or load factor.
    pub parameter: f64,
    /// End moment of turning ends, N·mm.
    pub moment_n_mm: f64,
    /// Strain energy of the whole shell, N·mm.
    pub strain_energy_n_mm: f64,
    /// Hash of the state in the log.
    pub state_hash: Hash,
}

impl Instant {
    /// The instant of a stage.
    pub fn of(Record { report, commit, .. }: &Record) -> Self {
        Self {
            step: report.step,
            driven_by: report.driven_by,
            parameter: report.parameter,
            moment_n_mm: report.moment_n_mm,
            strain_energy_n_mm: report.strain_energy_n_mm,
            state_hash: commit.state_hash,
        }
    }

    /// Its numbers, each with a name that says its unit.
    pub fn numbers(&self) -> Vec<(&'static str, f64)> {
        let driven = match self.driven_by {
            Parameter::Rotation => vec![("rotation_deg", self.parameter), ("moment_n_mm", self.moment_n_mm)],
            Parameter::LoadFactor => vec![("load_factor", self.parameter)],
        };
        let energy = ("strain_energy_n_mm", self.strain_energy_n_mm);
        [("step", self.step as f64)].into_iter().chain(driven).chain([energy]).collect()
    }
}
