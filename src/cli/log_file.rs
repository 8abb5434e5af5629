//! Logs, as the commands that read them see them.

use std::path::Path;

use super::failure::Failure;
use super::output::{eprint, path_in_line};
use super::scene_file::rendered;
use crate::history::{LoggedSceneError, logged_scene, read_probes, redefined_probes};
use crate::journal::{
    Completeness, Log, LongLog, LongLogError, Manifest, Portion, Portions, ReadError, SceneInLogError,
};
use crate::pipeline::Stages;
use crate::record::Record;
use crate::scene::{Reach, Scene};
use crate::units::count;

/// A log as far as it can be trusted, with the scene that its last stretch was run with.
pub(super) struct ReadLog {
    pub(super) log: Log,
    pub(super) scene: Scene,
    /// Whether that one is lost, and this is the last one that is not.
    pub(super) scene_is_older: bool,
}

impl ReadLog {
    /// Every stage whose hashes hold, as it is in the log.
    pub(super) fn records(&self) -> Vec<Record> {
        self.log.entries().iter().map(|entry| entry.record.clone()).collect()
    }

    /// The same with the readings of the probes of [`Self::scene`] alone; those that the log lacks are made.
    pub(super) fn records_of_scene(&self, path: &Path) -> Result<Vec<Record>, Failure> {
        let mut records = self.records();
        read_probes(&self.log, &mut Stages::new(self.scene.clone()), &mut records)
            .map_err(|source| Failure::WrongLog { log: path.to_path_buf(), source: Box::new(source) })?;
        Ok(records)
    }

    /// This log with every stage in memory, where only the last ones are.
    pub(super) fn whole(self, path: &Path) -> Result<Self, Failure> {
        match self.log.first() {
            0 => Ok(self),
            _ => Ok(Self { log: Log::read(path).map_err(unreadable(path))?, ..self }),
        }
    }

    /// Where what steps are made with changed: a line for each setting, without which all would seem to be of one kind.
    pub(super) fn mixed(&self) -> String {
        let mut text = String::new();
        for (ordinal, differences) in self.log.scene_changes() {
            for difference in differences.iter().filter(|difference| difference.reach == Reach::Steps) {
                let [was, is] = difference.values();
                text.push_str(&format!("mixed: {} is {is} from stage {ordinal} on, and was {was}\n", difference.path));
            }
        }
        text
    }

    /// What is shown as the scene's where that is lost: a line that says so.
    pub(super) fn older_scene(&self) -> Option<String> {
        older_scene(&self.log, self.scene_is_older)
    }

    /// Whether the run came to its end.
    pub(super) fn is_finished(&self) -> bool {
        self.log.completeness() == Completeness::Finished
    }

    /// What was lost of a log, a line each.
    pub(super) fn warnings_of(log: &Log) -> Vec<String> {
        let mut warnings: Vec<String> =
            log.notes().iter().map(|note| format!("at byte {}: {}", note.at, note.text)).collect();
        warnings.extend(log.missed_manifests().map(|lost| log.lost_in_words(lost)));
        warnings.extend(log.lost_pictures());
        warnings.extend(redefined_probes(log).iter().map(ToString::to_string));
        let own = log.manifests().iter().rfind(|manifest| !manifest.own_terms.is_empty());
        warnings.extend(own.map(|manifest| {
            let names: Vec<&str> = manifest.own_terms.iter().map(|(name, _)| &name[..]).collect();
            format!("made with terms of its program's own ({}), which are not part of its scene", names.join(", "))
        }));
        let bytes = |number: u64| count(number as usize, "byte");
        match log.completeness() {
            Completeness::Finished | Completeness::Unfinished => {}
            Completeness::Truncated { at, dropped } => warnings.push(format!(
                "cut off: good up to byte {at}; {} beyond, part of a stage, not used", bytes(dropped)
            )),
            Completeness::Damaged { at, dropped, later_commits } => warnings.push(format!(
                "damaged at byte {at}: {} beyond not used, with {} behind what is lost; `foldline verify` reports more, and `foldline \
                 recover --remake` may run again what is lost",
                bytes(dropped),
                count(later_commits as usize, "whole stage")
            )),
        }
        warnings
    }
}

/// The stages of a run for tables, curves and summaries: of the probes of each the first and those that are wanted, but all of the
/// last ones.
#[derive(Default)]
pub(super) struct Gathered {
    pub(super) records: Vec<Record>,
    /// Names of the wanted probes.
    wanted: Vec<String>,
    /// The last record that has probes.
    probed: Option<usize>,
}

impl Gathered {
    /// Of the probes of each stage, those with these names are wanted too.
    pub(super) fn with_probes(wanted: Vec<String>) -> Self {
        Self { wanted, ..Self::default() }
    }

    /// Takes the stages that follow.
    pub(super) fn take(&mut self, portion: &Portion) {
        for entry in portion.entries() {
            if !entry.record.report.probes.is_empty()
                && let Some(before) = self.probed.replace(self.records.len())
            {
                let probes = &mut self.records[before].report.probes;
                let mut is_first = true;
                probes.retain(|reading| std::mem::take(&mut is_first) || self.wanted.contains(&reading.name));
                probes.shrink_to_fit();
            }
            self.records.push(entry.record.clone());
        }
    }
}

pub(super) fn first_and_last<'r>(records: impl Iterator<Item = &'r Record> + Clone) -> Option<(u64, u64)> {
    let steps = records.map(|record| record.report.step);
    steps.clone().min().zip(steps.max())
}

/// Asks a long log, of which only the end is read, and reports what is lost of that; `None` for one that is read whole. Where the
/// index turns out not to fit, the log is read through and asked again.
pub(super) fn ask_long<T>(
    path: &Path,
    ask: impl Fn(&LongLog) -> Result<T, LongLogError>,
) -> Result<Option<T>, Failure> {
    let unreadable = |source| Failure::Read { path: path.to_path_buf(), source };
    let Some(long) = LongLog::open(path).map_err(unreadable)? else { return Ok(None) };
    say_warnings(long.tail(), path);
    if let Ok(answer) = ask(&long) {
        return Ok(Some(answer));
    }
    let Some(long) = LongLog::read_through(path).map_err(unreadable)? else { return Ok(None) };
    let wrong = |source| Failure::WrongLog { log: path.to_path_buf(), source: Box::new(source) };
    ask(&long).map(Some).map_err(wrong)
}

/// Reads a log and the scene of its last stretch, and reports what of it is lost; where that is lost, an earlier one
/// serves to show what is there.
pub(super) fn read_log(path: &Path) -> Result<ReadLog, Failure> {
    with_scene(Log::read(path).map_err(unreadable(path))?, path)
}

/// The same for what is read of a log of any length from front to back: shows it to `see` portion by portion, and gives back its end.
pub(super) fn read_through(path: &Path, mut see: impl FnMut(&Portion)) -> Result<ReadLog, Failure> {
    let mut portions = Portions::of(path).map_err(unreadable(path))?;
    loop {
        let portion = portions.read().map_err(unreadable(path))?;
        see(&portion);
        if let Some(log) = portion.into_end() {
            return with_scene(log, path);
        }
    }
}

pub(super) fn unreadable(path: &Path) -> impl Fn(ReadError) -> Failure {
    |error| match error {
        ReadError::Io { source, .. } => Failure::Read { path: path.to_path_buf(), source },
        error => Failure::WrongLog { log: path.to_path_buf(), source: Box::new(error) },
    }
}

fn with_scene(log: Log, path: &Path) -> Result<ReadLog, Failure> {
    let (scene, scene_is_older) = end_scene(&log, path)?;
    say_warnings(&log, path);
    Ok(ReadLog { log, scene, scene_is_older })
}

/// The scene of a log's last stretch, or where that is lost an earlier one, and whether it is that.
pub(super) fn end_scene(log: &Log, path: &Path) -> Result<(Scene, bool), Failure> {
    match (scene_of(log, path), log.manifests().last()) {
        (_, Some(manifest)) if !manifest.own_terms.is_empty() => Ok((scene_in(manifest, path, &[])?, false)),
        (Err(Failure::SceneLost { .. }), Some(manifest)) => Ok((scene_in(manifest, path, &[])?, true)),
        (scene, _) => Ok((scene?, false)),
    }
}

/// Reports what of a log is lost.
pub(super) fn say_warnings(log: &Log, path: &Path) {
    for warning in ReadLog::warnings_of(log) {
        eprint(&format!("warning: {}: {warning}", path_in_line(path)));
    }
}

/// What is shown as the scene's where that is lost (`is_older`): a line that says so.
pub(super) fn older_scene(log: &Log, is_older: bool) -> Option<String> {
    let lost = log.lost_manifests().last().filter(|_| is_older)?;
    Some(format!(
        "what the run was to compute from stage {} on is lost: its target, settings and probes are not known, and those below are \
         of the scene before",
        lost.ordinal
    ))
}

/// The scene that the log was last continued with.
pub(super) fn scene_of(log: &Log, path: &Path) -> Result<Scene, Failure> {
    let stages = log.commits();
    if log.last_manifest_is_lost() {
        return Err(Failure::SceneLost { log: path.to_path_buf(), ordinal: stages.saturating_sub(1) });
    }
    match (log.manifests().last(), stages.checked_sub(1)) {
        (None, None) => Err(Failure::NoScene { log: path.to_path_buf() }),
        // A stretch that has no stage yet.
        (Some(manifest), _) if manifest.first_ordinal == stages as u64 => scene_in(manifest, path, &[]),
        (_, last) => scene_at(log, path, last.unwrap_or(0), &[]),
    }
}

/// The scene that stage `index` was run with, with settings applied to it.
pub(super) fn scene_at(log: &Log, path: &Path, index: usize, settings: &[String]) -> Result<Scene, Failure> {
    logged_scene(log, index, settings, &[]).map_err(|error| match error {
        LoggedSceneError::Lost { ordinal } => Failure::SceneLost { log: path.to_path_buf(), ordinal },
        LoggedSceneError::Unreadable(error) => unreadable_scene(error, path),
        error => Failure::WrongLog { log: path.to_path_buf(), source: Box::new(error) },
    })
}

/// Reports which stretches of a log another revision of the numerics or another kind of kernel wrote than this one: what they
/// give now may differ in its last bits.
pub(super) fn say_other_numerics(log: &Log) {
    let here = Manifest::here(Path::new(""), "", 0);
    for manifest in log.manifests() {
        if let Some(otherwise) = here.rounds_otherwise(manifest) {
            eprint(&format!("stages from {} on: {otherwise}", manifest.first_ordinal));
        }
    }
}

fn scene_in(manifest: &Manifest, path: &Path, settings: &[String]) -> Result<Scene, Failure> {
    manifest.scene(settings).map_err(|error| unreadable_scene(error, path))
}

fn unreadable_scene(error: SceneInLogError, path: &Path) -> Failure {
    match error {
        SceneInLogError::Wrong(error) => Failure::WrongScene { rendered: rendered(&error) },
        source => Failure::WrongLog { log: path.to_path_buf(), source: Box::new(source) },
    }
}
