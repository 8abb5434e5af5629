//! What `foldline export` is asked for: a format, load steps, fields.

use std::path::{Path, PathBuf};

use clap::ValueEnum;

use super::asked::Ends;
use super::failure::Failure;
use super::wrapped::wrapped;
use crate::record::Record;
use crate::scene::Scene;
use crate::view::{Field, StepTimes, fields_of};

/// What states are written as.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Format {
    /// ParaView: the surface as rational Bézier cells with all fields, and its knot lines, a file each for every load step, and a
    /// .pvd for the series of either
    Vtu,
    /// A table of positions and fields at points of every element
    Csv,
    /// The same as records, with units and meanings
    Json,
    /// Knots, control points and displacements as arrays for numpy, one file for load steps that share a mesh
    Npz,
    /// The deformed surface as triangles (binary STL)
    Stl,
    /// The deformed surface as NURBS for CAD (STEP AP214)
    Step,
    /// Foxglove and other viewers of MCAP: the deformed mesh, with the reports and lines of all stages; for a log without
    /// `mesh_history`, or for another field or other times than it has
    Mcap,
}

impl Format {
    /// What the names of its files end in.
    pub(super) fn extension(self) -> &'static str {
        match self {
            Format::Vtu => "vtu",
            Format::Csv => "csv",
            Format::Json => "json",
            Format::Npz => "npz",
            Format::Stl => "stl",
            Format::Step => "step",
            Format::Mcap => "mcap",
        }
    }

    /// Whether it writes all load steps where none are chosen, rather than the last one.
    fn is_of_all_steps(self) -> bool {
        matches!(self, Format::Vtu | Format::Npz | Format::Mcap)
    }

    /// Whether several load steps may go into one file.
    pub(super) fn holds_many_steps(self) -> bool {
        matches!(self, Format::Npz | Format::Mcap)
    }
}

/// When viewers show what a stage did.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Times {
    /// A tenth of a second for each load step
    Steps,
    /// When it was there, by the time that the stages took
    Wall,
}

impl From<Times> for StepTimes {
    fn from(times: Times) -> Self {
        match times {
            Times::Steps => Self::Steps,
            Times::Wall => Self::Wall,
        }
    }
}

/// Load steps by number: one, or a first and a last one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct StepRange {
    first: u64,
    last: u64,
}

impl std::str::FromStr for StepRange {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let number = |text: &str| text.trim().parse::<u64>().map_err(|_| "load steps are wanted, such as 3,7,20-30");
        let (first, last) = text.split_once('-').or_else(|| text.split_once("..")).unwrap_or((text, text));
        let (first, last) = (number(first)?, number(last)?);
        if first > last {
            Err("the first load step of a range is beyond its last one")
        } else {
            Ok(Self { first, last })
        }
    }
}

/// The load steps that are written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Steps {
    /// Every n-th, and the last.
    Every(u64),
    /// These.
    Chosen(Vec<StepRange>),
    /// All of them, or the last one, as the format has it.
    Unsaid,
}

impl Steps {
    /// Chooses among the last equilibria of the load steps of a log.
    pub(super) fn of(&self, ends: Ends, format: Format, log: &Path) -> Result<Vec<Record>, Failure> {
        let Ends { mut records } = ends;
        let step = |record: &Record| record.report.step;
        let known = records.first().map(step).zip(records.last().map(step));
        let Some((_, last)) = known else { return Err(crate::view::PlotError::NoEquilibrium.into()) };
        match self {
            Steps::Every(n) => records.retain(|record| step(record) % n == 0 || step(record) == last),
            Steps::Chosen(ranges) => {
                let is_in = |record: &Record, range: &StepRange| (range.first..=range.last).contains(&step(record));
                if let Some(range) = ranges.iter().find(|range| !records.iter().any(|record| is_in(record, range))) {
                    return Err(Failure::NoSuchStep { log: log.to_path_buf(), step: range.first, known });
                }
                records.retain(|record| ranges.iter().any(|range| is_in(record, range)));
            }
            Steps::Unsaid if format.is_of_all_steps() => {}
            Steps::Unsaid => drop(records.drain(..records.len() - 1)),
        }
        Ok(records)
    }
}

/// The fields of a scene with these names, or all where none are given.
pub(super) fn chosen_fields(scene: &Scene, names: &[String]) -> Result<Vec<Field>, Failure> {
    let fields = fields_of(scene);
    let known = || fields.iter().map(|field| field.name.clone()).collect();
    if let Some(wrong) = names.iter().find(|name| !fields.iter().any(|field| field.name == **name)) {
        return Err(Failure::NoSuchField { field: wrong.clone(), known: known() });
    }
    let is_chosen = |field: &Field| names.is_empty() || names.contains(&field.name);
    Ok(fields.into_iter().filter(is_chosen).collect())
}

/// The list of fields, a line each.
pub(super) fn list_of_fields(scene: &Scene) -> String {
    let fields = fields_of(scene);
    let widest = fields.iter().map(|field| field.name.len()).max().unwrap_or(0);
    let line = |Field { name, unit, means, components, .. }: &Field| {
        let components = if components.len() > 1 { format!(" ({})", components.join(", ")) } else { String::new() };
        format!("{name:widest$}  {:10}  {means}{components}\n", if unit.is_empty() { "–" } else { unit })
    };
    let lines: String = fields.iter().map(line).collect();
    let axes = wrapped(
        "",
        "1 is along u of the undeformed surface, and 2 = n × 1. A positive κ bends the surface away from n. Forces and moments are those that \
         work on these strains (second Piola–Kirchhoff, per undeformed length): of a strip that bends freely n is −m κ, not 0. Failure \
         is by elastic strains, without those of heat; in Tsai and Wu's criterion F₁₂ = −√(F₁₁ F₂₂)/2.",
    );
    format!("{lines}\n{}\n", axes.trim_end())
}

/// Where files go: a folder with a name that they begin with, or one file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Target {
    /// `folder/name-00012.ext`.
    Folder(PathBuf, String),
    /// This file.
    File(PathBuf),
}

impl Target {
    /// The place that `-o` names: a file where that ends in the format's extension, else a folder.
    pub(super) fn of(output: Option<PathBuf>, log: &Path, format: Format) -> Self {
        let is_file = |path: &PathBuf| path.extension().is_some_and(|extension| extension == format.extension());
        let name = log.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        match output {
            Some(file) if is_file(&file) => Self::File(file),
            // The file ends as the log does.
            None if format == Format::Mcap => Self::File(log.with_file_name(format!("{name}-view.mcap"))),
            folder => Self::Folder(folder.unwrap_or_else(|| log.with_extension("")), name),
        }
    }

    /// The place of the knot lines beside the surface.
    pub(super) fn of_knot_lines(&self) -> Self {
        match self {
            Self::File(path) => {
                let stem = path.file_stem().unwrap_or_default().to_string_lossy();
                let extension = path.extension().unwrap_or_default().to_string_lossy();
                Self::File(path.with_file_name(format!("{stem}-knots.{extension}")))
            }
            Self::Folder(folder, name) => Self::Folder(folder.clone(), format!("{name}-knots")),
        }
    }

    /// The file that makes a series of the files of all steps.
    pub(super) fn of_series(&self) -> PathBuf {
        match self {
            Self::File(path) => path.with_extension("pvd"),
            Self::Folder(folder, name) => folder.join(format!("{name}.pvd")),
        }
    }

    /// The file of load steps from a first to a last one.
    pub(super) fn of_steps(&self, first: u64, last: u64, format: Format) -> PathBuf {
        match self {
            Self::Folder(folder, name) if first < last => {
                folder.join(format!("{name}-{first:05}-{last:05}.{}", format.extension()))
            }
            _ => self.of_step(first, format),
        }
    }

    /// The file of a load step.
    pub(super) fn of_step(&self, step: u64, format: Format) -> PathBuf {
        match self {
            Self::File(path) => path.clone(),
            Self::Folder(folder, name) => folder.join(format!("{name}-{step:05}.{}", format.extension())),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_are_numbers_and_ranges() {
        assert_eq!("3".parse(), Ok(StepRange { first: 3, last: 3 }));
        assert_eq!("20-30".parse(), Ok(StepRange { first: 20, last: 30 }));
        // As `thin` has them.
        assert_eq!("20..30".parse(), Ok(StepRange { first: 20, last: 30 }));
        for wrong in ["", "-3", "a", "3-", "30-20"] {
            assert!(wrong.parse::<StepRange>().is_err(), "{wrong}");
        }
    }
}
