//! Where two runs part.

use crate::history::bisection::IndexBisection;
use crate::history::compare::{Comparison, compare};
use crate::history::states::{RemakeError, States};
use crate::journal::{AskedLog, LongLogError};
use crate::record::Commit;

/// The first stage at which two runs differ, and how its states compare.
#[derive(Clone, Debug)]
pub struct Divergence {
    /// Ordinal of the stage.
    pub index: usize,
    /// Number of stages that were compared to find it.
    pub looks: usize,
    /// How the two states differ.
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
/// Where a state is not available.
pub fn find_divergence(a: &AskedLog, b: &AskedLog) -> Result<Option<Divergence>, RemakeError> {
    let len = a.commits().min(b.commits());
    if len == 0 {
        return Ok(None);
    }
    let both =
        |index: usize| -> Result<[Commit; 2], LongLogError> { Ok([a.record(index)?.commit, b.record(index)?.commit]) };
    let [x, y] = both(0)?;
    let same_scene = x.scene_hash == y.scene_hash;
    let mut search = IndexBisection::new(len);
    let mut looks = 0;
    while let Some(index) = search.next() {
        let [x, y] = both(index)?;
        let parted =
            if same_scene { x.chain_hash != y.chain_hash } else { (x.stage, x.state_hash) != (y.stage, y.state_hash) };
        search = search.narrowed(index, parted);
        looks += 1;
    }
    let index = search.answer();
    if index == len {
        return Ok(None);
    }
    let [x, y] = [a.part(index..index + 1)?, b.part(index..index + 1)?];
    let comparison = compare(&States::of(&x).at(index)?, &States::of(&y).at(index)?);
    Ok(Some(Divergence { index, looks, comparison }))
}
