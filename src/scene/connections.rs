//! The arrays of tables `[[joint]]` and `[[bond]]`: what connects the shells of a structure.

use super::data::{Bond, Joint};
use super::fault::{Checked, Faults};
use super::shells::Shells;
use super::table::Table;
use super::tables::Tables;

/// Reads all joints and bonds of a structure; `None` where something is wrong with them.
pub(super) fn connections(tables: &Tables, shells: &Shells, faults: &mut Faults) -> Option<(Vec<Joint>, Vec<Bond>)> {
    let before = faults.0.len();
    let (mut joints, mut bonds): (Vec<Joint>, Vec<Bond>) = (Vec::new(), Vec::new());
    for table in tables.all("joint") {
        joints.extend(faults.keep(joint(table, shells, &joints)));
    }
    for table in tables.all("bond") {
        bonds.extend(faults.keep(bond(table, shells, &bonds)));
    }
    (faults.0.len() == before).then_some((joints, bonds))
}

fn joint(table: &Table, shells: &Shells, before: &[Joint]) -> Checked<Joint> {
    let edges = shells.edges(table, "edges")?;
    let [one, other] = edges[..] else { unreachable!("a joint has two edges") };
    if one == other {
        return Err(table.wrong_at("edges", "an edge cannot be joined to itself", "name two edges"));
    }
    let is_same = |joint: &&Joint| joint.edges.contains(&one) && joint.edges.contains(&other);
    if let Some(same) = before.iter().find(is_same) {
        let problem = format!("joint \"{}\" joins the same edges", same.name);
        return Err(table.wrong_at("edges", problem, "take one of them away"));
    }
    check_name(table, before.iter().map(|joint| &*joint.name))?;
    Ok(Joint { name: table.name(), kind: table.get("kind"), edges: [one, other], stiffness: table.get("stiffness") })
}

fn bond(table: &Table, shells: &Shells, before: &[Bond]) -> Checked<Bond> {
    let names: Vec<String> = table.get("shells");
    let found = names.iter().map(|name| shells.find(name, table, "shells")).collect::<Checked<Vec<usize>>>()?;
    let [one, other] = found[..] else { unreachable!("a bond has two shells") };
    if one == other {
        return Err(table.wrong_at("shells", "a shell cannot be glued to itself", "name two shells"));
    }
    if let Some(same) = before.iter().find(|bond| bond.shells.contains(&one) && bond.shells.contains(&other)) {
        let problem = format!("bond \"{}\" glues the same shells", same.name);
        return Err(table.wrong_at("shells", problem, "take one of them away"));
    }
    check_name(table, before.iter().map(|bond| &*bond.name))?;
    Ok(Bond {
        name: table.name(),
        shells: [one, other],
        gap_mm: table.get("gap_mm"),
        stiffness: table.get("stiffness"),
    })
}

fn check_name<'a>(table: &Table, mut others: impl Iterator<Item = &'a str>) -> Checked<()> {
    match others.any(|other| other == table.name()) {
        true => Err(table.wrong_at("name", "another one has the same name", "give each a name of its own")),
        false => Ok(()),
    }
}
