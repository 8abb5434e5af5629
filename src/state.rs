//! What a checkpoint holds: plain data, all that decides the future of a run.

use std::borrow::Cow;
use std::sync::Arc;

use crate::digest::Feed;
pub use crate::digest::Hash;
use crate::scene::Stage;
pub use crate::spline::{KnotLists, Mesh, Patch};

/// The state of a run between two stages: everything that decides its future.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Geometry and spline space that the displacement belongs to.
    pub mesh: Arc<Mesh>,
    /// Displacement of every control point, mm, in the order of the mesh: shell by shell.
    pub displacement: Vec<[f64; 3]>,
    /// New knots of each patch that evaluate-indicators asks for; emptied by refine-knots.
    pub marked: KnotLists,
    /// Knots of each patch that evaluate-indicators finds superfluous; emptied by coarsen-knots.
    pub superfluous: KnotLists,
    /// The finer mesh that refine-knots made; project-displacements replaces `mesh` by it.
    pub refined: Option<Arc<Mesh>>,
    /// Load step: 0 before the first solve.
    pub step: u64,
    /// The stage that made this state; `None` for the state that the scene starts from.
    pub stage: Option<Stage>,
    /// The scene's parameter: rotation of each end in degrees, or the load factor.
    pub parameter: f64,
    /// Rotation vectors of the rigid sections where one of them turns freely, radians; empty otherwise.
    pub turns: Vec<[f64; 3]>,
    /// Moment of each end of the whole section where ends turn, dΠ/dθ / 2, N·mm; otherwise 0.
    pub moment_n_mm: f64,
    /// Energy that the whole shell stores, N·mm: strain energy, and what terms of the caller's own store.
    pub strain_energy_n_mm: f64,
    /// Number of negative pivots of the (symmetric part of the) tangent stiffness at the last equilibrium; 0 where it
    /// is stable.
    pub negative_pivots: u64,
    /// Memory of the drive from step to step.
    pub drive: DriveMemory,
    /// Largest force that residuals were compared with so far, N; 0 before the first equilibrium, and in states that
    /// were logged before residuals were compared with it.
    pub largest_force_n: f64,
    /// Change by the last refinement, and ripples since; `None` before the first one, and where the shell jumped on it.
    pub refinement: Option<Refinement>,
    /// The last estimate of the error on the present mesh, where a tolerance asks for one.
    pub estimate: Option<Estimate>,
}

/// An estimate of the error that the mesh causes, and from what state on it no longer holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Load step that it was made at.
    pub step: u64,
    /// Error of the measured quantity, relative.
    pub relative_error: f64,
    /// Largest max|κ|h in each direction then, dimensionless.
    pub largest_indicator: [f64; 2],
}

/// Change of the strain energy by a refinement, and what is expected of the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refinement {
    /// Sum of the magnitudes of the changes of strain energy by integrating again and by re-equilibrating, N·mm.
    pub changed_n_mm: f64,
    /// Number of elements that it added, relative to those before.
    pub growth: f64,
    /// Change that the refinement before it predicted for the whole mesh ([`Self::of_all_n_mm`]), N·mm.
    pub expected_n_mm: Option<f64>,
    /// Energy that the last ripple of the mesh released, N·mm; 0 where there was none since the last jump.
    pub ripple_n_mm: f64,
}

impl Refinement {
    /// Change of the strain energy by refining the whole mesh, if all of it were like the part that was refined, N·mm.
    pub fn of_all_n_mm(&self) -> f64 {
        self.changed_n_mm / self.growth
    }
}

/// Memory of the drive of a run, by load or along a path, from step to step. A path begins with an increment of the
/// parameter, and so with the control of load steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DriveMemory {
    /// Step control, which decides what the next solve attempts.
    pub control: StepControl,
    /// Course of equilibria that led to the current one.
    pub course: Course,
}

impl DriveMemory {
    /// Memory of the path that is followed, if one is.
    pub fn path(&self) -> Option<&PathMemory> {
        match &self.course {
            Course::Path(path) => Some(path),
            Course::Unknown | Course::Load(_) => None,
        }
    }

    /// Equilibrium that the load was moved on from, if it is known.
    pub fn previous(&self) -> Option<&Previous> {
        match &self.course {
            Course::Load(previous) => Some(previous),
            Course::Unknown | Course::Path(_) => None,
        }
    }
}

/// The course of equilibria that led to the current one, for the predictor of the next. The course of one drive stays
/// here until the next drive has made a step.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub enum Course {
    /// No course that continues: the shell is undeformed, or has jumped.
    #[default]
    Unknown,
    /// The load was moved on from the equilibrium before.
    Load(Previous),
    /// A path of equilibria was followed by arc length.
    Path(PathMemory),
}

impl Course {
    /// Returns the course on another mesh, to which `project` transfers vectors on the control points.
    pub fn projected(&self, project: impl Fn(&[[f64; 3]]) -> Vec<[f64; 3]>) -> Self {
        match self {
            Course::Unknown => Course::Unknown,
            Course::Load(Previous { displacement, parameter }) => {
                Course::Load(Previous { displacement: project(displacement), parameter: *parameter })
            }
            Course::Path(PathMemory {
                heading,
                parameter_rate,
                first_mm,
                next_mm,
                travelled_mm,
                critical_ahead,
                at_bifurcation,
            }) => Course::Path(PathMemory {
                heading: project(heading),
                parameter_rate: *parameter_rate,
                first_mm: *first_mm,
                next_mm: *next_mm,
                travelled_mm: *travelled_mm,
                critical_ahead: *critical_ahead,
                at_bifurcation: *at_bifurcation,
            }),
        }
    }
}

/// The equilibrium before the current one.
#[derive(Clone, Debug, PartialEq)]
pub struct Previous {
    /// Displacement of every control point, mm, in the order of the current mesh.
    pub displacement: Vec<[f64; 3]>,
    /// The scene's parameter there.
    pub parameter: f64,
}

/// What continuation by arc length remembers from step to step.
#[derive(Clone, Debug, PartialEq)]
pub struct PathMemory {
    /// Unit tangent of the path: rates of the control points' displacements with its length, in the order of the mesh. A
    /// motion is about as long as its root mean square over the parameter domain.
    pub heading: Vec<[f64; 3]>,
    /// Rate of the parameter with the length, per mm.
    pub parameter_rate: f64,
    /// Length of the first step, or of the distance to a branch that was switched to, mm: the unit of the scene's
    /// limits.
    pub first_mm: f64,
    /// Length of the next step, mm.
    pub next_mm: f64,
    /// Length of the path so far, mm.
    pub travelled_mm: f64,
    /// Critical point ahead that is being located.
    pub critical_ahead: Option<CriticalAhead>,
    /// Whether the last step passed a bifurcation at which the branch became less stable.
    pub at_bifurcation: bool,
}

/// A limit point or a bifurcation that is known to lie ahead on the path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CriticalAhead {
    /// Length of a step that passes it, mm.
    pub within_mm: f64,
    /// Rate of the parameter beyond it, per mm.
    pub rate_beyond: f64,
}

/// What the control of load steps remembers from step to step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StepControl {
    /// Power of 2 that the scene's increment is divided by; negative where it has grown.
    pub halvings: i32,
    /// Value of the scene's parameter that is known to lie beyond a jump ahead.
    pub jump_beyond: Option<f64>,
    /// Reason why the last solve left the state unchanged; `None` where it succeeded.
    pub rejection: Option<Rejection>,
}

/// Reasons why an attempted load step was rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Rejection {
    /// The solver found no equilibrium.
    NoEquilibrium,
    /// The shell jumped, and the jump is not located well enough yet.
    Jump,
    /// The step passed a limit point or a bifurcation that is not located well enough yet.
    CriticalPoint,
    /// The path turned too far, or the step ended on another branch.
    SharpTurn,
}

/// Cache of the hash of the last mesh: most stages keep theirs.
#[derive(Debug, Default)]
pub(crate) struct MeshHash {
    last: Option<(Arc<Mesh>, Hash)>,
}

impl MeshHash {
    /// Hash of a mesh, computed unless it is the last one.
    pub(crate) fn of(&mut self, mesh: &Arc<Mesh>) -> Hash {
        match &self.last {
            Some((last, hash)) if Arc::ptr_eq(last, mesh) => *hash,
            _ => self.last.insert((mesh.clone(), mesh.hash())).1,
        }
    }
}

impl State {
    /// Creates the state of undeformed shells, before the first step.
    pub fn undeformed(mesh: impl Into<Mesh>) -> Self {
        let mesh = mesh.into();
        Self {
            displacement: vec![[0.0; 3]; mesh.point_count()],
            marked: mesh.no_knots(),
            superfluous: mesh.no_knots(),
            mesh: Arc::new(mesh),
            refined: None,
            step: 0,
            stage: None,
            parameter: 0.0,
            turns: Vec::new(),
            moment_n_mm: 0.0,
            strain_energy_n_mm: 0.0,
            negative_pivots: 0,
            drive: DriveMemory::default(),
            largest_force_n: 0.0,
            refinement: None,
            estimate: None,
        }
    }

    /// The state of one shell of a structure alone; a state of one shell is returned as it is. What it remembers of the way is left
    /// out.
    pub fn of_shell(&self, shell: usize) -> Cow<'_, State> {
        if self.mesh.patches.len() == 1 {
            return Cow::Borrowed(self);
        }
        let displacement = self.displacement[self.mesh.range(shell)].to_vec();
        let alone = Self::undeformed(self.mesh.patches[shell].clone());
        Cow::Owned(Self {
            displacement,
            step: self.step,
            stage: self.stage,
            parameter: self.parameter,
            turns: self.turns.clone(),
            ..alone
        })
    }

    /// Content hash of everything that decides the future of a run; independent of how a log encodes the state.
    pub fn hash(&self) -> Hash {
        self.hash_on(self.mesh.hash())
    }

    /// Content hash of the state where the hash of its mesh is known.
    pub(crate) fn hash_on(&self, mesh: Hash) -> Hash {
        let Self {
            mesh: _,
            displacement,
            marked,
            superfluous,
            refined,
            step,
            stage,
            parameter,
            turns,
            moment_n_mm,
            strain_energy_n_mm,
            negative_pivots,
            drive: DriveMemory { control, course },
            largest_force_n,
            refinement,
            estimate,
        } = self;
        let mut feed = Feed::new("foldline state");
        feed.bytes(mesh.as_bytes());
        feed.integer(displacement.len() as u64);
        feed.each(displacement.as_flattened());
        marked.iter().flatten().for_each(|knots| feed.numbers(knots));
        feed.integer(u64::from(refined.is_some()));
        if let Some(mesh) = refined {
            feed.bytes(mesh.hash().as_bytes());
        }
        feed.integer(*step);
        feed.integer(stage.map_or(0, |stage| 1 + stage as u64));
        feed.number(*parameter);
        feed.number(*moment_n_mm);
        feed.number(*strain_energy_n_mm);
        feed.integer(*negative_pivots);
        control.feed(&mut feed);
        // Only where there are any, so that states without them hash as they always did.
        if !turns.is_empty() {
            feed.bytes(b"turns");
            feed.each(turns.as_flattened());
        }
        course.feed(&mut feed);
        if *largest_force_n != 0.0 {
            feed.bytes(b"largest force");
            feed.number(*largest_force_n);
        }
        if let Some(Refinement { changed_n_mm, growth, expected_n_mm, ripple_n_mm }) = refinement {
            feed.bytes(b"refinement");
            feed.numbers(&[*changed_n_mm, *growth, *ripple_n_mm]);
            feed.numbers(expected_n_mm.as_slice());
        }
        if superfluous.iter().flatten().any(|knots| !knots.is_empty()) {
            feed.bytes(b"superfluous");
            superfluous.iter().flatten().for_each(|knots| feed.numbers(knots));
        }
        if let Some(Estimate { step, relative_error, largest_indicator: [one, other] }) = estimate {
            feed.bytes(b"estimate");
            feed.integer(*step);
            feed.numbers(&[*relative_error, *one, *other]);
        }
        feed.finish()
    }
}

impl StepControl {
    fn feed(&self, feed: &mut Feed) {
        let Self { halvings, jump_beyond, rejection } = self;
        // As 32 bits without a sign: they had none before increments could grow.
        feed.integer(u64::from(halvings.cast_unsigned()));
        feed.integer(u64::from(jump_beyond.is_some()));
        feed.number(jump_beyond.unwrap_or(0.0));
        feed.integer(match rejection {
            None => 0,
            Some(Rejection::NoEquilibrium) => 1,
            Some(Rejection::Jump) => 2,
            Some(Rejection::CriticalPoint) => 3,
            Some(Rejection::SharpTurn) => 4,
        });
    }
}

impl Course {
    fn feed(&self, feed: &mut Feed) {
        match self {
            Course::Unknown => {}
            Course::Load(Previous { displacement, parameter }) => {
                feed.bytes(b"previous");
                feed.each(displacement.as_flattened());
                feed.number(*parameter);
            }
            Course::Path(path) => path.feed(feed),
        }
    }
}

impl PathMemory {
    fn feed(&self, feed: &mut Feed) {
        let Self { heading, parameter_rate, first_mm, next_mm, travelled_mm, critical_ahead, at_bifurcation } = self;
        feed.bytes(b"path");
        feed.each(heading.as_flattened());
        for value in [parameter_rate, first_mm, next_mm, travelled_mm] {
            feed.number(*value);
        }
        feed.integer(u64::from(critical_ahead.is_some()));
        if let Some(CriticalAhead { within_mm, rate_beyond }) = critical_ahead {
            feed.number(*within_mm);
            feed.number(*rate_beyond);
        }
        feed.integer(u64::from(*at_bifurcation));
    }
}
