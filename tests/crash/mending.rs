//! Damaged stages in front of whole ones.

use crate::program::{Sandbox, Straight, assert_ends_with};

/// A byte in the first chunk, and one in others as well, cost no stage: what is lost is run again, and the chain tells that it is
/// the same.
#[test]
fn lost_stages_are_made_again() {
    let whole = Straight::small();
    let entries = whole.log().entries().iter().map(|entry| entry.bytes.clone()).collect::<Vec<_>>();
    for (damaged, made) in [(vec![0], 1), (vec![7], 1), (vec![0, 1, 20], 3)] {
        let place = Sandbox::new();
        let mut bytes = whole.bytes.clone();
        for stage in &damaged {
            // In the commit, at the end of the chunk.
            bytes[entries[*stage].end as usize - 300] ^= 1;
        }
        place.write("run.mcap", &bytes);
        let refused = place.foldline("recover run.mcap -o good.mcap");
        refused
            .ends(if damaged[0] == 0 { 1 } else { 3 })
            .says(&["stages behind what is lost; --remake may run that again"]);
        let said = place.foldline("recover run.mcap -o new.mcap --remake").ends(0);
        said.says(&[&format!("{made} stage"), "made again", &format!("all {} stages", whole.stages)]);
        assert_ends_with(&place.log("new.mcap"), whole.chain, &format!("{damaged:?}"));
        place.foldline("replay new.mcap --from-scratch").ends(0);
    }
}
