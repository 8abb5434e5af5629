//! Warnings about the numbers of a stage: what is checked, and from which size on there is a warning.

use std::sync::Arc;

use crate::adapt::{Halved, evaluate_indicators, largest_strain};
use crate::energy::{Discretization, Shell, TermSource};
use crate::equilibrium::{Configuration, Equilibrium, LinearBuckling, Solved, Workspace};
use crate::model::{Member, members};
use crate::pipeline::probes::read_probes;
use crate::pipeline::step_control::next_stage;
use crate::record::{CriticalPoint, LARGE, Reading, Report, Warning};
use crate::scene::{Scene, Stage};
use crate::state::{Refinement, State};

/// Relative change by the last refinement, taken for the whole mesh, up to which a run whose indicators ask for no more
/// has seen that its elements are fine enough; halving them all to see it again would cost `baseline-quarter.toml` a
/// tenth of its time. Where the length limit keeps spans that bend much, the last refinement may have been at a load at
/// which nothing bent yet.
const SMALL: f64 = 0.01;
/// Change of a probe, relative to the larger of both readings, from which on there is a warning.
const OFF: f64 = 0.1;
/// Readings smaller than this share of the largest displacement, of the largest force, or of that times the longest side,
/// are not compared with another.
const SMALL_READING: f64 = 1e-3;
/// Largest number of iterations to the equilibrium of the halved mesh.
const MOST_ITERATIONS: usize = 8;
/// Share of the load by which the halved mesh buckles earlier, from which on there is a warning.
const LATE: f64 = 0.05;
/// Strain from which on there is a warning: stress over strain of the law differs from one of logarithmic strains by
/// 1.5 times this.
const LARGE_STRAIN: f64 = 0.05;

/// States whose numbers are most likely read, which are checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ReadAt {
    /// The last equilibrium before a jump.
    BeforeJump,
    /// A critical point that was passed, with so many modes that are critical.
    AtCriticalPoint { modes: usize },
    /// The end of the run.
    AtEnd,
}

/// Finds the states around a stage whose numbers are checked.
pub(super) fn doubtful<'s>(
    scene: &Scene,
    before: &'s State,
    after: &'s State,
    report: &Report,
) -> impl Iterator<Item = (&'s State, ReadAt)> + use<'s> {
    let solved = report.stage == Stage::Solve;
    // Only at the first critical point is the first mode the one that buckles.
    let is_first = before.negative_pivots == 0;
    let jumped = (report.jumped && solved).then_some((before, ReadAt::BeforeJump));
    let critical = report.critical_point.filter(|_| solved && is_first);
    let ended = match critical {
        Some(CriticalPoint { pivots_changed, .. }) => {
            Some((after, ReadAt::AtCriticalPoint { modes: pivots_changed.unsigned_abs().max(1) as usize }))
        }
        None => next_stage(scene, after).is_none().then_some((after, ReadAt::AtEnd)),
    };
    jumped.into_iter().chain(ended)
}

/// An equilibrium whose numbers are checked.
pub(super) struct Doubts<'a> {
    pub scene: &'a Scene,
    /// Terms of the caller's own.
    pub own: &'a [Arc<dyn TermSource>],
    /// Workspace of the state's mesh.
    pub work: &'a mut Workspace,
    pub state: &'a State,
}

impl Doubts<'_> {
    /// Checks the state; returns the warnings about it.
    pub fn all(mut self, read_at: ReadAt) -> Vec<Warning> {
        let large_strains = self.large_strains();
        large_strains.into_iter().chain(self.coarse(read_at)).collect()
    }

    fn large_strains(&self) -> Option<Warning> {
        let Self { scene, work, state, .. } = self;
        let Discretization { mesh, shells, .. } = work.discretization();
        let of_shell = |(member, shell): (Member, &Shell)| {
            let thickness = member.scene.material.thickness_mm();
            (member.index, largest_strain((member.patch, shell), &state.displacement, thickness))
        };
        let all = members(scene, mesh).into_iter().zip(shells).map(of_shell);
        let (index, (strain, at)) = all.reduce(|one, other| if other.1.0 > one.1.0 { other } else { one })?;
        let shell = scene.shell_name(index).map(str::to_owned);
        (strain > LARGE_STRAIN).then_some(Warning::LargeStrains { parameter: state.parameter, strain, at, shell })
    }

    /// Warns of what halving every element would change: the energy, else the load at which it buckles, else a probe.
    fn coarse(&mut self, read_at: ReadAt) -> Option<Warning> {
        if self.refining_has_shown() {
            return None;
        }
        let state = self.state;
        let critical = match read_at {
            ReadAt::AtCriticalPoint { modes } => modes,
            ReadAt::BeforeJump | ReadAt::AtEnd => 0,
        };
        let mut halved = Halved::of(self.scene, self.own, state, critical)?;
        let halving = halved.halving();
        let (parameter, elements) = (state.parameter, state.mesh.elements());
        let energy_share = halving.energy_share();
        if energy_share.is_finite() && energy_share > LARGE {
            return (!halving.is_still()).then_some(Warning::CoarseElements { parameter, elements, energy_share });
        }
        // Beyond a critical point the current mesh is unstable as well.
        let is_stable = critical > 0 || state.negative_pivots == 0;
        let buckled = if is_stable { halved.buckling() } else { None };
        if let Some(LinearBuckling { parameter: at, .. }) = buckled {
            return (at < (1.0 - LATE) * parameter).then_some(Warning::LateBuckling {
                parameter,
                elements,
                halved: at,
            });
        }
        // Near a critical point the halved mesh may lead anywhere.
        let are_read = read_at == ReadAt::AtEnd && !self.scene.probes.is_empty();
        if are_read { self.probe_off(halved) } else { None }
    }

    /// Warns of a probe that reads otherwise at the equilibrium of the halved mesh. A first-order estimate is not
    /// enough: the forces that it leaves out of balance are membrane forces, and reactions would be off by multiples
    /// where the reading is right. Probes that cannot be read, or not be solved for, on the halved mesh are skipped: on
    /// the current mesh a stage has read them.
    fn probe_off(&mut self, mut halved: Halved) -> Option<Warning> {
        let Self { scene, work, state, .. } = self;
        let here = read_probes(scene, work, Configuration::of(state), state.strain_energy_n_mm).ok()?;
        let [largest, side] = halved.halving().sizes_mm;
        let (work, at) = halved.relaxed();
        let solved = Equilibrium::new(scene, work).relax(at, &mut |last| last.iteration > MOST_ITERATIONS).ok()?;
        let Solved { displacement, turns, balance, .. } = solved;
        let at = Configuration { displacement: &displacement, turns: &turns, ..Configuration::of(state) };
        let there = read_probes(scene, work, at, balance.stored).ok()?;
        let smallest = |reading: &Reading| match reading.unit.as_str() {
            "mm" => SMALL_READING * largest,
            "N" => SMALL_READING * state.largest_force_n,
            "N·mm" => SMALL_READING * state.largest_force_n * side,
            _ => 0.0,
        };
        let is_off = |(here, there): &(&Reading, &Reading)| {
            let size = here.value.abs().max(there.value.abs());
            size > smallest(here) && (there.value - here.value).abs() > OFF * size
        };
        let mut off: Vec<_> = here.iter().zip(&there).filter(is_off).collect();
        let share = |(here, there): &(&Reading, &Reading)| {
            (there.value - here.value).abs() / here.value.abs().max(there.value.abs())
        };
        off.sort_by(|one, other| share(other).total_cmp(&share(one)));
        let (worst, finer) = off.first()?;
        Some(Warning::ProbeOff {
            parameter: state.parameter,
            elements: state.mesh.elements(),
            probe: worst.name.clone(),
            value: worst.value,
            halved: finer.value,
            unit: worst.unit.clone(),
            others: off.len() - 1,
        })
    }

    /// Whether refining has shown that elements are fine enough: the last time changed little, and the indicators are content.
    fn refining_has_shown(&self) -> bool {
        let Self { scene, work, state, .. } = self;
        let is_small = |last: Refinement| last.of_all_n_mm() <= SMALL * state.strain_energy_n_mm;
        let Some(adapt) = scene.adapt.as_ref().filter(|_| state.refinement.is_some_and(is_small)) else {
            return false;
        };
        let indicators = evaluate_indicators(scene, adapt, work.discretization(), &state.displacement);
        indicators.marked.iter().flatten().all(Vec::is_empty) && indicators.blocked.is_none()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pipeline::{Run, Stages};
    use crate::record::MemorySink;
    use crate::scene::{LengthLimit, parse};

    /// Whether refining has shown enough at the end of a run.
    fn has_shown(scene: Scene) -> bool {
        let mut stages = Stages::new(scene.clone());
        let start = stages.start().unwrap();
        let mut sink = MemorySink::default();
        Run::new(stages, start, None).to_end(None, &|| false, &mut sink).unwrap();
        let (state, _) = sink.stages.pop().unwrap();
        let mut work = Workspace::new(&scene, &state.mesh).unwrap();
        Doubts { scene: &scene, own: &[], work: &mut work, state: &state }.refining_has_shown()
    }

    /// The baseline, refined behind its snap, halves no elements to see what refining has shown; a cylinder that the length
    /// limit keeps coarse since its first small load does.
    #[test]
    fn what_refining_has_shown_is_not_looked_for_again() {
        let text = include_str!("../../pipelines/baseline-quarter.toml");
        let mut baseline = parse(text, "baseline-quarter.toml").unwrap();
        baseline.load.set_target(20.0);
        assert!(has_shown(baseline));
        let text = include_str!("../../tests/verification/scenes/pulled-cylinder.toml");
        let mut cylinder = parse(text, "pulled-cylinder.toml").unwrap();
        cylinder.adapt.as_mut().unwrap().length_limit = LengthLimit::SqrtRadiusThickness;
        assert!(!has_shown(cylinder));
    }
}
