//! Runs that a study or a sweep needs, each in a log of its own that is named after what decides its results
//! ([`Scene::results_hash`]): what is done is not done again.
//!
//! A run whose time counts has a record of that beside its log, since time is no function of a scene: it is kept only for the
//! same machine, number of threads, version and numerics of the program (where its speed is worked on, a folder of its own for each
//! build keeps times of one build together). Where it was interrupted it starts again, as its time would mean nothing; a run
//! that others are compared with continues where it stopped.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::history::{BasisError, basis};
use crate::journal::{
    Completeness, JournalWriter, LockError, Log, Manifest, ReadError, Resume, ResumeError, WriteError, host,
};
use crate::model::ModelError;
use crate::pipeline::{Ending, Run, RunError, Stages};
use crate::record::{NUMERICS_REVISION, Record, Sink, SinkError};
use crate::scene::{Scene, SyncPolicy};
use crate::state::State;
use crate::whole_file::WholeFile;

/// Digits of a hash in the name of a log.
const DIGITS: usize = 16;

/// The name of a run of a scene among others: the first digits of what decides its results, in hexadecimal.
pub fn run_name(scene: &Scene) -> String {
    short_name(scene.results_hash())
}

/// A name by the first digits of a hash.
pub(crate) fn short_name(hash: blake3::Hash) -> String {
    hash.to_hex()[..DIGITS].to_owned()
}

/// A folder with the logs of finished and interrupted runs.
#[derive(Clone, Debug)]
pub struct Archive {
    folder: PathBuf,
    threads: usize,
}

/// What a run is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Others are compared with its results.
    Results,
    /// Its time counts, too.
    Time,
}

/// A finished run.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct Done {
    /// What every stage reported.
    pub records: Vec<Record>,
    /// Wall time with the log written, seconds; where it does not count, that of the stages.
    pub wall_s: f64,
}

/// The time that a run took.
#[derive(Debug, Serialize, Deserialize)]
struct TimeTaken {
    wall_s: f64,
    threads: usize,
    program_version: String,
    numerics: u32,
    host: String,
}

/// Why a run of a study is not done.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TaskError {
    /// The scene cannot be made discrete.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The run stopped.
    #[error("the run stopped; its log {} keeps what was done", log.display())]
    Run {
        /// Its log.
        log: PathBuf,
        /// Why it stopped.
        source: Box<RunError>,
    },
    /// The program panicked, which is a fault of its own.
    #[error("the program panicked, which is a fault of its own: {message}")]
    Panicked {
        /// What it said.
        message: String,
    },
    /// The plan of a sweep is half written.
    #[error(
        "the task {key} is not of the scene that the folder holds: plan again with `foldline sweep run SWEEP.toml`"
    )]
    OtherPlan {
        /// Key of the task.
        key: String,
    },
    /// The caller asked to stop.
    #[error("interrupted")]
    Interrupted,
    /// The log cannot be read or continued.
    #[error("the log {} cannot be used; where it may go, remove it", log.display())]
    Resume {
        /// The log.
        log: PathBuf,
        /// Why.
        source: Box<ResumeError>,
    },
    /// The log cannot be written.
    #[error(transparent)]
    Write(#[from] Box<WriteError>),
    /// The last state of a log cannot be used.
    #[error("the log {} cannot be continued; where it may go, remove it", log.display())]
    Basis {
        /// The log.
        log: PathBuf,
        /// Why.
        source: BasisError,
    },
    /// The log is of another scene.
    #[error("{} is the log of another scene than its name says: move it elsewhere", log.display())]
    OtherScene {
        /// The log.
        log: PathBuf,
    },
    /// The folder or the record of a time cannot be written, or an old log not be removed.
    #[error("cannot write {}", path.display())]
    Io {
        /// What was to be written.
        path: PathBuf,
        /// Why it was not.
        source: io::Error,
    },
}

impl TaskError {
    /// Whether another process writes the log: it may be done, or gone, a little later.
    pub fn is_of_other_writer(&self) -> bool {
        let is_held = |lock: &LockError| matches!(lock, LockError::Busy { .. } | LockError::Leased { .. });
        match self {
            TaskError::Resume { source, .. } => matches!(&**source, ResumeError::Lock(lock) if is_held(lock)),
            TaskError::Write(source) => match &**source {
                WriteError::Lock(lock) => is_held(lock),
                // It came to be since it was looked for.
                WriteError::Exists { .. } => true,
                _ => false,
            },
            _ => false,
        }
    }

    /// Whether the scene is the cause, so that the task ends the same wherever it is done again; else the machine or the caller is.
    pub fn is_of_scene(&self) -> bool {
        match self {
            TaskError::Model(_) | TaskError::Panicked { .. } => true,
            TaskError::Run { source, .. } => matches!(**source, RunError::Stage(_)),
            _ => false,
        }
    }
}

/// Writes a log, and keeps what was reported.
struct Logged {
    writer: JournalWriter,
    records: Vec<Record>,
}

impl Sink for Logged {
    fn take(&mut self, state: &State, record: &Record) -> Result<(), SinkError> {
        self.writer.take(state, record)?;
        self.records.push(record.clone());
        Ok(())
    }
}

impl Archive {
    /// Opens a folder, which is made if it is not there; runs take so many threads.
    ///
    /// # Errors
    /// Where it cannot be made.
    pub fn open(folder: &Path, threads: usize) -> Result<Self, TaskError> {
        let failed = |source| TaskError::Io { path: folder.to_path_buf(), source };
        fs::create_dir_all(folder).map_err(failed)?;
        Ok(Self { folder: folder.to_path_buf(), threads })
    }

    /// Where the log of a scene lies.
    pub fn log_of(&self, scene: &Scene) -> PathBuf {
        self.folder.join(run_name(scene) + ".mcap")
    }

    /// Returns a finished run of a scene, which is read, continued or run from the start.
    ///
    /// # Errors
    /// Where the run stops, is interrupted, or its log cannot be used.
    pub fn done(&self, scene: &Scene, purpose: Purpose, interrupted: &dyn Fn() -> bool) -> Result<Done, TaskError> {
        let log = self.log_of(scene);
        if !log.exists() {
            return self.run(scene, purpose, interrupted, JournalWriter::create);
        }
        // Without the lock, since many read one reference at a time; what is finished changes no more.
        if let Some(done) = Log::read(&log).ok().and_then(|log| self.finished(&log, scene, purpose)) {
            return Ok(done);
        }
        let unusable = |source| TaskError::Resume { log: log.clone(), source: Box::new(source) };
        let claim = match Resume::open(&log) {
            // As a power cut may leave it.
            Err(ResumeError::Read { source: ReadError::TooShort { .. }, .. }) => {
                return self.run(scene, purpose, interrupted, JournalWriter::create_over_empty);
            }
            claim => claim.and_then(Resume::whole).map_err(unusable)?,
        };
        let hash = scene.hash();
        if claim.log().entries().iter().any(|entry| entry.record.commit.scene_hash != hash) {
            return Err(TaskError::OtherScene { log });
        }
        if let Some(done) = self.finished(claim.log(), scene, purpose) {
            return Ok(done);
        }
        let is_current = is_of_these_numerics(claim.log());
        match purpose {
            Purpose::Results if is_current => self.resume(claim, scene, interrupted),
            _ => {
                // Under the lock of the claim: nobody else writes it.
                fs::remove_file(&log).map_err(|source| TaskError::Io { path: log, source })?;
                drop(claim);
                self.run(scene, purpose, interrupted, JournalWriter::create)
            }
        }
    }

    /// What a log of this scene shows, where it is finished.
    fn finished(&self, log: &Log, scene: &Scene, purpose: Purpose) -> Option<Done> {
        let hash = scene.hash();
        let is_of_scene = log.entries().iter().all(|entry| entry.record.commit.scene_hash == hash);
        if !is_of_scene || !is_of_these_numerics(log) || log.completeness() != Completeness::Finished {
            return None;
        }
        let records = records(log);
        let wall_s = match purpose {
            Purpose::Results => Some(of_stages(&records)),
            Purpose::Time => self.time_of(scene),
        };
        wall_s.map(|wall_s| Done { records, wall_s })
    }

    fn manifest(&self, scene: &Scene) -> Manifest {
        Manifest::here(Path::new("study"), &scene.to_toml(), self.threads)
    }

    /// Runs a scene from its start, in a log that `create` makes.
    fn run(
        &self,
        scene: &Scene,
        purpose: Purpose,
        interrupted: &dyn Fn() -> bool,
        create: impl Fn(&Path, &Manifest, SyncPolicy) -> Result<JournalWriter, WriteError>,
    ) -> Result<Done, TaskError> {
        let log = self.log_of(scene);
        let begin = Instant::now();
        let mut stages = Stages::new(scene.clone());
        let start = stages.start()?;
        let writer = create(&log, &self.manifest(scene), scene.output.sync).map_err(Box::new)?;
        let run = Run::new(stages, start, None);
        let records = self.finish(&log, run, Logged { writer, records: Vec::new() }, interrupted)?;
        let wall_s = match purpose {
            Purpose::Time => self.keep_time(scene, begin.elapsed().as_secs_f64())?,
            Purpose::Results => of_stages(&records),
        };
        Ok(Done { records, wall_s })
    }

    /// Continues a log behind its last good stage.
    fn resume(&self, claim: Resume, scene: &Scene, interrupted: &dyn Fn() -> bool) -> Result<Done, TaskError> {
        let log = self.log_of(scene);
        let keep = claim.log().commits();
        let before = records(claim.log());
        let mut stages = Stages::new(scene.clone());
        let basis = basis(claim.log(), keep, &mut stages);
        let basis = basis.map_err(|source| TaskError::Basis { log: log.clone(), source })?;
        let resumed = claim.start_after(keep, &self.manifest(scene), scene.output.sync);
        let resumed = resumed.map_err(|source| TaskError::Resume { log: log.clone(), source: Box::new(source) })?;
        let run = Run::new(stages, basis.state, basis.commit);
        let records = self.finish(&log, run, Logged { writer: resumed.writer, records: before }, interrupted)?;
        Ok(Done { wall_s: of_stages(&records), records })
    }

    /// Runs to the end of the load and ends the log.
    fn finish(
        &self,
        log: &Path,
        mut run: Run,
        mut sink: Logged,
        interrupted: &dyn Fn() -> bool,
    ) -> Result<Vec<Record>, TaskError> {
        let ending = run.to_end(None, interrupted, &mut sink);
        let Logged { writer, records } = sink;
        let closed = if matches!(ending, Ok(Ending::Finished)) { writer.finish() } else { writer.close() };
        let ending = ending.map_err(|source| TaskError::Run { log: log.to_path_buf(), source: Box::new(source) })?;
        closed.map_err(Box::new)?;
        match ending {
            Ending::Finished => Ok(records),
            Ending::Interrupted | Ending::Until => Err(TaskError::Interrupted),
        }
    }

    fn time_file(&self, scene: &Scene) -> PathBuf {
        self.log_of(scene).with_extension("time.json")
    }

    /// The time that the run of a scene took, if that is known for these threads and this program.
    fn time_of(&self, scene: &Scene) -> Option<f64> {
        let taken: TimeTaken = serde_json::from_slice(&fs::read(self.time_file(scene)).ok()?).ok()?;
        let counts = taken.threads == self.threads
            && taken.program_version == env!("CARGO_PKG_VERSION")
            && taken.numerics == NUMERICS_REVISION
            && taken.host == host();
        counts.then_some(taken.wall_s).filter(|wall_s| wall_s.is_finite() && *wall_s > 0.0)
    }

    /// Writes the time that a run took beside its log, and gives it back.
    fn keep_time(&self, scene: &Scene, wall_s: f64) -> Result<f64, TaskError> {
        let Manifest { program_version, numerics, host, threads, .. } = self.manifest(scene);
        let taken = TimeTaken { wall_s, threads, program_version, numerics, host };
        let path = self.time_file(scene);
        let written = serde_json::to_vec(&taken).map_err(io::Error::from).and_then(|text| {
            let whole = WholeFile::beside(&path)?;
            whole.file().write_all(&text)?;
            whole.replace(&path)
        });
        written.map(|()| wall_s).map_err(|source| TaskError::Io { path, source })
    }
}

/// Wall time of all stages, seconds.
fn of_stages(records: &[Record]) -> f64 {
    records.iter().map(|record| record.wall_s).sum()
}

fn is_of_these_numerics(log: &Log) -> bool {
    log.manifests().iter().all(|manifest| manifest.numerics == NUMERICS_REVISION)
}

fn records(log: &Log) -> Vec<Record> {
    log.entries().iter().map(|entry| entry.record.clone()).collect()
}
