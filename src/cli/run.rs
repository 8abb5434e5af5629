//! `foldline run`: a scene from its start to its end.

use std::path::{Path, PathBuf};

use clap::Args;

use super::failure::Failure;
use super::output::{print, say};
use super::progress::Manner;
use super::wiring::{self, RunOptions};
use crate::scene::Scene;
use crate::study::Summary;
use crate::units::rounded;

/// Run a scene, and log every stage
#[derive(Args, Debug)]
pub(super) struct Arguments {
    /// Scene file (TOML); `foldline help scene` describes its keys
    scene: PathBuf,
    /// Log to write (MCAP) [default: checkpoints/<SCENE>.mcap]
    #[arg(short, long, value_name = "LOG")]
    output: Option<PathBuf>,
    /// Threads; the result is the same on any number of them [default: one for each core]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Stop at this rotation of each end, in degrees; `resume` goes on from there
    #[arg(long, value_name = "DEG", value_parser = positive, allow_negative_numbers = true)]
    until: Option<f64>,
    /// Show no progress, only the summary
    #[arg(short, long, conflicts_with = "json")]
    quiet: bool,
    /// Print a JSON object for each stage to standard output, and nothing else
    #[arg(long)]
    json: bool,
}

/// A run that has been checked and can start.
pub(super) struct Job {
    scene: Scene,
    options: RunOptions,
}

impl Arguments {
    /// Checks everything that can be checked before the run.
    pub(super) fn prepare(self) -> Result<Job, Failure> {
        let scene = wiring::read_scene(&self.scene)?;
        if let Some(until_deg) = self.until.filter(|until| *until > scene.load.rotation_deg) {
            return Err(Failure::UntilBeyondScene { until_deg, scene: Box::new(scene) });
        }
        let options = RunOptions {
            log: self.output.unwrap_or_else(|| default_log(&self.scene)),
            threads: self.threads.map(usize::from),
            until_deg: self.until,
            manner: Manner::of(self.quiet, self.json),
        };
        Ok(Job { scene, options })
    }
}

impl Job {
    /// Runs, and sums up.
    pub(super) fn run(self) -> Result<(), Failure> {
        let Job { scene, options } = self;
        let shown = matches!(options.manner, Manner::Live | Manner::Lines);
        if shown {
            let to = options.until_deg.unwrap_or(scene.load.rotation_deg);
            say(&format!("to {}° → {}", rounded(to), options.log.display()));
        }
        let records = wiring::run(&scene, &options)?;
        if options.manner != Manner::Json {
            print(&Summary::new(&scene, &records).to_string())?;
        }
        if shown {
            say(&format!("every stage: foldline inspect {}", options.log.display()));
        }
        Ok(())
    }
}

/// `checkpoints/<name of the scene>.mcap`.
fn default_log(scene: &Path) -> PathBuf {
    let name = scene.file_stem().unwrap_or(scene.as_os_str());
    let mut log = Path::new("checkpoints").join(name);
    log.as_mut_os_string().push(".mcap");
    log
}

/// A rotation that somebody could mean.
fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        Ok(_) => Err("a rotation above 0 degrees is wanted".to_string()),
        Err(_) => Err("a number of degrees is wanted, such as 12.5".to_string()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logs_are_named_after_scenes() {
        assert_eq!(default_log(Path::new("pipelines/a.b.toml")), Path::new("checkpoints/a.b.mcap"));
        assert_eq!(default_log(Path::new("plain")), Path::new("checkpoints/plain.mcap"));
    }

    #[test]
    fn rotations_are_positive_numbers() {
        assert_eq!(positive("12.5"), Ok(12.5));
        for wrong in ["0", "-1", "inf", "nan", "", "ten"] {
            assert!(positive(wrong).is_err(), "{wrong}");
        }
    }
}
