//! What makes two scenes the same run: hash and differences, field by field.
//!
//! Both work on the leaves of the scene as JSON, so that no field can be forgotten: one that the table of keys does
//! not know reaches everything.

use std::collections::BTreeMap;

use serde_json::{Map, Value, json};

use super::data::{Indicator, Probe, Scene};
use super::difference::{Difference, of_tables};
use super::key_table::SECTIONS;
use super::keys::{Reach, Section};
use crate::digest::Feed;

/// Where the path of a value in [`Scene`] is not the key of the scene file.
const RENAMED: [(&str, &str); 3] = [
    ("symmetry", "symmetry.part"),
    ("pipeline", "pipeline.stages"),
    ("adapt.length_limit.millimetres", "adapt.length_limit_mm"),
];

/// Path of the first probe where its error decides how the mesh is refined.
const REFINED_BY: &str = "adapt: the first probe";

/// Path of what of the plies changes no state: their strengths.
const FREE_OF_PLIES: &str = "ply: strengths";

/// What the hash of a scene begins with; changes when the meaning of a scene does.
const DOMAIN: &str = "foldline scene 1";

/// What the hash of results begins with.
const RESULTS_DOMAIN: &str = "foldline results 1";

/// Tables of a scene that change nothing that a finished run shows.
const WITHOUT_RESULTS: [&str; 2] = ["output.", "expect."];

/// Tables of a scene that repeat what the first of several shells has.
const OF_FIRST_SHELL: [&str; 4] = ["geometry.", "material.", "mesh.", "pose."];

impl Scene {
    /// Hashes everything that decides states: all keys but those that reach nothing ([`Reach::Free`]: outputs, expectations, the
    /// target, strengths, probes; though of these the first, without its name, where a tolerance asks for its error). Those may
    /// change, so that a run can be extended, or written with more output, and every stage done so far is found again.
    ///
    /// Fed are the domain string and then, in the order of their paths, each key and its value as JSON, each with its
    /// length in front: independent of the order of fields, of formatting and of comments in the scene file.
    pub fn hash(&self) -> blake3::Hash {
        hash_of(DOMAIN, self.leaves(), |path| reach(SECTIONS, path) != Reach::Free)
    }

    /// Hashes everything that decides what a finished run shows, fed as in [`Self::hash`]: besides what decides states also the
    /// target, probes and strengths. Runs of scenes that share it are one run, whatever else is written of them.
    pub fn results_hash(&self) -> blake3::Hash {
        hash_of(RESULTS_DOMAIN, self.leaves(), |path| !WITHOUT_RESULTS.iter().any(|table| path.starts_with(table)))
    }

    /// Lists every key on which the scenes differ, in alphabetical order; supports, actions and probes table by table.
    pub fn differences(&self, other: &Scene) -> Vec<Difference> {
        let (a, b) = (self.leaves(), other.leaves());
        let mut paths: Vec<_> = a.keys().chain(b.keys()).cloned().collect();
        paths.sort();
        paths.dedup();
        paths.retain(|path| a.get(path) != b.get(path));
        let of_path = |path: String| {
            let (a, b) = (a.get(&path), b.get(&path));
            let in_tables = of_tables(&path, a, b).filter(|found| !found.is_empty());
            // Tables in another order differ as a list.
            let whole =
                || vec![Difference { a: a.cloned(), b: b.cloned(), reach: reach(SECTIONS, &path), path: path.clone() }];
            in_tables.unwrap_or_else(whole)
        };
        paths.into_iter().flat_map(of_path).collect()
    }

    /// The probe by whose error the mesh is refined, and so decides states, though its name does not.
    fn probe_that_refines(&self) -> Option<&Probe> {
        let by_error = self.adapt.as_ref().is_some_and(|adapt| matches!(adapt.indicator, Indicator::Error(_)));
        self.probes.first().filter(|_| by_error && self.end_rotation().is_none())
    }

    /// Every value of the scene by its key in a scene file. Lists are values; keys without use are left out.
    pub(super) fn leaves(&self) -> BTreeMap<String, Value> {
        let mut leaves = BTreeMap::new();
        // A scene is structs of numbers, words and lists, which always have a JSON form.
        collect("", serde_json::to_value(self).unwrap_or_default(), &mut leaves);
        if !self.shells.is_empty() {
            // Those of the first shell stand among the shells.
            leaves.retain(|path, _| !OF_FIRST_SHELL.iter().any(|table| path.starts_with(table)));
        }
        if let Some(free) =
            leaves.get_mut("material.plies").and_then(Value::as_array_mut).and_then(|plies| take_free_of_plies(plies))
        {
            leaves.insert(FREE_OF_PLIES.to_owned(), free);
        }
        if let Some(probe) = self.probe_that_refines() {
            leaves.insert(REFINED_BY.to_owned(), serde_json::to_value(&probe.kind).unwrap_or_default());
        }
        leaves
    }
}

/// Hashes the values that are chosen by their path.
fn hash_of(domain: &str, leaves: BTreeMap<String, Value>, is_chosen: impl Fn(&str) -> bool) -> blake3::Hash {
    let mut feed = Feed::new(domain);
    for (path, value) in leaves.iter().filter(|(path, _)| is_chosen(path)) {
        feed.text(path);
        feed.text(&value.to_string());
    }
    feed.finish()
}

/// Takes from each ply what reaches nothing, where there is any.
fn take_free_of_plies(plies: &mut [Value]) -> Option<Value> {
    let is_free = |name: &String| reach(SECTIONS, &format!("ply.{name}")) == Reach::Free;
    let take = |ply: &mut Map<String, Value>| {
        let (free, kept) = std::mem::take(ply).into_iter().partition(|(name, _)| is_free(name));
        *ply = kept;
        free
    };
    let free: Vec<Map<String, Value>> = plies.iter_mut().filter_map(Value::as_object_mut).map(take).collect();
    free.iter().any(|ply| !ply.is_empty()).then(|| json!(free))
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

/// How far a change of a value reaches; the whole of an array of tables as far as any of its keys.
pub(super) fn reach(sections: &'static [Section], path: &str) -> Reach {
    let array = sections.iter().find(|section| section.is_list(path));
    match path {
        REFINED_BY => return Reach::Steps,
        FREE_OF_PLIES => return Reach::Free,
        _ => {}
    }
    let key = || sections.iter().flat_map(|section| section.keys).find(|key| key.path() == path).map(|key| key.reach);
    array.map(Section::reach).or_else(key).unwrap_or(Reach::Everything)
}
