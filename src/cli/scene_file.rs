//! Scene files.

use std::io::IsTerminal;
use std::path::Path;

use super::failure::Failure;
use crate::scene::{Geometry, Scene, SceneError, Stage, parse_with_settings};

/// A scene with the text that it came from.
pub(super) struct SceneFile {
    pub(super) scene: Scene,
    pub(super) text: String,
}

/// Reads and checks a scene file.
pub(super) fn read_scene(path: &Path) -> Result<SceneFile, Failure> {
    let text = std::fs::read_to_string(path).map_err(|source| Failure::Read { path: path.to_path_buf(), source })?;
    let scene = checked(&text, &path.display().to_string(), &[])?;
    // A log stands for itself: a surface from a file of its own goes into the text that the log keeps.
    let text = match scene.geometry {
        Geometry::Nurbs(_) => scene.to_toml(),
        _ => text,
    };
    Ok(SceneFile { scene, text })
}

/// Checks the text of a scene, with settings `section.key=value` laid over it.
pub(super) fn checked(text: &str, name: &str, settings: &[String]) -> Result<Scene, Failure> {
    let settings: Vec<&str> = settings.iter().map(String::as_str).collect();
    parse_with_settings(text, name, &settings).map_err(|error| Failure::WrongScene { rendered: rendered(&error) })
}

fn rendered(error: &SceneError) -> String {
    if std::io::stderr().is_terminal() { error.coloured() } else { error.plain() }
}

/// A stage by its name.
pub(super) fn stage_named(name: &str) -> Result<Stage, String> {
    let known = || Stage::ALL.map(Stage::name).join(", ");
    Stage::ALL.into_iter().find(|stage| stage.name() == name).ok_or_else(|| format!("the stages are {}", known()))
}
