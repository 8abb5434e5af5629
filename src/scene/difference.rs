//! A key on which two scenes differ, and how that is shown; supports, actions and probes are compared table by table.

use std::fmt;

use serde_json::Value;

use super::key_table::SECTIONS;
use super::keys::Reach;

/// A key that has different values in two scenes.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The key as written in a scene file: `solver.tolerance`; of a table that has a name `support.hinge.on`.
    pub path: String,
    /// Its value in the first scene; `None` where that has no use for it.
    pub a: Option<Value>,
    /// Its value in the second.
    pub b: Option<Value>,
    /// How far the change reaches.
    pub reach: Reach,
}

impl Difference {
    /// The values of the key in the two scenes, each in one line.
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

/// Differences of a list of tables, a key each; `None` where `path` is no such list.
pub(super) fn of_tables(path: &str, a: Option<&Value>, b: Option<&Value>) -> Option<Vec<Difference>> {
    let section = SECTIONS.iter().find(|section| section.is_list(path))?;
    let [a, b] = [a, b].map(|list| list.and_then(Value::as_array).map_or(&[][..], Vec::as_slice));
    let aligned = is_aligned(a, b);
    let pairs: Vec<(Option<&Value>, Option<&Value>)> = match aligned {
        true => a.iter().zip(b).map(|(was, is)| (Some(was), Some(is))).collect(),
        false => {
            let gone = a.iter().filter(|was| named(b, was).is_none()).map(|was| (Some(was), None));
            b.iter().map(|is| (named(a, is), Some(is))).chain(gone).collect()
        }
    };
    // What a key means on its own hangs on the tables before it.
    let reach = |key: Option<&str>| {
        let key = key.filter(|_| aligned).and_then(|name| section.key(None, name));
        key.map_or(section.reach(), |key| key.reach)
    };
    Some(pairs.into_iter().flat_map(|(was, is)| of_table(section.name, was, is, reach)).collect())
}

/// Whether the tables of two lists are the same ones in the same order, some perhaps renamed.
fn is_aligned(a: &[Value], b: &[Value]) -> bool {
    let is_pair =
        |(was, is): (&Value, &Value)| was["name"] == is["name"] || (named(b, was).is_none() && named(a, is).is_none());
    a.len() == b.len() && a.iter().zip(b).all(is_pair)
}

/// The table of a list that has the name of another.
fn named<'v>(list: &'v [Value], table: &Value) -> Option<&'v Value> {
    list.iter().find(|other| other["name"] == table["name"])
}

/// Differences of two tables, a key each; of one alone, or of two kinds, the whole table. `reach` gives how far each reaches.
fn of_table(
    table: &str,
    was: Option<&Value>,
    is: Option<&Value>,
    reach: impl Fn(Option<&str>) -> Reach,
) -> Vec<Difference> {
    let name = was.or(is).and_then(|it| it["name"].as_str()).unwrap_or_default();
    let difference = |key: Option<&str>, a: Option<&Value>, b: Option<&Value>| {
        let path = key.map_or(format!("{table}.{name}"), |key| format!("{table}.{name}.{key}"));
        Difference { path, a: a.cloned(), b: b.cloned(), reach: reach(key) }
    };
    match (was.and_then(Value::as_object), is.and_then(Value::as_object)) {
        (Some(a), Some(b)) if a.get("kind") == b.get("kind") => {
            let mut keys: Vec<&String> = a.keys().chain(b.keys()).collect();
            keys.sort();
            keys.dedup();
            let differ = keys.into_iter().filter(|key| a.get(*key) != b.get(*key));
            differ.map(|key| difference(Some(key), a.get(key), b.get(key))).collect()
        }
        _ if was == is => Vec::new(),
        _ => vec![difference(None, was, is)],
    }
}

/// Characters of a scene's value that are shown at most.
const LONGEST_SHOWN: usize = 60;

/// Formats two values of a scene that differ, as a scene file would have them, each in one line; of long ones only what
/// is around the first difference.
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
    use serde_json::json;

    use super::*;

    #[track_caller]
    fn assert_differ(list: &str, a: Value, b: Value, expected: &[(&str, Reach)]) {
        let found = of_tables(list, Some(&a), Some(&b)).unwrap();
        let found: Vec<(&str, Reach)> = found.iter().map(|it| (&*it.path, it.reach)).collect();
        assert_eq!(found, expected);
    }

    #[test]
    fn a_table_is_a_line_for_each_of_its_keys() {
        let pull = |name: &str, force: f64| json!({ "name": name, "kind": "force", "force_n": force });
        let both = json!([pull("a", 1.0), pull("b", 1.0)]);
        let renamed = json!([pull("a", 1.0), pull("c", 2.0)]);
        let keys = [("action.b.force_n", Reach::Everything), ("action.b.name", Reach::Names)];
        assert_differ("actions", both.clone(), renamed.clone(), &keys);
        let keys = [("probe.b.force_n", Reach::Free), ("probe.b.name", Reach::Free)];
        assert_differ("probes", both.clone(), renamed, &keys);
        let fewer = json!([pull("b", 1.0)]);
        assert_differ("actions", both.clone(), fewer.clone(), &[("action.a", Reach::Everything)]);
        assert_differ("probes", fewer, both, &[("probe.a", Reach::Free)]);
    }

    /// A history means the same only where nothing else has changed.
    #[test]
    fn histories_reach_as_far_as_the_loads() {
        let push = |name: &str, end: f64| json!({ "name": name, "kind": "force", "history": [[0.0, 0.0], [1.0, end]] });
        let was = json!([push("a", 1.0), push("b", 1.0)]);
        let keys = [("action.b.history", Reach::LaterLoads)];
        assert_differ("actions", was.clone(), json!([push("a", 1.0), push("b", 2.0)]), &keys);
        let keys = [("action.b.history", Reach::Everything)];
        assert_differ("actions", was, json!([push("b", 2.0), push("a", 1.0)]), &keys);
        // Whatever it is called.
        let [force, pressure] = ["force", "pressure"].map(|kind| json!([{ "name": "a.history", "kind": kind }]));
        assert_differ("actions", force, pressure, &[("action.a.history", Reach::Everything)]);
    }

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
