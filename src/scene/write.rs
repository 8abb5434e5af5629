//! A scene as TOML.

use std::collections::BTreeMap;

use serde_json::Value;

use super::data::{Geometry, Load, Material, Scene};
use super::key_table::{KEYS, SECTIONS};
use super::keys::{Kind, toml_float};
use super::write_general;

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
                        // The first kind of a load is not kept in the scene; the others are written elsewhere.
                        (None, Kind::Word([first, ..])) if key.name == "kind" => format!("\"{}\"", first.word),
                        (None, _) => return None,
                    };
                    Some(format!("{} = {value}\n", key.name))
                })
                .collect();
            let lines = general_lines(self, section.name, &leaves).unwrap_or(lines);
            if !lines.is_empty() {
                let gap = if text.is_empty() { "" } else { "\n" };
                text.push_str(&format!("{gap}[{}]\n{lines}", section.name));
            }
        }
        text + &write_general::arrays(self)
    }
}

/// Lines of a section whose keys depend on its kind; `None` where the table of keys knows them.
fn general_lines(scene: &Scene, section: &str, leaves: &BTreeMap<String, Value>) -> Option<String> {
    let general = match section {
        "geometry" => !matches!(scene.geometry, Geometry::TapeSpring { .. }),
        "material" => !matches!(scene.material, Material::Isotropic { .. }),
        "load" => matches!(scene.load, Load::Steps(_)),
        // [symmetry] belongs to turning ends alone.
        "symmetry" => return matches!(scene.load, Load::Steps(_)).then(String::new),
        _ => false,
    };
    if !general {
        return None;
    }
    let prefix = format!("{section}.");
    let own = leaves.iter().filter_map(|(path, value)| Some((path.strip_prefix(&prefix)?, value)));
    let lines = own.filter(|(name, _)| *name != "plies").map(|(name, value)| format!("{name} = {}\n", toml(value)));
    let kind = if section == "load" { "kind = \"steps\"\n" } else { "" };
    Some(kind.to_owned() + &lines.collect::<String>())
}

fn toml(value: &Value) -> String {
    match value {
        Value::Number(number) if number.is_f64() => number.as_f64().map_or_else(|| number.to_string(), toml_float),
        Value::Array(items) => format!("[{}]", items.iter().map(toml).collect::<Vec<_>>().join(", ")),
        other => other.to_string(),
    }
}
