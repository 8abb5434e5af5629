//! The end that a scene expects of its run, for suites that run scenes to see whether they still end so.

use serde::{Deserialize, Serialize};

/// How a run of the scene is expected to end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Expectation {
    /// How the run is expected to end.
    pub outcome: ExpectedOutcome,
    /// File, in the folder of the scene, of one with the same curve but for units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub same_as: Option<String>,
    /// Bits of the result that survive a change of an input in its last place, at least.
    pub least_bits: usize,
    /// Largest moment before the first jump (other scenes: first probe, or strain energy), from a closed form or a finer mesh.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub peak: Option<f64>,
    /// The same at the last equilibrium.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub last: Option<f64>,
    /// Largest error relative to these.
    #[serde(default = "most_error", skip_serializing_if = "is_most_error")]
    pub within: f64,
    /// Why it may be more than [`Self::MOST_ERROR`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inexact: Option<String>,
}

impl Default for Expectation {
    fn default() -> Self {
        Self {
            outcome: ExpectedOutcome::default(),
            same_as: None,
            least_bits: Self::LEAST_BITS,
            peak: None,
            last: None,
            within: Self::MOST_ERROR,
            inexact: None,
        }
    }
}

impl Expectation {
    /// Number of correct bits of a result (three digits) below which it counts as noise, unless the scene gives a
    /// reason.
    pub const LEAST_BITS: usize = 10;
    /// Largest error, relative to a closed form or a finer mesh, unless the scene states another one.
    pub const MOST_ERROR: f64 = 0.02;
}

fn most_error() -> f64 {
    Expectation::MOST_ERROR
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_most_error(within: &f64) -> bool {
    *within == Expectation::MOST_ERROR
}

/// The ways for a run to end that a scene can expect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
#[non_exhaustive]
pub enum ExpectedOutcome {
    /// The run reaches its target.
    #[default]
    Finished,
    /// Before its first step: mesh, supports and loads do not go together.
    Refused,
    /// Where no increment, however small, leads to an equilibrium.
    NoEquilibrium,
    /// At a jump beyond which no equilibrium is found.
    JumpNotFollowed,
    /// On a refined mesh that has no equilibrium.
    NotReEquilibrated,
    /// Where refinement asks for more than memory holds.
    RefinedTooFar,
    /// Where a path by arc length cannot be followed, however short the step.
    PathLost,
    /// Where a path by arc length has taken all the steps that it may.
    PathTooLong,
}

impl ExpectedOutcome {
    /// The word for the outcome in scenes and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Finished => "finished",
            Self::Refused => "refused",
            Self::NoEquilibrium => "no-equilibrium",
            Self::JumpNotFollowed => "jump-not-followed",
            Self::NotReEquilibrated => "not-re-equilibrated",
            Self::RefinedTooFar => "refined-too-far",
            Self::PathLost => "path-lost",
            Self::PathTooLong => "path-too-long",
        }
    }
}
