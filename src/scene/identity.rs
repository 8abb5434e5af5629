//! What makes two scenes the same run: hash and differences, field by field.
//!
//! Both work on the leaves of the scene as JSON, so that no field can be forgotten: one that the table of keys does
//! not know reaches everything.

use std::collections::BTreeMap;
use std::fmt;

use serde_json::Value;

use super::data::Scene;
use super::key_table::KEYS;
use super::keys::Reach;

/// A key on which two scenes differ.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The key as it stands in a scene file: `solver.tolerance`.
    pub path: String,
    /// Its value in the first scene; `None` where that has no use for it.
    pub a: Option<Value>,
    /// Its value in the second.
    pub b: Option<Value>,
    /// How far the change reaches.
    pub reach: Reach,
}

impl Difference {
    /// Its values in the two scenes, each in a line.
    pub fn values(&self) -> [String; 2] {
        shown_values(&self.a, &self.b)
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let show = |value: &Option<Value>| value.as_ref().map_or("not used".into(), Value::to_string);
        write!(f, "{}: {} -> {}", self.path, show(&self.a), show(&self.b))
    }
}

/// Characters of a scene's value that are shown at most.
const LONGEST_SHOWN: usize = 60;

/// Where the path of a value in [`Scene`] is not the key of the scene file.
const RENAMED: [(&str, &str); 3] = [
    ("symmetry", "symmetry.part"),
    ("pipeline", "pipeline.stages"),
    ("adapt.length_limit.millimetres", "adapt.length_limit_mm"),
];

/// What the hash of a scene begins with; changes when the meaning of a scene does.
const DOMAIN: &str = "foldline scene 1";

impl Scene {
    /// Hash over everything that decides states: all keys but `output.*`, `expect.*` and `load.rotation_deg`. Those
    /// are free, so that a run can be extended, or written with more beside it, and every stage done so far is found
    /// again.
    ///
    /// Fed are the domain string and then, in the order of their paths, each key and its value as JSON, each with its
    /// length in front: independent of the order of fields, of formatting and of comments in the scene file.
    pub fn hash(&self) -> blake3::Hash {
        let mut hasher = blake3::Hasher::new();
        let mut feed = |text: &str| {
            hasher.update(&(text.len() as u64).to_le_bytes());
            hasher.update(text.as_bytes());
        };
        feed(DOMAIN);
        for (path, value) in self.leaves() {
            if reach(&path) != Reach::Free {
                feed(&path);
                feed(&value.to_string());
            }
        }
        hasher.finalize()
    }

    /// Every key on which the scenes differ, in alphabetical order.
    pub fn differences(&self, other: &Scene) -> Vec<Difference> {
        let (a, b) = (self.leaves(), other.leaves());
        let mut paths: Vec<_> = a.keys().chain(b.keys()).cloned().collect();
        paths.sort();
        paths.dedup();
        paths.retain(|path| a.get(path) != b.get(path));
        paths
            .into_iter()
            .map(|path| Difference { a: a.get(&path).cloned(), b: b.get(&path).cloned(), reach: reach(&path), path })
            .collect()
    }

    /// Every value of the scene by its key in a scene file. Lists are values; keys without use are left out.
    pub(super) fn leaves(&self) -> BTreeMap<String, Value> {
        let mut leaves = BTreeMap::new();
        // A scene is structs of numbers, words and lists, which always have a JSON form.
        collect("", serde_json::to_value(self).unwrap_or_default(), &mut leaves);
        leaves
    }
}

fn collect(path: &str, value: Value, leaves: &mut BTreeMap<String, Value>) {
    match value {
        Value::Null => {}
        Value::Object(fields) => {
            for (name, value) in fields {
                let path = if path.is_empty() { name } else { format!("{path}.{name}") };
                collect(&path, value, leaves);
            }
        }
        value => {
            let renamed = RENAMED.iter().find(|(inside, _)| *inside == path);
            leaves.insert(renamed.map_or(path, |(_, key)| key).to_owned(), value);
        }
    }
}

fn reach(path: &str) -> Reach {
    // Keys of tables that depend on their kind: the table of keys does not hold them.
    match path {
        "load.factor" | "probes" => return Reach::Free,
        "load.increment" | "load.longest_increment" | "load.least_increment" | "load.snap_tolerance" => {
            return Reach::Steps;
        }
        _ => {}
    }
    KEYS.iter().find(|key| key.path() == path).map_or(Reach::Everything, |key| key.reach)
}

/// Two values of a scene that differ, as they stand in its file, each in one line: of long ones no more than what is around
/// the first place at which they do.
pub fn shown_values(a: &Option<Value>, b: &Option<Value>) -> [String; 2] {
    let texts = [a, b].map(|value| value.as_ref().map_or("not set".to_string(), ToString::to_string));
    let alike = texts[0].chars().zip(texts[1].chars()).take_while(|(a, b)| a == b).count();
    let long = |text: &String| text.chars().count() > LONGEST_SHOWN;
    let from = if texts.iter().any(long) { alike.saturating_sub(LONGEST_SHOWN / 3) } else { 0 };
    texts.map(|text| shown_from(&text, from))
}

/// A line of a text from a character on, with how much of it is left out.
fn shown_from(text: &str, from: usize) -> String {
    let before = if from > 0 { "… " } else { "" };
    let shown: String = text.chars().skip(from).take(LONGEST_SHOWN).collect();
    match text.chars().count().saturating_sub(from + LONGEST_SHOWN) {
        0 => format!("{before}{shown}"),
        more => format!("{before}{shown} … {more} characters more"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_is_a_line() {
        let elements = Some(serde_json::json!([4, 8]));
        assert_eq!(shown_values(&None, &elements), ["not set", "[4,8]"]);
        let mut net = vec![[0.25, 1.5, 2.0]; 1000];
        let before = Some(serde_json::json!(net));
        let [shown, none] = shown_values(&before, &None);
        assert!(shown.starts_with("[[0.25,1.5,2.0],[0.25") && shown.ends_with(" characters more"), "{shown}");
        assert!(shown.len() < 100 && none == "not set", "{shown}");
        // What is alike says nothing: the first number that differs is shown.
        net[700][1] = 1.75;
        let [from, to] = shown_values(&before, &Some(serde_json::json!(net)));
        assert!(from.starts_with("… ") && from.contains("[0.25,1.5,2.0]") && from != to, "{from}");
        assert!(to.contains("[0.25,1.75,2.0]") && to.len() < 100, "{to}");
    }
}
