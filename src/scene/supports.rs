//! The array of tables `[[support]]`: what holds the shell.

use super::data::{History, Hold, Motion, Region, Support};
use super::fault::Checked;
use super::histories::history;
use super::table::Table;

/// One `[[support]]`.
pub(super) fn support(table: &Table) -> Checked<Support> {
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
            (Region::Edge(table.get("on")), hold)
        }
        "rigid" => {
            let names = ["x_mm", "y_mm", "z_mm", "rotation_x_deg", "rotation_y_deg", "rotation_z_deg"];
            let hold = Hold::Rigid {
                motions: names.map(|name| table.get(name)),
                reference_mm: table.get("reference_mm"),
                normals_turn: table.word("normals") == "turn",
            };
            (Region::Edge(table.get("on")), hold)
        }
        other => unreachable!("a support of kind {other}"),
    };
    let history: History = history(table)?;
    Ok(Support { name: table.name(), on, hold, history })
}
