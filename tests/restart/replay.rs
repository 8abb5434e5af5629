//! Stages run again from the states before them: the same bits, or what differs, how much and where.

use foldline::history::{States, Verdict, replay_stage, verdict};
use foldline::journal::ITERATE_TOPIC;
use foldline::pipeline::Stages;
use foldline::scene::Stage;

use crate::program::{SMALL, Sandbox, Straight, scene};

fn with_whole_run() -> (Sandbox, &'static Straight) {
    let (place, whole) = (Sandbox::new(), Straight::small());
    place.write("run.mcap", &whole.bytes);
    (place, whole)
}

/// State and report of every stage, with the stages in any order, so that nothing is carried from one to the next.
#[test]
fn every_stage_comes_out_again() {
    let log = Straight::small().log();
    let mut stages = Stages::new(scene(SMALL));
    for index in (0..log.entries().len()).rev() {
        let replayed = replay_stage(&mut States::of(&log), index, &mut stages, &mut |_, _| {}).unwrap();
        assert_eq!(verdict(&replayed.comparison), Verdict::BitIdentical, "stage {index}");
        // Residuals of solves that found nothing are not numbers and not equal to themselves.
        let reports = [&replayed.report, &log.entries()[index].record.report];
        assert_eq!(format!("{:?}", reports[0]), format!("{:?}", reports[1]), "stage {index}");
    }
}

#[test]
fn a_whole_log_from_scratch_on_one_thread_and_on_two() {
    let (place, whole) = with_whole_run();
    for threads in [1, 2] {
        let said = place.foldline(&format!("replay run.mcap --from-scratch --threads {threads}")).ends(0);
        assert_eq!(said.out.lines().filter(|line| line.ends_with("bit-identical")).count(), whole.stages);
    }
    assert_eq!(place.read("run.mcap"), whole.bytes);
}

#[test]
fn a_step_or_a_stage_of_it() {
    let (place, whole) = with_whole_run();
    let log = whole.log();
    let of_step = |step| log.entries().iter().filter(move |entry| entry.record.report.step == step).count();
    for step in [1, 3, 6, 9, 11] {
        let said = place.foldline(&format!("replay run.mcap --step {step}")).ends(0);
        assert_eq!(said.out.lines().count(), of_step(step), "{}", said.out);
    }
    let said = place.foldline("replay run.mcap --step 3 --stage re-equilibrate").ends(0);
    assert!(said.out.lines().all(|line| line.contains("step 3 re-equilibrate")), "{}", said.out);
    place.foldline("replay run.mcap --step 13").ends(2).says(&["no load step 13; it has 1 to 11"]);
    place.foldline("replay run.mcap --step 1 --stage refine-knots").ends(2).says(&["no refine-knots", "solve"]);
    place.foldline("replay run.mcap --step 1 --stage sovle").ends(2).says(&["the stages are solve,"]);
    place.foldline("replay run.mcap").ends(2);
}

/// The three verdicts and their exit codes.
#[test]
fn other_settings() {
    let (place, _) = with_whole_run();
    let replay = |rest: &str| place.foldline(&format!("replay run.mcap {rest}"));
    replay("--step 4 --set solver.max_iterations=200").ends(0).says(&["bit-identical"]);
    // Another iteration moves the numbers by what the tolerance leaves.
    let said = replay("--step 3 --stage re-equilibrate --set solver.tolerance=1e-9").ends(3);
    said.says(&["within tolerance:", "agrees to", "bits"]);
    let said = replay("--step 4 --set solver.max_iterations=2").ends(4);
    said.says(&["2 iterations: different: a solve that reached 8 against a solve that found no equilibrium"]);
    replay("--step 4 --stage solve --set load.increment_deg=1").ends(4).says(&["different: "]);
    // The worst of several is the exit code.
    let said = replay("--from-scratch --set solver.max_iterations=12").ends(4);
    assert!(said.out.contains("bit-identical") && said.out.contains("different"), "{}", said.out);
    replay("--step 4 --set solver.max_iteration=2").ends(2).says(&["solver.max_iterations"]);
    replay("--step 4 --set solver.max_iterations=many").ends(2).says(&["many"]);
}

/// Every iterate of the step that snaps, as rows that agree with each other, with the report, and between both files.
#[test]
fn a_trace_of_the_snap() {
    let (place, whole) = with_whole_run();
    let log = whole.log();
    let jump = log.entries().iter().position(|entry| entry.record.report.jumped).unwrap();
    let report = &log.entries()[jump].record.report;
    let step = report.step;
    let said = place.foldline(&format!("replay run.mcap --step {step} --stage solve --trace snap")).ends(0);
    let csv = String::from_utf8(place.read("snap.csv")).unwrap();
    let mut lines = csv.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let all: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert!(all.iter().all(|row| row.len() == head.len()), "{csv}");
    said.says(&[&format!("{} iterates: snap.mcap, snap.csv", all.len())]);
    // Solves of the same step that were rejected come before the one that jumped.
    let rows: Vec<Vec<&str>> = all.iter().filter(|row| row[0] == jump.to_string()).cloned().collect();
    assert!(!rows.is_empty());
    let column = |name: &str| -> Vec<f64> {
        let at = head.iter().position(|other| *other == name).unwrap_or_else(|| panic!("no {name} in {head:?}"));
        rows.iter().map(|row| row[at].parse().unwrap()).collect()
    };
    assert!(column("step").iter().all(|value| *value == step as f64));
    let iteration = column("iteration");
    assert_eq!(iteration.last(), Some(&(report.iterations as f64)));
    assert!(iteration.windows(2).all(|pair| pair[1] >= pair[0]));
    let (residual, relative, energy) = (column("residual_n"), column("relative_residual"), column("energy_n_mm"));
    assert_eq!(*relative.last().unwrap(), report.residual);
    assert!(residual[residual.len() - 1] < 1e-6 * residual[0]);
    // The energy of the model is a quarter of the shell's, and falls through the snap.
    assert!((4.0 * energy[energy.len() - 1] / report.strain_energy_n_mm - 1.0).abs() < 1e-9);
    assert!(energy[energy.len() - 1] < energy[0]);
    let (pivots, shift) = (column("negative_pivots"), column("shift_n_per_mm"));
    assert!(pivots.iter().any(|count| *count > 0.0), "the way through a snap is unstable");
    assert!(pivots.iter().zip(&shift).all(|(count, shift)| (*count > 0.0) == (*shift > 0.0)), "{csv}");
    assert!(column("step_length").iter().all(|length| (0.0..=1.0).contains(length)), "{csv}");
    assert!(column("worst_x_mm").iter().all(|x| (0.0..=150.0).contains(x)), "{csv}");

    let mcap = place.read("snap.mcap");
    let messages: Vec<mcap::Message> = mcap::MessageStream::new(&mcap).unwrap().map(Result::unwrap).collect();
    assert_eq!(messages.len(), all.len());
    let of_jump = messages.iter().skip(all.len() - rows.len());
    for (row, message) in of_jump.enumerate() {
        assert_eq!(message.channel.topic, ITERATE_TOPIC);
        let value: serde_json::Value = serde_json::from_slice(&message.data).unwrap();
        assert_eq!(value["residual_n"].as_f64(), Some(residual[row]));
        assert_eq!(value["negative_pivots"].as_f64(), Some(pivots[row]));
        assert_eq!(value["stage"], Stage::Solve.name());
    }
}

/// A stage that fails when it is run again came out differently, and leaves its trace.
#[test]
fn a_trace_of_a_failure() {
    let (place, _) = with_whole_run();
    let replay = "replay run.mcap --step 3 --stage re-equilibrate --set solver.max_iterations=1 --trace failed";
    place.foldline(replay).ends(4).says(&["step 3 re-equilibrate: different: it fails now:"]);
    assert!(String::from_utf8(place.read("failed.csv")).unwrap().lines().count() > 1);
}
