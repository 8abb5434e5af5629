//! What other programs see in a log, and that it changes nothing for this one.

use std::fs;
use std::path::Path;
use std::sync::Arc;

use foldline::journal::{
    Completeness, JournalWriter, Level, Log, LongLog, ViewerMessage, ViewerTopic, ViewerTopics, format, message,
    recover, verify,
};
use foldline::record::Record;
use foldline::scene::SyncPolicy;
use foldline::state::State;

use crate::program::Sandbox;
use crate::support::{assert_prefix, writer};
use crate::synthetic;

const SCENE_TOPIC: &str = "/foldline/scene";

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
    let (without, with) = (log_with(None), log_with(Some(Pictures::on(SCENE_TOPIC))));
    assert!(with.file_len() > without.file_len());
    assert_eq!(with.last_commit(), without.last_commit());
    assert_prefix(&with, &synthetic::run(3, 7));
    let findings = foldline::journal::verify_log(&with);
    assert!(findings.iter().all(|finding| finding.level == Level::Info), "{findings:?}");
}

/// The stages of a run of which [`Pictures`] show something, by the MCAP project's own reader: their places in the run.
fn shown(bytes: &[u8]) -> Vec<u64> {
    let messages = mcap::MessageStream::new(bytes).unwrap().map(Result::unwrap);
    messages
        .filter(|message| message.channel.topic == SCENE_TOPIC)
        .map(|message| {
            let text = std::str::from_utf8(&message.data).unwrap();
            assert_eq!(message.channel.schema.as_ref().unwrap().data, &b"a descriptor"[..]);
            text.split_once(' ').unwrap().1.parse().unwrap()
        })
        .collect()
}

fn shown_of(stages: u64) -> Vec<u64> {
    (0..stages).flat_map(|ordinal| vec![ordinal; ordinal as usize % 3]).collect()
}

fn bytes_with_pictures(run: &[(State, Record)]) -> Vec<u8> {
    let (writer, disk) = writer(SyncPolicy::AtEnd);
    let mut writer = writer.with_viewer(Pictures::on(SCENE_TOPIC));
    run.iter().for_each(|(state, record)| writer.commit(state, record).unwrap());
    writer.finish().unwrap();
    std::mem::take(&mut disk.lock().unwrap().written)
}

/// Places of the packed chunks of a log, with their message indexes.
fn packed(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let summary = mcap::Summary::read(bytes).unwrap().unwrap();
    let packed = summary.chunk_indexes.iter().filter(|chunk| chunk.compression == "zstd");
    let place = |chunk: &mcap::records::ChunkIndex| {
        let start = chunk.chunk_start_offset as usize;
        start..start + (chunk.chunk_length + chunk.message_index_length) as usize
    };
    packed.map(place).collect()
}

/// Readers that go by the summary and readers that go from front to back see every picture, packed.
#[test]
fn pictures_are_packed_where_every_reader_finds_them() {
    let run = synthetic::run(3, 9);
    let bytes = bytes_with_pictures(&run);
    assert_eq!(shown(&bytes), shown_of(9));
    assert_eq!(packed(&bytes).len(), 6);
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let of_scene = summary.channels.values().find(|channel| channel.topic == SCENE_TOPIC).unwrap().id;
    let statistics = summary.stats.as_ref().unwrap();
    assert_eq!(statistics.channel_message_counts[&of_scene], 9);
    assert_eq!(statistics.chunk_count as usize, summary.chunk_indexes.len());
    let streamed = summary.chunk_indexes.iter().flat_map(|chunk| summary.stream_chunk(&bytes, chunk).unwrap());
    let found = streamed.map(Result::unwrap).filter(|message| message.channel.topic == SCENE_TOPIC).count();
    assert_eq!(found, 9);
    for chunk in &summary.chunk_indexes {
        let indexes = summary.read_message_indexes(&bytes, chunk).unwrap();
        for (channel, entries) in &indexes {
            for entry in entries {
                let message = summary.seek_message(&bytes, chunk, entry).unwrap();
                assert_eq!(message.channel.id, channel.id);
            }
        }
    }
}

/// Damage to what viewers are shown costs no stage, and is not overlooked.
#[test]
fn every_bit_of_a_packed_chunk() {
    let run = synthetic::run(2, 4);
    let bytes = bytes_with_pictures(&run);
    for place in packed(&bytes).into_iter().flatten() {
        for bit in 0..8 {
            let mut damaged = bytes.clone();
            damaged[place] ^= 1 << bit;
            let log = Log::from_bytes(damaged).unwrap();
            assert_prefix(&log, &run);
            assert_eq!((log.entries().len(), log.completeness()), (4, Completeness::Finished), "byte {place}");
            assert!(!log.problems().is_empty() && log.loss().is_none(), "byte {place}, bit {bit}");
        }
    }
}

/// A log with pictures, cut at every byte: a commit counts once its own chunk is there, and nothing is continued behind pictures
/// without their commit.
#[test]
fn every_cut_of_a_log_with_pictures() {
    let run = synthetic::run(2, 6);
    let bytes = bytes_with_pictures(&run);
    let ends: Vec<u64> =
        Log::from_bytes(bytes.clone()).unwrap().entries().iter().map(|entry| entry.bytes.end).collect();
    for length in 100..bytes.len() {
        let Ok(log) = Log::from_bytes(bytes[..length].to_vec()) else { continue };
        let whole_commits = ends.iter().filter(|end| **end <= length as u64).count();
        assert_eq!(log.entries().len(), whole_commits, "cut at {length}");
        match log.completeness() {
            Completeness::Finished | Completeness::Unfinished => {}
            Completeness::Truncated { at, dropped } => assert_eq!(at + dropped, length as u64),
            damaged => panic!("cut at {length}: {damaged:?}"),
        }
    }
}

/// Continued from any cut around a packed chunk, a log shows all that the whole one does, and no byte of it is out of place.
#[test]
fn a_log_with_pictures_goes_on() {
    let run = synthetic::run(3, 7);
    let bytes = bytes_with_pictures(&run);
    let place = Sandbox::new();
    let cuts = packed(&bytes).into_iter().flat_map(|place| {
        let middle = (place.start + place.end) / 2;
        [place.start, place.start + 5, middle, place.end - 3, place.end, place.end + 40]
    });
    for (number, cut) in cuts.enumerate() {
        let name = format!("{number}.mcap");
        place.write(&name, &bytes[..cut]);
        let path = place.file(&name);
        let resumed = JournalWriter::resume(&path, &synthetic::manifest(), SyncPolicy::AtEnd).unwrap();
        let (mut writer, log) = (resumed.writer.with_viewer(Pictures::on(SCENE_TOPIC)), resumed.log);
        run[log.commits()..].iter().for_each(|(state, record)| writer.commit(state, record).unwrap());
        writer.finish().unwrap();
        let again = fs::read(&path).unwrap();
        assert_prefix(&Log::read(&path).unwrap(), &run);
        assert_eq!(shown(&again), shown_of(7), "cut at {cut}");
        assert_faultless(&path);

        let copy = place.file(&format!("copy-{number}.mcap"));
        recover(&path, &copy).unwrap();
        assert_eq!(fs::read(&copy).unwrap(), again, "a copy is the same to the byte");
    }
}

#[track_caller]
fn assert_faultless(path: &Path) {
    let faults: Vec<_> = verify(path).into_iter().filter(|finding| finding.level > Level::Info).collect();
    assert!(faults.is_empty(), "{faults:?}");
}

/// A long log with pictures is continued by its index, which knows where they lie: the summary names every one.
#[test]
fn a_long_log_with_pictures_goes_on() {
    const STAGES: usize = 6000;
    let run = synthetic::run(2, STAGES + 3);
    let place = Sandbox::new();
    let path = place.file("long.mcap");
    let writer = JournalWriter::create(&path, &synthetic::manifest(), SyncPolicy::AtEnd).unwrap();
    let mut writer = writer.with_viewer(Pictures::on(SCENE_TOPIC));
    run[..STAGES].iter().for_each(|(state, record)| writer.commit(state, record).unwrap());
    writer.close().unwrap();
    assert_eq!(place.logs(), ["long.mcap", "long.mcap.index"]);
    assert_faultless(&path);
    let long = LongLog::open(&path).unwrap().unwrap();
    assert!(long.tail().entries().len() < 3000, "by its index");
    for stage in [0, 1, 1023, 1024, 4000, STAGES - 1] {
        assert_eq!(long.record(stage).unwrap(), run[stage].1);
        assert!(long.part(stage..stage + 1).unwrap().problems().is_empty());
    }
    let resumed = JournalWriter::resume(&path, &synthetic::manifest(), SyncPolicy::AtEnd).unwrap();
    assert!(resumed.log.entries().len() < 3000, "by its index");
    let mut writer = resumed.writer.with_viewer(Pictures::on(SCENE_TOPIC));
    run[STAGES..].iter().for_each(|(state, record)| writer.commit(state, record).unwrap());
    writer.finish().unwrap();
    assert_faultless(&path);
    let bytes = fs::read(&path).unwrap();
    assert_eq!(shown(&bytes), shown_of(STAGES as u64 + 3));
    assert_eq!(packed(&bytes).len(), (STAGES + 3) * 2 / 3);
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
