//! Scene files, and the scenes that come with the program.

use std::io;
use std::path::{Path, PathBuf};

use super::failure::Failure;
use super::output::path_in_line;
use super::shipped::{Shipped, nearest_names};
use super::terminal::{error_columns, is_coloured};
use crate::model::ModelError;
use crate::scene::{SCENE_BYTES_LIMIT, Scene, SceneError, Stage, parse_with_settings, tables_refused};

/// A scene with the text that it came from.
pub(super) struct SceneFile {
    pub(super) scene: Scene,
    pub(super) text: String,
    /// Where it is, or would be if it did not come with the program: logs are named after it.
    pub(super) file: PathBuf,
    pub(super) written: WrittenScene,
}

/// A scene as its author wrote it, for errors that show its lines.
pub(super) struct WrittenScene {
    text: String,
    name: String,
    settings: Vec<String>,
}

impl WrittenScene {
    /// The refusal of a scene that cannot be made discrete, with the lines of the tables that it is about.
    pub(super) fn refused(&self, refusal: ModelError) -> Failure {
        let Some((kind, name)) = refusal.concerns() else { return refusal.into() };
        let Self { text, name: file, settings } = self;
        match tables_refused(text, file, settings, kind, name, &refusal.to_string()) {
            Some(error) => Failure::WrongScene { rendered: rendered(&error) },
            None => refusal.into(),
        }
    }
}

/// A text where it is, or would be if it did not come with the program.
pub(super) struct NamedText {
    pub(super) text: String,
    pub(super) file: PathBuf,
    pub(super) is_shipped: bool,
}

/// Reads and checks a scene file, with settings `section.key=value` laid over it.
pub(super) fn read_scene(path: &Path, settings: &[String]) -> Result<SceneFile, Failure> {
    let NamedText { text, file, .. } = read_named(path)?;
    if is_sweep(&text) {
        return Err(Failure::IsSweep { file: path.to_path_buf() });
    }
    let scene = checked(&text, &path_in_line(path), settings)?;
    // A log needs no other file: what is in files of their own goes into the text that the log keeps, and settings do.
    let kept = if scene.may_read_files() || !settings.is_empty() { scene.to_toml() } else { text.clone() };
    let written = WrittenScene { text, name: path_in_line(path), settings: settings.to_vec() };
    Ok(SceneFile { scene, text: kept, file, written })
}

/// Whether a text is a sweep over designs: it names a scene and what varies.
fn is_sweep(text: &str) -> bool {
    let names_scene = text.lines().any(|line| line.trim_start().starts_with("scene"));
    let is_sweep = |table: toml::Table| {
        table.contains_key("scene") && (table.contains_key("axis") || table.contains_key("scatter"))
    };
    names_scene && toml::from_str(text).is_ok_and(is_sweep)
}

/// Reads the text of a scene or a study: a file, or else what comes with the program under that name.
pub(super) fn read_named(path: &Path) -> Result<NamedText, Failure> {
    match (bytes_of(path), Shipped::named(path)) {
        (Ok(bytes), _) => {
            let text = text_of(bytes).map_err(|reason| Failure::NotText { path: path.to_path_buf(), reason })?;
            Ok(NamedText { text, file: path.to_path_buf(), is_shipped: false })
        }
        (Err(source), shipped) if source.kind() == io::ErrorKind::NotFound => match shipped {
            Some(shipped) => Ok(NamedText { text: shipped.text.to_owned(), file: shipped.file(), is_shipped: true }),
            None => Err(Failure::NoSuchSceneFile { path: path.to_path_buf(), nearest: nearest_names(path) }),
        },
        (Err(source), _) => Err(Failure::Read { path: path.to_path_buf(), source }),
    }
}

/// What a scene file holds. A pipe would hang, and a device never end.
fn bytes_of(path: &Path) -> io::Result<Vec<u8>> {
    let wrong = |problem: String| Err(io::Error::new(io::ErrorKind::InvalidInput, problem));
    let found = std::fs::metadata(path)?;
    match found.len() {
        _ if !found.is_file() => wrong("it is no regular file".to_owned()),
        bytes if bytes > SCENE_BYTES_LIMIT => {
            wrong(format!("it has {bytes} bytes, and a scene has no more than {SCENE_BYTES_LIMIT}"))
        }
        _ => std::fs::read(path),
    }
}

/// The text of a scene, without a byte-order mark; or else what the bytes are most likely, and the way out.
fn text_of(bytes: Vec<u8>) -> Result<String, String> {
    const LOG: &[u8] = b"\x89MCAP0\r\n";
    const UTF_16: [&[u8]; 2] = [b"\xff\xfe", b"\xfe\xff"];
    if bytes.starts_with(LOG) {
        return Err("it is a log; `foldline resume` continues it, `foldline inspect` shows what is in it".into());
    }
    if UTF_16.iter().any(|mark| bytes.starts_with(mark)) || bytes.iter().take(64).any(|byte| *byte == 0) {
        return Err("it is text in UTF-16, or none at all; save it as UTF-8".into());
    }
    let text = String::from_utf8(bytes).map_err(|error| {
        let (at, bytes) = (error.utf8_error().valid_up_to(), error.as_bytes());
        let line = 1 + bytes[..at].iter().filter(|byte| **byte == b'\n').count();
        format!(
            "line {line} holds the byte 0x{:02X}, which is no UTF-8 (in Latin-1 it is {:?}); save it as UTF-8",
            bytes[at],
            char::from(bytes[at])
        )
    })?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// Checks the text of a scene, with settings `section.key=value` applied to it.
pub(super) fn checked(text: &str, name: &str, settings: &[String]) -> Result<Scene, Failure> {
    let settings: Vec<&str> = settings.iter().map(String::as_str).collect();
    parse_with_settings(text, name, &settings).map_err(|error| Failure::WrongScene { rendered: rendered(&error) })
}

/// An error of a scene as the terminal shows it.
pub(super) fn rendered(error: &SceneError) -> String {
    error.fitted(is_coloured(&io::stderr()), error_columns())
}

/// A stage by its name.
pub(super) fn stage_named(name: &str) -> Result<Stage, String> {
    let known = || Stage::ALL.map(Stage::name).join(", ");
    Stage::ALL.into_iter().find(|stage| stage.name() == name).ok_or_else(|| format!("the stages are {}", known()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_no_text_is_named() {
        let reason = |bytes: &[u8]| text_of(bytes.to_vec()).unwrap_err();
        assert!(reason(b"\x89MCAP0\r\nrest").contains("it is a log"));
        assert!(reason(b"\xff\xfe[\0g\0").contains("UTF-16"));
        assert!(reason(b"[\0g\0e\0").contains("UTF-16"));
        let latin = reason(b"[geometry]\n# L\xe4nge\n");
        assert!(latin.contains("line 2") && latin.contains("0xE4") && latin.contains('ä'), "{latin}");
        assert_eq!(text_of(b"\xef\xbb\xbf[geometry]".to_vec()), Ok("[geometry]".into()));
    }
}
