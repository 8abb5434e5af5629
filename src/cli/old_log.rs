//! A log that is where a run would write its own: what it is of, and the ways on.

use std::fmt::Write as _;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use super::asked::Asked;
use super::failure::Failure;
use super::output::path_in_command;
use crate::journal::{Completeness, LogLock};
use crate::printable::word;
use crate::scene::Scene;
use crate::units::count;
use crate::whole_file::beside as with_suffix;

/// Differences of scenes that are listed.
const MOST_LISTED: usize = 12;

/// Says what a log holds beside what a run of `scene` from `file`, with settings laid over it, would write, and how to go on;
/// `None` where it is no log.
pub(super) fn beside(log: &Path, scene: &Scene, file: &Path, settings: &[String]) -> Option<String> {
    let asked = Asked::open(log).ok()?;
    let (end, stages) = (asked.log.end(), count(asked.log.commits(), "stage"));
    let differences = asked.scene.differences(scene);
    let finished = end.completeness() == Completeness::Finished;
    let set: String = settings.iter().map(|setting| format!(" --set {}", word(setting))).collect();
    let (log, file) = (path_in_command(log), format!("{}{set}", path_in_command(file)));
    let mut text = match (&differences[..], finished) {
        ([], true) => format!("it holds all {stages} of a finished run of this very scene"),
        ([], false) => format!("it holds {stages} of this very scene, not finished"),
        (_, _) => format!("it holds {stages} of a scene that differs:"),
    };
    for difference in differences.iter().take(MOST_LISTED) {
        let [was, is] = difference.values();
        let _ = write!(text, "\n    {}: there {was}, here {is}", difference.path);
    }
    if differences.len() > MOST_LISTED {
        let _ = write!(text, "\n    and {} more", differences.len() - MOST_LISTED);
    }
    let mut ways: Vec<(&str, String)> = Vec::new();
    match (differences.is_empty(), finished) {
        (true, true) => ways.push(("look at it", format!("foldline inspect {log}"))),
        (true, false) => ways.push(("continue it", format!("foldline resume {log}"))),
        (false, _) => {
            ways.push(("go on from the stages that are valid for it", format!("foldline run {file} -o {log} --resume")))
        }
    }
    ways.push(("write another log", format!("foldline run {file} -o OTHER.mcap")));
    ways.push(("start again and keep the old log aside", format!("foldline run {file} -o {log} --force")));
    for (what, command) in ways {
        let _ = write!(text, "\n  {what}:\n    {command}");
    }
    Some(text)
}

/// Moves a log, and the index beside it, to a name that nothing has, and gives that back. A log that another process writes is left
/// where it is.
pub(super) fn put_aside(log: &Path) -> Result<PathBuf, Failure> {
    let _lock = LogLock::take(log).map_err(|source| Failure::CannotStart { source: Box::new(source) })?;
    let failed = |source| Failure::Write { path: log.to_path_buf(), source };
    for number in 1_u32.. {
        let aside = log.with_extension(format!("{number}.mcap"));
        match moved(log, &aside) {
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            moved => {
                moved.map_err(failed)?;
                // Only a cache, and not there for a short log: without it the log is read.
                let _ = self::moved(&with_suffix(log, ".index"), &with_suffix(&aside, ".index"));
                return Ok(aside);
            }
        }
    }
    Err(failed(io::ErrorKind::AlreadyExists.into()))
}

/// Gives a file another name, over no other file.
fn moved(from: &Path, to: &Path) -> io::Result<()> {
    match fs::hard_link(from, to) {
        Ok(()) => fs::remove_file(from),
        // A file system that has one name for each file.
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists && to.symlink_metadata().is_err() => {
            fs::rename(from, to)
        }
        Err(error) => Err(error),
    }
}
