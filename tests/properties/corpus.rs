//! The logs and scenes that fuzzing with coverage kept, read again. `tests/fuzz/README.md` says how they came about.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use foldline::scene::{Kind, SECTIONS, Stage, all_keys};

#[path = "../fuzz/crafted.rs"]
#[allow(dead_code, reason = "shared with other tests")]
mod crafted;
#[path = "../fuzz/scene_text.rs"]
mod scene_text;
#[path = "../fuzz/script.rs"]
mod script;

fn in_package(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

fn files(folder: &Path) -> Vec<PathBuf> {
    std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).filter(|path| path.is_file()).collect()
}

/// What the fuzzer kept for a target.
fn corpus(target: &str) -> Vec<Vec<u8>> {
    let kept = files(&in_package("tests/fuzz/corpus").join(target));
    kept.into_iter().map(|path| std::fs::read(path).unwrap()).collect()
}

/// What the reader's fuzzer begins with: the first commits of every golden log, and the smaller ones as they are.
fn logs() -> Vec<(String, Vec<u8>)> {
    let logs = files(&in_package("checkpoints/golden")).into_iter();
    let logs = logs.filter(|path| path.extension().is_some_and(|extension| extension == "mcap"));
    let scripts = logs.flat_map(|path| {
        let (name, log) = (path.file_stem().unwrap().display().to_string(), std::fs::read(&path).unwrap());
        let first = [1, 2, 5].map(|commits| (format!("{name}-{commits}"), script::script_of(&log, commits)));
        let whole = (log.len() < 28_000).then(|| (format!("{name}-as-it-is"), [&[255], &log[..]].concat()));
        first.into_iter().chain(whole)
    });
    scripts.collect()
}

/// What the fuzzer of scenes begins with: every scene of the package without its comments, and one with each key as a setting.
fn scenes() -> Vec<(String, String)> {
    let folders = ["pipelines", "pipelines/extreme", "pipelines/verification", "tests/verification/scenes"];
    let paths = folders.iter().flat_map(|folder| files(&in_package(folder)));
    let paths = paths.filter(|path| path.extension().is_some_and(|extension| extension == "toml"));
    let without_comments = |text: &str| -> String {
        text.lines().filter(|line| !line.starts_with('#')).map(|line| format!("{line}\n")).collect()
    };
    let scene = |path: PathBuf| {
        let text = std::fs::read_to_string(&path).unwrap();
        (path.file_stem().unwrap().display().to_string(), without_comments(&text))
    };
    let spring = without_comments(include_str!("../../pipelines/baseline-quarter.toml"));
    let with_setting = all_keys().map(|key| {
        (format!("with-{}", key.path()), format!("{}{}={}\n{spring}", scene_text::SETTING, key.path(), key.example))
    });
    paths.map(scene).chain(with_setting).collect()
}

/// The words of scenes, from the table of keys, and what TOML is written with, as a dictionary of libFuzzer.
fn dictionary() -> String {
    let quoted = |word: &str| format!("\"{word}\"");
    let of_key = |key: &foldline::scene::Key| {
        let words: Vec<String> = match &key.kind {
            Kind::Word(choices) | Kind::Words(choices) => choices.iter().map(|choice| quoted(choice.word)).collect(),
            Kind::NumberOr(word) => vec![quoted(word)],
            Kind::Stages => Stage::ALL.map(|stage| quoted(stage.name())).to_vec(),
            _ => vec![],
        };
        let setting = format!("{}{}=", scene_text::SETTING, key.path());
        [format!("{} = ", key.name), setting, key.example.to_owned()].into_iter().chain(words)
    };
    let signs =
        ["[[", "]]", " = ", "\"\"\"", "'''", "{", "}", "\\u202e", "inf", "nan", "-0.0", "1e308", "5e-324", "\u{feff}"];
    let titles = SECTIONS.iter().map(|section| format!("\n{}\n", section.title()));
    let words: BTreeSet<String> = all_keys().flat_map(of_key).chain(titles).chain(signs.map(str::to_owned)).collect();
    let escaped = |word: String| -> String {
        let byte = |byte: u8| match byte {
            b'"' | b'\\' => format!("\\{}", char::from(byte)),
            b' '..=b'~' => char::from(byte).to_string(),
            _ => format!("\\x{byte:02X}"),
        };
        word.bytes().map(byte).collect()
    };
    words.into_iter().map(|word| format!("\"{}\"\n", escaped(word))).collect()
}

#[test]
fn the_corpus_of_logs_is_read() {
    let kept = corpus("reader").into_iter().chain(logs().into_iter().map(|(_, script)| script));
    let count = kept.map(|script| script::read(script::log_of(&script))).count();
    println!("{count} logs");
}

#[test]
fn the_corpus_of_scenes_is_read() {
    let kept = corpus("scene").into_iter().map(|bytes| String::from_utf8(bytes).unwrap());
    let count = kept.chain(scenes().into_iter().map(|(_, text)| text)).map(|text| scene_text::read(&text)).count();
    println!("{count} scenes");
}

/// Seeds are logs whose commits are good, to the last: what the fuzzer changes is met behind every seal.
#[test]
fn seeds_are_whole_logs() {
    // A thinned log lacks what its commits name; there the script is not the log.
    for (name, script) in logs().iter().filter(|(name, _)| !name.ends_with("as-it-is") && !name.contains("thinned")) {
        let log = foldline::journal::Log::from_bytes(script::log_of(script)).unwrap();
        assert!(log.loss().is_none(), "{name}: {:?}", log.loss());
        assert!((0..log.commits()).all(|index| !log.keeps_state(index) || log.state(index).is_ok()), "{name}");
    }
}

/// Writes the seeds of both targets and the dictionary of scenes into the folder that `FOLDLINE_FUZZ_SEEDS` names.
#[test]
#[ignore = "writes files: the fuzzing needs it once"]
fn write_seeds() {
    let folder = PathBuf::from(std::env::var("FOLDLINE_FUZZ_SEEDS").unwrap());
    let scenes = scenes().into_iter().map(|(name, text)| (name, text.into_bytes()));
    for (target, seeds) in [("reader", logs()), ("scene", scenes.collect())] {
        std::fs::create_dir_all(folder.join(target)).unwrap();
        for (name, seed) in seeds {
            std::fs::write(folder.join(target).join(name), seed).unwrap();
        }
    }
    std::fs::write(folder.join("scene.dict"), dictionary()).unwrap();
}
