//! States as they were written up to version 6, when each was written in the oldest version that held it.

use std::borrow::Cow;

use serde::Deserialize;
#[cfg(test)]
use serde::Serialize;

use super::bytes::{CodecError, decode};
use super::versions::{CourseV7, MeshV1, PathV7, RefinementV6, RejectionV1, StageV1, StateV7, StateV8};
use crate::journal::soundness::Flaw;

/// Its one field holds the displacements and, from version 4 on, behind them those of the equilibrium before.
#[derive(Deserialize)]
#[cfg_attr(test, derive(Serialize))]
pub(super) struct StateV1 {
    pub mesh: [u8; 32],
    pub displacement: [u8; 32],
    pub marked: [Vec<f64>; 2],
    pub refined: Option<MeshV1<'static>>,
    pub step: u64,
    pub stage: Option<StageV1>,
    pub parameter: f64,
    pub moment_n_mm: f64,
    pub strain_energy_n_mm: f64,
    pub negative_pivots: u64,
    /// 0 where the increment has grown instead.
    pub halvings: u32,
    pub jump_beyond: Option<f64>,
    pub rejection: Option<RejectionV1>,
}

/// Rigid sections that turn freely.
#[derive(Deserialize)]
#[cfg_attr(test, derive(Serialize))]
pub(super) struct StateV2 {
    pub base: StateV1,
    pub turns: Vec<[f64; 3]>,
}

/// Fields added with continuation by arc length.
#[derive(Deserialize)]
#[cfg_attr(test, derive(Serialize))]
pub(super) struct StateV3 {
    pub base: StateV1,
    pub turns: Vec<[f64; 3]>,
    pub path: Option<PathV3>,
}

/// The equilibrium before.
#[derive(Deserialize)]
#[cfg_attr(test, derive(Serialize))]
pub(super) struct StateV4 {
    pub after: StateV3,
    pub previous_parameter: f64,
}

/// An increment that has grown.
#[derive(Deserialize)]
#[cfg_attr(test, derive(Serialize))]
pub(super) struct StateV5 {
    pub after: StateV3,
    pub previous_parameter: Option<f64>,
    pub doublings: u32,
}

/// The largest force met, and what the last refinement changed.
#[derive(Deserialize)]
#[cfg_attr(test, derive(Serialize))]
pub(super) struct StateV6 {
    pub after: StateV5,
    pub largest_force_n: f64,
    pub refinement: Option<RefinementV6>,
}

#[derive(Deserialize)]
#[cfg_attr(test, derive(Serialize))]
pub(super) struct PathV3 {
    pub heading: Vec<[f64; 3]>,
    pub parameter_rate: f64,
    pub first_mm: f64,
    pub next_mm: f64,
    pub travelled_mm: f64,
    pub critical_ahead: Option<[f64; 2]>,
    pub at_bifurcation: bool,
}

/// A state of before in the present version, whose one field may hold two, and the heading of its path.
pub(super) struct Older {
    pub state: StateV8<'static>,
    pub heading: Option<Vec<[f64; 3]>>,
}

/// The state that the bytes of an older version hold.
pub(super) fn decode_older(bytes: &[u8]) -> Result<Older, CodecError> {
    let sixth = |after| StateV6 { after, largest_force_n: 0.0, refinement: None };
    let third = |after| sixth(StateV5 { after, previous_parameter: None, doublings: 0 });
    let stored = match bytes.first() {
        Some(7) => {
            return Ok(Older { state: StateV8::from(decode::<StateV7>(7, bytes)?), heading: None });
        }
        Some(6) => decode(6, bytes)?,
        Some(5) => sixth(decode(5, bytes)?),
        Some(4) => {
            let StateV4 { after, previous_parameter } = decode(4, bytes)?;
            sixth(StateV5 { after, previous_parameter: Some(previous_parameter), doublings: 0 })
        }
        Some(3) => third(decode(3, bytes)?),
        Some(2) => {
            let StateV2 { base, turns } = decode(2, bytes)?;
            third(StateV3 { base, turns, path: None })
        }
        _ => third(StateV3 { base: decode(1, bytes)?, turns: Vec::new(), path: None }),
    };
    stored.into_present()
}

impl StateV6 {
    fn into_present(self) -> Result<Older, CodecError> {
        let Self { after: StateV5 { after, previous_parameter, doublings }, largest_force_n, refinement } = self;
        let StateV3 { base, turns, path } = after;
        let (course, heading) = match (path, previous_parameter) {
            (None, None) => (CourseV7::Unknown, None),
            (None, Some(parameter)) => (CourseV7::Load { parameter }, None),
            (Some(path), None) => {
                let PathV3 { heading, parameter_rate, first_mm, next_mm, travelled_mm, critical_ahead, at_bifurcation } =
                    path;
                let path = PathV7 { parameter_rate, first_mm, next_mm, travelled_mm, critical_ahead, at_bifurcation };
                (CourseV7::Path(path), Some(heading))
            }
            (Some(_), Some(_)) => return Err(Flaw::TwoCourses.into()),
        };
        let state = StateV7 {
            mesh: base.mesh,
            fields: vec![base.displacement],
            marked: base.marked.map(Cow::Owned),
            refined: base.refined,
            step: base.step,
            stage: base.stage,
            parameter: base.parameter,
            turns: Cow::Owned(turns),
            moment_n_mm: base.moment_n_mm,
            strain_energy_n_mm: base.strain_energy_n_mm,
            negative_pivots: base.negative_pivots,
            // One of the two is 0; where a changed byte makes it another number, the hash sees it.
            halvings: base.halvings.wrapping_sub(doublings).cast_signed(),
            jump_beyond: base.jump_beyond,
            rejection: base.rejection,
            course,
            largest_force_n,
            refinement,
        };
        Ok(Older { state: state.into(), heading })
    }
}
