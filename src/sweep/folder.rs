//! The folder of a sweep: its plan, logs, and what is on record of each task.
//!
//! | file | what |
//! |---|---|
//! | `sweep.json`, `tasks.jsonl`, `scene.toml` | the plan: what tasks share, a line for each, the scene that is varied |
//! | `logs/KEY.mcap` | the log of a task |
//! | `rows/KEY.json` | what is on record of a task that ended; whole or not there |
//! | `table.jsonl` | the same of many tasks, gathered for speed; may be removed |
//! | `table.csv` | the table, where it was collected |
//! | `slurm.json`, `slurm/` | see [`super::submission`] |
//!
//! Whoever does a task writes its record, on whatever machine; records of tasks that the plan does not have are left alone, so
//! that a sweep can be changed and changed back.

use std::collections::HashMap;
use std::fs::{self, File};
use std::io::{BufRead, BufReader, ErrorKind, Write};
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::error::SweepError;
use super::plan::{Head, Plan, Task};
use super::record::{Row, TaskRecord};
use crate::digest::Feed;
use crate::whole_file::WholeFile;

const HEAD: &str = "sweep.json";
const TASKS: &str = "tasks.jsonl";
const SCENE: &str = "scene.toml";
const TABLE: &str = "table.jsonl";
const CSV: &str = "table.csv";

/// The folder of a sweep.
#[derive(Clone, Debug)]
pub struct Folder {
    path: PathBuf,
}

impl Folder {
    /// Takes a folder for a sweep; nothing is read or made yet.
    pub fn at(path: &Path) -> Self {
        Self { path: path.to_path_buf() }
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Where logs lie.
    pub fn logs(&self) -> PathBuf {
        self.path.join("logs")
    }

    /// Whether it holds a sweep.
    pub fn holds_sweep(&self) -> bool {
        self.path.join(HEAD).is_file()
    }

    /// What the tasks share.
    ///
    /// # Errors
    /// Where there is no sweep, or its file is damaged.
    pub fn head(&self) -> Result<Head, SweepError> {
        let path = self.path.join(HEAD);
        let text = fs::read_to_string(&path).map_err(|source| SweepError::Read { path: path.clone(), source })?;
        let damaged = |problem: String| SweepError::Damaged { path: path.clone(), what: "plan", problem };
        let head: Head = serde_json::from_str(&text).map_err(|why| damaged(why.to_string()))?;
        match self.plan_hash(&head) {
            Ok(hash) if hash == head.plan_hash => Ok(head),
            Ok(_) => {
                Err(damaged("it is not as it was written, or the tasks or the scene beside it are not".to_owned()))
            }
            Err(error) => Err(damaged(error.to_string())),
        }
    }

    /// Hash of a plan as it lies in the folder.
    fn plan_hash(&self, head: &Head) -> Result<String, SweepError> {
        let mut feed = Feed::new("foldline planned 1");
        let head = Head { plan_hash: String::new(), ..head.clone() };
        feed.text(&serde_json::to_string(&head).unwrap_or_default());
        for name in [TASKS, SCENE] {
            let path = self.path.join(name);
            let bytes = fs::read(&path).map_err(|source| SweepError::Read { path, source })?;
            feed.integer(bytes.len() as u64);
            feed.bytes(&bytes);
        }
        Ok(feed.finish().to_hex().to_string())
    }

    /// The text of the scene that is varied.
    ///
    /// # Errors
    /// Where it cannot be read.
    pub fn scene_text(&self) -> Result<String, SweepError> {
        let path = self.path.join(SCENE);
        fs::read_to_string(&path).map_err(|source| SweepError::Read { path, source })
    }

    /// All tasks.
    ///
    /// # Errors
    /// Where they cannot be read.
    pub fn tasks(&self) -> Result<Vec<Task>, SweepError> {
        let path = self.path.join(TASKS);
        let file = File::open(&path).map_err(|source| SweepError::Read { path: path.clone(), source })?;
        let mut tasks = Vec::new();
        for (number, line) in BufReader::new(file).lines().enumerate() {
            let line = line.map_err(|source| SweepError::Read { path: path.clone(), source })?;
            let task = serde_json::from_str(&line).map_err(|why| SweepError::Damaged {
                path: path.clone(),
                what: "list of tasks",
                problem: format!("line {}: {why}", number + 1),
            })?;
            tasks.push(task);
        }
        Ok(tasks)
    }

    /// Writes a plan in a folder of its own, or over an earlier plan of the same file. Its hash comes last: a kill before leaves a
    /// folder that is to be planned again.
    ///
    /// # Errors
    /// Where the folder holds another sweep, or cannot be written.
    pub fn keep(&self, plan: &Plan) -> Result<(), SweepError> {
        match read_json::<Head>(&self.path.join(HEAD)) {
            // A sweep whose file was moved is known by its title.
            Some(there)
                if there.file != plan.head.file
                    && (there.title != plan.head.title || Path::new(&there.file).exists()) =>
            {
                let (title, file) = (there.title, there.file);
                return Err(SweepError::OtherSweep { folder: self.path.clone(), title, file });
            }
            Some(_) => {}
            None if self.holds_sweep() => {}
            None => {
                if let Some(name) = [TASKS, SCENE, "logs", "rows"].iter().find(|name| self.path.join(name).exists()) {
                    return Err(SweepError::InTheWay { folder: self.path.clone(), name });
                }
            }
        }
        for folder in [self.logs(), self.rows_folder()] {
            fs::create_dir_all(&folder).map_err(|source| SweepError::Write { path: folder, source })?;
        }
        let mut head = Head { plan_hash: String::new(), ..plan.head.clone() };
        self.write_json(HEAD, &head)?;
        self.write(TASKS, &lines(&plan.tasks))?;
        self.write(SCENE, plan.scene_text.as_bytes())?;
        head.plan_hash = self.plan_hash(&head)?;
        self.write_json(HEAD, &head)
    }

    /// Writes what is on record of a task.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn keep_record(&self, record: &TaskRecord) -> Result<(), SweepError> {
        self.write_json(&record_file(&record.key), &record.clone().sealed())
    }

    /// What is on record of a task. A record that cannot be read is none: the log gives it again.
    pub fn record(&self, key: &str) -> Option<TaskRecord> {
        let record: TaskRecord = read_json(&self.path.join(record_file(key)))?;
        (record.key == key && record.is_whole()).then_some(record)
    }

    /// Takes tasks off the record, so that they are done again.
    ///
    /// # Errors
    /// Where a record cannot be removed.
    pub fn forget<'k>(&self, keys: impl IntoIterator<Item = &'k str>) -> Result<(), SweepError> {
        let mut records = keys.into_iter().map(record_file).chain([TABLE.to_owned()]);
        records.try_for_each(|name| self.remove(&name))
    }

    /// Every task with what is on record of it and answers what the sweep asks; gathers records that the table does not have.
    ///
    /// # Errors
    /// Where tasks cannot be read. The table is written where it can be.
    pub fn rows(&self) -> Result<Vec<Row>, SweepError> {
        self.rows_gathered_from(MOST_UNGATHERED)
    }

    /// The same, and gathers whatever the table does not have.
    ///
    /// # Errors
    /// Where tasks cannot be read.
    pub fn gather(&self) -> Result<Vec<Row>, SweepError> {
        self.rows_gathered_from(0)
    }

    /// Writes the table as CSV; gives back where it lies.
    ///
    /// # Errors
    /// Where it cannot be written.
    pub fn keep_csv(&self, csv: &str) -> Result<PathBuf, SweepError> {
        self.write(CSV, csv.as_bytes())?;
        Ok(self.path.join(CSV))
    }

    fn rows_gathered_from(&self, most_ungathered: usize) -> Result<Vec<Row>, SweepError> {
        let (tasks, outputs) = (self.tasks()?, self.head()?.outputs);
        let mut known = self.table();
        let mut gathered = 0;
        let rows: Vec<Row> = tasks
            .into_iter()
            .map(|task| {
                // What was done again since has a newer record of its own.
                let in_table =
                    known.get(&task.key).filter(|record| record.answers(&task, &outputs) && record.is_whole()).cloned();
                let record = in_table.or_else(|| {
                    let found = self.record(&task.key).filter(|record| record.answers(&task, &outputs))?;
                    // What failed may be done again, and is not looked for in two places.
                    if !found.is_short() {
                        gathered += 1;
                        known.insert(task.key.clone(), found.clone());
                    }
                    Some(found)
                });
                Row { task, record }
            })
            .collect();
        if gathered > most_ungathered {
            let records: Vec<&TaskRecord> = known.values().collect();
            // Where nothing can be written, the next one gathers them again.
            let _ = self.write(TABLE, &lines(&records));
        }
        Ok(rows)
    }

    /// Records of the table; of damaged lines the rows are read.
    fn table(&self) -> HashMap<String, TaskRecord> {
        let Ok(file) = File::open(self.path.join(TABLE)) else { return HashMap::new() };
        let lines = BufReader::new(file).lines().map_while(Result::ok);
        let records = lines.filter_map(|line| serde_json::from_str::<TaskRecord>(&line).ok());
        records.map(|record| (record.key.clone(), record)).collect()
    }

    fn remove(&self, name: &str) -> Result<(), SweepError> {
        let path = self.path.join(name);
        match fs::remove_file(&path) {
            Err(source) if source.kind() != ErrorKind::NotFound => Err(SweepError::Write { path, source }),
            _ => Ok(()),
        }
    }

    fn write_json(&self, name: &str, value: &impl Serialize) -> Result<(), SweepError> {
        let text = serde_json::to_vec(value);
        let text = text.map_err(|why| SweepError::Write { path: self.path.join(name), source: why.into() })?;
        self.write(name, &text)
    }

    fn rows_folder(&self) -> PathBuf {
        self.path.join("rows")
    }

    pub(super) fn write(&self, name: &str, content: &[u8]) -> Result<(), SweepError> {
        let path = self.path.join(name);
        let written = WholeFile::beside(&path).and_then(|whole| {
            whole.file().write_all(content)?;
            whole.replace(&path)
        });
        written.map_err(|source| SweepError::Write { path, source })
    }
}

/// Records that are read one by one before they are gathered.
const MOST_UNGATHERED: usize = 256;

fn record_file(key: &str) -> String {
    format!("rows/{key}.json")
}

fn lines<T: Serialize>(items: &[T]) -> Vec<u8> {
    let mut text = Vec::new();
    for item in items {
        // Plain data always has a JSON form.
        if serde_json::to_writer(&mut text, item).is_ok() {
            text.push(b'\n');
        }
    }
    text
}

fn read_json<T: DeserializeOwned>(path: &Path) -> Option<T> {
    serde_json::from_slice(&fs::read(path).ok()?).ok()
}
