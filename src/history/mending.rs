//! A damaged log whose lost stages are run again, so that the whole ones behind them are no longer lost.

use std::sync::Arc;

use crate::energy::TermSource;
use crate::history::logged_scene::logged_scene;
use crate::history::states::States;
use crate::journal::Log;
use crate::pipeline::{Run, Stages};
use crate::record::MemorySink;

/// Runs the lost stages of a log again where whole ones follow on them, and returns the log with them and their number;
/// the hashes of what follows show that they are the same. `None` where there are none, or where the run had other
/// terms of the caller's own.
pub fn mended(log: &Log, own: &[Arc<dyn TermSource>]) -> Option<(Log, usize)> {
    let mut mended: Option<(Log, usize)> = None;
    loop {
        let (log, made) = mended.as_ref().map_or((log, 0), |(log, made)| (log, *made));
        let Some((more, count)) = with_lost_stages(log, own) else { return mended };
        mended = Some((more, made + count));
    }
}

/// The log with the stages between its good part and the next whole one.
fn with_lost_stages(log: &Log, own: &[Arc<dyn TermSource>]) -> Option<(Log, usize)> {
    let next = log.later_commits().iter().map(|commit| commit.ordinal).min()?;
    let lost = (next as usize).checked_sub(log.commits()).filter(|lost| *lost > 0)?;
    let (stages, state) = match log.commits().checked_sub(1) {
        Some(last) => {
            let scene = logged_scene(log, last, &[], own).ok()?;
            (Stages::with_terms(scene, own.to_vec()), States::of(log).with_terms(own).at(last).ok()?)
        }
        None => {
            let mut stages = Stages::with_terms(log.manifests().last()?.scene(&[]).ok()?, own.to_vec());
            let start = stages.start().ok()?;
            (stages, start)
        }
    };
    let mut run = Run::new(stages, state, log.last_commit().copied());
    let mut made = MemorySink::default();
    while made.stages.len() < lost {
        run.advance(&mut made).ok()??;
    }
    Some((log.with_stages(&made.stages).ok()??, lost))
}
