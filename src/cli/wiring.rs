//! Where the command line meets the rest of the program: every call to the scene parser, the log, the run loop and the
//! spline surface stands here, one small function each.

use std::path::{Path, PathBuf};

use super::failure::Failure;
use super::progress::Manner;
use crate::pipeline::Record;
use crate::scene::Scene;
use crate::view::SurfaceSamples;

/// A log as far as it can be trusted.
pub(super) struct ReadLog {
    /// The scene that the log was written for.
    pub(super) scene: Scene,
    /// Every stage whose hashes hold.
    pub(super) records: Vec<Record>,
    /// Whether the run came to its end.
    pub(super) finished: bool,
    /// What was lost or left out, a line each.
    pub(super) warnings: Vec<String>,
}

/// What a run is given beside its scene; none of it changes a state, except where the run stops.
pub(super) struct RunOptions {
    /// Where the log goes.
    pub(super) log: PathBuf,
    /// Threads of the assembly; `None` takes one for each core.
    pub(super) threads: Option<usize>,
    /// Rotation at which the run stops early, degrees.
    pub(super) until_deg: Option<f64>,
    /// How the run is shown.
    pub(super) manner: Manner,
}

/// Reads and checks a scene file.
pub(super) fn read_scene(path: &Path) -> Result<Scene, Failure> {
    let _text = std::fs::read_to_string(path).map_err(|source| Failure::Read { path: path.to_path_buf(), source })?;
    // scene::parse(&text, &path.display().to_string()), its error rendered into Failure::WrongScene
    Err(Failure::NotYetWired { what: "reading scenes" })
}

/// Runs a scene from its start into a new log, shown in the manner asked for. Gives back every stage.
pub(super) fn run(_scene: &Scene, options: &RunOptions) -> Result<Vec<Record>, Failure> {
    // let mut sink = Shown::new(JournalWriter::create(&options.log, scene)?, options.manner, scene, 0.0);
    // run the loop; afterwards `let (journal, records) = sink.finish()`, whatever the loop said
    let _ = (&options.log, options.threads, options.until_deg, options.manner);
    Err(Failure::NotYetWired { what: "running scenes" })
}

/// Reads a log.
pub(super) fn read_log(path: &Path) -> Result<ReadLog, Failure> {
    let _bytes = std::fs::metadata(path).map_err(|source| Failure::Read { path: path.to_path_buf(), source })?;
    Err(Failure::NotYetWired { what: "reading logs" })
}

/// Samples the deformed surface, the whole shell, in the state that `record` made.
pub(super) fn surface(_log: &Path, _scene: &Scene, _record: &Record) -> Result<SurfaceSamples, Failure> {
    // the state of `record.commit.ordinal`, its hash checked, into
    // Ok(view::deformed_surface(scene, &state.mesh, &state.displacement, 4)?)
    Err(Failure::NotYetWired { what: "sampling the deformed surface" })
}

/// Help on the keys of a scene file.
pub(super) fn scene_help() -> Result<String, Failure> {
    // Ok(scene::help_text())
    Err(Failure::NotYetWired { what: "help on scenes" })
}
