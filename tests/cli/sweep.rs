//! `foldline sweep`: rows, what becomes of tasks that fail, tables, and what it refuses.

use serde_json::Value;

use crate::program::Sandbox;

fn rows(text: &str) -> Vec<Value> {
    text.lines().map(|line| serde_json::from_str(line).unwrap()).collect()
}

/// A sweep over the small scene to 2°, with these axes.
fn place(axes: &str) -> Sandbox {
    let place = Sandbox::new();
    let head = "title = \"t\"\nscene = \"small.toml\"\nsettings = [\"load.rotation_deg=2\"]\n";
    place.write("s.toml", format!("{head}{axes}"));
    place
}

#[test]
fn a_scene_that_is_wrong_and_a_run_that_stops_are_rows() {
    // At an arc of 400° there is no section.
    let place = place(
        "outputs = [\"last.moment_n_mm\", \"theory_peak_n_mm\"]\n[[axis]]\nkey = \"geometry.arc_deg\"\nvalues = [110, 400, 20]\n",
    );
    let said = place.foldline("sweep run s.toml").ends(0);
    assert!(said.err.contains("arc_deg"), "{}", said.err);
    let rows = rows(&place.foldline("sweep status s.toml --json").ends(0).out);
    let endings: Vec<&str> = rows.iter().map(|row| row["ending"].as_str().unwrap()).collect();
    assert_eq!(endings, ["done", "refused", "done"]);
    assert!(rows[1]["reason"].as_str().unwrap().contains("400") && rows[1]["last.moment_n_mm"].is_null());
    // So shallow a section has no peak: there is no such number, and a row all the same.
    assert!(rows[2]["theory_peak_n_mm"].is_null() && rows[2]["last.moment_n_mm"].as_f64().unwrap() > 0.0);
    place.foldline("sweep run s.toml").ends(0).says(&["3 of them on record"]);
}

#[test]
fn a_run_that_stops_keeps_its_log_and_its_reason() {
    let place = place(
        "[[axis]]\nkeys = [\"solver.max_iterations\", \"solver.least_increment_deg\", \"solver.snap_tolerance_deg\"]\nvalues = [[50, 0.1, 0.1], [1, 1.9, 2.0]]\n",
    );
    place.foldline("sweep run s.toml").ends(0);
    let found = rows(&place.foldline("sweep status s.toml --json --where ending=failed").ends(0).out);
    let [failed] = &found[..] else { panic!("{found:?}") };
    assert!(failed["reason"].as_str().unwrap().contains("no equilibrium"), "{failed}");
    assert!(place.file("checkpoints/sweeps/s/logs").join(failed["log"].as_str().unwrap()).is_file());
    place.foldline("sweep run s.toml").ends(0).says(&["2 of them on record"]);
    place.foldline("sweep run s.toml --retry").ends(0).says(&["1 of them on record"]);
}

#[test]
fn where_nothing_can_be_run_nothing_is_begun() {
    let place = place("[[axis]]\nkey = \"geometry.radius\"\nvalues = [9, 10]\n");
    place.foldline("sweep run s.toml").ends(2).says(&["not one of its 2 scenes", "radius_mm"]);
    assert!(!place.file("checkpoints").exists());
    place.foldline("sweep status s.toml").ends(2).says(&["has not been begun", "foldline sweep run s.toml"]);
    place.foldline("sweep run nothing.toml").ends(2).says(&["nothing.toml"]);
    place.foldline("sweep resume nothing").ends(2).says(&["nothing"]);
    place.write("s.toml", "title = \"t\"\nscene = \"small.toml\"\noutputs = [\"probe.tip\"]\n[[axis]]\nkey = \"geometry.radius_mm\"\nvalues = [9]\n");
    place.foldline("sweep run s.toml").ends(2).says(&["no [[probe]] of that name"]);
}

#[test]
fn another_sweep_is_not_written_over() {
    let place = place("[[axis]]\nkey = \"geometry.radius_mm\"\nvalues = [9]\n");
    place.foldline("sweep run s.toml --folder f").ends(0);
    place.write(
        "other.toml",
        "title = \"other\"\nscene = \"small.toml\"\n[[axis]]\nkey = \"geometry.radius_mm\"\nvalues = [9]\n",
    );
    place.foldline("sweep run other.toml --folder f").ends(2).says(&["holds the sweep `t` of", "s.toml", "--folder"]);
    std::fs::create_dir(place.file("g")).unwrap();
    place.write("g/scene.toml", "precious");
    place.foldline("sweep run other.toml --folder g").ends(2).says(&["has a `scene.toml` and holds no sweep"]);
    assert_eq!(place.read("g/scene.toml"), b"precious");
    place.foldline("run other.toml").ends(2).says(&["is a sweep over designs", "foldline sweep run other.toml"]);
    place.foldline("new sweeps/roof-snap -o roof.toml").ends(0).says(&["next: foldline sweep run roof.toml"]);
    place.foldline("sweep run roof.toml --slurm --dry-run").ends(0);
}

#[test]
fn rows_are_chosen_and_written() {
    let place = place(
        "outputs = [\"last.moment_n_mm\"]\n[[axis]]\nkey = \"geometry.radius_mm\"\nfrom = 9\nto = 12\ncount = 4\n",
    );
    place.foldline("sweep run s.toml --json").ends(0);
    let all = rows(&place.foldline("sweep status s.toml --json").ends(0).out);
    let moments: Vec<f64> = all.iter().map(|row| row["last.moment_n_mm"].as_f64().unwrap()).collect();
    assert!(moments.is_sorted() && moments.len() == 4, "a larger section is stiffer: {moments:?}");
    let some = rows(&place.foldline("sweep status s.toml --json --where radius_mm>=11").ends(0).out);
    assert_eq!(some, all[2..]);
    place
        .foldline("sweep status s.toml --where radius>3")
        .ends(2)
        .says(&["no column is called `radius`", "geometry.radius_mm"]);
    place.foldline("sweep status s.toml --where radius_mm").ends(2).says(&["a comparison"]);
    place.foldline("sweep status s.toml --csv t.csv").ends(0).says(&["4 rows: 4 done"]);
    let csv = String::from_utf8(place.read("t.csv")).unwrap();
    let lines: Vec<Vec<&str>> = csv.lines().map(|line| line.split(',').collect()).collect();
    assert_eq!(lines[0][..6], ["number", "key", "role", "ending", "geometry.radius_mm", "last.moment_n_mm"]);
    assert_eq!(lines[4][5].parse::<f64>().unwrap(), moments[3]);
    place.foldline("sweep status s.toml --csv t.csv").ends(2).says(&["t.csv exists"]);
    place.foldline("sweep report s.toml -o page.html").ends(0).says(&["page.html"]);
    let page = String::from_utf8(place.read("page.html")).unwrap();
    let (_, rest) = page.split_once("id=\"data\">").unwrap();
    let held: Value = serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap();
    assert_eq!(held["rows"].as_array().unwrap().len(), 4);
    assert!(place.file(held["logs"].as_str().unwrap()).join(all[0]["log"].as_str().unwrap()).is_file());
}

/// A tape spring whose ends turn, a strip along its path under a growing load, meshes against a reference: one engine.
#[test]
fn three_kinds_go_through_one_engine() {
    let turned = place("[[axis]]\nkey = \"geometry.radius_mm\"\nvalues = [9, 10]\n");
    turned.foldline("sweep run s.toml").ends(0).says(&["peak_", "2 rows: 2 done"]);
    let place = Sandbox::new();
    place.write("along.toml", include_str!("../restart/path.toml"));
    place.write("s.toml", "title = \"path\"\nscene = \"along.toml\"\noutputs = [\"last.path_length_mm\", \"limit_parameter\"]\n[[axis]]\nkey = \"material.thickness_mm\"\nvalues = [0.2, 0.25]\n");
    place.foldline("sweep run s.toml --folder path").ends(0);
    for row in rows(&place.foldline("sweep status path --json").ends(0).out) {
        assert!(row["last.path_length_mm"].as_f64().unwrap() > 0.0, "{row}");
    }
    let small = include_str!("../restart/small.toml");
    let (before, behind) = small.split_once("[adapt]").unwrap();
    assert!(behind.contains("[pipeline]"));
    let uniform = format!("{before}[pipeline]\nstages = [\"solve\"]\n");
    place.write("uniform.toml", uniform);
    place.write(
        "r.toml",
        "title = \"error\"\nscene = \"uniform.toml\"\nsettings = [\"load.rotation_deg=4\"]\n\
         outputs = [\"error_before\", \"error_after\"]\n[reference]\nsettings = [\"mesh.elements=[24, 8]\"]\n\
         [[axis]]\nkey = \"mesh.elements\"\nvalues = [[4, 4], [8, 4], [16, 8]]\n",
    );
    place.foldline("sweep run r.toml --folder error").ends(0);
    let rows = rows(&place.foldline("sweep status error --json").ends(0).out);
    let errors: Vec<Option<f64>> = rows.iter().map(|row| row["error_before"].as_f64()).collect();
    let [None, Some(coarse), Some(_), Some(fine)] = errors[..] else { panic!("{errors:?}") };
    assert!(fine < coarse && fine > 0.0 && rows[0]["mesh.elements"] == serde_json::json!([24, 8]), "{errors:?}");
}

#[test]
fn shipped_sweeps_are_planned() {
    let place = Sandbox::new();
    let told = place.foldline("scenes sweeps").ends(0).out;
    for file in std::fs::read_dir(concat!(env!("CARGO_MANIFEST_DIR"), "/pipelines/sweeps")).unwrap() {
        let path = file.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        assert!(told.contains(name), "{told}");
        place.foldline(&format!("sweep run sweeps/{name} --folder {name} --slurm --dry-run")).ends(0);
    }
    for (name, count) in [("fold-moments", 21), ("imperfect-trac-booms", 100)] {
        let tasks = String::from_utf8(place.read(&format!("{name}/tasks.jsonl"))).unwrap();
        assert_eq!((tasks.lines().count(), tasks.matches("refused").count()), (count, 0), "{name}");
    }
}

/// Scripts for Slurm are written where there is none, and hold what is not on record: wrong scenes never need a job.
#[test]
fn a_dry_run_writes_the_batch_scripts() {
    let place = place("[[axis]]\nkey = \"geometry.arc_deg\"\nvalues = [110, 400, 120]\n");
    let command = "sweep run s.toml --folder f --slurm --dry-run";
    let said = place.foldline(&format!(
        "{command} --partition low --time 01:00:00 --memory 500 --per-job 2 --threads 2 --at-most 4 --sbatch=--qos=long"
    ));
    let said = said.ends(0).out;
    let lines: Vec<&str> = said.lines().collect();
    assert!(
        lines.len() == 2
            && lines[0].starts_with("tasks=$(sbatch --parsable /")
            && lines[0].ends_with("f/slurm/1-tasks.sh)"),
        "{said}"
    );
    assert!(lines[1].contains(" --dependency=afterany:$tasks "), "{said}");
    let script = String::from_utf8(place.read("f/slurm/1-tasks.sh")).unwrap();
    for line in [
        "--partition=low",
        "--time=01:00:00",
        "--mem=500M",
        "--array=1-1%4",
        "--cpus-per-task=2",
        "--qos=long",
        "--requeue",
    ] {
        assert!(script.lines().any(|found| found.starts_with("#SBATCH") && found.contains(line)), "{line}: {script}");
    }
    let keys = String::from_utf8(place.read("f/slurm/1-tasks.txt")).unwrap();
    assert_eq!(keys.lines().count(), 2, "the third is refused, and on record");
    // As an element does.
    place.foldline("sweep task f --list f/slurm/1-tasks.txt --from 2 --count 1").ends(0);
    let endings = || -> Vec<Value> {
        rows(&place.foldline("sweep status f --json").ends(0).out).iter().map(|row| row["ending"].clone()).collect()
    };
    assert_eq!(endings(), ["to do", "refused", "done"]);
    place.foldline("sweep collect f").ends(1).says(&["1 task left", "sweep resume f --slurm"]);
    place.foldline("sweep task f --list f/slurm/1-tasks.txt").ends(0);
    place.foldline("sweep collect f").ends(0).says(&["3 of 3 rows", "table.csv"]);
    place.foldline("sweep status f --csv t.csv").ends(0);
    assert_eq!(place.read("t.csv"), place.read("f/table.csv"));
    place.foldline(command).ends(0).says(&["nothing to submit: all tasks are on record"]);
    for wrong in ["--per-job 0", "--partition=a\tb", "--tasks 2"] {
        place.foldline(&format!("{command} {wrong}")).ends(2);
    }
    place.foldline("sweep run s.toml --folder f --partition low").ends(2).says(&["--slurm"]);
}

/// Programs of Slurm's names stand in for it: what is submitted in which order, and what is not submitted again.
#[cfg(unix)]
#[test]
fn what_is_submitted_is_known_and_not_submitted_again() {
    let place = place(
        "[reference]\nsettings = [\"mesh.elements=[6, 4]\"]\n[[axis]]\nkey = \"geometry.radius_mm\"\nvalues = [9, 10]\n",
    );
    let path = format!("{}:{}", place.file("bin").display(), std::env::var("PATH").unwrap_or_default());
    let slurm = |command: &str, code: i32, words: &[&str]| {
        let output = place.command(command).env("PATH", &path).output().unwrap();
        let said = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
        assert!(
            output.status.code() == Some(code) && words.iter().all(|word| said.contains(word)),
            "{command}: {said}"
        );
    };
    std::fs::create_dir_all(place.file("bin")).unwrap();
    let program = |name: &str, text: &str| {
        use std::os::unix::fs::PermissionsExt;
        place.write(&format!("bin/{name}"), format!("#!/bin/sh\n{text}\n"));
        std::fs::set_permissions(place.file(&format!("bin/{name}")), std::fs::Permissions::from_mode(0o755)).unwrap();
    };
    program("sbatch", "echo \"$@\" >> calls\nwc -l < calls");
    program("scontrol", "echo 'MaxArraySize            = 2'");
    program("squeue", "echo 'slurm_load_jobs error: Invalid job id specified' >&2; exit 1");
    slurm(
        "sweep run s.toml --folder f --slurm",
        0,
        &["job 1: 2 references in 1 element, 2 each", "job 2: 2 tasks in 1 element", "job 3: collects"],
    );
    let calls = String::from_utf8(place.read("calls")).unwrap();
    let calls: Vec<&str> = calls.lines().collect();
    assert!(calls.len() == 3 && calls[0].contains("1-references.sh") && !calls[0].contains("afterany"), "{calls:?}");
    assert!(
        calls[1].contains("--dependency=afterany:1 ") && calls[2].contains("--dependency=afterany:2 "),
        "{calls:?}"
    );
    slurm("sweep status f", 0, &["Slurm: none of the jobs is left"]);
    program("squeue", "echo '1|1|RUNNING'; echo '2|1|PENDING'; echo '3|N/A|PENDING'");
    slurm(
        "sweep status f",
        0,
        &["4 rows: 4 to do", "Slurm: 1 element waiting, 1 running, then the table is collected"],
    );
    slurm("sweep resume f --slurm", 0, &["nothing to submit: 4 tasks in the queue"]);
    program("squeue", "echo '1|1|RUNNING'");
    slurm("sweep resume f --slurm --json", 0, &["\"number\":2", "\"role\":\"tasks\",\"job\":4"]);
    program("sbatch", "echo 'sbatch: error: invalid partition specified: low' >&2; exit 1");
    program("squeue", "exit 0");
    slurm(
        "sweep resume f --slurm --partition low",
        1,
        &["Slurm refused `sbatch --parsable", "invalid partition specified: low"],
    );
    program("squeue", "echo 'Unable to contact slurm controller' >&2; exit 1");
    slurm("sweep status f", 0, &["cannot be asked from here"]);
    slurm("sweep resume f --slurm", 1, &["Unable to contact slurm controller"]);
}
