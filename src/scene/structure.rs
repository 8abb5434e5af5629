//! Supports, actions and probes, and whether they make a problem.

use super::data::{Action, ActionKind, Hold, Load, Material, Motion, Probe, Support};
use super::fault::{Checked, Faults};
use super::sections::{OnSections, on_sections};
use super::shells::Shells;
use super::table::Table;
use super::tables::Tables;
use super::{actions, nearness, probes, supports};

/// What holds the shell, what hangs on its sections, what acts on it, and what is measured.
pub(super) type Structure = (Vec<Support>, OnSections, Vec<Action>, Vec<Probe>);

/// Reads supports, springs, masses, actions and probes; `None` where something is wrong with them.
pub(super) fn structure(tables: &Tables, load: &Load, shells: &Shells, faults: &mut Faults) -> Option<Structure> {
    let before = faults.0.len();
    let supports: Vec<Support> =
        tables.all("support").filter_map(|table| faults.keep(supports::support(table, shells))).collect();
    let hung = on_sections(tables, &supports, faults);
    let (springs, masses) = &hung;
    let action = |table: &Table| faults.keep(actions::action(table, shells, &supports, masses));
    let actions: Vec<Action> = tables.all("action").filter_map(action).collect();
    let probe = |table: &Table| faults.keep(probes::probe(table, (&supports, springs), shells));
    let probes: Vec<Probe> = tables.all("probe").filter_map(probe).collect();
    if faults.0.len() > before {
        return None;
    }
    faults.keep(check(tables, load, shells, (&supports, &actions, &probes)))?;
    Some((supports, hung, actions, probes))
}

fn check(
    tables: &Tables,
    load: &Load,
    shells: &Shells,
    (supports, actions, probes): (&[Support], &[Action], &[Probe]),
) -> Checked<()> {
    for (index, (probe, table)) in probes.iter().zip(tables.all("probe")).enumerate() {
        if probes[..index].iter().any(|known| known.name == probe.name) {
            return Err(table.wrong_at("name", "another probe has the same name", "reports need a name for each"));
        }
    }
    match load {
        Load::EndRotation(_) => {
            let mut of_steps = ["support", "spring", "mass", "action"].into_iter().flat_map(|name| tables.all(name));
            if let Some(table) = of_steps.next() {
                return Err(table.wrong(
                    None,
                    "turning ends are the supports and the load of this scene",
                    "write `kind = \"steps\"` in [load] to use supports and actions of your own",
                ));
            }
        }
        Load::Steps(_) => check_steps(tables, supports, actions)?,
    }
    for (index, shell) in shells.all.iter().enumerate() {
        let on_it = actions.iter().filter(|action| action.shell.is_none_or(|on| on == index));
        check_temperature(tables, &shell.material, on_it)?;
    }
    Ok(())
}

fn check_steps(tables: &Tables, supports: &[Support], actions: &[Action]) -> Checked<()> {
    let (load, symmetry) = (tables.one("load"), tables.one("symmetry"));
    if symmetry.is_given {
        return Err(symmetry.wrong(
            None,
            "[symmetry] belongs to turning ends",
            "model the part itself, and give its cut edges [[support]] tables of kind = \"symmetric\"",
        ));
    }
    if supports.is_empty() {
        return Err(load.wrong(
            None,
            "nothing holds the shell",
            "add [[support]] tables, such as on = \"u-start\", kind = \"clamped\"",
        ));
    }
    for (index, (support, table)) in supports.iter().zip(tables.all("support")).enumerate() {
        if let Some(other) = supports[..index].iter().find(|other| other.name == support.name) {
            return Err(table.wrong_at(
                "name",
                format!("another support is called \"{}\"", other.name),
                "give each a name of its own",
            ));
        }
        if let Some(other) = supports[..index]
            .iter()
            .find(|other| (other.shell, other.on) == (support.shell, support.on) && hold_the_same(other, support))
        {
            let problem = format!("\"{}\" holds the same place already", other.name);
            return Err(table.wrong_at(
                "on",
                problem,
                "a place is held once: take one of them away, or hold other components",
            ));
        }
    }
    nearness::check(tables, supports, actions)?;
    let moves = |support: &Support| match &support.hold {
        Hold::Displacement { displacement_mm } => {
            displacement_mm.iter().any(|value| value.is_some_and(|value| value != 0.0))
        }
        Hold::Rigid { motions, .. } => {
            motions.iter().any(|motion| matches!(motion, Motion::Given(value) if *value != 0.0))
        }
        Hold::Symmetric | Hold::RigidMotions => false,
    };
    if actions.is_empty() && !supports.iter().any(moves) {
        return Err(load.wrong(
            None,
            "nothing acts on the shell",
            "add an [[action]], or give a support a displacement or rotation other than 0",
        ));
    }
    Ok(())
}

/// Whether the material gives the effect of a change of temperature.
fn check_temperature<'a>(
    tables: &Tables,
    material: &Material,
    mut actions: impl Iterator<Item = &'a Action>,
) -> Checked<()> {
    let is_thermal = |action: &&Action| matches!(action.kind, ActionKind::Temperature { .. });
    let heated = actions.find(|action| is_thermal(action) && !material.expands());
    let Some(heated) = heated else { return Ok(()) };
    let Some(action) = tables.all("action").find(|table| table.name() == heated.name) else { return Ok(()) };
    let (problem, remedy) = match material {
        Material::Isotropic { .. } => (
            "the material has no `thermal_expansion_per_k`".into(),
            "write for example `thermal_expansion_per_k = 23.1e-6` in [material]",
        ),
        Material::Orthotropic { .. } => (
            "the material has no thermal expansion".into(),
            "write `thermal_expansion_1_per_k` and `thermal_expansion_2_per_k` in [material]",
        ),
        Material::Laminate { plies, .. } => {
            let without = plies.iter().position(|ply| ply.law.expansion_per_k().is_none()).unwrap_or_default();
            (
                format!("[[ply]] {} has no thermal expansion", without + 1),
                "write `thermal_expansion_1_per_k` and `thermal_expansion_2_per_k` in [material] for all plies, or in each [[ply]]",
            )
        }
    };
    Err(action.wrong_at("kind", problem, remedy))
}

/// Whether two supports on one place hold a common component.
fn hold_the_same(one: &Support, other: &Support) -> bool {
    match (&one.hold, &other.hold) {
        (Hold::Displacement { displacement_mm: a }, Hold::Displacement { displacement_mm: b }) => {
            (0..3).any(|c| a[c].is_some() && b[c].is_some())
        }
        _ => true,
    }
}
