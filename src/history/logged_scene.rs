//! The scene that a stage of a log was run with.

use std::sync::Arc;

use crate::energy::TermSource;
use crate::journal::{Log, SceneInLogError};
use crate::record::run_hash;
use crate::scene::Scene;
use crate::state::Hash;

/// Defaults as they once were, for scenes in logs of that time that leave them out: any of them, as not all changed at once.
/// Applied to any other scene they would change its hash, which the log holds.
const DEFAULTS_BEFORE: [&str; 3] =
    ["mesh.quadrature=patch", "mesh.quadrature=full", "adapt.length_limit=sqrt-radius-thickness"];

/// Why the scene that a stage was run with is not available.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LoggedSceneError {
    /// No manifest has a scene with the hash in the stage's commit.
    #[error(
        "the scene that stage {ordinal} was run with is lost; `foldline run SCENE -o LOG --resume` with that scene's file brings it back"
    )]
    Lost {
        /// Ordinal of the stage.
        ordinal: usize,
    },
    /// The run had energies or loads that are not part of a scene.
    #[error(
        "stage {ordinal} was run with terms of its program's own ({names}), which this one does not have: it shows such a log, and \
         neither continues it nor runs its stages again"
    )]
    OwnTerms {
        /// Ordinal of the stage.
        ordinal: usize,
        /// Names of the terms.
        names: String,
    },
    /// The run had the same terms with other parameters, fewer, or in another order.
    #[error(
        "stage {ordinal} was run with other terms of its program's own: {differences}; give those that it was run with"
    )]
    OtherTerms {
        /// Ordinal of the stage.
        ordinal: usize,
        /// What differs, in words.
        differences: String,
    },
    /// It does not read with the settings.
    #[error(transparent)]
    Unreadable(#[from] SceneInLogError),
}

/// Returns the scene that stage `index` was run with, `settings` applied to it. Scene and terms of the caller's own are
/// compared with the hash in the stage's commit, so that no other scene takes the place of one that is lost.
///
/// # Errors
/// Where it is lost, does not read with the settings, or was run with other terms.
pub fn logged_scene(
    log: &Log,
    index: usize,
    settings: &[String],
    own: &[Arc<dyn TermSource>],
) -> Result<Scene, LoggedSceneError> {
    let lost = LoggedSceneError::Lost { ordinal: index };
    let Some(entry) = log.entry(index) else { return Err(lost) };
    let expected = entry.record.commit.scene_hash;
    check_terms(log, index, own)?;
    let terms: Vec<(&str, Hash)> = own.iter().map(|source| (source.name(), source.hash())).collect();
    for manifest in log.manifests_of(index) {
        for chosen in 0..1 << DEFAULTS_BEFORE.len() {
            let is_chosen = |index: usize| chosen >> index & 1 == 1;
            let defaults = DEFAULTS_BEFORE.iter().enumerate().filter(|(index, _)| is_chosen(*index));
            let as_then: Vec<String> = defaults.map(|(_, default)| default.to_string()).collect();
            if manifest.scene(&as_then).is_ok_and(|scene| run_hash(&scene, &terms) == expected) {
                return Ok(manifest.scene(&[&as_then[..], settings].concat())?);
            }
        }
    }
    Err(lost)
}

/// Refuses terms of the caller's own that are not those that stage `index` was run with, by name, hash and order.
///
/// # Errors
/// Which differ, and how.
pub(super) fn check_terms(log: &Log, index: usize, own: &[Arc<dyn TermSource>]) -> Result<(), LoggedSceneError> {
    let here: Vec<(String, String)> =
        own.iter().map(|source| (source.name().to_owned(), source.hash().to_string())).collect();
    let Some(logged) = log.manifests_of(index).map(|manifest| &manifest.own_terms).find(|terms| **terms != here) else {
        return Ok(());
    };
    let of_name = |terms: &[(String, String)], name: &str| terms.iter().find(|(known, _)| known == name).cloned();
    let missing = logged.iter().filter(|(name, _)| of_name(&here, name).is_none());
    let names: Vec<&str> = missing.map(|(name, _)| &name[..]).collect();
    if !names.is_empty() {
        return Err(LoggedSceneError::OwnTerms { ordinal: index, names: names.join(", ") });
    }
    let differences = here.iter().filter_map(|term| match of_name(logged, &term.0) {
        None => Some(format!("\"{}\" was not there", term.0)),
        Some(known) => (known != *term).then(|| format!("\"{}\" had other parameters", term.0)),
    });
    let mut differences: Vec<String> = differences.collect();
    if differences.is_empty() {
        differences.push("they were in another order".to_owned());
    }
    Err(LoggedSceneError::OtherTerms { ordinal: index, differences: differences.join(", ") })
}
