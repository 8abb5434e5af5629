//! `foldline resume`: continues a log from its last good stage.

use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::{EXIT_CODES, Failure};
use super::log_file::{ReadLog, scene_of};
use super::output::{eprint, path_in_line, print};
use super::probe_table::{json_lines, new_probes, probe_table};
use super::progress::ProgressStyle;
use super::session::{RunOptions, drive, watch_signals};
use super::settings::Settings;
use super::terminal::output_columns;
use crate::history::{basis, plan, read_probes, restored_scene};
use crate::journal::{Completeness, Entry, Log, Manifest, ReadError, Resume, ResumeError, Resumed, stages_in_words};
use crate::pipeline::{Run, Stages};
use crate::record::{Parameter, Record};
use crate::scene::{Scene, SyncPolicy};
use crate::study::Summary;
use crate::units::count;

/// Continue a log from its last good stage, as if it had never stopped
#[derive(Args, Debug)]
#[command(after_help = EXIT_CODES)]
pub(super) struct Arguments {
    /// Log to continue (MCAP)
    log: PathBuf,
    /// Stop after the first step at or beyond this rotation of each end, in degrees, or this load factor
    #[arg(long, value_name = "AT", value_parser = super::session::positive, allow_negative_numbers = true)]
    until: Option<f64>,
    /// Threads; the result is the same on any number of them [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Show no progress, only the summary
    #[arg(short, long)]
    quiet: bool,
    /// Print a JSON object for each stage to standard output, and nothing else
    #[arg(long)]
    json: bool,
}

impl Arguments {
    /// Continues with the scene that is in the log.
    pub(super) fn run(self) -> Result<(), Failure> {
        let old = OldLog::open(&self.log)?;
        let mut scene = scene_of(old.claim.log(), &self.log)?;
        scene.output.sync = Settings::read()?.sync.unwrap_or(scene.output.sync);
        if let Some(until) = self.until.filter(|until| *until > scene.load.target()) {
            return Err(Failure::UntilBeyondScene { until, scene: Box::new(scene) });
        }
        let options = RunOptions {
            log: self.log,
            threads: self.threads.map(usize::from),
            until: self.until,
            style: ProgressStyle::of(self.quiet, self.json),
        };
        let last = old.claim.log().manifests().last();
        let (file, text) = last.map_or_else(Default::default, |m| (m.scene_file.clone(), m.scene_text.clone()));
        let manifest = Manifest::here(Path::new(&file), &text, options.use_threads()?);
        go_on(old, scene, manifest, &options)
    }
}

/// A log that this process alone may write.
pub(super) struct OldLog {
    claim: Resume,
}

impl OldLog {
    pub(super) fn open(path: &Path) -> Result<Self, Failure> {
        Ok(Self { claim: Resume::open(path).map_err(|error| refused(path, error))? })
    }

    /// The same; `None` where the file has not even a header, as a power cut may leave it.
    pub(super) fn open_unless_empty(path: &Path) -> Result<Option<Self>, Failure> {
        match Resume::open(path) {
            Ok(claim) => Ok(Some(Self { claim })),
            Err(ResumeError::Read { source: ReadError::TooShort { .. }, .. }) => Ok(None),
            Err(error) => Err(refused(path, error)),
        }
    }
}

fn refused(path: &Path, error: ResumeError) -> Failure {
    match error {
        ResumeError::NoLog { source, .. } => Failure::Read { path: path.to_path_buf(), source },
        error => Failure::Resume { log: path.to_path_buf(), source: Box::new(error) },
    }
}

/// Continues a log as far as its stages are kept for `scene`.
///
/// Of a long log only the end is read, which is enough where the scene is the same.
pub(super) fn go_on(old: OldLog, scene: Scene, manifest: Manifest, options: &RunOptions) -> Result<(), Failure> {
    let raised = watch_signals()?;
    let path = &options.log;
    let unusable = |source: Box<dyn std::error::Error + Send + Sync>| Failure::Resume { log: path.clone(), source };
    let same_scene = scene_of(old.claim.log(), path).is_ok_and(|was| was.differences(&scene).is_empty());
    let claim = if same_scene { old.claim } else { old.claim.whole().map_err(|source| unusable(Box::new(source)))? };
    let log = claim.log();
    let (was, restored) = scene_before(log, path, &scene)?;
    if restored.is_none()
        && let Some(stages) = stages_without(log, &scene)
    {
        return put_back(claim, &stages, &manifest, scene.output.sync, options);
    }
    let plan = plan(log, &was, &scene).map_err(|source| unusable(Box::new(source)))??;
    if plan.keep <= log.first() && log.first() > 0 {
        // The state to continue from lies before the end that was read.
        let claim = claim.whole().map_err(|source| unusable(Box::new(source)))?;
        return go_on(OldLog { claim }, scene, manifest, options);
    }
    // What is lost or changed is reported however quiet the run is.
    let lost = ReadLog::warnings_of(log).into_iter().chain(restored).chain(plan.changes);
    let mut findings = other_numerics(log, &manifest);
    if options.is_shown() {
        eprint(&found(log, plan.keep));
    }
    lost.for_each(|line| eprint(&line));
    let mut stages = Stages::new(scene.clone());
    if !same_scene {
        // What a run of it from the start would refuse is refused.
        stages.start()?;
    }
    let basis = basis(log, plan.keep, &mut stages).map_err(|source| unusable(Box::new(source)))?;
    let (first, all) = (log.first(), log.commits());
    let kept = log.entries().iter().take(plan.keep.saturating_sub(first));
    let mut before: Vec<Record> = kept.map(|entry| entry.record.clone()).collect();
    let new_probes = new_probes(&was, &scene);
    if !new_probes.is_empty() {
        read_probes(log, &mut stages, &mut before).map_err(|source| unusable(Box::new(source)))?;
        show_probes(&new_probes, &before, options)?;
    }
    let run = Run::new(stages, basis.state, basis.commit);
    let reached = run.state().parameter;
    let shown = Parameter::of(&scene).shown(reached);
    let until = options.until;
    let next = run.next_stage().filter(|_| until.is_none_or(|until| reached < until));
    match next {
        Some(stage) => findings.push(format!("continues from {shown} with {stage}")),
        None => findings.push(format!("nothing to do: the log has reached {shown}")),
    }
    if options.is_shown() {
        findings.iter().for_each(|line| eprint(line));
    }
    let finished = log.completeness() == Completeness::Finished && plan.keep == all;
    // One that lost its summary is closed again.
    if next.is_none() && finished && log.has_summary() && !log.last_manifest_is_lost() {
        return match first {
            0 => options.sum_up(&Summary::new(&scene, &before)),
            first => options.end_of_long(first, all),
        };
    }
    let resumed =
        claim.start_after(plan.keep, &manifest, scene.output.sync).map_err(|source| unusable(Box::new(source)))?;
    say_dropped(&resumed);
    let records = drive(run, &scene, resumed.writer, options, &raised)?;
    match first {
        0 => options.sum_up(&Summary::new(&scene, &[before, records].concat())),
        first => options.end_of_long(first, plan.keep + records.len()),
    }
}

/// The scene that a log was last continued with, and a message where it is lost and `scene` takes its place.
fn scene_before(log: &Log, path: &Path, scene: &Scene) -> Result<(Scene, Option<String>), Failure> {
    match scene_of(log, path) {
        Err(lost @ (Failure::SceneLost { .. } | Failure::NoScene { .. })) => {
            let said = "the log has lost its last scene; this one decides the same states and takes its place";
            Ok((restored_scene(log, &Stages::new(scene.clone())).ok_or(lost)?, Some(said.to_string())))
        }
        was => Ok((was?, None)),
    }
}

/// Shows what probes that a log has not read on its equilibria.
fn show_probes(names: &[String], before: &[Record], options: &RunOptions) -> Result<(), Failure> {
    let head = "new probes on the equilibria of the log, which itself keeps the ones that it has";
    match options.style {
        ProgressStyle::Json => print(&json_lines(before)),
        _ => print(&format!("{head}\n{}", probe_table(names, before, output_columns()))),
    }
}

/// The stages that were run with `scene` under a manifest that is lost, where the log lacks it; that of its last stages it has.
fn stages_without(log: &Log, scene: &Scene) -> Option<String> {
    let hash = scene.hash();
    let lost = log.missed_manifests().flat_map(|lost| log.stages_without_scene(lost));
    let stages: Vec<&Entry> = lost.filter(|entry| entry.record.commit.scene_hash == hash).collect();
    stages_in_words(&stages)
}

/// Puts the scene of lost stretches back into the log, which continues with that of its last stages as before.
fn put_back(
    claim: Resume,
    stages: &str,
    manifest: &Manifest,
    sync: SyncPolicy,
    options: &RunOptions,
) -> Result<(), Failure> {
    let path = &options.log;
    let finished = claim.log().completeness() == Completeness::Finished;
    ReadLog::warnings_of(claim.log()).iter().for_each(|line| eprint(line));
    let resumed = claim
        .put_back(manifest, sync)
        .map_err(|source| Failure::Resume { log: path.clone(), source: Box::new(source) })?;
    say_dropped(&resumed);
    let closed = if finished { resumed.writer.finish() } else { resumed.writer.close() };
    closed.map_err(|source| Failure::WrongLog { log: path.clone(), source: Box::new(source) })?;
    eprint(&format!(
        "put back: the scene of {stages}, which this is. No stage was run; `foldline resume` continues with that of the last"
    ));
    Ok(())
}

fn say_dropped(resumed: &Resumed) {
    if let Some(dropped) = &resumed.dropped {
        eprint(&format!("what was dropped is kept in {}", path_in_line(dropped)));
    }
}

/// What a log holds and what of it is used.
fn found(log: &Log, keep: usize) -> String {
    let all = count(log.commits(), "stage");
    match log.commits() {
        0 => "the log holds no stage".to_string(),
        commits if keep == commits && log.missed_manifests().next().is_some() => {
            format!("the log holds {all}, and has lost a manifest")
        }
        commits if keep == commits => format!("the log holds {all}, all good"),
        _ => format!("the log holds {all}, all good; the first {keep} are kept"),
    }
}

/// Another kernel, revision or program may round differently: it is allowed, reported, and recorded in the log.
fn other_numerics(log: &Log, manifest: &Manifest) -> Vec<String> {
    let Some(last) = log.manifests().last() else { return Vec::new() };
    let otherwise = manifest
        .rounds_otherwise(last)
        .map(|what| format!("{what}: stages from here on may differ in their last bits"));
    let [was, is] = [last, manifest].map(|manifest| &manifest.program_version);
    let program = (was != is).then(|| format!("written by foldline {was}, continued with foldline {is}"));
    otherwise.into_iter().chain(program).chain(other_machine(last, manifest)).collect()
}

/// Another machine, which rounds alike where the kernel is of one kind.
fn other_machine(last: &Manifest, manifest: &Manifest) -> Option<String> {
    (!last.same_machine(manifest)).then(|| {
        let feature = |list: &[String]| list.join(" ");
        format!(
            "another machine: written on {} ({} {}), continues on {} ({} {}); the log records it",
            last.host,
            last.cpu,
            feature(&last.cpu_features),
            manifest.host,
            manifest.cpu,
            feature(&manifest.cpu_features)
        )
    })
}
