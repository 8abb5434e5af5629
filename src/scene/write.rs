//! A scene as TOML.

use serde_json::Value;

use super::data::{Load, Scene};
use super::key_table::SECTIONS;
use super::keys::{Key, toml_float};
use super::write_arrays;

impl Scene {
    /// The scene as TOML, every key spelled out; parsing it gives the same scene.
    pub fn to_toml(&self) -> String {
        let leaves = self.leaves();
        let mut text = String::new();
        for section in SECTIONS.iter().filter(|section| !section.many) {
            // The kind of a load is not kept in the scene.
            let load = section.name == "load";
            let kind = match &self.load {
                Load::EndRotation(_) if load => "end-rotation",
                Load::Steps(_) if load => "steps",
                _ => leaves.get(&format!("{}.kind", section.name)).and_then(Value::as_str).unwrap_or_default(),
            };
            let line = |key: &Key| {
                let value =
                    leaves.get(&key.path()).map(toml).or((load && key.name == "kind").then(|| format!("\"{kind}\"")));
                value.map(|value| format!("{} = {value}\n", key.name))
            };
            let lines: String = section.keys_of(Some(kind)).filter_map(line).collect();
            // [symmetry] belongs to turning ends alone.
            let is_used = section.name != "symmetry" || self.end_rotation().is_some();
            if !lines.is_empty() && is_used {
                let gap = if text.is_empty() { "" } else { "\n" };
                text.push_str(&format!("{gap}[{}]\n{lines}", section.name));
            }
        }
        text + &write_arrays::arrays(self)
    }
}

fn toml(value: &Value) -> String {
    match value {
        Value::Number(number) if number.is_f64() => number.as_f64().map_or_else(|| number.to_string(), toml_float),
        Value::Array(items) => format!("[{}]", items.iter().map(toml).collect::<Vec<_>>().join(", ")),
        other => other.to_string(),
    }
}
