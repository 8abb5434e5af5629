//! The tasks of a sweep: a scene for each combination of values, with what decides its results as its key.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use serde_json::Value;

use super::error::SweepError;
use super::quantity::Quantity;
use super::sampling::points;
use super::sweep_file::{Combine, SweepFile};
use crate::digest::Feed;
use crate::record::NUMERICS_REVISION;
use crate::scene::{Scene, parse, parse_with_settings};
use crate::study::{is_comparable, run_name, short_name};

/// Columns of what is wrong with a scene: it goes on record, and is read on whatever terminal.
const COLUMNS: usize = 60;

/// What all tasks of a sweep share.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Head {
    /// What the sweep shows.
    pub title: String,
    /// Its file, as a whole path, or the name that it comes with the program under.
    pub file: String,
    /// File of the scene that is varied.
    pub scene: String,
    /// Settings laid over every task.
    pub settings: Vec<String>,
    /// Settings laid over those of a task for its reference.
    pub reference: Option<Vec<String>>,
    /// Keys that vary.
    pub columns: Vec<String>,
    /// What is collected.
    pub outputs: Vec<Quantity>,
    /// Number of tasks, references among them.
    pub tasks: usize,
    /// Hash of the texts that it was planned from.
    pub planned_from: String,
    /// Hash of the plan as it was written; none before that.
    #[serde(default)]
    pub plan_hash: String,
}

/// A task of a sweep.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Task {
    /// Its number, from 1 on: references first.
    pub number: usize,
    /// What decides its results, hashed.
    pub key: String,
    /// Values of the columns.
    pub values: Vec<Value>,
    /// Whether others are compared with it.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub is_reference: bool,
    /// Key of its reference.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub reference: Option<String>,
    /// What is wrong with its scene.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub refused: Option<String>,
}

/// A sweep with all its tasks.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What they share.
    pub head: Head,
    /// Text of the scene that is varied.
    pub scene_text: String,
    /// The tasks by their numbers.
    pub tasks: Vec<Task>,
}

impl Head {
    /// The scene of a task, from the text of the scene that is varied.
    ///
    /// # Errors
    /// What is wrong with it, with the lines of its text.
    pub fn scene_of(&self, scene_text: &str, task: &Task) -> Result<Scene, String> {
        let own = self.columns.iter().zip(&task.values).map(|(key, value)| format!("{key}={value}"));
        let of_reference = self.reference.iter().flatten().filter(|_| task.is_reference).cloned();
        let settings: Vec<String> = self.settings.iter().cloned().chain(own).chain(of_reference).collect();
        scene_with(scene_text, &self.scene, &settings)
    }
}

fn scene_with(text: &str, name: &str, settings: &[String]) -> Result<Scene, String> {
    parse_with_settings(text, name, settings).map_err(|error| error.fitted(false, Some(COLUMNS)))
}

impl Plan {
    /// Plans the tasks of a sweep in `file`, whose text is `sweep_text`, over the scene of `scene_text` in the file `scene_file`.
    ///
    /// # Errors
    /// Where not one of the scenes can be run, they cannot be compared with their references, or have no probe that is asked for.
    pub fn of(
        sweep: &SweepFile,
        [sweep_text, scene_text]: [&str; 2],
        [file, scene_file]: [&str; 2],
    ) -> Result<Self, SweepError> {
        let wrong = |problem: String| SweepError::Wrong { file: file.to_owned(), problem };
        let mut head = Head {
            title: sweep.title.clone(),
            file: file.to_owned(),
            scene: scene_file.to_owned(),
            settings: sweep.settings.clone(),
            reference: sweep.reference.as_ref().map(|reference| reference.settings.clone()),
            columns: sweep.columns(),
            outputs: sweep.outputs.clone(),
            tasks: 0,
            planned_from: planned_from(sweep_text, scene_text, scene_file),
            plan_hash: String::new(),
        };
        let scene_text = whole(scene_text, scene_file);
        let values = all_values(sweep);
        let made = |values: Vec<Value>, is_reference| {
            let mut task = Task { number: 0, key: String::new(), values, is_reference, reference: None, refused: None };
            match head.scene_of(&scene_text, &task) {
                Ok(scene) => task.key = run_name(&scene),
                Err(why) => (task.key, task.refused) = (name_of_refused(&scene_text, &task, &why), Some(why)),
            }
            task
        };
        let mut tasks: Vec<Task> = values.into_par_iter().map(|values| made(values, false)).collect();
        if let Some(first) = tasks.first().filter(|_| tasks.iter().all(|task| task.refused.is_some())) {
            let (file, reason) = (file.to_owned(), first.refused.clone().unwrap_or_default());
            return Err(SweepError::AllRefused { file, tasks: tasks.len(), reason });
        }
        let mut references: Vec<Task> = Vec::new();
        if head.reference.is_some() {
            let of_tasks: Vec<Task> =
                tasks.par_iter().map(|task| made(values_of_reference(&head, &task.values), true)).collect();
            let mut seen = std::collections::BTreeSet::new();
            if let Some(problem) = not_comparable(&head, &scene_text, &tasks, &of_tasks) {
                return Err(wrong(problem));
            }
            for (task, reference) in tasks.iter_mut().zip(of_tasks) {
                task.reference = Some(reference.key.clone());
                if seen.insert(reference.key.clone()) {
                    references.push(reference);
                }
            }
        }
        references.append(&mut tasks);
        let mut tasks = references;
        tasks.iter_mut().enumerate().for_each(|(index, task)| task.number = index + 1);
        head.tasks = tasks.len();
        let can_be_run = tasks.iter().filter(|task| task.refused.is_none());
        if let Some(scene) = can_be_run.filter_map(|task| head.scene_of(&scene_text, task).ok()).next() {
            if head.outputs.is_empty() {
                head.outputs = Quantity::of_scene(&scene);
            }
            if let Some(output) = head.outputs.iter().find(|output| output.is_of_no_probe(&scene)) {
                return Err(wrong(format!("{output}: the scene has no [[probe]] of that name")));
            }
        }
        Ok(Self { head, scene_text, tasks })
    }
}

/// Why the first task that can be run cannot be compared with its reference.
fn not_comparable(head: &Head, scene_text: &str, tasks: &[Task], references: &[Task]) -> Option<String> {
    let scenes =
        |(task, reference)| Some((head.scene_of(scene_text, task).ok()?, head.scene_of(scene_text, reference).ok()?));
    let (scene, reference) = tasks.iter().zip(references).find_map(scenes)?;
    let why = is_comparable(&scene, &reference).err()?;
    Some(format!("tasks cannot be compared with their [reference]: {why}"))
}

/// Values of the columns of a task's reference: what the reference sets itself replaces the task's.
fn values_of_reference(head: &Head, values: &[Value]) -> Vec<Value> {
    let set = |key: &String| {
        let settings = head.reference.iter().flatten().rev();
        let mut own = settings.filter_map(|setting| setting.split_once('=')).filter(|(name, _)| name.trim() == *key);
        let (_, text) = own.next()?;
        // A word needs no quotes in a setting.
        let parsed = toml::from_str::<toml::Table>(&format!("value = {text}"));
        let value = parsed.ok().and_then(|table| table.get("value").cloned());
        Some(value.map_or_else(|| Value::from(text.trim()), |value| serde_json::to_value(value).unwrap_or_default()))
    };
    head.columns.iter().zip(values).map(|(key, value)| set(key).unwrap_or_else(|| value.clone())).collect()
}

/// Hash of what a plan follows from: the sweep, the scene with the surface that it reads from a file of its own, and the program.
pub fn planned_from(sweep_text: &str, scene_text: &str, scene_file: &str) -> String {
    let mut feed = Feed::new("foldline plan 1");
    for text in [sweep_text, &whole(scene_text, scene_file), env!("CARGO_PKG_VERSION"), &NUMERICS_REVISION.to_string()]
    {
        feed.text(text);
    }
    feed.finish().to_hex().to_string()
}

/// A scene needs no other file: what is in files of their own goes into the text.
fn whole(scene_text: &str, name: &str) -> String {
    match parse(scene_text, name) {
        Ok(scene) if scene.may_read_files() => scene.to_toml(),
        _ => scene_text.to_owned(),
    }
}

/// The name of a task whose scene is wrong.
fn name_of_refused(scene_text: &str, task: &Task, why: &str) -> String {
    let mut feed = Feed::new("foldline refused 1");
    let values = task.values.iter().map(Value::to_string).collect::<Vec<_>>().join("\n");
    [scene_text, &values, why].into_iter().for_each(|text| feed.text(text));
    short_name(feed.finish())
}

/// Values of the columns for each task, samples changing fastest.
fn all_values(sweep: &SweepFile) -> Vec<Vec<Value>> {
    let lengths: Vec<usize> = sweep.axis.iter().map(|axis| axis.count()).collect();
    let combinations: Vec<Vec<usize>> = match sweep.combine {
        Combine::Zip => (0..lengths.first().copied().unwrap_or(1)).map(|index| vec![index; lengths.len()]).collect(),
        Combine::All => lengths.iter().fold(vec![vec![]], |shorter: Vec<Vec<usize>>, length| {
            let longer =
                |places: &Vec<usize>| (0..*length).map(|index| [&places[..], &[index]].concat()).collect::<Vec<_>>();
            shorter.iter().flat_map(longer).collect()
        }),
    };
    let samples = match sweep.sample {
        Some(sample) if !sweep.scatter.is_empty() => points(&sample, sweep.scatter.len()),
        _ => vec![vec![]],
    };
    let mut all = Vec::with_capacity(combinations.len() * samples.len());
    for places in &combinations {
        let of_axes = sweep.axis.iter().zip(places).flat_map(|(axis, index)| axis.at(*index));
        let of_axes: Vec<Value> = of_axes.map(|value| serde_json::to_value(value).unwrap_or_default()).collect();
        for sample in &samples {
            let scattered =
                sweep.scatter.iter().zip(sample).map(|(scatter, share)| Value::from(scatter.quantile(*share)));
            all.push(of_axes.iter().cloned().chain(scattered).collect());
        }
    }
    all
}
