//! Logs in memory, and what a log that was read must hold.

use std::io;
use std::sync::{Arc, Mutex};

use foldline::journal::{Backend, JournalWriter, Log};
use foldline::record::Record;
use foldline::scene::SyncPolicy;
use foldline::state::State;

use crate::synthetic;

/// What a test disk was given, and what of it would survive a power cut.
#[derive(Debug, Default)]
pub struct Disk {
    pub written: Vec<u8>,
    /// Length of `written` at every sync.
    pub durable: Vec<usize>,
    /// Appends after which one fails, having written half, and how.
    pub fail_append: Option<(usize, io::ErrorKind)>,
    /// Syncs after which one fails.
    pub fail_sync: Option<usize>,
    /// Whether cutting back fails too.
    pub fail_cut: bool,
    pub appends: usize,
}

#[derive(Clone, Debug, Default)]
pub struct TestBackend(pub Arc<Mutex<Disk>>);

impl Backend for TestBackend {
    fn append(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut disk = self.0.lock().unwrap();
        disk.appends += 1;
        if let Some((after, kind)) = disk.fail_append
            && disk.appends > after
        {
            disk.written.extend_from_slice(&bytes[..bytes.len() / 2]);
            return Err(kind.into());
        }
        disk.written.extend_from_slice(bytes);
        Ok(())
    }

    fn sync(&mut self) -> io::Result<()> {
        let mut disk = self.0.lock().unwrap();
        if disk.fail_sync.is_some_and(|after| disk.durable.len() >= after) {
            return Err(io::Error::other("input/output error"));
        }
        let length = disk.written.len();
        disk.durable.push(length);
        Ok(())
    }

    fn cut(&mut self, length: u64) -> io::Result<()> {
        let mut disk = self.0.lock().unwrap();
        if disk.fail_cut {
            return Err(io::Error::other("cannot cut"));
        }
        disk.written.truncate(length as usize);
        Ok(())
    }
}

/// A writer on a test disk.
pub fn writer(sync: SyncPolicy) -> (JournalWriter, Arc<Mutex<Disk>>) {
    let backend = TestBackend::default();
    let disk = backend.0.clone();
    (JournalWriter::on(Box::new(backend), "run.mcap", &synthetic::manifest(), sync).unwrap(), disk)
}

/// The bytes of a finished log of this run.
pub fn finished_log(run: &[(State, Record)]) -> Vec<u8> {
    let (mut writer, disk) = writer(SyncPolicy::AtEnd);
    for (state, record) in run {
        writer.commit(state, record).unwrap();
    }
    writer.finish().unwrap();
    std::mem::take(&mut disk.lock().unwrap().written)
}

/// Asserts that the log holds a beginning of the run and nothing else: every record and every state, bit for bit.
#[track_caller]
pub fn assert_prefix(log: &Log, run: &[(State, Record)]) {
    assert_records(log, run);
    for (index, (state, _)) in run.iter().enumerate().take(log.entries().len()) {
        assert_eq!(log.state(index).unwrap(), *state);
    }
}

/// As [`assert_prefix`], but of the states only the last, for large ones.
#[track_caller]
pub fn assert_prefix_by_its_last_state(log: &Log, run: &[(State, Record)]) {
    assert_records(log, run);
    if let Some(last) = log.entries().len().checked_sub(1) {
        assert_eq!(log.state(last).unwrap(), run[last].0);
    }
}

#[track_caller]
fn assert_records(log: &Log, run: &[(State, Record)]) {
    assert!(log.entries().len() <= run.len());
    for (entry, (_, record)) in log.entries().iter().zip(run) {
        assert_eq!(entry.record, *record);
    }
}
