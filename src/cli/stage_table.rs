//! The stages of a log as a table, and the stages of one load step in full.

use std::fmt::Write as _;

use super::wrapped::hanging;
use crate::record::{ConnectionReading, LargestTraction, Outcome, Parameter, Record, Report};
use crate::scene::Stage;
use crate::units::{reading, significant};

/// A column: its head, and whether its cells are right-aligned.
struct Column(&'static str, bool);

const COLUMNS: [Column; 14] = [
    Column("#", true),
    Column("step", true),
    Column("stage", false),
    Column("θ °", true),
    Column("M N·mm", true),
    Column("Π N·mm", true),
    Column("mesh", true),
    Column("free", true),
    Column("iter", true),
    Column("fact", true),
    Column("neg", true),
    Column("wall s", true),
    Column("state", false),
    Column("", false),
];

/// Columns that are left out where a terminal is too narrow, the least important first; their numbers are in `--step`.
const LEFT_OUT: [usize; 8] = [12, 9, 11, 7, 5, 10, 8, 0];

/// Columns that the last one has at least, where it is wider than that; its cells are continued below.
const NOTE: usize = 24;

/// Formats stages as a table with a row for each; columns are as wide as they need to be, and a run of a thousand
/// stages fits 120 characters. With fewer `columns` than it needs some are left out.
///
/// `mesh` is elements along the length × along the arc, `free` the free unknowns, `neg` the negative pivots; blank is
/// zero. The last column shows what else happened; ✗ is a solve rejected, at the rotation that it tried, ! a warning.
pub fn stage_table(records: &[Record], columns: Option<usize>) -> String {
    let steps = records.first().is_some_and(|record| record.report.driven_by == Parameter::LoadFactor);
    // Where no ends turn, the first probe replaces their moment: of the last scene, which may have others.
    let probe = records.iter().rev().find_map(|record| record.report.probes.first());
    let probe = probe.map(|reading| reading.name.clone());
    // The cells are made twice: those of a long run do not fit in memory.
    let rows = || records.iter().map(|record| cells(record, probe.as_deref()));
    let mut heads = COLUMNS.map(|column| column.0.to_string());
    if steps {
        heads[3] = "factor".into();
        heads[4] = probe.clone().unwrap_or_default();
    }
    let mut widths = COLUMNS.map(|column| column.0.chars().count());
    for row in rows() {
        widths.iter_mut().zip(&row).for_each(|(width, cell)| *width = cell.chars().count().max(*width));
    }
    widths[4] = widths[4].max(heads[4].chars().count());
    let shown = shown(&widths, columns);
    let mut table = String::new();
    for row in std::iter::once(heads).chain(rows()) {
        let mut line = String::new();
        for &column in &shown {
            let (cell, width) = (&row[column], widths[column]);
            let cell = if COLUMNS[column].1 { format!("{cell:>width$}") } else { format!("{cell:<width$}") };
            line.push_str(&cell);
            line.push(' ');
        }
        let note = &row[COLUMNS.len() - 1];
        table.push_str(hanging(&line, note, columns).trim_end());
        table.push('\n');
    }
    table
}

/// The columns before the last that there is room for.
fn shown(widths: &[usize; COLUMNS.len()], columns: Option<usize>) -> Vec<usize> {
    let last = COLUMNS.len() - 1;
    let mut shown: Vec<usize> = (0..last).collect();
    let note = widths[last].min(NOTE);
    for left_out in LEFT_OUT {
        let taken = shown.iter().map(|&column| widths[column] + 1).sum::<usize>() + note;
        if columns.is_none_or(|columns| taken <= columns) {
            break;
        }
        shown.retain(|&column| column != left_out);
    }
    shown
}

/// The cells of a stage; `probe` is the name of the one that has a column.
fn cells(record: &Record, probe: Option<&str>) -> [String; COLUMNS.len()] {
    let Record { report, commit, wall_s, .. } = record;
    let unless_zero = |number: u64| if number == 0 { String::new() } else { number.to_string() };
    [
        commit.ordinal.to_string(),
        report.step.to_string(),
        report.stage.name().to_string(),
        format!("{:.3}", report.parameter),
        match report.driven_by {
            Parameter::Rotation => reading(report.moment_n_mm, 3),
            Parameter::LoadFactor => {
                let shown = report.probes.iter().find(|found| Some(&*found.name) == probe);
                shown.map_or(String::new(), |probe| reading(probe.value, 4))
            }
        },
        reading(report.strain_energy_n_mm, 3),
        report.elements.with_sign("×"),
        report.unknowns.to_string(),
        unless_zero(report.iterations as u64),
        unless_zero(report.factorizations as u64),
        unless_zero(report.negative_pivots),
        format!("{wall_s:.2}"),
        commit.state_hash.to_hex()[..8].to_string(),
        note(report),
    ]
}

/// What else happened, in few words; warnings after it.
fn note(report: &Report) -> String {
    let mut notes = vec![happened(report)];
    notes.extend(report.warnings.iter().map(|warning| format!("! {}", warning.name())));
    notes.retain(|note| !note.is_empty());
    notes.join(", ")
}

fn happened(report: &Report) -> String {
    let attempted = report.attempted_parameter;
    let degree = if report.driven_by == Parameter::Rotation { "°" } else { "" };
    match report.outcome {
        Outcome::RejectedJump => format!("✗ unstable by {attempted:.3}{degree}"),
        Outcome::RejectedCriticalPoint => format!("✗ past critical {attempted:.3}{degree}"),
        Outcome::RejectedSharpTurn => format!("✗ sharp turn {attempted:.3}{degree}"),
        Outcome::RejectedNoEquilibrium => format!("✗ no solution {attempted:.3}{degree}"),
        Outcome::Done if report.jumped => match report.energy_released_n_mm {
            Some(released) => format!("snap, −{released:.2} N·mm"),
            None => "snap".to_string(),
        },
        Outcome::Done if report.rippled => "a ripple of the mesh".to_string(),
        Outcome::Done if report.stage == Stage::SwitchBranch => {
            report.energy_released_n_mm.map_or("left".to_string(), |released| format!("left, −{released:.2e} N·mm"))
        }
        Outcome::Done if report.critical_point.is_some() => {
            report.critical_point.map_or(String::new(), |passed| passed.in_words())
        }
        Outcome::Done if report.marked != [0, 0] => {
            let verb = if report.stage == Stage::RefineKnots { "inserted" } else { "marked" };
            format!("{verb} {} + {}", report.marked[0], report.marked[1])
        }
        Outcome::Done => String::new(),
    }
}

/// Lists all fields of every stage of load step `step`; empty where the log has no such step.
pub fn step_in_full(records: &[Record], step: u64) -> String {
    let mut text = String::new();
    for record in records.iter().filter(|record| record.report.step == step) {
        if !text.is_empty() {
            text.push('\n');
        }
        for (name, value) in in_full(record) {
            // Writing to a string does not fail.
            let _ = match name {
                "" => writeln!(text, "{value}"),
                name => writeln!(text, "  {name:<20} {value}"),
            };
        }
    }
    text
}

/// A number with all digits that mean something; each bit is in the JSON.
fn digits(number: f64) -> String {
    significant(number, 12)
}

/// What a joint or a bond shows of an equilibrium.
fn connection_in_words(
    ConnectionReading { name, energy_share, opened_deg, peel, shear }: &ConnectionReading,
) -> String {
    let opened = opened_deg.map(|angle| format!("opened by {}°", significant(angle, 4)));
    let largest = |kind: &str, traction: &Option<LargestTraction>| {
        let LargestTraction { mpa, at: [u, v] } = traction.as_ref()?;
        let [u, v] = [u, v].map(|parameter| significant(*parameter, 3));
        Some(format!("{kind} at most {} MPa, at u = {u}, v = {v}", significant(*mpa, 4)))
    };
    let share = format!("{name}: {} % of the energy", significant(100.0 * energy_share, 3));
    let further = [opened, largest("peel", peel), largest("shear", shear)].into_iter().flatten();
    [share].into_iter().chain(further).collect::<Vec<_>>().join("; ")
}

fn in_full(record: &Record) -> Vec<(&'static str, String)> {
    let Record { report, commit, wall_s, .. } = record;
    let outcome = match report.outcome {
        Outcome::Done if report.jumped => "done; the shell jumped".to_string(),
        Outcome::Done if report.rippled => "done; a ripple of the mesh was passed".to_string(),
        Outcome::Done => "done".to_string(),
        Outcome::RejectedJump => {
            "rejected: unstable on the way, or jumped; the increment is halved until that is located".to_string()
        }
        Outcome::RejectedCriticalPoint => {
            "rejected: past a limit point or a bifurcation; the step is halved until that is located".to_string()
        }
        Outcome::RejectedSharpTurn => {
            "rejected: the path turned too far, or this is another branch; the step is halved".to_string()
        }
        Outcome::RejectedNoEquilibrium => "rejected: no equilibrium found; the increment is halved".to_string(),
    };
    let mut lines = vec![
        ("", format!("stage {}: {}, load step {}", commit.ordinal, report.stage, report.step)),
        ("outcome", outcome),
        match report.driven_by {
            Parameter::Rotation => ("rotation", format!("{}°", digits(report.parameter))),
            Parameter::LoadFactor => ("load factor", digits(report.parameter)),
        },
    ];
    if report.attempted_parameter != report.parameter {
        lines.push(match report.driven_by {
            Parameter::Rotation => ("attempted rotation", format!("{}°", digits(report.attempted_parameter))),
            Parameter::LoadFactor => ("attempted factor", digits(report.attempted_parameter)),
        });
    }
    if report.driven_by == Parameter::Rotation {
        lines.push(("end moment", format!("{} N·mm", digits(report.moment_n_mm))));
    }
    for probe in &report.probes {
        lines.push(("probe", format!("{} = {} {}", probe.name, digits(probe.value), probe.unit)));
    }
    lines.push(("strain energy", format!("{} N·mm", digits(report.strain_energy_n_mm))));
    lines.extend(report.connections.iter().map(|connection| ("connection", connection_in_words(connection))));
    if let Some(length) = report.path_length_mm {
        lines.push(("length of the path", format!("{} mm (root mean square displacement)", digits(length))));
    }
    if let Some(passed) = report.critical_point {
        lines.push(("passed", passed.in_words()));
    }
    if report.jumped || report.rippled || report.stage == Stage::SwitchBranch {
        let released = report.energy_released_n_mm;
        lines.push((
            "energy released",
            released.map_or("not known".to_string(), |energy| format!("{} N·mm", digits(energy))),
        ));
    }
    lines.extend([
        ("elements", format!("{} = {} (length × arc, of the model)", report.elements, report.elements.count())),
        ("free unknowns", report.unknowns.to_string()),
    ]);
    if report.stage.finds_equilibrium() {
        lines.extend([
            ("Newton iterations", report.iterations.to_string()),
            ("factorizations", report.factorizations.to_string()),
            ("residual/forces", format!("{:.3e}", report.residual)),
        ]);
    }
    let stable = if report.negative_pivots == 0 { "stable" } else { "not stable" };
    lines.push(("negative pivots", format!("{} ({stable})", report.negative_pivots)));
    if report.stage == Stage::EvaluateIndicators {
        let ([marked1, marked2], [r1, r2]) = (report.marked, report.largest_indicator);
        lines.extend([
            ("knots asked for", format!("{marked1} along the length, {marked2} along the arc")),
            ("largest max|κ| h", format!("{r1} along the length, {r2} along the arc")),
        ]);
        if let Some([e1, e2]) = report.estimated_error.map(|error| error.map(|relative| 100.0 * relative)) {
            lines.push(("estimated error", format!("{e1:.4} % by spans along the length, {e2:.4} % along the arc")));
        }
    }
    lines.extend(report.warnings.iter().map(|warning| ("warning", warning.in_words())));
    lines.extend([
        ("wall time", format!("{wall_s:.6} s")),
        ("state", commit.state_hash.to_string()),
        ("parent state", commit.parent_hash.to_string()),
        ("chain", commit.chain_hash.to_string()),
        ("scene", commit.scene_hash.to_string()),
    ]);
    lines
}
