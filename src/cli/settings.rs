//! What a user sets once for all commands, none of which changes a result: by the environment, or in a file `foldline.toml` in the
//! current folder or the nearest one above it. An argument wins over the environment, and that over the file.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::failure::Failure;
use crate::scene::SyncPolicy;

/// For `--help`.
pub(super) const SETTINGS: &str = "\
Set once for all commands, and without effect on any result:
  FOLDLINE_LOGS     or `logs` in foldline.toml: folder for logs [default: checkpoints]
  FOLDLINE_THREADS  or `threads`: threads [default: one for each core]
  FOLDLINE_SYNC     or `sync`: when logs are forced to disk, as the scene's key
An argument wins over the environment, and that over foldline.toml, which is
looked for in the current folder and those above it.";

const FILE: &str = "foldline.toml";

/// What is set.
#[derive(Clone, Debug, Default, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Settings {
    /// Folder for logs.
    pub(super) logs: Option<PathBuf>,
    /// Threads.
    pub(super) threads: Option<u16>,
    /// When logs are forced to disk.
    pub(super) sync: Option<SyncPolicy>,
}

impl Settings {
    /// Reads the environment, and the file for what it leaves open.
    pub(super) fn read() -> Result<Self, Failure> {
        let folder = std::env::current_dir().unwrap_or_default();
        let file = match folder.ancestors().map(|folder| folder.join(FILE)).find(|file| file.is_file()) {
            Some(file) => Self::of_file(&file)?,
            None => Self::default(),
        };
        let set = |name: &str| std::env::var(name).ok().filter(|value| !value.is_empty());
        let wrong = |name: &str, value: &str, wanted: &str| Failure::WrongSetting {
            place: name.to_owned(),
            reason: format!("{value:?}, where {wanted}"),
        };
        let threads = match set("FOLDLINE_THREADS") {
            None => None,
            Some(value) => {
                let threads = value.parse::<u16>().ok().filter(|threads| (1..=1024).contains(threads));
                Some(threads.ok_or_else(|| wrong("FOLDLINE_THREADS", &value, "a number from 1 to 1024 is wanted"))?)
            }
        };
        let sync = match set("FOLDLINE_SYNC") {
            None => None,
            Some(value) => {
                let sync = SyncPolicy::deserialize(toml::Value::from(value.clone())).ok();
                let words = "each-stage, each-second or at-end is wanted";
                Some(sync.ok_or_else(|| wrong("FOLDLINE_SYNC", &value, words))?)
            }
        };
        Ok(Self {
            logs: set("FOLDLINE_LOGS").map(PathBuf::from).or(file.logs),
            threads: threads.or(file.threads),
            sync: sync.or(file.sync),
        })
    }

    fn of_file(file: &Path) -> Result<Self, Failure> {
        let wrong = |reason: String| Failure::WrongSetting { place: file.display().to_string(), reason };
        let text = std::fs::read_to_string(file).map_err(|error| wrong(error.to_string()))?;
        let settings: Self = toml::from_str(&text).map_err(|error| {
            wrong(format!(
                "{}; it holds `logs`, `threads` and `sync`, and nothing that could change a result",
                error.to_string().trim_end()
            ))
        })?;
        if settings.threads.is_some_and(|threads| !(1..=1024).contains(&threads)) {
            return Err(wrong("`threads` is a number from 1 to 1024".to_owned()));
        }
        // As seen from the file.
        let logs = settings.logs.map(|logs| file.parent().map_or(logs.clone(), |folder| folder.join(&logs)));
        Ok(Self { logs, ..settings })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_sets_what_changes_no_result() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join(FILE);
        std::fs::write(&file, "logs = \"runs\"\nthreads = 2\nsync = \"at-end\"\n").unwrap();
        let expected =
            Settings { logs: Some(folder.path().join("runs")), threads: Some(2), sync: Some(SyncPolicy::AtEnd) };
        assert_eq!(Settings::of_file(&file).unwrap(), expected);
        for (text, words) in [
            ("tolerance = 0.1\n", "nothing that could change a result"),
            ("threads = 0\n", "from 1 to 1024"),
            ("sync = \"never\"\n", "each-stage"),
        ] {
            std::fs::write(&file, text).unwrap();
            let error = Settings::of_file(&file).unwrap_err().to_string();
            assert!(error.contains(words) && error.contains("foldline.toml"), "{error}");
        }
    }
}
