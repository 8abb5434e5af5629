//! What can be drawn of a run: the numbers of its reports by the names that conditions have for them, and its probes.

use super::run::PlottedPoint;
use crate::record::Parameter;
use crate::scene::Scene;
use crate::spline::Elements;

/// A number of each equilibrium of a run.
#[derive(Clone, Debug)]
pub struct Quantity {
    /// Its name in arguments and files.
    pub name: String,
    source: Source,
    /// −1 where it is drawn with the other sign, and 1 otherwise.
    sign: f64,
}

#[derive(Clone, Copy, Debug)]
struct Row {
    name: &'static str,
    title: &'static str,
    unit: &'static str,
    /// What drives the runs that have it; `None` where all have it.
    of: Option<Parameter>,
    /// Whether it is 0 for the unloaded shell; otherwise it begins with the first equilibrium.
    begins_at_zero: bool,
    value: fn(&PlottedPoint) -> Option<f64>,
}

#[derive(Clone, Debug)]
enum Source {
    Report(&'static Row),
    /// The probe of this name.
    Probe(String),
}

/// What a probe's name may have in front of it.
const PROBE: &str = "probe.";
/// Units that names in reports end in, and that may be left out.
const UNIT_ENDINGS: [&str; 4] = ["_n_mm", "_deg", "_mm", "_s"];

const fn row(
    name: &'static str,
    title: &'static str,
    unit: &'static str,
    value: fn(&PlottedPoint) -> Option<f64>,
) -> Row {
    Row { name, title, unit, of: None, begins_at_zero: true, value }
}

/// The same for what the unloaded shell has not, or not at 0.
const fn of_equilibria(row: Row) -> Row {
    Row { begins_at_zero: false, ..row }
}

const fn driven_by(parameter: Parameter, row: Row) -> Row {
    Row { of: Some(parameter), ..row }
}

static ROWS: [Row; 20] = [
    driven_by(Parameter::Rotation, row("rotation", "rotation of each end θ", "°", |at| Some(at.report.parameter))),
    driven_by(Parameter::Rotation, row("moment", "end moment M", "N·mm", |at| Some(at.report.moment_n_mm))),
    driven_by(Parameter::LoadFactor, row("load_factor", "load factor", "", |at| Some(at.report.parameter))),
    row("step", "load step", "", |at| Some(at.report.step as f64)),
    row("strain_energy", "strain energy", "N·mm", |at| Some(at.report.strain_energy_n_mm)),
    row("work", "work so far", "N·mm", |at| Some(at.so_far.work_n_mm)),
    row("energy_released", "energy released by jumps so far", "N·mm", |at| at.so_far.released_n_mm),
    row("path_length", "length of the path", "mm", |at| at.report.path_length_mm),
    row("time", "wall time so far", "s", |at| Some(at.so_far.wall_s)),
    row("total_iterations", "Newton iterations so far", "", |at| Some(at.so_far.iterations)),
    of_equilibria(row("iterations", "Newton iterations of the load step", "", |at| Some(at.in_step.iterations))),
    of_equilibria(row("factorizations", "factorizations of the load step", "", |at| Some(at.in_step.factorizations))),
    of_equilibria(row("elements", "elements of the model", "", |at| Some(at.report.elements.count() as f64))),
    of_equilibria(row("elements_1", "elements along u", "", |at| of_one(&at.report.elements, 0))),
    of_equilibria(row("elements_2", "elements along v", "", |at| of_one(&at.report.elements, 1))),
    of_equilibria(row("unknowns", "free unknowns of the model", "", |at| Some(at.report.unknowns as f64))),
    of_equilibria(row("negative_pivots", "negative pivots", "", |at| Some(at.report.negative_pivots as f64))),
    of_equilibria(row("residual", "relative residual", "", |at| Some(at.report.residual))),
    of_equilibria(row("largest_indicator", "largest indicator max|κ|h", "", |at| at.so_far.largest_indicator)),
    of_equilibria(row("estimated_error", "estimated relative error", "", |at| at.so_far.estimated_error)),
];

/// All quantities of a run of a scene.
pub fn quantities_of(scene: &Scene) -> Vec<Quantity> {
    let driven_by = Parameter::of(scene);
    let rows = ROWS.iter().filter(|row| row.of.is_none_or(|parameter| parameter == driven_by));
    let of_rows = rows.map(|row| Quantity { name: row.name.to_owned(), source: Source::Report(row), sign: 1.0 });
    let of_probes = scene.probes.iter().map(|probe| Quantity::of_probe(&probe.name));
    of_rows.chain(of_probes).collect()
}

/// The quantity that a name means in a run of `scene`: one of a report, with or without its unit, or a probe, with or without
/// `probe.`; with the other sign behind a minus. `None` where the run has no such.
pub fn quantity_named(scene: &Scene, name: &str) -> Option<Quantity> {
    if let Some(other_sign) = name.strip_prefix(['-', '−']) {
        return quantity_named(scene, other_sign).map(Quantity::negated);
    }
    let known = quantities_of(scene);
    if let Some(probe) = name.strip_prefix(PROBE) {
        return known.into_iter().find(|quantity| quantity.probe() == Some(probe));
    }
    let plain = UNIT_ENDINGS.iter().find_map(|unit| name.strip_suffix(unit)).unwrap_or(name);
    let is = |wanted: &str| known.iter().find(|quantity| quantity.name == wanted).cloned();
    is(name).or_else(|| is(plain))
}

impl Quantity {
    pub(super) fn of_probe(name: &str) -> Self {
        // The numbers of reports have their names first.
        let is_taken = ROWS.iter().any(|row| row.name == name);
        let full = if is_taken { format!("{PROBE}{name}") } else { name.to_owned() };
        Self { name: full, source: Source::Probe(name.to_owned()), sign: 1.0 }
    }

    /// The same with the other sign.
    pub(super) fn negated(self) -> Self {
        Self { sign: -self.sign, ..self }
    }

    /// The name of the probe that it reads, if it does.
    pub fn probe(&self) -> Option<&str> {
        match &self.source {
            Source::Probe(name) => Some(name),
            Source::Report(_) => None,
        }
    }

    /// What it is called in the names of files.
    pub fn in_file_name(&self) -> String {
        let plain = self.name.strip_prefix(PROBE).unwrap_or(&self.name);
        let kept = |c: char| if c.is_alphanumeric() || "._-".contains(c) { c } else { '-' };
        let minus = if self.sign < 0.0 { "minus-" } else { "" };
        format!("{minus}{}", plain.chars().map(kept).collect::<String>())
    }

    /// Its value at an equilibrium, if it has one there.
    pub(super) fn value(&self, at: &PlottedPoint) -> Option<f64> {
        let value = match &self.source {
            Source::Report(row) => (row.value)(at),
            Source::Probe(_) => self.reading(at).map(|reading| reading.value),
        };
        value.map(|value| self.sign * value)
    }

    /// Its value for the unloaded shell, if it is known there.
    pub(super) fn at_rest(&self) -> Option<f64> {
        match &self.source {
            Source::Report(row) => row.begins_at_zero.then_some(0.0),
            Source::Probe(_) => Some(0.0),
        }
    }

    /// Its unit at an equilibrium; empty where it has none.
    pub(super) fn unit<'p>(&self, at: &PlottedPoint<'p>) -> Option<&'p str> {
        match &self.source {
            Source::Report(row) => Some(row.unit),
            Source::Probe(_) => self.reading(at).map(|reading| &*reading.unit),
        }
    }

    /// What its axis is called, with this unit.
    pub(super) fn title(&self, unit: &str) -> String {
        let minus = if self.sign < 0.0 { "−" } else { "" };
        let name = match &self.source {
            Source::Report(row) => row.title,
            Source::Probe(name) => name,
        };
        if unit.is_empty() { format!("{minus}{name}") } else { format!("{minus}{name} ({unit})") }
    }

    fn reading<'p>(&self, at: &PlottedPoint<'p>) -> Option<&'p crate::record::Reading> {
        let name = self.probe()?;
        at.report.probes.iter().find(|reading| reading.name == name)
    }
}

/// Elements along u or v of a scene of one shell.
fn of_one(elements: &Elements, direction: usize) -> Option<f64> {
    match elements {
        Elements::OfOne(counts) => Some(counts[direction] as f64),
        Elements::OfEach(_) => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn roof() -> Scene {
        let text = include_str!("../../../pipelines/verification/hinged-roof-12.7.toml");
        crate::scene::parse(text, "hinged-roof-12.7.toml").unwrap()
    }

    #[test]
    fn names_with_and_without_units_and_signs() {
        let name = |text: &str| quantity_named(&roof(), text).map(|quantity| quantity.title("u"));
        assert_eq!(name("load_factor").as_deref(), Some("load factor (u)"));
        assert_eq!(name("strain_energy_n_mm").as_deref(), Some("strain energy (u)"));
        assert_eq!(name("w_c").as_deref(), Some("w_c (u)"));
        assert_eq!(name("-probe.w_c").as_deref(), Some("−w_c (u)"));
        assert_eq!(name("moment"), None, "nothing turns");
        assert_eq!(quantity_named(&roof(), "-w_c").unwrap().in_file_name(), "minus-w_c");
    }
}
