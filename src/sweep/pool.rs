//! The tasks of a sweep on this machine: references first, then all others, as many at a time as there is room for.

use std::collections::BTreeSet;

use super::error::SweepError;
use super::folder::Folder;
use super::plan::Task;
use super::record::TaskRecord;
use super::work::Work;
use crate::model::starting_mesh;
use crate::spline::Patch;
use crate::study::{EngineError, Room, TaskError, Workers};

/// What came of a task on this machine.
#[derive(Debug)]
pub enum Outcome {
    /// It is on record.
    OnRecord(TaskRecord),
    /// It is not, and can be continued.
    Left(TaskError),
}

/// Tasks that are not on record yet, or not with all outputs.
///
/// # Errors
/// Where the folder cannot be read.
pub fn to_do(folder: &Folder) -> Result<Vec<Task>, SweepError> {
    let mut seen = BTreeSet::new();
    let open = folder.rows()?.into_iter().filter(|row| row.record.is_none()).map(|row| row.task);
    // Tasks that share what decides their results are one.
    Ok(open.filter(|task| seen.insert((task.key.clone(), task.is_reference))).collect())
}

/// Does tasks, and puts what came of each on record before `take` is told. No task begins after `interrupted`, which also stops those in
/// hand after their stage.
///
/// # Errors
/// Where a record cannot be written or threads cannot be made.
pub fn do_tasks(
    folder: &Folder,
    work: &Work<'_>,
    tasks: &[Task],
    workers: Workers,
    interrupted: &(dyn Fn() -> bool + Sync),
    mut take: impl FnMut(&Task, &Outcome),
) -> Result<(), EngineError<SweepError>> {
    let room = Room::of_this_machine();
    let (references, others): (Vec<&Task>, Vec<&Task>) = tasks.iter().partition(|task| task.is_reference);
    for group in [references, others] {
        let bytes = |index: usize| group.get(index).map_or(0, |task| bytes_of(work, task));
        let measure = |index: usize| work.of(group[index], interrupted);
        workers.run(group.len(), interrupted, &room, &bytes, &measure, |index, ended| {
            let task: &Task = group[index];
            let outcome = match work.record(task, ended) {
                Ok(record) => {
                    folder.keep_record(&record)?;
                    Outcome::OnRecord(record)
                }
                Err(error) => Outcome::Left(error),
            };
            take(task, &outcome);
            Ok(())
        })?;
    }
    Ok(())
}

/// Bytes that a task is taken to need on the mesh that it starts with, with all elements halved to judge it: the factor of a band
/// matrix, unknowns times half the band.
fn bytes_of(work: &Work<'_>, task: &Task) -> u64 {
    const AT_LEAST: f64 = 20e6;
    let Ok(scene) = work.scene_of(task) else { return 0 };
    let Ok(mesh) = starting_mesh(&scene) else { return AT_LEAST as u64 };
    let judged = if scene.adapt.is_some() { 2 } else { 1 };
    let of_patch = |patch: &Patch| {
        let (elements, degree) = (patch.element_counts(), patch.degree);
        let lines = [0, 1].map(|way| (judged * elements[way] + degree[way]) as f64);
        let unknowns = 3.0 * lines[0] * lines[1];
        let band = 3.0 * lines[0].min(lines[1]) * (degree[0].max(degree[1]) + 1) as f64;
        2.0 * 8.0 * unknowns * band
    };
    (AT_LEAST + mesh.patches.iter().map(of_patch).sum::<f64>()) as u64
}
