//! Bytes that no state encodes to.

use super::*;
use crate::state::PathMemory;

fn on_a_path() -> State {
    let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let control_points = (0..9).map(|i| [f64::from(i), 2.0, 3.0, 1.0]).collect();
    let mut state = State::undeformed(Mesh { degree: [2, 2], knots: [knots.clone(), knots], control_points });
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

/// A state has one course behind it: bytes with two are not read as either.
#[test]
fn a_load_step_and_a_path_behind_one_state_are_refused() {
    let state = on_a_path();
    let encoded = encode_state(&state).unwrap();
    let read = |bytes: &[u8]| {
        let displacement = |_| Some(&encoded.displacement[..]);
        decode_state(bytes, displacement, state.mesh.clone(), state.mesh.hash(), state.hash())
    };
    assert_eq!(read(&encoded.state).unwrap(), state);
    let mut both: StateV6 = decode(6, &encoded.state).unwrap();
    both.after.previous_parameter = Some(7.0);
    let error = read(&encode(6, &both).unwrap()).unwrap_err();
    assert!(matches!(error, CodecError::Unsound(Flaw::TwoCourses)), "{error}");
}

/// Made at once, as a block.
#[test]
fn displacements_are_what_bincode_makes_of_them() {
    let displacement: Vec<[f64; 3]> = (0..7).map(|i| [f64::from(i), -0.0, 1.0 / f64::from(i)]).collect();
    for before in 0..displacement.len() {
        let both = [&displacement[..], &displacement[..before]];
        let slow = encode(1, &DisplacementV1(Cow::from(both.concat()))).unwrap();
        assert_eq!(encode_displacements(both), slow);
    }
}
