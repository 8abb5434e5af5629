//! A scene as TOML, in the order of the table of keys.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use super::data::{Load, Material, Scene};
use super::key_table::SECTIONS;
use super::keys::{Section, toml_float};

impl Scene {
    /// Writes the scene as TOML with every key spelled out; parsing it gives the same scene.
    pub fn to_toml(&self) -> String {
        let leaves = self.leaves();
        let tables = SECTIONS.iter().flat_map(|section| {
            let tables = if section.many { self.items(section) } else { vec![self.values(section, &leaves)] };
            tables.into_iter().map(|values| table(section, &values)).filter(|text| !text.is_empty())
        });
        tables.collect::<Vec<_>>().join("\n")
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
            _ => Value::Null,
        };
        let items = items.as_array().into_iter().flatten().filter_map(Value::as_object);
        items.map(|item| item.iter().flat_map(|(name, value)| as_written(name, value)).collect()).collect()
    }
}

/// A table with the keys that have a value.
fn table(section: &Section, values: &Map<String, Value>) -> String {
    let kind = values.get("kind").and_then(Value::as_str);
    let lines =
        section.keys_of(kind).filter_map(|key| Some(format!("{} = {}\n", key.name, toml(values.get(key.name)?))));
    let lines: String = lines.collect();
    if lines.is_empty() { lines } else { format!("{}\n{lines}", section.title()) }
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
