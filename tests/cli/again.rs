//! The everyday loop: a scene is changed and run again; and what is set once for all commands.

use crate::program::{SMALL, Said, Sandbox};

/// A sandbox with the log of a scene up to 4°.
fn with_log() -> Sandbox {
    let place = Sandbox::new();
    place.write("small.toml", SMALL);
    place.foldline("run small.toml -o small.mcap --until 4 --quiet").ends(0);
    place
}

fn pin(name: &str, text: &str) {
    insta::with_settings!({ omit_expression => true }, { insta::assert_snapshot!(name, text) });
}

#[test]
fn a_log_that_is_there_is_told_apart_from_what_is_run() {
    let place = with_log();
    pin("again-the-same", &place.foldline("run small.toml -o small.mcap").ends(2).err);
    place.write("small.toml", SMALL.replace("rotation_deg = 16.0", "rotation_deg = 6.0").replace("0.1\n", "0.12\n"));
    pin("again-another", &place.foldline("run small.toml -o small.mcap").ends(2).err);
    place.foldline("resume small.mcap --until 6 --quiet").ends(0);
    place.write("small.toml", SMALL.replace("rotation_deg = 16.0", "rotation_deg = 6.0"));
    place.foldline("run small.toml -o small.mcap --resume --quiet").ends(0);
    pin("again-finished", &place.foldline("run small.toml -o small.mcap").ends(2).err);
    place.write("small.mcap", "text");
    place.foldline("run small.toml -o small.mcap --force").ends(2).says(&["is no log"]);
    assert_eq!(place.read("small.mcap"), b"text");
}

#[test]
fn the_old_log_is_kept_aside() {
    let place = with_log();
    let old = place.read("small.mcap");
    place.write("small.1.mcap", "taken");
    let said = place.foldline("run small.toml -o small.mcap --until 2 --force").ends(0);
    said.says(&["the log that was there is small.2.mcap now"]);
    assert_eq!(place.read("small.2.mcap"), old);
    assert_eq!(place.read("small.1.mcap"), b"taken");
    assert!(place.log("small.mcap").commits() < place.log("small.2.mcap").commits());
    // Nothing is moved for a scene that cannot run.
    place.write("small.toml", SMALL.replace("rotation_deg", "rotation_dge"));
    place.foldline("run small.toml -o small.mcap --force").ends(2);
    assert!(!place.file("small.3.mcap").exists());
    place.foldline("run small.toml -o small.mcap --force --resume").ends(2).says(&["cannot be used with"]);
}

/// The log holds the scene as it was run, so that it is resumed and replayed like any other.
#[test]
fn settings_are_laid_over_a_scene() {
    let place = Sandbox::new();
    place.write("small.toml", SMALL);
    place.foldline("run small.toml -o set.mcap --set load.rotation_deg=6 --until 2 --quiet").ends(0);
    place.foldline("resume set.mcap --quiet").ends(0);
    place.write("small.toml", SMALL.replace("rotation_deg = 16.0", "rotation_deg = 6.0"));
    place.foldline("run small.toml -o same.mcap --quiet").ends(0);
    let chain = |log: &str| place.log(log).last_commit().unwrap().chain_hash;
    assert_eq!(chain("set.mcap"), chain("same.mcap"));
    place.foldline("replay set.mcap --step 2").ends(0);
    place.foldline("run small.toml -o no.mcap --set load.rotation=6").ends(2).says(&["rotation_deg"]);
    assert!(!place.file("no.mcap").exists());
}

#[test]
fn what_is_set_once_changes_no_result() {
    let place = Sandbox::new();
    place.write("small.toml", SMALL);
    place.foldline("run small.toml -o plain.mcap --until 4 --quiet").ends(0);
    place.write("foldline.toml", "logs = \"runs\"\nthreads = 1\nsync = \"at-end\"\n");
    std::fs::create_dir(place.file("runs")).unwrap();
    std::fs::create_dir(place.file("elsewhere")).unwrap();
    place.foldline("run small.toml --until 4 --quiet").ends(0);
    let mut command = place.command("run small.toml --until 4 --quiet");
    Said::new("run", command.env("FOLDLINE_LOGS", "elsewhere").env("FOLDLINE_THREADS", "2").output().unwrap()).ends(0);
    for log in ["runs/small.mcap", "elsewhere/small.mcap"] {
        assert_eq!(place.log(log).last_commit(), place.log("plain.mcap").last_commit(), "{log}");
    }
    let mut command = place.command("run small.toml -o never.mcap");
    let said = Said::new("run", command.env("FOLDLINE_THREADS", "many").output().unwrap()).ends(2);
    said.says(&["FOLDLINE_THREADS: \"many\", where a number from 1 to 1024 is wanted"]);
    place.write("foldline.toml", "threshold = 0.1\n");
    place
        .foldline("run small.toml -o never.mcap")
        .ends(2)
        .says(&["foldline.toml", "nothing that could change a result"]);
    assert!(!place.file("never.mcap").exists());
}

/// Commands that are proposed can be typed as they stand, whatever the files are called.
#[test]
fn names_in_proposed_commands_are_quoted() {
    let place = Sandbox::new();
    place.write("my scene.toml", SMALL);
    let run = |arguments: &[&str]| {
        let mut command = place.command("run");
        Said::new("run", command.args(arguments).output().unwrap())
    };
    let said = run(&["my scene.toml", "-o", "it's mine.mcap", "--until", "4"]).ends(0);
    said.says(&[r"foldline inspect 'it'\''s mine.mcap'"]);
    let said = run(&["my scene.toml", "-o", "it's mine.mcap", "--set", "load.sense=\"opposite\""]).ends(2);
    let said = said.says(&[r"foldline resume 'it'\''s mine.mcap'"]);
    said.says(&["foldline run 'my scene.toml' --set 'load.sense=\"opposite\"' -o OTHER.mcap"]);
}
