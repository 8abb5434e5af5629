//! The summary of a run: what it found, compared with theory, and what it cost.

use crate::record::{Outcome, Parameter, Reading, Record, Warning};
use crate::scene::{Geometry, ProfilePiece, Scene, Shell, Stage};
use crate::spline::Elements;
use crate::study::{Passed, PathPoint, Snap, TapeSpring, equilibrium_path, snaps};
use crate::units::{rounded, significant};

/// From this rotation on a fold is far from the ends, and its moment is compared directly (theory: the plateau is
/// flat to 0.1 N·mm beyond 40°).
const FAR_FROM_ENDS_DEG: f64 = 40.0;

/// The results and the cost of a run. Every number is computed from the records; `Display` prints them with the
/// closed-form laws.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub struct Summary {
    /// The tape spring, for the laws that the run is compared with.
    pub spring: Option<TapeSpring>,
    /// What drives the run.
    pub driven_by: Parameter,
    /// Shape of the shell and its thickness, in words.
    pub shell: String,
    /// The scene's probes at the last equilibrium.
    pub probes: Vec<Reading>,
    /// Target of the run: rotation in degrees, or load factor.
    pub target: f64,
    /// Elements of the whole shell for each element of the model: 1, 2 or 4.
    pub symmetric_parts: usize,
    /// dM/dθ at θ = 0, N·mm per radian of each end; `None` before the first equilibrium.
    pub initial_stiffness_n_mm: Option<f64>,
    /// The highest moment before a jump; `None` where the moment was still rising at the end.
    pub peak: Option<MeasuredPeak>,
    /// Work and energy before the first jump; `None` before the first equilibrium.
    pub balance: Option<EnergyBalance>,
    /// The jumps, in order.
    pub snaps: Vec<Snap>,
    /// Limit points and bifurcations that the path passed, in order.
    pub passed: Vec<Passed>,
    /// Unstable equilibria that were left by switch-branch: parameter, and energy released, N·mm.
    pub left: Vec<(f64, Option<f64>)>,
    /// Ripples of the mesh: how many, and what they released in all, N·mm.
    pub ripples: (usize, f64),
    /// Whether loads follow the shell: what a jump released is then the integral of their work along the descent.
    pub loads_follow: bool,
    /// Moment of the fold; `None` where the shell did not jump.
    pub fold: Option<FoldMean>,
    /// The mesh at the start and after every change.
    pub meshes: Vec<MeshChange>,
    /// What each stage that ran has cost, in the order of [`Stage::ALL`].
    pub work: Vec<StageWork>,
    /// Wall time that keeping the stages took, all but the last one, seconds.
    pub kept_s: f64,
    /// Where the mesh cannot show what the shell does, a line for each kind of warning.
    pub warnings: Vec<WarningCount>,
    /// Whether a warning casts doubt on the peak.
    pub peak_in_doubt: bool,
    /// Solves that were rejected.
    pub rejections: usize,
    /// Load steps that ended in an equilibrium.
    pub load_steps: usize,
    /// The last equilibrium; `None` before the first.
    pub last: Option<PathPoint>,
}

/// A maximum of the measured moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredPeak {
    /// Moment, N·mm.
    pub moment_n_mm: f64,
    /// Rotation of each end, degrees.
    pub parameter: f64,
    /// How it was found.
    pub found: PeakFound,
}

/// How the peak of the moment was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PeakFound {
    /// The top of a parabola through the largest moment and its neighbours.
    Parabola,
    /// The largest moment: the shell jumped before it fell.
    Jump,
    /// The largest moment: the load steps are too long for a parabola.
    LoadStep,
}

/// The mean moment of the fold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FoldMean {
    /// Mean moment, N·mm.
    pub moment_n_mm: f64,
    /// Rotations from and to which it is taken, degrees.
    pub range_deg: [f64; 2],
    /// Number of load steps in the mean.
    pub points: usize,
}

/// A kind of warning, and the number of load steps that reported it.
#[derive(Clone, Debug, PartialEq)]
pub struct WarningCount {
    /// The first warning of its kind.
    pub first: Warning,
    /// Number of load steps that reported it.
    pub steps: usize,
}

/// A mesh of the run, and the rotation at which the run came to it.
#[derive(Clone, Debug, PartialEq)]
pub struct MeshChange {
    /// Rotation of each end at which it was made, degrees; 0 for the mesh that the run starts with.
    pub parameter: f64,
    /// Elements (along the length, along the arc) of the model.
    pub elements: Elements,
    /// Free unknowns of the model.
    pub unknowns: usize,
}

/// Work compared with strain energy, up to the first jump.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct EnergyBalance {
    /// Rotation of the last equilibrium that is counted, degrees.
    pub parameter: f64,
    /// Turning ends: ∫ 2M dθ; else of loads, given motions and changes of the natural state, N·mm.
    pub work_n_mm: f64,
    /// Strain energy there, N·mm.
    pub strain_energy_n_mm: f64,
    /// Largest strain energy on the way, N·mm.
    pub largest_energy_n_mm: f64,
    /// Energy that refinement took out at fixed rotation: a coarse mesh stores too much, N·mm.
    pub taken_out_by_refinement_n_mm: f64,
    /// Energy that ripples of the mesh released, N·mm.
    pub released_in_ripples_n_mm: f64,
    /// What changes of the natural state would have put into a shell that stays, over all steps, N·mm.
    pub put_in_n_mm: f64,
}

impl EnergyBalance {
    /// The energy that accounts for the work, N·mm.
    pub fn accounted_n_mm(&self) -> f64 {
        self.strain_energy_n_mm + self.taken_out_by_refinement_n_mm + self.released_in_ripples_n_mm
    }

    /// The part of the work for which no energy accounts, relative to the largest energy involved. The strain energy
    /// itself is no measure: a shell that is unloaded again stores none, and one that takes its natural shape neither
    /// stores any nor takes work.
    pub fn relative_error(&self) -> f64 {
        (self.work_n_mm - self.accounted_n_mm()) / self.largest_n_mm()
    }

    /// The largest energy involved, N·mm.
    pub fn largest_n_mm(&self) -> f64 {
        let energies = [self.largest_energy_n_mm, self.put_in_n_mm, self.accounted_n_mm().abs(), self.work_n_mm.abs()];
        energies.into_iter().fold(0.0, f64::max)
    }
}

/// Number of runs of one stage, and what they cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StageWork {
    /// The stage.
    pub stage: Stage,
    /// Number of times that the stage ran.
    pub runs: usize,
    /// Newton iterations.
    pub iterations: usize,
    /// Numeric factorizations.
    pub factorizations: usize,
    /// Wall time, seconds.
    pub wall_s: f64,
}

impl Summary {
    /// Summarizes `records`, the stages of a run of `scene` from its first one on. The run may be unfinished.
    pub fn new(scene: &Scene, records: &[Record]) -> Self {
        let path = equilibrium_path(records);
        let snaps = snaps(records);
        let before_jump = path.iter().position(|point| point.jumped).unwrap_or(path.len());
        let mut steps: Vec<u64> = path.iter().map(|point| point.step).collect();
        steps.dedup();
        Self {
            spring: TapeSpring::of_scene(scene),
            driven_by: Parameter::of(scene),
            shell: shells_in_words(scene),
            probes: records
                .iter()
                .rev()
                .find(|record| !record.report.probes.is_empty())
                .map_or(vec![], |record| record.report.probes.clone()),
            target: scene.load.target(),
            symmetric_parts: scene.symmetry.copies(),
            initial_stiffness_n_mm: initial_stiffness(&path[..before_jump]),
            peak: peak(&path[..before_jump], before_jump < path.len()),
            balance: energy_balance(records),
            fold: fold_mean(&path, snaps.last()),
            snaps,
            passed: path.iter().filter_map(|point| point.passed).collect(),
            left: records
                .iter()
                .filter(|record| record.report.stage == Stage::SwitchBranch)
                .map(|record| (record.report.parameter, record.report.energy_released_n_mm))
                .collect(),
            warnings: warnings(records),
            peak_in_doubt: before_jump_and_with_it(records).any(Warning::doubts_results),
            ripples: ripples(records),
            loads_follow: scene.loads_follow(),
            meshes: mesh_changes(records),
            work: work(records),
            kept_s: records.iter().map(|record| record.kept_s).sum(),
            rejections: records.iter().filter(|record| record.report.outcome != Outcome::Done).count(),
            load_steps: steps.len(),
            last: path.last().cloned(),
        }
    }

    /// Wall time of all stages and of keeping them, seconds.
    pub fn wall_s(&self) -> f64 {
        self.work.iter().map(|work| work.wall_s).sum::<f64>() + self.kept_s
    }

    /// Number of stages that ran.
    pub fn stages(&self) -> usize {
        self.work.iter().map(|work| work.runs).sum()
    }
}

fn shells_in_words(scene: &Scene) -> String {
    match scene.shells.is_empty() {
        true => shell_in_words(scene),
        false => {
            let named =
                |(index, shell): (usize, &Shell)| format!("{}: {}", shell.name, shell_in_words(&scene.of_shell(index)));
            scene.shells.iter().enumerate().map(named).collect::<Vec<_>>().join("\n")
        }
    }
}

fn shell_in_words(scene: &Scene) -> String {
    let mm = |length: f64| significant(length, 6);
    let shape = match &scene.geometry {
        Geometry::TapeSpring { length_mm, radius_mm, arc_deg } => {
            format!("tape spring, L {} R {} mm, arc {}°", mm(*length_mm), mm(*radius_mm), rounded(*arc_deg))
        }
        Geometry::Plate { length_mm, width_mm } => format!("plate, {} × {} mm", mm(*length_mm), mm(*width_mm)),
        Geometry::CylinderPanel { length_mm, radius_mm, arc_deg, .. } => {
            format!("cylinder panel, L {} R {} mm, arc {}°", mm(*length_mm), mm(*radius_mm), rounded(*arc_deg))
        }
        Geometry::Annulus { inner_radius_mm, outer_radius_mm, arc_deg, .. } => {
            format!("annulus, R {} to {} mm, arc {}°", mm(*inner_radius_mm), mm(*outer_radius_mm), rounded(*arc_deg))
        }
        Geometry::SphereZone { radius_mm, latitude_deg, arc_deg, .. } => {
            let [from, to, arc] = [latitude_deg[0], latitude_deg[1], *arc_deg].map(rounded);
            format!("sphere zone, R {} mm, latitudes {from}° to {to}°, arc {arc}°", mm(*radius_mm))
        }
        Geometry::Profile { length_mm, profile, .. } => {
            let across: f64 = profile.iter().map(ProfilePiece::length_mm).sum();
            let pieces = if profile.len() == 1 { "1 piece".into() } else { format!("{} pieces", profile.len()) };
            format!("profile of {pieces}, L {} mm, {} mm across", mm(*length_mm), mm(across))
        }
        Geometry::Nurbs(_) => "NURBS surface".into(),
    };
    format!("{shape}, t {} mm", mm(scene.material.thickness_mm()))
}

/// Work of the end moments up to the last equilibrium before a jump, by the trapezoidal rule, and where it went.
fn energy_balance(records: &[Record]) -> Option<EnergyBalance> {
    let mut sum = EnergyBalance::default();
    let mut moment = 0.0;
    for Record { report, .. } in records {
        if report.jumped {
            break;
        }
        let work = match report.driven_by {
            Parameter::Rotation => (moment + report.moment_n_mm) * (report.parameter - sum.parameter).to_radians(),
            Parameter::LoadFactor => report.work_n_mm,
        };
        match report.stage {
            Stage::Solve if report.outcome == Outcome::Done => {
                sum.work_n_mm += work;
                sum.parameter = report.parameter;
                sum.put_in_n_mm += report.put_in_n_mm;
                sum.released_in_ripples_n_mm += report.energy_released_n_mm.unwrap_or(0.0);
            }
            // A return to before a jump on refining takes the work of the step back.
            Stage::ReEquilibrate if report.returned_from().is_some() => {
                sum.work_n_mm += work;
                sum.parameter = report.parameter;
                sum.put_in_n_mm -= report.put_in_n_mm;
                sum.taken_out_by_refinement_n_mm += work + sum.strain_energy_n_mm - report.strain_energy_n_mm;
            }
            // Refining integrates the energy again, and re-equilibrating lowers it: neither is work of the ends.
            Stage::RefineKnots | Stage::ReEquilibrate => {
                sum.taken_out_by_refinement_n_mm +=
                    report.work_n_mm + sum.strain_energy_n_mm - report.strain_energy_n_mm;
            }
            _ => continue,
        }
        (moment, sum.strain_energy_n_mm) = (report.moment_n_mm, report.strain_energy_n_mm);
        sum.largest_energy_n_mm = sum.largest_energy_n_mm.max(report.strain_energy_n_mm);
    }
    (sum.work_n_mm != 0.0).then_some(sum)
}

/// How many ripples there were, and what they released.
fn ripples(records: &[Record]) -> (usize, f64) {
    let rippled = records.iter().filter(|record| record.report.rippled);
    rippled.fold((0, 0.0), |(count, sum), record| (count + 1, sum + record.report.energy_released_n_mm.unwrap_or(0.0)))
}

/// dM/dθ at θ = 0: M/θ of up to three first points on one mesh, extrapolated by the polynomial through them.
fn initial_stiffness(path: &[PathPoint]) -> Option<f64> {
    let first = path.first()?;
    let points: Vec<(f64, f64)> = path
        .iter()
        .take(3)
        .take_while(|point| point.elements == first.elements)
        .map(|point| (point.parameter.to_radians(), point.moment_n_mm))
        .filter(|point| point.0 > 0.0)
        .collect();
    let at_zero = |(i, &(theta, moment)): (usize, &(f64, f64))| {
        let others = points.iter().enumerate().filter(|(j, _)| *j != i);
        others.fold(moment / theta, |term, (_, other)| term * other.0 / (other.0 - theta))
    };
    (!points.is_empty()).then(|| points.iter().enumerate().map(at_zero).sum())
}

/// A parabola's top is taken for the peak where it is no higher than this, as a multiple of the largest moment: beyond it the
/// steps are too long for a parabola. With steps of 0.4° the baseline's lies 0.1 % above, with steps of 1.6° 2 %, and 1.2 %
/// above the truth.
const CLOSE_TOP: f64 = 1.005;

/// The largest moment of the points before the jump.
fn peak(path: &[PathPoint], jumps_after: bool) -> Option<MeasuredPeak> {
    let index = (0..path.len()).max_by(|&i, &j| path[i].moment_n_mm.total_cmp(&path[j].moment_n_mm))?;
    let largest = &path[index];
    let as_it_stands = |found| MeasuredPeak { moment_n_mm: largest.moment_n_mm, parameter: largest.parameter, found };
    if index + 1 == path.len() {
        return jumps_after.then_some(as_it_stands(PeakFound::Jump));
    }
    let in_step = as_it_stands(PeakFound::LoadStep);
    let Some(left) = index.checked_sub(1).map(|before| &path[before]) else { return Some(in_step) };
    let right = &path[index + 1];
    let top = vertex([left, largest, right]);
    Some(top.filter(|top| top.moment_n_mm <= CLOSE_TOP * largest.moment_n_mm).unwrap_or(in_step))
}

/// The top of the parabola through three points of the path.
fn vertex(points: [&PathPoint; 3]) -> Option<MeasuredPeak> {
    let [x0, x1, x2] = points.map(|point| point.parameter);
    let [y0, y1, y2] = points.map(|point| point.moment_n_mm);
    let (slope_left, slope_right) = ((y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1));
    let bend = (slope_right - slope_left) / (x2 - x0);
    if !(bend < 0.0 && bend.is_finite()) {
        return None;
    }
    // y = y1 + slope (x − x1) + bend (x − x1)², with the slope at x1.
    let slope = (slope_left * (x2 - x1) + slope_right * (x1 - x0)) / (x2 - x0);
    let offset = -slope / (2.0 * bend);
    Some(MeasuredPeak { moment_n_mm: y1 + 0.5 * slope * offset, parameter: x1 + offset, found: PeakFound::Parabola })
}

/// Mean moment beyond the last jump: over the last third of the rotation, or where all of that is far from the ends,
/// over everything that is.
fn fold_mean(path: &[PathPoint], snap: Option<&Snap>) -> Option<FoldMean> {
    let (snap, last) = (snap?, path.last()?);
    let third = snap.after + (last.parameter - snap.after) * 2.0 / 3.0;
    let from = if last.parameter > FAR_FROM_ENDS_DEG { FAR_FROM_ENDS_DEG.max(snap.after) } else { third };
    let jump = path.iter().rposition(|point| point.jumped)?;
    let points: Vec<&PathPoint> = path[jump..].iter().filter(|point| point.parameter >= from).collect();
    let sum: f64 = points.iter().map(|point| point.moment_n_mm).sum();
    Some(FoldMean {
        moment_n_mm: sum / points.len() as f64,
        range_deg: [points.first()?.parameter, last.parameter],
        points: points.len(),
    })
}

/// Each kind of warning once, in the order in which they were first reported.
fn warnings(records: &[Record]) -> Vec<WarningCount> {
    let mut firsts: Vec<Warning> = Vec::new();
    for warning in records.iter().flat_map(|record| &record.report.warnings) {
        if firsts.iter().all(|first| first.name() != warning.name()) {
            firsts.push(warning.clone());
        }
    }
    let steps_with = |first: &Warning| {
        let says = |record: &&Record| record.report.warnings.iter().any(|warning| warning.name() == first.name());
        let mut steps: Vec<u64> = records.iter().filter(says).map(|record| record.report.step).collect();
        steps.dedup();
        steps.len()
    };
    firsts.into_iter().map(|first| WarningCount { steps: steps_with(&first), first }).collect()
}

/// Warnings up to the load step of the first jump: those of the equilibria before it are reported there.
fn before_jump_and_with_it(records: &[Record]) -> impl Iterator<Item = &Warning> {
    let jump = records.iter().find(|record| record.report.jumped).map(|record| record.report.step);
    let in_time = records.iter().take_while(move |record| jump.is_none_or(|jump| record.report.step <= jump));
    in_time.flat_map(|record| &record.report.warnings)
}

/// The first mesh and every change after it, each once.
fn mesh_changes(records: &[Record]) -> Vec<MeshChange> {
    let mut changes: Vec<MeshChange> = Vec::new();
    for Record { report, .. } in records {
        if changes.last().is_none_or(|last| last.elements != report.elements) {
            changes.push(MeshChange {
                parameter: if changes.is_empty() { 0.0 } else { report.parameter },
                elements: report.elements.clone(),
                unknowns: report.unknowns,
            });
        }
    }
    changes
}

/// Work by stage, of the stages that ran.
fn work(records: &[Record]) -> Vec<StageWork> {
    let of_stage = |stage: Stage| {
        let start = StageWork { stage, runs: 0, iterations: 0, factorizations: 0, wall_s: 0.0 };
        records.iter().filter(|record| record.report.stage == stage).fold(start, |sum, record| StageWork {
            stage,
            runs: sum.runs + 1,
            iterations: sum.iterations + record.report.iterations,
            factorizations: sum.factorizations + record.report.factorizations,
            wall_s: sum.wall_s + record.wall_s,
        })
    };
    Stage::ALL.map(of_stage).into_iter().filter(|work| work.runs > 0).collect()
}
