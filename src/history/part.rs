//! Where two runs part.

use crate::history::bisection::IndexBisection;
use crate::history::compare::{Comparison, compare};
use crate::history::states::{RemakeError, States};
use crate::journal::Log;

/// The first stage at which two runs differ.
#[derive(Clone, Debug)]
pub struct Parting {
    /// Ordinal of the stage.
    pub index: usize,
    /// Stages looked at.
    pub looks: usize,
    /// The two states.
    pub comparison: Comparison,
}

/// Finds the first stage whose states differ, by their hashes; `None` where the shorter run is the beginning of the
/// longer.
///
/// The chain hash binds a stage to all before it, so runs of one scene are bisected by it. Chains of different scenes
/// differ from the first stage on; those runs are bisected by the state hash, on the premise that runs that have
/// parted do not meet again.
///
/// # Errors
/// Where a state cannot be had.
pub fn find_parting(a: &Log, b: &Log) -> Result<Option<Parting>, RemakeError> {
    let len = a.entries().len().min(b.entries().len());
    let commit = |log: &Log, index: usize| log.entries()[index].record.commit;
    let same_scene = len > 0 && commit(a, 0).scene_hash == commit(b, 0).scene_hash;
    let parted = |index: usize| {
        let (x, y) = (commit(a, index), commit(b, index));
        if same_scene { x.chain_hash != y.chain_hash } else { (x.stage, x.state_hash) != (y.stage, y.state_hash) }
    };
    let mut search = IndexBisection::new(len);
    let mut looks = 0;
    while let Some(index) = search.next() {
        search = search.told(index, parted(index));
        looks += 1;
    }
    let index = search.answer();
    if index == len {
        return Ok(None);
    }
    let comparison = compare(&States::of(a).at(index)?, &States::of(b).at(index)?);
    Ok(Some(Parting { index, looks, comparison }))
}
