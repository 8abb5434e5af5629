//! The command line: one file per subcommand, nothing but arguments and printing.
//!
//! Everything that can be wrong with the arguments and the scene is found before anything starts. What a program would
//! read goes to standard output, what a person would watch to standard error.
//!
//! | file | what |
//! |---|---|
//! | `new` | a scene to begin with |
//! | `check` | what a scene is, and what a run of it takes |
//! | `run`, `resume` | a run from its start, and from where it stopped |
//! | `old_log`, `settings` | a log that is in the way of a run; what is set once for all commands |
//! | `inspect`, `plot`, `replay`, `bisect`, `stability`, `verify` | questions to a log |
//! | `plotted`, `pictured`, `animated` | logs, as curves are drawn of them; a state as a picture; load steps as an animation |
//! | `report`, `compare` | runs as one page, and next to each other in a table |
//! | `export`, `export_choice` | states in the formats of other programs; which of them, and of what |
//! | `recover`, `thin` | a log written again |
//! | `bench`, `converge`, `study`, `speed_ups`, `extremes` | suites, and how fast and exact runs are |
//! | `sweep`, `sweep_progress`, `sweep_table` | tables over designs: what is done, as it is shown; their rows |
//! | `sweep_slurm`, `sweep_task`, `slurm` | a sweep as jobs of Slurm; what a job does; Slurm's programs, called |
//! | `calibrate` | the threshold at which a scene's mesh keeps an error |
//! | `help`, `man`, `completions` | help on subcommands and topics, as manual pages, and for a shell |
//! | `scenes`, `shipped` | the scenes that come with the program |
//! | `scene_file`, `log_file`, `asked` | what is read: scenes, logs, some stages of a log |
//! | `session` | threads, signals, the log of a run under way |
//! | `probe_table` | what probes measure on a log |
//! | `progress`, `load_step`, `stage_table`, `stage_csv`, `json_line` | stages, as they are shown |
//! | `mesh_table` | the meshes of a run |
//! | `trace` | iterates of replayed stages |
//! | `wrapped`, `columns` | sentences in lines that fit; tables that do |
//! | `terminal`, `output`, `failure` | what is printed to; streams and files; what can stop a command |

mod animated;
mod asked;
mod bench;
mod bisect;
mod calibrate;
mod check;
mod columns;
mod compare;
mod completions;
mod converge;
mod export;
mod export_choice;
mod extremes;
mod failure;
mod help;
mod inspect;
mod json_line;
mod load_step;
mod log_file;
mod man;
mod mesh_table;
mod new;
mod old_log;
mod output;
mod pictured;
mod plot;
mod plotted;
mod probe_table;
mod progress;
mod recover;
mod replay;
mod report;
mod resume;
mod run;
mod scene_file;
mod scenes;
mod session;
mod settings;
mod shipped;
mod slurm;
mod speed_ups;
mod stability;
mod stage_csv;
mod stage_table;
mod study;
mod sweep;
mod sweep_progress;
mod sweep_slurm;
mod sweep_table;
mod sweep_task;
mod terminal;
mod thin;
mod trace;
mod verify;
mod wrapped;

use std::process::ExitCode;

use clap::{ColorChoice, CommandFactory, Parser, Subcommand};

use failure::{EXIT_CODES, Failure};

#[doc(hidden)]
pub use extremes::ExtremesTable;
#[doc(hidden)]
pub use json_line::json_line;
#[doc(hidden)]
pub use progress::{ProgressSink, ProgressStyle};
#[doc(hidden)]
pub use stage_csv::stage_csv;
#[doc(hidden)]
pub use stage_table::{stage_table, step_in_full};

/// Thin shells that fold, simulated as a pipeline of restartable stages
#[derive(Parser, Debug)]
#[command(name = "foldline", version, after_help = EXIT_CODES, disable_help_subcommand = true, term_width = terminal::help_columns())]
struct Arguments {
    #[command(subcommand)]
    command: Command,
    /// Colours: on a terminal, unless NO_COLOR is set; or always (as with CLICOLOR_FORCE), or never
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto", hide_possible_values = true)]
    color: ColorChoice,
}

#[derive(Subcommand, Debug)]
enum Command {
    Scenes(scenes::Arguments),
    New(new::Arguments),
    Check(check::Arguments),
    Run(run::Arguments),
    Resume(resume::Arguments),
    Inspect(inspect::Arguments),
    Plot(plot::Arguments),
    Report(report::Arguments),
    Compare(compare::Arguments),
    Export(export::Arguments),
    Replay(replay::Arguments),
    Bisect(bisect::Arguments),
    Stability(stability::Arguments),
    Verify(verify::Arguments),
    Recover(recover::Arguments),
    Thin(thin::Arguments),
    Bench(bench::Arguments),
    Converge(converge::Arguments),
    Calibrate(calibrate::Arguments),
    Study(study::Arguments),
    Sweep(sweep::Arguments),
    #[command(alias = "stress")]
    Extremes(extremes::Arguments),
    Completions(completions::Arguments),
    Man(man::Arguments),
    Help(help::Arguments),
}

impl Command {
    /// The exit code of a command that did what it was asked to.
    fn run(self) -> Result<u8, Failure> {
        session::outlive_file_limits()?;
        // Commands that compute without an argument for the number of threads.
        if matches!(
            self,
            Command::Plot(_)
                | Command::Report(_)
                | Command::Compare(_)
                | Command::Export(_)
                | Command::Bisect(_)
                | Command::Stability(_)
                | Command::Recover(_)
        ) {
            session::use_threads(None)?;
        }
        match self {
            Command::Scenes(arguments) => arguments.run().map(|()| 0),
            Command::New(arguments) => arguments.run().map(|()| 0),
            Command::Check(arguments) => arguments.run().map(|()| 0),
            Command::Run(arguments) => arguments.prepare()?.run().map(|()| 0),
            Command::Resume(arguments) => arguments.run().map(|()| 0),
            Command::Inspect(arguments) => arguments.run().map(|()| 0),
            Command::Plot(arguments) => arguments.run().map(|()| 0),
            Command::Report(arguments) => arguments.run().map(|()| 0),
            Command::Compare(arguments) => arguments.run().map(|()| 0),
            Command::Export(arguments) => arguments.run().map(|()| 0),
            Command::Replay(arguments) => arguments.run(),
            Command::Bisect(arguments) => arguments.run(),
            Command::Stability(arguments) => arguments.run().map(|()| 0),
            Command::Verify(arguments) => arguments.run(),
            Command::Recover(arguments) => arguments.run(),
            Command::Thin(arguments) => arguments.run().map(|()| 0),
            Command::Converge(arguments) => arguments.run().map(|()| 0),
            Command::Calibrate(arguments) => arguments.run().map(|()| 0),
            Command::Study(arguments) => arguments.run().map(|()| 0),
            Command::Sweep(arguments) => arguments.run().map(|()| 0),
            Command::Bench(arguments) => arguments.run().map(|()| 0),
            Command::Extremes(arguments) => arguments.run(),
            Command::Completions(arguments) => arguments.run(Arguments::command()).map(|()| 0),
            Command::Man(arguments) => arguments.run(Arguments::command()).map(|()| 0),
            Command::Help(arguments) => arguments.run(Arguments::command()).map(|()| 0),
        }
    }
}

/// Runs the command that the arguments of this process name, prints its result or error, and returns the exit code.
pub fn main() -> ExitCode {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => {
            terminal::use_colours(terminal::colours_asked_for(std::env::args_os()));
            // Help and version too; nobody has to read them to the end.
            let _ = error.print();
            return ExitCode::from(u8::try_from(error.exit_code()).unwrap_or(2));
        }
    };
    terminal::use_colours(arguments.color);
    match arguments.command.run() {
        Ok(code) => ExitCode::from(code),
        Err(failure) => {
            output::say(&failure);
            ExitCode::from(failure.exit_code())
        }
    }
}
