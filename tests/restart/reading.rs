//! `inspect`, `verify` and `recover` on logs that are whole, cut, unfinished and damaged.

use foldline::journal::{Completeness, Log};

use crate::program::{Sandbox, Straight, assert_ends_with};

/// What each kind of log gives.
struct Case {
    name: &'static str,
    bytes: Vec<u8>,
    stages: usize,
    inspect: &'static [&'static str],
    verify: i32,
    recover: i32,
}

/// A byte of the commit of a stage, at the end of its chunk.
fn in_commit(log: &Log, stage: usize) -> usize {
    log.entries()[stage].bytes.end as usize - 300
}

fn cases() -> Vec<Case> {
    let whole = Straight::small();
    let (bytes, all) = (&whole.bytes, whole.stages);
    let mut torn = whole.cut_after(21).to_vec();
    torn.extend_from_slice(&bytes[torn.len()..torn.len() + 1000]);
    let flipped = |behind: usize| {
        let mut bytes = bytes.clone();
        bytes[in_commit(&whole.log(), behind)] ^= 1;
        bytes
    };
    let unfinished = &["unfinished; continue with: foldline resume"][..];
    let cut = &["cut off: good up to byte", "unfinished; continue with: foldline resume"][..];
    let damaged = &["damaged at byte", "behind what is lost", "unfinished; continue with"][..];
    vec![
        Case { name: "whole", bytes: bytes.clone(), stages: all, inspect: &["16°"], verify: 0, recover: 0 },
        Case {
            name: "unfinished",
            bytes: whole.cut_after(21).into(),
            stages: 21,
            inspect: unfinished,
            verify: 0,
            recover: 0,
        },
        Case { name: "truncated", bytes: torn, stages: 21, inspect: cut, verify: 1, recover: 3 },
        Case { name: "damaged", bytes: flipped(21), stages: 21, inspect: damaged, verify: 1, recover: 3 },
        Case { name: "damaged at once", bytes: flipped(0), stages: 0, inspect: damaged, verify: 1, recover: 1 },
    ]
}

#[test]
fn what_each_log_gives() {
    let whole = Straight::small();
    for Case { name, bytes, stages, inspect, verify, recover } in cases() {
        let place = Sandbox::new();
        place.write("run.mcap", &bytes);
        let said = place.foldline("inspect run.mcap").ends(0);
        said.says(inspect);
        let json = place.foldline("inspect run.mcap --json").ends(0).out;
        assert_eq!(json.lines().count(), stages, "{name}");
        let verdict = if verify == 0 { "run.mcap: good\n" } else { " wrong\n" };
        let said = place.foldline("verify run.mcap").ends(verify);
        assert!(said.out.ends_with(verdict), "{name}: {}", said.out);
        place.foldline("recover run.mcap -o new.mcap").ends(recover);
        assert_eq!(place.read("run.mcap"), bytes, "{name}: looking at a log changes nothing");
        if recover == 1 {
            assert_eq!(place.logs(), ["run.mcap"], "{name}");
        } else {
            let new = place.log("new.mcap");
            assert_eq!(new.entries().len(), stages, "{name}");
            let kept = if name == "whole" { Completeness::Finished } else { Completeness::Unfinished };
            assert_eq!(new.completeness(), kept, "{name}");
            place.foldline("verify new.mcap").ends(0);
            place.foldline("recover run.mcap -o new.mcap").ends(1).says(&["new.mcap exists and is not overwritten"]);
            place.foldline("resume new.mcap").ends(0);
            assert_ends_with(&place.log("new.mcap"), whole.chain, name);
        }
        // However quiet it is, it says what is lost.
        let manner = ["--quiet", "--json", ""][stages % 3];
        let said = place.foldline(&format!("resume run.mcap {manner}")).ends(0);
        for damage in inspect.iter().filter(|line| line.starts_with("cut off") || line.starts_with("damaged")) {
            assert!(said.err.contains(damage), "{name} {manner}: {}", said.err);
        }
        if said.err.contains("damaged") {
            assert!(said.err.contains("run.mcap.dropped-1"), "{name}: {}", said.err);
        }
        assert_ends_with(&place.log("run.mcap"), whole.chain, name);
    }
}

/// Garbage behind a log, and a manifest that is lost, are wrong, even where every stage is kept.
#[test]
fn whatever_is_wrong_is_an_exit_code() {
    let whole = Straight::small();
    let place = Sandbox::new();
    place.write("run.mcap", &whole.bytes);
    place.foldline("verify run.mcap").ends(0).says(&["run.mcap: good"]);
    place.write("run.mcap", [&whole.bytes[..], b"garbage"].concat());
    place.foldline("verify run.mcap").ends(1).says(&["wrong"]);
    let mut bytes = whole.bytes.clone();
    let at = bytes.windows(10).position(|window| window == b"[geometry]").unwrap();
    bytes[at + 1] ^= 1;
    place.write("run.mcap", &bytes);
    place.foldline("verify run.mcap").ends(1).says(&["manifest", "wrong"]);
}

/// Two places of damage are two findings of `verify`.
#[test]
fn all_findings_are_listed() {
    let whole = Straight::small();
    let place = Sandbox::new();
    let mut bytes = whole.bytes.clone();
    for behind in [12, 30] {
        bytes[in_commit(&whole.log(), behind)] ^= 1;
    }
    place.write("run.mcap", &bytes);
    let said = place.foldline("verify run.mcap").ends(1);
    let errors = said.out.lines().filter(|line| line.starts_with("error ") && line.contains("CRC failed"));
    assert_eq!(errors.count(), 2, "{}", said.out);
    let warnings = said.out.lines().filter(|line| line.starts_with("warning  commit "));
    assert_eq!(warnings.count(), whole.stages - 14, "{}", said.out);
}

#[test]
fn what_is_no_log() {
    let place = Sandbox::new();
    for command in ["verify none.mcap", "inspect none.mcap", "resume none.mcap", "replay none.mcap --step 1"] {
        place.foldline(command).ends(2).says(&["cannot read none.mcap", "No such file"]);
    }
    // For `recover` 1 is the code of a log of which nothing can be kept.
    place.foldline("recover none.mcap -o new.mcap").ends(1).says(&["none.mcap"]);
    for command in ["verify small.toml", "inspect small.toml", "recover small.toml -o new.mcap", "resume small.toml"] {
        place.foldline(command).ends(1).says(&["this is not a log"]);
    }
    assert_eq!(place.logs(), Vec::<String>::new());
}
