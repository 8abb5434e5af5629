//! What a scene holds: plain data, every default filled in.
//!
//! | file | what |
//! |---|---|
//! | `geometry` | the undeformed surface |
//! | `material` | law and thickness |
//! | `mesh` | spline space and quadrature |
//! | `place` | places on the surface |
//! | `boundary` | supports and actions |
//! | `probe` | what reports read |
//! | `expectation` | how a run is to end |
//! | `output` | what is written besides the states |
//! | `structure`, `connection` | several shells, and what connects them |
//! | `section` | what hangs on rigid sections |
//! | `imperfection` | where the surfaces differ from the perfect ones |

mod boundary;
mod connection;
mod expectation;
mod geometry;
mod imperfection;
mod material;
mod mesh;
mod output;
mod place;
mod probe;
mod section;
mod structure;

pub use boundary::{
    Action, ActionKind, ForceVector, FreeWord, History, Hold, LoadedArea, Motion, SectionTurns, Support,
    SurfaceDirection,
};
pub use connection::{Bond, Joint, JointKind};
pub use expectation::{Expectation, ExpectedOutcome};
pub use geometry::{Geometry, NurbsPatch, ProfilePiece, Seam};
pub use imperfection::{Imperfection, ImperfectionKind, OffsetGrid};
pub use material::{Material, OrthotropicLaw, Ply, Strengths};
pub use mesh::{MeshSpec, Quadrature};
pub use output::{NumbersIn, Output, SyncPolicy};
pub use place::{Axis, Edge, ParametricDirection, Region, ShellEdge};
pub use probe::{Component, Probe, ProbeKind, Reaction};
pub use section::{PointMass, Spring};
pub use structure::{Pose, Shell};

use std::borrow::Cow;

use serde::{Deserialize, Serialize};

/// A checked scene with all defaults filled in; a run is a function of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scene {
    /// Undeformed mid-surface; of several shells that of the first.
    pub geometry: Geometry,
    /// Constitutive law and thickness; of several shells those of the first.
    pub material: Material,
    /// Spline space and quadrature that the run starts with; of several shells those of the first.
    pub mesh: MeshSpec,
    /// Where the axes of the geometry lie.
    #[serde(default, skip_serializing_if = "Pose::is_none")]
    pub pose: Pose,
    /// The shells of a structure; empty where there is one shell, which needs no name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub shells: Vec<Shell>,
    /// What joins shells along edges.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joints: Vec<Joint>,
    /// What joins shells over areas.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bonds: Vec<Bond>,
    /// Where the undeformed surfaces differ from the perfect ones.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub imperfections: Vec<Imperfection>,
    /// Which part of the shell is modelled.
    pub symmetry: Symmetry,
    /// What drives the run: how far, and in which steps.
    pub load: Load,
    /// Where and how the shell is held; empty where [`Load::EndRotation`] holds its ends.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub supports: Vec<Support>,
    /// Springs between rigid sections and the ground.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub springs: Vec<Spring>,
    /// Point masses on rigid sections.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub masses: Vec<PointMass>,
    /// Forces, moments and pressures.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub actions: Vec<Action>,
    /// Quantities that every equilibrium reports by name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub probes: Vec<Probe>,
    /// When and how far the mesh is refined; `None` where no stage of the pipeline refines.
    pub adapt: Option<Adapt>,
    /// Tolerances and limits of the equilibrium solver.
    pub solver: Solver,
    /// How the path of equilibria is followed where not by increments of the parameter.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub continuation: Option<ArcLength>,
    /// The stages of one load step, in order.
    pub pipeline: Vec<Stage>,
    /// Which outputs are written besides the states; they never change a state.
    pub output: Output,
    /// How the run is to end; nothing but a test of the scene looks at it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub expect: Option<Expectation>,
}

impl Scene {
    /// Direction away from the axis or the centre of the shell at a point; `None` where the geometry has neither.
    pub fn away_from_centre(&self, point: [f64; 3]) -> Option<[f64; 3]> {
        self.geometry.away_from_centre(self.pose.own(point)).map(|direction| self.pose.turned(direction))
    }

    /// Number of shells.
    pub fn shell_count(&self) -> usize {
        self.shells.len().max(1)
    }

    /// Name of a shell; `None` where the scene has one shell, which has no name.
    pub fn shell_name(&self, shell: usize) -> Option<&str> {
        self.shells.get(shell).map(|shell| &*shell.name)
    }

    /// The scene of one perfect shell alone, with the supports, actions and probes that are its own, and the actions on all shells.
    /// A scene of one shell is returned as it is.
    pub fn of_shell(&self, shell: usize) -> Cow<'_, Scene> {
        let Some(own) = self.shells.get(shell) else { return Cow::Borrowed(self) };
        let supports = self.supports.iter().filter_map(|support| support.of_shell(shell));
        let actions = self.actions.iter().filter(|action| action.shell.is_none_or(|on| on == shell)).cloned();
        let probes = self.probes.iter().filter(|probe| probe.shell == shell).cloned();
        Cow::Owned(Scene {
            geometry: own.geometry.clone(),
            material: own.material.clone(),
            mesh: own.mesh.clone(),
            pose: own.pose,
            supports: supports.collect(),
            actions: actions.collect(),
            probes: probes.collect(),
            shells: Vec::new(),
            joints: Vec::new(),
            bonds: Vec::new(),
            springs: Vec::new(),
            masses: Vec::new(),
            imperfections: Vec::new(),
            ..self.clone()
        })
    }
}

/// The part of the shell that is modelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Symmetry {
    /// The whole shell.
    None,
    /// One half, cut at mid-length.
    HalfLength,
    /// One half, cut along the apex line.
    HalfArc,
    /// One quarter, cut both ways.
    Quarter,
}

impl Symmetry {
    /// Whether the model is cut across the length and along the arc.
    pub fn cuts(self) -> [bool; 2] {
        match self {
            Symmetry::None => [false, false],
            Symmetry::HalfLength => [true, false],
            Symmetry::HalfArc => [false, true],
            Symmetry::Quarter => [true, true],
        }
    }

    /// Number of models that make up the whole shell: 1, 2 or 4. Energies of the model times this are those of the
    /// shell.
    pub fn copies(self) -> usize {
        self.cuts().iter().map(|cut| 1 + usize::from(*cut)).product()
    }
}

/// The sense of the bending relative to the curvature of the cross-section.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Sense {
    /// Longitudinal curvature of the other sign: free edges in tension.
    Opposite,
    /// Longitudinal curvature of the same sign: free edges in compression.
    Equal,
}

/// What drives a run. Its *parameter* grows from 0 by increments: the rotation θ of the ends in degrees, or the load
/// factor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Load {
    /// The ends of a tape spring turn.
    EndRotation(EndRotation),
    /// Actions and given motions of supports follow the load factor, each by its own history.
    Steps(LoadSteps),
}

impl Load {
    /// The value of the parameter at which the run stops.
    pub fn target(&self) -> f64 {
        match self {
            Load::EndRotation(load) => load.rotation_deg,
            Load::Steps(load) => load.factor,
        }
    }

    /// The increment of the parameter in one load step.
    pub fn increment(&self) -> f64 {
        match self {
            Load::EndRotation(load) => load.increment_deg,
            Load::Steps(load) => load.increment,
        }
    }

    /// The largest increment of the parameter, to which increments grow where solves are easy; the increment itself
    /// where they do not grow.
    pub fn longest_increment(&self) -> f64 {
        let longest = match self {
            Load::EndRotation(load) => load.longest_increment_deg,
            Load::Steps(load) => load.longest_increment,
        };
        longest.unwrap_or(self.increment())
    }
}

/// A load that is applied in steps of the load factor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LoadSteps {
    /// Load factor at which the run stops, > 0.
    pub factor: f64,
    /// Increment of the load factor in one load step.
    pub increment: f64,
    /// Increments grow to this where solves are easy; `None` where they do not grow.
    pub longest_increment: Option<f64>,
    /// Increments are not cut below this; then the run stops with all good steps kept.
    pub least_increment: f64,
    /// A jump is located to this load factor before the run continues beyond it.
    pub snap_tolerance: f64,
}

/// A load that turns the end sections by +θ and −θ about the transverse axis through their centroids.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct EndRotation {
    /// Sense of the bending.
    pub sense: Sense,
    /// Rotation of each end at which the run stops, θ > 0 (degrees).
    pub rotation_deg: f64,
    /// Rotation increment of one load step (degrees).
    pub increment_deg: f64,
    /// Increments grow to this where solves are easy (degrees); `None` where they do not grow.
    pub longest_increment_deg: Option<f64>,
}

/// When and how far the mesh is refined.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Adapt {
    /// What marks a knot span.
    #[serde(flatten)]
    pub indicator: Indicator,
    /// Elements are not split below this length.
    pub length_limit: LengthLimit,
    /// How spans that are marked by their bending strain are split.
    #[serde(default, skip_serializing_if = "Splitting::is_halves")]
    pub splitting: Splitting,
}

/// What marks a knot span for refinement, in the JSON form by the key that it has in `[adapt]`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Indicator {
    /// The paper's: max|κ| h exceeds r₀ in its direction (dimensionless). One number in the JSON form where both are equal.
    #[serde(rename = "threshold", with = "one_or_pair")]
    BendingStrain([f64; 2]),
    /// The mesh may cause this relative error of what the scene measures.
    #[serde(rename = "tolerance")]
    Error(f64),
}

/// How a marked knot span is split.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Splitting {
    /// In two halves.
    #[default]
    Halves,
    /// In as many parts as indicator and length limit ask for.
    Parts,
}

impl Splitting {
    fn is_halves(&self) -> bool {
        *self == Splitting::Halves
    }
}

/// The least length of an element.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LengthLimit {
    /// √(R t) with the least radius of curvature R of the undeformed shell: the decay length of bending.
    SqrtRadiusThickness,
    /// ½ √(R t) with the least radius of curvature R of the undeformed shell, or with its shorter side where that is less:
    /// forces on points and at free edges bend over a part of the decay length.
    HalfDecayLength,
    /// The thickness t.
    Thickness,
    /// A length each way in mm. One number in the JSON form where both are equal.
    #[serde(with = "one_or_pair")]
    Millimetres([f64; 2]),
}

/// Tolerances and limits of the equilibrium solver.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Solver {
    /// A state is in equilibrium when |residual| ≤ tolerance · |forces|: the largest of reactions, loads and forces of the
    /// free strain, or a thousandth of the forces of the elements, or of the largest of these met before.
    pub tolerance: f64,
    /// Newton iterations after which a solve has failed.
    pub max_iterations: usize,
    /// [`Load::EndRotation`]: increments are not cut below this; then the run stops with all good steps kept (degrees).
    pub least_increment_deg: Option<f64>,
    /// [`Load::EndRotation`]: a jump is located to this rotation before the run continues beyond it (degrees).
    pub snap_tolerance_deg: Option<f64>,
}

/// Continuation by arc length: a load step is a length along the path of equilibria, and the parameter, which may go back,
/// is found with the displacements. Lengths are multiples of the first step's, which is one increment of the parameter.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArcLength {
    /// The word of the scene.
    pub control: ArcLengthWord,
    /// No step is longer than this.
    pub longest_step: f64,
    /// No step is cut below this; then the run stops with all good steps kept.
    pub shortest_step: f64,
    /// Load steps after which the run stops, wherever it is: a path may close in itself.
    pub most_steps: usize,
}

/// The word `arc-length`, as the value of a key.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ArcLengthWord {
    /// The only one.
    ArcLength,
}

impl Load {
    /// Sets the parameter at which the run stops.
    pub fn set_target(&mut self, target: f64) {
        match self {
            Load::EndRotation(load) => load.rotation_deg = target,
            Load::Steps(load) => load.factor = target,
        }
    }
}

impl Scene {
    /// The next load factor at which the history of an action or support has a point.
    pub fn next_history_point(&self, load_factor: f64) -> Option<f64> {
        self.histories().flat_map(History::kinks).filter(|at| *at > load_factor).reduce(f64::min)
    }

    /// The load factor up to which two scenes with the same actions and supports have the same histories.
    pub fn same_histories_up_to(&self, other: &Scene) -> f64 {
        self.histories().zip(other.histories()).map(|(one, other)| one.same_up_to(other)).fold(f64::INFINITY, f64::min)
    }

    /// Of actions, then of supports.
    fn histories(&self) -> impl Iterator<Item = &History> {
        let supports = self.supports.iter().map(|support| &support.history);
        self.actions.iter().map(|action| &action.history).chain(supports)
    }

    /// Whether a load turns with the shell, so that its work may depend on the path of deformation.
    pub fn loads_follow(&self) -> bool {
        self.actions.iter().any(|action| action.kind.follows())
    }

    /// The end rotation, where it drives the run.
    pub fn end_rotation(&self) -> Option<&EndRotation> {
        match &self.load {
            Load::EndRotation(load) => Some(load),
            Load::Steps(_) => None,
        }
    }

    /// The least increment of the parameter, below which load steps are not cut.
    pub fn least_increment(&self) -> f64 {
        match &self.load {
            Load::EndRotation(_) => self.solver.least_increment_deg.unwrap_or(0.0),
            Load::Steps(load) => load.least_increment,
        }
    }

    /// The interval of the parameter to which a jump is located.
    pub fn snap_tolerance(&self) -> f64 {
        match &self.load {
            Load::EndRotation(_) => self.solver.snap_tolerance_deg.unwrap_or(0.0),
            Load::Steps(load) => load.snap_tolerance,
        }
    }
}

/// Two numbers as one where they are equal.
mod one_or_pair {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    #[derive(Deserialize)]
    #[serde(untagged)]
    enum OneOrPair {
        One(f64),
        Pair([f64; 2]),
    }

    /// Writes one number where both are equal, and else the pair.
    pub fn serialize<S: Serializer>(pair: &[f64; 2], serializer: S) -> Result<S::Ok, S::Error> {
        if pair[0] == pair[1] { pair[0].serialize(serializer) } else { pair.serialize(serializer) }
    }

    /// Reads one number, which means two equal ones, or a pair.
    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<[f64; 2], D::Error> {
        Ok(match OneOrPair::deserialize(deserializer)? {
            OneOrPair::One(both) => [both; 2],
            OneOrPair::Pair(pair) => pair,
        })
    }
}

/// A stage of the pipeline.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize, schemars::JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Stage {
    /// Move the load on by one increment and find equilibrium.
    Solve,
    /// Mark the knot spans that are too coarse, by their bending or by the error that they cause.
    EvaluateIndicators,
    /// Insert knots into the geometry where spans are marked.
    RefineKnots,
    /// Carry the displacements over to the refined space, exactly.
    ProjectDisplacements,
    /// Find equilibrium at the same load on the refined mesh.
    ReEquilibrate,
    /// Leave an unstable equilibrium along its soft mode, down to a stable one at the same load.
    SwitchBranch,
    /// Take knots out that no longer pay, by the best approximation in the coarser space.
    CoarsenKnots,
}

impl Stage {
    /// All stages, in the order in which a load step runs them. The order in the enum is historical and must stay: it
    /// decides hashes.
    pub const ALL: [Stage; 7] = [
        Stage::Solve,
        Stage::SwitchBranch,
        Stage::EvaluateIndicators,
        Stage::RefineKnots,
        Stage::ProjectDisplacements,
        Stage::ReEquilibrate,
        Stage::CoarsenKnots,
    ];

    /// The stages of a load step that refines the mesh.
    pub const REFINING: [Stage; 5] = [
        Stage::Solve,
        Stage::EvaluateIndicators,
        Stage::RefineKnots,
        Stage::ProjectDisplacements,
        Stage::ReEquilibrate,
    ];

    /// Whether the stage ends in an equilibrium.
    pub fn finds_equilibrium(self) -> bool {
        matches!(self, Stage::Solve | Stage::ReEquilibrate | Stage::SwitchBranch)
    }

    /// The name of the stage in scenes, logs and on the terminal.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Solve => "solve",
            Stage::EvaluateIndicators => "evaluate-indicators",
            Stage::RefineKnots => "refine-knots",
            Stage::ProjectDisplacements => "project-displacements",
            Stage::ReEquilibrate => "re-equilibrate",
            Stage::SwitchBranch => "switch-branch",
            Stage::CoarsenKnots => "coarsen-knots",
        }
    }
}

impl std::fmt::Display for Stage {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.pad(self.name())
    }
}
