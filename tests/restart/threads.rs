//! The chain of hashes is the same on any number of threads.

use foldline::state::Hash;

use crate::support::{run, scene};

fn chain_on(threads: usize) -> Hash {
    let mut quarter = scene("baseline-quarter.toml");
    quarter.load.set_target(12.0);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
    let stages = pool.install(|| run(quarter));
    assert!(stages.iter().any(|(_, record)| record.report.jumped), "the run goes through the snap");
    stages.last().unwrap().1.commit.chain_hash
}

#[test]
fn one_and_two_threads_twice_each() {
    let first = chain_on(1);
    for threads in [2, 1, 2, 5] {
        assert_eq!(chain_on(threads), first, "{threads} threads");
    }
}
