//! The probes of a scene on the states of a log that was written without them, or with others of the same names.

use std::fmt;
use std::ops::Range;

use crate::history::logged_scene::{LoggedSceneError, check_terms};
use crate::history::states::{RemakeError, States};
use crate::journal::{Log, Manifest};
use crate::pipeline::{StageError, Stages};
use crate::record::{Outcome, Record};
use crate::scene::{Probe, Scene, shown_values};

/// Why the probes of a scene cannot be evaluated on a log.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ProbeError {
    /// The state is not available.
    #[error(transparent)]
    State(#[from] RemakeError),
    /// The stages were run with other terms of the caller's own.
    #[error(transparent)]
    Terms(#[from] LoggedSceneError),
    /// The scene cannot be made discrete on its mesh.
    #[error("the probes cannot be read on the states of the log")]
    Stage(#[from] StageError),
}

/// Evaluates the probes of the scene of `stages` at every equilibrium of the first stages of a log, and puts the
/// readings into `records`, which holds a record for each of these stages. The log itself does not change.
///
/// # Errors
/// Where a state cannot be read, or was made with other terms of the caller's own.
pub fn read_probes(log: &Log, stages: &mut Stages, records: &mut [Record]) -> Result<(), ProbeError> {
    let mut states = States::of(log).with_terms(stages.own_terms());
    for (index, Record { report, .. }) in records.iter_mut().enumerate() {
        if report.outcome == Outcome::Done && report.stage.finds_equilibrium() {
            check_terms(log, index, stages.own_terms())?;
            report.probes = stages.read_probes(&states.at(index)?)?;
        }
    }
    Ok(())
}

/// A probe of which earlier stages of the log hold readings of something else under the same name.
#[derive(Clone, Debug, PartialEq)]
pub struct RedefinedProbe {
    /// Ordinals of the stages that were run with another one.
    pub stages: Range<u64>,
    /// The probe as it was defined there.
    pub was: Probe,
    /// What it is in the last scene of the log.
    pub is: Probe,
}

impl fmt::Display for RedefinedProbe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [was, is] = [&self.was, &self.is].map(|probe| serde_json::to_value(&probe.kind).ok());
        let [was, is] = shown_values(&was, &is);
        let Range { start, end } = self.stages;
        write!(
            f,
            "probe `{}` of stages {start} to {} is not the one of the last scene ({was} there, {is} in the end): they are not put \
             together",
            self.is.name,
            end.saturating_sub(1)
        )
    }
}

/// The probes of the last scene of a log that earlier stretches define otherwise under the same name.
pub fn redefined_probes(log: &Log) -> Vec<RedefinedProbe> {
    let [before @ .., last] = log.manifests() else { return Vec::new() };
    let probes = |manifest: &Manifest| manifest.scene(&[]).map_or_else(|_| Vec::new(), |scene: Scene| scene.probes);
    let mut found = Vec::new();
    let is_other = |manifest: &&Manifest| manifest.scene_text != last.scene_text;
    if !before.iter().any(|manifest| is_other(&manifest)) {
        return found;
    }
    let wanted = probes(last);
    let ends = log.manifests().iter().skip(1).map(|next| next.first_ordinal);
    for (manifest, end) in
        before.iter().zip(ends).filter(|(manifest, end)| manifest.first_ordinal < *end && is_other(manifest))
    {
        for was in probes(manifest) {
            let is = wanted.iter().find(|is| is.name == was.name && **is != was);
            found.extend(is.map(|is| RedefinedProbe { stages: manifest.first_ordinal..end, is: is.clone(), was }));
        }
    }
    found
}

/// Removes readings from records that were made by other probes of the same names.
pub fn remove_redefined(redefined: &[RedefinedProbe], records: &mut [Record]) {
    for Record { report, commit, .. } in records {
        let here = redefined.iter().filter(|other| other.stages.contains(&commit.ordinal));
        here.for_each(|other| report.probes.retain(|reading| reading.name != other.is.name));
    }
}
