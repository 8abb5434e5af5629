//! Sweeps: what is done is done once, whatever kills the program, and however many of them work in one folder.

use std::collections::BTreeMap;
use std::time::Duration;

use foldline::journal::{Completeness, Log};
use serde_json::Value;

use crate::program::Sandbox;

const SWEEP: &str = r#"
title = "small"
scene = "small.toml"
settings = ["load.rotation_deg=14"]
outputs = ["peak_moment_n_mm", "snap_before", "fold_moment_n_mm", "last.strain_energy_n_mm"]

[[axis]]
key = "geometry.radius_mm"
values = [9, 10, 11]

[[axis]]
key = "material.thickness_mm"
values = [0.1, 0.12]
"#;

const COMMAND: &str = "sweep run sweep.toml --folder f --tasks 2";

fn place() -> Sandbox {
    let place = Sandbox::new();
    place.write("sweep.toml", SWEEP);
    place
}

/// The table of a sweep without what it cost.
fn table(place: &Sandbox) -> Vec<Value> {
    let text = place.foldline("sweep status f --json").ends(0).out;
    let costless = |line: &str| {
        let mut row: Value = serde_json::from_str(line).unwrap();
        row.as_object_mut().unwrap().remove("wall_s");
        row
    };
    text.lines().map(costless).collect()
}

fn logs(place: &Sandbox) -> BTreeMap<String, Vec<u8>> {
    let Ok(files) = std::fs::read_dir(place.file("f/logs")) else { return BTreeMap::new() };
    let names = files.map(|file| file.unwrap().file_name().into_string().unwrap());
    let logs = names.filter(|name| name.ends_with(".mcap"));
    logs.map(|name| (name.clone(), place.read(&format!("f/logs/{name}")))).collect()
}

fn is_finished(bytes: &[u8]) -> bool {
    Log::from_bytes(bytes.to_vec()).is_ok_and(|log| log.completeness() == Completeness::Finished)
}

#[test]
fn a_killed_sweep_gives_the_same_table_and_runs_nothing_twice_to_its_end() {
    let straight = place();
    straight.foldline(COMMAND).ends(0);
    let expected = table(&straight);
    assert!(expected.len() == 6 && expected.iter().all(|row| row["ending"] == "done"), "{expected:?}");
    let place = place();
    let (mut killed, mut kept) = (0, BTreeMap::new());
    for delay_ms in [40, 80, 120, 160, 240, 320] {
        let mut child = place.command(COMMAND).spawn().unwrap();
        std::thread::sleep(Duration::from_millis(delay_ms));
        child.kill().unwrap();
        killed += usize::from(!child.wait().unwrap().success());
        let now = logs(&place);
        for (name, bytes) in &kept {
            assert_eq!(now.get(name), Some(bytes), "{name} was finished, and is not touched again");
        }
        kept = now.into_iter().filter(|(_, bytes)| is_finished(bytes)).collect();
    }
    assert!(killed > 0, "no sweep was killed");
    place.foldline("sweep resume f").ends(0);
    assert_eq!(table(&place), expected);
}

/// Two at once share the tasks: what one has in hand the other leaves, and nothing is lost.
#[test]
fn two_sweeps_in_one_folder_do_each_task_once() {
    let straight = place();
    straight.foldline(COMMAND).ends(0);
    let place = place();
    let mut children: Vec<_> = (0..2).map(|_| place.command(COMMAND).spawn().unwrap()).collect();
    for child in &mut children {
        assert!(child.wait().unwrap().success(), "each waits for what the other has in hand");
    }
    assert_eq!(table(&place), table(&straight));
    for (name, bytes) in logs(&place) {
        assert!(is_finished(&bytes), "{name}");
        let stretches = Log::from_bytes(bytes).unwrap().manifests().len();
        assert_eq!(stretches, 1, "{name} was begun once");
        place.foldline(&format!("verify f/logs/{name}")).ends(0);
    }
}

#[test]
fn a_finished_sweep_runs_nothing_again_and_reads_what_is_newly_asked_for() {
    let place = place();
    place.foldline(COMMAND).ends(0);
    let made = logs(&place);
    place.foldline(COMMAND).ends(0).says(&["6 of them on record"]);
    let asked = SWEEP.replace("\"snap_before\"", "\"snap_after\", \"theory_peak_n_mm\"");
    place.write("sweep.toml", &asked);
    place.foldline(COMMAND).ends(0);
    assert_eq!(logs(&place), made, "the logs tell");
    let rows = table(&place);
    assert!(rows.iter().all(|row| row["theory_peak_n_mm"].as_f64().is_some_and(|peak| peak > 100.0)), "{rows:?}");
    // More values: only those are run.
    place.write("sweep.toml", asked.replace("[9, 10, 11]", "[9, 10, 11, 12]"));
    place.foldline(COMMAND).ends(0).says(&["8 tasks, 6 of them on record"]);
    let now = logs(&place);
    assert_eq!((now.len(), made.iter().all(|(name, bytes)| now[name] == *bytes)), (8, true));
}

/// Errors are against the reference that the sweep has now; a reference among the tasks has none.
#[test]
fn another_reference_gives_other_errors() {
    let place = Sandbox::new();
    let small = include_str!("small.toml");
    let (before, _) = small.split_once("[adapt]").unwrap();
    place.write("uniform.toml", format!("{before}[pipeline]\nstages = [\"solve\"]\n"));
    let sweep = |reference: &str| {
        format!(
            "title = \"error\"\nscene = \"uniform.toml\"\nsettings = [\"load.rotation_deg=4\"]\noutputs = [\"error_before\"]\n\
             [reference]\nsettings = [\"mesh.elements={reference}\"]\n[[axis]]\nkey = \"mesh.elements\"\nvalues = [[4, 4], [8, 4]]\n"
        )
    };
    let errors = |reference: &str| -> Vec<Option<f64>> {
        place.write("sweep.toml", sweep(reference));
        place.foldline(COMMAND).ends(0);
        let rows = table(&place).into_iter().filter(|row| row["role"] == "task");
        rows.map(|row| row["error_before"].as_f64()).collect()
    };
    let fine = errors("[16, 4]");
    let own = errors("[8, 4]");
    assert!(fine.iter().all(|error| error.is_some_and(|error| error > 0.0)), "{fine:?}");
    assert!(own[0].is_some_and(|error| Some(error) != fine[0]) && own[1] == Some(0.0), "{own:?}");
    assert_eq!(errors("[16, 4]"), fine);
    place.write("sweep.toml", sweep("[8, 4]\", \"geometry.radius_mm=20"));
    place.foldline(COMMAND).ends(2).says(&["cannot be compared with their [reference]", "radius_mm"]);
}

/// A record of other numerics does not count, one that is no record neither, and a half-written plan is planned again.
#[test]
fn what_is_damaged_is_done_again_from_the_logs() {
    let place = place();
    place.foldline(COMMAND).ends(0);
    let (expected, made) = (table(&place), logs(&place));
    let records: Vec<_> = std::fs::read_dir(place.file("f/rows")).unwrap().map(|entry| entry.unwrap().path()).collect();
    std::fs::write(&records[0], "{").unwrap();
    std::fs::write(&records[1], "").unwrap();
    let text = std::fs::read_to_string(&records[2]).unwrap();
    std::fs::write(&records[2], text.replace("\"numerics\":", "\"numerics\":1")).unwrap();
    let endings = |rows: &[Value]| rows.iter().filter(|row| row["ending"] == "done").count();
    assert_eq!(endings(&table(&place)), 3);
    std::fs::write(place.file("f/sweep.json"), "{").unwrap();
    place.foldline("sweep resume f").ends(2);
    place.foldline(COMMAND).ends(0);
    assert_eq!((table(&place), logs(&place)), (expected.clone(), made));
    let text = std::fs::read_to_string(&records[2]).unwrap();
    std::fs::write(&records[2], text.replacen("peak_moment_n_mm\":", "peak_moment_n_mm\":1", 1)).unwrap();
    assert_eq!(endings(&table(&place)), 5, "a number that was changed by hand");
    // So does a plan with another scene than its own; the sweep's file mends it.
    std::fs::write(place.file("f/scene.toml"), include_str!("small.toml").replace("131000.0", "131001.0")).unwrap();
    place.foldline("sweep resume f").ends(2).says(&["not as it was written", "plans again"]);
    place.foldline(COMMAND).ends(0);
    assert_eq!(table(&place), expected);
}

/// A log holds a finished run to a nearer target: it is no answer for a farther one.
#[test]
fn a_farther_target_is_another_task() {
    let place = place();
    place.write(
        "sweep.toml",
        SWEEP
            .replace("load.rotation_deg=14", "load.increment_deg=2")
            .replace("geometry.radius_mm", "load.rotation_deg")
            .replace("[9, 10, 11]", "[4, 8]"),
    );
    place.foldline(COMMAND).ends(0);
    let energies: Vec<f64> = table(&place).iter().map(|row| row["last.strain_energy_n_mm"].as_f64().unwrap()).collect();
    assert!(energies[2] > 2.0 * energies[0] && logs(&place).len() == 4, "{energies:?}");
}

#[test]
fn an_interrupted_sweep_says_how_it_continues() {
    let place = place();
    let child = place
        .command(COMMAND)
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .unwrap();
    std::thread::sleep(Duration::from_millis(150));
    std::process::Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
    let said = crate::program::Said::new(COMMAND, child.wait_with_output().unwrap());
    // It may have come to its end.
    if said.code != Some(0) {
        said.ends(75).says(&["continue with: foldline sweep resume f"]);
    }
    place.foldline("sweep resume f").ends(0);
    assert!(table(&place).iter().all(|row| row["ending"] == "done"));
}

/// Slurm may send a signal again and again: the stage in hand is done, and the log ends well. What is held by another process is waited for.
#[cfg(unix)]
#[test]
fn a_task_outlives_repeated_signals_and_waits_for_a_log_that_is_held() {
    let place = place();
    place.foldline("sweep run sweep.toml --folder f --slurm --dry-run").ends(0);
    let command = "sweep task f 1";
    let mut child = place.command(command).spawn().unwrap();
    while logs(&place).is_empty() && child.try_wait().unwrap().is_none() {
        std::thread::sleep(Duration::from_millis(1));
    }
    let code = loop {
        if let Some(status) = child.try_wait().unwrap() {
            break status.code();
        }
        std::process::Command::new("kill").args(["-TERM", &child.id().to_string()]).status().unwrap();
    };
    assert!(matches!(code, Some(75 | 0)), "{code:?}");
    let name = logs(&place).into_keys().next().unwrap();
    place.foldline(&format!("verify f/logs/{name}")).ends(0);
    let held = foldline::journal::LogLock::take(&place.file(&format!("f/logs/{name}"))).unwrap();
    let mut child = place.command(command).spawn().unwrap();
    std::thread::sleep(Duration::from_millis(500));
    assert!(code == Some(0) || child.try_wait().unwrap().is_none(), "it waits");
    drop(held);
    assert!(child.wait().unwrap().success());
    place.foldline(command).ends(0);
    assert_eq!(table(&place).iter().filter(|row| row["ending"] == "done").count(), 1);
}
