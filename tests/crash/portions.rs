//! Long logs, which no command that goes through them from front to back holds whole; what it says is what it would say having
//! read them whole.

use std::fs;

use foldline::journal::{Completeness, Log};

use crate::bounds::measured;
use crate::long::{SCENE, write_long_of};
use crate::program::Sandbox;

const COMMITS: u64 = 50_000;

/// Runs a command that takes less memory than the log is long: one that held the log, or its states, would not.
#[track_caller]
fn in_less_than(length: u64, place: &Sandbox, arguments: &str) {
    let (code, peak, said) = measured(place, arguments);
    println!("{arguments}: {} MiB for a log of {} MiB", peak >> 20, length >> 20);
    assert_eq!(code, Some(0), "{arguments}: {said}");
    assert!(peak < length, "{arguments} takes {peak} bytes for {length}");
}

#[test]
fn no_command_holds_a_long_log() {
    let place = Sandbox::new();
    let path = place.file("long.mcap");
    // With states as long as reports, as those of small meshes are.
    write_long_of(&SCENE.replace("[4, 2]", "[8, 4]"), &path, COMMITS);
    let length = fs::metadata(&path).unwrap().len();
    for command in [
        "inspect long.mcap",
        "plot long.mcap -o pictures",
        "verify long.mcap",
        "recover long.mcap -o recovered.mcap",
        "thin long.mcap -o thin.mcap --keep 1..10",
    ] {
        in_less_than(length, &place, command);
    }
    let bytes = place.read("long.mcap");
    assert!(place.read("recovered.mcap").starts_with(&bytes));
    let table = |log: &str| place.foldline(&format!("inspect {log}")).ends(0).out.replace(log, "the log");
    assert!(table("long.mcap") == table("recovered.mcap"));

    place.foldline("verify thin.mcap").ends(0).says(&["thinned (1..10): 11 of 50000 stages have their state"]);
    place.foldline("inspect thin.mcap").ends(0).says(&["stages with their state: 0–9, 49999"]);
    // No run made these states, and none makes them again.
    let again = "the state was thinned out; made again from stage 10 on, stage 10 comes out otherwise";
    place.foldline("plot thin.mcap -o none --step 40000").ends(1).says(&[again]);
}

/// Damage in the middle, that costs commits and that costs none.
#[test]
fn a_long_log_that_is_damaged() {
    let place = Sandbox::new();
    let path = place.file("long.mcap");
    write_long_of(SCENE, &path, COMMITS / 2);
    let good = place.read("long.mcap");
    let half = COMMITS as usize / 4;
    let chunk = Log::from_bytes(good.clone()).unwrap().entries()[half].bytes.clone();
    for (at, kept, code) in [(chunk.start + 1000, half, 3), (chunk.end + 11, half * 2, 0)] {
        let mut bytes = good.clone();
        bytes[at as usize] ^= 1;
        place.write("long.mcap", bytes);
        let whole = Log::read(&path).unwrap();
        assert_eq!(whole.commits(), kept);
        if let Completeness::Damaged { at, dropped, later_commits } = whole.completeness() {
            assert_eq!(later_commits as usize, half - 1);
            let said =
                [format!("damaged at byte {at}: {dropped} bytes beyond not used, with {later_commits} whole stages")];
            place.foldline("inspect long.mcap").ends(0).says(&said.each_ref().map(String::as_str));
        }
        place.foldline("thin long.mcap -o thin.mcap --keep every=10").says(&["it is not whole"]);
        let name = format!("recovered{code}.mcap");
        place.foldline(&format!("recover long.mcap -o {name}")).ends(code).says(&[&format!("{kept} stages")]);
        let recovered = Log::read(&place.file(&name)).unwrap();
        assert!(recovered.commits() == kept && recovered.loss().is_none());
        assert_eq!(recovered.last_commit(), whole.last_commit());
    }
}
