//! A scene as TOML.

use serde_json::Value;

use super::data::Scene;
use super::key_table::{KEYS, SECTIONS};
use super::keys::{Kind, toml_float};

impl Scene {
    /// The scene as TOML, every key spelled out; parsing it gives the same scene.
    pub fn to_toml(&self) -> String {
        let leaves = self.leaves();
        let mut text = String::new();
        for section in &SECTIONS {
            let lines: String = KEYS
                .iter()
                .filter(|key| key.section == section.name)
                .filter_map(|key| {
                    let value = match (leaves.get(&key.path()), &key.kind) {
                        (Some(value), _) => toml(value),
                        // A kind that is the only one is not kept in the scene.
                        (None, Kind::Word([only])) if key.name == "kind" => format!("\"{}\"", only.word),
                        (None, _) => return None,
                    };
                    Some(format!("{} = {value}\n", key.name))
                })
                .collect();
            if !lines.is_empty() {
                let gap = if text.is_empty() { "" } else { "\n" };
                text.push_str(&format!("{gap}[{}]\n{lines}", section.name));
            }
        }
        text
    }
}

fn toml(value: &Value) -> String {
    match value {
        Value::Number(number) if number.is_f64() => number.as_f64().map_or_else(|| number.to_string(), toml_float),
        Value::Array(items) => format!("[{}]", items.iter().map(toml).collect::<Vec<_>>().join(", ")),
        other => other.to_string(),
    }
}
