//! What other programs see in a log, and that it changes nothing for this one.

use std::sync::Arc;

use foldline::journal::{JournalWriter, Level, Log, ViewerMessage, ViewerTopic, ViewerTopics, format, message};
use foldline::record::Record;
use foldline::scene::SyncPolicy;
use foldline::state::State;

use crate::support::{assert_prefix, writer};
use crate::synthetic;

struct Pictures(Arc<ViewerTopic>);

impl Pictures {
    fn on(topic: &str) -> Box<Self> {
        Box::new(Self(Arc::new(ViewerTopic {
            topic: topic.to_owned(),
            message_encoding: "protobuf".to_owned(),
            schema_name: "foxglove.SceneUpdate".to_owned(),
            schema_encoding: "protobuf".to_owned(),
            schema: b"a descriptor".to_vec(),
        })))
    }
}

impl ViewerTopics for Pictures {
    fn messages(&mut self, state: &State, record: &Record) -> Vec<ViewerMessage> {
        let data = format!("{} {}", state.parameter, record.commit.ordinal).into_bytes();
        (0..record.commit.ordinal % 3).map(|_| ViewerMessage { topic: self.0.clone(), data: data.clone() }).collect()
    }
}

fn log_with(viewer: Option<Box<dyn ViewerTopics>>) -> Log {
    let (mut writer, disk): (JournalWriter, _) = writer(SyncPolicy::AtEnd);
    if let Some(viewer) = viewer {
        writer = writer.with_viewer(viewer);
    }
    for (state, record) in synthetic::run(3, 7) {
        writer.commit(&state, &record).unwrap();
    }
    writer.finish().unwrap();
    Log::from_bytes(std::mem::take(&mut disk.lock().unwrap().written)).unwrap()
}

#[test]
fn pictures_change_no_hash() {
    let (without, with) = (log_with(None), log_with(Some(Pictures::on("/foldline/scene"))));
    assert!(with.file_len() > without.file_len());
    assert_eq!(with.last_commit(), without.last_commit());
    assert_prefix(&with, &synthetic::run(3, 7));
    let findings = foldline::journal::verify_log(&with);
    assert!(findings.iter().all(|finding| finding.level == Level::Info), "{findings:?}");
}

#[test]
fn pictures_keep_off_the_logs_own_topics() {
    let (writer, _disk) = writer(SyncPolicy::AtEnd);
    let mut writer = writer.with_viewer(Pictures::on(format::STATE_TOPIC));
    let run = synthetic::run(3, 2);
    writer.commit(&run[0].0, &run[0].1).unwrap();
    let error = writer.commit(&run[1].0, &run[1].1).unwrap_err();
    insta::assert_snapshot!(std::error::Error::source(&error).unwrap(), @"viewers' messages cannot go to /foldline/state, which is the log's own");
}

/// A stage that changes neither mesh nor displacements costs its report and a few hashes, however large the shell.
#[test]
fn what_is_unchanged_is_not_written_again() {
    let run = synthetic::run(40, 12);
    let log = Log::from_bytes(crate::support::finished_log(&run)).unwrap();
    let idle = |index: &usize| {
        let (before, after) = (&run[index - 1].0, &run[*index].0);
        before.mesh == after.mesh && before.displacement == after.displacement && after.refined.is_none()
    };
    let (idle, busy): (Vec<usize>, Vec<usize>) = (1..run.len()).partition(idle);
    assert!(idle.len() >= 4 && busy.len() >= 4);
    let length = |index: &usize| log.entries()[*index].bytes.clone().count();
    assert!(idle.iter().map(length).max().unwrap() < 3000);
    assert!(busy.iter().map(length).min().unwrap() > 40 * 40 * 24);
}

/// Viewers want plain types, no references, and one schema that names every entry there is.
#[test]
fn the_schema_of_reports_is_plain_and_whole() {
    let schema = message::schema_of::<message::ReportMessage>("foldline.Report");
    let schema: serde_json::Value = serde_json::from_slice(&schema).unwrap();
    let (_, record) = synthetic::run(3, 1).remove(0);
    let json = message::ReportMessage::new(&record).to_json().unwrap();
    let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
    let properties = schema["properties"].as_object().unwrap();
    for entry in json.as_object().unwrap().keys() {
        assert!(properties[entry]["type"].is_string(), "{entry}: {}", properties[entry]);
    }
    let text = schema.to_string();
    assert!(!text.contains("$ref") && !text.contains("oneOf") && !text.contains("allOf"), "{text}");
    assert_eq!(properties["stage"]["enum"][0], "solve");
}

/// JSON has no NaN, and a solve that failed may well report one.
#[test]
fn numbers_that_json_lacks_come_back() {
    let (_, mut record) = synthetic::run(3, 1).remove(0);
    record.report.residual = f64::NAN;
    record.report.largest_indicator = [f64::INFINITY, f64::NEG_INFINITY];
    record.report.moment_n_mm = -0.0;
    record.report.strain_energy_n_mm = f64::MIN_POSITIVE / 8.0;
    let json = message::ReportMessage::new(&record).to_json().unwrap();
    let read = message::ReportMessage::from_json(&json).unwrap().report;
    assert!(read.residual.is_nan());
    assert_eq!(read.largest_indicator, record.report.largest_indicator);
    assert_eq!(read.moment_n_mm.to_bits(), record.report.moment_n_mm.to_bits());
    assert_eq!(read.strain_energy_n_mm.to_bits(), record.report.strain_energy_n_mm.to_bits());
}
