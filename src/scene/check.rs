//! Tables to a scene, and what must hold between keys.

use std::path::Path;

use super::connections::connections;
use super::data::{ArcLength, EndRotation, Geometry, Load, LoadSteps, Scene, Shell, Solver, Symmetry};
use super::document::Document;
use super::error::SceneError;
use super::fault::{Checked, CheckedWhole, Faults, Source};
use super::imperfections::{check_symmetry, imperfections};
use super::key_table::SECTIONS;
use super::meshes::{self, Refinable};
use super::problem::Problem;
use super::shells::{Shells, check_structure};
use super::structure::structure;
use super::table::{Table, between};
use super::tables::Tables;

/// Parses and checks a scene in TOML; errors call the text `file_name`.
///
/// # Errors
/// What is wrong: the syntax; or all wrong names, missing tables and keys, and wrong values; or else what does not go
/// together.
pub fn parse(text: &str, file_name: &str) -> Result<Scene, SceneError> {
    parse_with_settings::<&str>(text, file_name, &[])
}

/// Parses and checks a scene in TOML with settings of the form `section.key=value`, which replace what the file has;
/// the last setting of a key holds. A value is TOML, but a word needs no quotes.
///
/// # Errors
/// As [`parse`]; what is wrong with a setting is shown in the setting.
pub fn parse_with_settings<S: AsRef<str>>(text: &str, file_name: &str, settings: &[S]) -> Result<Scene, SceneError> {
    let folder = Path::new(file_name).parent().unwrap_or(Path::new(""));
    let document = Document::read(text, settings, SECTIONS).map_err(|fault| vec![*fault]);
    document.and_then(|document| scene(&document, folder)).map_err(|faults| {
        let file = Source { name: file_name.into(), text: text.into() };
        let settings = settings.iter().map(|text| Source { name: "--set".into(), text: text.as_ref().into() });
        SceneError::new(faults, std::iter::once(file).chain(settings).collect())
    })
}

fn scene(document: &Document<'_>, folder: &Path) -> CheckedWhole<Scene> {
    match document.of_shells.is_empty() {
        true => {
            let tables = Tables::read(document)?;
            let mut faults = Faults::default();
            let shells = Shells::of_one(&tables, folder, &mut faults);
            let chooses_mesh = meshes::chooses_mesh(&tables);
            with_shells(&tables, shells, chooses_mesh, folder, faults)
        }
        false => {
            let tables = Tables::read(&document.of_structure())?;
            let shells = Shells::of_structure(document, &tables, folder)?;
            with_shells(&tables, Some(shells), false, folder, Faults::default())
        }
    }
}

/// Reads the rest of a scene, whose shells are known where nothing is wrong with them.
fn with_shells(
    tables: &Tables,
    shells: Option<Shells>,
    chooses_mesh: bool,
    folder: &Path,
    mut faults: Faults,
) -> CheckedWhole<Scene> {
    let load = faults.keep(load(tables, shells.as_ref()));
    let kinds = shells.iter().flat_map(|shells| &shells.all).map(|shell| shell.geometry.word()).collect();
    let is_structure = shells.as_ref().is_some_and(|shells| shells.are_named);
    let refinable = Refinable { tables, chooses_mesh, kinds, is_structure };
    let stages = faults.keep(meshes::stages(&refinable));
    let pipeline = stages.and_then(|stages| Some((faults.keep(meshes::adapt(&refinable, &stages))?, stages)));
    let symmetry = match is_structure {
        true => Some(Symmetry::None),
        false => faults.keep(meshes::symmetry(tables)),
    };
    let (Some(shells), Some(load), Some(symmetry), Some((adapt, pipeline))) = (shells, load, symmetry, pipeline) else {
        return Err(faults.0);
    };
    faults.keep(check_structure(&shells, tables, &load));
    let solver = faults.keep(solver(tables, &load));
    let continuation = faults.keep(continuation(tables, &load));
    let connections = connections(tables, &shells, &mut faults);
    let imperfections = imperfections(tables, &shells, folder, &mut faults);
    let structure = structure(tables, &load, &shells, &mut faults);
    let (
        Some(solver),
        Some(continuation),
        Some((joints, bonds)),
        Some(imperfections),
        Some((supports, (springs, masses), actions, probes)),
    ) = (solver, continuation, connections, imperfections, structure)
    else {
        return Err(faults.0);
    };
    faults.keep(check_symmetry(tables, &supports, symmetry));
    let output = tables.one("output").data();
    let expect = Some(tables.one("expect")).filter(|table| table.is_given).map(Table::data);
    let named = shells.named();
    let Some(Shell { geometry, material, mesh, pose, .. }) = shells.all.into_iter().next() else {
        unreachable!("a scene has a shell")
    };
    faults.or(Scene {
        geometry,
        material,
        mesh,
        pose,
        shells: named,
        joints,
        bonds,
        imperfections,
        symmetry,
        load,
        supports,
        springs,
        masses,
        actions,
        probes,
        adapt,
        solver,
        continuation,
        pipeline,
        output,
        expect,
    })
}

fn load(tables: &Tables, shells: Option<&Shells>) -> Checked<Load> {
    let table = tables.one("load");
    if table.kind() == "steps" {
        return steps(table).map(Load::Steps);
    }
    let is_spring = |shells: &Shells| matches!(shells.all[..], [Shell { geometry: Geometry::TapeSpring { .. }, .. }]);
    if shells.is_some_and(|shells| !shells.are_named && !is_spring(shells)) {
        return Err(table.wrong_at(
            "kind",
            "only a tape spring has ends that turn",
            "write `kind = \"steps\"`, and add [[support]] and [[action]] tables",
        ));
    }
    let load: EndRotation = table.data();
    let EndRotation { rotation_deg, increment_deg, longest_increment_deg, .. } = load;
    let place = |name: &str| table.place_of(name);
    if increment_deg > rotation_deg {
        let problem = Problem::IncrementPastTarget { increment_deg, rotation_deg };
        return Err(between(problem, place("increment_deg"), place("rotation_deg"), table));
    }
    if let Some(longest_increment_deg) = longest_increment_deg.filter(|longest| *longest < increment_deg) {
        let problem = Problem::LongestIncrementTooSmall { longest_increment_deg, increment_deg };
        return Err(between(problem, place("longest_increment_deg"), place("increment_deg"), table));
    }
    let longest_increment_deg = longest_increment_deg.filter(|longest| *longest > increment_deg);
    Ok(Load::EndRotation(EndRotation { longest_increment_deg, ..load }))
}

/// Steps of the load factor.
fn steps(table: &Table) -> Checked<LoadSteps> {
    let load: LoadSteps = table.data();
    let LoadSteps { factor, increment, longest_increment, least_increment, snap_tolerance } = load;
    if increment > factor {
        let problem = format!("the increment, {increment}, goes past the load factor at the end, {factor}");
        return Err(table.wrong_at("increment", problem, "make it smaller"));
    }
    if let Some(longest) = longest_increment.filter(|longest| *longest < increment) {
        let problem = format!("the longest increment, {longest}, is smaller than the increment, {increment}");
        return Err(table.wrong_at("longest_increment", problem, "make it larger, or take it out"));
    }
    if least_increment > increment || snap_tolerance < least_increment {
        let problem = format!(
            "least_increment = {least_increment} must be at most the increment ({increment}) and at most snap_tolerance \
             ({snap_tolerance})"
        );
        return Err(table.wrong_at("least_increment", problem, "make it smaller"));
    }
    Ok(LoadSteps { longest_increment: longest_increment.filter(|longest| *longest > increment), ..load })
}

fn solver(tables: &Tables, load: &Load) -> Checked<Solver> {
    let (table, load_table) = (tables.one("solver"), tables.one("load"));
    let solver: Solver = table.data();
    let Load::EndRotation(load) = load else {
        for (name, instead) in [("least_increment_deg", "least_increment"), ("snap_tolerance_deg", "snap_tolerance")] {
            if table.place_of(name).is_some() {
                let problem = format!("`{name}` is in degrees, and the steps of this scene are load factors");
                return Err(table.wrong_at(name, problem, format!("write `{instead}` in [load]")));
            }
        }
        return Ok(Solver { least_increment_deg: None, snap_tolerance_deg: None, ..solver });
    };
    let (Some(least_increment_deg), Some(snap_tolerance_deg)) = (solver.least_increment_deg, solver.snap_tolerance_deg)
    else {
        unreachable!("the limits of increments have defaults")
    };
    let increment_deg = load.increment_deg;
    if least_increment_deg > increment_deg {
        let problem = Problem::LeastIncrementTooLarge { least_increment_deg, increment_deg };
        let (least, increment) = (table.place_of("least_increment_deg"), load_table.place_of("increment_deg"));
        return Err(between(problem, least, increment, table));
    }
    if snap_tolerance_deg < least_increment_deg {
        let problem = Problem::SnapToleranceTooSmall { snap_tolerance_deg, least_increment_deg };
        let (snap, least) = (table.place_of("snap_tolerance_deg"), table.place_of("least_increment_deg"));
        return Err(between(problem, snap, least, table));
    }
    Ok(solver)
}

fn continuation(tables: &Tables, load: &Load) -> Checked<Option<ArcLength>> {
    let (table, load_table) = (tables.one("continuation"), tables.one("load"));
    if table.word("control") == "arc-length" {
        if load.longest_increment() > load.increment() {
            let place = load_table.place_of("longest_increment_deg").or(load_table.place_of("longest_increment"));
            return Err(load_table.wrong(
                place.as_ref(),
                "increments do not grow by arc length: only the first step is an increment",
                "take it out, and write `longest_step` in [continuation]",
            ));
        }
        return Ok(Some(table.data()));
    }
    match ["longest_step", "shortest_step", "most_steps"].iter().find_map(|name| table.place_of(name)) {
        None => Ok(None),
        Some(place) => Err(table.wrong(
            Some(&place),
            "this is about lengths along the path, and the steps of this scene are increments of its load",
            "write `control = \"arc-length\"` beside it, or take it out",
        )),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::help::example_scene;
    use crate::scene::{Key, Presence, all_keys};

    #[test]
    fn every_key_stands_in_a_section_of_the_table_and_ends_in_its_unit() {
        for key in all_keys() {
            let section = SECTIONS.iter().find(|section| section.name == key.section).unwrap();
            assert!(section.keys.contains(key), "{} is in another table", key.path());
            assert!(key.name.ends_with(key.unit.suffix()), "{}", key.path());
            assert!(!key.meaning.is_empty(), "{}", key.path());
            let words: Vec<&str> = section.kind_key().into_iter().flat_map(|kind| kind.words()).collect();
            assert!(key.kinds.iter().all(|kind| words.contains(kind)), "{}", key.path());
            let same = section.keys.iter().filter(|other| other.name == key.name);
            let beside =
                same.filter(|other| other.kinds.is_empty() || other.kinds.iter().any(|kind| key.belongs_to(kind)));
            assert_eq!(beside.count(), 1, "{} occurs twice", key.path());
        }
    }

    /// Examples and defaults of all kinds of tables are values of their keys, and the data of a scene has fields for them.
    #[test]
    fn the_examples_of_every_kind_of_table_are_a_table() {
        for section in SECTIONS {
            let words = section.kind_key().map_or(vec![None], |key| key.words().map(Some).collect());
            for kind in words {
                let instead = |key: &&Key| {
                    let unless = |other: &Key| other.presence == Presence::Unless(key.name);
                    matches!(key.presence, Presence::InsteadOf(_)) || section.keys.iter().any(unless)
                };
                let beside = |key: &&Key| !instead(key) && (key.name != "kind" || section.kind_key().is_none());
                let lines = section.keys_of(kind).filter(beside).map(|key| format!("{} = {}\n", key.name, key.example));
                let kind_line = kind.map_or(String::new(), |kind| format!("kind = \"{kind}\"\n"));
                let text = format!("{}\n{kind_line}{}", section.title(), lines.collect::<String>());
                let document = Document::read::<&str>(&text, &[], SECTIONS).unwrap();
                let table = Table::read(&document, section, document.tables.first(), &[]);
                assert!(table.is_ok(), "{text}\n{:?}", table.err());
            }
        }
    }

    #[test]
    fn every_word_of_the_table_is_understood() {
        for section in SECTIONS.iter().filter(|section| !section.many) {
            for key in section.keys_of(section.example_kind()).filter(|key| key.name != "kind") {
                for word in key.words() {
                    let setting = format!("{}={word}", key.path());
                    let parsed = parse_with_settings(&example_scene(), "table.toml", &[setting]);
                    assert!(parsed.is_ok() || word == "load", "{:?}", parsed.err());
                }
            }
        }
    }
}
