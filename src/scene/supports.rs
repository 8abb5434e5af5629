//! The array of tables `[[support]]`: what holds the shell.

use super::data::{Edge, History, Hold, Motion, Region, ShellEdge, Support};
use super::fault::Checked;
use super::histories::history;
use super::shells::Shells;
use super::table::Table;

/// One `[[support]]`.
pub(super) fn support(table: &Table, shells: &Shells) -> Checked<Support> {
    let zero = Some(0.0);
    let (on, hold) = match table.kind() {
        "hinged" => (table.get("on"), Hold::Displacement { displacement_mm: [zero; 3] }),
        "fixed" => {
            let held: Vec<String> = table.get("hold");
            let displacement_mm = ["x", "y", "z"].map(|axis| held.iter().any(|word| word == axis).then_some(0.0));
            (table.get("on"), Hold::Displacement { displacement_mm })
        }
        "displacement" => {
            let displacement_mm: [Option<f64>; 3] = ["x_mm", "y_mm", "z_mm"].map(|name| table.get(name));
            if displacement_mm == [None; 3] {
                return Err(table.wrong(
                    None,
                    "no component is given",
                    "write `x_mm`, `y_mm` or `z_mm`; those left out are free",
                ));
            }
            (table.get("on"), Hold::Displacement { displacement_mm })
        }
        "symmetric" => (table.get("on"), Hold::Symmetric),
        "rigid-motions" => (Region::Whole, Hold::RigidMotions),
        "clamped" => {
            let hold = Hold::Rigid { motions: [Motion::Given(0.0); 6], reference_mm: None, normals_turn: true };
            (first_edge(table), hold)
        }
        "rigid" => {
            let names = ["x_mm", "y_mm", "z_mm", "rotation_x_deg", "rotation_y_deg", "rotation_z_deg"];
            let hold = Hold::Rigid {
                motions: names.map(|name| table.get(name)),
                reference_mm: table.get("reference_mm"),
                normals_turn: table.word("normals") == "turn",
            };
            (first_edge(table), hold)
        }
        other => unreachable!("a support of kind {other}"),
    };
    let history: History = history(table)?;
    let edges = shells.edges(table, "edges")?;
    check_edges(table, &edges)?;
    let shell = match edges.first() {
        Some(first) => Some(first.shell),
        None => shells.named_in(table, on == Region::Whole)?,
    };
    let on = edges.first().map_or(on, |first| Region::Edge(first.edge));
    let also = edges.into_iter().skip(1).collect();
    Ok(Support { name: table.name(), on, shell: shell.unwrap_or(0), also, hold, history })
}

/// The edge that a table names by `on`; another one where it lists edges of several shells, which take its place.
fn first_edge(table: &Table) -> Region {
    Region::Edge(table.get::<Option<Edge>>("on").unwrap_or(Edge::UStart))
}

/// Refuses a list that names an edge twice, and one beside the name of a shell.
fn check_edges(table: &Table, edges: &[ShellEdge]) -> Checked<()> {
    if let (Some(_), Some(place)) = (edges.first(), table.place_of("shell")) {
        let problem = "`edges` says which shells are meant already";
        return Err(table.wrong(Some(&place), problem, "take `shell` out"));
    }
    match (1..edges.len()).any(|index| edges[..index].contains(&edges[index])) {
        true => Err(table.wrong_at("edges", "an edge is named twice", "name each once")),
        false => Ok(()),
    }
}
