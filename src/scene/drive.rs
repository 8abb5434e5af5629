//! What drives a run, read off a scene in one place.

use super::data::{ArcLength, Load, Scene};
use crate::units::rounded;

/// What advances a run from step to step.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum Drive<'s> {
    /// The load: a step is an increment of the parameter.
    Load(Parameter),
    /// The path of equilibria, wherever the parameter goes: a step is a length along it, within these limits.
    Path(Parameter, &'s ArcLength),
}

impl<'s> Drive<'s> {
    /// Returns the drive of a scene.
    pub fn of(scene: &'s Scene) -> Self {
        let parameter = match scene.load {
            Load::EndRotation(_) => Parameter::Rotation,
            Load::Steps(_) => Parameter::LoadFactor,
        };
        match &scene.continuation {
            None => Drive::Load(parameter),
            Some(limits) => Drive::Path(parameter, limits),
        }
    }

    /// The parameter of the run.
    pub fn parameter(self) -> Parameter {
        match self {
            Drive::Load(parameter) | Drive::Path(parameter, _) => parameter,
        }
    }

    /// Whether the path of equilibria is followed.
    pub fn follows_path(self) -> bool {
        matches!(self, Drive::Path(..))
    }

    /// Progress of the parameter towards the target: its magnitude along a path, which may reach the target on the
    /// other side of 0.
    pub fn progress(self, parameter: f64) -> f64 {
        match self {
            Drive::Load(_) => parameter,
            Drive::Path(..) => parameter.abs(),
        }
    }
}

/// The quantity that the parameter of a run measures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Parameter {
    /// Rotation of each end, degrees.
    Rotation,
    /// Load factor.
    LoadFactor,
}

impl Parameter {
    /// Returns the parameter of a scene.
    pub fn of(scene: &Scene) -> Self {
        Drive::of(scene).parameter()
    }

    /// Formats a value with its unit.
    pub fn shown(self, value: f64) -> String {
        match self {
            Parameter::Rotation => format!("{value}°"),
            Parameter::LoadFactor => format!("load factor {value}"),
        }
    }

    /// Formats a value with its unit, rounded to the decimals that matter.
    pub fn shown_short(self, value: f64) -> String {
        match self {
            Parameter::Rotation => format!("{}°", rounded(value)),
            Parameter::LoadFactor => format!("load factor {}", rounded(value)),
        }
    }
}
