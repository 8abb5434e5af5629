//! `foldline compare`: runs next to each other.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::{EXIT_CODES, Failure};
use super::log_file::{Gathered, ReadLog, read_through};
use super::output::{file_name, path_in_line, print};
use super::report::write_page;
use crate::history::{redefined_probes, remove_redefined};
use crate::printable::one_line;
use crate::record::Parameter;
use crate::scene::Difference;
use crate::spline::Elements;
use crate::study::{Curve, Deviation, Finding, Summary};
use crate::units::{signed, significant};

/// Columns of the text.
const WIDTH: usize = 80;
/// Columns of the names of numbers, of a number, and of its difference.
const NAME: usize = 24;
const NUMBER: usize = 12;
const DIFFERENCE: usize = 10;
/// Digits of a number.
const DIGITS: usize = 6;
/// Digits of the hash of a scene.
const HASH: usize = 8;
/// Further runs that fit in a line.
const BESIDE: usize = (WIDTH - NAME - NUMBER) / (NUMBER + DIFFERENCE);

/// Show runs next to each other: what each came to and cost, with the difference of every further one from the first, where their
/// curves part most, and what their scenes differ in
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES)]
pub(super) struct Arguments {
    /// Logs to read (MCAP); the others are compared with the first
    #[arg(required = true, num_args = 2.., value_name = "LOG")]
    logs: Vec<PathBuf>,
    /// Write the page that `foldline report` writes of them as well
    #[arg(short, long, value_name = "FILE", value_parser = file_name())]
    output: Option<PathBuf>,
}

impl Arguments {
    /// Reads the logs, and prints what they come to.
    pub(super) fn run(self) -> Result<(), Failure> {
        let Self { logs, output } = self;
        let runs: Vec<ComparedRun> =
            logs.iter().enumerate().map(|(index, log)| ComparedRun::read(index, log)).collect::<Result<_, _>>()?;
        if let Some(output) = &output {
            write_page(&logs, output)?;
        }
        let page = output.map_or(String::new(), |output| format!("\n{}\n", path_in_line(&output)));
        print(&(text(&runs) + &page))
    }
}

/// A run, as it is compared.
struct ComparedRun {
    /// What it is called in tables.
    letter: String,
    path: PathBuf,
    read: ReadLog,
    /// Elements (along u, along v) of the model at the end.
    elements: Option<Elements>,
    findings: Vec<Finding>,
    curve: Curve,
}

impl ComparedRun {
    fn read(index: usize, path: &Path) -> Result<Self, Failure> {
        let mut gathered = Gathered::default();
        let read = read_through(path, |portion| gathered.take(portion))?;
        let mut records = gathered.records;
        remove_redefined(&redefined_probes(&read.log), &mut records);
        let summary = Summary::new(&read.scene, &records);
        Ok(Self {
            letter: letter(index),
            path: path.to_path_buf(),
            elements: summary.meshes.last().map(|mesh| mesh.elements.clone()),
            findings: summary.findings(),
            curve: Curve::of(&read.scene, &records),
            read,
        })
    }

    /// Log, scene, whether the run came to its end, and its mesh.
    fn head(&self) -> String {
        let Self { letter, path, read, elements, .. } = self;
        let file = read.log.manifests().last().map_or("", |made| &made.scene_file);
        let file = Path::new(file).file_name().unwrap_or_default().to_string_lossy();
        let hash = read.scene.hash().to_hex();
        let end = if read.is_finished() { "finished" } else { "unfinished" };
        let mut text = format!("{letter:<3}{}\n", path_in_line(path));
        let _ = writeln!(text, "   scene {} ({}), {end}", one_line(&file), &hash[..HASH]);
        if let Some(elements) = elements {
            let [p, q] = read.scene.mesh.degree;
            let _ = writeln!(text, "   {elements} elements of the model at the end, degrees {p} and {q}");
        }
        text
    }

    fn value(&self, row: &Finding) -> Option<f64> {
        let is_it = |finding: &&Finding| (&finding.name, &finding.unit) == (&row.name, &row.unit);
        self.findings.iter().find(is_it).map(|finding| finding.value)
    }
}

/// A, B, … Z, and numbers beyond.
fn letter(index: usize) -> String {
    let letter = u8::try_from(index).ok().and_then(|index| b'A'.checked_add(index)).filter(u8::is_ascii_uppercase);
    letter.map_or_else(|| (index + 1).to_string(), |letter| char::from(letter).to_string())
}

/// All that is shown.
fn text(runs: &[ComparedRun]) -> String {
    let Some((first, others)) = runs.split_first() else { return String::new() };
    let mut text: String = runs.iter().map(ComparedRun::head).collect();
    let rows = rows(runs);
    for others in others.chunks(BESIDE) {
        text += &format!("\n{}", table(&rows, first, others));
    }
    text += &format!("\n{}", parting(first, others));
    for other in others {
        text += &format!("\n{}", scenes(first, other));
    }
    text
}

/// What any of the runs has, in an order that keeps that of each where it can.
fn rows(runs: &[ComparedRun]) -> Vec<&Finding> {
    let mut rows: Vec<&Finding> = Vec::new();
    for run in runs {
        let mut next = 0;
        for finding in &run.findings {
            let is_it = |row: &&Finding| (&row.name, &row.unit) == (&finding.name, &finding.unit);
            let place = rows.iter().position(is_it).unwrap_or_else(|| {
                rows.insert(next, finding);
                next
            });
            next = place + 1;
        }
    }
    rows
}

/// Numbers of the first run and of some others, with their differences from it.
fn table(rows: &[&Finding], first: &ComparedRun, others: &[ComparedRun]) -> String {
    let mut text = format!("{:NAME$}{:>NUMBER$}", "", first.letter);
    for other in others {
        let _ = write!(text, "{:>NUMBER$}{:DIFFERENCE$}", other.letter, "");
    }
    let mut text = text.trim_end().to_owned() + "\n";
    for row in rows {
        let of_first = first.value(row);
        let mut line = format!("{:NAME$}{:>NUMBER$}", name(row), shown(of_first));
        for other in others {
            let value = other.value(row);
            let difference = of_first.zip(value).map_or(String::new(), |(from, to)| difference(from, to));
            let _ = write!(line, "{:>NUMBER$}{difference:>DIFFERENCE$}", shown(value));
        }
        text += line.trim_end();
        text.push('\n');
    }
    text
}

/// The name of a number with its unit, as much as there is room for.
fn name(Finding { name, unit, .. }: &Finding) -> String {
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    let room = NAME.saturating_sub(3 + unit.chars().count());
    let name = one_line(name);
    match name.chars().count() > room {
        true => format!("  {}…{unit}", name.chars().take(room.saturating_sub(1)).collect::<String>()),
        false => format!("  {name}{unit}"),
    }
}

fn shown(value: Option<f64>) -> String {
    value.map_or("–".into(), |value| significant(value, DIGITS))
}

/// A difference in percent of where it is from.
fn difference(from: f64, to: f64) -> String {
    match 100.0 * (to - from) / from {
        _ if from == to => "=".into(),
        percent if percent.abs() < 1000.0 => format!("{} %", signed(percent, 2)),
        percent if percent.abs() < 1e6 => format!("{} %", signed(percent, 0)),
        // From nothing, or next to it.
        _ => String::new(),
    }
}

/// Where the curves of the others part most from that of the first.
fn parting(first: &ComparedRun, others: &[ComparedRun]) -> String {
    let mut text = format!(
        "{}: largest difference from {}, in % of the largest of {} there\n",
        one_line(&first.curve.quantity),
        first.letter,
        first.letter
    );
    let at = |Deviation { parameter, share }: Deviation| {
        let unit = if first.curve.driven_by == Parameter::Rotation { "°" } else { "" };
        let place = if share > 0.0 { format!(" at {}{unit}", significant(parameter, DIGITS)) } else { String::new() };
        format!("{} %{place}", significant(100.0 * share, 3))
    };
    for other in others {
        let told = match first.curve.deviations(&other.curve) {
            Err(cause) => format!("not compared: {cause}"),
            Ok([None, None]) => "no load step of one lies between those of the other".into(),
            Ok([before, behind]) => {
                let before = before.map(|before| at(before) + " before any jump");
                let behind = behind.map(|behind| at(behind) + " behind both");
                before.into_iter().chain(behind).collect::<Vec<_>>().join(", ")
            }
        };
        let _ = writeln!(text, "  {:<3}{told}", other.letter);
    }
    text
}

/// What the scenes of two runs differ in.
fn scenes(first: &ComparedRun, other: &ComparedRun) -> String {
    let differences = first.read.scene.differences(&other.read.scene);
    if differences.is_empty() {
        return format!("{} has the scene of {}\n", other.letter, first.letter);
    }
    let lines: String = differences.iter().map(line_of).collect();
    format!("the scene of {} differs from that of {} in\n{lines}", other.letter, first.letter)
}

/// A key with both values, in a line where they fit.
fn line_of(difference: &Difference) -> String {
    let ([from, to], path) = (difference.values(), one_line(&difference.path));
    let line = format!("  {path}: {from} → {to}\n");
    if line.chars().count() <= WIDTH { line } else { format!("  {path}\n    {from}\n    → {to}\n") }
}
