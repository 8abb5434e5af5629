//! What a stage says of the worth of its numbers: where its mesh cannot show what the shell does.
//!
//! | warning | measure | looked for |
//! |---|---|---|
//! | the elements are coarse | the strain energy that halving all of them would change ([`Halving`]) | before a jump, and at the end of a run |
//! | refinement is blocked | how long the spans that the length limit keeps are for their bending ([`Blocked`]) | where nothing is marked any more |
//! | refining changed the energy | the strain energy that the finer mesh stores otherwise at the same load | wherever the mesh is refined, but behind a jump: there it is meant to |

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::adapt::{Blocked, Halving, evaluate_indicators};
use crate::pipeline::step_control::next_stage;
use crate::pipeline::{Report, Stages};
use crate::scene::Stage;
use crate::state::{Refinement, State};
use crate::units::{count, signed};

/// Change of the strain energy, relative to it, from which on it is said.
const LARGE: f64 = 0.05;

/// The same of the last refinement, taken for the whole mesh, up to which a run whose indicators ask for no more has seen that
/// its elements are fine enough; halving them all to see it again would cost `baseline-quarter.toml` a tenth of its time. Where
/// the length limit keeps spans that bend much, the last refinement may have been at a load at which nothing bent yet.
const SMALL: f64 = 0.01;

/// A mesh that cannot show what the shell does, with the numbers that say so.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "kebab-case")]
pub enum Warning {
    /// Halving every element would change the strain energy by much.
    CoarseElements {
        /// The scene's parameter at the equilibrium that this is said of.
        parameter: f64,
        /// Elements each way of the model there.
        elements: [usize; 2],
        /// What halving them would change of the strain energy, relative to it ([`Halving::energy_share`]).
        energy_share: f64,
    },
    /// The length limit keeps spans that are far longer than their bending allows.
    RefinementBlocked {
        /// The scene's parameter.
        parameter: f64,
        /// Such spans each way.
        spans: [usize; 2],
        /// Length of the longest, in decay lengths √(t/κ) of its bending.
        decay_lengths: f64,
        /// Largest indicator among them, over its threshold.
        over_threshold: f64,
    },
    /// A finer mesh stores another strain energy at the same load.
    EnergyChangedByRefining {
        /// The scene's parameter.
        parameter: f64,
        /// Elements each way of the model, after refining.
        elements: [usize; 2],
        /// Change of the strain energy, relative to it.
        energy_change: f64,
    },
}

impl Warning {
    /// What refining at the same load did to the energy, where that is much.
    pub(super) fn of_refining(before: &State, after: &State, elements: [usize; 2]) -> Option<Self> {
        let energy_change = after.strain_energy_n_mm / before.strain_energy_n_mm - 1.0;
        let is_large = energy_change.is_finite() && energy_change.abs() > LARGE;
        // Behind a jump there is no equilibrium before: the fold only forms, and refining is to change it.
        let is_said = is_large && before.previous.is_some();
        is_said.then_some(Self::EnergyChangedByRefining { parameter: before.parameter, elements, energy_change })
    }

    /// Spans that are kept too long.
    pub(super) fn of_blocked(state: &State, blocked: Blocked) -> Self {
        let Blocked { spans, decay_lengths, over_threshold } = blocked;
        Self::RefinementBlocked { parameter: state.parameter, spans, decay_lengths, over_threshold }
    }

    /// What it is, in few words: one for each kind.
    pub fn name(&self) -> &'static str {
        match self {
            Self::CoarseElements { .. } => "coarse elements",
            Self::RefinementBlocked { .. } => "refinement blocked",
            Self::EnergyChangedByRefining { .. } => "energy changed",
        }
    }

    /// The scene's parameter that it is said of.
    pub fn parameter(&self) -> f64 {
        match *self {
            Self::CoarseElements { parameter, .. }
            | Self::RefinementBlocked { parameter, .. }
            | Self::EnergyChangedByRefining { parameter, .. } => parameter,
        }
    }

    /// Whether it says that results read at or before its parameter are wrong.
    pub fn doubts_results(&self) -> bool {
        !matches!(self, Self::RefinementBlocked { .. })
    }

    /// A sentence with the numbers, and the way out.
    pub fn in_words(&self) -> String {
        match *self {
            Self::CoarseElements { elements: [n1, n2], energy_share, .. } => {
                let change = if energy_share > 1.0 {
                    "more than all".to_owned()
                } else {
                    format!("some {:.0} %", 100.0 * energy_share)
                };
                format!(
                    "{n1} × {n2} elements cannot show this shape: halving each would change {change} of the strain energy; \
                     write more elements or a higher degree in [mesh], or a lower adapt.threshold"
                )
            }
            Self::RefinementBlocked { spans, decay_lengths, over_threshold, .. } => {
                let each_way = spans.iter().zip(["u", "v"]).filter(|(number, _)| **number > 0);
                let kept: Vec<String> =
                    each_way.map(|(number, way)| format!("{} along {way}", count(*number, "span"))).collect();
                format!(
                    "the length limit keeps {} up to {decay_lengths:.1} times as long as the decay of their bending, √(t/κ), \
                     with indicators up to {over_threshold:.0} times the threshold; write a lower adapt.length_limit_mm",
                    kept.join(" and ")
                )
            }
            Self::EnergyChangedByRefining { elements: [n1, n2], energy_change, .. } => format!(
                "refining to {n1} × {n2} elements changed the strain energy at the same load by {} %, and what was read before \
                 is as far off; start from a finer mesh, or lower adapt.threshold",
                signed(100.0 * energy_change, 1)
            ),
        }
    }
}

impl Stages {
    /// Adds what is to be said of the state that a stage made, or of the one before it.
    pub(super) fn warn(&mut self, before: &State, after: &State, report: &mut Report) {
        let refined = matches!(report.stage, Stage::RefineKnots | Stage::ReEquilibrate);
        let of_refining = refined.then(|| Warning::of_refining(before, after, report.elements));
        // Where a number is most likely read: at the last equilibrium before a jump, and at the end of the run.
        let jumped = report.jumped && report.stage == Stage::Solve;
        let ends = next_stage(&self.scene, after).is_none();
        let looked_at = [jumped.then_some(before), ends.then_some(after)];
        let of_elements = looked_at.into_iter().flatten().map(|state| self.coarse_elements(state));
        report.warnings.extend(of_refining.into_iter().chain(of_elements).flatten());
    }

    fn coarse_elements(&mut self, state: &State) -> Option<Warning> {
        if self.refining_has_shown(state) {
            return None;
        }
        let halving = Halving::of(&self.scene, state).filter(|halving| !halving.is_still())?;
        let energy_share = halving.energy_share();
        let (parameter, elements) = (state.parameter, state.mesh.element_counts());
        let is_said = energy_share.is_finite() && energy_share > LARGE;
        is_said.then_some(Warning::CoarseElements { parameter, elements, energy_share })
    }

    /// Whether refining has shown that elements are fine enough: the last time changed little, and the indicators are content.
    fn refining_has_shown(&mut self, state: &State) -> bool {
        let is_small = |last: Refinement| last.of_all_n_mm() <= SMALL * state.strain_energy_n_mm;
        let Some(adapt) = self.scene.adapt.clone().filter(|_| state.refinement.is_some_and(is_small)) else {
            return false;
        };
        let Ok((scene, work)) = self.workspace(&state.mesh, state.step, Stage::EvaluateIndicators) else {
            return false;
        };
        let indicators = evaluate_indicators(scene, &adapt, work.discretization(), &state.displacement);
        indicators.marked.iter().all(Vec::is_empty) && indicators.blocked.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::{MemorySink, Run};
    use crate::scene::{LengthLimit, Scene, parse};

    /// Whether refining has shown enough at the end of a run.
    fn has_shown(scene: Scene) -> bool {
        let start = Stages::new(scene.clone()).start().unwrap();
        let mut sink = MemorySink::default();
        Run::new(Stages::new(scene.clone()), start, None).to_end(None, &|| false, &mut sink).unwrap();
        Stages::new(scene).refining_has_shown(&sink.stages.pop().unwrap().0)
    }

    /// The baseline, refined behind its snap, halves no elements to see what refining has shown; a cylinder that the length
    /// limit keeps coarse since its first small load does.
    #[test]
    fn what_refining_has_shown_is_not_looked_for_again() {
        let text = include_str!("../../pipelines/baseline-quarter.toml");
        let mut baseline = parse(text, "baseline-quarter.toml").unwrap();
        baseline.load.set_target(20.0);
        assert!(has_shown(baseline));
        let text = include_str!("../../tests/verification/scenes/pulled-cylinder.toml");
        let mut cylinder = parse(text, "pulled-cylinder.toml").unwrap();
        cylinder.adapt.as_mut().unwrap().length_limit = LengthLimit::SqrtRadiusThickness;
        assert!(!has_shown(cylinder));
    }
}
