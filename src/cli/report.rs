//! `foldline report`: runs as one page.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use clap::Args;

use super::asked::{Ends, ordinal};
use super::failure::{EXIT_CODES, Failure};
use super::log_file::read_log;
use super::output::{file_name, path_in_line, print_as_it_is, write_files};
use super::plotted::names_of;
use super::speed_ups;
use crate::history::States;
use crate::journal::Manifest;
use crate::scene::Parameter;
use crate::view::{FrameAt, PlotError, ReportedRun, Shape, Told, chosen_frames, report_page};

/// Write a page about runs that needs no network: curves with critical points, the deformed shell to be turned and played, the
/// mesh, time, energies, scenes and hashes
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES)]
pub(super) struct Arguments {
    /// Logs to read (MCAP), several drawn in one picture; or study files (TOML), of which those runs are run that are not logged yet
    #[arg(required = true, value_name = "LOG|STUDY")]
    logs: Vec<PathBuf>,
    /// Page to write [default: the first log's name with .html]
    #[arg(short, long, value_name = "FILE", value_parser = file_name())]
    output: Option<PathBuf>,
    /// Of studies: folder of the logs of their runs
    #[arg(long, value_name = "DIR", default_value = "checkpoints/studies")]
    study_logs: PathBuf,
}

impl Arguments {
    /// Reads the logs, writes the page, and names it.
    pub(super) fn run(self) -> Result<(), Failure> {
        let Self { logs, output, study_logs } = self;
        let output = output.unwrap_or_else(|| logs[0].with_extension("html"));
        let is_study = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "toml");
        match logs.iter().find(|path| is_study(path)) {
            None => {}
            Some(_) if logs.iter().all(is_study) => {
                return speed_ups::run(&logs, &[], &study_logs, rayon::current_num_threads(), false, Some(&output));
            }
            Some(study) => return Err(Failure::StudyAmongLogs { study: study.clone() }),
        }
        write_page(&logs, &output)?;
        print_as_it_is(&format!("{}\n", path_in_line(&output)))
    }
}

/// Writes the page of some logs.
pub(super) fn write_page(logs: &[PathBuf], output: &Path) -> Result<(), Failure> {
    let names = names_of(logs.iter().map(PathBuf::as_path));
    let runs: Vec<ReportedRun> =
        logs.iter().zip(&names).map(|(log, name)| reported(log, name)).collect::<Result<_, _>>()?;
    if runs.iter().any(|run| run.axes() != runs[0].axes()) {
        return Err(Failure::NoCommonCurve);
    }
    let page = report_page(&names.join(", "), &runs).map_err(|cause| PlotError::Drawing(cause.to_string()))?;
    write_files(&[(output.to_path_buf(), page.into_bytes())])
}

/// What the page shows of a log.
fn reported(path: &Path, name: &str) -> Result<ReportedRun, Failure> {
    let read = read_log(path)?.whole(path)?;
    let records = read.records_of_scene(path)?;
    let last = records.last().ok_or(PlotError::NoEquilibrium)?;
    let mut ends = Ends::default();
    records.iter().for_each(|record| ends.take(record));
    let steps: Vec<u64> = ends.records.iter().map(|record| record.report.step).collect();
    if steps.is_empty() {
        return Err(PlotError::NoEquilibrium.into());
    }
    let jumps: BTreeSet<u64> =
        records.iter().filter(|record| record.report.jumped).map(|record| record.report.step).collect();
    let chosen = chosen_frames(&steps, |step| jumps.contains(&step) || jumps.contains(&(step + 1)));
    let mut states = States::of(&read.log);
    let mut frames = Vec::new();
    for end in ends.records.iter().filter(|end| chosen.contains(&end.report.step)) {
        let wrong = |source| Failure::WrongLog { log: path.to_path_buf(), source: Box::new(source) };
        let state = states.at(ordinal(end)).map_err(wrong)?;
        let label = Parameter::of(&read.scene).shown_short(state.parameter);
        frames.push(FrameAt { step: state.step, label, state });
    }
    let mut origin = vec![
        ("log".to_owned(), path_in_line(path)),
        ("scene hash".to_owned(), last.commit.scene_hash.to_string()),
        ("last chain hash".to_owned(), last.commit.chain_hash.to_string()),
    ];
    origin.extend(read.log.manifests().iter().next_back().map(machine).into_iter().flatten());
    let scene_text = read.log.manifests().iter().next_back().map_or_else(String::new, |made| made.scene_text.clone());
    let told = Told { name: name.to_owned(), scene_text, origin };
    Ok(ReportedRun::new(&read.scene, &records, told, Shape::new(&read.scene, &frames)))
}

fn machine(made: &Manifest) -> Vec<(String, String)> {
    let row = |name: &str, value: String| (name.to_owned(), value);
    vec![
        row("program", format!("foldline {}, numerics {}", made.program_version, made.numerics)),
        row("machine", format!("{} ({}), {} threads", made.host, made.cpu, made.threads)),
        row("kernel", made.kernel.clone()),
    ]
}
