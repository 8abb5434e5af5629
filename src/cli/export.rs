//! `foldline export`: states of a log in the formats of other programs.

use std::path::{Path, PathBuf};

use clap::Args;
use clap::builder::TypedValueParser;

use super::asked::{Asked, ordinal};
use super::export_choice::{Format, StepRange, Steps, Target, Times, chosen_fields, list_of_fields};
use super::failure::{EXIT_CODES, Failure};
use super::log_file::scene_at;
use super::output::{file_name, path_in_line, print, print_as_it_is, refuse_what_is_there, write_files};
use super::pictured::named;
use crate::history::States;
use crate::record::{Parameter, Record};
use crate::scene::Scene;
use crate::state::State;
use crate::units::rounded;
use crate::view::{
    Instant, ShellsOfState, StatesOnMesh, ViewerFile, WholeShell, csv, json, knot_lines_vtu, npz, pvd, step, stl,
    surface_vtu, time_steps,
};

/// Write the states of a log for other programs: ParaView, tables, numpy, CAD
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES)]
pub(super) struct Arguments {
    /// Log to read (MCAP)
    log: PathBuf,
    /// What to write
    #[arg(long, value_name = "FORMAT", required_unless_present = "list_fields")]
    to: Option<Format>,
    /// Folder for the files, or one file where this ends in .FORMAT [default: the log's name without .mcap]
    #[arg(short, long, value_name = "DIR|FILE", value_parser = file_name())]
    output: Option<PathBuf>,
    /// Every N-th load step, and the last [default: all for vtu and npz, the last one for the rest]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u64).range(1..))]
    every: Option<u64>,
    /// These load steps, such as 3,7,20-30
    #[arg(long, value_name = "LIST", value_delimiter = ',', conflicts_with = "every")]
    steps: Vec<StepRange>,
    /// These fields [default: all]; for mcap the one that colours the mesh, such as bending_moment.11 [default: the larger
    /// bending strain]
    #[arg(long, value_name = "LIST", value_delimiter = ',')]
    fields: Vec<String>,
    /// Points along each side of an element, for csv, json and stl
    #[arg(long, value_name = "N", default_value_t = 4, value_parser = points())]
    points: usize,
    /// For mcap: when viewers show what a stage did [default: steps]
    #[arg(long, value_name = "TIMES")]
    times: Option<Times>,
    /// One shell of a structure of several, by its name; exports for viewers (mcap) have all shells [default: all]
    #[arg(long, value_name = "NAME")]
    shell: Option<String>,
    /// Only print which fields there are, with units and meanings
    #[arg(long)]
    list_fields: bool,
}

impl Arguments {
    /// Writes the files, and names them.
    pub(super) fn run(self) -> Result<(), Failure> {
        let Self { log, to, output, every, steps, fields, points, times, shell, list_fields } = self;
        let asked = Asked::open(&log)?;
        let (Some(format), false) = (to, list_fields) else { return print(&list_of_fields(&asked.scene)) };
        let shell = chosen_shell(&asked.scene, &log, shell)?;
        if format != Format::Mcap {
            if times.is_some() {
                return Err(Failure::TimesOfNoViewer);
            }
            chosen_fields(&asked.scene, &fields)?;
        } else if shell.is_some() {
            return Err(Failure::ShellForViewers);
        }
        let steps = match every {
            Some(n) => Steps::Every(n),
            None if steps.is_empty() => Steps::Unsaid,
            None => Steps::Chosen(steps),
        };
        let ends = steps.of(asked.ends()?, format, &log)?;
        let target = Target::of(output, &log, format);
        if let (Target::File(file), true) = (&target, ends.len() > 1 && !format.holds_many_steps()) {
            return Err(Failure::StepsInOneFile { file: file.clone(), steps: ends.len() });
        }
        let export = Export { asked, log: &log, format, fields: &fields, points, shell, target };
        match format {
            Format::Npz => export.write_arrays(&ends),
            Format::Mcap => export.write_for_viewers(&ends, times.unwrap_or(Times::Steps)),
            _ => export.write_states(&ends),
        }
    }
}

/// What is written, and where.
struct Export<'a> {
    asked: Asked,
    log: &'a Path,
    format: Format,
    fields: &'a [String],
    points: usize,
    /// The shell that is written, by its place in the scene; `None` for all.
    shell: Option<usize>,
    target: Target,
}

/// Finds the shell that is to be written, where it is chosen by name.
fn chosen_shell(scene: &Scene, log: &Path, name: Option<String>) -> Result<Option<usize>, Failure> {
    let Some(name) = name else { return Ok(None) };
    let known: Vec<String> = scene.shells.iter().map(|shell| shell.name.clone()).collect();
    match known.iter().position(|known| *known == name) {
        None => Err(Failure::NoSuchShell { log: log.to_path_buf(), name, known }),
        found => Ok(found),
    }
}

impl Export<'_> {
    /// Writes the states of these stages, a file or two each.
    fn write_states(&self, ends: &[Record]) -> Result<(), Failure> {
        // Nothing is computed for a place where something is in the way.
        let files = ends.iter().flat_map(|end| self.files_of(end)).chain(self.series_files());
        refuse_what_is_there(&files.collect::<Vec<_>>())?;
        self.each_state(ends, |scene, state, record| {
            let shells = ShellsOfState::new(scene, state);
            let contents = self.contents(&self.chosen(&shells), scene, &Instant::of(record))?;
            write(&self.files_of(record).into_iter().zip(contents).collect::<Vec<_>>())
        })?;
        let times = time_steps(&ends.iter().map(Instant::of).collect::<Vec<_>>());
        let series = self.series_files().into_iter().enumerate().map(|(kind, path)| {
            let name = |end| self.files_of(end)[kind].file_name().unwrap_or_default().to_string_lossy().into_owned();
            let names: Vec<String> = ends.iter().map(name).collect();
            (path, pvd(names.iter().map(|name| &name[..]).zip(times.iter().copied())).into_bytes())
        });
        write(&series.collect::<Vec<_>>())
    }

    /// Writes the states of these stages as arrays: a file for all that follow each other on one mesh.
    fn write_arrays(&self, ends: &[Record]) -> Result<(), Failure> {
        let mut groups: Vec<StatesOnMesh> = Vec::new();
        self.each_state(ends, |scene, state, record| {
            let shells = ShellsOfState::new(scene, state);
            let shells = self.chosen(&shells);
            let state = (Instant::of(record), shells.iter().map(|shell| shell.displacement().collect()).collect());
            let mesh = StatesOnMesh::mesh_of(&shells);
            match groups.last_mut().filter(|group| group.mesh == mesh) {
                Some(group) => group.states.push(state),
                None => groups.push(StatesOnMesh { mesh, states: vec![state] }),
            }
            Ok(())
        })?;
        if let (Target::File(file), true) = (&self.target, groups.len() > 1) {
            return Err(Failure::MeshesInOneFile { file: file.clone(), meshes: groups.len() });
        }
        let file = |group: &StatesOnMesh| {
            let [first, last] =
                [group.states.first(), group.states.last()].map(|state| state.map_or(0, |(at, _)| at.step));
            let path = self.target.of_steps(first, last, self.format);
            let bytes = npz(group).map_err(|source| Failure::Write { path: path.clone(), source: source.into() })?;
            Ok((path, bytes))
        };
        write(&groups.iter().map(file).collect::<Result<Vec<_>, Failure>>()?)
    }

    /// Writes what viewers of MCAP are shown: a picture of these stages, the reports and lines of all.
    fn write_for_viewers(&self, ends: &[Record], times: Times) -> Result<(), Failure> {
        let path = self.target.of_step(ends.last().map_or(0, |end| end.report.step), self.format);
        refuse_what_is_there(std::slice::from_ref(&path))?;
        let shown = match self.fields {
            [] => None,
            [name] => Some(named(&self.asked.scene, name)?),
            fields => return Err(Failure::FieldsForViewers { fields: fields.len() }),
        };
        let unusable = |source| Failure::WrongLog { log: self.log.to_path_buf(), source };
        let mut file = ViewerFile::new(times.into(), shown).map_err(|source| unusable(Box::new(source)))?;
        self.each_state(ends, |scene, state, _| Ok(file.reach_over(scene, state)?))?;
        let records = self.asked.records()?;
        let (mut stages, scene) = (records.iter().peekable(), &self.asked.scene);
        self.each_state(ends, |scene, state, end| {
            let mut time_ns = 0;
            while let Some(stage) = stages.next_if(|stage| ordinal(stage) <= ordinal(end)) {
                time_ns = file.add_stage(scene, stage).map_err(|source| unusable(Box::new(source)))?;
            }
            file.add_picture(scene, state, time_ns).map_err(|source| unusable(Box::new(source)))
        })?;
        for stage in stages {
            file.add_stage(scene, stage).map_err(|source| unusable(Box::new(source)))?;
        }
        let bytes = file.finish().map_err(|source| unusable(Box::new(source)))?;
        write(&[(path, bytes)])
    }

    /// The shells that are written; one alone needs no name.
    fn chosen<'s>(&self, shells: &'s ShellsOfState) -> Vec<WholeShell<'s>> {
        match self.shell {
            None => shells.whole(),
            Some(shell) => shells.whole().into_iter().skip(shell).take(1).map(WholeShell::without_name).collect(),
        }
    }

    /// The contents of the files of a state.
    fn contents(&self, shells: &[WholeShell], scene: &Scene, instant: &Instant) -> Result<Vec<Vec<u8>>, Failure> {
        let mut fields = chosen_fields(scene, self.fields)?;
        fields.retain(|field| shells.iter().any(|shell| shell.has(field)));
        let deformed = || shells.iter().map(|shell| (shell.deformed(), shell.name()));
        let title = || {
            let name = self.log.file_stem().unwrap_or_default().to_string_lossy();
            let at = match instant.driven_by {
                Parameter::Rotation => format!("{} degrees", rounded(instant.parameter)),
                Parameter::LoadFactor => instant.driven_by.shown_short(instant.parameter),
            };
            format!("{name}, load step {}, {at}", instant.step)
        };
        Ok(match self.format {
            Format::Vtu => {
                [surface_vtu(shells, &fields, instant), knot_lines_vtu(shells, instant)].map(String::into_bytes).into()
            }
            Format::Csv => vec![csv(shells, &fields, self.points).into_bytes()],
            Format::Json => vec![json(shells, &fields, self.points, instant).into_bytes()],
            Format::Stl => {
                vec![stl(&deformed().map(|(surface, _)| surface).collect::<Vec<_>>(), self.points, &title())]
            }
            Format::Step => vec![step(&deformed().collect::<Vec<_>>(), &title()).into_bytes()],
            // Their states are not written one by one.
            Format::Npz | Format::Mcap => vec![],
        })
    }

    /// The files of the state of a stage.
    fn files_of(&self, end: &Record) -> Vec<PathBuf> {
        let step = end.report.step;
        match self.format {
            Format::Vtu => [&self.target, &self.target.of_knot_lines()].map(|to| to.of_step(step, self.format)).into(),
            _ => vec![self.target.of_step(step, self.format)],
        }
    }

    /// The files that make one series of the files of all steps.
    fn series_files(&self) -> Vec<PathBuf> {
        match self.format {
            Format::Vtu => [&self.target, &self.target.of_knot_lines()].map(Target::of_series).into(),
            _ => vec![],
        }
    }

    /// Shows the state that each of some stages made to `see`, with the scene and the record of the stage.
    fn each_state(
        &self,
        ends: &[Record],
        mut see: impl FnMut(&Scene, &State, &Record) -> Result<(), Failure>,
    ) -> Result<(), Failure> {
        let stages: Vec<usize> = ends.iter().map(ordinal).collect();
        let mut ends = ends.iter();
        for part in self.asked.log.parts(&stages) {
            let (log, indices) = part.map_err(self.asked.changed())?;
            let mut states = States::of(&log);
            for (index, end) in indices.iter().zip(ends.by_ref()) {
                let unusable = |source| Failure::WrongLog { log: self.log.to_path_buf(), source: Box::new(source) };
                let state = states.at(*index).map_err(unusable)?;
                see(&scene_at(&log, self.log, *index, &[])?, &state, end)?;
            }
        }
        Ok(())
    }
}

/// A number of points that has both ends of a side.
fn points() -> impl TypedValueParser<Value = usize> {
    clap::value_parser!(u64).range(2..=100).map(|points| points as usize)
}

/// Writes files, and names them.
fn write(files: &[(PathBuf, Vec<u8>)]) -> Result<(), Failure> {
    write_files(files)?;
    print_as_it_is(&files.iter().map(|(path, _)| format!("{}\n", path_in_line(path))).collect::<String>())
}
