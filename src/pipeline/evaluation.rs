//! Evaluating indicators: which knot spans are too coarse, and which knots no longer pay.

use std::sync::Arc;

use crate::adapt::{
    DirectionalError, JudgedMesh, compared_with, evaluate_indicators, length_limit, span_lengths, still_holds,
    superfluous,
};
use crate::energy::TermSource;
use crate::equilibrium::{Configuration, Workspace, WorkspaceError};
use crate::model::pass_on;
use crate::pipeline::current_mesh::CurrentMesh;
use crate::pipeline::measured::Measured;
use crate::record::{Report, Warning};
use crate::scene::{Adapt, Indicator, Scene, Stage};
use crate::spline::knot_counts;
use crate::state::{Estimate, State};

/// What halving the spans of either direction would change, and the relative errors that are in it.
type Errors = ([DirectionalError; 2], [f64; 2]);

/// A state whose mesh is judged.
pub(super) struct Evaluation<'a> {
    pub scene: &'a Scene,
    pub adapt: &'a Adapt,
    pub own: &'a [Arc<dyn TermSource>],
    pub current: &'a mut CurrentMesh,
    pub state: &'a State,
}

impl Evaluation<'_> {
    /// The state with its marks, and the report.
    ///
    /// # Errors
    /// Where the mesh, or one with its spans halved, does not fit in memory, or a probe cannot be read.
    pub fn run(mut self) -> Result<(State, Report), WorkspaceError> {
        let Self { scene, adapt, state, .. } = self;
        let work = self.current.workspace(scene, self.own, &state.mesh)?;
        let indicators = evaluate_indicators(scene, adapt, work.discretization(), &state.displacement);
        let report = Report {
            largest_indicator: indicators.largest,
            ..Report::of(scene, state, work.discretization().unknowns.count())
        };
        let marked = pass_on(scene, &state.mesh, indicators.marked)?;
        let next = State { marked, superfluous: state.mesh.no_knots(), ..state.clone() };
        let (next, mut report) = match adapt.indicator {
            Indicator::BendingStrain(_) => (next, report),
            Indicator::Error(tolerance) => self.by_error(tolerance, next, report)?,
        };
        report.marked = knot_counts(&next.marked);
        let blocked = indicators.blocked.filter(|_| report.marked == [0, 0]);
        report.warnings.extend(blocked.map(|blocked| Warning::of_blocked(state, blocked)));
        Ok((next, report))
    }

    /// The same by the error that the mesh causes, unless the estimate before still holds.
    fn by_error(&mut self, tolerance: f64, next: State, report: Report) -> Result<(State, Report), WorkspaceError> {
        let largest_indicator = report.largest_indicator;
        let known = self.state.estimate;
        if known.is_some_and(|known| still_holds(&known, self.state, largest_indicator, tolerance)) {
            return Ok((next, report));
        }
        let Some((errors, relative)) = self.errors()? else { return Ok((State { estimate: None, ..next }, report)) };
        let Self { scene, adapt, state, .. } = *self;
        let discretization = self.current.workspace(scene, self.own, &state.mesh)?.discretization();
        let shell = &discretization.shells[0];
        let judged = JudgedMesh {
            mesh: state.mesh.lone(),
            errors: &errors,
            relative,
            lengths: &span_lengths(shell),
            limit: length_limit(scene, shell, adapt.length_limit),
            tolerance,
        };
        let marked = judged.marked();
        // A mesh that was changed at this step stays as it is for now: refining and coarsening would take turns.
        let is_older = known.is_some_and(|known| known.step < state.step);
        let may_coarsen = is_older
            && state.negative_pivots == 0
            && scene.pipeline.contains(&Stage::CoarsenKnots)
            && marked.iter().all(Vec::is_empty);
        let room = if may_coarsen { judged.room() } else { 0.0 };
        let superfluous = match room > 0.0 {
            true => {
                let start = self.current.start(scene, self.own)?.lone().clone();
                let work = self.current.workspace(scene, self.own, &state.mesh)?;
                superfluous(scene, work, state, &start, room).unwrap_or_default()
            }
            false => Default::default(),
        };
        let relative_error = relative.iter().sum();
        let estimate = Some(Estimate { step: state.step, relative_error, largest_indicator });
        let is_out_of_reach = marked.iter().all(Vec::is_empty) && relative_error > tolerance;
        let warning = Warning::ToleranceNotMet { parameter: state.parameter, estimated: relative_error, tolerance };
        let warnings = is_out_of_reach.then_some(warning).into_iter().collect();
        let report = Report { estimated_error: Some(relative), warnings, ..report };
        let (marked, superfluous) = (vec![marked], vec![superfluous]);
        Ok((State { marked, superfluous, estimate, ..next }, report))
    }

    /// What halving the spans of either direction would change, and the relative errors that are in it; `None` where the
    /// stiffness on a halved mesh has no factor, as exactly at a limit point.
    fn errors(&mut self) -> Result<Option<Errors>, WorkspaceError> {
        let Self { scene, own, state, .. } = *self;
        let work = self.current.workspace(scene, own, &state.mesh)?;
        let held = work.energy(&vec![[0.0; 3]; state.displacement.len()], state.parameter);
        let stored = compared_with(state.strain_energy_n_mm / scene.symmetry.copies() as f64, held);
        // Nothing is stored before the first load: there is no error yet.
        if stored <= 0.0 {
            return Ok(None);
        }
        let measured = Measured::of(scene);
        let here = measured.read(scene, work, Configuration::of(state))?;
        let slope = measured.slope(scene, work, state, here)?;
        let [along, across] = self.current.enriched(scene, own, &state.mesh)?;
        let measure = |work: &mut Workspace, at: Configuration| measured.read(scene, work, at);
        let (along, across) = (along.error_of(state, here, &measure)?, across.error_of(state, here, &measure)?);
        let (Some(along), Some(across)) = (along, across) else { return Ok(None) };
        let errors = [along, across];
        let relative = errors.each_ref().map(|error| measured.relative_error(scene, state, here, slope, error, stored));
        Ok(Some((errors, relative)))
    }
}
