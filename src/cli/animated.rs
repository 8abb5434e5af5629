//! The mesh of a log over its load steps.

use std::path::Path;

use super::asked::{Ends, ordinal};
use super::failure::Failure;
use super::log_file::read_log;
use super::pictured::{Look, pictured};
use crate::history::States;
use crate::record::Record;
use crate::view::{Picture, PlotError, chosen_frames, mesh_animation};

/// Width of an animation, pixels: as wide as a page, and a third of the bytes of a picture.
const WIDTH: u32 = 900;
/// Frames beyond which an animation is no longer one to look at, nor to keep in memory.
const MOST_FRAMES: usize = 400;

/// Animates every `every`-th load step and the last, or those that show the run.
pub(super) fn animation(log: &Path, every: Option<u64>, look: &Look) -> Result<Vec<u8>, Failure> {
    let read = read_log(log)?.whole(log)?;
    let mut ends = Ends::default();
    read.log.entries().iter().for_each(|entry| ends.take(&entry.record));
    let chosen = chosen(&ends, &read.records(), every)?;
    let mut states = States::of(&read.log);
    let mut frames = Vec::new();
    for end in ends.records.iter().filter(|end| chosen.contains(&end.report.step)) {
        let wrong = |source| Failure::WrongLog { log: log.to_path_buf(), source: Box::new(source) };
        let state = states.at(ordinal(end)).map_err(wrong)?;
        let (samples, picture) = pictured(log, &read.scene, &state, &end.report, look)?;
        frames.push((samples, Picture { width: WIDTH, ..picture }));
    }
    Ok(mesh_animation(&frames)?)
}

/// The load steps that are shown.
fn chosen(ends: &Ends, records: &[Record], every: Option<u64>) -> Result<Vec<u64>, Failure> {
    let steps: Vec<u64> = ends.records.iter().map(|end| end.report.step).collect();
    let last = *steps.last().ok_or(PlotError::NoEquilibrium)?;
    let chosen: Vec<u64> = match every {
        Some(n) => steps.into_iter().filter(|step| step % n == 0 || *step == last).collect(),
        None => {
            let jumped = |step: u64| records.iter().any(|record| record.report.step == step && record.report.jumped);
            chosen_frames(&steps, |step| jumped(step) || jumped(step + 1))
        }
    };
    match chosen.len() {
        frames if frames > MOST_FRAMES => {
            let enough = every.unwrap_or(1).saturating_mul(frames.div_ceil(MOST_FRAMES) as u64);
            Err(Failure::TooManyFrames { frames, most: MOST_FRAMES, enough })
        }
        _ => Ok(chosen),
    }
}
