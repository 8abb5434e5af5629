//! Power cuts, full disks and failing ones, on a backend that tells what was written from what is durable.

use std::io;

use foldline::journal::{Completeness, Log, WriteError};
use foldline::record::Sink;
use foldline::scene::SyncPolicy;

use crate::support::{assert_prefix, writer};
use crate::synthetic;

/// Power goes at any sync; of what came after it any part is there, or space without content.
#[test]
fn power_cut_at_every_sync() {
    let run = synthetic::run(3, 10);
    let (mut writer, disk) = writer(SyncPolicy::EachStage);
    for (state, record) in &run {
        writer.commit(state, record).unwrap();
    }
    writer.finish().unwrap();
    let disk = disk.lock().unwrap();
    assert_eq!(disk.durable.len(), run.len() + 1);
    for (sync, &durable) in disk.durable.iter().enumerate() {
        let commits = run.len().min(sync + 1);
        let next = disk.durable.get(sync + 1).copied().unwrap_or(durable);
        let room = next - durable;
        for beyond in [0, room.min(1), room / 3, room.saturating_sub(1)] {
            let kept = &disk.written[..durable + beyond];
            let mut zeros = disk.written[..durable].to_vec();
            zeros.resize(durable + beyond, 0);
            for image in [kept.to_vec(), zeros] {
                let log = Log::from_bytes(image).unwrap();
                assert!(log.entries().len() >= commits, "sync {sync}, {beyond} bytes beyond");
                assert_prefix(&log, &run);
                assert!(!matches!(log.completeness(), Completeness::Damaged { .. }), "sync {sync} + {beyond}");
            }
        }
    }
}

#[test]
fn syncs_follow_the_policy() {
    let run = synthetic::run(2, 8);
    for (policy, during) in [(SyncPolicy::EachStage, 8), (SyncPolicy::EachSecond, 0), (SyncPolicy::AtEnd, 0)] {
        let (mut writer, disk) = writer(policy);
        for (state, record) in &run {
            writer.commit(state, record).unwrap();
        }
        assert_eq!(disk.lock().unwrap().durable.len(), during, "{policy:?}");
        writer.close().unwrap();
        assert_eq!(disk.lock().unwrap().durable.len(), during + 1, "{policy:?}");
    }
}

#[test]
fn a_full_disk_leaves_all_commits_before() {
    let run = synthetic::run(3, 6);
    for fail_cut in [false, true] {
        let (mut writer, disk) = writer(SyncPolicy::AtEnd);
        {
            let mut disk = disk.lock().unwrap();
            disk.fail_append = Some((1 + 4, io::ErrorKind::StorageFull));
            disk.fail_cut = fail_cut;
        }
        for (state, record) in &run[..4] {
            writer.take(state, record).unwrap();
        }
        let error = writer.take(&run[4].0, &run[4].1).unwrap_err();
        insta::allow_duplicates! {
            insta::assert_snapshot!(error, @"no space left to write run.mcap; it holds 4 stages, all good. Make space, then `foldline resume run.mcap`");
        }
        let error = writer.take(&run[4].0, &run[4].1).unwrap_err();
        insta::allow_duplicates! {
            insta::assert_snapshot!(error, @"run.mcap was given up after an earlier error; `foldline resume run.mcap` continues after its 4 stages");
        }
        assert!(matches!(writer.finish(), Err(WriteError::GivenUp { commits: 4, .. })));
        let log = Log::from_bytes(disk.lock().unwrap().written.clone()).unwrap();
        assert_eq!(log.entries().len(), 4);
        assert_prefix(&log, &run);
        assert_eq!(matches!(log.completeness(), Completeness::Unfinished), !fail_cut);
    }
}

#[test]
fn a_failing_disk_stops_the_run() {
    let run = synthetic::run(3, 6);
    let (mut writer, disk) = writer(SyncPolicy::EachStage);
    disk.lock().unwrap().fail_sync = Some(3);
    for (state, record) in &run[..3] {
        writer.take(state, record).unwrap();
    }
    let error = writer.take(&run[3].0, &run[3].1).unwrap_err();
    insta::assert_snapshot!(error, @"cannot sync run.mcap; it holds 4 stages. `foldline resume run.mcap` continues after the last good one");
    assert_eq!(error.source.unwrap().to_string(), "input/output error");
    let log = Log::from_bytes(disk.lock().unwrap().written.clone()).unwrap();
    assert_prefix(&log, &run);
}

#[test]
fn the_writer_refuses_what_no_reader_would_take() {
    let run = synthetic::run(3, 3);
    let (mut broken, _) = writer(SyncPolicy::AtEnd);
    let error = broken.take(&run[1].0, &run[1].1).unwrap_err();
    insta::assert_snapshot!(error, @"commit 1 does not follow on the 0 that run.mcap holds: it was not made from its last state");

    let (mut broken, _) = writer(SyncPolicy::AtEnd);
    assert!(matches!(broken.commit(&run[1].0, &run[0].1), Err(WriteError::StateHash { ordinal: 0, .. })));

    let mut state = synthetic::start(2);
    state.displacement[3][1] = f64::NAN;
    let mut record = run[0].1.clone();
    let (stage, step) = (record.commit.stage, record.commit.step);
    let commit = foldline::record::Commit::next;
    record.commit = commit(None, stage, step, synthetic::scene_hash(), record.commit.parent_hash, state.hash());
    let (mut broken, disk) = writer(SyncPolicy::AtEnd);
    let error = broken.take(&state, &record).unwrap_err();
    let mut text = error.to_string();
    let mut cause = std::error::Error::source(&error);
    while let Some(error) = cause {
        text = format!("{text}: {error}");
        cause = error.source();
    }
    insta::assert_snapshot!(text, @"stage 0 cannot be written to run.mcap, which holds all before it: the state cannot be kept: the content is unusable: displacement component 10 is NaN");
    assert!(Log::from_bytes(disk.lock().unwrap().written.clone()).unwrap().entries().is_empty());
}
