//! The scene that a stage of a log was run with.

use crate::journal::{Log, SceneInLogError};
use crate::scene::Scene;

/// Defaults as they once were, for scenes in logs of that time that leave them out: any of them, as not all changed at once.
/// Laid over any other scene they would change its hash, which the log holds.
const DEFAULTS_BEFORE: [&str; 3] =
    ["mesh.quadrature=patch", "mesh.quadrature=full", "adapt.length_limit=sqrt-radius-thickness"];

/// Why the scene of a stage cannot be had.
#[derive(Debug, thiserror::Error)]
pub enum LoggedSceneError {
    /// No manifest has a scene that hashes as the stage's commit says.
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
         neither goes on with it nor runs its stages again"
    )]
    OwnTerms {
        /// Ordinal of the stage.
        ordinal: usize,
        /// Names of the terms.
        names: String,
    },
    /// It does not read with the settings.
    #[error(transparent)]
    Unreadable(#[from] SceneInLogError),
}

/// The scene that stage `index` was run with, with settings laid over it: that of its stretch, and held against the
/// hash in its commit, so that no other takes its place where it is lost.
///
/// # Errors
/// Where it is lost, does not read with the settings, or does not decide the states alone.
pub fn logged_scene(log: &Log, index: usize, settings: &[String]) -> Result<Scene, LoggedSceneError> {
    let lost = LoggedSceneError::Lost { ordinal: index };
    let Some(entry) = log.entry(index) else { return Err(lost) };
    let expected = entry.record.commit.scene_hash;
    for manifest in log.manifests_of(index) {
        if !manifest.own_terms.is_empty() {
            let names: Vec<&str> = manifest.own_terms.iter().map(|(name, _)| &name[..]).collect();
            return Err(LoggedSceneError::OwnTerms { ordinal: index, names: names.join(", ") });
        }
        for chosen in 0..1 << DEFAULTS_BEFORE.len() {
            let is_chosen = |index: usize| chosen >> index & 1 == 1;
            let defaults = DEFAULTS_BEFORE.iter().enumerate().filter(|(index, _)| is_chosen(*index));
            let as_then: Vec<String> = defaults.map(|(_, default)| default.to_string()).collect();
            if manifest.scene(&as_then).is_ok_and(|scene| scene.hash() == expected) {
                return Ok(manifest.scene(&[&as_then[..], settings].concat())?);
            }
        }
    }
    Err(lost)
}
