//! A run cut anywhere and resumed ends with the same chain of hashes as one that was never cut.

use foldline::scene::Stage;

use crate::program::{
    SMALL, STRUCTURE, Sandbox, Straight, assert_ends_with, assert_resumes_from_every_cut, small_syncing,
};

/// The small run with a policy of syncing, cut after every stage in turn.
fn every_cut(policy: &str, threads_before: usize, threads_after: usize) {
    let whole = Straight::run(&small_syncing(policy), threads_before);
    assert_eq!(whole.chain, Straight::small().chain, "syncing and threads change no state");
    assert_resumes_from_every_cut(&whole, policy, threads_before, threads_after);
}

#[test]
fn every_cut_from_one_thread_to_two_syncing_each_second() {
    every_cut("each-second", 1, 2);
}

#[test]
fn every_cut_from_two_threads_to_one_syncing_each_stage() {
    every_cut("each-stage", 2, 1);
}

#[test]
fn every_cut_from_one_thread_to_one_syncing_at_the_end() {
    every_cut("at-end", 1, 1);
}

/// How far increments have grown is part of a state.
#[test]
fn every_cut_of_a_run_whose_increments_grow() {
    let growing = SMALL.replace("increment_deg = 2.0", "increment_deg = 0.5\nlongest_increment_deg = 4.0");
    let whole = Straight::run(&growing, 1);
    let place = Sandbox::new();
    place.write("whole.mcap", &whole.bytes);
    let log = place.log("whole.mcap");
    let rotations: Vec<f64> = log.entries().iter().map(|entry| entry.record.report.parameter).collect();
    let longest = rotations.windows(2).map(|pair| pair[1] - pair[0]).fold(0.0, f64::max);
    assert!(longest > 1.9, "the longest step is {longest}°");
    assert_resumes_from_every_cut(&whole, "growing", 1, 2);
}

/// The estimate of the error, superfluous knots, meshes that lose some and returns to before a jump are parts of a state.
#[test]
fn every_cut_of_a_run_that_keeps_a_tolerance() {
    let kept = include_str!("tolerance.toml");
    let whole = Straight::run(kept, 1);
    let place = Sandbox::new();
    place.write("whole.mcap", &whole.bytes);
    let log = place.log("whole.mcap");
    let count = |stage| log.entries().iter().filter(|entry| entry.record.report.stage == stage).count();
    println!("{} refined, {} coarsened", count(Stage::RefineKnots), count(Stage::CoarsenKnots));
    assert!(count(Stage::RefineKnots) > 2 && count(Stage::CoarsenKnots) > 0);
    assert!(log.entries().iter().any(|entry| entry.record.report.returned_from().is_some()));
    assert_resumes_from_every_cut(&whole, "tolerance", 1, 2);
}

/// Shells that are joined, glued and hung on springs; one of them refines.
#[test]
fn every_cut_of_a_structure() {
    let whole = Straight::structure();
    assert_eq!(whole.chain, Straight::run(STRUCTURE, 1).chain, "threads change no state");
    assert_resumes_from_every_cut(whole, "structure", 1, 2);
}

/// What a resume says: what it found, what it dropped and why, and what it computes first.
#[test]
fn a_resume_says_what_it_found() {
    let whole = Straight::small();
    let place = Sandbox::new();
    place.write("cut.mcap", whole.cut_after(9));
    place.foldline("resume cut.mcap").ends(0).says(&["the log holds 9 stages, all good", "continues from 6° with"]);

    let mut torn = whole.cut_after(9).to_vec();
    torn.extend_from_slice(&whole.bytes[torn.len()..torn.len() + 700]);
    place.write("torn.mcap", &torn);
    let said = place.foldline("resume torn.mcap").ends(0);
    said.says(&["the log holds 9 stages, all good", "cut off: good up to byte", "continues from 6° with"]);
    assert_ends_with(&place.log("torn.mcap"), whole.chain, "torn");

    let mut flipped = whole.bytes.clone();
    flipped[whole.cut_after(20).len() + 400] ^= 8;
    place.write("flipped.mcap", &flipped);
    let said = place.foldline("resume flipped.mcap").ends(0);
    let later = format!("with {} whole stages behind what is lost", whole.stages - 21);
    said.says(&["the log holds 20 stages", "damaged at byte", &later, "flipped.mcap.dropped-1"]);
    assert_ends_with(&place.log("flipped.mcap"), whole.chain, "flipped");
}

/// A finished log is left as it is.
#[test]
fn resuming_a_finished_log_changes_nothing() {
    let whole = Straight::small();
    let place = Sandbox::new();
    place.write("run.mcap", &whole.bytes);
    place.foldline("resume run.mcap").ends(0).says(&["nothing to do: the log has reached 16°"]);
    place.foldline("run small.toml -o run.mcap --resume").ends(0).says(&["nothing to do: the log has reached 16°"]);
    assert_eq!(place.read("run.mcap"), whole.bytes);
    assert_eq!(place.logs(), ["run.mcap"]);
}

/// Stopped on purpose, twice, the second time in the middle of the way to the snap.
#[test]
fn until_here_and_until_there_is_the_straight_run() {
    let whole = Straight::small();
    let place = Sandbox::new();
    place.foldline("run small.toml -o run.mcap --until 5 --threads 2").ends(0);
    assert_eq!(place.log("run.mcap").entries().last().unwrap().record.report.parameter, 6.0);
    place.foldline("resume run.mcap --until 10.3 --threads 1").ends(0);
    let reached = place.log("run.mcap").entries().last().unwrap().record.report.parameter;
    assert!((10.3..10.5).contains(&reached), "{reached}");
    place.foldline("resume run.mcap --until 10.3").ends(0).says(&["nothing to do"]);
    place.foldline("resume run.mcap --until 17").ends(2).says(&["--until 17 is beyond the 16°"]);
    place.foldline("resume run.mcap").ends(0);
    assert_ends_with(&place.log("run.mcap"), whole.chain, "until twice");
}

/// Programs read a resumed run as they read a run: one JSON object for each stage, and nothing else.
#[test]
fn json_of_a_resume_is_the_stages_that_it_made() {
    let whole = Straight::small();
    let place = Sandbox::new();
    place.write("cut.mcap", whole.cut_after(30));
    let said = place.foldline("resume cut.mcap --json").ends(0);
    assert_eq!(said.err, "");
    let all = place.foldline("inspect cut.mcap --json").ends(0).out;
    let expected: String = all.lines().skip(30).map(|line| format!("{line}\n")).collect();
    assert_eq!(said.out, expected);
    assert_eq!(all.lines().count(), whole.stages);
}

#[test]
fn the_same_scene_again_goes_on_with_its_log() {
    let whole = Straight::small();
    let place = Sandbox::new();
    place.foldline("run small.toml -o run.mcap --resume --until 9").ends(0);
    place.foldline("run small.toml -o run.mcap").ends(2).says(&["run.mcap exists and is not overwritten", "resume"]);
    place.write("small.toml", format!("# another comment\n{SMALL}"));
    place.foldline("run small.toml -o run.mcap --resume").ends(0).says(&["continues from 10° with solve"]);
    assert_ends_with(&place.log("run.mcap"), whole.chain, "run --resume");
}

/// Meshes for viewers go into the log beside the states and change none of them.
#[test]
fn mesh_history_changes_no_hash() {
    let whole = Straight::small();
    let place = Sandbox::new();
    place.write("small.toml", format!("{SMALL}\n[output]\nmesh_history = true\n"));
    place.foldline("run small.toml -o run.mcap").ends(0);
    assert_ends_with(&place.log("run.mcap"), whole.chain, "with viewers' topics");
    let bytes = place.read("run.mcap");
    let messages = mcap::MessageStream::new(&bytes).unwrap().map(Result::unwrap);
    let scenes: Vec<_> =
        messages.filter(|message| message.channel.topic == foldline::view::MESH_HISTORY_TOPIC).collect();
    let equilibria = place.log("run.mcap").entries().iter().filter(|entry| entry.record.report.residual > 0.0).count();
    assert!(scenes.len() > 10 && scenes.len() <= equilibria, "{} of {equilibria}", scenes.len());
    let last: serde_json::Value = serde_json::from_slice(&scenes[scenes.len() - 1].data).unwrap();
    let triangles = &last["entities"][0]["triangles"][0];
    let points = triangles["points"].as_array().unwrap();
    assert_eq!(points.len(), triangles["colors"].as_array().unwrap().len());
    let indices = triangles["indices"].as_array().unwrap();
    assert!(indices.iter().all(|index| (index.as_u64().unwrap() as usize) < points.len()));
    let schema = scenes[0].channel.schema.as_ref().unwrap();
    assert_eq!((schema.name.as_str(), schema.encoding.as_str()), ("foxglove.SceneUpdate", "jsonschema"));
}
