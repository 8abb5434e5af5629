//! What a mesh and a state must hold so that no later code can stumble over them, whoever wrote them.

use crate::scene::{Drive, Scene, Stage};
use crate::spline::{DEGREES, KnotFlaw, Patch, check_knots};
use crate::state::{
    Course, CriticalAhead, DriveMemory, Estimate, Mesh, PathMemory, Previous, Refinement, State, StepControl,
};

/// What is wrong with a decoded mesh or state.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Flaw {
    /// A degree that no kernel is built for.
    #[error("degree {degree} in direction {} (it must be {} to {})", direction + 1, DEGREES.start(), DEGREES.end())]
    Degree {
        /// Parametric direction, 0 or 1.
        direction: usize,
        /// The degree.
        degree: usize,
    },
    /// Too few knots for the degree.
    #[error("{found} knots in direction {} for degree {degree} (it takes at least {})", direction + 1, 2 * (degree + 1))]
    FewKnots {
        /// Parametric direction, 0 or 1.
        direction: usize,
        /// The degree.
        degree: usize,
        /// Number of knots.
        found: usize,
    },
    /// A knot smaller than the one before it.
    #[error("knot {index} in direction {} is {value}, smaller than the one before it", direction + 1)]
    KnotOrder {
        /// Parametric direction, 0 or 1.
        direction: usize,
        /// Place in the knot vector.
        index: usize,
        /// The knot.
        value: f64,
    },
    /// A knot repeated so often that the surface falls apart, or a knot vector that is not open.
    #[error("knot {value} in direction {} occurs {found} times for degree {degree}", direction + 1)]
    KnotMultiplicity {
        /// Parametric direction, 0 or 1.
        direction: usize,
        /// The degree.
        degree: usize,
        /// The knot.
        value: f64,
        /// How often it occurs.
        found: usize,
    },
    /// A sequence of the wrong length.
    #[error("{found} {what} where the knots ask for {expected}")]
    Length {
        /// What there is too much or too little of.
        what: &'static str,
        /// Length that fits the knots and degrees.
        expected: usize,
        /// Length of the sequence.
        found: usize,
    },
    /// A number is NaN or infinite.
    #[error("{what} {index} is {value}")]
    NotFinite {
        /// Name of the quantity.
        what: &'static str,
        /// Place in its sequence, flattened; 0 for a single number.
        index: usize,
        /// The value.
        value: f64,
    },
    /// A weight that puts a control point at infinity or beyond.
    #[error("weight {index} is {value} (it must be above 0)")]
    Weight {
        /// Index of the control point.
        index: usize,
        /// Its weight.
        value: f64,
    },
    /// A marked knot that the mesh cannot have, or one that the refined mesh lacks.
    #[error("{what} knot {value} in direction {} is not a knot that this mesh can have", direction + 1)]
    ForeignKnot {
        /// "marked", "superfluous" or "the mesh's".
        what: &'static str,
        /// Parametric direction, 0 or 1.
        direction: usize,
        /// The knot.
        value: f64,
    },
    /// Something that no run of the scene makes.
    #[error("it has {what}, and no run of the scene in this log makes that")]
    Foreign {
        /// What it is.
        what: &'static str,
    },
    /// Steps of two drives at once behind the same state.
    #[error("it is reached both by a load step and along a path, and no run makes that")]
    TwoCourses,
    /// A number that no run makes.
    #[error("{what} is {value}, and no run makes that")]
    Absurd {
        /// Name of the quantity.
        what: &'static str,
        /// The value.
        value: f64,
    },
}

fn finite(what: &'static str, values: impl IntoIterator<Item = f64, IntoIter: Clone>) -> Result<(), Flaw> {
    let values = values.into_iter();
    // Many are looked at side by side where nothing stops at the first.
    if values.clone().fold(true, |all, value| all & value.is_finite()) {
        return Ok(());
    }
    match values.enumerate().find(|(_, value)| !value.is_finite()) {
        Some((index, value)) => Err(Flaw::NotFinite { what, index, value }),
        None => Ok(()),
    }
}

/// Checks that a mesh has patches, each a tensor-product spline surface with finite numbers.
///
/// # Errors
/// The first flaw.
pub fn check_mesh(mesh: &Mesh) -> Result<(), Flaw> {
    match mesh.patches.is_empty() {
        true => Err(Flaw::Length { what: "patches", expected: 1, found: 0 }),
        false => mesh.patches.iter().try_for_each(check_patch),
    }
}

/// Checks that a patch is a tensor-product spline surface with finite numbers: open, nondecreasing knots, interior
/// multiplicities up to the degree, and as many control points as the knots ask for.
fn check_patch(patch: &Patch) -> Result<(), Flaw> {
    for direction in 0..2 {
        let (degree, knots) = (patch.degree[direction], &patch.knots[direction]);
        if !DEGREES.contains(&degree) {
            return Err(Flaw::Degree { direction, degree });
        }
        check_knots(knots, degree, 0.0).map_err(|flaw| match flaw {
            KnotFlaw::Few { .. } => Flaw::FewKnots { direction, degree, found: knots.len() },
            KnotFlaw::NotFinite { index } => Flaw::NotFinite { what: "knot", index, value: knots[index] },
            KnotFlaw::Descending { index } => Flaw::KnotOrder { direction, index, value: knots[index] },
            // No distance is asked for.
            KnotFlaw::TooNear { pair: [value, _], .. } => Flaw::KnotMultiplicity { direction, degree, value, found: 1 },
            KnotFlaw::NotClamped { knot: value, times: found } | KnotFlaw::Tears { knot: value, times: found } => {
                Flaw::KnotMultiplicity { direction, degree, value, found }
            }
        })?;
    }
    let expected = patch.grid().len();
    if patch.control_points.len() != expected {
        return Err(Flaw::Length { what: "control points", expected, found: patch.control_points.len() });
    }
    finite("control point coordinate", patch.control_points.iter().flatten().copied())?;
    match patch.control_points.iter().position(|point| point[3] <= 0.0) {
        Some(index) => Err(Flaw::Weight { index, value: patch.control_points[index][3] }),
        None => Ok(()),
    }
}

/// Checks that a state fits its mesh and holds finite numbers; the mesh is checked too.
///
/// # Errors
/// The first flaw.
pub fn check_state(state: &State) -> Result<(), Flaw> {
    check_mesh(&state.mesh)?;
    check_on_mesh(state)
}

fn of_each_patch(what: &'static str, mesh: &Mesh, found: usize) -> Result<(), Flaw> {
    let expected = mesh.patches.len();
    if found == expected { Ok(()) } else { Err(Flaw::Length { what, expected, found }) }
}

/// Checks that a refined patch has every knot of the patch, and more.
fn check_finer(patch: &Patch, refined: &Patch) -> Result<(), Flaw> {
    for direction in 0..2 {
        if refined.degree[direction] != patch.degree[direction] {
            return Err(Flaw::Degree { direction, degree: refined.degree[direction] });
        }
        let mut finer = refined.knots[direction].iter();
        if let Some(&value) = patch.knots[direction].iter().find(|&knot| !finer.any(|other| other == knot)) {
            return Err(Flaw::ForeignKnot { what: "the mesh's", direction, value });
        }
    }
    Ok(())
}

/// Checks that marked knots lie inside a patch, and that superfluous ones are its own.
fn check_lists(patch: &Patch, marked: &[Vec<f64>; 2], superfluous: &[Vec<f64>; 2]) -> Result<(), Flaw> {
    for direction in 0..2 {
        let knots = &patch.knots[direction];
        for &value in &marked[direction] {
            if !(value > knots[0] && value < knots[knots.len() - 1]) {
                return Err(Flaw::ForeignKnot { what: "marked", direction, value });
            }
        }
        if let Some(&value) = superfluous[direction].iter().find(|value| !knots.contains(value)) {
            return Err(Flaw::ForeignKnot { what: "superfluous", direction, value });
        }
    }
    Ok(())
}

/// The same of a state whose mesh is sound.
pub(super) fn check_on_mesh(state: &State) -> Result<(), Flaw> {
    let State {
        mesh,
        displacement,
        marked,
        superfluous,
        refined,
        step: _,
        stage: _,
        parameter,
        turns,
        moment_n_mm,
        strain_energy_n_mm,
        negative_pivots: _,
        drive: DriveMemory { control: StepControl { halvings: _, jump_beyond, rejection: _ }, course },
        largest_force_n,
        refinement,
        estimate,
    } = state;
    if let Some(refined) = refined {
        check_mesh(refined)?;
        of_each_patch("refined patches", mesh, refined.patches.len())?;
        mesh.patches.iter().zip(&refined.patches).try_for_each(|(patch, finer)| check_finer(patch, finer))?;
    }
    of_each_patch("lists of marked knots", mesh, marked.len())?;
    of_each_patch("lists of superfluous knots", mesh, superfluous.len())?;
    for (patch, (marked, superfluous)) in mesh.patches.iter().zip(marked.iter().zip(superfluous)) {
        check_lists(patch, marked, superfluous)?;
    }
    let expected = mesh.point_count();
    let fits = |what, found| if found == expected { Ok(()) } else { Err(Flaw::Length { what, expected, found }) };
    fits("displacements", displacement.len())?;
    finite("displacement component", displacement.as_flattened().iter().copied())?;
    finite("rotation", [*parameter])?;
    finite("moment", [*moment_n_mm])?;
    finite("turn", turns.iter().flatten().copied())?;
    finite("strain energy", [*strain_energy_n_mm])?;
    finite("largest force", [*largest_force_n])?;
    if let Some(Refinement { changed_n_mm, growth, expected_n_mm, ripple_n_mm }) = refinement {
        finite("change on refining", [*changed_n_mm, *growth, *ripple_n_mm].into_iter().chain(*expected_n_mm))?;
    }
    if let Some(Estimate { step: _, relative_error, largest_indicator: [one, other] }) = estimate {
        finite("estimated error", [*relative_error, *one, *other])?;
    }
    match course {
        Course::Unknown => {}
        Course::Load(Previous { displacement, parameter }) => {
            fits("displacements before", displacement.len())?;
            finite("displacement component before", displacement.as_flattened().iter().copied())?;
            finite("rotation or load factor before", [*parameter])?;
        }
        Course::Path(PathMemory {
            heading,
            parameter_rate,
            first_mm,
            next_mm,
            travelled_mm,
            critical_ahead,
            at_bifurcation: _,
        }) => {
            fits("rates along the path", heading.len())?;
            finite("rate along the path", heading.as_flattened().iter().copied())?;
            let ahead =
                critical_ahead.map_or([0.0; 2], |CriticalAhead { within_mm, rate_beyond }| [within_mm, rate_beyond]);
            let lengths = [*parameter_rate, *first_mm, *next_mm, *travelled_mm];
            finite("length or rate of the path", lengths.into_iter().chain(ahead))?;
        }
    }
    finite("rotation of a known jump", *jump_beyond)
}

/// Checks that a state may have been made by a run of these scenes: those of its log up to its own, which is the last. What one
/// of them brought into a state stays there under the next.
///
/// # Errors
/// The first flaw.
pub(super) fn check_made_by(state: &State, scenes: &[&Scene]) -> Result<(), Flaw> {
    let Some(scene) = scenes.last() else { return Ok(()) };
    let State {
        mesh,
        displacement,
        marked,
        superfluous,
        refined,
        step: _,
        stage,
        parameter: _,
        turns,
        moment_n_mm: _,
        strain_energy_n_mm: _,
        negative_pivots,
        drive: DriveMemory { control, course },
        largest_force_n,
        refinement,
        estimate,
    } = state;
    let foreign = |what| Err(Flaw::Foreign { what });
    of_each_patch("shells of the scene", mesh, scene.shell_count())?;
    for (shell, patch) in mesh.patches.iter().enumerate() {
        let degree = scene.of_shell(shell).mesh.degree;
        if let Some(direction) = (0..2).find(|direction| patch.degree[*direction] != degree[*direction]) {
            return Err(Flaw::Degree { direction, degree: patch.degree[direction] });
        }
    }
    let follows_a_path = scenes.iter().any(|scene| Drive::of(scene).follows_path());
    let refines = scenes.iter().any(|scene| scene.adapt.is_some());
    let is_stage = |stage: &Stage| match stage {
        Stage::SwitchBranch => follows_a_path,
        stage => scene.pipeline.contains(stage),
    };
    match stage {
        Some(stage) if !is_stage(stage) => return foreign("a stage of another pipeline"),
        _ if !refines && marked.iter().flatten().any(|knots| !knots.is_empty()) => return foreign("marked knot spans"),
        _ if !refines && superfluous.iter().flatten().any(|knots| !knots.is_empty()) => {
            return foreign("superfluous knots");
        }
        _ if !refines && estimate.is_some() => return foreign("an estimate of its error"),
        _ if !refines && refined.is_some() => return foreign("a refined mesh"),
        _ if !refines && refinement.is_some() => return foreign("a memory of refining"),
        _ if !follows_a_path && matches!(course, Course::Path(_)) => return foreign("a path"),
        _ if turns.len() > scene.supports.len() + ENDS => return foreign("more rigid sections that turn"),
        _ if *negative_pivots > 3 * displacement.len() as u64 + MOTIONS * (scene.supports.len() + ENDS) as u64 => {
            return foreign("more negative pivots than unknowns");
        }
        _ => {}
    }
    let at_least = |what, value: f64, least: f64| {
        if value >= least { Ok(()) } else { Err(Flaw::Absurd { what, value }) }
    };
    let StepControl { halvings, jump_beyond: _, rejection: _ } = control;
    if halvings.unsigned_abs() > HALVINGS {
        return Err(Flaw::Absurd { what: "the number of halvings", value: f64::from(*halvings) });
    }
    match course {
        // Its size and numbers are all that can be asked of an equilibrium before.
        Course::Unknown | Course::Load(_) => {}
        Course::Path(PathMemory {
            heading: _,
            parameter_rate: _,
            first_mm,
            next_mm,
            travelled_mm,
            critical_ahead,
            at_bifurcation: _,
        }) => {
            at_least("the first step along the path", *first_mm, f64::MIN_POSITIVE)?;
            at_least("the next step along the path", *next_mm, f64::MIN_POSITIVE)?;
            at_least("the length of the path", *travelled_mm, 0.0)?;
            if let Some(CriticalAhead { within_mm, rate_beyond: _ }) = critical_ahead {
                at_least("the way to a critical point", *within_mm, 0.0)?;
            }
        }
    }
    if let Some(Refinement { changed_n_mm, growth, expected_n_mm, ripple_n_mm }) = refinement {
        at_least("what refining changed", *changed_n_mm, 0.0)?;
        at_least("the growth of the mesh", *growth, f64::MIN_POSITIVE)?;
        at_least("what refining was expected to change", expected_n_mm.unwrap_or(0.0), 0.0)?;
        at_least("what a ripple released", *ripple_n_mm, 0.0)?;
    }
    at_least("the largest force", *largest_force_n, 0.0)
}

/// Ends of a tape spring, which turn as rigid sections and are no supports of the scene.
const ENDS: usize = 2;

/// Unknowns of the motion of a rigid section.
const MOTIONS: u64 = 6;

/// Halvings or doublings after which an increment is no number any more.
const HALVINGS: u32 = 1000;
