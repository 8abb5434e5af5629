//! States and meshes as they are written, in every version: a change of [`State`](crate::state::State) changes none of these.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use crate::state::{CriticalAhead, Mesh, PathMemory, Refinement};

#[derive(Serialize, Deserialize)]
pub(super) struct MeshV1<'a> {
    pub degree: [u64; 2],
    pub knots: [Cow<'a, [f64]>; 2],
    pub control_points: Cow<'a, [[f64; 4]]>,
}

impl<'a> MeshV1<'a> {
    pub fn of(mesh: &'a Mesh) -> Self {
        Self {
            degree: mesh.degree.map(|degree| degree as u64),
            knots: [0, 1].map(|way| Cow::from(&mesh.knots[way])),
            control_points: Cow::from(&mesh.control_points),
        }
    }

    pub fn into_mesh(self) -> Mesh {
        Mesh {
            degree: self.degree.map(|degree| usize::try_from(degree).unwrap_or(usize::MAX)),
            knots: self.knots.map(Cow::into_owned),
            control_points: self.control_points.into_owned(),
        }
    }
}

#[derive(Serialize, Deserialize)]
pub(super) struct DisplacementV1<'a>(pub Cow<'a, [[f64; 3]]>);

#[derive(Serialize, Deserialize)]
pub(super) struct StateV1<'a> {
    pub mesh: [u8; 32],
    pub displacement: [u8; 32],
    pub marked: [Cow<'a, [f64]>; 2],
    pub refined: Option<MeshV1<'a>>,
    pub step: u64,
    pub stage: Option<StageV1>,
    pub parameter: f64,
    pub moment_n_mm: f64,
    pub strain_energy_n_mm: f64,
    pub negative_pivots: u64,
    /// 0 where the increment has grown instead.
    pub halvings: u32,
    pub jump_seen_at_deg: Option<f64>,
    pub rejection: Option<RejectionV1>,
}

/// Version 2: rigid sections that turn freely. Written only where there are any.
#[derive(Serialize, Deserialize)]
pub(super) struct StateV2<'a> {
    pub base: StateV1<'a>,
    pub turns: Cow<'a, [[f64; 3]]>,
}

/// Version 3: continuation by arc length, and what came with it. Written only where there is any of that.
#[derive(Serialize, Deserialize)]
pub(super) struct StateV3<'a> {
    pub base: StateV1<'a>,
    pub turns: Cow<'a, [[f64; 3]]>,
    pub path: Option<PathV3<'a>>,
}

/// Version 4: the equilibrium before. Its displacements stand behind the state's own, so that stages that change neither
/// write neither again.
#[derive(Serialize, Deserialize)]
pub(super) struct StateV4<'a> {
    pub after: StateV3<'a>,
    pub previous_parameter: f64,
}

/// Version 5: an increment that has grown. Written only where it has.
#[derive(Serialize, Deserialize)]
pub(super) struct StateV5<'a> {
    pub after: StateV3<'a>,
    pub previous_parameter: Option<f64>,
    pub doublings: u32,
}

/// Version 6: the largest force met, and what the last refinement changed. Every state of an equilibrium has the first.
#[derive(Serialize, Deserialize)]
pub(super) struct StateV6<'a> {
    pub after: StateV5<'a>,
    pub largest_force_n: f64,
    pub refinement: Option<RefinementV6>,
}

#[derive(Serialize, Deserialize)]
pub(super) struct RefinementV6 {
    pub changed_n_mm: f64,
    pub growth: f64,
    pub expected_n_mm: Option<f64>,
    pub ripple_n_mm: f64,
}

impl RefinementV6 {
    pub fn of(Refinement { changed_n_mm, growth, expected_n_mm, ripple_n_mm }: Refinement) -> Self {
        Self { changed_n_mm, growth, expected_n_mm, ripple_n_mm }
    }

    pub fn into_memory(self) -> Refinement {
        let Self { changed_n_mm, growth, expected_n_mm, ripple_n_mm } = self;
        Refinement { changed_n_mm, growth, expected_n_mm, ripple_n_mm }
    }
}

#[derive(Serialize, Deserialize)]
pub(super) struct PathV3<'a> {
    pub heading: Cow<'a, [[f64; 3]]>,
    pub parameter_rate: f64,
    pub first_mm: f64,
    pub next_mm: f64,
    pub travelled_mm: f64,
    /// Length and rate.
    pub critical_ahead: Option<[f64; 2]>,
    pub at_bifurcation: bool,
}

impl<'a> PathV3<'a> {
    pub fn of(path: &'a PathMemory) -> Self {
        let PathMemory { heading, parameter_rate, first_mm, next_mm, travelled_mm, critical_ahead, at_bifurcation } =
            path;
        Self {
            heading: Cow::from(heading),
            parameter_rate: *parameter_rate,
            first_mm: *first_mm,
            next_mm: *next_mm,
            travelled_mm: *travelled_mm,
            critical_ahead: critical_ahead.map(|CriticalAhead { within_mm, rate_beyond }| [within_mm, rate_beyond]),
            at_bifurcation: *at_bifurcation,
        }
    }

    pub fn into_memory(self) -> PathMemory {
        PathMemory {
            heading: self.heading.into_owned(),
            parameter_rate: self.parameter_rate,
            first_mm: self.first_mm,
            next_mm: self.next_mm,
            travelled_mm: self.travelled_mm,
            critical_ahead: self
                .critical_ahead
                .map(|[within_mm, rate_beyond]| CriticalAhead { within_mm, rate_beyond }),
            at_bifurcation: self.at_bifurcation,
        }
    }
}

#[derive(Serialize, Deserialize)]
pub(super) enum StageV1 {
    Solve,
    EvaluateIndicators,
    RefineKnots,
    ProjectDisplacements,
    ReEquilibrate,
    /// From version 3 on.
    SwitchBranch,
}

#[derive(Serialize, Deserialize)]
pub(super) enum RejectionV1 {
    NoEquilibrium,
    Jump,
    /// From version 3 on.
    CriticalPoint,
    /// From version 3 on.
    SharpTurn,
}
