//! The array of tables `[[imperfection]]`: where the undeformed surfaces differ from the perfect ones.

use std::borrow::Cow;
use std::path::Path;

use super::data::{Geometry, Hold, Imperfection, ImperfectionKind, OffsetGrid, Region, Scene, Support, Symmetry};
use super::fault::{Checked, Faults};
use super::offset_grid;
use super::shells::Shells;
use super::table::{Table, data};
use super::tables::Tables;

impl Scene {
    /// The scene without its imperfections.
    pub fn perfect(&self) -> Cow<'_, Scene> {
        match self.imperfections.is_empty() {
            true => Cow::Borrowed(self),
            false => Cow::Owned(Scene { imperfections: Vec::new(), ..self.clone() }),
        }
    }

    /// Whether parts of the scene may be in files of their own: written as TOML it is whole.
    pub fn may_read_files(&self) -> bool {
        let is_nurbs = |geometry: &Geometry| matches!(geometry, Geometry::Nurbs(_));
        let is_grid = |imperfection: &Imperfection| matches!(imperfection.kind, ImperfectionKind::Grid { .. });
        is_nurbs(&self.geometry)
            || self.shells.iter().any(|shell| is_nurbs(&shell.geometry))
            || self.imperfections.iter().any(is_grid)
    }
}

/// Reads all imperfections; `None` where something is wrong with them.
pub(super) fn imperfections(
    tables: &Tables,
    shells: &Shells,
    folder: &Path,
    faults: &mut Faults,
) -> Option<Vec<Imperfection>> {
    let before = faults.0.len();
    let mut all: Vec<Imperfection> = Vec::new();
    for table in tables.all("imperfection") {
        let names: Vec<&str> = all.iter().map(|other| &*other.name).collect();
        let read = faults.keep(imperfection(table, shells, folder, &names));
        all.extend(read);
    }
    (faults.0.len() == before).then_some(all)
}

fn imperfection(table: &Table, shells: &Shells, folder: &Path, others: &[&str]) -> Checked<Imperfection> {
    let kind = match table.kind() {
        "modes" => modes(table)?,
        "grid" => grid(table, shells, folder)?,
        _ => data(&table.title, table.values.clone()),
    };
    let name = table.name();
    match others.contains(&&*name) {
        true => Err(table.wrong_at("name", "another imperfection has the same name", "give each a name of its own")),
        false => Ok(Imperfection { name, kind }),
    }
}

fn modes(table: &Table) -> Checked<ImperfectionKind> {
    let numbers: Vec<f64> = table.get("modes");
    for (index, number) in numbers.iter().enumerate() {
        let place = table.place_of_item("modes", index);
        let wrong = |problem: String, remedy: &str| Err(table.wrong(place.as_ref(), problem, remedy));
        if number.fract() != 0.0 {
            return wrong(format!("there is no mode {number}"), "modes are counted: 1, 2, 3");
        }
        if numbers[..index].contains(number) {
            return wrong(format!("mode {number} stands there twice"), "list each mode once");
        }
    }
    let seed: Option<u64> = table.get("seed");
    let amplitude: f64 = table.get("amplitude");
    match (numbers.len(), seed) {
        (0, _) => Err(table.wrong_at("modes", "no mode is listed", "write such as modes = [1]")),
        (1, Some(_)) => Err(table.wrong_at(
            "seed",
            "a single mode has no weights to draw",
            "take `seed` out, or list several modes; a negative `amplitude` turns a single mode round",
        )),
        (2.., None) => Err(table.wrong_at(
            "modes",
            "several modes are combined at random, and there is no seed",
            "add such as seed = 1, or list one mode; several [[imperfection]] tables add up",
        )),
        (2.., Some(_)) if amplitude < 0.0 => Err(table.wrong_at(
            "amplitude",
            "a random combination has no sense to turn round",
            "write a positive amplitude, or another seed",
        )),
        _ if amplitude == 0.0 => {
            Err(table.wrong_at("amplitude", "an amplitude of 0 changes nothing", "take the table out"))
        }
        _ => {
            let modes = numbers.iter().map(|number| *number as usize).collect();
            Ok(ImperfectionKind::Modes { modes, amplitude, seed })
        }
    }
}

fn grid(table: &Table, shells: &Shells, folder: &Path) -> Checked<ImperfectionKind> {
    let shell = shells.named_in(table, false)?.unwrap_or(0);
    let offsets = match table.get::<Option<String>>("file") {
        Some(name) => {
            let read = offset_grid::read(&folder.join(name));
            read.map_err(|wrong| table.wrong_at("file", wrong.problem, wrong.remedy))?
        }
        None => {
            let offsets = OffsetGrid { u: table.get("u"), v: table.get("v"), offsets_mm: table.get("offsets_mm") };
            offset_grid::check(&offsets).map_err(|wrong| table.wrong_at(wrong.key, wrong.problem, wrong.remedy))?;
            offsets
        }
    };
    Ok(ImperfectionKind::Grid { shell, offsets, scale: table.get("scale") })
}

/// Refuses imperfections that a plane of symmetry leaves without meaning: of a whole shell whose two sides are held alike, as nothing
/// says that they are imperfect alike; and a grid on a part of a spring, whose places are those of the whole.
pub(super) fn check_symmetry(tables: &Tables, supports: &[Support], symmetry: Symmetry) -> Checked<()> {
    let mut all = tables.all("imperfection");
    let is_inside = |support: &&Support| support.hold == Hold::Symmetric && matches!(support.on, Region::Line(..));
    if let (Some(support), Some(table)) = (supports.iter().find(is_inside), tables.all("imperfection").next()) {
        let problem = format!(
            "support \"{}\" holds a line inside in a plane of symmetry, and both sides would have to be imperfect alike",
            support.name
        );
        let remedy = "model the half, whose edge lies there: what its imperfection does at that edge is checked; or take the support out";
        return Err(table.wrong(None, problem, remedy));
    }
    match all.find(|table| table.kind() == "grid" && symmetry != Symmetry::None) {
        Some(table) => Err(table.wrong_at(
            "kind",
            "a grid is measured on a whole shell, and [symmetry] models a part of it",
            "write part = \"none\" in [symmetry]",
        )),
        None => Ok(()),
    }
}
