//! `foldline run`: a scene from its start to its end.

use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::{EXIT_CODES, Failure};
use super::old_log;
use super::output::{eprint, file_name, path_in_line};
use super::progress::ProgressStyle;
use super::resume::{self, OldLog};
use super::scene_file::{SceneFile, read_scene};
use super::session::{RunOptions, drive, positive, watch_signals};
use super::settings::{SETTINGS, Settings};
use super::wrapped::wrapped;
use crate::journal::{JournalWriter, Manifest};
use crate::model::{Size, oddities};
use crate::pipeline::{Run, Stages};
use crate::record::Parameter;
use crate::scene::{Quadrature, SyncPolicy};
use crate::study::{Summary, hardly_moved_or_thrown_off};
use crate::units::rounded;

/// Run a scene, and log every stage
#[derive(Args, Debug)]
#[command(after_help = format!("{SETTINGS}\n\n{EXIT_CODES}"))]
pub(super) struct Arguments {
    /// Scene file (TOML), or the name of one of `foldline scenes`; `foldline help scene` describes its keys
    scene: PathBuf,
    /// Log to write (MCAP) [default: checkpoints/SCENE.mcap]
    #[arg(short, long, value_name = "LOG", value_parser = file_name())]
    output: Option<PathBuf>,
    /// Threads; the result is the same on any number of them [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Stop after the first step at or beyond this rotation of each end, in degrees, or this load factor; `resume` continues
    /// from there
    #[arg(long, value_name = "AT", value_parser = positive, allow_negative_numbers = true)]
    until: Option<f64>,
    /// Continue the log if there is one, as far as its stages are valid for this scene
    #[arg(long)]
    resume: bool,
    /// Start again where there is a log, which is kept under another name (LOG.1.mcap)
    #[arg(long, conflicts_with = "resume")]
    force: bool,
    /// Lay a setting over the scene, such as load.rotation_deg=20; may be repeated. The log holds the scene as it is run
    #[arg(long, value_name = "KEY=VALUE")]
    set: Vec<String>,
    /// Show no progress, only the summary
    #[arg(short, long)]
    quiet: bool,
    /// Print a JSON object for each stage to standard output, and nothing else
    #[arg(long)]
    json: bool,
}

/// A run that has been checked and can start.
pub(super) struct Job {
    scene: SceneFile,
    options: RunOptions,
    resume: bool,
    force: bool,
    /// Settings that were laid over the scene.
    set: Vec<String>,
    sync: Option<SyncPolicy>,
}

impl Arguments {
    /// Checks everything that can be checked before the run.
    pub(super) fn prepare(self) -> Result<Job, Failure> {
        let settings = Settings::read()?;
        let scene = read_scene(&self.scene, &self.set)?;
        if let Some(until) = self.until.filter(|until| *until > scene.scene.load.target()) {
            return Err(Failure::UntilBeyondScene { until, scene: Box::new(scene.scene) });
        }
        let options = RunOptions {
            log: self.output.unwrap_or_else(|| default_log(&scene.file, settings.logs.as_deref())),
            threads: self.threads.or(settings.threads).map(usize::from),
            until: self.until,
            style: ProgressStyle::of(self.quiet, self.json),
        };
        Ok(Job { scene, options, resume: self.resume, force: self.force, set: self.set, sync: settings.sync })
    }
}

impl Job {
    /// Runs the scene and prints the summary.
    pub(super) fn run(self) -> Result<(), Failure> {
        let Job { scene: whole, options, resume, force, set, sync } = self;
        let SceneFile { mut scene, text, file, written } = whole;
        scene.output.sync = sync.unwrap_or(scene.output.sync);
        let manifest = Manifest::here(&file, &text, options.use_threads()?);
        manifest.check_size().map_err(|source| Failure::CannotStart { source: Box::new(source) })?;
        let is_there = resume && options.log.exists();
        if is_there {
            if let Some(old) = OldLog::open_unless_empty(&options.log)? {
                return resume::go_on(old, scene, manifest, &options);
            }
            eprint(&format!("{} holds nothing: started again", path_in_line(&options.log)));
        }
        // What is there and no log is refused by whoever creates one.
        let is_in_the_way = !is_there && options.log.exists();
        let in_the_way = is_in_the_way.then(|| old_log::beside(&options.log, &scene, &file, &set)).flatten();
        let is_put_aside = match in_the_way {
            Some(found) if !force => return Err(Failure::LogIsThere { log: options.log, found }),
            found => found.is_some(),
        };
        let mut stages = Stages::new(scene.clone());
        let start = stages.start().map_err(|refusal| written.refused(refusal))?;
        let size = Size::of(&scene)?;
        let mut odd = oddities(&scene, &size);
        odd.extend(hardly_moved_or_thrown_off(&mut stages, &start, &size));
        let remarks = stages.remarks(&start)?;
        let raised = watch_signals()?;
        make_default_folder(&options.log)?;
        if is_put_aside {
            let aside = old_log::put_aside(&options.log)?;
            eprint(&format!("the log that was there is {} now", path_in_line(&aside)));
        }
        let begin = if is_there { JournalWriter::create_over_empty } else { JournalWriter::create };
        let writer = begin(&options.log, &manifest, scene.output.sync)
            .map_err(|source| Failure::CannotStart { source: Box::new(source) })?;
        if options.is_shown() {
            let to = options.until.unwrap_or(scene.load.target());
            let to = match Parameter::of(&scene) {
                Parameter::Rotation => format!("{}°", rounded(to)),
                Parameter::LoadFactor => format!("load factor {}", rounded(to)),
            };
            eprint(&size.to_string());
            eprint(&format!("to {to} → {}", path_in_line(&options.log)));
        }
        // What looks odd is reported however quiet the run is.
        odd.iter().for_each(|odd| eprint(&wrapped("warning: ", odd)));
        remarks.iter().for_each(|remark| eprint(remark));
        if scene.mesh.degree.contains(&2) && scene.mesh.quadrature == Quadrature::Full {
            eprint(
                "warning: degree 2 with full quadrature locks on coarse meshes, and stays too stiff; mesh.quadrature = \"reduced\" helps",
            );
        }
        let records = drive(Run::new(stages, start, None), &scene, writer, &options, &raised)?;
        options.sum_up(&Summary::new(&scene, &records))
    }
}

/// `checkpoints/` is made where it is the default, and a folder that was set for all logs; any other has to be there.
fn make_default_folder(log: &Path) -> Result<(), Failure> {
    match log.parent() {
        Some(folder) if folder == Path::new("checkpoints") => {
            std::fs::create_dir_all(folder).map_err(|source| Failure::Write { path: folder.to_path_buf(), source })
        }
        _ => Ok(()),
    }
}

/// `checkpoints/<name of the scene>.mcap`, or the same in a folder that is set for logs.
fn default_log(scene: &Path, folder: Option<&Path>) -> PathBuf {
    let name = scene.file_stem().unwrap_or(scene.as_os_str());
    let mut log = folder.unwrap_or(Path::new("checkpoints")).join(name);
    log.as_mut_os_string().push(".mcap");
    log
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logs_are_named_after_scenes() {
        assert_eq!(default_log(Path::new("pipelines/a.b.toml"), None), Path::new("checkpoints/a.b.mcap"));
        assert_eq!(default_log(Path::new("plain"), None), Path::new("checkpoints/plain.mcap"));
    }
}
