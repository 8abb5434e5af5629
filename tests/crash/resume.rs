//! Continuing logs in files: at any stage, after any end, with damage, and with a rival.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use foldline::journal::{
    Completeness, JournalWriter, Level, LockError, Log, NewLogError, RecoverError, RecoverOutcome, Resume, ResumeError,
    WriteError, recover, verify,
};
use foldline::record::Record;
use foldline::scene::SyncPolicy;
use foldline::state::State;

use crate::support::assert_prefix;
use crate::synthetic;

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn file(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn names(&self) -> Vec<String> {
        let names = fs::read_dir(self.0.path()).unwrap();
        let mut names: Vec<String> = names.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }
}

enum End {
    Dropped,
    Closed,
    Finished,
}

fn write(path: &Path, run: &[(State, Record)], end: End) {
    let mut writer = JournalWriter::create(path, &synthetic::manifest(), SyncPolicy::AtEnd).unwrap();
    run.iter().for_each(|(state, record)| writer.commit(state, record).unwrap());
    match end {
        End::Dropped => drop(writer),
        End::Closed => writer.close().unwrap(),
        End::Finished => writer.finish().unwrap(),
    }
}

/// Resumes, runs the stages that are missing from `run`'s length, and finishes.
fn resume_and_finish(path: &Path, stages: usize) {
    let resumed = JournalWriter::resume(path, &synthetic::manifest(), SyncPolicy::AtEnd).unwrap();
    let (mut writer, log) = (resumed.writer, resumed.log);
    let done = log.entries().len();
    let state = if done == 0 { synthetic::start(3) } else { log.state(done - 1).unwrap() };
    for (state, record) in synthetic::go_on(&state, log.last_commit(), stages - done) {
        writer.commit(&state, &record).unwrap();
    }
    writer.finish().unwrap();
}

fn assert_faultless(path: &Path) {
    let faults: Vec<_> = verify(path).into_iter().filter(|finding| finding.level > Level::Info).collect();
    assert!(faults.is_empty(), "{faults:?}");
}

#[test]
fn a_run_stopped_at_any_stage_ends_the_same() {
    let folder = Folder::new();
    let run = synthetic::run(3, 11);
    for stages in 0..=run.len() {
        for (name, end) in [("dropped", End::Dropped), ("closed", End::Closed), ("finished", End::Finished)] {
            let path = folder.file(&format!("{name}-{stages}.mcap"));
            write(&path, &run[..stages], end);
            resume_and_finish(&path, run.len());
            let log = Log::read(&path).unwrap();
            assert_eq!(log.completeness(), Completeness::Finished);
            assert_eq!(log.entries().len(), run.len());
            assert_eq!(log.manifests().len(), 2);
            assert_eq!(log.manifests()[1].first_ordinal, stages as u64);
            assert_prefix(&log, &run);
            assert_faultless(&path);
            fs::remove_file(&path).unwrap();
            assert_eq!(folder.names(), Vec::<String>::new(), "nothing is left beside the log");
        }
    }
}

#[test]
fn resuming_and_doing_nothing_changes_nothing() {
    let folder = Folder::new();
    let path = folder.file("run.mcap");
    write(&path, &synthetic::run(3, 4), End::Finished);
    let before = fs::read(&path).unwrap();
    drop(JournalWriter::resume(&path, &synthetic::manifest(), SyncPolicy::EachStage).unwrap());
    assert_eq!(fs::read(&path).unwrap(), before);
    assert_eq!(folder.names(), ["run.mcap"]);
}

#[test]
fn a_log_is_never_overwritten() {
    let folder = Folder::new();
    let path = folder.file("run.mcap");
    fs::write(&path, "not even a log").unwrap();
    let error = JournalWriter::create(&path, &synthetic::manifest(), SyncPolicy::AtEnd).unwrap_err();
    let text = error.to_string().replace(&path.display().to_string(), "run.mcap");
    insta::assert_snapshot!(text, @"run.mcap exists and is no log; it is not overwritten: write elsewhere with `-o OTHER`");
    let error = JournalWriter::resume(&path, &synthetic::manifest(), SyncPolicy::AtEnd).unwrap_err();
    let source = std::error::Error::source(&error).unwrap().to_string();
    insta::assert_snapshot!(source, @"this is not a log: it does not begin like an MCAP file, and no commit of a run is in it");
    assert_eq!(fs::read(&path).unwrap(), b"not even a log");
    assert!(matches!(recover(&path, &folder.file("new.mcap")), Ok(RecoverOutcome::Hopeless { .. })));
    assert_eq!(folder.names(), ["run.mcap"]);
    let nowhere = JournalWriter::create(&folder.file("no/run.mcap"), &synthetic::manifest(), SyncPolicy::AtEnd);
    assert!(matches!(nowhere, Err(WriteError::NoFolder { .. })));
    let missing = JournalWriter::resume(&folder.file("none"), &synthetic::manifest(), SyncPolicy::AtEnd);
    assert!(matches!(missing, Err(ResumeError::NoLog { .. })));
}

#[test]
fn what_damage_costs_is_kept_beside_the_log() {
    let folder = Folder::new();
    let (path, copy) = (folder.file("run.mcap"), folder.file("copy.mcap"));
    let run = synthetic::run(3, 9);
    write(&path, &run, End::Finished);
    let entries: Vec<_> = Log::read(&path).unwrap().entries().iter().map(|entry| entry.bytes.clone()).collect();
    let mut bytes = fs::read(&path).unwrap();
    bytes[entries[4].start as usize + 300] ^= 4;
    fs::write(&path, &bytes).unwrap();
    let log = Log::read(&path).unwrap();
    let at = log.good_end();
    assert_eq!(log.completeness(), Completeness::Damaged { at, dropped: bytes.len() as u64 - at, later_commits: 4 });
    assert!(at <= entries[4].start);

    let outcome = recover(&path, &copy).unwrap();
    assert!(matches!(outcome, RecoverOutcome::Lossy { commits: 4, later_commits: 4, .. }), "{outcome:?}");
    assert_faultless(&copy);
    assert_prefix(&Log::read(&copy).unwrap(), &run);
    assert!(matches!(recover(&path, &copy), Err(RecoverError::New(NewLogError::Exists { .. }))));

    let resumed = JournalWriter::resume(&path, &synthetic::manifest(), SyncPolicy::AtEnd).unwrap();
    let dropped = fs::read(resumed.dropped.as_ref().unwrap()).unwrap();
    assert_eq!(dropped, bytes[at as usize..]);
    drop(resumed);
    resume_and_finish(&path, run.len());
    assert_prefix(&Log::read(&path).unwrap(), &run);
    assert_faultless(&path);
    assert_eq!(folder.names(), ["copy.mcap", "run.mcap", "run.mcap.dropped-1", "run.mcap.dropped-2"]);
}

/// Bytes that no commit needs may go wrong anywhere: the chain reaches across, and the next resume heals them.
#[test]
fn damage_between_commits_costs_nothing() {
    let folder = Folder::new();
    let (path, copy) = (folder.file("run.mcap"), folder.file("copy.mcap"));
    let run = synthetic::run(3, 6);
    write(&path, &run, End::Finished);
    let good = fs::read(&path).unwrap();
    let entries: Vec<_> = Log::read(&path).unwrap().entries().iter().map(|entry| entry.bytes.clone()).collect();
    let index = entries[2].end as usize;
    for (place, what) in [(2, "magic"), (11, "header"), (index, "kind"), (index + 3, "length")] {
        let mut bytes = good.clone();
        bytes[place] ^= 1;
        fs::write(&path, &bytes).unwrap();
        let log = Log::read(&path).unwrap();
        assert_eq!((log.completeness(), log.entries().len()), (Completeness::Finished, run.len()), "{what}");
        let findings = verify(&path);
        assert!(findings.iter().any(|finding| finding.level == Level::Warning), "{what}: {findings:?}");
        assert!(findings.iter().all(|finding| finding.level < Level::Error), "{what}: {findings:?}");
        assert_eq!(recover(&path, &copy).unwrap(), RecoverOutcome::Lossless { commits: 6 }, "{what}");
        assert_prefix(&Log::read(&copy).unwrap(), &run);
        fs::remove_file(&copy).unwrap();
    }
}

/// No hash covers a time, an index or the summary, and still `verify` finds any byte of them that changes.
#[test]
fn verify_finds_every_changed_byte() {
    let folder = Folder::new();
    let path = folder.file("run.mcap");
    write(&path, &synthetic::run(2, 2), End::Finished);
    assert_faultless(&path);
    let good = fs::read(&path).unwrap();
    for place in (0..good.len()).step_by(7) {
        let mut bytes = good.clone();
        bytes[place] ^= 0x10;
        fs::write(&path, &bytes).unwrap();
        let findings = verify(&path);
        assert!(findings.iter().any(|finding| finding.level > Level::Info), "byte {place}: {findings:?}");
    }
}

#[test]
fn two_writers_do_not_meet() {
    let folder = Folder::new();
    let path = folder.file("run.mcap");
    let run = synthetic::run(3, 6);
    let mut first = JournalWriter::create(&path, &synthetic::manifest(), SyncPolicy::AtEnd).unwrap();
    first.commit(&run[0].0, &run[0].1).unwrap();
    let second = JournalWriter::resume(&path, &synthetic::manifest(), SyncPolicy::AtEnd);
    let Err(ResumeError::Lock(error @ LockError::Busy { .. })) = second else { panic!("{second:?}") };
    assert!(error.to_string().contains(&format!("process {}", std::process::id())), "{error}");
    first.commit(&run[1].0, &run[1].1).unwrap();

    // A file system without locks: a rival comes in all the same, and leaves its token.
    fs::write(folder.file("run.mcap.lease"), "00112233445566778899aabbccddeeff\nprocess 1 (elsewhere)\n").unwrap();
    let before = fs::read(&path).unwrap();
    let error = first.commit(&run[2].0, &run[2].1).unwrap_err();
    assert!(matches!(error, WriteError::Lock(LockError::Lost { .. })), "{error}");
    assert!(error.to_string().contains("taken over by process 1 (elsewhere)"), "{error}");
    assert!(matches!(first.finish(), Err(WriteError::GivenUp { .. })));
    assert_eq!(fs::read(&path).unwrap(), before);
    assert_eq!(Log::read(&path).unwrap().entries().len(), 2);

    // The rival is gone too; neither left anything that keeps the next one out.
    resume_and_finish(&path, run.len());
    assert_faultless(&path);
    assert_eq!(folder.names(), ["run.mcap"]);
}

/// Where locks do not keep a rival out, the first of two that resume one log loses it, with nothing of the other's.
#[test]
fn a_rival_resumes_while_the_first_has_written_nothing() {
    let folder = Folder::new();
    let path = folder.file("run.mcap");
    let run = synthetic::run(3, 6);
    write(&path, &run[..2], End::Dropped);
    let resume = || JournalWriter::resume(&path, &synthetic::manifest(), SyncPolicy::AtEnd).unwrap().writer;
    let mut first = resume();
    fs::remove_file(folder.file("run.mcap.lock")).unwrap();
    let mut second = resume();
    let error = first.commit(&run[2].0, &run[2].1).unwrap_err();
    assert!(matches!(error, WriteError::Lock(LockError::Lost { .. })), "{error}");
    drop(first);
    run[2..].iter().for_each(|(state, record)| second.commit(state, record).unwrap());
    second.finish().unwrap();
    assert_prefix(&Log::read(&path).unwrap(), &run);
    assert_faultless(&path);
    assert_eq!(folder.names(), ["run.mcap"]);
}

/// What a process that died left beside a log, or somebody put there, is no obstacle; what may be somebody's stays.
#[test]
fn what_lies_beside_a_log_is_no_obstacle() {
    let folder = Folder::new();
    let path = folder.file("run.mcap");
    write(&path, &synthetic::run(3, 2), End::Dropped);
    fs::write(folder.file("run.mcap.new"), "half a copy").unwrap();
    fs::write(folder.file("run.mcap.lease"), "00112233445566778899aabbccddeeff\nprocess 1 (dead)\n").unwrap();
    fs::write(folder.file("run.mcap.lock"), "").unwrap();
    resume_and_finish(&path, 5);
    assert_faultless(&path);
    assert_eq!(folder.names(), ["run.mcap", "run.mcap.new"]);
    assert_eq!(fs::read(folder.file("run.mcap.new")).unwrap(), b"half a copy");
}

/// Links in the places of lock and lease are not written through.
#[test]
fn links_beside_a_log_are_not_followed() {
    let folder = Folder::new();
    let (path, other) = (folder.file("run.mcap"), folder.file("other"));
    let run = synthetic::run(3, 3);
    fs::write(&other, "somebody's").unwrap();
    std::os::unix::fs::symlink(&other, folder.file("run.mcap.lease")).unwrap();
    write(&path, &run, End::Finished);
    assert_faultless(&path);
    assert_eq!(folder.names(), ["other", "run.mcap"]);
    std::os::unix::fs::symlink(&other, folder.file("run.mcap.lock")).unwrap();
    let refused = JournalWriter::resume(&path, &synthetic::manifest(), SyncPolicy::AtEnd).unwrap_err();
    assert!(refused.to_string().contains("cannot make") && refused.to_string().contains("run.mcap.lock"), "{refused}");
    assert_eq!(fs::read(&other).unwrap(), b"somebody's");
}

/// A file that held nothing is begun again under the lock: what a rival has put there meanwhile is left alone.
#[test]
fn an_empty_log_is_not_taken_from_a_rival() {
    let folder = Folder::new();
    let path = folder.file("run.mcap");
    let run = synthetic::run(3, 3);
    fs::write(&path, "").unwrap();
    let create = || JournalWriter::create_over_empty(&path, &synthetic::manifest(), SyncPolicy::AtEnd);
    let mut first = create().unwrap();
    first.commit(&run[0].0, &run[0].1).unwrap();
    let before = fs::read(&path).unwrap();
    assert!(matches!(create(), Err(WriteError::Lock(LockError::Busy { .. }))));
    assert_eq!(fs::read(&path).unwrap(), before);
    run[1..].iter().for_each(|(state, record)| first.commit(state, record).unwrap());
    first.finish().unwrap();
    assert!(matches!(create(), Err(WriteError::Exists { .. })));
    assert_prefix(&Log::read(&path).unwrap(), &run);
    assert_faultless(&path);
}

/// Where locks do not hold, the loser does no harm even between the look at the lease and the write: it writes to a file
/// without a name.
#[test]
fn a_taken_over_log_is_another_file() {
    let folder = Folder::new();
    let path = folder.file("run.mcap");
    let run = synthetic::run(3, 6);
    write(&path, &run[..2], End::Dropped);
    let old = fs::OpenOptions::new().append(true).open(&path).unwrap();
    let resumed = Resume::open(&path).unwrap().in_a_copy().start(&synthetic::manifest(), SyncPolicy::AtEnd).unwrap();
    let mut writer = resumed.writer;
    run[2..].iter().for_each(|(state, record)| writer.commit(state, record).unwrap());
    writer.finish().unwrap();
    std::io::Write::write_all(&mut &old, b"what the loser still had in hand").unwrap();
    assert_faultless(&path);
    assert_prefix(&Log::read(&path).unwrap(), &run);
}

/// A log is continued in place: nothing of it is copied, and nothing changes before the first new stage.
#[test]
fn a_log_grows_in_place() {
    let folder = Folder::new();
    let path = folder.file("run.mcap");
    let run = synthetic::run(3, 9);
    for end in [End::Dropped, End::Closed, End::Finished] {
        write(&path, &run[..5], end);
        let before = fs::read(&path).unwrap();
        let same_file = fs::File::open(&path).unwrap();
        let whole = Log::read(&path).unwrap().entries()[4].bytes.end as usize;
        let mut writer = JournalWriter::resume(&path, &synthetic::manifest(), SyncPolicy::AtEnd).unwrap().writer;
        assert_eq!(fs::read(&path).unwrap(), before);
        writer.commit(&run[5].0, &run[5].1).unwrap();
        let after = fs::read(&path).unwrap();
        assert_eq!(after[..whole], before[..whole]);
        assert_eq!(same_file.metadata().unwrap().len(), after.len() as u64, "it is the same file");
        drop(writer);
        resume_and_finish(&path, run.len());
        assert_prefix(&Log::read(&path).unwrap(), &run);
        assert_faultless(&path);
        fs::remove_file(&path).unwrap();
    }
}

/// Power goes while a log is continued: before the cut is durable, after it, and anywhere in the first write, of which any
/// beginning is there, or space without content.
#[test]
fn a_power_cut_while_a_log_is_gone_on_with() {
    let folder = Folder::new();
    let path = folder.file("run.mcap");
    let run = synthetic::run(2, 5);
    for end in [End::Dropped, End::Closed, End::Finished] {
        write(&path, &run[..3], end);
        let before = fs::read(&path).unwrap();
        let mut writer = JournalWriter::resume(&path, &synthetic::manifest(), SyncPolicy::AtEnd).unwrap().writer;
        writer.commit(&run[3].0, &run[3].1).unwrap();
        drop(writer);
        let after = fs::read(&path).unwrap();
        let kept = before.iter().zip(&after).take_while(|(before, after)| before == after).count();
        let mut images = vec![(false, before.clone())];
        for length in (kept - 1..after.len()).step_by(3) {
            images.push((false, after[..length].to_vec()));
            let mut zeros = after[..length].to_vec();
            zeros.resize(after.len(), 0);
            images.push((true, zeros));
        }
        let mut lost = 0;
        for (has_zeros, image) in images {
            let log = Log::from_bytes(image).unwrap();
            assert!(log.entries().len() >= 3);
            assert_prefix(&log, &run);
            assert!(has_zeros || !matches!(log.completeness(), Completeness::Damaged { .. }), "{:?}", log.problems());
            lost += usize::from(log.last_manifest_is_lost());
        }
        // Only the head of a manifest does not tell yet that its scene is the one before.
        assert!(lost < 80, "{lost} images do not say which scene they continue with");
        fs::remove_file(&path).unwrap();
    }
}

const CHILD: &str = "FOLDLINE_TEST_CHILD_LOG";

/// Not a test by itself: the process that the next one kills.
#[test]
fn child_that_is_killed() {
    let Some(path) = std::env::var_os(CHILD) else { return };
    let path = PathBuf::from(path);
    let (mut writer, mut state, mut last) = if path.exists() {
        let resumed = JournalWriter::resume(&path, &synthetic::manifest(), SyncPolicy::AtEnd).unwrap();
        let state = resumed.log.entries().len().checked_sub(1).map(|last| resumed.log.state(last).unwrap());
        (resumed.writer, state.unwrap_or_else(|| synthetic::start(3)), resumed.log.last_commit().copied())
    } else {
        let writer = JournalWriter::create(&path, &synthetic::manifest(), SyncPolicy::AtEnd).unwrap();
        (writer, synthetic::start(3), None)
    };
    loop {
        let (next, record) = synthetic::go_on(&state, last.as_ref(), 1).remove(0);
        writer.commit(&next, &record).unwrap();
        (state, last) = (next, Some(record.commit));
    }
}

#[test]
fn a_killed_process_leaves_a_log_to_go_on_with() {
    let folder = Folder::new();
    let path = folder.file("run.mcap");
    let mut known = 0;
    for round in 0..6 {
        let mut child = std::process::Command::new(std::env::current_exe().unwrap())
            .args(["--exact", "resume::child_that_is_killed"])
            .env(CHILD, &path)
            .stdout(std::process::Stdio::null())
            .spawn()
            .unwrap();
        let began = Instant::now();
        let commits = || Log::read(&path).map_or(0, |log| log.entries().len());
        while commits() <= known + round && began.elapsed() < Duration::from_secs(20) {
            std::thread::sleep(Duration::from_millis(3));
        }
        child.kill().unwrap();
        child.wait().unwrap();
        let log = Log::read(&path).unwrap();
        assert!(log.entries().len() > known + round);
        assert!(!matches!(log.completeness(), Completeness::Damaged { .. } | Completeness::Finished));
        known = log.entries().len();
    }
    resume_and_finish(&path, known + 3);
    assert_prefix(&Log::read(&path).unwrap(), &synthetic::run(3, known + 3));
    assert_faultless(&path);
    assert_eq!(folder.names(), ["run.mcap"]);
}

/// Forty megabytes come back whole; `--nocapture` shows in what time.
#[test]
fn forty_megabytes_are_resumed() {
    let folder = Folder::new();
    let path = folder.file("run.mcap");
    let run = synthetic::run(120, 250);
    write(&path, &run, End::Dropped);
    let length = fs::metadata(&path).unwrap().len();
    assert!(length > 40 << 20, "{length}");
    let best = (0..5).map(|_| {
        let began = Instant::now();
        let resumed = JournalWriter::resume(&path, &synthetic::manifest(), SyncPolicy::AtEnd).unwrap();
        let state = resumed.log.state(run.len() - 1).unwrap();
        let took = began.elapsed();
        assert_eq!(state, run[run.len() - 1].0);
        took
    });
    let best = best.min().unwrap();
    println!("{length} bytes resumed in {best:?}");
}
