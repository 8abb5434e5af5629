//! What is collected of a run: figures of its summary, of theory, of its reports and probes, and errors against a reference.

use std::fmt::{self, Display, Formatter};

use serde::{Deserialize, Serialize};

use crate::record::{Record, Report};
use crate::scene::{Drive, Scene};
use crate::study::{Passed, Snap, Summary, equilibria};

/// A finished run, as quantities are read of it.
#[derive(Debug)]
pub struct Finished<'f> {
    /// Its scene.
    pub scene: &'f Scene,
    /// What its stages reported.
    pub records: &'f [Record],
    /// Its summary.
    pub summary: &'f Summary,
    /// Errors before the first snap and behind it, where it is compared with a reference.
    pub errors: [Option<f64>; 2],
}

/// A quantity by the name that it goes by in sweeps and tables.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Quantity {
    /// One of [`FIGURES`].
    Figure(&'static Figure),
    /// One of [`FIELDS`] of the reports, over all equilibria.
    Field(Which, &'static Field),
    /// A probe by its name.
    Probe(Which, String),
}

/// Which of the equilibria counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Which {
    /// The last one.
    Last,
    /// The one with the largest value.
    Largest,
    /// The one with the smallest value.
    Smallest,
}

/// A figure of a run.
pub struct Figure {
    /// Its name.
    pub name: &'static str,
    /// What it is.
    pub what: &'static str,
    read: fn(&Finished<'_>) -> Option<f64>,
}

/// A number of a report.
pub struct Field {
    /// Its name.
    pub name: &'static str,
    read: fn(&Report) -> Option<f64>,
}

const ERRORS: [&str; 2] = ["error_before", "error_after"];

macro_rules! figures {
    ($($name:literal, $what:literal, $read:expr;)+) => {
        &[$(Figure { name: $name, what: $what, read: $read }),+]
    };
}

/// All figures.
pub static FIGURES: &[Figure] = figures! {
    "stiffness_n_mm", "dM/dθ at rest, N·mm per radian of each end", |run| run.summary.initial_stiffness_n_mm;
    "peak_moment_n_mm", "highest moment before the first snap, N·mm", |run| Some(run.summary.peak?.moment_n_mm);
    "peak_rotation_deg", "rotation of each end at the peak, degrees", |run| Some(run.summary.peak?.parameter);
    "snaps", "number of snaps", |run| Some(run.summary.snaps.len() as f64);
    "snap_before", "rotation (degrees) or load factor of the last equilibrium before the first snap", |run| Some(first_snap(run)?.before);
    "snap_after", "the same of the first equilibrium behind it", |run| Some(first_snap(run)?.after);
    "snap_released_n_mm", "energy that the first snap released, N·mm", |run| first_snap(run)?.energy_released_n_mm;
    "fold_moment_n_mm", "moment of the fold, N·mm", |run| Some(run.summary.fold?.moment_n_mm);
    "limit_parameter", "rotation or load factor of the first limit point of the path", |run| Some(first_limit(run)?.parameter);
    "limit_probe", "the first probe there", |run| first_limit(run)?.probe;
    "energy_balance", "work for which no energy accounts, relative", |run| Some(run.summary.balance?.relative_error());
    "theory_stiffness_n_mm", "2EI/L of beam theory, N·mm per radian", |run| Some(run.summary.spring.as_ref()?.initial_stiffness_n_mm());
    "theory_peak_n_mm", "peak of Wuest's law, N·mm", |run| Some(run.summary.spring.as_ref()?.peak()?.moment_n_mm);
    "theory_plateau_n_mm", "equal-energy plateau of Wuest's law, N·mm", |run| Some(run.summary.spring.as_ref()?.plateau()?.moment_n_mm);
    "theory_fold_n_mm", "fold moment (1 ± ν) D α of Seffen & Pellegrino, N·mm", |run| Some(run.summary.spring.as_ref()?.fold_moment_n_mm());
    "error_before", "largest difference from the reference before the first snap, relative", |run| run.errors[0];
    "error_after", "the same behind it", |run| run.errors[1];
    "iterations", "Newton iterations", |run| Some(run.records.iter().map(|record| record.report.iterations).sum::<usize>() as f64);
    "warnings", "kinds of warnings", |run| Some(run.summary.warnings.len() as f64);
};

macro_rules! fields {
    ($($name:literal, $read:expr;)+) => {
        &[$(Field { name: $name, read: $read }),+]
    };
}

/// All numbers of reports.
pub static FIELDS: &[Field] = fields! {
    "parameter", |report| Some(report.parameter);
    "moment_n_mm", |report| Some(report.moment_n_mm);
    "strain_energy_n_mm", |report| Some(report.strain_energy_n_mm);
    "path_length_mm", |report| report.path_length_mm;
    "negative_pivots", |report| Some(report.negative_pivots as f64);
    "residual", |report| Some(report.residual);
    "unknowns", |report| Some(report.unknowns as f64);
};

fn first_limit(run: &Finished<'_>) -> Option<Passed> {
    run.summary.passed.iter().find(|passed| passed.critical.limit_point).copied()
}

fn first_snap(run: &Finished<'_>) -> Option<Snap> {
    run.summary.snaps.first().copied()
}

impl Quantity {
    /// What a scene is run for where nothing is asked for: the moments of turning ends, or else its probes.
    pub fn of_scene(scene: &Scene) -> Vec<Self> {
        let figures = |names: &[&str]| {
            let named = |name: &&str| FIGURES.iter().find(|figure| figure.name == *name).map(Quantity::Figure);
            names.iter().filter_map(named).collect::<Vec<_>>()
        };
        let mut chosen = match scene.end_rotation() {
            Some(_) => figures(&["peak_moment_n_mm", "snap_before", "snap_released_n_mm", "fold_moment_n_mm"]),
            None if Drive::of(scene).follows_path() => figures(&["limit_parameter", "limit_probe"]),
            None => Vec::new(),
        };
        chosen.extend(scene.probes.iter().map(|probe| Quantity::Probe(Which::Last, probe.name.clone())));
        if chosen.is_empty() {
            chosen.extend(
                FIELDS
                    .iter()
                    .find(|field| field.name == "strain_energy_n_mm")
                    .map(|field| Quantity::Field(Which::Last, field)),
            );
        }
        chosen
    }

    /// Whether it compares a run with its reference.
    pub fn needs_reference(&self) -> bool {
        matches!(self, Quantity::Figure(figure) if ERRORS.contains(&figure.name))
    }

    /// Whether it is of a probe that a scene does not have.
    pub(super) fn is_of_no_probe(&self, scene: &Scene) -> bool {
        matches!(self, Quantity::Probe(_, name) if scene.probes.iter().all(|probe| probe.name != *name))
    }

    /// Reads it of a run; `None` where the run has none.
    pub fn of(&self, run: &Finished<'_>) -> Option<f64> {
        let reports = || equilibria(run.records).map(|record| &record.report);
        let value = match self {
            Quantity::Figure(figure) => (figure.read)(run),
            Quantity::Field(which, field) => which.of(reports().filter_map(field.read)),
            Quantity::Probe(which, name) => which
                .of(reports().filter_map(|report| Some(report.probes.iter().find(|probe| probe.name == *name)?.value))),
        };
        value.filter(|value| value.is_finite())
    }
}

impl Which {
    const ALL: [Self; 3] = [Self::Last, Self::Largest, Self::Smallest];

    fn name(self) -> &'static str {
        match self {
            Self::Last => "last",
            Self::Largest => "largest",
            Self::Smallest => "smallest",
        }
    }

    fn of(self, values: impl Iterator<Item = f64>) -> Option<f64> {
        match self {
            Self::Last => values.last(),
            Self::Largest => values.reduce(f64::max),
            Self::Smallest => values.reduce(f64::min),
        }
    }
}

impl Display for Quantity {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Quantity::Figure(figure) => out.write_str(figure.name),
            Quantity::Field(which, field) => write!(out, "{}.{}", which.name(), field.name),
            Quantity::Probe(Which::Last, name) => write!(out, "probe.{name}"),
            Quantity::Probe(which, name) => write!(out, "{}.probe.{name}", which.name()),
        }
    }
}

impl From<Quantity> for String {
    fn from(quantity: Quantity) -> Self {
        quantity.to_string()
    }
}

impl TryFrom<String> for Quantity {
    type Error = String;

    fn try_from(name: String) -> Result<Self, String> {
        if let Some(figure) = FIGURES.iter().find(|figure| figure.name == name) {
            return Ok(Quantity::Figure(figure));
        }
        let (which, rest) = match name.split_once('.') {
            Some((first, rest)) => (Which::ALL.into_iter().find(|which| which.name() == first), rest),
            None => (None, &name[..]),
        };
        let of = which.map_or(&name[..], |_| rest);
        if let Some(probe) = of.strip_prefix("probe.").filter(|probe| !probe.is_empty()) {
            return Ok(Quantity::Probe(which.unwrap_or(Which::Last), probe.to_owned()));
        }
        match (which, FIELDS.iter().find(|field| field.name == rest)) {
            (Some(which), Some(field)) => Ok(Quantity::Field(which, field)),
            _ => Err(unknown(&name)),
        }
    }
}

/// What there is instead of a name that is none.
fn unknown(name: &str) -> String {
    let figures: Vec<&str> = FIGURES.iter().map(|figure| figure.name).collect();
    let fields: Vec<&str> = FIELDS.iter().map(|field| field.name).collect();
    let nearest = figures.iter().min_by_key(|known| strsim::osa_distance(known, name)).copied().unwrap_or_default();
    format!(
        "no output is called `{name}` (did you mean `{nearest}`?); there are {}; `last.`, `largest.` or `smallest.` before one of \
         {}; and probes, as `probe.NAME` or `largest.probe.NAME`",
        figures.join(", "),
        fields.join(", ")
    )
}

impl PartialEq for Figure {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl PartialEq for Field {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl fmt::Debug for Figure {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        out.write_str(self.name)
    }
}

impl fmt::Debug for Field {
    fn fmt(&self, out: &mut Formatter<'_>) -> fmt::Result {
        out.write_str(self.name)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_as_they_are_written() {
        let names = ["peak_moment_n_mm", "last.moment_n_mm", "smallest.residual", "probe.tip", "largest.probe.a.b"];
        for name in names {
            assert_eq!(Quantity::try_from(name.to_owned()).unwrap().to_string(), name);
        }
        assert_eq!(Quantity::try_from("last.probe.tip".to_owned()).unwrap().to_string(), "probe.tip");
        for wrong in ["", "peak", "probe.", "last.", "last.peak_moment_n_mm", "first.moment_n_mm", "moment_n_mm"] {
            assert!(Quantity::try_from(wrong.to_owned()).unwrap_err().contains("did you mean"), "{wrong}");
        }
    }
}
