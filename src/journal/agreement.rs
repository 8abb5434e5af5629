//! Whether a report agrees with its state: every number that both hold, bit for bit.

use crate::record::{Parameter, Report};
use crate::scene::Stage;
use crate::spline::knot_counts;
use crate::state::State;

/// A number of a report that differs from the number in the state that the stage made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the report has {field} {said}, and the state has {held}")]
pub struct Disagreement {
    /// Name of the field.
    pub field: &'static str,
    /// The value in the report.
    pub said: String,
    /// What the state holds.
    pub held: String,
}

/// The first field in which a report differs from its state.
pub(super) fn disagreement(report: &Report, state: &State) -> Option<Disagreement> {
    let differs = |field, said: f64, held: f64| {
        let differ = said.to_bits() != held.to_bits();
        differ.then(|| Disagreement { field, said: said.to_string(), held: held.to_string() })
    };
    let turns = report.driven_by == Parameter::Rotation;
    // A refined mesh is what the stage that made it reports, and the spans that asked for it are not marked any more.
    let counted = state.refined.as_ref().filter(|_| report.stage == Stage::RefineKnots).unwrap_or(&state.mesh);
    let marked = match report.stage {
        Stage::RefineKnots => report.marked,
        _ => knot_counts(&state.marked),
    };
    differs("parameter", report.parameter, state.parameter)
        .or_else(|| differs("moment_n_mm", report.moment_n_mm, state.moment_n_mm).filter(|_| turns))
        .or_else(|| differs("strain_energy_n_mm", report.strain_energy_n_mm, state.strain_energy_n_mm))
        .or_else(|| differ("negative_pivots", &report.negative_pivots, &state.negative_pivots))
        .or_else(|| differ("elements", &report.elements, &counted.elements()))
        .or_else(|| differ("marked", &report.marked, &marked))
        .or_else(|| match (report.path_length_mm, state.drive.path()) {
            (Some(said), Some(path)) => differs("path_length_mm", said, path.travelled_mm),
            (Some(said), None) => {
                Some(Disagreement { field: "path_length_mm", said: said.to_string(), held: "no path".to_owned() })
            }
            (None, _) => None,
        })
}

fn differ<T: PartialEq + std::fmt::Debug>(field: &'static str, said: &T, held: &T) -> Option<Disagreement> {
    (said != held).then(|| Disagreement { field, said: format!("{said:?}"), held: format!("{held:?}") })
}
