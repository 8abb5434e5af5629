//! The meshes of a run: how many elements from which load step on, and which knots came and went.

use std::sync::Arc;

use super::asked::{Asked, ordinal};
use super::failure::Failure;
use super::wrapped::wrapped;
use crate::history::States;
use crate::record::{Parameter, Record};
use crate::scene::Scene;
use crate::spline::{Mesh, Patch};
use crate::units::significant;

/// A row for the first mesh and for each that followed; below it the knots, from 0 to 1 along each side, that it has and the one
/// before had not (+), and those that it no longer has (−).
pub(super) fn mesh_table(asked: &Asked) -> Result<String, Failure> {
    let records = asked.records()?;
    let driven_by = records.first().map(|record| record.report.driven_by);
    let at = if driven_by == Some(Parameter::LoadFactor) { "factor" } else { "θ °" };
    let mut text = format!("{:>6}  {at:>9}  {:>11}  {:>8}\n", "step", "elements", "unknowns");
    let changes: Vec<&Record> =
        records.chunk_by(|a, b| a.report.elements == b.report.elements).map(|of| &of[0]).collect();
    let stages: Vec<usize> = changes.iter().map(|record| ordinal(record)).collect();
    let mut changes = changes.into_iter();
    let mut before: Option<Arc<Mesh>> = None;
    for part in asked.log.parts(&stages) {
        let (log, indices) = part.map_err(asked.changed())?;
        let mut states = States::of(&log);
        for (&index, record) in indices.iter().zip(&mut changes) {
            let state = states.at(index).map_err(|source| asked.unusable(source))?;
            text += &row(record);
            if let Some(before) = before.replace(state.mesh.clone()) {
                text += &knots_changed(&asked.scene, &before, &state.mesh);
            }
        }
    }
    Ok(text)
}

fn row(Record { report, .. }: &Record) -> String {
    let elements = report.elements.to_string();
    format!("{:>6}  {:>9.3}  {elements:>11}  {:>8}\n", report.step, report.parameter, report.unknowns)
}

fn knots_changed(scene: &Scene, before: &Mesh, after: &Mesh) -> String {
    let mut lines = String::new();
    for (shell, patches) in before.patches.iter().zip(&after.patches).enumerate() {
        let changed = patch_changed(patches.0, patches.1);
        if let Some(name) = scene.shell_name(shell).filter(|_| !changed.is_empty()) {
            lines += &format!("          {name}\n");
        }
        lines += &changed;
    }
    lines
}

fn patch_changed(before: &Patch, after: &Patch) -> String {
    let mut lines = String::new();
    for (direction, name) in ["length", "arc"].into_iter().enumerate() {
        let [before, after] = [before, after].map(|patch| &patch.knots[direction]);
        for (sign, knots) in [("+", not_among(after, before)), ("−", not_among(before, after))] {
            if !knots.is_empty() {
                let knots: Vec<String> = knots.iter().map(|knot| significant(*knot, 6)).collect();
                lines += &(wrapped(&format!("          {name:<6} {sign} "), &knots.join(" ")) + "\n");
            }
        }
    }
    lines
}

fn not_among(knots: &[f64], others: &[f64]) -> Vec<f64> {
    knots.iter().copied().filter(|knot| !others.contains(knot)).collect()
}
