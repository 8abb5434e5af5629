//! Iterates of replayed stages, for `replay --trace`: one MCAP and one CSV file.

use std::path::{Path, PathBuf};

use super::failure::Failure;
use super::output::{path_in_line, write_files};
use crate::equilibrium::Iterate;
use crate::journal::{TraceRow, trace_file};
use crate::record::Commit;
use crate::spline::Mesh;

/// An iterate with where it belongs.
pub(super) fn row(commit: &Commit, mesh: &Mesh, iterate: &Iterate) -> TraceRow {
    TraceRow {
        ordinal: commit.ordinal,
        step: commit.step,
        stage: commit.stage.name().to_string(),
        iteration: iterate.iteration,
        energy_n_mm: iterate.energy,
        residual_n: iterate.residual,
        relative_residual: iterate.relative_residual(),
        step_length: iterate.step_length,
        shift_n_per_mm: iterate.shift,
        negative_pivots: iterate.negative_pivots,
        worst_point: mesh.grid_place(iterate.worst_point),
        worst_point_mm: mesh.point(iterate.worst_point),
    }
}

/// FILE with the endings .mcap and .csv.
pub(super) fn files(file: &Path) -> [PathBuf; 2] {
    ["mcap", "csv"].map(|ending| file.with_extension(ending))
}

/// Writes both files. Returns what was written.
pub(super) fn write(file: &Path, rows: &[TraceRow]) -> Result<String, Failure> {
    let [mcap, csv] = files(file);
    let trace = trace_file(rows).map_err(|source| Failure::WrongLog { log: mcap.clone(), source: Box::new(source) })?;
    let written = format!("{} iterates: {}, {}\n", rows.len(), path_in_line(&mcap), path_in_line(&csv));
    write_files(&[(mcap, trace), (csv, table(rows).into_bytes())])?;
    Ok(written)
}

fn table(rows: &[TraceRow]) -> String {
    let mut text = String::from(
        "ordinal,step,stage,iteration,energy_n_mm,residual_n,relative_residual,step_length,shift_n_per_mm,\
         negative_pivots,worst_point_1,worst_point_2,worst_x_mm,worst_y_mm,worst_z_mm\n",
    );
    for row in rows {
        let [p1, p2] = row.worst_point;
        let [x, y, z] = row.worst_point_mm;
        text.push_str(&format!(
            "{},{},{},{},{:e},{:e},{:e},{},{:e},{},{p1},{p2},{x},{y},{z}\n",
            row.ordinal,
            row.step,
            row.stage,
            row.iteration,
            row.energy_n_mm,
            row.residual_n,
            row.relative_residual,
            row.step_length,
            row.shift_n_per_mm,
            row.negative_pivots
        ));
    }
    text
}
