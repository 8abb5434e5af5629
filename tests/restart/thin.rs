//! A log without some of its states: the chain and the reports stay, and what was dropped is made again from what was kept.

use foldline::journal::{Completeness, StateError};

use crate::program::{Sandbox, Straight, assert_ends_with};

#[test]
fn every_stage_stays_and_some_states() {
    let whole = Straight::small();
    let place = Sandbox::new();
    place.write("run.mcap", &whole.bytes);
    place.foldline("thin run.mcap -o thin.mcap --keep every=3,5").ends(0).says(&["all", "stages"]);
    assert_eq!(place.read("run.mcap"), whole.bytes);
    let (log, thin) = (whole.log(), place.log("thin.mcap"));
    assert_ends_with(&thin, whole.chain, "thinned");
    assert!(thin.file_len() < log.file_len() * 7 / 10, "{} of {}", thin.file_len(), log.file_len());
    let step = |index: usize| log.entries()[index].record.report.step;
    let all = log.entries().len();
    let mut kept = 0;
    for index in 0..all {
        assert_eq!(thin.entries()[index].record, log.entries()[index].record);
        let last = index + 1 == all;
        let ends_step = last || step(index + 1) > step(index);
        if last || (ends_step && (step(index) % 3 == 0 || step(index) == 5)) {
            assert_eq!(thin.state(index).unwrap(), log.state(index).unwrap());
            kept += 1;
        } else {
            assert!(matches!(thin.state(index), Err(StateError::NotKept { .. })), "{index}");
        }
    }
    assert!(kept > 3 && kept < all / 2);
    place.foldline("verify thin.mcap").ends(0).says(&[&format!("{kept} of {all} stages have their state")]);
    place.foldline("inspect thin.mcap").ends(0).says(&["thinned (every=3,5)", "stages with their state: "]);
    place.foldline("thin run.mcap -o thin.mcap --keep 1").ends(1).says(&["thin.mcap exists and is not overwritten"]);
    place.foldline("thin run.mcap -o other.mcap --keep 7..3").ends(2).says(&["has no load step in it"]);

    // What was dropped comes out again, bit for bit, from the last state before it.
    for step in [1, 2, 4, 7] {
        let said = place.foldline(&format!("replay thin.mcap --step {step}")).ends(0);
        assert!(said.out.contains("bit-identical") && !said.out.contains("different"), "{}", said.out);
    }
    // A copy of it is a copy of it, and a thinned log can be thinned again.
    place.foldline("recover thin.mcap -o copy.mcap").ends(0);
    assert_eq!(place.read("copy.mcap"), place.read("thin.mcap"));
    place.foldline("thin thin.mcap -o thinner.mcap --keep 3").ends(0);
    // What it has no state of any more can be made again, and is not said to be nothing.
    let said = place.foldline("thin thin.mcap -o again.mcap --keep 2,5,every=2,400").ends(0);
    let again = said.says(&[
        "--keep 2: the log was thinned before, and no longer has the state of 1 load step, the first of them 2",
        "--keep every=2: the log was thinned before, and no longer has the state of 4 load steps",
        "`foldline stability thin.mcap --step 2`",
        "--keep 400 keeps nothing",
    ]);
    assert!(!again.err.contains("--keep 5"), "{}", again.err);
    place.foldline("stability thin.mcap --step 2").ends(0);
    assert_ends_with(&place.log("thinner.mcap"), whole.chain, "thinned twice");
}

#[test]
fn a_thinned_log_goes_on() {
    let whole = Straight::small();
    for stages in [1, 14, 33] {
        let place = Sandbox::new();
        place.write("run.mcap", whole.cut_after(stages));
        place.foldline("thin run.mcap -o thin.mcap --keep every=1000").ends(0).says(&["1 of them with their states"]);
        assert_eq!(place.log("thin.mcap").completeness(), Completeness::Unfinished);
        place.foldline("resume thin.mcap").ends(0);
        assert_ends_with(&place.log("thin.mcap"), whole.chain, &format!("thinned after {stages} stages"));
    }
}

/// What is lost is told from what was dropped, and a damaged log is not thinned.
#[test]
fn damage_is_not_thinned_away() {
    let whole = Straight::small();
    let place = Sandbox::new();
    let mut bytes = whole.bytes.clone();
    bytes[whole.cut_after(20).len() + 300] ^= 1;
    place.write("run.mcap", bytes);
    place.foldline("thin run.mcap -o thin.mcap --keep 1").ends(1).says(&["it is not whole", "foldline recover"]);
    assert_eq!(place.logs(), ["run.mcap"]);
}

/// States that were dropped are made again wherever one is asked for, with what came before them run as it was.
#[test]
fn what_was_dropped_is_made_again_when_it_is_asked_for() {
    let whole = Straight::small();
    let place = Sandbox::new();
    place.write("run.mcap", &whole.bytes);
    let said = place.foldline("thin run.mcap -o thin.mcap --keep 2,400,500..600").ends(0);
    said.says(&["--keep 400 keeps nothing", "--keep 500..600 keeps nothing", "of the log go from 1 to"]);
    for command in [
        "stability LOG",
        "stability LOG --step 4",
        "bisect LOG --snap --tolerance 0.01",
        "replay LOG --step 4 --set solver.tolerance=1e-9",
    ] {
        let [whole, thin] = ["run.mcap", "thin.mcap"].map(|log| place.foldline(&command.replace("LOG", log)));
        assert_eq!((thin.code, &thin.out), (whole.code, &whole.out), "{command}: {}", thin.err);
    }
    for log in ["run", "thin"] {
        place.foldline(&format!("plot {log}.mcap --step 4 -o {log}")).ends(0);
    }
    assert_eq!(place.read("run/mesh.vtu"), place.read("thin/mesh.vtu"));
    place.write("other.toml", crate::program::small_with(&[("[solver]", "[solver]\ntolerance = 1e-9")]));
    place.foldline("run other.toml -o other.mcap --quiet").ends(0);
    place.foldline("thin other.mcap -o thin-other.mcap --keep 2").ends(0);
    let [a, b] =
        ["run.mcap other.mcap", "thin.mcap thin-other.mcap"].map(|logs| place.foldline(&format!("bisect {logs}")));
    assert_eq!(a.out, b.out);

    let probed = format!("{}\n[[probe]]\nname = \"energy\"\nkind = \"energy\"\n", crate::program::SMALL);
    place.write("probed.toml", probed);
    let read = |log: &str| place.foldline(&format!("run probed.toml -o {log} --resume --quiet")).ends(0).out;
    assert_eq!(read("thin.mcap"), read("run.mcap"));
}
