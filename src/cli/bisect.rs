//! `foldline bisect`: where two runs part, where a run jumps, where a condition first holds.

use std::path::PathBuf;

use clap::Args;

use super::asked::Asked;
use super::failure::Failure;
use super::log_file::{ReadLog, ask_long, read_log, scene_at};
use super::output::{path_in_line, print};
use super::replay::place;
use super::stage_table::stage_table;
use super::terminal::output_columns;
use crate::history::{
    Comparison, Condition, ConditionError, SnapError, SnapReport, States, find_divergence, find_snap,
    first_loss_of_stability, first_where, no_jump,
};
use crate::journal::{AskedLog, LongLog, LongLogError};
use crate::record::{Parameter, Record};
use crate::units::{count, place as place_mm, unsigned_zero};

/// Find where two logs part, where a log jumps (--snap), or where a condition first holds (--when)
#[derive(Args, Debug)]
#[command(group(clap::ArgGroup::new("question").required(true).args(["other", "snap", "when"])))]
pub(super) struct Arguments {
    /// Log to read (MCAP)
    log: PathBuf,
    /// A second log: find the first stage at which the two differ; exit code 1 if they do
    other: Option<PathBuf>,
    /// Locate the first jump or loss of stability: go back to the last stable state before it and halve the load; also reports
    /// what kind of critical point it is, and which mode is soft there
    #[arg(long)]
    snap: bool,
    /// How well the jump is to be located: in degrees, or in the load factor of a scene that is driven by one
    #[arg(long, value_name = "WIDTH", default_value_t = 1e-4, requires = "snap", value_parser = resolved)]
    tolerance: f64,
    /// Find the first stage whose report meets a condition, such as 'moment_n_mm < 100 and step > 3'
    #[arg(long, value_name = "CONDITION")]
    when: Option<String>,
}

impl Arguments {
    /// Answers the question.
    pub(super) fn run(self) -> Result<u8, Failure> {
        if let Some(condition) = &self.when
            // A field that the end does not have may be one of an earlier stretch.
            && let Some(Ok(found)) = ask_long(&self.log, |long| first_of_long(long, condition))?
        {
            let never = || Failure::NeverHolds { log: self.log.clone(), condition: condition.clone() };
            return print(&stage_table(&found.ok_or_else(never)?, output_columns())).map(|()| 0);
        }
        match (&self.other, &self.when) {
            (Some(other), _) => self.part(&Asked::open(&self.log)?, &Asked::open(other)?, other),
            (None, Some(condition)) => self.first(&read_log(&self.log)?, condition),
            (None, None) => self.jump(&Asked::open(&self.log)?),
        }
    }

    fn part(&self, a: &Asked, b: &Asked, other: &std::path::Path) -> Result<u8, Failure> {
        let unusable = |source| Failure::WrongLog { log: self.log.clone(), source: Box::new(source) };
        let lengths = [a, b].map(|asked| asked.log.commits());
        let mut text = String::new();
        let found = find_divergence(&a.log, &b.log).map_err(unusable)?;
        match &found {
            None if lengths[0] == lengths[1] => {
                let by = match [a, b].iter().any(|asked| matches!(asked.log, AskedLog::Long(_))) {
                    true => {
                        ", by their chains of hashes; `foldline verify` checks that all bytes are as they were written"
                    }
                    false => "",
                };
                text.push_str(&format!("the same: all {}{by}\n", count(lengths[0], "stage")))
            }
            None => text.push_str(&format!(
                "the same as far as both go: {} holds {}, {} holds {}\n",
                path_in_line(&self.log),
                count(lengths[0], "stage"),
                path_in_line(other),
                count(lengths[1], "stage")
            )),
            Some(parting) => {
                let report = a.log.record(parting.index).map_err(a.changed())?.report;
                text.push_str(&format!(
                    "part at stage {}: step {} {} at {} (found in {})\n",
                    parting.index,
                    report.step,
                    report.stage,
                    report.driven_by.shown(report.attempted_parameter),
                    count(parting.looks, "look")
                ));
                text.push_str(&compared(&parting.comparison));
            }
        }
        for (asked, log) in [(a, &*self.log), (b, other)] {
            text.extend(asked.older_scene().map(|line| format!("  {}: {line}\n", path_in_line(log))));
        }
        for difference in a.scene.differences(&b.scene) {
            let [x, y] = difference.values();
            text.push_str(&format!("  scene: {} is {x} and {y}\n", difference.path));
        }
        if let (Some(x), Some(y)) = (a.log.end().manifests().first(), b.log.end().manifests().first()) {
            let mut differs = |what: &str, p: String, q: String| {
                if p != q {
                    text.push_str(&format!("  {what}: {p} and {q}\n"));
                }
            };
            differs("machine", x.host.clone(), y.host.clone());
            differs(
                "processor",
                format!("{} {}", x.cpu, x.cpu_features.join(" ")),
                format!("{} {}", y.cpu, y.cpu_features.join(" ")),
            );
            differs("kernel", x.kernel.clone(), y.kernel.clone());
            differs("program", x.program_version.clone(), y.program_version.clone());
            differs("threads", x.threads.to_string(), y.threads.to_string());
        }
        print(&text)?;
        Ok(u8::from(found.is_some()))
    }

    fn first(&self, read: &ReadLog, text: &str) -> Result<u8, Failure> {
        let records = read.records();
        let never = || Failure::NeverHolds { log: self.log.clone(), condition: text.to_string() };
        // One that has probes, if any has.
        let sample = records.iter().rev().max_by_key(|record| record.report.probes.len()).ok_or_else(never)?;
        let condition = Condition::parse(text, &sample.report)?;
        let found = records.iter().position(|record| condition.holds(&record.report)).ok_or_else(never)?;
        print(&stage_table(&records[found.saturating_sub(1)..=found], output_columns()))?;
        Ok(0)
    }

    fn jump(&self, asked: &Asked) -> Result<u8, Failure> {
        /// Stages before the jump among which the last stable one is looked for.
        const BEFORE: usize = 500;
        let every: Vec<usize> = (0..asked.log.commits()).collect();
        let mut farthest: f64 = 0.0;
        for part in asked.log.parts(&every) {
            let (log, _) = part.map_err(asked.changed())?;
            let Some(jump) = first_loss_of_stability(&log) else {
                let parameters = log.entries().iter().map(|entry| entry.record.report.parameter);
                farthest = parameters.fold(farthest, f64::max);
                continue;
            };
            // The scene of the stretch that jumped.
            let scene = scene_at(&log, &self.log, jump, &[])?;
            let found_in = |from: usize| -> Result<_, Failure> {
                let log = asked.log.part(from..jump + 1).map_err(asked.changed())?;
                Ok(find_snap(&mut States::of(&log), &scene, self.tolerance))
            };
            let near = jump.saturating_sub(BEFORE);
            let report = match found_in(near)? {
                Err(SnapError::NothingBefore) if near > 0 => found_in(0)?,
                report => report,
            };
            return print(&told(&report.map_err(Box::new)?, Parameter::of(&scene))).map(|()| 0);
        }
        Err(Box::new(no_jump(&asked.scene, farthest)).into())
    }
}

/// The first stage of a long log that meets a condition, and the one before it.
fn first_of_long(long: &LongLog, text: &str) -> Result<Result<Option<Vec<Record>>, ConditionError>, LongLogError> {
    let records = long.tail().entries().iter().map(|entry| &entry.record);
    let Some(sample) = records.max_by_key(|record| record.report.probes.len()) else { return Ok(Ok(None)) };
    match Condition::parse(text, &sample.report) {
        Ok(condition) => first_where(long, &condition).map(Ok),
        Err(error) => Ok(Err(error)),
    }
}

/// A tolerance that rotations are resolved to.
fn resolved(text: &str) -> Result<f64, String> {
    match super::session::positive(text)? {
        tolerance if tolerance < 1e-8 => {
            Err("jumps are not resolved more finely than 1e-8 (degrees, or load factor)".to_string())
        }
        tolerance => Ok(tolerance),
    }
}

fn compared(comparison: &Comparison) -> String {
    match comparison {
        Comparison::Identical => "  the states are the same; the scenes that made them are not\n".to_string(),
        Comparison::Structure(what) => format!("  {what}\n"),
        Comparison::Numbers(differences) => differences
            .iter()
            .map(|difference| {
                let [a, b] = difference.values;
                format!(
                    "  {}: {a} and {b}, {:.1} bits agree{}\n",
                    difference.field,
                    difference.agreeing_bits,
                    place(difference.place)
                )
            })
            .collect(),
    }
}

fn told(report: &SnapReport, parameter: Parameter) -> String {
    let [below, beyond] = report.bracket;
    let [before, after] = report.moment_n_mm;
    let [stable, most, end] = report.negative_pivots;
    let at = place_mm(report.mode_at);
    let [u, v, w] = report.mode.shape[report.mode.largest_at].map(unsigned_zero);
    let elements = report.stable.mesh.elements();
    let (name, degree) = match parameter {
        Parameter::Rotation => ("critical rotation", "°"),
        Parameter::LoadFactor => ("critical load", ""),
    };
    let moment = match parameter {
        Parameter::Rotation => format!("moment               {before:.3} N·mm before, {after:.3} N·mm after\n"),
        Parameter::LoadFactor => String::new(),
    };
    let kind = match report.critical {
        None => "not passed by the path that was followed".to_string(),
        Some(critical) if critical.pivots_changed == 0 => {
            format!("{}: no pivot of the stiffness changed sign", critical.name())
        }
        Some(critical) => format!(
            "{}: {} of the stiffness changed sign",
            critical.name(),
            count(critical.pivots_changed.unsigned_abs() as usize, "pivot")
        ),
    };
    let released = report.energy_released_n_mm.map_or("not known".to_string(), |energy| format!("{energy:.4} N·mm"));
    format!(
        "{name:<20} {below:.9}{degree} to {beyond:.9}{degree}, on {elements} elements, {}\n\
         {moment}\
         energy released      {released}; strain energy before: {:.4} N·mm\n\
         kind                 {kind}\n\
         negative pivots      {stable} before, up to {most} on the way, {end} after\n\
         soft mode            eigenvalue {:.4e} N/mm at {below:.6}{degree}; moves most at {at}, towards ({u:.2}, {v:.2}, {w:.2})\n",
        count(report.solves, "solve"),
        report.stable.strain_energy_n_mm,
        report.mode.eigenvalue
    )
}
