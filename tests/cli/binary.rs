//! The program from outside: help, wrong usage, exit codes, closed pipes.

use std::process::{Command, Output, Stdio};

fn foldline(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_foldline"));
    command.args(arguments);
    command
}

fn output(arguments: &[&str]) -> Output {
    foldline(arguments).output().unwrap()
}

fn stdout(arguments: &[&str]) -> String {
    let output = output(arguments);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    String::from_utf8(output.stdout).unwrap()
}

/// Standard error of a command that is to end with `code` and print nothing.
fn refusal(arguments: &[&str], code: i32) -> String {
    let output = output(arguments);
    let text = String::from_utf8(output.stderr).unwrap();
    assert_eq!(output.status.code(), Some(code), "{text}");
    assert!(output.stdout.is_empty());
    text
}

#[test]
fn help() {
    insta::assert_snapshot!("help", stdout(&["--help"]));
    insta::assert_snapshot!("help_run", stdout(&["help", "run"]));
    insta::assert_snapshot!("help_inspect", stdout(&["help", "inspect"]));
    insta::assert_snapshot!("help_plot", stdout(&["help", "plot"]));
}

#[test]
fn help_on_scenes_table_by_table() {
    let all = stdout(&["help", "scene"]);
    for topic in foldline::scene::help_topics() {
        let part = stdout(&["help", "scene", topic]);
        assert!(all.contains(&part) && part.len() > 100, "{topic}");
    }
    assert!(stdout(&["help", "scene", "support"]).starts_with("[[support]]  "));
    assert_eq!(stdout(&["help", "scene", "[[support]]"]), stdout(&["help", "scene", "support"]));
    let schema: serde_json::Value = serde_json::from_str(&stdout(&["help", "scene", "--json-schema"])).unwrap();
    assert_eq!(schema["required"], serde_json::json!(["load"]));
    insta::assert_snapshot!(refusal(&["help", "scene", "suport"], 2), @"error: no help on `suport`; there is help on geometry, material, ply, mesh, shell, joint, bond, imperfection, symmetry, load, support, spring, mass, action, probe, adapt, solver, continuation, pipeline, output, expect, places; did you mean `support`?");
    refusal(&["help", "run", "support"], 2);
    refusal(&["help", "run", "--json-schema"], 2);
}

#[test]
fn every_option_stands_in_the_long_help_and_the_short() {
    for subcommand in ["run", "inspect", "plot", "help"] {
        let [long, short] = [["help", subcommand], [subcommand, "-h"]].map(|arguments| stdout(&arguments));
        let options = |text: &str| -> Vec<String> {
            let words = text.split_whitespace().map(|word| word.trim_end_matches(','));
            words.filter(|word| word.starts_with("--")).map(str::to_string).collect()
        };
        assert_eq!(options(&long), options(&short), "{subcommand}");
    }
}

#[test]
fn wrong_usage() {
    insta::assert_snapshot!(refusal(&["help", "plto"], 2), @"error: no help on `plto`; there is help on scenes, new, check, run, resume, inspect, plot, report, compare, export, replay, bisect, stability, verify, recover, thin, bench, converge, calibrate, study, sweep, extremes, completions, man, help, scene; did you mean `plot`?");
    insta::assert_snapshot!(refusal(&["run", "nope.toml"], 2), @"error: cannot read nope.toml: there is no such file, and no scene of that name comes with the program; `foldline scenes` lists those");
    insta::assert_snapshot!(refusal(&["run", "a.toml", "--until", "-3"], 2), @r"
    error: invalid value '-3' for '--until <AT>': a rotation or a load factor above 0 is wanted; by arc length it counts on both sides of 0

    For more information, try '--help'.
    ");
    insta::assert_snapshot!(refusal(&["plot", "a.mcap", "--view", "north"], 2), @r"
    error: invalid value 'north' for '--view <AZIMUTH,ELEVATION>': two numbers of degrees are wanted, such as -62,24

    For more information, try '--help'.
    ");
    for arguments in [
        &["run", "a.toml", "-o", "-"][..],
        &["recover", "a.mcap", "-o", "-"],
        &["plot", "a.mcap", "-o", "-"],
        &["replay", "a.mcap", "--from-scratch", "--trace", "-"],
        &["stability", "a.mcap", "--step", "1", "-o", "-"],
    ] {
        let said = refusal(arguments, 2);
        assert!(said.contains("not to standard output; ./- is a file of that name"), "{said}");
    }
    refusal(&["run", "a.toml", "--threads", "0"], 2);
    refusal(&["run", "a.toml", "--quiet", "--json"], 2);
    refusal(&["inspect"], 2);
    refusal(&["inspect", "nope.mcap"], 2);
    refusal(&["fold"], 2);
    refusal(&[], 2);
}

#[test]
fn a_closed_pipe_is_no_failure() {
    for arguments in [&["help"][..], &["--help"], &["help", "run"]] {
        let mut child = foldline(arguments).stdout(Stdio::piped()).stderr(Stdio::piped()).spawn().unwrap();
        drop(child.stdout.take());
        let output = child.wait_with_output().unwrap();
        assert_eq!(output.status.code(), Some(0));
        assert_eq!(String::from_utf8_lossy(&output.stderr), "");
    }
}

#[test]
fn a_full_disk_is() {
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = foldline(&["help"]).stdout(full).stderr(Stdio::piped()).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&output.stderr).contains("cannot write to standard output"));
}

/// What is no text, or no surface that a shell can have, or no tape spring, is refused before anything starts or is printed.
#[test]
fn files_that_are_no_scenes() {
    let place = crate::program::Sandbox::new();
    let plate = include_str!("../verification/scenes/net-u-fastest.toml");
    place.write("log.toml", b"\x89MCAP0\r\n");
    place.write("latin.toml", b"# L\xe4nge\n");
    let utf_16: Vec<u8> = [0xFEFF].into_iter().chain(plate.encode_utf16()).flat_map(u16::to_le_bytes).collect();
    place.write("wide.toml", &utf_16);
    place.write("plate.toml", plate);
    let right_order = "[geometry]\nkind = \"nurbs\"\nfile = \"plate.json\"\n";
    let rest = plate.split_once("[material]").unwrap().1;
    place.write("marked.toml", format!("\u{feff}{right_order}[material]{rest}"));
    let json = "\u{feff}{\"degrees\": [1, 1], \"knots_u\": [0, 0, 1, 1], \"knots_v\": [0, 0, 1, 1], \
                \"control_points_mm\": [[0, 0, 0], [0, 40, 0], [100, 0, 0], [100, 40, 0]]}";
    place.write("plate.json", json);
    let says = |arguments: &str, pieces: &[&str]| {
        let said = place.foldline(arguments).ends(2).says(pieces);
        assert!(said.out.is_empty(), "{}", said.out);
    };
    says("run log.toml -o a.mcap", &["it is a log", "foldline resume"]);
    says("run latin.toml -o a.mcap", &["line 1 holds the byte 0xE4", "save it as UTF-8"]);
    says("run wide.toml -o a.mcap", &["UTF-16", "save it as UTF-8"]);
    says("run plate.toml -o a.mcap", &["listed with u running fastest"]);
    says("converge marked.toml", &["only a tape spring whose ends turn"]);
    assert_eq!(place.logs(), ["plate.json"]);
    place.foldline("run marked.toml -o a.mcap -q").ends(0);
}

/// A shell with nothing left free is refused before anything starts.
#[test]
fn a_shell_that_is_held_everywhere() {
    let place = crate::program::Sandbox::new();
    let (head, _) = include_str!("../restart/column.toml").split_once("[mesh]").unwrap();
    let hinged = ["u-start", "u=0.5", "u-end"].map(|on| format!("[[support]]\non = \"{on}\"\nkind = \"hinged\"\n"));
    let rest = "[mesh]\ndegree = [2, 2]\nelements = [1, 1]\n[load]\nkind = \"steps\"\nincrement = 1.0\n";
    let pressure = "[[action]]\nkind = \"pressure\"\npressure_mpa = 1e-5\n";
    place.write("held.toml", format!("{head}{rest}{}{pressure}", hinged.concat()));
    let said = place.foldline("run held.toml -o held.mcap").ends(2);
    said.says(&["hold every control point of 1 × 1 elements", "write more in mesh.elements, or hold less"]);
    assert!(place.logs().is_empty());
}

/// A name that would break a line or turn its direction is refused, and itself not shown.
#[test]
fn names_are_lines_of_what_can_be_seen() {
    let place = crate::program::Sandbox::new();
    for (name, character) in [("tip\\nstage 9", "U+000A"), ("tip\\u202e9", "U+202E"), ("tip\u{2066}", "U+2066")] {
        let probe = format!("\n[[probe]]\nname = \"{name}\"\nkind = \"energy\"\n");
        place.write("named.toml", format!("{}{probe}", crate::program::SMALL));
        let said = place.foldline("run named.toml -o a.mcap").ends(2).says(&[character, "cannot be seen"]);
        assert!(!said.err.contains(['\u{202e}', '\u{2066}']), "{}", said.err);
    }
}

/// Surfaces and scenes that no log could hold are refused before anything is done.
#[test]
fn scenes_that_no_log_can_hold() {
    let place = crate::program::Sandbox::new();
    let rest = include_str!("../verification/scenes/net-u-fastest.toml").split_once("[material]").unwrap().1;
    place.write("plate.toml", format!("[geometry]\nkind = \"nurbs\"\nfile = \"plate.json\"\n[material]{rest}"));
    let count = 350;
    let knots: Vec<usize> = [0].into_iter().chain(0..count).chain([count - 1]).collect();
    let points: Vec<[usize; 3]> = (0..count * count).map(|index| [index / count, index % count, 0]).collect();
    let json = format!(
        "{{\"degrees\": [1, 1], \"knots_u\": {knots:?}, \"knots_v\": {knots:?}, \"control_points_mm\": {points:?}}}"
    );
    place.write("plate.json", json);
    place.foldline("run plate.toml -o a.mcap").ends(2).says(&["values, and one in a log has no more than", "350000"]);
    place.write("plate.json", vec![b' '; 9 << 20]);
    place
        .foldline("run plate.toml -o a.mcap")
        .ends(2)
        .says(&["plate.json", "it has 9437184 bytes, and no more than 8388608"]);
    place.write("long.toml", format!("{}# {}", crate::program::SMALL, " ".repeat(9 << 20)));
    place.foldline("run long.toml -o a.mcap").ends(2).says(&["a scene has no more than 8388608"]);
    assert_eq!(place.logs(), ["plate.json"]);
}

/// Files may have any name that the system takes: it is used as it is, and breaks no line where it is shown.
#[cfg(unix)]
#[test]
fn names_of_files() {
    use std::ffi::OsStr;
    use std::os::unix::ffi::OsStrExt;
    let folder = tempfile::tempdir().unwrap();
    for (name, shown) in [(&b"not\xffutf-8"[..], "not\u{fffd}utf-8"), (b"two\nlines", "two␊lines")] {
        let log = folder.path().join(OsStr::from_bytes(name));
        let scene = log.with_extension("toml");
        std::fs::write(&scene, include_str!("../restart/small.toml")).unwrap();
        let run = |arguments: &[&OsStr]| {
            let output = Command::new(env!("CARGO_BIN_EXE_foldline")).args(arguments).output().unwrap();
            let text = String::from_utf8([output.stdout, output.stderr].concat()).unwrap();
            (output.status.code(), text)
        };
        let [command, to, until, two] = ["run", "-o", "--until", "2"].map(OsStr::new);
        let (code, said) = run(&[command, scene.as_os_str(), to, log.as_os_str(), until, two]);
        assert!(code == Some(0) && said.contains(shown), "{said}");
        for (command, code) in [("inspect", 0), ("verify", 0), ("resume", 0), ("thin", 2)] {
            let (found, said) = run(&[OsStr::new(command), log.as_os_str()]);
            assert!(found == Some(code) && (code == 2 || said.contains(shown)), "{command}: {said}");
        }
        let (code, said) = run(&[OsStr::new("inspect"), log.with_extension("other").as_os_str()]);
        assert!(code == Some(2) && said.contains(shown), "{said}");
        std::fs::remove_file(&scene).unwrap();
    }
}

/// A scene in which nothing acts is one that is run, and that it does is said however quiet the run is.
#[test]
fn nothing_acts() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("still.toml");
    let roof = include_str!("../restart/path.toml").split("[continuation]").next().unwrap();
    std::fs::write(&scene, roof.replace("-3000.0]", "-3000.0]\nhistory = [[0, 0], [2, 0]]")).unwrap();
    for (number, manner) in ["--quiet", "--json"].into_iter().enumerate() {
        let log = folder.path().join(format!("{number}.mcap"));
        let output = output(&["run", scene.to_str().unwrap(), "-o", log.to_str().unwrap(), manner]);
        let said = String::from_utf8(output.stderr).unwrap();
        assert!(output.status.success() && said.contains("nothing acts on the shell"), "{manner}: {said}");
    }
}
