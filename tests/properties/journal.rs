//! The journal: what goes in comes out bit for bit, and what did not go in does not come out.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::Arc;

use foldline::journal::{
    JournalWriter, Log, check_state, decode_mesh, decode_state, encode_mesh, encode_state, message, verify_log,
};
use foldline::scene::{Stage, SyncPolicy};
use foldline::state::{
    Course, CriticalAhead, DriveMemory, Estimate, Hash, KnotLists, Mesh, Patch, PathMemory, Previous, Refinement,
    Rejection, State, StepControl,
};
use proptest::prelude::*;

use crate::synthetic;

fn number() -> impl Strategy<Value = f64> {
    use prop::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    POSITIVE | NEGATIVE | NORMAL | SUBNORMAL | ZERO
}

/// Open knots with interior multiplicities up to the degree.
fn knots(degree: usize) -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec((0.01..1.0_f64, 1..=degree), 0..5).prop_map(move |inner| {
        let mut at = 0.0;
        let mut knots = vec![0.0; degree + 1];
        for (step, multiplicity) in inner {
            at += step;
            knots.extend(std::iter::repeat_n(at, multiplicity));
        }
        knots.extend(std::iter::repeat_n(at + 1.0, degree + 1));
        knots
    })
}

fn mesh() -> impl Strategy<Value = Mesh> {
    prop::collection::vec(patch(), 1..=3).prop_map(|patches| Mesh { patches })
}

fn patch() -> impl Strategy<Value = Patch> {
    (2..=5_usize, 2..=5_usize).prop_flat_map(|(first, second)| {
        (knots(first), knots(second)).prop_flat_map(move |(along_length, along_arc)| {
            let count = (along_length.len() - first - 1) * (along_arc.len() - second - 1);
            let points = prop::collection::vec(prop::array::uniform4(number()), count);
            points.prop_map(move |points| Patch {
                degree: [first, second],
                knots: [along_length.clone(), along_arc.clone()],
                control_points: points.into_iter().map(|[x, y, z, w]| [x, y, z, w.abs().max(1e-9)]).collect(),
            })
        })
    })
}

/// Knots of the last patch, and none of the others.
fn of_last(mesh: &Mesh, knots: [Vec<f64>; 2]) -> KnotLists {
    let mut lists = mesh.no_knots();
    *lists.last_mut().unwrap() = knots;
    lists
}

/// The first knot along v of the last patch.
fn last_knot(mesh: &Mesh) -> Vec<f64> {
    mesh.patches.last().unwrap().knots[1][..1].to_vec()
}

fn stage() -> impl Strategy<Value = Option<Stage>> {
    prop::option::of(prop::sample::select(Stage::ALL.to_vec()))
}

fn state() -> impl Strategy<Value = State> {
    let control = (any::<i32>(), prop::option::of(number()), 0..5_u8).prop_map(|(halvings, jump_beyond, why)| {
        let rejection = [
            None,
            Some(Rejection::Jump),
            Some(Rejection::NoEquilibrium),
            Some(Rejection::CriticalPoint),
            Some(Rejection::SharpTurn),
        ][usize::from(why)];
        StepControl { halvings, jump_beyond, rejection }
    });
    let refined = any::<bool>();
    let marks = prop::collection::vec(0.001..0.999_f64, 0..3);
    let scalars = (number(), number(), number(), any::<u64>(), any::<u64>());
    (mesh(), refined, marks, stage(), scalars, control).prop_flat_map(
        |(mesh, refined, marks, stage, (rotation, moment, energy, pivots, step), control)| {
            let mesh = Arc::new(mesh);
            prop::collection::vec(prop::array::uniform3(number()), mesh.point_count()).prop_map(move |displacement| {
                State {
                    turns: if step % 2 == 0 { vec![[rotation, 0.5, -1.0]] } else { vec![] },
                    mesh: mesh.clone(),
                    displacement,
                    marked: of_last(&mesh, [marks.clone(), Vec::new()]),
                    superfluous: of_last(
                        &mesh,
                        [Vec::new(), if step % 7 == 0 { last_knot(&mesh) } else { Vec::new() }],
                    ),
                    estimate: (step % 4 == 0).then_some(Estimate {
                        step: pivots,
                        relative_error: rotation,
                        largest_indicator: [energy, moment],
                    }),
                    refined: refined.then(|| mesh.clone()),
                    step,
                    stage,
                    parameter: rotation,
                    moment_n_mm: moment,
                    strain_energy_n_mm: energy,
                    negative_pivots: pivots,
                    drive: DriveMemory {
                        control,
                        course: match pivots % 3 {
                            0 => Course::Path(PathMemory {
                                heading: vec![[energy, moment, 0.25]; mesh.point_count()],
                                parameter_rate: energy,
                                first_mm: moment,
                                next_mm: rotation,
                                travelled_mm: 3.5,
                                critical_ahead: (pivots % 2 == 0)
                                    .then_some(CriticalAhead { within_mm: moment, rate_beyond: rotation }),
                                at_bifurcation: step % 3 == 0,
                            }),
                            1 => Course::Load(Previous {
                                displacement: vec![[moment, rotation, -1.5]; mesh.point_count()],
                                parameter: energy,
                            }),
                            _ => Course::Unknown,
                        },
                    },
                    largest_force_n: if step % 5 == 0 { 0.0 } else { moment.abs() },
                    refinement: (pivots % 5 == 0).then_some(Refinement {
                        changed_n_mm: energy,
                        growth: rotation,
                        expected_n_mm: (pivots % 2 == 0).then_some(moment),
                        ripple_n_mm: moment,
                    }),
                }
            })
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn states_come_back_bit_for_bit(state in state()) {
        prop_assert!(check_state(&state).is_ok());
        let (mesh_hash, hash) = (state.mesh.hash(), state.hash());
        let mesh = decode_mesh(&encode_mesh(&state.mesh).unwrap(), mesh_hash).unwrap();
        prop_assert_eq!(mesh.hash(), mesh_hash);
        let bytes = encode_state(&state).unwrap();
        let find = |asked: Hash| bytes.fields.iter().find(|field| field.hash == asked).map(|field| &field.bytes[..]);
        let back = decode_state(&bytes.state, find, Arc::new(mesh), mesh_hash, hash).unwrap();
        prop_assert_eq!(back.hash(), hash);
        prop_assert_eq!(encode_state(&back).unwrap(), bytes);
    }

    #[test]
    fn changed_bytes_never_decode(state in state(), place in any::<prop::sample::Index>(), flip in 1..=255_u8) {
        let (mesh_hash, hash) = (state.mesh.hash(), state.hash());
        let good = encode_state(&state).unwrap();
        let bytes = flipped(good.state.clone(), place, flip);
        let find = |asked: Hash| good.fields.iter().find(|field| field.hash == asked).map(|field| &field.bytes[..]);
        prop_assert!(decode_state(&bytes, find, state.mesh.clone(), mesh_hash, hash).is_err());
        for changed in &good.fields {
            let bytes = flipped(changed.bytes.clone(), place, flip);
            let find = |asked: Hash| if asked == changed.hash { Some(&bytes[..]) } else { find(asked) };
            prop_assert!(decode_state(&good.state, find, state.mesh.clone(), mesh_hash, hash).is_err());
        }
        let bytes = flipped(encode_mesh(&state.mesh).unwrap(), place, flip);
        prop_assert!(decode_mesh(&bytes, mesh_hash).is_err());
    }

    #[test]
    fn arbitrary_bytes_are_no_state(mut bytes in prop::collection::vec(any::<u8>(), 0..400), version in any::<bool>()) {
        if let (true, Some(first)) = (version, bytes.first_mut()) {
            *first = foldline::journal::CODEC_VERSION;
        }
        let hash = Hash::from_bytes([0; 32]);
        prop_assert!(decode_mesh(&bytes, hash).is_err());
        let mesh = synthetic::start(1).mesh;
        prop_assert!(decode_state(&bytes, |_| Some(&bytes[..]), mesh, hash, hash).is_err());
    }

    #[test]
    fn arbitrary_bytes_are_no_log(bytes in prop::collection::vec(any::<u8>(), 0..3000), magic in any::<bool>()) {
        let mut file = if magic { mcap::MAGIC.to_vec() } else { Vec::new() };
        file.extend(bytes);
        prop_assert!(Log::from_bytes(file).is_err());
    }

    /// Pieces of a log cut out, repeated, overwritten: what is read is a beginning of the run.
    #[test]
    fn mangled_logs_give_a_beginning_of_the_run(
        edits in prop::collection::vec((any::<prop::sample::Index>(), any::<prop::sample::Index>(), 1..600_usize, 0..4_u8), 1..6)
    ) {
        let (run, mut bytes) = log();
        for (from, to, len, kind) in edits {
            let (from, to) = (from.index(bytes.len()), to.index(bytes.len()));
            let piece = bytes[from..bytes.len().min(from + len)].to_vec();
            match kind {
                0 => drop(bytes.drain(from..from + piece.len())),
                1 => drop(bytes.splice(to..to, piece)),
                2 => {
                    let end = bytes.len().min(to + piece.len());
                    bytes.splice(to..end, piece);
                }
                _ => bytes[from..from + piece.len()].iter_mut().for_each(|byte| *byte = byte.wrapping_add(len as u8)),
            }
            if bytes.is_empty() {
                break;
            }
        }
        if let Ok(log) = Log::from_bytes(bytes) {
            for (index, (entry, (state, record))) in log.entries().iter().zip(&run).enumerate() {
                prop_assert_eq!(&entry.record, record);
                prop_assert_eq!(&log.state(index).unwrap(), state);
            }
            verify_log(&log);
        }
    }

    /// Well-formed MCAP with the log's topics, right checksums, and nonsense in the messages.
    #[test]
    fn nonsense_in_good_frames_is_no_commit(
        messages in prop::collection::vec((0..6_usize, nonsense(), any::<bool>()), 1..12)
    ) {
        let topics = ["/foldline/mesh", "/foldline/state", "/foldline/report", "/foldline/commit", "/foldline/finished", "/other"];
        let mut writer = mcap::WriteOptions::new().profile("foldline").compression(None).create(std::io::Cursor::new(Vec::new())).unwrap();
        for (topic, data, flush) in messages {
            let channel = writer.add_channel(0, topics[topic], "json", &BTreeMap::new()).unwrap();
            let header = mcap::records::MessageHeader { channel_id: channel, sequence: 0, log_time: 0, publish_time: 0 };
            writer.write_to_known_channel(&header, &data).unwrap();
            if flush {
                writer.flush().unwrap();
            }
        }
        writer.finish().unwrap();
        let log = Log::from_bytes(writer.into_inner().into_inner()).unwrap();
        prop_assert!(log.entries().is_empty());
        verify_log(&log);
    }

    #[test]
    fn reports_come_back_bit_for_bit(values in prop::array::uniform9(any::<f64>()), counts in any::<[u32; 4]>()) {
        let (_, mut record) = synthetic::run(2, 1).remove(0);
        let report = &mut record.report;
        [report.parameter, report.attempted_parameter, report.moment_n_mm] = [values[0], values[1], values[2]];
        [report.strain_energy_n_mm, report.residual] = [values[3], values[4]];
        report.energy_released_n_mm = (values[5] >= 0.0).then_some(values[5]);
        report.largest_indicator = [values[6], values[7]];
        [report.iterations, report.unknowns, report.marked[0], report.marked[1]] = counts.map(|count| count as usize);
        record.wall_s = values[8];
        let json = message::ReportMessage::new(&record).to_json().unwrap();
        let back = message::ReportMessage::from_json(&json).unwrap();
        // NaN is not equal to itself, so the comparison is of what is written.
        prop_assert_eq!(format!("{:?}", (&back.report, back.wall_s)), format!("{:?}", (&record.report, record.wall_s)));
        prop_assert_eq!(back.to_json().unwrap(), json);
    }
}

fn flipped(mut bytes: Vec<u8>, place: prop::sample::Index, flip: u8) -> Vec<u8> {
    let place = place.index(bytes.len());
    bytes[place] ^= flip;
    bytes
}

fn nonsense() -> impl Strategy<Value = Cow<'static, [u8]>> {
    let (_, record) = synthetic::run(2, 1).remove(0);
    let report = message::ReportMessage::new(&record).to_json().unwrap();
    let commit = message::seal(&message::CommitMessage::new(
        &record.commit,
        record.commit.state_hash,
        record.commit.state_hash,
        &[Hash::from_bytes([4; 32])],
        Vec::new(),
    ))
    .unwrap();
    let end = message::seal(&message::FinishedMessage::after(&record.commit, Hash::from_bytes([4; 32]))).unwrap();
    prop_oneof![
        prop::collection::vec(any::<u8>(), 0..200).prop_map(Cow::Owned),
        Just(Cow::Owned(report)),
        Just(Cow::Owned(commit)),
        Just(Cow::Owned(end)),
        Just(Cow::Borrowed(&b"{}"[..])),
    ]
}

/// A run and its log.
fn log() -> (Vec<(State, foldline::record::Record)>, Vec<u8>) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("run.mcap");
    let run = synthetic::run(2, 6);
    let mut writer = JournalWriter::create(&path, &synthetic::manifest(), SyncPolicy::AtEnd).unwrap();
    run.iter().for_each(|(state, record)| writer.commit(state, record).unwrap());
    writer.finish().unwrap();
    (run, std::fs::read(&path).unwrap())
}
