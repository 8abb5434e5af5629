//! Supports, actions and probes, and whether they make a problem.

use super::data::{Action, ActionKind, Geometry, Hold, Load, Material, Motion, Probe, Support};
use super::fault::Checked;
use super::read::Reader;
use super::{actions, nearness, probes, supports};

/// Supports, actions and probes, and whether they make a problem.
pub(super) fn structure(
    reader: &Reader<'_, '_>,
    load: &Load,
    shell: (&Geometry, &Material),
) -> Checked<(Vec<Support>, Vec<Action>, Vec<Probe>)> {
    let document = reader.document;
    let tables = document.tables("support");
    let supports: Vec<Support> =
        tables.into_iter().enumerate().map(|(k, table)| supports::support(table, k + 1)).collect::<Checked<_>>()?;
    let actions: Vec<Action> = document
        .tables("action")
        .into_iter()
        .enumerate()
        .map(|(k, table)| actions::action(table, k + 1, shell))
        .collect::<Checked<_>>()?;
    let mut probes: Vec<Probe> = Vec::new();
    for table in document.tables("probe") {
        let name = table.place_of("name");
        let other = table.wrong(name.as_ref(), "another probe has the same name", "reports need a name for each");
        let probe = probes::probe(table, &supports, shell.0)?;
        if probes.iter().any(|known| known.name == probe.name) {
            return Err(other);
        }
        probes.push(probe);
    }
    match load {
        Load::EndRotation(_) => {
            if let Some(table) = document.tables("support").first().or(document.tables("action").first()) {
                return Err(table.wrong(
                    None,
                    "turning ends are the supports and the load of this scene",
                    "write `kind = \"steps\"` in [load] to use supports and actions of your own",
                ));
            }
        }
        Load::Steps(_) => check_steps(reader, &supports, &actions)?,
    }
    Ok((supports, actions, probes))
}

fn check_steps(reader: &Reader<'_, '_>, supports: &[Support], actions: &[Action]) -> Checked<()> {
    let document = reader.document;
    let load = document.table("load");
    if let Some(header) = document.header("symmetry") {
        let symmetry = document.table("symmetry");
        return Err(symmetry.wrong(
            Some(&header.place),
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
    for (index, (support, table)) in supports.iter().zip(document.tables("support")).enumerate() {
        if let Some(other) = supports[..index].iter().find(|other| other.name == support.name) {
            return Err(table.wrong(
                table.place_of("name").as_ref(),
                format!("another support is called \"{}\"", other.name),
                "give each a name of its own",
            ));
        }
        if let Some(other) =
            supports[..index].iter().find(|other| other.on == support.on && hold_the_same(other, support))
        {
            let problem = format!("\"{}\" holds the same place already", other.name);
            return Err(table.wrong(
                table.place_of("on").as_ref(),
                problem,
                "a place is held once: take one of them away, or hold other components",
            ));
        }
    }
    nearness::check(document, supports, actions)?;
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

/// Whether the material says what a change of temperature does to it.
pub(super) fn check_temperature(reader: &Reader<'_, '_>, material: &Material, actions: &[Action]) -> Checked<()> {
    let is_thermal = |action: &Action| matches!(action.kind, ActionKind::Temperature { .. });
    let Some(heated) = actions.iter().position(is_thermal).filter(|_| !material.expands()) else { return Ok(()) };
    let action = &reader.document.tables("action")[heated];
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
    Err(action.wrong(action.place_of("kind").as_ref(), problem, remedy))
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
