//! The program from outside: a folder to run it in, a small scene that refines and snaps, and what a log must hold.

use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use foldline::journal::{Completeness, Level, Log, verify_log};
use foldline::scene::{Scene, Stage, parse};
use foldline::state::Hash;

/// A quarter of the baseline, coarse, through the snap.
pub const SMALL: &str = include_str!("small.toml");

/// A small structure: joined and glued shells, of which one refines, with a spring and a mass.
pub const STRUCTURE: &str = include_str!("structure.toml");

/// A folder of its own for a test, with the small scene and the small structure in it.
pub struct Sandbox(tempfile::TempDir);

impl Sandbox {
    pub fn new() -> Self {
        let place = Self(tempfile::tempdir().unwrap());
        place.write("small.toml", SMALL);
        place.write("structure.toml", STRUCTURE);
        place
    }

    pub fn path(&self) -> &Path {
        self.0.path()
    }

    pub fn file(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        std::fs::write(self.file(name), content).unwrap();
    }

    pub fn read(&self, name: &str) -> Vec<u8> {
        std::fs::read(self.file(name)).unwrap()
    }

    pub fn log(&self, name: &str) -> Log {
        Log::read(&self.file(name)).unwrap()
    }

    /// Files in the folder, without scenes.
    pub fn logs(&self) -> Vec<String> {
        let names = std::fs::read_dir(self.path()).unwrap();
        let mut names: Vec<String> = names.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.retain(|name| !name.ends_with(".toml"));
        names.sort();
        names
    }

    /// The program in this folder, with these arguments, words apart.
    pub fn command(&self, arguments: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_foldline"));
        command.args(arguments.split_whitespace()).current_dir(self.path()).stdin(Stdio::null()).env_remove("COLUMNS");
        command
    }

    /// Runs the program to its end.
    pub fn foldline(&self, arguments: &str) -> Said {
        Said::new(arguments, self.command(arguments).output().unwrap())
    }
}

/// What the program said.
#[derive(Debug)]
pub struct Said {
    pub code: Option<i32>,
    pub out: String,
    pub err: String,
    arguments: String,
}

impl Said {
    pub fn new(arguments: &str, output: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        let (out, err) = (text(output.stdout), text(output.stderr));
        Self { code: output.status.code(), out, err, arguments: arguments.to_owned() }
    }

    /// Asserts the exit code.
    #[track_caller]
    pub fn ends(self, code: i32) -> Self {
        assert_eq!(self.code, Some(code), "{}\n{}{}", self.arguments, self.out, self.err);
        self
    }

    /// Asserts that it says all of this, wherever it says it.
    #[track_caller]
    pub fn says(self, pieces: &[&str]) -> Self {
        for piece in pieces {
            assert!(
                self.out.contains(piece) || self.err.contains(piece),
                "{}\ndoes not say {piece:?} but\n{}{}",
                self.arguments,
                self.out,
                self.err
            );
        }
        self
    }
}

/// The small scene with other lines; each piece must stand in it.
pub fn small_with(changes: &[(&str, &str)]) -> String {
    changes.iter().fold(SMALL.to_owned(), |text, (from, to)| {
        assert!(text.contains(from), "{from}");
        text.replace(from, to)
    })
}

/// The small scene, syncing by a policy.
pub fn small_syncing(policy: &str) -> String {
    format!("{SMALL}\n[output]\nsync = \"{policy}\"\n")
}

pub fn scene(text: &str) -> Scene {
    parse(text, "small.toml").unwrap_or_else(|error| panic!("{error}"))
}

/// The log of the small scene, run in one go.
pub struct Straight {
    pub bytes: Vec<u8>,
    pub stages: usize,
    pub chain: Hash,
}

impl Straight {
    /// Runs a scene in one go.
    pub fn run(scene: &str, threads: usize) -> Self {
        let place = Sandbox::new();
        place.write("straight.toml", scene);
        place.foldline(&format!("run straight.toml -o straight.mcap --quiet --threads {threads}")).ends(0);
        let log = place.log("straight.mcap");
        assert_eq!(log.completeness(), Completeness::Finished);
        let chain = log.last_commit().unwrap().chain_hash;
        Self { bytes: place.read("straight.mcap"), stages: log.entries().len(), chain }
    }

    /// The small scene on two threads, run once for all tests.
    pub fn small() -> &'static Self {
        static SMALL_RUN: OnceLock<Straight> = OnceLock::new();
        SMALL_RUN.get_or_init(|| {
            let straight = Self::run(SMALL, 2);
            straight.assert_eventful();
            straight
        })
    }

    /// The small structure on two threads, run once for all tests.
    pub fn structure() -> &'static Self {
        static STRUCTURE_RUN: OnceLock<Straight> = OnceLock::new();
        STRUCTURE_RUN.get_or_init(|| {
            let straight = Self::run(STRUCTURE, 2);
            let log = straight.log();
            let refined = log.entries().iter().filter(|entry| entry.record.report.stage == Stage::RefineKnots);
            assert!(refined.count() >= 1 && straight.stages >= 12, "{} stages", straight.stages);
            straight
        })
    }

    pub fn log(&self) -> Log {
        Log::from_bytes(self.bytes.clone()).unwrap()
    }

    /// The bytes that a process leaves which dies right after stage `stages`.
    pub fn cut_after(&self, stages: usize) -> &[u8] {
        let log = self.log();
        let entries = log.entries();
        // With the index behind its chunk, which comes in the same write.
        let end = entries.get(stages).map_or_else(|| entries[stages - 1].bytes.end, |next| next.bytes.start);
        &self.bytes[..end as usize]
    }

    /// The run has all that a restart may stumble over.
    fn assert_eventful(&self) {
        let log = self.log();
        let reports = || log.entries().iter().map(|entry| &entry.record.report);
        assert!((40..=80).contains(&self.stages), "{} stages", self.stages);
        assert!(reports().filter(|report| report.stage == Stage::RefineKnots).count() >= 2);
        let turned_down = log.entries().iter().enumerate().filter(|(index, _)| {
            let state = log.state(*index).unwrap();
            state.drive.control.rejection.is_some()
        });
        assert!(turned_down.count() >= 2);
        let jump = reports().position(|report| report.jumped).expect("a jump");
        assert!(reports().skip(jump).any(|report| report.stage == Stage::RefineKnots), "refines beyond the jump");
    }
}

/// Asserts that a log is whole, without a fault, and ends with this chain.
#[track_caller]
pub fn assert_ends_with(log: &Log, chain: Hash, what: &str) {
    assert_eq!(log.completeness(), Completeness::Finished, "{what}");
    assert_eq!(log.last_commit().unwrap().chain_hash, chain, "{what}");
    let faults: Vec<_> = verify_log(log).into_iter().filter(|finding| finding.level > Level::Info).collect();
    assert!(faults.is_empty(), "{what}: {faults:?}");
}

/// Cuts a straight run after every stage in turn and resumes each.
pub fn assert_resumes_from_every_cut(whole: &Straight, run: &str, threads_before: usize, threads_after: usize) {
    let place = Sandbox::new();
    for stages in 0..=whole.stages {
        place.write("cut.mcap", whole.cut_after(stages));
        place.foldline(&format!("resume cut.mcap --quiet --threads {threads_after}")).ends(0);
        let what = format!("cut after {stages} stages, {run}, {threads_before} threads and then {threads_after}");
        let log = place.log("cut.mcap");
        assert_ends_with(&log, whole.chain, &what);
        assert_eq!(log.entries().len(), whole.stages, "{what}");
        assert_eq!(log.manifests().len(), 2, "{what}");
        let manifest = &log.manifests()[1];
        assert_eq!((manifest.first_ordinal, manifest.threads), (stages as u64, threads_after), "{what}");
        assert_eq!(place.logs(), ["cut.mcap"], "{what}: nothing is left beside the log");
    }
}
