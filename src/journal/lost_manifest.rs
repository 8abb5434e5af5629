//! What is not known of a log for the loss of a manifest.

use super::log::{Entry, Log};
use super::manifest::Manifest;
use super::stretch::LostManifest;
use crate::state::Hash;

impl Log {
    /// The stages of a lost manifest for which no later scene makes the same states, as far as they were read.
    pub fn stages_without_scene(&self, lost: &LostManifest) -> Vec<&Entry> {
        let behind = &self.manifests()[lost.before..];
        let end = behind.first().map_or(self.commits() as u64, |next| next.first_ordinal);
        let known: Vec<Hash> = behind.iter().filter_map(Manifest::run_hash).collect();
        let made = (lost.ordinal..end).filter_map(|ordinal| self.entry(ordinal as usize));
        made.filter(|entry| !known.contains(&entry.record.commit.scene_hash)).collect()
    }

    /// Describes what is not known because a manifest is lost, and the way out.
    pub fn lost_in_words(&self, lost: &LostManifest) -> String {
        let LostManifest { at, ordinal, .. } = lost;
        let what = match stages_in_words(&self.stages_without_scene(lost)) {
            Some(stages) => format!("the scene of {stages}"),
            None => format!("what the run was to compute from stage {ordinal} on"),
        };
        format!(
            "the manifest at byte {at} is lost, and with it {what}: no other scene takes its place. `foldline run SCENE -o LOG --resume` \
             with that scene's file brings it back"
        )
    }
}

/// Names the first and the last of some stages, and their load steps; `None` where there is none.
pub fn stages_in_words(stages: &[&Entry]) -> Option<String> {
    let [first, last] = [stages.first()?, stages.last()?].map(|entry| &entry.record.commit);
    Some(match first.ordinal == last.ordinal {
        true => format!("stage {} (load step {})", first.ordinal, first.step),
        false => format!("stages {} to {} (load steps {} to {})", first.ordinal, last.ordinal, first.step, last.step),
    })
}
