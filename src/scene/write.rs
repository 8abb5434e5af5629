//! A scene as TOML, in the order of the table of keys.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use super::data::{Load, Material, Scene};
use super::key_table::{OF_A_SHELL, SECTIONS};
use super::keys::{Section, toml_float};

impl Scene {
    /// Writes the scene as TOML with every key spelled out; parsing it gives the same scene.
    pub fn to_toml(&self) -> String {
        let leaves = self.leaves();
        let tables = SECTIONS.iter().flat_map(|section| match section.name {
            "shell" => (0..self.shells.len()).flat_map(|shell| self.tables_of_shell(section, shell)).collect(),
            name if OF_A_SHELL.contains(&name) && !self.shells.is_empty() => Vec::new(),
            _ => self.tables(section, &section.title(), &leaves),
        });
        tables.collect::<Vec<_>>().join("\n")
    }

    /// The tables of a section, with their headers.
    fn tables(&self, section: &Section, title: &str, leaves: &BTreeMap<String, Value>) -> Vec<String> {
        let tables = if section.many { self.items(section) } else { vec![self.values(section, leaves)] };
        tables.into_iter().map(|values| table(section, title, &values)).filter(|text| !text.is_empty()).collect()
    }

    /// The table of a shell, and those below it.
    fn tables_of_shell(&self, section: &Section, shell: usize) -> Vec<String> {
        let (own, alone) = (&self.shells[shell], self.of_shell(shell));
        let [x, y, _] = own.pose.axes;
        let values = json!({ "name": own.name, "position_mm": own.pose.position_mm, "x_axis": x, "y_axis": y });
        let values = values.as_object().cloned().unwrap_or_default();
        let leaves = alone.leaves();
        let below = SECTIONS.iter().filter(|section| OF_A_SHELL.contains(&section.name)).flat_map(|section| {
            let title = section.title().replacen(section.name, &format!("shell.{}", section.name), 1);
            alone.tables(section, &title, &leaves)
        });
        std::iter::once(table(section, &section.title(), &values)).chain(below).collect()
    }

    /// Values of a table of which there is one, by key.
    fn values(&self, section: &Section, leaves: &BTreeMap<String, Value>) -> Map<String, Value> {
        let prefix = format!("{}.", section.name);
        let own = leaves.iter().filter_map(|(path, value)| Some((path.strip_prefix(&prefix)?.into(), value.clone())));
        let mut values: Map<String, Value> = own.collect();
        match (section.name, &self.load) {
            // The kind of a load is not kept in the scene, and [symmetry] belongs to turning ends alone.
            ("load", Load::EndRotation(_)) => _ = values.insert("kind".into(), json!("end-rotation")),
            ("load", Load::Steps(_)) => _ = values.insert("kind".into(), json!("steps")),
            ("symmetry", Load::Steps(_)) => values.clear(),
            _ => {}
        }
        values
    }

    /// Values of the tables of an array, by key.
    fn items(&self, section: &Section) -> Vec<Map<String, Value>> {
        let items = match (section.name, &self.material) {
            ("ply", Material::Laminate { plies, .. }) => json!(plies),
            ("support", _) => json!(self.supports),
            ("action", _) => json!(self.actions),
            ("probe", _) => json!(self.probes),
            ("spring", _) => json!(self.springs),
            ("mass", _) => json!(self.masses),
            ("joint", _) => json!(self.joints),
            ("bond", _) => json!(self.bonds),
            ("imperfection", _) => json!(self.imperfections),
            _ => Value::Null,
        };
        let items = items.as_array().into_iter().flatten().filter_map(Value::as_object);
        items.map(|item| self.named(section, item)).collect()
    }

    /// Values of a table by key, with the names of shells.
    fn named(&self, section: &Section, item: &Map<String, Value>) -> Map<String, Value> {
        let name =
            |shell: &Value| json!(self.shell_name(shell.as_u64().unwrap_or_default() as usize).unwrap_or_default());
        let edge = |edge: &Value| {
            let shell = name(&edge["shell"]);
            json!(format!("{}.{}", shell.as_str().unwrap_or_default(), edge["edge"].as_str().unwrap_or_default()))
        };
        let list =
            |value: &Value, of: &dyn Fn(&Value) -> Value| value.as_array().into_iter().flatten().map(of).collect();
        let mut values: Map<String, Value> = item
            .iter()
            .flat_map(|(key, value)| match (section.name, &**key) {
                ("joint", "edges") => vec![("edges".to_owned(), list(value, &edge))],
                ("bond", "shells") => vec![("shells".to_owned(), list(value, &name))],
                ("support" | "action" | "probe" | "imperfection", "shell" | "also") => vec![],
                _ => as_written(key, value),
            })
            .collect();
        let is_on_a_shell = match section.name {
            "support" | "action" | "probe" => true,
            "imperfection" => values.contains_key("offsets_mm"),
            _ => false,
        };
        if self.shells.is_empty() || !is_on_a_shell {
            return values;
        }
        // The first shell is not written in the data of a scene, and nor is it where an action is on all of them.
        let first = json!(0);
        let shell = item.get("shell").unwrap_or(&first);
        match item.get("also") {
            Some(also) => {
                let on = json!({ "shell": shell, "edge": item["on"]["edge"] });
                let edges = std::iter::once(edge(&on)).chain(also.as_array().into_iter().flatten().map(edge)).collect();
                values.remove("on");
                values.insert("edges".into(), edges);
            }
            None if section.name != "action" || item.contains_key("shell") => {
                values.insert("shell".into(), name(shell));
            }
            None => {}
        }
        values
    }
}

/// A table with the keys that have a value.
fn table(section: &Section, title: &str, values: &Map<String, Value>) -> String {
    let kind = values.get("kind").and_then(Value::as_str);
    let lines =
        section.keys_of(kind).filter_map(|key| Some(format!("{} = {}\n", key.name, toml(values.get(key.name)?))));
    let lines: String = lines.collect();
    if lines.is_empty() { lines } else { format!("{title}\n{lines}") }
}

/// A field of the data of a support, an action or a probe, as the keys that it comes from.
fn as_written(name: &str, value: &Value) -> Vec<(String, Value)> {
    let own = |value: Value| vec![(name.to_owned(), value)];
    let zip = |names: &[&str]| {
        let given = names.iter().zip(value.as_array().into_iter().flatten()).filter(|(_, value)| !value.is_null());
        given.map(|(name, value)| ((*name).to_owned(), value.clone())).collect()
    };
    match (name, value) {
        ("on", Value::String(word)) if word == "whole" => vec![],
        ("on", Value::Object(place)) => match (place.get("line").and_then(Value::as_array), place.values().next()) {
            (Some(line), _) => own(json!(format!("{}={}", line[0].as_str().unwrap_or_default(), toml(&line[1])))),
            (None, Some(edge_or_point)) => own(edge_or_point.clone()),
            (None, None) => vec![],
        },
        ("displacement_mm", _) => zip(&["x_mm", "y_mm", "z_mm"]),
        ("motions", _) => zip(&["x_mm", "y_mm", "z_mm", "rotation_x_deg", "rotation_y_deg", "rotation_z_deg"]),
        ("normals_turn", Value::Bool(turn)) => vec![("normals".into(), json!(if *turn { "turn" } else { "free" }))],
        ("per", Value::String(area)) if area == "projected" => own(json!("projected-area")),
        // A force that is a size and a direction.
        (_, Value::Array(items)) if name.starts_with("force_n") && items.len() == 2 => zip(&[name, "along"]),
        _ => own(value.clone()),
    }
}

fn toml(value: &Value) -> String {
    match value {
        Value::Number(number) if number.is_f64() => number.as_f64().map_or_else(|| number.to_string(), toml_float),
        Value::Array(items) => format!("[{}]", items.iter().map(toml).collect::<Vec<_>>().join(", ")),
        Value::Object(fields) => {
            let fields = fields.iter().map(|(name, value)| format!("{name} = {}", toml(value)));
            format!("{{ {} }}", fields.collect::<Vec<_>>().join(", "))
        }
        other => other.to_string(),
    }
}
