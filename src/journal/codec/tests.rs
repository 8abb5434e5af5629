//! Bytes that no state encodes to.

use super::older::{PathV3, StateV1, StateV3, StateV5, StateV6};
use super::*;
use crate::journal::Flaw;
use crate::state::{Course, Patch, PathMemory};

fn on_a_path() -> State {
    let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let control_points = (0..9).map(|i| [f64::from(i), 2.0, 3.0, 1.0]).collect();
    let mut state = State::undeformed(Patch { degree: [2, 2], knots: [knots.clone(), knots], control_points });
    state.largest_force_n = 1.0;
    state.drive.course = Course::Path(PathMemory {
        heading: vec![[1.0, 0.0, 0.0]; 9],
        parameter_rate: 0.5,
        first_mm: 1.0,
        next_mm: 1.0,
        travelled_mm: 1.0,
        critical_ahead: None,
        at_bifurcation: false,
    });
    state
}

#[test]
fn a_state_with_a_path_is_read_as_it_was_written() {
    let state = on_a_path();
    let encoded = encode_state(&state).unwrap();
    let read = |bytes: &[u8]| {
        let field = |asked| encoded.fields.iter().find(|field| field.hash == asked).map(|field| &field.bytes[..]);
        decode_state(bytes, field, state.mesh.clone(), state.mesh.hash(), state.hash())
    };
    assert_eq!(read(&encoded.state).unwrap(), state);
}

/// Bytes that name a field too many, or one too few, for their course are not read.
#[test]
fn fields_are_those_of_the_course() {
    let state = on_a_path();
    let encoded = encode_state(&state).unwrap();
    let read = |fields: Vec<[u8; 32]>| {
        let mut stored: StateV8 = decode(8, &encoded.state).unwrap();
        stored.base.fields = fields;
        let bytes = encode(8, &stored).unwrap();
        let field = |_| Some(&encoded.fields[0].bytes[..]);
        decode_state(&bytes, field, state.mesh.clone(), state.mesh.hash(), state.hash()).unwrap_err()
    };
    let hash = *encoded.fields[0].hash.as_bytes();
    for count in [0, 1, 3, 9] {
        let error = read(vec![hash; count]);
        assert!(matches!(error, CodecError::FieldCount { found } if found == count), "{error}");
    }
    assert!(matches!(read(vec![hash; 2]), CodecError::ContentHash { .. }));
}

/// A state has one course behind it: bytes of version 6 with two are not read as either.
#[test]
fn a_load_step_and_a_path_behind_one_state_are_refused() {
    let state = on_a_path();
    let base = StateV1 {
        mesh: *state.mesh.hash().as_bytes(),
        displacement: [0; 32],
        marked: Default::default(),
        refined: None,
        step: 0,
        stage: None,
        parameter: 0.0,
        moment_n_mm: 0.0,
        strain_energy_n_mm: 0.0,
        negative_pivots: 0,
        halvings: 0,
        jump_beyond: None,
        rejection: None,
    };
    let path = PathV3 {
        heading: vec![[1.0, 0.0, 0.0]; 9],
        parameter_rate: 0.5,
        first_mm: 1.0,
        next_mm: 1.0,
        travelled_mm: 1.0,
        critical_ahead: None,
        at_bifurcation: false,
    };
    let after = StateV3 { base, turns: Vec::new(), path: Some(path) };
    let after = StateV5 { after, previous_parameter: None, doublings: 0 };
    let mut stored = StateV6 { after, largest_force_n: 1.0, refinement: None };
    let displacement = encode_field(&state.displacement);
    let read = |stored: &StateV6| {
        let bytes = encode(6, stored).unwrap();
        decode_state(&bytes, |_| Some(&displacement), state.mesh.clone(), state.mesh.hash(), state.hash())
    };
    assert_eq!(read(&stored).unwrap(), state);
    stored.after.previous_parameter = Some(7.0);
    let error = read(&stored).unwrap_err();
    assert!(matches!(error, CodecError::Unsound(Flaw::TwoCourses)), "{error}");
}

/// Made at once, as a block.
#[test]
fn a_field_is_what_bincode_makes_of_it() {
    let vectors: Vec<[f64; 3]> = (0..7).map(|i| [f64::from(i), -0.0, 1.0 / f64::from(i)]).collect();
    for count in 0..vectors.len() {
        let slow = encode(1, &FieldV1(Cow::from(&vectors[..count]))).unwrap();
        assert_eq!(encode_field(&vectors[..count]), slow);
    }
}
