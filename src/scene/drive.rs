//! What drives a run, read off a scene in one place.

use super::data::{ArcLength, Load, Scene};
use crate::units::rounded;

/// What moves the structure on, step after step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive<'s> {
    /// The load: a step is an increment of the parameter.
    Load(Parameter),
    /// The path of equilibria, wherever the parameter goes: a step is a length along it, within these limits.
    Path(Parameter, &'s ArcLength),
}

impl<'s> Drive<'s> {
    /// Of a scene.
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

    /// What the parameter is.
    pub fn parameter(self) -> Parameter {
        match self {
            Drive::Load(parameter) | Drive::Path(parameter, _) => parameter,
        }
    }

    /// Whether the path of equilibria is followed.
    pub fn follows_path(self) -> bool {
        matches!(self, Drive::Path(..))
    }

    /// How far a parameter is on the way to the target: along a path it may get there on the other side of 0.
    pub fn way_of(self, parameter: f64) -> f64 {
        match self {
            Drive::Load(_) => parameter,
            Drive::Path(..) => parameter.abs(),
        }
    }
}

/// What the parameter of a run is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// Rotation of each end, degrees.
    Rotation,
    /// Load factor.
    LoadFactor,
}

impl Parameter {
    /// Of a scene.
    pub fn of(scene: &Scene) -> Self {
        Drive::of(scene).parameter()
    }

    /// A value with its unit.
    pub fn shown(self, value: f64) -> String {
        match self {
            Parameter::Rotation => format!("{value}°"),
            Parameter::LoadFactor => format!("load factor {value}"),
        }
    }

    /// The same with no more decimals than say something.
    pub fn shown_short(self, value: f64) -> String {
        match self {
            Parameter::Rotation => format!("{}°", rounded(value)),
            Parameter::LoadFactor => format!("load factor {}", rounded(value)),
        }
    }
}
