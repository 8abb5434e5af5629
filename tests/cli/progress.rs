//! What a run says while it continues.

use std::io::{self, ErrorKind, Write};

use foldline::cli::ProgressSink;
use foldline::record::{MemorySink, Outcome, Record, Sink, SinkError};
use foldline::scene::{Scene, Stage};
use foldline::state::State;

use crate::synthetic::{self, CURVE, Script};

fn lines(scene: &Scene, records: &[Record]) -> String {
    let mut text = Vec::new();
    let mut shown = ProgressSink::lines(MemorySink::default(), scene, &mut text);
    for record in records {
        shown.take(&synthetic::state(record), record).unwrap();
    }
    let (memory, seen) = shown.finish();
    assert_eq!(memory.stages.len(), records.len());
    assert_eq!(seen, records);
    String::from_utf8(text).unwrap()
}

#[test]
fn a_line_for_each_load_step() {
    insta::assert_snapshot!(lines(&synthetic::scene(), &synthetic::records()));
}

#[test]
fn a_line_for_each_solve_of_a_uniform_run() {
    let scene = Scene { pipeline: vec![Stage::Solve], adapt: None, ..synthetic::scene() };
    let mut script = Script::new();
    script.solve(CURVE[0], false);
    script.rejected(3.2, Outcome::RejectedNoEquilibrium);
    script.solve(CURVE[1], false);
    script.rejected(3.2, Outcome::RejectedNoEquilibrium);
    insta::assert_snapshot!(lines(&scene, &script.records()));
}

#[test]
fn a_warning_is_shown_once() {
    insta::assert_snapshot!(lines(&synthetic::scene(), &synthetic::coarse_records()));
}

#[test]
fn a_step_cut_short_is_shown_at_the_end() {
    let mut script = Script::new();
    script.solve(CURVE[0], false);
    assert!(lines(&synthetic::scene(), &script.records()).starts_with("step    1"));
}

#[test]
fn json_lines_of_a_run_are_those_of_its_records() {
    let records = synthetic::records();
    let mut text = Vec::new();
    let mut shown = ProgressSink::json(MemorySink::default(), &mut text);
    records.iter().for_each(|record| shown.take(&synthetic::state(record), record).unwrap());
    shown.finish();
    let expected: String = records.iter().map(|record| foldline::cli::json_line(record) + "\n").collect();
    assert_eq!(String::from_utf8(text).unwrap(), expected);
}

struct Broken(ErrorKind);

impl Write for Broken {
    fn write(&mut self, _: &[u8]) -> io::Result<usize> {
        Err(self.0.into())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

#[test]
fn a_reader_that_leaves_does_not_stop_the_run() {
    let records = synthetic::records();
    let mut shown = ProgressSink::json(MemorySink::default(), Broken(ErrorKind::BrokenPipe));
    records.iter().for_each(|record| shown.take(&synthetic::state(record), record).unwrap());
    assert_eq!(shown.finish().0.stages.len(), records.len());
}

#[test]
fn a_full_disk_behind_json_lines_does() {
    let records = synthetic::records();
    let mut shown = ProgressSink::json(MemorySink::default(), Broken(ErrorKind::StorageFull));
    let error = shown.take(&synthetic::state(&records[0]), &records[0]).unwrap_err();
    insta::assert_snapshot!(error);
    assert_eq!(shown.finish().0.stages.len(), 1);
}

#[test]
fn a_stage_that_was_not_kept_is_not_shown() {
    struct Refuses;
    impl Sink for Refuses {
        fn take(&mut self, _: &State, _: &Record) -> Result<(), SinkError> {
            Err(SinkError { context: "disk full".into(), source: None })
        }
    }
    let records = synthetic::records();
    let mut text = Vec::new();
    let mut shown = ProgressSink::json(Refuses, &mut text);
    assert!(shown.take(&synthetic::state(&records[0]), &records[0]).is_err());
    assert!(shown.finish().1.is_empty());
    assert!(text.is_empty());
}
