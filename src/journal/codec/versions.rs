//! States and meshes as they are written: a change of [`State`](crate::state::State) changes none of these.

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

use crate::state::{Course, CriticalAhead, Estimate, KnotLists, Mesh, Patch, PathMemory, Previous, Refinement};

#[derive(Serialize, Deserialize)]
pub(super) struct MeshV1<'a> {
    pub degree: [u64; 2],
    pub knots: [Cow<'a, [f64]>; 2],
    pub control_points: Cow<'a, [[f64; 4]]>,
}

impl<'a> MeshV1<'a> {
    /// Borrows a patch in the form in which it is encoded.
    pub fn of(patch: &'a Patch) -> Self {
        Self {
            degree: patch.degree.map(|degree| degree as u64),
            knots: [0, 1].map(|direction| Cow::from(&patch.knots[direction])),
            control_points: Cow::from(&patch.control_points),
        }
    }

    /// Converts the decoded form to a patch.
    pub fn into_patch(self) -> Patch {
        Patch {
            degree: self.degree.map(|degree| usize::try_from(degree).unwrap_or(usize::MAX)),
            knots: self.knots.map(Cow::into_owned),
            control_points: self.control_points.into_owned(),
        }
    }
}

/// A mesh of several patches.
#[derive(Serialize, Deserialize)]
pub(super) struct MeshV2<'a>(pub Vec<MeshV1<'a>>);

impl<'a> MeshV2<'a> {
    /// Borrows a mesh in the form in which it is encoded.
    pub fn of(mesh: &'a Mesh) -> Self {
        Self(mesh.patches.iter().map(MeshV1::of).collect())
    }

    /// Converts the decoded form to a mesh.
    pub fn into_mesh(self) -> Mesh {
        Mesh { patches: self.0.into_iter().map(MeshV1::into_patch).collect() }
    }
}

/// A field: a vector at every control point. Up to version 6 of states, their displacements and behind them those of
/// the equilibrium before.
#[derive(Serialize, Deserialize)]
pub(super) struct FieldV1<'a>(pub Cow<'a, [[f64; 3]]>);

/// Version 9, which is written where the mesh has several patches: what version 8 has is that of the first.
#[derive(Serialize, Deserialize)]
pub(super) struct StateV9<'a> {
    pub base: StateV8<'a>,
    /// Marked and superfluous knots of each further patch.
    pub marked: Vec<[Cow<'a, [f64]>; 2]>,
    pub superfluous: Vec<[Cow<'a, [f64]>; 2]>,
    /// The finer mesh, whole.
    pub refined: Option<MeshV2<'a>>,
}

/// Borrows lists of knots.
pub(super) fn borrowed(lists: &[[Vec<f64>; 2]]) -> Vec<[Cow<'_, [f64]>; 2]> {
    lists.iter().map(|knots| knots.each_ref().map(Cow::from)).collect()
}

/// Puts the lists of the first patch and those of further patches together.
pub(super) fn owned(first: [Cow<'_, [f64]>; 2], more: Vec<[Cow<'_, [f64]>; 2]>) -> KnotLists {
    std::iter::once(first).chain(more).map(|knots| knots.map(Cow::into_owned)).collect()
}

/// Version 8, which is written where the mesh is one patch: with superfluous knots and the last estimate of the error.
#[derive(Serialize, Deserialize)]
pub(super) struct StateV8<'a> {
    pub base: StateV7<'a>,
    pub superfluous: [Cow<'a, [f64]>; 2],
    pub estimate: Option<EstimateV8>,
}

impl<'a> From<StateV7<'a>> for StateV8<'a> {
    fn from(base: StateV7<'a>) -> Self {
        Self { base, superfluous: Default::default(), estimate: None }
    }
}

#[derive(Serialize, Deserialize)]
pub(super) struct EstimateV8 {
    pub step: u64,
    pub relative_error: f64,
    pub largest_indicator: [f64; 2],
}

impl EstimateV8 {
    pub fn of(Estimate { step, relative_error, largest_indicator }: Estimate) -> Self {
        Self { step, relative_error, largest_indicator }
    }

    pub fn into_memory(self) -> Estimate {
        let Self { step, relative_error, largest_indicator } = self;
        Estimate { step, relative_error, largest_indicator }
    }
}

/// Version 7: every field by the hash of its bytes.
#[derive(Serialize, Deserialize)]
pub(super) struct StateV7<'a> {
    pub mesh: [u8; 32],
    /// The displacements, and what the course has: those of the equilibrium before, or the heading of the path.
    pub fields: Vec<[u8; 32]>,
    pub marked: [Cow<'a, [f64]>; 2],
    pub refined: Option<MeshV1<'a>>,
    pub step: u64,
    pub stage: Option<StageV1>,
    pub parameter: f64,
    pub turns: Cow<'a, [[f64; 3]]>,
    pub moment_n_mm: f64,
    pub strain_energy_n_mm: f64,
    pub negative_pivots: u64,
    pub halvings: i32,
    pub jump_beyond: Option<f64>,
    pub rejection: Option<RejectionV1>,
    pub course: CourseV7,
    pub largest_force_n: f64,
    pub refinement: Option<RefinementV6>,
}

/// A course without its field.
#[derive(Serialize, Deserialize)]
pub(super) enum CourseV7 {
    Unknown,
    Load { parameter: f64 },
    Path(PathV7),
}

#[derive(Serialize, Deserialize)]
pub(super) struct PathV7 {
    pub parameter_rate: f64,
    pub first_mm: f64,
    pub next_mm: f64,
    pub travelled_mm: f64,
    /// Length and rate.
    pub critical_ahead: Option<[f64; 2]>,
    pub at_bifurcation: bool,
}

impl CourseV7 {
    /// Converts a course to the form in which it is encoded, and returns its field apart.
    pub fn of(course: &Course) -> (Self, Option<&[[f64; 3]]>) {
        match course {
            Course::Unknown => (Self::Unknown, None),
            Course::Load(Previous { displacement, parameter }) => {
                (Self::Load { parameter: *parameter }, Some(displacement))
            }
            Course::Path(PathMemory {
                heading,
                parameter_rate,
                first_mm,
                next_mm,
                travelled_mm,
                critical_ahead,
                at_bifurcation,
            }) => {
                let path = PathV7 {
                    parameter_rate: *parameter_rate,
                    first_mm: *first_mm,
                    next_mm: *next_mm,
                    travelled_mm: *travelled_mm,
                    critical_ahead: critical_ahead
                        .map(|CriticalAhead { within_mm, rate_beyond }| [within_mm, rate_beyond]),
                    at_bifurcation: *at_bifurcation,
                };
                (Self::Path(path), Some(heading))
            }
        }
    }

    /// Converts the decoded form to a course with its field; `None` where a field is missing or is one too many.
    pub fn with(self, field: Option<Vec<[f64; 3]>>) -> Option<Course> {
        match (self, field) {
            (Self::Unknown, None) => Some(Course::Unknown),
            (Self::Load { parameter }, Some(displacement)) => Some(Course::Load(Previous { displacement, parameter })),
            (Self::Path(path), Some(heading)) => {
                let PathV7 { parameter_rate, first_mm, next_mm, travelled_mm, critical_ahead, at_bifurcation } = path;
                let critical_ahead =
                    critical_ahead.map(|[within_mm, rate_beyond]| CriticalAhead { within_mm, rate_beyond });
                Some(Course::Path(PathMemory {
                    heading,
                    parameter_rate,
                    first_mm,
                    next_mm,
                    travelled_mm,
                    critical_ahead,
                    at_bifurcation,
                }))
            }
            _ => None,
        }
    }
}

#[derive(Serialize, Deserialize)]
pub(super) struct RefinementV6 {
    pub changed_n_mm: f64,
    pub growth: f64,
    pub expected_n_mm: Option<f64>,
    pub ripple_n_mm: f64,
}

impl RefinementV6 {
    /// Converts to the form in which a refinement is encoded.
    pub fn of(Refinement { changed_n_mm, growth, expected_n_mm, ripple_n_mm }: Refinement) -> Self {
        Self { changed_n_mm, growth, expected_n_mm, ripple_n_mm }
    }

    /// Converts the decoded form to a refinement.
    pub fn into_memory(self) -> Refinement {
        let Self { changed_n_mm, growth, expected_n_mm, ripple_n_mm } = self;
        Refinement { changed_n_mm, growth, expected_n_mm, ripple_n_mm }
    }
}

#[derive(Serialize, Deserialize)]
pub(super) enum StageV1 {
    Solve,
    EvaluateIndicators,
    RefineKnots,
    ProjectDisplacements,
    ReEquilibrate,
    SwitchBranch,
    CoarsenKnots,
}

#[derive(Serialize, Deserialize)]
pub(super) enum RejectionV1 {
    NoEquilibrium,
    Jump,
    CriticalPoint,
    SharpTurn,
}
